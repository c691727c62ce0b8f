//! Whether a block is squashed by its weight, by the blocks above it or by loads, as where `young` is given in GPa: an estimate.

use super::load::{Column, Plans, borne, total};
use super::six_digits;
use super::warning::{Warning, WarningKind};
use crate::scene::Scene;
use crate::simulation::Motion;

/// The greatest strain that what a block bears may give it: strains are taken for small, and rock breaks before.
const MAX_STRAIN: f64 = 0.01;

/// The deformable block that is squashed most by what it bears, over the area of its plan, if its strain (F − W/2)/(A·E) is more than [`MAX_STRAIN`]: half of
/// its own weight W lies below its middle, whose strain the whole block has. Of a box that bears nothing else it is ρ·g·h/(2E). `columns` are those of [`loaded_columns`](super::load::loaded_columns). An estimate as that of [`load`](super::load::load).
pub(super) fn strain(scene: &Scene, columns: &[Column]) -> Option<Warning> {
    let stiffness = |block: usize| {
        let body = &scene.blocks[block].body;
        let young = scene.simulation.materials[body.material].young.approximate();
        (body.motion == Motion::Deformable).then(|| young * columns[block].shared(&columns[block]))
    };
    let deformable = || (0..columns.len()).filter_map(|block| Some((block, stiffness(block).filter(|s| *s > 0.0)?)));
    // Most scenes could bear all of it anywhere.
    let softest = deformable().map(|(_, stiffness)| stiffness).fold(f64::INFINITY, f64::min);
    let total = total(columns);
    if total.is_nan() || total <= MAX_STRAIN * softest {
        return None;
    }
    let plans = Plans::of(columns);
    let middle = |one: &Column| borne(columns, &plans, one) - one.weight.unwrap_or(0.0) / 2.0;
    let strains = deformable().map(|(block, stiffness)| (block, middle(&columns[block]) / stiffness));
    let (block, found) = strains.reduce(|most, next| if next.1 > most.1 { next } else { most })?;
    if found <= MAX_STRAIN || !found.is_finite() {
        return None;
    }
    let young = scene.simulation.materials[scene.blocks[block].body.material].young.approximate();
    let remedy = format!("young ≥ {}", six_digits(young * found / MAX_STRAIN, true, false));
    Some(Warning { kind: WarningKind::Strain, block: Some(block), found, allowed: MAX_STRAIN, remedy })
}

#[cfg(test)]
mod tests {
    use super::super::load::loaded_columns;
    use super::*;
    use crate::{Block, Number, SceneBlock, ToleranceSet, Vec3};

    #[test]
    fn blocks_that_weight_or_loads_squash_by_more_than_a_hundredth_are_found() {
        let at = |c: [i32; 3]| Vec3::new(c[0], c[1], c[2]).map(|&c| Number::from_integer(c));
        let cuboid = |low, high| Block::cuboid(&at(low), &at(high)).unwrap();
        let mut scene = Scene::on_fixed("slab", cuboid([-9, -9, -1], [9, 9, 0]));
        for z in 0..2 {
            scene.blocks.push(SceneBlock::new("cube", cuboid([0, 0, z], [1, 1, z + 1])));
        }
        scene.simulation.gravity = at([0, 0, -10]);
        let squashed = |scene: &Scene| strain(scene, &loaded_columns(&ToleranceSet::ZERO, scene).unwrap());
        let mut of_young = |young: i32, motion: Motion| {
            scene.simulation.materials[0].density = Number::from_integer(2500);
            scene.simulation.materials[0].young = Number::from_integer(young);
            scene.blocks.iter_mut().skip(1).for_each(|block| block.body.motion = motion);
            squashed(&scene)
        };
        // 37.5 kN/m² in the middle of the lower cube: a hundredth is allowed.
        assert_eq!(of_young(3_750_001, Motion::Deformable), None);
        assert!(of_young(3_749_999, Motion::Deformable).is_some());
        let found = of_young(50, Motion::Deformable).unwrap();
        assert_eq!((found.block, found.found, found.allowed), (Some(1), 750.0, 0.01));
        assert_eq!(found.remedy, "young ≥ 3.75001e6");
        assert_eq!(of_young(50, Motion::Rigid), None, "a rigid block has no strain");
    }
}
