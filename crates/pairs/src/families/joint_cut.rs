//! Neighbouring pieces of one block cut by joints.

use super::{CoordinateStyle, Family, PairSampler};
use crate::families::MotionStyle;
use crate::shapes::{ClippedPolyhedron, HalfSpace};
use rand_chacha::ChaCha8Rng;
use rockproof_model::{Block, ContactKind, Number, Vec3};

#[derive(Debug)]
pub(super) struct JointCut;

impl Family for JointCut {
    fn name(&self) -> &'static str {
        "joint_cut"
    }

    fn describe(&self) -> &'static str {
        "two pieces of a block cut by rational joint planes, sharing a face that no binary number holds, or slid along it"
    }

    fn reaches(&self) -> &'static [ContactKind] {
        &[ContactKind::VertexVertex, ContactKind::VertexEdge, ContactKind::EdgeVertex]
    }

    fn motion_style(&self) -> MotionStyle {
        MotionStyle::Sliding
    }

    fn generate(&self, rng: &mut ChaCha8Rng) -> (Block, Block) {
        let mut sampler = PairSampler::with_style(rng, CoordinateStyle::Grid);
        loop {
            if let Some(pair) = attempt(&mut sampler) {
                return pair;
            }
        }
    }
}

/// Sixteenths of a metre, so that the numbers of a cut stay small.
const UNITS: i128 = 16;

fn attempt(sampler: &mut PairSampler<'_>) -> Option<(Block, Block)> {
    let low = [(); 3].map(|()| sampler.between(-160, 160));
    let high = low.map(|c| c + sampler.between(12, 64));
    let joint = plane(sampler, low, high);
    let whole = ClippedPolyhedron::cuboid(low, high, UNITS);
    let (mut a, mut b) = (whole.clipped(joint).ok()?, whole.clipped(joint.reversed()).ok()?);
    for _ in 0..sampler.below(3) {
        // A joint through both pieces, or one that ends at the first joint.
        let plane = plane(sampler, low, high);
        match sampler.below(3) {
            0 => a = a.clipped(plane).ok()?,
            1 => b = b.clipped(plane).ok()?,
            _ => (a, b) = (a.clipped(plane).ok()?, b.clipped(plane).ok()?),
        }
    }
    let (a, b) = (a.block(0).ok()?, b.block(0).ok()?);
    let b = if sampler.chance(30) { slid(sampler, &b, &joint) } else { b };
    Some(if sampler.chance(50) { (a, b) } else { (b, a) })
}

/// A joint of small whole normal through the middle part of the box.
fn plane(sampler: &mut PairSampler<'_>, low: [i128; 3], high: [i128; 3]) -> HalfSpace {
    let mut normal = [0; 3];
    while normal.iter().filter(|c| **c != 0).count() < 2 {
        normal = [(); 3].map(|()| sampler.between(-7, 7));
    }
    let level = (0..3).map(|i| normal[i] * sampler.between(low[i] + 3, high[i] - 3)).sum();
    HalfSpace { normal, level }
}

/// The block slid along the joint, or lifted off or pressed into it, by a small step.
fn slid(sampler: &mut PairSampler<'_>, block: &Block, joint: &HalfSpace) -> Block {
    let [a, b, c] = joint.normal;
    let along = *sampler.pick(&[[b, -a, 0], [c, 0, -a], [0, c, -b], [a, b, c], [-a, -b, -c]]);
    let step = 1.0 / f64::from(1 << sampler.between(8, 14));
    let [x, y, z] = along.map(|c| Number::from_f64(c as f64 * step).unwrap_or(Number::ZERO));
    block.translated(&Vec3::new(x, y, z))
}
