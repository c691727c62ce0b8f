//! How many pairs a second a whole campaign examines: generation, both engines, the oracle on exact and rounded input,
//! comparison, metamorphic checks and the journal.

use crate::sample::SampleKind;
use rockproof_campaign::config::CampaignConfig;
use rockproof_campaign::journal::Journal;
use rockproof_campaign::run::{Campaign, RunError};
use rockproof_campaign::source::SourceError;
use rockproof_differential::attribution::{EnginePanel, examine_pair};
use rockproof_differential::builtin::{self, ENGINES};
use rockproof_differential::finding::Finding;
use rockproof_differential::subject::{PairSource, Subject};
use rockproof_pairs::batch::{self, PairConfig};
use rockproof_results::{Owner, ResultsError, Start};
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::sync::{Mutex, PoisonError};

/// What is run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ThroughputRun {
    /// Which pairs.
    pub kind: SampleKind,
    /// Seed of all pairs.
    pub seed: u64,
    /// How many pairs, before those with findings are left out.
    pub pairs: u64,
    /// Worker threads.
    pub threads: usize,
    /// Whether pairs with findings are left out, found by a run before that is not timed.
    pub only_alike: bool,
    /// How often; the median counts.
    pub times: usize,
}

/// What it reached.
#[derive(Clone, Debug, PartialEq)]
pub struct Throughput {
    /// What was run.
    pub run: ThroughputRun,
    /// Pairs examined each time.
    pub pairs: u64,
    /// Pairs, times the tolerance sets of each.
    pub examined: u64,
    /// Findings each time.
    pub findings: u64,
    /// Pairs with at least one finding.
    pub pairs_with_findings: u64,
    /// Pairs a second, of the median run.
    pub pairs_per_second: f64,
    /// Signs the oracle decided a pair.
    pub signs_per_pair: f64,
}

/// Why there is no figure.
#[derive(Debug, thiserror::Error)]
pub enum ThroughputError {
    /// The pairs cannot be made.
    #[error(transparent)]
    Source(#[from] SourceError),
    /// The journal of the campaign cannot be kept.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// The campaign ended with an error.
    #[error(transparent)]
    Run(#[from] RunError),
    /// There is no such engine.
    #[error("engine \"{0}\" does not exist")]
    Engine(String),
    /// The directory of the journal cannot be made or removed.
    #[error("{directory}: {source}")]
    Directory {
        /// The directory.
        directory: PathBuf,
        /// What went wrong.
        source: std::io::Error,
    },
}

/// The pairs of a kind, without those left out.
struct CleanPairs {
    seed: u64,
    config: PairConfig,
    left_out: HashSet<u64>,
}

impl PairSource for CleanPairs {
    fn batch_len(&self) -> u64 {
        batch::BATCH
    }

    fn batch(&self, number: u64) -> Vec<Subject> {
        let cases = batch::batch(self.seed, number, &self.config);
        cases.into_iter().filter(|case| !self.left_out.contains(&case.index)).map(Subject::from).collect()
    }
}

/// A source that notes which pairs have findings.
struct FindingCollector<'p> {
    pairs: &'p CleanPairs,
    panel: &'p EnginePanel,
    found: Mutex<HashSet<u64>>,
}

impl PairSource for FindingCollector<'_> {
    fn batch_len(&self) -> u64 {
        self.pairs.batch_len()
    }

    fn batch(&self, number: u64) -> Vec<Subject> {
        let subjects = self.pairs.batch(number);
        let differ = subjects.iter().filter(|s| !examine_pair(s, self.panel).findings.is_empty()).map(|s| s.index);
        let differ: Vec<u64> = differ.collect();
        self.found.lock().unwrap_or_else(PoisonError::into_inner).extend(differ);
        Vec::new()
    }
}

/// Runs campaigns with both built-in engines and the default sets, their journals in a directory of their own under
/// `scratch`, which is removed. No case files are written: shrinking is no part of the figure.
///
/// # Errors
/// When a campaign cannot run.
pub fn throughput(run: &ThroughputRun, scratch: &Path) -> Result<Throughput, ThroughputError> {
    let names = ENGINES.map(str::to_owned);
    let config = CampaignConfig {
        pairs: run.pairs,
        seed: run.seed,
        engines: names.to_vec(),
        cases_per_fingerprint: 0,
        // Otherwise the finding furthest from a tie has a case file.
        cases_per_cause: 0,
        ..CampaignConfig::default()
    };
    let panel = builtin::panel(&names, config.metamorphic_every).map_err(ThroughputError::Engine)?;
    let mut pairs = CleanPairs { seed: run.seed, config: run.kind.config()?, left_out: HashSet::new() };
    let narrow = |finding: &Finding| builtin::panel_for(&names, finding);
    let go = |source: &dyn PairSource| {
        in_directory(scratch, |directory| {
            let mut journal = Journal::open_for(Owner::Bench, directory, serde_json::Map::new(), Start::Overwrite)?;
            let campaign = Campaign {
                config: &config,
                source,
                panel: &panel,
                narrow: &narrow,
                steppers: &[],
                threads: run.threads,
            };
            campaign.run(&mut journal, &AtomicBool::new(false), &mut |_| {})?;
            Ok(journal.progress().clone())
        })
    };
    let noting = FindingCollector { pairs: &pairs, panel: &panel, found: Mutex::default() };
    go(&noting)?;
    let found = noting.found.into_inner().unwrap_or_else(PoisonError::into_inner);
    let pairs_with_findings = found.len() as u64;
    if run.only_alike {
        pairs.left_out = found;
    }
    let count = run.pairs - pairs.left_out.len() as u64;
    let mut seconds = Vec::new();
    let mut last = go(&pairs)?;
    seconds.push(last.seconds);
    for _ in 1..run.times {
        last = go(&pairs)?;
        seconds.push(last.seconds);
    }
    let seconds = super::time_interleaved::median(seconds).unwrap_or(f64::NAN);
    Ok(Throughput {
        run: *run,
        pairs: count,
        examined: last.summary.by_family().values().map(|[examined, _]| examined).sum(),
        findings: last.summary.total(),
        pairs_with_findings,
        pairs_per_second: count as f64 / seconds,
        signs_per_pair: last.levels.iter().sum::<u64>() as f64 / count.max(1) as f64,
    })
}

/// Calls `work` with a new directory, and removes it whatever happens.
fn in_directory<T>(
    scratch: &Path,
    work: impl FnOnce(&Path) -> Result<T, ThroughputError>,
) -> Result<T, ThroughputError> {
    let at = |source| ThroughputError::Directory { directory: scratch.to_owned(), source };
    let directory = tempfile::Builder::new().prefix("rockproof-bench-").tempdir_in(scratch).map_err(at)?;
    let result = work(directory.path());
    directory.close().map_err(at)?;
    result
}

#[cfg(test)]
mod tests {
    use super::in_directory;
    use std::fs;

    #[test]
    fn a_directory_of_others_is_neither_used_nor_removed() {
        let scratch = tempfile::tempdir().unwrap();
        let theirs = scratch.path().join(format!("rockproof-bench-{}", std::process::id()));
        fs::create_dir(&theirs).unwrap();
        let used = in_directory(scratch.path(), |directory| Ok(directory.to_owned())).unwrap();
        assert!(used != theirs && used.starts_with(scratch.path()) && !used.exists());
        assert!(theirs.exists());
    }
}
