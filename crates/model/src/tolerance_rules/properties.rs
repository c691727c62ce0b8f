//! Whether a density or a friction is so far from those of rock that another unit, or another key, is meant.

use super::warning::{Warning, WarningKind};
use crate::number::Number;
use crate::scene::Scene;
use std::cmp::Ordering;

/// The largest friction that is not warned of: tan 78.7°.
const MAX_FRICTION: i32 = 5;
/// Densities that are not warned of (kg/m³): pumice and wood are heavier than the one, iron is lighter than the other.
const DENSITIES: [i32; 2] = [100, 10_000];

/// The greatest friction between any two blocks of which one can move, if it is more than 5; **exactly 5 is not more**.
pub(super) fn friction(scene: &Scene) -> Option<Warning> {
    let joints = &scene.simulation.joints;
    let mut may_move = vec![false; joints.names.len()];
    scene.blocks.iter().for_each(|one| may_move[one.body.joint] |= !one.body.is_fixed());
    // A pair of joint materials that is present has two blocks, and any block of the one may be beside any of the other.
    let pairs = scene.joint_pairs().into_iter().filter(|pair| pair.iter().any(|&joint| may_move[joint]));
    let used = pairs.map(|[one, other]| &joints.between(one, other).friction);
    let greatest = used.max()?;
    let limit = Number::from_integer(MAX_FRICTION);
    (*greatest > limit).then(|| Warning {
        kind: WarningKind::Friction,
        block: None,
        found: greatest.approximate(),
        allowed: limit.approximate(),
        remedy: format!("`friction_angle` where degrees are meant, or friction ≤ {MAX_FRICTION}"),
    })
}

/// The first block that can move and whose density is outside 100 to 10,000 kg/m³; **the limits are within**.
pub(super) fn density(scene: &Scene) -> Option<Warning> {
    let [least, most] = DENSITIES.map(Number::from_integer);
    let all = scene.blocks.iter().enumerate().filter(|(_, one)| !one.body.is_fixed());
    let mut densities = all.map(|(block, one)| (block, &scene.simulation.materials[one.body.material].density));
    let (block, density) = densities.find(|(_, density)| **density < least || **density > most)?;
    let (limit, relation) = if density.cmp(&least) == Ordering::Less { (least, "≥") } else { (most, "≤") };
    let allowed = limit.approximate();
    let remedy = format!("density {relation} {allowed} (kg/m³)");
    Some(Warning { kind: WarningKind::Density, block: Some(block), found: density.approximate(), allowed, remedy })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Block, Motion, SceneBlock, Vec3};

    #[test]
    fn friction_between_fixed_blocks_means_nothing() {
        let corner = |c: i32| Vec3::new(c, c, c).map(|&c| Number::from_integer(c));
        let cube = || Block::cuboid(&corner(0), &corner(1)).unwrap();
        let mut scene = Scene::on_fixed("floor", cube());
        scene.blocks.push(SceneBlock::new("wall", cube()));
        scene.simulation.joints.all_mut().for_each(|joint| joint.friction = Number::from_integer(30));
        assert_eq!(friction(&scene).map(|found| found.found), Some(30.0));
        scene.blocks[1].body.motion = Motion::Fixed;
        assert_eq!(friction(&scene), None);
    }
}
