//! The pairs on which engine and oracle are compared for every candidate: the scene's neighbours as they stand, and relatives of theirs.

use super::TuneError;
use super::cluster;
use crate::campaign::attribution::{Panel, examine};
use crate::campaign::directed::Rung;
use crate::campaign::families::{Family, Kit, Real, Style};
use crate::campaign::finding::Cause;
use crate::campaign::pairs::{self, Form, PairConfig, SetSource};
use crate::campaign::subject::{Subject, SubjectSet};
use crate::model::{Block, Scene, ToleranceSet};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rayon::prelude::*;
use std::sync::Arc;

/// Neighbouring pairs looked at as they stand, at most.
const STANDING: usize = 384;

/// Batches of sixteen relatives.
const BATCHES: u64 = 12;

/// Pairs that engine and oracle answer differently, with what was looked at. A pair differs when rounding its input changes the exact
/// contacts, or when the engine misses those of the rounded input.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
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
    standing: Vec<(Block, Block)>,
    relatives: Arc<dyn Family>,
    /// Neighbouring pairs of the scene, whether looked at or not.
    pub neighbours: usize,
}

impl Probes {
    /// The neighbours of a scene, or as many of them as are looked at: a choice of the seed.
    ///
    /// # Errors
    /// When there are no neighbours.
    pub fn of(scene: &Scene, seed: u64) -> Result<Probes, TuneError> {
        let blocks: Vec<Block> = scene.blocks.iter().map(|block| block.block.clone()).collect();
        let relatives = Real::neighbours(&blocks).ok_or(TuneError::NoNeighbours)?;
        let mut pairs = cluster::neighbours(scene);
        let neighbours = pairs.len();
        let mut key = *b"rockproof tuner, standing pairs.";
        key[24..].copy_from_slice(&seed.to_le_bytes());
        let mut rng = ChaCha8Rng::from_seed(key);
        let mut kit = Kit::with_style(&mut rng, Style::Grid);
        // The first of a random order (Fisher and Yates).
        for at in 0..pairs.len().min(STANDING) {
            let other = at + kit.below((pairs.len() - at) as u64) as usize;
            pairs.swap(at, other);
        }
        pairs.truncate(STANDING);
        pairs.sort_unstable();
        let standing = pairs.into_iter().map(|[i, j]| (blocks[i].clone(), blocks[j].clone())).collect();
        Ok(Probes { seed, standing, relatives: Arc::new(relatives), neighbours })
    }

    /// Compares the engine of the panel with the oracle under a set.
    pub fn compare(&self, set: &ToleranceSet, panel: &Panel) -> Differences {
        let given = || vec![SubjectSet { name: "candidate".into(), f32: set.clone(), f64: set.clone() }];
        let standing = self.standing.par_iter().map(|(a, b)| {
            let (a, b) = (a.clone(), b.clone());
            let subject = Subject { index: 0, family: "real".into(), form: "standing".into(), a, b, sets: given() };
            let [differs, changed] = look(&subject, panel);
            Differences { standing: [1, differs], changed, ..Differences::default() }
        });
        let config = PairConfig {
            families: vec![Arc::clone(&self.relatives)],
            sets: vec![SetSource::given("candidate", set.clone())],
            sets_per_batch: 1,
            directed_percent: 80,
            ladder_percent: 0,
            shaken_percent: 0,
        };
        let relatives = (0..BATCHES).into_par_iter().flat_map_iter(|batch| {
            pairs::batch(self.seed, batch, &config).into_iter().map(|case| {
                let form = case.form.clone();
                let (index, family) = (case.index, case.family.into());
                let subject = Subject { index, family, form: form.name().into(), a: case.a, b: case.b, sets: given() };
                let [differs, changed] = look(&subject, panel);
                let none = Differences { changed, ..Differences::default() };
                match form {
                    Form::Directed { rung, .. } if is_on_boundary(rung) => {
                        Differences { boundary: [1, differs], ..none }
                    }
                    Form::Directed { .. } => Differences { near: [1, differs], ..none },
                    _ => Differences { moved: [1, differs], ..none },
                }
            })
        });
        let [standing, relatives] = [
            standing.reduce(Differences::default, Differences::add),
            relatives.reduce(Differences::default, Differences::add),
        ];
        standing.add(relatives)
    }
}

fn is_on_boundary(rung: Rung) -> bool {
    match rung {
        Rung::Exact => true,
        Rung::Steps(_, steps) => steps.abs() <= 1,
        Rung::Permille(_) => false,
    }
}

/// Whether the pair differs (1 or 0), and contacts changed by tolerances.
fn look(subject: &Subject, panel: &Panel) -> [u64; 2] {
    let found = examine(subject, panel).findings;
    let changed = found.iter().filter(|finding| finding.cause == Cause::Tolerance).count() as u64;
    [u64::from(found.len() as u64 > changed), changed]
}
