//! The pairs on which engine and oracle are compared for every candidate: the scene's neighbours as they stand, and perturbed copies of them.

use super::TuneError;
use super::cluster;
use super::pair_check::{CheckedSet, PairCheck, PairChecker};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rayon::prelude::*;
use rockproof_differential::engine::Engine;
use rockproof_model::{Block, Precision, Scene, ToleranceSet};
use rockproof_pairs::batch::{self, PairConfig, PairForm, SetSource};
use rockproof_pairs::directed::Rung;
use rockproof_pairs::families::{CoordinateStyle, Family, PairSampler, RealNeighbours};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Neighbouring pairs looked at as they stand, at most.
const STANDING: usize = 384;

/// Batches of sixteen perturbed pairs.
const BATCHES: u64 = 12;

/// Pairs that engine and oracle answer differently, with what was looked at. A pair differs when rounding its input changes the exact
/// contacts, or when the engine misses those of the rounded input.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Differences {
    /// Neighbours as they stand: examined, and different.
    pub standing: [u64; 2],
    /// Neighbours moved at random.
    pub moved: [u64; 2],
    /// Neighbours moved beside the boundary of a decision: by 2 steps of the number format up to a tenth of the search distance.
    pub near: [u64; 2],
    /// Neighbours moved onto the boundary, or one step beside it. There rounding the input decides, whatever the tolerances.
    pub boundary: [u64; 2],
    /// Contacts that the tolerances add, remove or change, compared with nearest features alone, in all of these pairs.
    pub changed: u64,
}

impl Differences {
    /// Pairs that differ and that a tolerance set can do something about: all but those on a boundary.
    pub fn avoidable(&self) -> u64 {
        self.standing[1] + self.moved[1] + self.near[1]
    }

    /// Pairs of these sorts that were examined.
    pub fn examined(&self) -> u64 {
        self.standing[0] + self.moved[0] + self.near[0]
    }

    fn add(mut self, other: Differences) -> Differences {
        let sorts = [
            (&mut self.standing, other.standing),
            (&mut self.moved, other.moved),
            (&mut self.near, other.near),
            (&mut self.boundary, other.boundary),
        ];
        for (sum, [examined, different]) in sorts {
            sum[0] += examined;
            sum[1] += different;
        }
        self.changed += other.changed;
        self
    }
}

/// The pairs of one scene.
pub struct Probes {
    seed: u64,
    precision: Precision,
    standing: Vec<PairChecker>,
    perturbed: Arc<dyn Family>,
    /// Neighbouring pairs of the scene, whether looked at or not.
    pub neighbours: usize,
}

impl Probes {
    /// The neighbours of a scene, or as many of them as are looked at: a choice of the seed.
    ///
    /// # Errors
    /// When there are no neighbours.
    pub fn of(scene: &Scene, precision: Precision, seed: u64) -> Result<Probes, TuneError> {
        let blocks: Vec<Block> = scene.blocks.iter().map(|block| block.block.clone()).collect();
        let perturbed = RealNeighbours::neighbours(&blocks).ok_or(TuneError::NoNeighbours)?;
        let mut pairs = cluster::neighbours(scene);
        let neighbours = pairs.len();
        let mut key = *b"rockproof tuner, standing pairs.";
        key[24..].copy_from_slice(&seed.to_le_bytes());
        let mut rng = ChaCha8Rng::from_seed(key);
        let mut sampler = PairSampler::with_style(&mut rng, CoordinateStyle::Grid);
        // The first of a random order (Fisher and Yates).
        for at in 0..pairs.len().min(STANDING) {
            let other = at + sampler.below((pairs.len() - at) as u64) as usize;
            pairs.swap(at, other);
        }
        pairs.truncate(STANDING);
        pairs.sort_unstable();
        let standing =
            pairs.into_par_iter().map(|[i, j]| PairChecker::new(&blocks[i], &blocks[j], precision)).collect();
        Ok(Probes { seed, precision, standing, perturbed: Arc::new(perturbed), neighbours })
    }

    /// Compares an engine of the precision with the oracle under a set.
    ///
    /// # Errors
    /// The name of a tolerance that overflows in the precision.
    pub fn compare(&self, set: &ToleranceSet, engine: &dyn Engine) -> Result<Differences, &'static str> {
        let sets = CheckedSet::new(set, self.precision)?;
        let standing = self.standing.par_iter().map(|pair| {
            let PairCheck { differs, changed } = pair.check(&sets, engine);
            Differences { standing: [1, differs.into()], changed, ..Differences::default() }
        });
        let config = PairConfig {
            families: vec![Arc::clone(&self.perturbed)],
            sets: vec![SetSource::constant("candidate", set.clone())],
            sets_per_batch: 1,
            directed_percent: 80,
            ladder_percent: 0,
            perturbed_percent: 0,
        };
        let perturbed = (0..BATCHES).into_par_iter().flat_map_iter(|batch| {
            batch::batch(self.seed, batch, &config).into_iter().map(|case| {
                let PairCheck { differs, changed } =
                    PairChecker::new(&case.a, &case.b, self.precision).check(&sets, engine);
                let none = Differences { changed, ..Differences::default() };
                let differs = differs.into();
                match case.form {
                    PairForm::Directed { rung, .. } if is_on_boundary(rung) => {
                        Differences { boundary: [1, differs], ..none }
                    }
                    PairForm::Directed { .. } => Differences { near: [1, differs], ..none },
                    _ => Differences { moved: [1, differs], ..none },
                }
            })
        });
        let [standing, perturbed] = [
            standing.reduce(Differences::default, Differences::add),
            perturbed.reduce(Differences::default, Differences::add),
        ];
        Ok(standing.add(perturbed))
    }
}

fn is_on_boundary(rung: Rung) -> bool {
    match rung {
        Rung::Exact => true,
        Rung::Steps(_, steps) => steps.abs() <= 1,
        Rung::Permille(_) => false,
    }
}
