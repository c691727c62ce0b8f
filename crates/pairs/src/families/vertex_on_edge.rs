//! A corner near an edge.

use super::edge_cross::ridge;
use super::{Drawn, PairSampler};
use crate::families::MotionStyle;
use rockproof_model::{Block, ContactKind};

pub(super) const VERTEX_ON_EDGE: Drawn = Drawn {
    name: "vertex_on_edge",
    about: "a corner on, beside, or a whole Pythagorean distance from an edge, between its ends, near one or beyond",
    reaches: &[ContactKind::VertexEdge, ContactKind::EdgeVertex],
    style: MotionStyle::Any,
    draw,
};

fn draw(sampler: &mut PairSampler<'_>) -> (Block, Block) {
    let below = if sampler.chance(50) { ridge(sampler) } else { sampler.cuboid(16, 48) };
    let above = sampler.convex(8, 40);
    let above = if sampler.chance(40) { sampler.turned(&above) } else { sampler.cube_turned(&above) };
    let above = if sampler.chance(20) { sampler.tipped(&above) } else { above };
    // A vertex on the sharp side of the edge, and the edge from there along x (every shape drawn here has one).
    let p = below.furthest([-1, 0, 64]);
    let q = below.furthest([1, 0, 64]);
    let tip = above.furthest([sampler.between(-1, 1), sampler.between(-1, 1), -3]);
    let (from, to) = (below.points()[p], below.points()[q]);
    let along = match sampler.below(6) {
        0 => 0,
        1 => sampler.between(-2, 2),
        2 => 32,
        _ => sampler.between(1, 63),
    };
    let below = below.refined(64);
    let above = above.refined(64);
    let foot = [0, 1, 2].map(|i| 2 * (64 * from[i] + along * (to[i] - from[i])));
    let offset = sampler.small_vector(2 * sampler.denominator());
    let tip = above.points()[tip].map(|c| 2 * c);
    let (a, b) = sampler.point_to_point((&below, foot), (&above, tip), offset);
    sampler.finish(a, b)
}
