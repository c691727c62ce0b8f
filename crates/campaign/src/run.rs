//! The campaign itself: chunk by chunk, in parallel inside a chunk, results merged in the order of indices.

use super::config::CampaignConfig;
use super::distribute::{DistributeError, WorkerPanic};
use super::engine_counts::{self, ENGINES};
use super::examiner::{Counts, Examiner, InProcess};
use super::journal::{CampaignProgress, Journal, NewRows, ProgressCounts};
use super::merge::MergeError;
use super::part::Part;
use super::steps::{self, StepEngine, StepFinding};
use super::summary::{PairGroup, row_counts};
use rockproof_differential::agreement_record::AgreementRecord;
use rockproof_differential::attribution::{EnginePanel, PairExamination, examine_pair};
use rockproof_differential::engine::{Levels, Shortage};
use rockproof_differential::finding::Finding;
use rockproof_differential::subject::PairSource;
use rockproof_results::ResultsError;
use serde::Serialize;
use serde_json::{Map, Value, json};
use std::ops::Range;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// A campaign ready to run.
pub struct Campaign<'c> {
    /// What to do.
    pub config: &'c CampaignConfig,
    /// Where the pairs come from.
    pub source: &'c dyn PairSource,
    /// The oracle and the engines.
    pub panel: &'c EnginePanel,
    /// A panel with one engine of the given name, or all of a precision: what a shrinker needs.
    pub narrow: &'c (dyn Fn(&Finding) -> EnginePanel + Sync),
    /// What makes the steps of pairs that the source moves; empty for no steps.
    pub steppers: &'c [Box<dyn StepEngine>],
    /// Worker threads; 0 for one a core.
    pub threads: usize,
}

/// How a campaign ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// All pairs are done.
    Finished,
    /// It was told to stop; the journal holds what is done.
    Stopped,
}

