//! `tune`: which tolerances should this model use?

use crate::doubts::tell_of_tolerances;
use crate::exit::{ExitStatus, Outcome, print_note, shows_progress};
use crate::input::{FormatArgs, ReadArgs, ToleranceArgs, model_help, stepper};
use crate::input_file::InputFile;
use crate::stop::{ReadyingStop, on_ctrl_c_while_readying};
use crate::terminal::threads;
use anyhow::Context;
use indicatif::{ProgressBar, ProgressStyle};
use rayon::ThreadPool;
use rockproof_examine::{file_name, tolerances_json};
use rockproof_model::scene::write_toml;
use rockproof_model::{Precision, Scene, ToleranceSpec};
use rockproof_report::latex::latex;
use rockproof_report::table::{Table, TableCell, counted};
use rockproof_results::{Owner, Start, bounded, digest};
use rockproof_tune::distribute::StopCriterion;
use rockproof_tune::report::{as_toml, markdown, sides, tolerances_file};
use rockproof_tune::{
    EvaluatedCandidate, Evaluator, Search, SearchRecord, TuneError, UnauditedEvaluator, rule_warnings,
};
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Search for the tolerances that suit a model
///
/// Tries tolerance sets on the model's own neighbouring pairs, on perturbed copies of them at the boundaries of decisions, and in steps that the oracle makes
/// as well, and prints the one with no difference between engine and oracle, the least sinking and the largest margin to every rule, ready to paste,
/// beside what the model's current set does.
///
/// Writes tolerances.toml, tune.md, tune.tex (its table for a paper), candidates.csv and tune.json. The same number of candidates gives the same bytes; only that number depends on
/// the clock.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  rockproof tune cases/real/openpit_rock.dda
  rockproof tune slope.toml --engine stepper-f32 --budget 600 --out reports/slope
  rockproof tune slope.toml --candidates 50           always the same answer, however long it takes
  rockproof tune slope.toml --candidates 200 --resume
  mpirun -n 8 rockproof tune slope.toml --candidates 200 --mpi --threads 1

Exit status: 0 done, 1 no set kept every rule without a difference and every block from sinking deeper than `penetration` or overlapping unseen by contacts in all its steps, after no more than 5 of settling, 2 usage or input error, 130 interrupted (go on with --resume).")]
pub(crate) struct Tune {
    #[arg(help = model_help(), value_hint = clap::ValueHint::FilePath)]
    file: InputFile,
    #[command(flatten)]
    read: ReadArgs,
    /// What the author uses now, to compare with
    #[command(flatten)]
    tolerances: ToleranceArgs,
    /// Engine: stepper-f32 or stepper-f64
    #[arg(long, default_value = "stepper-f64", value_parser = stepper)]
    engine: Precision,
    /// Seed of candidates and pairs
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Seconds after which no more candidates are tried, in this session
    #[arg(long, value_name = "SECONDS", default_value_t = 60, value_parser = clap::value_parser!(u64).range(1..=1_000_000))]
    budget: u64,
    /// Try so many candidates in all, however long it takes
    #[arg(long, value_name = "COUNT", conflicts_with = "budget", value_parser = clap::value_parser!(u32).range(1..))]
    candidates: Option<u32>,
    /// Steps of a part of the model for each candidate, after its settling [default: 4 to 32, as the budget and the part allow]
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    steps: Option<u32>,
    /// Directory of the results [default: reports/tune-MODEL]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Go on with the search in the directory, or begin if there is none
    #[arg(long, conflicts_with = "overwrite")]
    resume: bool,
    /// Discard the search in the directory; other files there stay
    #[arg(long)]
    overwrite: bool,
    /// Share the work among the ranks of an MPI job (docs/scale.md; a build with the feature mpi)
    #[arg(long)]
    mpi: bool,
    /// Worker threads, with --mpi of each rank; 0, the default, is one per core; the results do not depend on it
    #[arg(long, default_value_t = 0, hide_default_value = true, value_parser = threads)]
    threads: usize,
    #[command(flatten)]
    format: FormatArgs,
}

/// A search that can begin.
pub(crate) struct Prepared {
    pub(crate) evaluator: UnauditedEvaluator,
    /// What the author uses.
    pub(crate) author: ToleranceSpec,
    /// Everything that determines what candidate `n` is and measures.
    pub(crate) identity: Map<String, Value>,
    pub(crate) dir: PathBuf,
}

/// What is told where the model was still measured.
pub(crate) const MEASURING: &str = "interrupted before the first candidate of this session: nothing is written, and the same command can be given again";

/// What Ctrl-C does; while the model is measured the program ends at once.
pub(crate) fn on_ctrl_c_while_measuring() -> anyhow::Result<ReadyingStop> {
    on_ctrl_c_while_readying(MEASURING)
}

