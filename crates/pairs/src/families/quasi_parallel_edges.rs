//! Two ridges that are almost parallel.

use super::edge_cross::{crossing_ridges, keel, ridge};
use super::{Drawn, PairSampler};
use crate::families::MotionStyle;
use crate::shapes::RationalRotation;
use rockproof_model::{Block, ContactKind};

pub(super) const QUASI_PARALLEL_EDGES: Drawn = Drawn {
    name: "quasi_parallel_edges",
    about: "a ridge along the keel of another block, turned by nothing, by some degrees around the parallel angle, or by far less",
    reaches: &[ContactKind::VertexEdge, ContactKind::EdgeVertex, ContactKind::EdgeEdge],
    style: MotionStyle::Any,
    draw,
};

fn draw(sampler: &mut PairSampler<'_>) -> (Block, Block) {
    let below = ridge(sampler);
    let along = keel(sampler);
    // The angle is 2·atan(1/n): 3 degrees are n = 38; the length rule of `revised` bites at some n of hundreds.
    let n = match sampler.below(8) {
        0 | 1 => None,
        2 | 3 => Some(sampler.between(30, 48)),
        4 => Some(sampler.between(3, 30)),
        5 => Some(sampler.between(100, 1000)),
        6 => Some(1 << sampler.between(5, 12)),
        _ => Some(1 << sampler.between(12, 24)),
    };
    let above = match n {
        None => along,
        Some(n) => {
            let sideways = sampler.sign() as i64;
            let quaternion = if sampler.chance(75) { [n as i64, 0, 0, sideways] } else { [n as i64, 0, sideways, 0] };
            sampler.turned_by(&along, RationalRotation::from_quaternion(quaternion))
        }
    };
    let (a, b) = crossing_ridges(sampler, &below, &above);
    sampler.finish(a, b)
}
