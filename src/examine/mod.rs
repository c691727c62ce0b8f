//! `examine`: is this model safe?

mod cases;
mod document;
mod pairs;
mod progress;
mod results;
mod steps;
mod verdict;
mod view;

use crate::check::{CheckedModel, ModelArgs};
use crate::exit::{Outcome, Verdict, print_note};
use crate::input::{FormatArgs, precision};
use crate::overlaps::{Overlaps, overlaps};
use crate::stop::on_ctrl_c;
use crate::table::grouped;
use crate::terminal::threads;
use pairs::{ExaminedPair, PRECISIONS};
use progress::Stage;
use rockproof_differential::subject::SubjectSet;
use rockproof_model::rules::{self, Violation};
use rockproof_model::{Precision, ToleranceSet, ToleranceSpec};
use rockproof_results::{Claim, Directory, Owner, Start, bounded};
use rockproof_tune::report::markdown;
use rockproof_tune::{Evaluator, Measurement, Search};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use steps::Steps;

/// Blocks of a model that is stepped without being asked to.
const MOST_STEPPED: usize = 2000;
/// Steps of the search for a set, for each candidate.
const TUNE_STEPS: u64 = 8;
/// Seed of the search for a set.
const SEED: u64 = 1;

/// Is this model safe? Blocks, tolerances, every neighbouring pair, some steps, and a better set in one command
///
/// Reads the blocks as `check` does: sizes, units, rules, overlaps. Then classifies every neighbouring pair exactly and in f32 and f64 and names the cause of each
/// difference; makes some steps and asks exactly after each whether blocks overlap unseen or passed through one another; and searches for a
/// tolerance set that does better, which it then examines in the same way. Ends with a verdict and the next command.
///
/// Writes index.html (the model in 3-D, bad pairs in colour), examine.md, examine.json, blocks.vtu, pairs.csv, tolerances.toml, tolerances.csv, both tables
/// for a paper (pairs.tex, tolerances.tex), and the worst differences as cases to replay. Nothing is written before the end, so an interrupted examination is begun anew.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  rockproof examine slope.dda
  rockproof examine cells.txt --planarity 1e-4 --tolerances mine.toml --out reports/mine
  rockproof examine blocks.obj --scale 1/1000            a file in millimetres
  rockproof examine slope.toml --steps 50 --no-tune
  rockproof examine slope.dda --format json > slope.json

Exit status: 0 safe, 1 not safe with the tolerances it was examined with, 2 usage or input error, 130 interrupted.")]
pub(crate) struct Examine {
    #[command(flatten)]
    model: ModelArgs,
    /// Precision that the model is to be safe in: f32 or f64
    #[arg(long, default_value = "f64", value_parser = precision)]
    precision: Precision,
    /// Steps to make and audit after settling, whatever the size of the model; 0 for none [default: 5 where the model has at most 2000 blocks]
    #[arg(long, value_name = "N")]
    steps: Option<u64>,
    /// Tolerance sets to try, those given among them
    #[arg(long, value_name = "COUNT", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    candidates: u32,
    /// Look for no other tolerance set
    #[arg(long, conflicts_with = "candidates")]
    no_tune: bool,
    /// Directory of the results [default: reports/examine-MODEL]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Discard the examination in the directory; other files there stay
    #[arg(long)]
    overwrite: bool,
    #[command(flatten)]
    format: FormatArgs,
    /// Worker threads [default: one a core]; the results do not depend on it
    #[arg(long, default_value_t = 0, hide_default_value = true, value_parser = threads)]
    threads: usize,
}

/// How a model does with one tolerance set.
pub(crate) struct Assessment {
    /// The set.
    pub(crate) set: ToleranceSet,
    /// The rules that it violates.
    pub(crate) violations: Vec<Violation>,
    /// The blocks that overlap.
    pub(crate) overlaps: Overlaps,
    /// All neighbouring pairs, in ascending order.
    pub(crate) pairs: Vec<ExaminedPair>,
    /// The steps.
    pub(crate) steps: Steps,
}

/// What the search for another set came to.
pub(crate) enum Recommendation {
    /// There was none, and why.
    Skipped(String),
    /// The set given is the best of so many.
    Given { candidates: usize },
    /// Another set.
    Other(Box<OtherSet>),
}

