//! SPEC section 3's rule on the penalty stiffness.

use super::{LengthLocation, RequiredValue, Rule, RuleSlack, Violation, Violations, check};
use crate::block::Block;
use crate::number::{Number, Precision};
use crate::scene::{Scene, SceneBlock};
use crate::simulation::{Simulation, derive_stiffness, smallest_face};
use crate::tolerance::ToleranceSet;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::Zero;

/// As [`check`], and the rule on the penalty stiffness: with W = ρ·V·|g| the weight of a block that can move, n the
/// corners of its face of least area, and p the softest normal stiffness between its joint material and that of any
/// other block, W/(p·n) must not exceed `penetration`; compared exactly, by squares. Joints without a stiffness have the
/// one that [`derive_stiffness`] gives them. The violation is that of the block with the largest overlap, ties going to the
/// lowest number; without gravity there is none.
pub fn check_scene(set: &ToleranceSet, scene: &Scene, precision: Precision) -> Vec<Violation> {
    let mut violations = check(set, &scene.shapes(), precision);
    violations.extend(stiffness(set, scene).and_then(|mut compared| compared.found.pop()));
    violations
}

/// How far the set is from breaking the rule on the penalty stiffness; `None` where nothing has a weight that rests on anything.
pub fn stiffness_slack(set: &ToleranceSet, scene: &Scene) -> Option<RuleSlack> {
    stiffness(set, scene)?.slacks.pop()
}

/// The overlap of one block under its weight.
struct Overlap {
    block: usize,
    weight_squared: BigRational,
    corners: usize,
    /// Of the overlap in m.
    squared: BigRational,
}

fn stiffness(set: &ToleranceSet, scene: &Scene) -> Option<Violations> {
    let mut simulation = scene.simulation.clone();
    let bodies: Vec<(&Block, _)> = scene.blocks.iter().map(|b| (&b.block, &b.body)).collect();
    derive_stiffness(&mut simulation, &bodies, set);
    let gravity = simulation.gravity.map(Number::to_rational).norm_squared();
    if gravity.is_zero() {
        return None;
    }
    let joints = blocks_by_joint(&simulation, &scene.blocks);
    let overlap = |(block, scene_block): (usize, &SceneBlock)| {
        let softest = softest(&simulation, &joints, scene_block)?;
        let density = simulation.materials[scene_block.body.material].density.to_rational();
        let mass = density * scene_block.block.volume();
        let corners = smallest_face(&scene_block.block);
        let weight_squared = &mass * &mass * &gravity;
        let resistance = softest * BigRational::from_integer(BigInt::from(corners));
        let squared = &weight_squared / (&resistance * &resistance);
        Some(Overlap { block, weight_squared, corners, squared })
    };
    let overlaps = scene.blocks.iter().enumerate().filter(|(_, b)| !b.body.is_fixed()).filter_map(overlap);
    let worst = overlaps.reduce(|worst, next| if next.squared > worst.squared { next } else { worst })?;
    let allowed = set.penetration.to_rational();
    let allowed_squared = &allowed * &allowed;
    let corners = BigRational::from_integer(BigInt::from(worst.corners));
    let mut remedies = vec![("penetration", RequiredValue::RootOrMore(worst.squared.clone()))];
    if !allowed.is_zero() {
        let needed = &worst.weight_squared / (&allowed_squared * &corners * &corners);
        remedies.insert(0, ("normal_stiffness", RequiredValue::RootOrMore(needed)));
    }
    let mut violations = Violations::default();
    let place = LengthLocation { block: worst.block, edge: None };
    violations.at_most_squared(Rule::Stiffness, (&worst.squared, &allowed_squared), Some(place), &remedies);
    Some(violations)
}

/// How many blocks have each joint material.
pub(super) fn blocks_by_joint(simulation: &Simulation, blocks: &[SceneBlock]) -> Vec<usize> {
    let mut counts = vec![0; simulation.joints.names.len()];
    for block in blocks {
        counts[block.body.joint] += 1;
    }
    counts
}

/// The least normal stiffness of a joint that a block can be part of; `None` where there is no other block. `blocks` are those of each
/// joint material, this one among them.
pub(super) fn softest(simulation: &Simulation, blocks: &[usize], block: &SceneBlock) -> Option<BigRational> {
    let own = block.body.joint;
    (0..blocks.len())
        .filter(|&joint| blocks[joint] > usize::from(joint == own))
        .filter_map(|joint| simulation.joints.between(own, joint).normal_stiffness.as_ref())
        .min()
        .map(Number::to_rational)
}
