//! SPEC section 3's rule on the penalty stiffness.

use super::largest::{factor, may_be_largest};
use super::{LengthLocation, Relation, RequiredValue, Rule, RuleSlack, Violation, Violations, check};
use crate::block::Block;
use crate::number::{Number, Precision};
use crate::scene::{Scene, SceneBlock};
use crate::simulation::{Body, MovingBlock, Simulation, derive_stiffness_of, moving_blocks, smallest_face};
use crate::tolerance::ToleranceSet;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::Zero;

/// As [`check`], and the rule on the penalty stiffness: with W = ρ·V·|g| the weight of a block that can move, n the
/// corners of its face of least area, and p the softest normal stiffness between its joint material and that of any
/// other block, W/(p·n) must not exceed `penetration`; compared exactly, by squares. Joints without a stiffness have the
/// one that [`derive_stiffness`](crate::simulation::derive_stiffness) gives them. The violation is that of the block with the largest overlap, ties going to the
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
    let moving = moving_blocks(&bodies);
    derive_stiffness_of(&mut simulation, &moving, set);
    let gravity = simulation.gravity.map(Number::to_rational).norm_squared();
    if gravity.is_zero() {
        return None;
    }
    let joints = blocks_by_joint(&simulation, &scene.blocks);
    let overlap = |one: &MovingBlock<'_>| {
        let softest = softest(&simulation, &joints, one.body)?;
        let density = simulation.materials[one.body.material].density.to_rational();
        let mass = density * one.block.volume();
        let corners = smallest_face(one.block);
        let weight_squared = &mass * &mass * &gravity;
        let resistance = softest * BigRational::from_integer(BigInt::from(corners));
        let squared = &weight_squared / (&resistance * &resistance);
        Some(Overlap { block: one.number, weight_squared, corners, squared })
    };
    // The mass over the resistance in f64; gravity is the same for all.
    let softest_near = nearby_softest(&simulation, &joints);
    let near = moving.iter().map(|one| {
        let density = factor(simulation.materials[one.body.material].density.approximate());
        density * factor(one.volume) / (softest_near(one.body.joint) * smallest_face(one.block) as f64)
    });
    let near: Vec<f64> = near.collect();
    let overlaps = may_be_largest(&near).filter_map(|place| overlap(&moving[place]));
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
    violations.require(
        Rule::Stiffness,
        (&worst.squared, Relation::SquareNotAbove, &allowed_squared),
        Some(place),
        &remedies,
    );
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

/// As [`softest`] in f64, by the block's joint material; NaN where there is none, or none that f64 knows.
pub(super) fn nearby_softest(simulation: &Simulation, blocks: &[usize]) -> impl Fn(usize) -> f64 {
    let of_joint = |own: usize| {
        let others = (0..blocks.len()).filter(|&joint| blocks[joint] > usize::from(joint == own));
        let stiffnesses = others.filter_map(|joint| simulation.joints.between(own, joint).normal_stiffness.as_ref());
        // Rounding to nearest keeps the order.
        stiffnesses.min().map_or(f64::NAN, |least| factor(least.approximate()))
    };
    let all: Vec<f64> = (0..blocks.len()).map(of_joint).collect();
    move |joint| all[joint]
}

/// The least normal stiffness of a joint that a block with this body can be part of; `None` where there is no other block. `blocks` are those of each
/// joint material, this one among them.
pub(super) fn softest(simulation: &Simulation, blocks: &[usize], body: &Body) -> Option<BigRational> {
    let own = body.joint;
    (0..blocks.len())
        .filter(|&joint| blocks[joint] > usize::from(joint == own))
        .filter_map(|joint| simulation.joints.between(own, joint).normal_stiffness.as_ref())
        .min()
        .map(Number::to_rational)
}
