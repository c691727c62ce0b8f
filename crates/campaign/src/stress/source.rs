//! The pairs of the stress set, as a campaign draws them.

use super::axis::{CellKey, cells};
use super::pairs;
use crate::source::{SourceError, set_sources};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rockproof_differential::subject::{PairSource, Subject};
use rockproof_pairs::tolerance_sets::{self, SetSource};

/// Pairs of one batch: of one cell.
const BATCH: u64 = 16;

/// Pairs of each cell unless a campaign says otherwise: if none of so many differs, the share is below 1 % (Wilson).
pub const PAIRS_PER_CELL: u64 = 416;

/// The stress pairs of a seed: batch `n` belongs to cell `n` modulo the number of cells, so that any number of pairs is spread evenly.
#[derive(Debug)]
pub struct StressSource {
    seed: u64,
    cells: Vec<CellKey>,
    sets: Vec<SetSource>,
}

impl StressSource {
    /// The pairs of a seed under the named tolerance sets; `auto` where none is named.
    ///
    /// # Errors
    /// When a set does not exist.
    pub fn new(seed: u64, tolerances: &[String]) -> Result<StressSource, SourceError> {
        let names: Vec<&str> = if tolerances.is_empty() {
            vec![tolerance_sets::NAMES[0]]
        } else {
            tolerances.iter().map(String::as_str).collect()
        };
        let sets = set_sources(&names)?;
        Ok(StressSource { seed, cells: cells(), sets })
    }

    /// As many pairs as give each cell [`PAIRS_PER_CELL`].
    pub fn default_pairs() -> u64 {
        cells().len() as u64 * PAIRS_PER_CELL
    }

    /// As many pairs as give each cell at least `pairs`, in whole batches.
    pub fn pairs_for(pairs: u64) -> u64 {
        cells().len() as u64 * pairs.next_multiple_of(BATCH)
    }

    /// The cell of a batch.
    pub fn cell(&self, batch: u64) -> CellKey {
        self.cells[(batch % self.cells.len() as u64) as usize]
    }
}

impl PairSource for StressSource {
    fn batch_len(&self) -> u64 {
        BATCH
    }

    fn batch(&self, number: u64) -> Vec<Subject> {
        let cell = self.cell(number);
        let family = cell.family();
        let mut rng = generator(self.seed, number);
        (0..BATCH)
            .map(|k| {
                let (a, b) = pairs::pair(&mut rng, cell);
                let sets = self.sets.iter().filter_map(|source| source.derive(&a, &b)).collect();
                let (index, form) = (number * BATCH + k, cell.form.name().into());
                Subject { index, family: family.as_str().into(), form, a, b, sets }
            })
            .collect()
    }
}

/// The generator of one batch: the seed is the key, the batch the stream.
fn generator(seed: u64, batch: u64) -> ChaCha8Rng {
    let mut key = *b"rockproof stress, version 1.....";
    key[24..].copy_from_slice(&seed.to_le_bytes());
    let mut rng = ChaCha8Rng::from_seed(key);
    rng.set_stream(batch);
    rng
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pair_is_a_function_of_seed_and_index() {
        let source = |seed| StressSource::new(seed, &[]).expect("a source");
        let (one, same, other) = (source(5).batch(3), source(5).batch(3), source(6).batch(3));
        let blocks = |subjects: &[Subject]| subjects.iter().map(|s| (s.a.clone(), s.b.clone())).collect::<Vec<_>>();
        assert_eq!(blocks(&one), blocks(&same));
        assert_ne!(blocks(&one), blocks(&other));
        assert_eq!(one[5].index, 3 * BATCH + 5);
        assert!(one.iter().all(|s| s.sets.len() == 1 && &*s.sets[0].name == "auto"));
    }

    #[test]
    fn sets_that_do_not_exist_are_named() {
        let error = StressSource::new(1, &["nothing".to_owned()]).expect_err("no such set");
        assert!(error.to_string().contains("nothing"), "{error}");
    }
}