/// Writes what was tried so far.
type Commit<'c> = &'c mut dyn FnMut(&Search<'_>) -> anyhow::Result<()>;

impl Tune {
    pub(crate) fn run(&self) -> Outcome {
        if !self.mpi {
            return self.run_here();
        }
        #[cfg(feature = "mpi")]
        return crate::mpi::on_all_ranks(self);
        #[cfg(not(feature = "mpi"))]
        Err(crate::exit::without_mpi())
    }

    /// Searches in this process alone.
    pub(crate) fn run_here(&self) -> Outcome {
        let stop = on_ctrl_c_while_measuring()?;
        let pool = self.pool()?;
        let Prepared { evaluator, author, identity, dir } = self.prepared(&pool)?;
        // Overlaps of a large model take long.
        Start::of(self.resume, self.overwrite).refuse_held(&dir, Owner::Tune)?;
        let evaluator = pool.install(|| evaluator.audited());
        let stop = stop.begin();
        self.searched((&evaluator, &author), (&identity, &dir), &stop, |search, enough, commit| {
            while !(enough.reached)(search.tried().len()) && !stop.load(Ordering::Relaxed) {
                pool.install(|| search.step().map(|_| ()))?;
                commit(search)?;
            }
            Ok(())
        })
    }

    pub(crate) fn pool(&self) -> anyhow::Result<ThreadPool> {
        Ok(rayon::ThreadPoolBuilder::new().num_threads(self.threads).build()?)
    }

    /// Worker threads; 0 for one a core.
    #[cfg(feature = "mpi")]
    pub(crate) fn threads(&self) -> usize {
        self.threads
    }

    /// The seed of candidates and pairs.
    #[cfg(feature = "mpi")]
    pub(crate) fn seed(&self) -> u64 {
        self.seed
    }

    /// Reads and measures the model, in `pool`.
    pub(crate) fn prepared(&self, pool: &ThreadPool) -> anyhow::Result<Prepared> {
        let scene = self.read.scene(&self.file)?;
        let author = self.tolerances.spec(scene.tolerances.as_ref())?;
        let here = || self.tolerances.place(self.file.path());
        let stem = self.file.stem();
        let dir =
            self.out.clone().unwrap_or_else(|| PathBuf::from(format!("reports/{}", bounded(&format!("tune-{stem}")))));
        // A search goes on with the steps it began with, whatever the budget is now.
        let held = if self.resume { SearchRecord::steps(&dir) } else { None };
        let steps = self.steps.map(u64::from).or(held);
        let prepare = || UnauditedEvaluator::new(&scene, self.engine, self.seed, steps, self.budget);
        let evaluator = pool.install(prepare).with_context(here)?;
        let author_set = author.derive(&scene.shapes(), self.engine).with_context(here)?;
        tell_of_tolerances(&scene.shapes(), &author_set);
        let identity = self.identity(&scene, &as_toml(&author_set), evaluator.steps());
        Ok(Prepared { evaluator, author, identity, dir })
    }

    /// Opens the record of a search, lets `search_all` search until it is told that there is enough, and writes and prints the answer.
    pub(crate) fn searched(
        &self,
        (evaluator, author): (&Evaluator, &ToleranceSpec),
        (identity, dir): (&Map<String, Value>, &Path),
        stop: &AtomicBool,
        search_all: impl FnOnce(&mut Search<'_>, &StopCriterion<'_>, Commit<'_>) -> anyhow::Result<()>,
    ) -> Outcome {
        let here = || self.tolerances.place(self.file.path());
        let mut search = Search::new(evaluator, author, self.seed).with_context(here)?;
        let start = Start::of(self.resume, self.overwrite);
        start.refuse_inputs(dir, [self.file.path()].into_iter().chain(self.tolerances.file()))?;
        let mut record = SearchRecord::open(dir, identity, start, &mut search)?;
        let begun = Instant::now();
        let reached = |tried: usize| match self.candidates {
            Some(count) => tried >= count as usize,
            // The first of all is always measured: it is what the others are compared with.
            None => tried > 0 && begun.elapsed() >= Duration::from_secs(self.budget),
        };
        let enough = StopCriterion { reached: &reached, most: self.candidates.map(|count| count as usize) };
        let bar = shows_progress().then(spinner);
        let ended = search_all(&mut search, &enough, &mut |search| {
            record.commit(search)?;
            if let Some(bar) = &bar {
                tell(bar, search);
            }
            Ok(())
        });
        if let Some(bar) = &bar {
            bar.finish_and_clear();
        }
        ended.map_err(|error| match error.downcast_ref() {
            // What is wrong with a candidate is wrong with the model.
            Some(TuneError::Record(_) | TuneError::Distribute(_) | TuneError::Panic(_)) | None => error,
            Some(_) => error.context(here()),
        })?;
        let text = markdown(&file_name(self.file.path()), evaluator, &search);
        let Some(best) = search.best().map(|best| &search.tried()[best]) else {
            print_note("interrupted before the first candidate; --resume begins with it");
            return Ok(ExitStatus::Interrupted);
        };
        record.write("tune.md", text.as_bytes())?;
        record.write("tune.tex", sides_in_latex(&search).as_bytes())?;
        record.write("tolerances.toml", tolerances_file(best, evaluator).as_bytes())?;
        let count = search.tried().len();
        let tried = counted(count as u64, "candidate", "candidates");
        let files = "tolerances.toml, tune.md, tune.tex, candidates.csv, tune.json";
        let is_interrupted = stop.load(Ordering::Relaxed);
        let interrupted = if is_interrupted { "interrupted; --resume goes on\n" } else { "" };
        let told = || format!("{text}\n{tried} tried; written to {}: {files}\n{interrupted}", dir.display());
        self.format.print(told, || {
            json!({
                "clean": best.measurement.is_clean(),
                "candidates": count,
                "author": candidate_json(&search.tried()[0]),
                "recommended": candidate_json(best),
                "warnings": rule_warnings(&best.set, evaluator.scene()),
                "directory": dir.display().to_string(),
            })
        })?;
        Ok(match (is_interrupted, best.measurement.is_clean()) {
            (true, _) => ExitStatus::Interrupted,
            (_, true) => ExitStatus::Passed,
            (_, false) => ExitStatus::CheckFailed,
        })
    }

    /// Everything that determines what candidate `n` is and measures.
    fn identity(&self, scene: &Scene, author: &str, steps: u64) -> Map<String, Value> {
        let mut map = Map::new();
        map.insert("version".to_owned(), env!("CARGO_PKG_VERSION").into());
        map.insert("model".to_owned(), digest(write_toml(scene).as_bytes()).into());
        map.insert("engine".to_owned(), self.engine.to_string().into());
        map.insert("seed".to_owned(), self.seed.into());
        map.insert("author".to_owned(), author.into());
        map.insert("steps".to_owned(), steps.into());
        map
    }
}

/// What was measured of the author's set and the one recommended, as a table for a paper.
fn sides_in_latex(search: &Search<'_>) -> String {
    let (columns, rows) = sides(search).unwrap_or_default();
    let mut table = Table::new("tune", "The author's tolerances beside those recommended; lengths in m", &columns);
    for row in rows {
        table.push(row.into_iter().map(TableCell::Text).collect());
    }
    latex(&table, usize::MAX)
}

/// What shows on a terminal that there is progress.
fn spinner() -> ProgressBar {
    let bar = ProgressBar::new_spinner();
    if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed}, {msg}") {
        bar.set_style(style);
    }
    bar
}

