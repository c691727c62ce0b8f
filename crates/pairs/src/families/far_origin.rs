//! Ordinary pairs far from the origin.

use super::{CoordinateStyle, Family, PairSampler};
use rand_chacha::ChaCha8Rng;
use rockproof_model::{Block, ContactKind, Number, Vec3};
use std::sync::Arc;

#[derive(Debug)]
pub(super) struct FarOrigin {
    families: Vec<Arc<dyn Family>>,
}

impl FarOrigin {
    pub(super) fn new(families: Vec<Arc<dyn Family>>) -> FarOrigin {
        FarOrigin { families }
    }
}

impl Family for FarOrigin {
    fn name(&self) -> &'static str {
        "far_origin"
    }

    fn describe(&self) -> &'static str {
        "a pair of another family, 256 m to some 1,000 km from the origin, where coordinates lose their last bits"
    }

    fn reaches(&self) -> &'static [ContactKind] {
        &ContactKind::ALL
    }

    fn generate(&self, rng: &mut ChaCha8Rng) -> (Block, Block) {
        let mut sampler = PairSampler::with_style(rng, CoordinateStyle::Grid);
        let family = Arc::clone(sampler.pick(&self.families));
        let distance = 1 << sampler.between(8, 20);
        // Whole metres, or odd sixteenths, which f32 drops at this distance.
        let parts = if sampler.chance(50) { 1 } else { 16 };
        let offset = [(); 3].map(|()| {
            let metres = sampler.between(-distance * parts, distance * parts) as f64 / parts as f64;
            Number::from_f64(metres).unwrap_or(Number::ZERO)
        });
        let offset = Vec3::new(offset[0].clone(), offset[1].clone(), offset[2].clone());
        let (a, b) = family.generate(rng);
        (a.translated(&offset), b.translated(&offset))
    }
}
