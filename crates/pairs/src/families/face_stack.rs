//! A block on the top face of another.

use super::{Drawn, PairSampler};
use crate::families::MotionStyle;
use crate::shapes::LatticeSolid;
use rockproof_model::{Block, ContactKind};

pub(super) const FACE_STACK: Drawn = Drawn {
    name: "face_stack",
    about: "a block on the flat top of another: flush, shifted or turned, with a gap around zero",
    reaches: &ContactKind::ALL,
    style: MotionStyle::Pressing,
    draw,
};

fn draw(sampler: &mut PairSampler<'_>) -> (Block, Block) {
    let below = flat_topped(sampler);
    let above = match sampler.below(5) {
        4 => {
            let upright = if sampler.chance(50) { sampler.cuboid(8, 48) } else { sampler.convex(8, 48) };
            sampler.tipped(&upright)
        }
        0 => {
            // A block standing on a tip or an edge instead of a face.
            let tilted = sampler.convex(8, 48);
            sampler.turned(&tilted)
        }
        1 => {
            let upright = sampler.convex(8, 48);
            sampler.turned_flat(&upright)
        }
        _ => sampler.convex(8, 48),
    };
    let (below, above) = LatticeSolid::on_one_lattice(&below, &above);
    let unit = below.denominator() / sampler.denominator();
    let top = below.extent(2).1;
    let mut shift = [0, 0, top - above.extent(2).0];
    for (axis, shift) in shift.iter_mut().enumerate().take(2) {
        let (low, high) = below.extent(axis);
        let (near, far) = above.extent(axis);
        *shift = match sampler.below(5) {
            0 => low - near,
            1 => high - far,
            2 => (low + high) / 2 - (near + far) / 2,
            3 => low - near + sampler.gap(2 * sampler.denominator()) * unit,
            _ => low - near + sampler.between(0, ((high - low) / unit).max(1)) * unit,
        };
    }
    shift[2] += sampler.gap(2 * sampler.denominator()) * unit;
    sampler.finish(below, above.moved(shift))
}

/// A block with a flat top, at z = its height.
fn flat_topped(sampler: &mut PairSampler<'_>) -> LatticeSolid {
    let sides = sampler.lengths(8, 48);
    match sampler.below(6) {
        0 => sampler.shape("hexagon", sides),
        1 => sampler.shape("frustum", sides),
        2 => sampler.shape("pentagon", sides),
        3 => sampler.shape("trapezoid", sides),
        _ => sampler.shape("cuboid", sides),
    }
}