/// Tells how far a search is.
fn tell(bar: &ProgressBar, search: &Search<'_>) {
    if let Some(best) = search.best() {
        let differ = search.tried()[best].measurement.differences.avoidable();
        bar.set_message(format!("{} candidates, the best with {differ} pairs that differ", search.tried().len()));
        bar.tick();
    }
}

/// A candidate for programs.
fn candidate_json(candidate: &EvaluatedCandidate) -> Value {
    let m = &candidate.measurement;
    let pairs = |[examined, differ]: [u64; 2]| json!({ "examined": examined, "differ": differ });
    let lockstep = m.lockstep.as_ref().map(|l| {
        json!({
            "steps": l.steps, "steps_differing": l.differ, "contacts": l.found, "contacts_differing": l.contacts,
            "modes_differing": l.modes, "steps_of_one_side": l.failed, "deepest_overlap_m": l.deepest,
        })
    });
    json!({
        "origin": candidate.origin.name(),
        "tolerances": tolerances_json(&candidate.set),
        "rules_violated": m.violated.iter().map(|rule| rule.formula()).collect::<Vec<_>>(),
        "nearest_rule": m.tightest.rule.formula(),
        "nearest_rule_met": m.tightest.factor,
        "lost_pairs": m.lost_pairs,
        "pairs_standing": pairs(m.differences.standing),
        "pairs_moved": pairs(m.differences.moved),
        "pairs_near_boundary": pairs(m.differences.near),
        "pairs_on_boundary": pairs(m.differences.boundary),
        "contacts_changed_by_tolerances": m.differences.changed,
        "settling_steps": m.steps_measured.settled,
        "steps": m.steps_measured.steps,
        "steps_deep": m.steps_measured.deep,
        "steps_unseen": m.steps_measured.unseen.steps,
        "unseen_pairs": m.steps_measured.unseen.most_pairs,
        "unseen_m": m.steps_measured.unseen.deepest,
        "steps_explained": m.steps_measured.explained.steps,
        "explained_pairs": m.steps_measured.explained.most_pairs,
        "explained_m": m.steps_measured.explained.deepest,
        "unconverged": m.steps_measured.unconverged,
        "steps_refused": m.steps_measured.refused,
        "stopped": m.steps_measured.stopped,
        "sunk_m": m.steps_measured.overlaps.sunk,
        "deepest_overlap_m": m.steps_measured.overlaps.deepest,
        "lockstep": lockstep,
    })
}