/// Why a campaign cannot run.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The directory cannot be used.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// No worker threads.
    #[error("cannot start the worker threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// The pairs done end inside a batch.
    #[error(
        "{dir}: the run ended after {done} pairs, inside a batch of {batch}, and cannot go on to more; one whose pairs are a multiple of {batch} can. --overwrite begins anew"
    )]
    InsideBatch {
        /// The directory.
        dir: String,
        /// Pairs done.
        done: u64,
        /// Pairs of a batch.
        batch: u64,
    },
    /// A table cannot be written.
    #[error("cannot write a table: {0}")]
    Csv(#[from] csv::Error),
    /// A case cannot be written.
    #[error("cannot write a case: {0}")]
    Toml(#[from] toml::ser::Error),
    /// `run.json` cannot be written.
    #[error("cannot write run.json: {0}")]
    Json(#[from] serde_json::Error),
    /// A built-in engine does not exist.
    #[error("engine \"{0}\" does not exist")]
    Engine(String),
    /// A merge has begun in the directory, and has not ended.
    #[error("{dir} is being made of parts: go on with `rockproof merge` and --resume, or use --overwrite or --out DIR")]
    Merging {
        /// The directory.
        dir: PathBuf,
    },
    /// A part, or what is to be made of parts, cannot be used.
    #[error(transparent)]
    Merge(#[from] MergeError),
    /// A worker cannot make a case file.
    #[error("a worker: {0}")]
    Case(String),
    /// A thread of this process panicked.
    #[error(transparent)]
    Panic(#[from] WorkerPanic),
    /// An engine cannot be asked.
    #[error(transparent)]
    Shortage(#[from] Shortage),
    /// The processes of the campaign do not work together.
    #[error(transparent)]
    Distribute(#[from] DistributeError),
}

/// Whether a run was told to stop.
pub(super) type Stopped<'s> = &'s (dyn Fn() -> bool + Sync);

/// What one batch brought.
#[derive(Default)]
pub(super) struct BatchResult {
    pub(super) findings: Vec<Finding>,
    pub(super) stepped: Vec<StepFinding>,
    pub(super) counts: Counts,
}

impl BatchResult {
    /// The same with what later batches brought.
    pub(super) fn with(mut self, later: BatchResult) -> BatchResult {
        self.counts.add(later.counts);
        self.findings.extend(later.findings);
        self.stepped.extend(later.stepped);
        self
    }
}

/// Bytes of rows that wait for a commit at most.
const COMMIT: usize = 4 << 20;

impl Campaign<'_> {
    /// Runs until all pairs are done or `stop` is set, calling `watch` with what is done after each chunk. `stop` is looked at between
    /// pairs; the chunk it comes in is made anew when the run is resumed, so that answers of engines that end together with this program
    /// count for nothing.
    ///
    /// # Errors
    /// When a file cannot be written, or an engine cannot be asked for want of something here. What was committed before stays, and can be
    /// resumed.
    pub fn run(
        &self,
        journal: &mut Journal,
        stop: &AtomicBool,
        watch: &mut dyn FnMut(&CampaignProgress),
    ) -> Result<Ending, RunError> {
        self.work_here(0..self.config.pairs, journal, stop, watch)
    }

    /// The same for a part of the pairs, in a journal that [`Journal::open_part`] opened. No case files are made.
    ///
    /// # Errors
    /// As [`Campaign::run`].
    pub fn run_part(
        &self,
        part: Part,
        journal: &mut Journal,
        stop: &AtomicBool,
        watch: &mut dyn FnMut(&CampaignProgress),
    ) -> Result<Ending, RunError> {
        self.work_here(part.pairs(self.config.pairs, self.source.batch_len()), journal, stop, watch)
    }

    /// Pairs of a chunk, by which the cases are chosen: whole batches.
    pub(super) fn chunk(&self) -> u64 {
        let batch_len = self.source.batch_len();
        self.config.chunk.div_ceil(batch_len).max(1).saturating_mul(batch_len)
    }

    /// Examines a share of the pairs on the threads of this process.
    fn work_here(
        &self,
        share: Range<u64>,
        journal: &mut Journal,
        stop: &AtomicBool,
        watch: &mut dyn FnMut(&CampaignProgress),
    ) -> Result<Ending, RunError> {
        let stopped = || self.is_over(stop);
        let mut examiner = InProcess::new(self, journal, &stopped)?;
        let ending = self.work(share, journal, &stopped, watch, &mut examiner);
        self.panel.check_shortage()?;
        ending
    }

    /// Whether there is no more to do: it was told to stop, or an engine cannot be asked.
    pub(super) fn is_over(&self, stop: &AtomicBool) -> bool {
        stop.load(Ordering::SeqCst) || self.panel.check_shortage().is_err()
    }

    /// Has a share of the pairs examined, chunk by chunk. Chunks begin where they do in the whole campaign.
    pub(super) fn work<E: Examiner>(
        &self,
        share: Range<u64>,
        journal: &mut Journal,
        stopped: Stopped<'_>,
        watch: &mut dyn FnMut(&CampaignProgress),
        examiner: &mut E,
    ) -> Result<Ending, RunError> {
        if journal.progress().merging {
            return Err(RunError::Merging { dir: journal.dir().to_owned() });
        }
        let (done, pairs) = (journal.progress().pairs_done, share.end - share.start);
        if done > pairs {
            return Err(journal.damaged(format!("{done} pairs are done, but only {pairs} are asked for")).into());
        }
        if self.makes_steps() {
            journal.keep_steps()?;
        }
        let mut progress = journal.progress().clone();
        let (before, started) = (progress.seconds, Instant::now());
        let seen = journal.seen();
        let (batch_len, chunk) = (self.source.batch_len(), self.chunk());
        if done < pairs && !done.is_multiple_of(batch_len) {
            let dir = journal.dir().display().to_string();
            return Err(RunError::InsideBatch { dir, done, batch: batch_len });
        }
        let (mut new, mut committed) = (NewRows::default(), Instant::now());
        while progress.pairs_done < pairs && !stopped() {
            let first = share.start + progress.pairs_done;
            let end = (first / chunk + 1).saturating_mul(chunk).min(share.end);
            let Some((counts, found)) = examiner.examine(first..end)? else { break };
            let mut next = progress.clone();
            counts.add_to(&mut next);
            seen.shrinking.store(true, Ordering::Relaxed);
            let Some((rows, cases)) = examiner.choose(found, &mut next)? else { break };
            journal.write_cases(cases)?;
            new.append(rows);
            next.engines = examiner.engines();
            next.pairs_done = end - share.start;
            next.seconds = before + started.elapsed().as_secs_f64();
            progress = next;
            if committed.elapsed() >= E::COMMIT_AFTER || new.bytes() >= COMMIT {
                journal.commit(&std::mem::take(&mut new), progress.clone())?;
                committed = Instant::now();
            }
            seen.shrinking.store(false, Ordering::Relaxed);
            watch(&progress);
        }
        let finished = progress.pairs_done >= pairs;
        if progress.pairs_done > journal.progress().pairs_done {
            journal.commit(&new, progress)?;
        }
        self.write_tables(journal, finished, examiner.run_notes())?;
        Ok(if finished { Ending::Finished } else { Ending::Stopped })
    }

    /// The worker threads.
    pub(super) fn pool(&self) -> Result<rayon::ThreadPool, RunError> {
        Ok(rayon::ThreadPoolBuilder::new().num_threads(self.threads).build()?)
    }

    /// Writes the tables of counts, and `run.json` with what else is to be told in it.
    pub(super) fn write_tables(
        &self,
        journal: &mut Journal,
        finished: bool,
        more: Map<String, Value>,
    ) -> Result<(), RunError> {
        let progress = journal.progress();
        let mut files = vec![
            ("summary.csv", progress.summary.to_csv()?),
            ("agreement.csv", progress.agreement.to_csv()?),
            ("confusion.csv", progress.agreement.confusion_to_csv()?),
        ];
        if self.makes_steps() {
            files.push(("step_summary.csv", progress.steps.to_csv()?));
        }
        if !progress.engines.is_empty() {
            files.push((ENGINES, engine_counts::to_csv(&progress.engines)?));
        }
        let rows = row_counts(&files)?;
        files.push(("run.json", self.run_json(journal, finished, rows, more)?));
        Ok(files.into_iter().try_for_each(|(name, bytes)| journal.write(name, &bytes))?)
    }

    pub(super) fn makes_steps(&self) -> bool {
        !self.steppers.is_empty() && self.config.steps_every > 0 && self.config.steps > 0
    }

    /// One batch; `None` where the run is stopped meanwhile.
    pub(super) fn batch(
        &self,
        number: u64,
        end: u64,
        seen: &ProgressCounts,
        stopped: Stopped<'_>,
    ) -> Option<BatchResult> {
        let mut batch = BatchResult::default();
        let subjects = self.source.batch(number);
        let mut record = AgreementRecord::default();
        for subject in subjects.iter().filter(|s| s.index < end) {
            if stopped() {
                return None;
            }
            for set in &subject.sets {
                batch.counts.summary.add_pair(PairGroup {
                    family: subject.family.to_string(),
                    form: subject.form.to_string(),
                    tolerances: set.name.to_string(),
                });
            }
            let PairExamination { findings, levels, contacts, metamorphic_checks, agreement } =
                examine_pair(subject, self.panel);
            seen.pairs.fetch_add(1, Ordering::Relaxed);
            seen.findings.fetch_add(findings.len() as u64, Ordering::Relaxed);
            for finding in &findings {
                batch.counts.summary.add_finding(finding);
            }
            batch.findings.extend(findings);
            let Counts { levels: sum, contacts: contact_sum, metamorphic_checks: checks, .. } = &mut batch.counts;
            sum.add(&levels);
            *contact_sum += contacts;
            *checks += metamorphic_checks;
            record.add(agreement);
        }
        batch.counts.agreement.add_record(record);
        batch.counts.agreement.close_batch();
        if stopped() {
            return None;
        }
        if self.makes_steps() {
            let moving = subjects.iter().filter(|s| s.index < end);
            let beside = self.source.step_pairs(number);
            let beside = beside.iter().filter(|(s, _)| s.index < end).map(|(s, motion)| (s, motion.clone()));
            let mut moving: Vec<_> = moving.filter_map(|s| Some((s, self.source.motion(s)?))).chain(beside).collect();
            // Rows come in the order of indices; the sort is stable.
            moving.sort_by_key(|(subject, _)| subject.index);
            if !moving.is_empty() {
                let made = steps::examine_all(&moving, self.steppers);
                (batch.counts.steps, batch.stepped) = (made.summary, made.findings);
            }
        }
        Some(batch)
    }

    fn run_json(
        &self,
        journal: &Journal,
        finished: bool,
        table_rows: Map<String, Value>,
        more: Map<String, Value>,
    ) -> Result<Vec<u8>, RunError> {
        let progress = journal.progress();
        let levels: Map<String, Value> =
            Levels::NAMES.iter().zip(progress.levels).map(|(name, count)| ((*name).to_owned(), count.into())).collect();
        let summary = &progress.summary;
        let by_cause: Map<String, Value> = rockproof_differential::finding::Cause::ALL
            .iter()
            .map(|cause| (cause.name().to_owned(), summary.count_of(cause.name()).into()))
            .collect();
        let mut text = json!({
            "version": env!("CARGO_PKG_VERSION"),
            "seed": self.config.seed,
            "configuration": progress.configuration,
            "machine": {
                "os": std::env::consts::OS,
                "architecture": std::env::consts::ARCH,
                "cores": std::thread::available_parallelism().map_or(1, usize::from),
                "threads": self.threads,
            },
            "finished": finished,
            "pairs": progress.pairs_done,
            "contacts": progress.contacts,
            "findings": { "total": summary.total(), "by_cause": by_cause },
            "metamorphic_checks": progress.metamorphic_checks,
            "external_engines": progress.engines,
            "oracle_levels": levels,
            "case_files": progress.cases.values().sum::<u64>(),
            "seconds": progress.seconds,
            "pairs_per_second": progress.pairs_done as f64 / progress.seconds.max(1e-9),
            "resumed": progress.resumed,
            "table_rows": table_rows,
        });
        if self.makes_steps() {
            let counts = progress.steps.by_engine();
            let made: u64 = counts.values().map(|counts| counts.steps).sum();
            text["steps"] = json!({
                "made": made,
                "findings": progress.steps.total(),
                "case_files": progress.step_cases.values().sum::<u64>(),
            });
        }
        for (key, value) in more {
            text[key] = value;
        }
        let mut bytes = serde_json::to_vec_pretty(&text)?;
        bytes.push(b'\n');
        Ok(bytes)
    }
}

/// Rows of `findings.csv` or `step_findings.csv`, each with the case file of its finding.
pub(super) fn rows<F, R: Serialize>(
    findings: &[F],
    names: &[Option<String>],
    row: impl Fn(&F, String) -> R,
) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(Vec::new());
    for (finding, name) in findings.iter().zip(names) {
        writer.serialize(row(finding, name.as_ref().map_or(String::new(), |name| format!("cases/{name}"))))?;
    }
    writer.into_inner().map_err(|e| e.into_error().into())
}
