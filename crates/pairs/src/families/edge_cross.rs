//! Two ridges that cross.

use super::{Drawn, PairSampler};
use crate::families::MotionStyle;
use crate::shapes::LatticeSolid;
use crate::shapes::lattice_solid::Units;
use rockproof_model::{Block, ContactKind};

pub(super) const EDGE_CROSS: Drawn = Drawn {
    name: "edge_cross",
    about: "the ridge of a block across the keel of another, crossing inside, near or at the ends of the edges",
    reaches: &[ContactKind::EdgeEdge],
    style: MotionStyle::Pressing,
    draw,
};

fn draw(sampler: &mut PairSampler<'_>) -> (Block, Block) {
    let below = ridge(sampler);
    let above = keel(sampler);
    let across = above.mapped(&[[0, -1, 0], [1, 0, 0], [0, 0, 1]], 1);
    let above = if sampler.chance(60) { sampler.turned_flat(&across) } else { across };
    let (a, b) = crossing_ridges(sampler, &below, &above);
    sampler.finish(a, b)
}

/// A block whose highest feature is an edge along x.
pub fn ridge(sampler: &mut PairSampler<'_>) -> LatticeSolid {
    let sides = sampler.lengths(12, 48);
    match sampler.below(4) {
        0 => sampler.shape("wedge", [sides[1], sides[0], sides[2]]).mapped(&[[0, 1, 0], [-1, 0, 0], [0, 0, 1]], 1),
        // A square bar on its edge.
        1 => {
            let bar = sampler.shape("cuboid", [sides[0], sides[1], sides[1]]);
            bar.mapped(&[[2, 0, 0], [0, 1, -1], [0, 1, 1]], 2)
        }
        2 => sampler.shape("hipped ridge", sides),
        _ => sampler.shape("ridge", sides),
    }
}

/// A block whose lowest feature is an edge along x.
pub fn keel(sampler: &mut PairSampler<'_>) -> LatticeSolid {
    ridge(sampler).mapped(&[[1, 0, 0], [0, -1, 0], [0, 0, -1]], 1)
}

/// `above` moved so that its lowest edge crosses the highest edge of `below`.
pub fn crossing_ridges(
    sampler: &mut PairSampler<'_>,
    below: &LatticeSolid,
    above: &LatticeSolid,
) -> (LatticeSolid, LatticeSolid) {
    let (low, high) = (middle(below, 2, below.extent(2).1), middle(above, 2, above.extent(2).0));
    crossing(sampler, (below, low), (above, high))
}

/// `above` moved so that an edge of it crosses one of `below`, at the middle of each or off by a share of its half, with
/// a gap along z. The edges are given as by [`middle`].
pub(super) fn crossing(
    sampler: &mut PairSampler<'_>,
    (below, (p, half_p)): (&LatticeSolid, (Units, Units)),
    (above, (q, half_q)): (&LatticeSolid, (Units, Units)),
) -> (LatticeSolid, LatticeSolid) {
    let slide = |sampler: &mut PairSampler<'_>| match sampler.below(6) {
        0 | 1 => 0,
        2 => 64 * sampler.sign(),
        3 => (64 + sampler.between(-2, 2)) * sampler.sign(),
        _ => sampler.between(-60, 60),
    };
    let (s, t) = (slide(sampler), slide(sampler));
    // Halves, so that the middles are whole; 64 steps from the middle to the end, so that the ends are met exactly.
    let (below, above) = (below.refined(64), above.refined(64));
    let at = |middle: Units, half: Units, step: i128| [0, 1, 2].map(|i| 64 * middle[i] + step * half[i]);
    let gap = sampler.gap(2 * sampler.denominator());
    sampler.point_to_point((&below, at(p, half_p, s)), (&above, at(q, half_q, t)), [0, 0, gap])
}

/// Twice the middle, and twice half the length, of the edge at this place along an axis.
pub(super) fn middle(solid: &LatticeSolid, axis: usize, place: i128) -> (Units, Units) {
    let ends: Vec<Units> = solid.points().iter().copied().filter(|p| p[axis] == place).collect();
    let (p, q) = (ends[0], ends[ends.len() - 1]);
    ([0, 1, 2].map(|i| p[i] + q[i]), [0, 1, 2].map(|i| q[i] - p[i]))
}
