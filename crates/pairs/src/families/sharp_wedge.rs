//! Wedges of a few degrees.

use super::edge_cross::{crossing, middle};
use super::{Drawn, PairSampler};
use crate::families::MotionStyle;
use crate::shapes::LatticeSolid;
use rockproof_model::{Block, ContactKind};

pub(super) const SHARP_WEDGE: Drawn = Drawn {
    name: "sharp_wedge",
    about: "a wedge of some degrees, lying on, entering, pointing at or flat across another wedge or block",
    reaches: &[ContactKind::VertexVertex, ContactKind::VertexFace, ContactKind::FaceVertex],
    style: MotionStyle::Any,
    draw,
};

fn draw(sampler: &mut PairSampler<'_>) -> (Block, Block) {
    if sampler.chance(15) {
        return blades(sampler);
    }
    let a = sharp(sampler);
    let other = if sampler.chance(60) { sharp(sampler) } else { sampler.convex(16, 64) };
    let b = sampler.cube_turned(&other);
    let b = if sampler.chance(30) { sampler.turned_flat(&b) } else { b };
    let size = 2 * sampler.denominator();
    // The tip of the wedge against a vertex, or its sole against whatever of B comes first.
    let (a, b) = if sampler.chance(50) {
        let tips: Vec<usize> = (0..a.points().len()).filter(|&v| a.points()[v][0] == 0).collect();
        let tip = *sampler.pick(&tips);
        let vb = sampler.below(b.points().len() as u64) as usize;
        let offset = sampler.small_vector(size);
        sampler.vertex_to_vertex((&a, tip), (&b, vb), offset)
    } else {
        let vb = b.furthest([sampler.between(-1, 1), sampler.between(-1, 1), 4]);
        let sole = a.furthest([1, 1, -16]);
        let offset = [-sampler.length(0, 40), -sampler.length(0, 8), -sampler.gap(size)];
        sampler.vertex_to_vertex((&a, sole), (&b, vb), offset)
    };
    sampler.finish(a, b)
}

/// Two blades that lie flat, one's edge across the other's. Each opens to both sides of its edge alike, so neither leans
/// more to one side of the plane of both edges than the other: σ ties.
fn blades(sampler: &mut PairSampler<'_>) -> (Block, Block) {
    let (a, b) = (blade(sampler), blade(sampler).mapped(&[[0, -1, 0], [1, 0, 0], [0, 0, 1]], 1));
    let (edge_a, edge_b) = (middle(&a, 0, a.extent(0).0), middle(&b, 1, b.extent(1).0));
    let (a, b) = crossing(sampler, (&a, edge_a), (&b, edge_b));
    sampler.finish(a, b)
}

/// A blade with its edge along y, that opens along x as `sharp` does.
fn blade(sampler: &mut PairSampler<'_>) -> LatticeSolid {
    let length = sampler.length(32, 64);
    let thickness = (length / sampler.between(12, 100)).max(8);
    let width = sampler.length(16, 48);
    sampler.shape("ridge", [width, thickness, length]).mapped(&[[0, 0, -1], [1, 0, 0], [0, -1, 0]], 1)
}

/// A wedge or point along x, its tip at x = 0 and its thickness a twelfth to a hundredth of its length.
fn sharp(sampler: &mut PairSampler<'_>) -> LatticeSolid {
    let length = sampler.length(32, 64);
    let thickness = (length / sampler.between(12, 100)).max(8);
    let width = sampler.length(16, 48);
    match sampler.below(3) {
        0 => sampler
            .shape("tetrahedron", [thickness, width, length])
            .mapped(&[[0, 0, -1], [0, 1, 0], [1, 0, 0]], 1)
            .moved([0; 3]),
        1 => sampler.shape("pyramid", [width, thickness, length]).mapped(&[[0, 0, -1], [1, 0, 0], [0, -1, 0]], 1),
        _ => sampler.shape("wedge", [length, width, thickness]),
    }
}
