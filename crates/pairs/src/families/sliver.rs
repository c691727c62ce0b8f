//! Thin plates, needles and short edges.

use super::{Drawn, PairSampler};
use crate::families::MotionStyle;
use crate::shapes::LatticeSolid;
use rockproof_model::{Block, ContactKind};

pub(super) const SLIVER: Drawn = Drawn {
    name: "sliver",
    about: "a plate, a needle or a block with a sliver face against another block",
    reaches: &[ContactKind::VertexFace, ContactKind::FaceVertex, ContactKind::EdgeEdge],
    style: MotionStyle::Any,
    draw,
};

fn draw(sampler: &mut PairSampler<'_>) -> (Block, Block) {
    let thin = thin(sampler);
    let a = sampler.cube_turned(&thin);
    let a = if sampler.chance(25) { sampler.turned(&a) } else { a };
    let b = if sampler.chance(20) { self::thin(sampler) } else { sampler.convex(8, 48) };
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
