//! Whether a block is squashed by its weight, by the blocks above it, by loads or by its initial stress, as where `young` is given in GPa: an estimate.

use super::column::{Column, Plans, borne, total};
use super::shape::largest;
use super::six_digits;
use super::warning::{Warning, WarningKind};
use crate::scene::Scene;
use crate::simulation::Motion;

/// The greatest strain that what a block bears, or its initial stress, may give it: strains are taken for small, and rock breaks before.
pub(super) const MAX_STRAIN: f64 = 0.01;

/// The deformable block that is strained most, if that is more than [`MAX_STRAIN`]: by what it bears, or by its initial stress where nothing holds that. An estimate as that of [`load`](super::load::load), along the same directions; `squashed` is that of [`worst`](super::pressing::worst).
///
/// What a block bears, over the area of its plan, strains it by (F − W/2)/(A·E): half of its own weight W lies below its middle, whose strain the whole block has. Of a box
/// that bears nothing else it is ρ·g·h/(2E). An initial stress σ strains a block that is free to expand by ((1 + ν)·σ − ν·tr(σ)·I)/E (Hooke's law);
/// of that the Frobenius norm counts, no less than the strain along any axis: √(1 + 2ν²)·σ/E of one principal stress, √3·(1 − 2ν)·σ/E where it is the same all round. What f64 does not hold is infinite.
pub(super) fn strain(scene: &Scene, squashed: Option<(usize, f64)>) -> Option<Warning> {
    let stressed = deformable(scene).map(|(block, young)| (block, stress_strain(scene, block, young)));
    let (block, found) = largest(squashed.into_iter().chain(stressed))?;
    if found <= MAX_STRAIN {
        return None;
    }
    let young = scene.simulation.materials[scene.blocks[block].body.material].young.approximate();
    let remedy = format!("young ≥ {}", six_digits(young * found / MAX_STRAIN, true, false));
    Some(Warning { kind: WarningKind::Strain, block: Some(block), found, allowed: MAX_STRAIN, remedy })
}

/// The deformable blocks with Young's modulus of each (Pa).
pub(super) fn deformable(scene: &Scene) -> impl Iterator<Item = (usize, f64)> {
    let young = |material: usize| scene.simulation.materials[material].young.approximate();
    let all = scene.blocks.iter().enumerate().filter(|(_, one)| one.body.motion == Motion::Deformable);
    all.map(move |(block, one)| (block, young(one.body.material)))
}

/// The block that is squashed most by what it bears along a direction; `None` where all could bear it.
pub(super) fn most_squashed(scene: &Scene, columns: &[Column]) -> Option<(usize, f64)> {
    let stiffness = |one: &Column| {
        let body = &scene.blocks[one.block].body;
        (body.motion == Motion::Deformable)
            .then(|| scene.simulation.materials[body.material].young.approximate() * one.area)
    };
    let stiffnesses =
        || columns.iter().filter_map(|one| Some((one, stiffness(one)?))).filter(|(_, stiffness)| *stiffness > 0.0);
    // Most scenes could bear all of it anywhere.
    let softest = stiffnesses().map(|(_, stiffness)| stiffness).fold(f64::INFINITY, f64::min);
    if total(columns) <= MAX_STRAIN * softest {
        return None;
    }
    let plans = Plans::of(columns);
    let middle = |one: &Column| borne(columns, &plans, one) - one.weight.unwrap_or(0.0) / 2.0;
    largest(stiffnesses().map(|(one, stiffness)| (one.block, middle(one) / stiffness)))
}

/// The Frobenius norm of the strain by which a block's initial stress is let go.
fn stress_strain(scene: &Scene, block: usize, young: f64) -> f64 {
    let body = &scene.blocks[block].body;
    let poisson = scene.simulation.materials[body.material].poisson.approximate();
    // Over Young's modulus first, since squares of stresses may be beyond f64 where strains are not.
    let parts: Vec<f64> = body.stress.iter().map(|part| part.approximate() / young).collect();
    let (normal, shear) = parts.split_at(3);
    let around = poisson * normal.iter().sum::<f64>();
    let normal: f64 = normal.iter().map(|part| ((1.0 + poisson) * part - around).powi(2)).sum();
    let shear: f64 = shear.iter().map(|part| ((1.0 + poisson) * part).powi(2)).sum();
    (normal + 2.0 * shear).sqrt()
}

#[cfg(test)]
mod tests {
    use super::super::column::ColumnSource;
    use super::super::pressing::worst;
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
        let squashed = |scene: &Scene| {
            let set = ToleranceSet::ZERO;
            strain(scene, worst(&ColumnSource::of(&set, scene), &set, scene).squashed)
        };
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

    #[test]
    fn initial_stress_strains_by_hookes_law() {
        let one = Vec3::new(1, 1, 1).map(|&c| Number::from_integer(c));
        let mut scene = Scene::on_fixed("cube", Block::cuboid(&one.map(|_| Number::ZERO), &one).unwrap());
        scene.blocks[0].body.motion = Motion::Deformable;
        let mut of = |parts: [f64; 6], young: &str| {
            scene.simulation.materials[0].young = Number::parse(young).unwrap();
            scene.blocks[0].body.stress = parts.map(|part| Number::from_f64(part).unwrap());
            strain(&scene, None).map(|found| found.found)
        };
        let near = |found: Option<f64>, expected: f64| (found.unwrap() / expected - 1.0).abs() < 1e-12;
        // ν = 1/4: of one principal stress √(1 + 2/16), all round 1 − 2/4 along each of three axes, of shear 1 + 1/4 twice.
        assert!(near(of([-200.0, 0.0, 0.0, 0.0, 0.0, 0.0], "1000"), 0.2 * 1.125_f64.sqrt()));
        assert!(near(of([-200.0, -200.0, -200.0, 0.0, 0.0, 0.0], "1000"), 0.1 * 3_f64.sqrt()));
        assert!(near(of([0.0, 0.0, 0.0, 0.0, 80.0, 0.0], "1000"), 0.1 * 2_f64.sqrt()));
        assert_eq!(of([-11.0, -11.0, -11.0, 0.0, 0.0, 0.0], "1000"), None, "0.0095, and 0.019 without ν");
        assert_eq!(of([1e300, 1e300, -1e300, 0.0, 0.0, 0.0], "1e-10"), Some(f64::INFINITY));
    }
}