/// A set that the search prefers.
pub(crate) struct OtherSet {
    /// Sets that were tried.
    pub(crate) candidates: usize,
    /// How it came about.
    pub(crate) origin: &'static str,
    /// How the model does with it.
    pub(crate) assessed: Assessment,
    /// What the search measured of it, and of the set given.
    pub(crate) measured: [Measurement; 2],
    /// What the search says.
    pub(crate) text: String,
}

/// Everything that was found.
pub(crate) struct Examination {
    /// The model and its tolerances.
    pub(crate) model: CheckedModel,
    /// The name of the set that was given.
    pub(crate) name: String,
    /// How the model does with it.
    pub(crate) given: Assessment,
    /// Another set.
    pub(crate) other: Recommendation,
}

impl Assessment {
    /// Pairs that differ in a precision, and those of them that are broken.
    pub(crate) fn differing(&self, precision: Precision) -> [usize; 2] {
        let count = |is_meant: &dyn Fn(&ExaminedPair) -> bool| self.pairs.iter().filter(|pair| is_meant(pair)).count();
        [
            count(&|pair| pair.in_precision(precision).total() > 0),
            count(&|pair| pair.in_precision(precision).broken > 0),
        ]
    }

    /// Whether nothing is wrong with the model under this set.
    pub(crate) fn is_safe(&self, precision: Precision) -> bool {
        let [_, broken] = self.differing(precision);
        self.violations.is_empty() && self.overlaps.lost() == 0 && broken == 0 && !self.steps.object()
    }
}

impl Examination {
    /// The assessment under the set that is recommended, if another one is.
    pub(crate) fn recommended(&self) -> Option<&Assessment> {
        match &self.other {
            Recommendation::Other(other) => Some(&other.assessed),
            _ => None,
        }
    }
}

impl Examine {
    pub(crate) fn run(&self) -> Outcome {
        let model = self.model.checked(self.precision)?;
        let dir = self.directory();
        let start = Start::of(false, self.overwrite);
        let mut directory =
            Directory::claim(Claim { dir: &dir, owner: Owner::Examine, start, files: &results::FILES })?;
        let stop = on_ctrl_c()?;
        let pool = rayon::ThreadPoolBuilder::new().num_threads(self.threads).build()?;
        let Some(found) = pool.install(|| self.examine(model, &stop))? else {
            print_note("interrupted: nothing is written, and the same command begins anew");
            return Ok(Verdict::Interrupted);
        };
        found.model.notes.iter().for_each(|note| print_note(note));
        let cases = cases::worst(&found);
        let verdict = verdict::Verdict::of(&found, &cases, &self.model, &dir);
        let written = results::write((&found, &self.model), &verdict, &cases, &mut directory)?;
        self.format.print(|| verdict.text(), || written.document)?;
        print_note(&format!("written to {}: {}", dir.display(), written.names.join(", ")));
        Ok(if verdict.is_safe { Verdict::Passed } else { Verdict::CheckFailed })
    }

    fn directory(&self) -> PathBuf {
        self.out.clone().unwrap_or_else(|| {
            PathBuf::from(format!("reports/{}", bounded(&format!("examine-{}", self.model.file.stem()))))
        })
    }

    /// Does everything; `None` where it was stopped.
    fn examine(&self, model: CheckedModel, stop: &AtomicBool) -> anyhow::Result<Option<Examination>> {
        let name = self.name_of(&model.spec);
        let shapes = model.scene.shapes();
        let [f32, f64] = PRECISIONS.map(|precision| model.spec.derive(&shapes, precision));
        let sets = SubjectSet { name: name.as_str().into(), f32: f32?, f64: f64? };
        let Some(given) = self.assess(&model, &sets, stop)? else { return Ok(None) };
        let Some(other) = self.recommend(&model, &given, stop)? else { return Ok(None) };
        Ok(Some(Examination { model, name, given, other }))
    }

    /// What a set is called: by the preset it is, with a mark where it was changed, or by its file.
    fn name_of(&self, spec: &ToleranceSpec) -> String {
        let changed = if spec.numbers().is_empty() { "" } else { ", changed" };
        spec.preset().map_or("the set given".to_owned(), |preset| format!("{}{changed}", preset.name()))
    }

