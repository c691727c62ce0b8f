//! A comparison, batch by batch, on several threads.

use super::compare::{BatchResult, OtherPaths, compare_batch};
use super::paths::Paths;
use super::record::{ComparisonPlan, ComparisonRecord, RecordError};
use rayon::prelude::*;
use rockproof_campaign::run::Ending;
use rockproof_pairs::batch::{BATCH, PairConfig};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// What has been looked at, for whoever shows progress. It counts ahead of what is on disk.
#[derive(Debug, Default)]
pub struct ProgressCounts {
    /// Pairs of the share, those of earlier sessions among them.
    pub pairs: AtomicU64,
    /// Disagreements, likewise.
    pub disagreements: AtomicU64,
}

/// What a comparison needs beside its record.
#[derive(Clone, Copy)]
pub struct Comparison<'c> {
    /// The paths.
    pub paths: &'c dyn Paths,
    /// What the pairs are drawn from.
    pub config: &'c PairConfig,
    /// Worker threads; 0 for one a core. No count depends on it.
    pub threads: usize,
}

/// The stepper in 512 bits is asked without counting in one round of all families in so many: it makes the same comparisons again.
const SETTLED_EVERY: u64 = 8;
/// A commit is made at the end of a chunk when so much time has gone by since the last one: it takes some milliseconds.
const COMMIT_AFTER: Duration = Duration::from_millis(500);
/// A chunk that takes less than this is doubled, for at its end cores wait for one another.
const SHORTEST_CHUNK: Duration = Duration::from_secs(2);
/// A chunk that takes longer than this is halved, for it is what a kill costs.
const LONGEST_CHUNK: Duration = Duration::from_secs(8);
/// Batches of a chunk at most: their results are held together.
const LARGEST_CHUNK: u64 = 1 << 16;

impl Comparison<'_> {
    /// Compares until all pairs of the share are done or `stop` is set. Batches that were begun are ended then, and what is done is committed.
    ///
    /// # Errors
    /// When a file cannot be written. What was committed before stays, and can be gone on from.
    pub fn run(
        &self,
        record: &mut ComparisonRecord,
        stop: &AtomicBool,
        seen: &ProgressCounts,
    ) -> Result<Ending, RecordError> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(self.threads).build()?;
        let plan = record.plan();
        let share = plan.share();
        let stopped = || stop.load(Ordering::SeqCst);
        seen.pairs.store(record.progress().pairs_done, Ordering::Relaxed);
        seen.disagreements.store(record.progress().totals.all().disagreements, Ordering::Relaxed);
        let (mut chunk, mut committed) = (pool.current_num_threads() as u64, Instant::now());
        let mut next = (share.start + record.progress().pairs_done) / BATCH;
        let end = share.end.div_ceil(BATCH);
        while next < end && !stopped() {
            let begun = Instant::now();
            let one = |number| (!stopped()).then(|| self.batch(&plan, number, seen));
            let numbers = next..end.min(next.saturating_add(chunk));
            let done: Vec<Option<BatchResult>> = pool.install(|| numbers.into_par_iter().map(one).collect());
            // What comes after a batch that was not begun is done anew: the pairs done are the first ones.
            let done: Vec<BatchResult> = done.into_iter().map_while(|batch| batch).collect();
            next += done.len() as u64;
            let took = begun.elapsed();
            record.add(done, took.as_secs_f64())?;
            if committed.elapsed() >= COMMIT_AFTER {
                record.commit()?;
                committed = Instant::now();
            }
            chunk = match took {
                _ if took > LONGEST_CHUNK => (chunk / 2).max(pool.current_num_threads() as u64),
                _ if took < SHORTEST_CHUNK => (2 * chunk).min(LARGEST_CHUNK),
                _ => chunk,
            };
        }
        record.commit()?;
        record.write_tables()?;
        Ok(if next < end { Ending::Stopped } else { Ending::Finished })
    }

    fn batch(&self, plan: &ComparisonPlan, number: u64, seen: &ProgressCounts) -> BatchResult {
        // By rounds of all families, so that each of them has its share.
        let round = number / self.config.families.len() as u64;
        let joins = |every: u64| every > 0 && round.is_multiple_of(every);
        let others =
            OtherPaths { settled: joins(SETTLED_EVERY), plain: joins(plan.plain_every), gmp: joins(plan.gmp_every) };
        let result = compare_batch(self.paths, (plan.seed, number), self.config, others);
        seen.pairs.fetch_add(BATCH, Ordering::Relaxed);
        seen.disagreements.fetch_add(result.disagreements.len() as u64, Ordering::Relaxed);
        result
    }
}
