//! Which pairs are handed out together.

use std::ops::Range;

/// What a unit should take its worker, in seconds: long beside what a message costs, short beside a campaign.
const SECONDS: f64 = 1.0;

/// Pairs that are handed out and not yet written, at most; what is found in them waits in the memory of rank 0, some 300 bytes a pair.
const AHEAD: u64 = 4 << 20;

/// Units that a worker has at once: while one is on its way, it works at another.
pub(super) const UNITS_PER_WORKER: usize = 2;

/// Units that are handed out and not yet written, for each worker at most.
pub(super) const WINDOW: usize = 2 * UNITS_PER_WORKER;

/// Cuts pairs into units: whole batches of one chunk, as many as take their worker about as long as any other, fewer towards the end.
#[derive(Debug)]
pub(super) struct Plan {
    rest: Range<u64>,
    batch: u64,
    chunk: u64,
    workers: u64,
}

impl Plan {
    pub(super) fn new(pairs: Range<u64>, batch: u64, chunk: u64, workers: usize) -> Plan {
        Plan { rest: pairs, batch, chunk, workers: workers.max(1) as u64 }
    }

    /// The next unit for a worker of so many threads that has examined so many pairs a second; a first one is for a batch a thread.
    pub(super) fn next(&mut self, threads: usize, rate: Option<f64>) -> Option<Range<u64>> {
        let Range { start, end } = self.rest;
        if start >= end {
            return None;
        }
        let asked = rate.map_or(threads as u64 * self.batch, |rate| (rate * SECONDS) as u64);
        let fair = (end - start) / (UNITS_PER_WORKER as u64 * self.workers);
        let held = AHEAD / (WINDOW as u64 * self.workers);
        let batches = (asked.min(fair).min(held) / self.batch).max(1);
        let chunk_end = (start / self.chunk + 1).saturating_mul(self.chunk);
        let unit_end = start.saturating_add(batches * self.batch).min(chunk_end).min(end);
        self.rest.start = unit_end;
        Some(start..unit_end)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_whole_batches_of_one_chunk_and_every_pair_is_in_one() {
        for (pairs, rate) in [(0..1000, None), (64..203, Some(3.0)), (4096..100_000, Some(900.0)), (0..0, None)] {
            let mut plan = Plan::new(pairs.clone(), 16, 4096, 3);
            let mut next = pairs.start;
            while let Some(unit) = plan.next(4, rate) {
                assert_eq!(unit.start, next);
                assert!(unit.end == pairs.end || unit.end % 16 == 0, "{unit:?}");
                assert_eq!(unit.start / 4096, (unit.end - 1) / 4096, "{unit:?} is of two chunks");
                next = unit.end;
            }
            assert_eq!(next, pairs.end.max(pairs.start));
        }
    }

    #[test]
    fn a_unit_is_as_large_as_its_worker_is_fast_and_small_at_the_end() {
        let mut plan = Plan::new(0..1_000_000, 16, 100_000, 2);
        let lengths = [(1, None), (64, None), (1, Some(160.0)), (64, Some(40_000.0))]
            .map(|(threads, rate)| plan.next(threads, rate).map(|unit| unit.end - unit.start));
        assert_eq!(lengths, [16, 1024, 160, 40_000].map(Some));
        let mut last = Plan::new(0..640, 16, 4096, 4);
        assert_eq!(last.next(64, Some(40_000.0)), Some(0..80), "an eighth of the rest");
        // However fast: what many workers find must not fill the memory.
        let mut many = Plan::new(0..u64::MAX, 16, u64::MAX / 2, 1000);
        assert_eq!(many.next(64, Some(1e9)), Some(0..1040));
    }
}
