//! Ordinary pairs in other units.

use super::{CoordinateStyle, Family, PairSampler};
use crate::shapes::lattice_solid::number_of;
use rand_chacha::ChaCha8Rng;
use rockproof_model::{Block, ContactKind, Number};
use std::sync::Arc;

#[derive(Debug)]
pub(super) struct UnitScale {
    families: Vec<Arc<dyn Family>>,
}

impl UnitScale {
    pub(super) fn new(families: Vec<Arc<dyn Family>>) -> UnitScale {
        UnitScale { families }
    }
}

impl Family for UnitScale {
    fn name(&self) -> &'static str {
        "unit_scale"
    }

    fn describe(&self) -> &'static str {
        "a pair of another family in millimetres, kilometres or scaled by a power of two"
    }

    fn reaches(&self) -> &'static [ContactKind] {
        &ContactKind::ALL
    }

    fn generate(&self, rng: &mut ChaCha8Rng) -> (Block, Block) {
        let mut sampler = PairSampler::with_style(rng, CoordinateStyle::Grid);
        let family = Arc::clone(sampler.pick(&self.families));
        let factor = match sampler.below(8) {
            0 => number_of(1000, 1, 0),
            1 => number_of(1, 1000, 0),
            2 => number_of(1_000_000, 1, 0),
            3 => number_of(3, 1, -2),
            4 => number_of(1, 1, sampler.between(-40, 40) as i32),
            _ => number_of(1, 1, sampler.between(-16, 16) as i32),
        };
        let (a, b) = family.generate(rng);
        (scaled(&a, &factor), scaled(&b, &factor))
    }
}

/// The block with every coordinate multiplied by a positive factor.
fn scaled(block: &Block, factor: &Number) -> Block {
    block.with_vertices(block.vertices().iter().map(|v| v.map(|c| c.times(factor))).collect())
}