    /// How the model does with a set; `None` where it was stopped meanwhile.
    fn assess(&self, model: &CheckedModel, sets: &SubjectSet, stop: &AtomicBool) -> anyhow::Result<Option<Assessment>> {
        let shapes = model.scene.shapes();
        let set = sets.of(self.precision).clone();
        let violations = rules::check_scene(&set, &model.scene, self.precision);
        let overlaps = {
            let _stage = Stage::new("overlaps", 0, stop);
            overlaps(&shapes, &set, None)
        };
        let all = overlaps.neighbours();
        let pairs = pairs::examine_all(&shapes, all, sets, &Stage::new("pairs", all.len() as u64, stop));
        let Some(pairs) = pairs.filter(|_| !stop.load(Ordering::SeqCst)) else { return Ok(None) };
        let steps = match self.why_no_steps(model, &overlaps) {
            Some(why) => Steps::Skipped(why),
            None => {
                let count = self.steps.unwrap_or(5);
                let settling = u64::from(model.scene.simulation.control.settle);
                let stage = Stage::new("steps", count + settling, stop);
                match steps::make(&model.scene, &set, self.precision, count, &stage)? {
                    None => return Ok(None),
                    Some(made) => Steps::Made(Box::new(made)),
                }
            }
        };
        Ok(Some(Assessment { set, violations, overlaps, pairs, steps }))
    }

    fn why_no_steps(&self, model: &CheckedModel, overlaps: &Overlaps) -> Option<String> {
        let blocks = model.scene.blocks.len();
        match self.steps {
            Some(0) => Some("none were asked for".to_owned()),
            _ if overlaps.lost() > 0 => {
                let pairs = plural(overlaps.lost(), "pair overlaps", "pairs overlap");
                Some(format!("not made: {pairs} at the start so that contacts cannot hold them"))
            }
            None if blocks > MOST_STEPPED => Some(format!(
                "not made: {blocks} blocks are more than {MOST_STEPPED}; --steps N makes them all the same"
            )),
            _ => None,
        }
    }

    /// Looks for a better set; `None` where it was stopped meanwhile.
    fn recommend(
        &self,
        model: &CheckedModel,
        given: &Assessment,
        stop: &AtomicBool,
    ) -> anyhow::Result<Option<Recommendation>> {
        if let Some(why) = self.why_no_search(model, given) {
            return Ok(Some(Recommendation::Skipped(why)));
        }
        let stage = Stage::new("tolerance sets", self.candidates.into(), stop);
        let evaluator = Evaluator::new(&model.scene, self.precision, SEED, Some(TUNE_STEPS), 0)?;
        let mut search = Search::new(&evaluator, &model.spec, SEED)?;
        while search.tried().len() < self.candidates as usize {
            if stage.is_stopped() {
                return Ok(None);
            }
            search.step()?;
            stage.advance();
        }
        drop(stage);
        let candidates = search.tried().len();
        let best = search.best().map(|best| &search.tried()[best]);
        let Some(best) = best.filter(|best| best.set != given.set) else {
            return Ok(Some(Recommendation::Given { candidates }));
        };
        let sets = SubjectSet { name: "recommended".into(), f32: best.set.clone(), f64: best.set.clone() };
        let Some(assessed) = self.assess(model, &sets, stop)? else { return Ok(None) };
        let file = file_name(&model.file);
        let text = markdown(&file, &evaluator, &search);
        let measured = [best.measurement.clone(), search.tried()[0].measurement.clone()];
        let other = OtherSet { candidates, origin: best.origin.name(), assessed, measured, text };
        Ok(Some(Recommendation::Other(Box::new(other))))
    }

    fn why_no_search(&self, model: &CheckedModel, given: &Assessment) -> Option<String> {
        if self.no_tune {
            return Some("not looked for (--no-tune)".to_owned());
        }
        if given.overlaps.neighbours().is_empty() {
            return Some("not looked for: no two blocks are near one another".to_owned());
        }
        let (shortest, _) = model.extents.shortest();
        let deepest = given.overlaps.worst_lost().and_then(|worst| worst.penetration.depth_m()).unwrap_or(0.0);
        // A tolerance as long as an edge of the model is none.
        (deepest > shortest).then(|| {
            let [deepest, shortest] = [deepest, shortest].map(crate::extents::short);
            format!("not looked for: the deepest overlap, {deepest} m, is longer than the shortest edge, {shortest} m, and no set is meant to hold that")
        })
    }
}

/// A count with its noun.
pub(crate) fn plural(count: usize, one: &str, many: &str) -> String {
    format!("{} {}", grouped(count as u64), if count == 1 { one } else { many })
}

/// The name of a file without its folders.
pub(crate) fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
