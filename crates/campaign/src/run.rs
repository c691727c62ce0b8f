//! The campaign itself: chunk by chunk, in parallel inside a chunk, results merged in the order of indices.

use super::config::CampaignConfig;
use super::journal::{Journal, Progress, Seen};
use super::kept::{Counts, Kept, Most, Record, Wish, keep};
use super::shrink::Shrinker;
use super::steps::{self, StepEngine, StepFinding};
use super::summary::{Origin, Summary};
use rayon::prelude::*;
use rockproof_differential::agreement::Agreement;
use rockproof_differential::attribution::{Examined, Panel, examine};
use rockproof_differential::case_file::Case;
use rockproof_differential::engine::{EngineCounts, Levels};
use rockproof_differential::finding::{FAR, Finding};
use rockproof_differential::subject::{Source, Subject};
use rockproof_results::ResultsError;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// A campaign ready to run.
pub struct Campaign<'c> {
    /// What to do.
    pub config: &'c CampaignConfig,
    /// Where the pairs come from.
    pub source: &'c dyn Source,
    /// The oracle and the engines.
    pub panel: &'c Panel,
    /// A panel with one engine of the given name, or all of a precision: what a shrinker needs.
    pub narrow: &'c (dyn Fn(&Finding) -> Panel + Sync),
    /// What makes the steps of pairs that the source moves; empty for no steps.
    pub steppers: &'c [Box<dyn StepEngine>],
    /// Worker threads; 0 for one a core.
    pub threads: usize,
}

/// Of findings about steps one case is kept where of others so many are: they are larger, and each is a step made some ten times.
const STEP_CASES: u64 = 4;

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
}

/// The table of what external engines were put through; only where there are any.
pub const ENGINES: &str = "engines.csv";

/// A row of it; the fields are its columns.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct EngineRow {
    /// The engine.
    pub engine: String,
    /// Questions asked.
    pub asked: u64,
    /// Processes started.
    pub processes_started: u64,
    /// Failures that a fresh process did not repeat.
    pub recovered: u64,
    /// Answers that nothing exact stands against.
    pub not_compared: u64,
}

/// Whether a run was told to stop.
type Stopped<'s> = &'s (dyn Fn() -> bool + Sync);

/// What one batch brought.
#[derive(Default)]
struct Batch {
    findings: Vec<Finding>,
    summary: Summary,
    levels: Levels,
    contacts: u64,
    metamorphic_checks: u64,
    agreement: Agreement,
    steps: steps::Examined,
}

