//! Who examines the pairs of a campaign: the threads of this process, or those of other processes ([`crate::distribute`]).

use super::cases::CaseFile;
use super::engine_counts::EngineSums;
use super::journal::{CampaignProgress, Journal, NewRows, ProgressCounts};
use super::run::{BatchResult, Campaign, RunError, Stopped};
use super::steps::{StepFinding, StepSummary};
use super::summary::Summary;
use rayon::prelude::*;
use rockproof_differential::agreement::Agreement;
use rockproof_differential::engine::{EngineCounts, Levels};
use rockproof_differential::finding::Finding;
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;
use std::time::Duration;

/// What some pairs add to the counts of a campaign.
#[derive(Debug, Default)]
pub(super) struct Counts {
    pub(super) summary: Summary,
    pub(super) levels: Levels,
    pub(super) contacts: u64,
    pub(super) metamorphic_checks: u64,
    pub(super) agreement: Agreement,
    pub(super) steps: StepSummary,
}

impl Counts {
    /// Adds the counts of other pairs.
    pub(super) fn add(&mut self, other: Counts) {
        self.summary.add(other.summary);
        self.levels.add(&other.levels);
        self.contacts += other.contacts;
        self.metamorphic_checks += other.metamorphic_checks;
        self.agreement.add(other.agreement);
        self.steps.add(other.steps);
    }

    /// Adds them to what is done.
    pub(super) fn add_to(self, progress: &mut CampaignProgress) {
        progress.summary.add(self.summary);
        let mut levels = Levels(progress.levels);
        levels.add(&self.levels);
        progress.levels = levels.0;
        progress.contacts += self.contacts;
        progress.metamorphic_checks += self.metamorphic_checks;
        progress.agreement.add(self.agreement);
        progress.steps.add(self.steps);
    }
}

/// Rows of a chunk and its case files.
pub(super) type Chosen = Result<Option<(NewRows, Vec<CaseFile>)>, RunError>;

/// Examines chunks of pairs in the order in which they are asked for.
pub(super) trait Examiner {
    /// What was found in a chunk.
    type Found;

    /// So long rows may wait for a commit.
    const COMMIT_AFTER: Duration;

    /// Examines the pairs of a chunk; `None` where the run is stopped meanwhile.
    fn examine(&mut self, pairs: Range<u64>) -> Result<Option<(Counts, Self::Found)>, RunError>;

    /// The rows of what was found and the case files, chosen by what `progress` counts before and counted there. `None` where the run is stopped
    /// meanwhile; what is counted then is to be thrown away.
    fn choose(&mut self, found: Self::Found, progress: &mut CampaignProgress) -> Chosen;

    /// What external engines were put through, in this session and before.
    fn engines(&self) -> BTreeMap<String, EngineCounts>;

    /// What `run.json` says of it.
    fn run_notes(&self) -> Map<String, Value>;
}

/// The threads of this process.
pub(super) struct InProcess<'c> {
    campaign: &'c Campaign<'c>,
    pool: rayon::ThreadPool,
    engines: EngineSums,
    seen: Arc<ProgressCounts>,
    stopped: Stopped<'c>,
}

impl<'c> InProcess<'c> {
    /// Threads that go on with the run of a journal.
    pub(super) fn new(
        campaign: &'c Campaign<'c>,
        journal: &Journal,
        stopped: Stopped<'c>,
    ) -> Result<InProcess<'c>, RunError> {
        let engines = EngineSums::begin(campaign.panel, &journal.progress().engines);
        Ok(InProcess { campaign, pool: campaign.pool()?, engines, seen: journal.seen(), stopped })
    }
}

impl Examiner for InProcess<'_> {
    type Found = (Vec<Finding>, Vec<StepFinding>);

    const COMMIT_AFTER: Duration = Duration::ZERO;

    fn examine(&mut self, pairs: Range<u64>) -> Result<Option<(Counts, Self::Found)>, RunError> {
        let (campaign, batch_len, end) = (self.campaign, self.campaign.source.batch_len(), pairs.end);
        // Added up by the threads as well, neighbours to neighbours, so that findings stay in the order of indices.
        let all: Option<BatchResult> = self.pool.install(|| {
            let numbers = (pairs.start / batch_len..end.div_ceil(batch_len)).into_par_iter();
            let batches = numbers.map(|number| campaign.batch(number, end, &self.seen, self.stopped));
            batches.try_reduce(BatchResult::default, |before, after| Some(before.with(after)))
        });
        Ok(all.map(|all| (all.counts, (all.findings, all.stepped))))
    }

    fn choose(&mut self, (findings, stepped): Self::Found, progress: &mut CampaignProgress) -> Chosen {
        let chosen = self.pool.install(|| self.campaign.chosen(&findings, &stepped, progress, self.stopped))?;
        Ok((!(self.stopped)()).then_some(chosen))
    }

    fn engines(&self) -> BTreeMap<String, EngineCounts> {
        self.engines.totals(self.campaign.panel)
    }

    fn run_notes(&self) -> Map<String, Value> {
        Map::new()
    }
}
