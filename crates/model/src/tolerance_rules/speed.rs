//! Whether a block that the scene sets in motion is stopped before it is deeper than `penetration`: an estimate, as [`fall`](super::fall()) is of heights.

use super::column::{ColumnSource, gravity};
use super::six_digits;
use super::warning::{Warning, WarningKind};
use crate::number::Number;
use crate::scene::{Scene, SceneBlock};
use crate::simulation::{motion_energy, smallest_face};
use crate::tolerance::ToleranceSet;
use crate::vector::Vec3;

/// The block whose given velocity and spin would carry it deepest, if that is deeper than `penetration`; of equally deep ones the first. `None` where all move alike,
/// so that none meets another, and where `dynamic` is 0: then every step ends at rest.
///
/// A block that moves with the energy E has E + W·d to give until it is stopped d deep, W its weight, of which a contact of stiffness p takes p·d²/2. One contact takes all of it
/// where a corner below the centroid hits: d = (W + √(W² + 2·p·E))/p. Where n contacts share it none is as deep, but still √n times less only. Where the block goes, and what it loses before, is not asked.
pub(super) fn speed(set: &ToleranceSet, scene: &Scene, source: &ColumnSource<'_>) -> Option<Warning> {
    let allowed = set.penetration.approximate();
    let is_at_rest = |one: &SceneBlock| is_zero(&one.body.velocity) && is_zero(&one.body.spin);
    let moves = |one: &SceneBlock| !one.body.is_fixed() && !is_at_rest(one);
    let first = &scene.blocks.first()?.body.velocity;
    let moves_alike = |one: &SceneBlock| moves(one) && is_zero(&one.body.spin) && one.body.velocity == *first;
    let has_motion = scene.blocks.iter().any(moves) && !scene.blocks.iter().all(moves_alike);
    if allowed <= 0.0 || scene.simulation.control.dynamic == Number::ZERO || !has_motion {
        return None;
    }
    let pull = gravity(scene).map_or(0.0, |(_, pull)| pull);
    let reached = |(block, one): (usize, &SceneBlock)| {
        let mass = source.masses[block]?;
        let stiffness = source.contacts[block] / smallest_face(&one.block) as f64;
        if !moves(one) || stiffness.is_nan() {
            return None;
        }
        let (weight, energy) = (mass * pull, motion_energy(&one.block, &one.body, mass));
        let depth = (weight + (weight * weight + 2.0 * stiffness * energy).sqrt()) / stiffness;
        Some((block, depth, 2.0 * (energy + weight * allowed) / (allowed * allowed)))
    };
    let all = scene.blocks.iter().enumerate().filter_map(reached);
    let (block, depth, needed) = all.reduce(|deepest, next| if next.1 > deepest.1 { next } else { deepest })?;
    if depth <= allowed || !depth.is_finite() {
        return None;
    }
    // A stiffness that is derived may fall with a larger `penetration`, which then mends nothing.
    let deeper = ToleranceSet { penetration: Number::from_f64(depth).unwrap_or(Number::ZERO), ..set.clone() };
    let is_mended = ColumnSource::of(&deeper, scene).contacts[block] >= source.contacts[block];
    let stiffness = format!("normal_stiffness ≥ {}", six_digits(needed, true, false));
    let penetration = is_mended.then(|| format!("penetration ≥ {}", six_digits(depth, true, false)));
    let remedy = [Some(stiffness), penetration].into_iter().flatten().collect::<Vec<_>>().join(" or ");
    Some(Warning { kind: WarningKind::Speed, block: Some(block), found: depth, allowed, remedy })
}

fn is_zero(vector: &Vec3<Number>) -> bool {
    vector.components().into_iter().all(|part| *part == Number::ZERO)
}