impl Campaign<'_> {
    /// Runs until all pairs are done or `stop` is set, calling `watch` with what is done after each chunk. `stop` is looked at between
    /// pairs; the chunk it comes in is made anew when the run is resumed, so that answers of engines that end together with this program
    /// count for nothing.
    ///
    /// # Errors
    /// When a file cannot be written. What was committed before stays, and can be resumed.
    pub fn run(
        &self,
        journal: &mut Journal,
        stop: &AtomicBool,
        watch: &mut dyn FnMut(&Progress),
    ) -> Result<Ending, RunError> {
        let (done, pairs) = (journal.progress().pairs_done, self.config.pairs);
        if done > pairs {
            return Err(journal.damaged(format!("{done} pairs are done, but only {pairs} are asked for")).into());
        }
        let pool = rayon::ThreadPoolBuilder::new().num_threads(self.threads).build()?;
        if self.makes_steps() {
            journal.keep_steps()?;
        }
        let before = journal.progress().seconds;
        let (engines_before, engines_at_start) = (journal.progress().engines.clone(), self.engine_counts());
        let stopped = || stop.load(Ordering::SeqCst);
        let started = Instant::now();
        let seen = journal.seen();
        let batch_len = self.source.batch_len();
        if done < pairs && !done.is_multiple_of(batch_len) {
            let dir = journal.dir().display().to_string();
            return Err(RunError::InsideBatch { dir, done, batch: batch_len });
        }
        let chunk = self.config.chunk.div_ceil(batch_len).max(1) * batch_len;
        while journal.progress().pairs_done < self.config.pairs && !stopped() {
            let first = journal.progress().pairs_done;
            let end = (first + chunk).min(self.config.pairs);
            let batches: Option<Vec<Batch>> = pool.install(|| {
                let numbers = (first / batch_len..end.div_ceil(batch_len)).into_par_iter();
                numbers.map(|n| self.batch(n, end, &seen, &stopped)).collect()
            });
            let Some(batches) = batches else { break };
            let mut progress = journal.progress().clone();
            let (mut findings, mut stepped) = (Vec::new(), Vec::new());
            for batch in batches {
                progress.summary.add(batch.summary);
                let mut levels = Levels(progress.levels);
                levels.add(&batch.levels);
                progress.levels = levels.0;
                progress.contacts += batch.contacts;
                progress.metamorphic_checks += batch.metamorphic_checks;
                progress.agreement.add(batch.agreement);
                findings.extend(batch.findings);
                progress.steps.add(batch.steps.summary);
                stepped.extend(batch.steps.findings);
            }
            seen.shrinking.store(true, Ordering::Relaxed);
            let kept = pool.install(|| self.keep_cases(&findings, &mut progress, &stopped))?;
            let finding_rows = rows(&findings, &kept.names, Finding::row)?;
            let kept_steps = pool.install(|| self.keep_step_cases(&stepped, &mut progress, &stopped))?;
            let step_rows = rows(&stepped, &kept_steps.names, StepFinding::row)?;
            if stopped() {
                break;
            }
            journal.write_cases(kept.files)?;
            journal.write_cases(kept_steps.files)?;
            for (name, now) in self.engine_counts() {
                let since = engines_at_start.get(&name).map_or(now, |start| now.since(start));
                let sum = engines_before.get(&name).map_or(since, |before| before.plus(&since));
                progress.engines.insert(name, sum);
            }
            progress.pairs_done = end;
            progress.seconds = before + started.elapsed().as_secs_f64();
            journal.commit(&finding_rows, &step_rows, progress)?;
            seen.shrinking.store(false, Ordering::Relaxed);
            watch(journal.progress());
        }
        let finished = journal.progress().pairs_done >= self.config.pairs;
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
            files.push((ENGINES, engines_to_csv(&progress.engines)?));
        }
        files.push(("run.json", self.run_json(journal, finished)?));
        files.into_iter().try_for_each(|(name, bytes)| journal.write(name, &bytes))?;
        Ok(if finished { Ending::Finished } else { Ending::Stopped })
    }

    fn makes_steps(&self) -> bool {
        !self.steppers.is_empty() && self.config.steps_every > 0 && self.config.steps > 0
    }

    /// What its external engines were put through since the program began.
    fn engine_counts(&self) -> BTreeMap<String, EngineCounts> {
        self.panel.engines.iter().filter_map(|e| Some((e.name().to_owned(), e.counts()?))).collect()
    }

    /// One batch; `None` where the run is stopped meanwhile.
    fn batch(&self, number: u64, end: u64, seen: &Seen, stopped: Stopped<'_>) -> Option<Batch> {
        let mut batch = Batch::default();
        let subjects = self.source.batch(number);
        for subject in subjects.iter().filter(|s| s.index < end) {
            if stopped() {
                return None;
            }
            for set in &subject.sets {
                batch.summary.add_pair(Origin {
                    family: subject.family.to_string(),
                    form: subject.form.to_string(),
                    tolerances: set.name.to_string(),
                });
            }
            let Examined { findings, levels, contacts, metamorphic_checks, agreement } = examine(subject, self.panel);
            seen.pairs.fetch_add(1, Ordering::Relaxed);
            seen.findings.fetch_add(findings.len() as u64, Ordering::Relaxed);
            for finding in &findings {
                batch.summary.add_finding(finding);
            }
            batch.findings.extend(findings);
            batch.levels.add(&levels);
            batch.contacts += contacts;
            batch.metamorphic_checks += metamorphic_checks;
            batch.agreement.add(agreement);
        }
        batch.agreement.close_batch();
        if stopped() {
            return None;
        }
        if self.makes_steps() {
            let moving = subjects.iter().filter(|s| s.index < end);
            let beside = self.source.step_pairs(number);
            let beside = beside.iter().filter(|(s, _)| s.index < end).map(|(s, motion)| (s, motion.clone()));
            let moving: Vec<_> = moving.filter_map(|s| Some((s, self.source.motion(s)?))).chain(beside).collect();
            if !moving.is_empty() {
                batch.steps = steps::examine_all(&moving, self.steppers);
            }
        }
        Some(batch)
    }

    /// Keeps case files of findings: the first few of each fingerprint. None is made any more where the run is stopped.
    fn keep_cases(
        &self,
        findings: &[Finding],
        progress: &mut Progress,
        stopped: Stopped<'_>,
    ) -> Result<Kept, RunError> {
        let wish = |finding: &Finding| {
            let fingerprint = finding.fingerprint();
            let name = format!("{}.toml", fingerprint.file_stem(&finding.set, finding.index));
            let far = finding.margin_ulps().map(f64::abs).filter(|ulps| *ulps > FAR);
            let record = far.map(|ulps| Record {
                key: format!("furthest {} {}", finding.who, finding.cause),
                decade: ulps.log10().floor() as u64,
            });
            Wish { fingerprint: fingerprint.text(), cause: finding.cause.name(), name, record }
        };
        let most = Most { of_cause: self.config.cases_per_cause, alike: self.config.cases_per_fingerprint };
        let counts = Counts { alike: &mut progress.fingerprints, of_cause: &mut progress.cases };
        keep(findings, wish, most, counts, |finding| if stopped() { Ok(None) } else { self.case(finding) })
    }

    /// The same of findings about steps.
    fn keep_step_cases(
        &self,
        findings: &[StepFinding],
        progress: &mut Progress,
        stopped: Stopped<'_>,
    ) -> Result<Kept, RunError> {
        let wish = |finding: &StepFinding| Wish {
            fingerprint: finding.fingerprint(),
            cause: finding.cause.name(),
            name: finding.file_name(),
            record: None,
        };
        let of_cause = self.config.cases_per_cause / STEP_CASES;
        let most = Most { of_cause, alike: self.config.cases_per_fingerprint };
        let counts = Counts { alike: &mut progress.step_fingerprints, of_cause: &mut progress.step_cases };
        keep(findings, wish, most, counts, |finding| if stopped() { Ok(None) } else { self.step_case(finding) })
    }

    /// The subject of a pair.
    fn subject(&self, index: u64) -> Option<Subject> {
        let subjects = self.source.batch(index / self.source.batch_len());
        subjects.into_iter().find(|subject| subject.index == index)
    }

    /// The case file of a finding, made small; none where the pair alone does not show the finding again.
    fn case(&self, finding: &Finding) -> Result<Option<Vec<u8>>, RunError> {
        let panel = (self.narrow)(finding);
        let case = self.subject(finding.index).and_then(|s| Case::of(finding, &s, self.config.seed, &panel));
        let Some(case) = case else { return Ok(None) };
        Ok(Some(Shrinker::new(&panel, self.config.shrink_evaluations).shrink(case).to_toml()?.into_bytes()))
    }

    /// The case file of a finding about a step; none where the oracle's step ends in a stop, so that there is no answer to record, or where
    /// the step does not show the finding again.
    fn step_case(&self, finding: &StepFinding) -> Result<Option<Vec<u8>>, RunError> {
        let Some((subject, motion)) = self.source.moving(finding.index, &finding.family) else { return Ok(None) };
        let case = steps::case::of(finding, &subject, &motion, self.steppers);
        Ok(case.map(|case| case.text()).transpose()?)
    }

    fn run_json(&self, journal: &Journal, finished: bool) -> Result<Vec<u8>, RunError> {
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
        let mut bytes = serde_json::to_vec_pretty(&text)?;
        bytes.push(b'\n');
        Ok(bytes)
    }
}

/// `engines.csv`: a row for each external engine.
fn engines_to_csv(engines: &BTreeMap<String, EngineCounts>) -> Result<Vec<u8>, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for (name, counts) in engines {
        let EngineCounts { asked, processes_started, recovered, not_compared } = *counts;
        writer.serialize(EngineRow { engine: name.clone(), asked, processes_started, recovered, not_compared })?;
    }
    writer.into_inner().map_err(|e| e.into_error().into())
}

/// Rows of `findings.csv` or `step_findings.csv`, each with the case file of its finding.
fn rows<F, R: Serialize>(
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
