//! Blocks side by side with faces in one plane.

use super::{Drawn, PairSampler};
use crate::families::MotionStyle;
use rockproof_model::{Block, ContactKind};

pub(super) const COPLANAR_SLIDE: Drawn = Drawn {
    name: "coplanar_slide",
    about: "blocks that share one, two or three planes exactly, one slid along the other to, near and past its edges",
    reaches: &ContactKind::ALL,
    style: MotionStyle::Sliding,
    draw,
};

fn draw(sampler: &mut PairSampler<'_>) -> (Block, Block) {
    let sides = sampler.lengths(8, 48);
    // Often sides in common, so that edges and corners coincide as well.
    let [mut u, mut v, w] = sampler.lengths(8, 48);
    if sampler.chance(50) {
        u = sides[0];
    }
    if sampler.chance(50) {
        v = sides[1];
    }
    let prisms = ["cuboid", "cuboid", "cuboid", "cuboid", "hexagon", "rhombus", "trapezoid"];
    let shape = *sampler.pick(&prisms);
    let a = sampler.shape(shape, sides);
    let shape = if sampler.chance(70) { shape } else { *sampler.pick(&prisms) };
    let b = sampler.shape(shape, [u, v, w]);
    let unit = a.denominator() / sampler.denominator();
    let size = 2 * sampler.denominator();
    // On top; then each way: flush on either side, slid by a share of the block, or by about a tolerance.
    let mut offset = [0, 0, sides[2]];
    if sampler.chance(30) {
        offset[2] += sampler.gap(size);
    }
    for axis in 0..2 {
        let far = sides[axis] - if axis == 0 { u } else { v };
        offset[axis] = match sampler.below(6) {
            0 | 1 => 0,
            2 => far,
            3 => sampler.gap(size),
            4 => sides[axis],
            _ => sampler.between(0, sides[axis]),
        };
    }
    sampler.finish(a, b.moved(offset.map(|c| c * unit)))
}
