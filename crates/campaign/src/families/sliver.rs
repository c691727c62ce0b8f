//! Thin plates, needles and short edges.

use super::{Family, PairSampler};
use crate::shapes::LatticeSolid;
use rand_chacha::ChaCha8Rng;
use rockproof_model::{Block, ContactKind};

#[derive(Debug)]
pub(super) struct Sliver;

impl Family for Sliver {
    fn name(&self) -> &'static str {
        "sliver"
    }

    fn describe(&self) -> &'static str {
        "a plate, a needle or a block with a sliver face against another block"
    }

    fn reaches(&self) -> &'static [ContactKind] {
        &[ContactKind::VertexFace, ContactKind::FaceVertex, ContactKind::EdgeEdge]
    }

    fn generate(&self, rng: &mut ChaCha8Rng) -> (Block, Block) {
        let mut sampler = PairSampler::new(rng);
        let thin = thin(&mut sampler);
        let a = sampler.cube_turned(&thin);
        let a = if sampler.chance(25) { sampler.turned(&a) } else { a };
        let b = if sampler.chance(20) { self::thin(&mut sampler) } else { sampler.convex(8, 48) };
        let (va, vb) = if sampler.chance(50) {
            let out = sampler.direction();
            (a.furthest(out), b.furthest(out.map(|c| -c)))
        } else {
            (a.furthest([1, 2, 4]), b.furthest([1, 2, -4]))
        };
        let size = 2 * sampler.denominator();
        let offset = if sampler.chance(50) {
            sampler.small_vector(size)
        } else {
            [-sampler.length(0, 16), -sampler.length(0, 16), sampler.gap(size)]
        };
        let (a, b) = sampler.vertex_to_vertex((&a, va), (&b, vb), offset);
        sampler.finish(a, b)
    }
}

fn thin(sampler: &mut PairSampler<'_>) -> LatticeSolid {
    let [x, y, z] = sampler.lengths(16, 48);
    let thin = (z / (1 << sampler.between(4, 9))).max(8);
    match sampler.below(6) {
        0 => sampler.shape("cuboid", [x, thin, thin]),
        1 => sampler.shape("tetrahedron", [x, y, thin]),
        2 => sampler.shape("hexagon", [x, thin, y]),
        3 => sampler.shape("trapezoid", [x, thin, z]),
        4 => sampler.shape("cut corner", [x, y, thin]),
        _ => sampler.shape("cuboid", [x, y, thin]),
    }
}
