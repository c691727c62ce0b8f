//! A campaign without a directory: what it finds stays in memory, for programs that go on from there.

use super::journal::ProgressCounts;
use super::run::{BatchResult, Campaign, RunError};
use super::summary::Summary;
use rayon::prelude::*;
use rockproof_differential::finding::Finding;
use std::sync::atomic::AtomicBool;

/// What a campaign in memory brought.
#[derive(Debug, Default)]
pub struct CampaignOutcome {
    /// The findings, in the order of the pairs.
    pub findings: Vec<Finding>,
    /// Counts of pairs and findings.
    pub summary: Summary,
    /// Contacts in the exact answers.
    pub contacts: u64,
    /// Metamorphic checks made.
    pub metamorphic_checks: u64,
}

impl Campaign<'_> {
    /// Examines all pairs, as [`Campaign::run`] does, and keeps the findings in memory; no steps are told of and no case files made. `None` where
    /// `stop` is set before the end; it is looked at between pairs. What has been looked at is counted in `seen`.
    ///
    /// # Errors
    /// When there are no worker threads, or an engine cannot be asked for want of something here.
    pub fn examine(&self, stop: &AtomicBool, seen: &ProgressCounts) -> Result<Option<CampaignOutcome>, RunError> {
        let stopped = || self.is_over(stop);
        let (batch_len, pairs) = (self.source.batch_len(), self.config.pairs);
        let batches: Option<Vec<BatchResult>> = self.pool()?.install(|| {
            let numbers = (0..pairs.div_ceil(batch_len)).into_par_iter();
            numbers.map(|number| self.batch(number, pairs, seen, &stopped)).collect()
        });
        self.panel.check_shortage()?;
        Ok(batches.map(|batches| {
            let mut all = CampaignOutcome::default();
            for batch in batches {
                all.findings.extend(batch.findings);
                all.summary.add(batch.counts.summary);
                all.contacts += batch.counts.contacts;
                all.metamorphic_checks += batch.counts.metamorphic_checks;
            }
            all
        }))
    }
}
