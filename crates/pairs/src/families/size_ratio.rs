//! A small block on a large one.

use super::{Drawn, PairSampler};
use crate::families::MotionStyle;
use rockproof_model::{Block, ContactKind};

pub(super) const SIZE_RATIO: Drawn = Drawn {
    name: "size_ratio",
    about: "a block at a face, edge or corner of one 8 to 4096 times its size",
    reaches: &[ContactKind::VertexFace, ContactKind::FaceVertex],
    style: MotionStyle::Any,
    draw,
};

fn draw(sampler: &mut PairSampler<'_>) -> (Block, Block) {
    let small = sampler.convex(8, 32);
    let small = if sampler.chance(40) { sampler.turned(&small) } else { sampler.cube_turned(&small) };
    let ratio = 1 << sampler.between(3, 12);
    let large = if sampler.chance(70) { sampler.cuboid(8, 32) } else { sampler.convex(8, 32) };
    let large = large.stretched([ratio; 3], 1);
    let top = large.furthest([sampler.sign(), sampler.sign(), 64]);
    let sole = small.furthest([sampler.between(-1, 1), sampler.between(-1, 1), -3]);
    let size = 2 * sampler.denominator();
    let mut offset = sampler.small_vector(size);
    // Inward from the corner, by nothing, a small block's size, or anywhere.
    for (axis, offset) in offset.iter_mut().enumerate().take(2) {
        let width = (large.extent(axis).1 - large.extent(axis).0) * sampler.denominator() / large.denominator();
        let inward = if large.points()[top][axis] * 2 > large.extent(axis).0 + large.extent(axis).1 { -1 } else { 1 };
        match sampler.below(4) {
            0 => {}
            1 => *offset += inward * sampler.length(0, 32),
            _ => *offset += inward * sampler.between(0, width),
        }
    }
    let (a, b) = sampler.vertex_to_vertex((&large, top), (&small, sole), offset);
    sampler.finish(a, b)
}
