//! Times entries against each other on a machine that is busy with other things.
//!
//! The pairs are cut into chunks. In each round every entry does the first chunk, in turn, then every entry the
//! second, and so on: what slows the machine for a while slows all of them. A fast entry does each chunk once untimed
//! first, so that it finds its code and data in the cache, as after preparing a pair; without, most of the time of
//! a prepared pair goes into fetching it, which flatters whoever calculates more. A entry's time for a chunk is the
//! median over the rounds, its time for the sample the sum over the chunks, and a ratio is taken over the chunks that
//! both have done.

use crate::bench_entry::{BenchEntry, CERTIFIED, CERTIFIED_NEARBY, FLOAT, NEARBY, TimedPart};
use crate::sample::{PreparedPair, Sample};
use std::hint::black_box;
use std::time::Instant;

/// How much is timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimingPlan {
    /// Pairs a chunk: enough to drown the clock, few enough to fit into the cache and between two interruptions.
    pub chunk: usize,
    /// Rounds of a fast entry.
    pub rounds: usize,
    /// Rounds of a slow one.
    pub slow_rounds: usize,
    /// A slow entry does one chunk in this many.
    pub slow_every: usize,
}

/// What one entry reached on one sample.
#[derive(Clone, Debug, PartialEq)]
pub struct Timing {
    /// The entry's engine.
    pub engine: &'static str,
    /// How much of the work.
    pub mode: TimedPart,
    /// Pairs timed.
    pub pairs: usize,
    /// Microseconds a pair.
    pub micros: f64,
    /// Its time over that of f64, for the same part of the work on the same pairs; of `certified nearby` over that of `f64 nearby`.
    pub to_f64: f64,
    /// Its time over that of the oracle's fast path, likewise.
    pub to_certified: f64,
}

/// Two exact entries found different numbers of contacts.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{engine} finds {found} contacts in chunk {chunk} of the {sample} pairs, {CERTIFIED} finds {expected}")]
pub struct Disagreement {
    /// The sample.
    pub sample: &'static str,
    /// The chunk.
    pub chunk: usize,
    /// The entry.
    pub engine: &'static str,
    /// Its contacts.
    pub found: usize,
    /// Those of the oracle's fast path.
    pub expected: usize,
}

/// Seconds by chunk; empty where the entry does not do the chunk.
type ChunkTimes = Vec<Vec<f64>>;

/// Times every entry on a sample.
///
/// # Errors
/// When exact entries disagree about the number of contacts: then no time means anything.
pub fn time_interleaved(
    sample: &Sample,
    entries: &[BenchEntry],
    plan: &TimingPlan,
) -> Result<Vec<Timing>, Disagreement> {
    let chunks: Vec<&[PreparedPair]> = sample.pairs.chunks(plan.chunk.max(1)).collect();
    let mut times: Vec<ChunkTimes> = vec![vec![Vec::new(); chunks.len()]; entries.len()];
    for round in 0..plan.rounds.max(1) {
        for (number, chunk) in chunks.iter().enumerate() {
            for turn in 0..entries.len() {
                // Nobody is always first.
                let at = (turn + round + number) % entries.len();
                let entry = &entries[at];
                let takes_part = round < plan.slow_rounds.max(1) && number.is_multiple_of(plan.slow_every.max(1));
                if entry.slow && !takes_part {
                    continue;
                }
                if !entry.slow {
                    black_box(chunk.iter().map(entry.run).sum::<usize>());
                }
                let start = Instant::now();
                let contacts: usize = chunk.iter().map(entry.run).sum();
                times[at][number].push(start.elapsed().as_secs_f64());
                if round == 0 && entry.exact && entry.mode != TimedPart::Preparation {
                    check(sample, number, chunk, entry, contacts)?;
                }
            }
        }
    }
    let medians: Vec<Vec<Option<f64>>> =
        times.into_iter().map(|times| times.into_iter().map(median).collect()).collect();
    let reference = |engine: &str, mode: TimedPart| {
        entries.iter().zip(&medians).find(|(c, _)| c.engine == engine && c.mode == mode).map(|(_, m)| m)
    };
    let figure = |(entry, mine): (&BenchEntry, &Vec<Option<f64>>)| {
        let over = |engine: &str| reference(engine, entry.mode).map_or(f64::NAN, |other| ratio(mine, other));
        let pairs: usize = mine.iter().zip(&chunks).filter(|(m, _)| m.is_some()).map(|(_, chunk)| chunk.len()).sum();
        Timing {
            engine: entry.engine,
            mode: entry.mode,
            pairs,
            micros: mine.iter().flatten().sum::<f64>() * 1e6 / pairs as f64,
            to_f64: over(if entry.engine == CERTIFIED_NEARBY { NEARBY } else { FLOAT }),
            to_certified: over(CERTIFIED),
        }
    };
    Ok(entries.iter().zip(&medians).map(figure).collect())
}

fn check(
    sample: &Sample,
    number: usize,
    chunk: &[PreparedPair],
    entry: &BenchEntry,
    found: usize,
) -> Result<(), Disagreement> {
    let expected: usize = chunk
        .iter()
        .map(|r| rockproof_oracle::Pair::new(&r.exact[0], &r.exact[1]).classify(&r.tolerances).contacts.len())
        .sum();
    let disagreement =
        Disagreement { sample: sample.kind.name(), chunk: number, engine: entry.engine, found, expected };
    if found == expected { Ok(()) } else { Err(disagreement) }
}

/// The middle value, the mean of two of them; `None` of nothing.
pub fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_unstable_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() {
        0 => None,
        n if n % 2 == 1 => Some(values[middle]),
        _ => Some((values[middle - 1] + values[middle]) / 2.0),
    }
}

/// The sum of the one over the sum of the other, over what both have.
fn ratio(mine: &[Option<f64>], other: &[Option<f64>]) -> f64 {
    let both = || mine.iter().zip(other).filter_map(|(m, o)| Some(((*m)?, (*o)?)));
    both().map(|(m, _)| m).sum::<f64>() / both().map(|(_, o)| o).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn median_and_ratio() {
        assert_eq!(median(vec![]), None);
        assert_eq!(median(vec![9.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(vec![4.0, 1.0]), Some(2.5));
        assert_eq!(ratio(&[Some(6.0), None, Some(4.0)], &[Some(2.0), Some(9.0), Some(3.0)]), 2.0);
    }
}
