//! Whether a block sinks deeper than `penetration` under the blocks above it and under loads: an estimate. The rule of SPEC section 3 counts a block's own weight.

use super::column::{Column, ColumnSource, Plans, borne, carried, dot, total};
use super::shape::largest;
use super::six_digits;
use super::warning::{Warning, WarningKind};
use crate::number::Number;
use crate::scene::Scene;
use crate::simulation::smallest_face;
use crate::tolerance::ToleranceSet;

/// The block that would sink deepest under its own weight, its loads and what those above it press down with, if that is deeper than `penetration`;
/// `None` where `penetration` is 0, which the rules refuse. `sunk` is that of [`worst`](super::pressing::worst).
///
/// Of each block above, that share counts which its plan (the box of its vertices across gravity) has over this block's plan; what is above a fixed
/// block in between does not count. Of equally deep blocks it is the first. The block rests on as many contacts as its smallest face has corners, each of the softest normal stiffness that
/// it can meet, and on its fixed points. Blocks lean on one another and arches carry what is above them, so this is an estimate, in f64. Along the other directions in which loads press, above means before.
pub(super) fn load(set: &ToleranceSet, scene: &Scene, sunk: Option<&Sunk>) -> Option<Warning> {
    let allowed = set.penetration.approximate();
    let &Sunk { block, depth, borne, contacts, held } = sunk?;
    let corners = smallest_face(&scene.blocks[block].block) as f64;
    let needed = (borne / allowed - held) / corners;
    // A stiffness that is derived may fall with a larger `penetration`, which then mends nothing.
    let deeper = ToleranceSet { penetration: Number::from_f64(depth).unwrap_or(Number::ZERO), ..set.clone() };
    let is_mended = ColumnSource::of(&deeper, scene).contacts[block] >= contacts;
    let stiffness = format!("normal_stiffness ≥ {}", six_digits(needed, true, false));
    let penetration = is_mended.then(|| format!("penetration ≥ {}", six_digits(depth, true, false)));
    let remedy = [Some(stiffness), penetration].into_iter().flatten().collect::<Vec<_>>().join(" or ");
    Some(Warning { kind: WarningKind::Load, block: Some(block), found: depth, allowed, remedy })
}

/// A block that sinks deeper than `penetration`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sunk {
    pub(super) block: usize,
    /// How deep (m); infinite where f64 cannot hold it.
    pub(super) depth: f64,
    /// Under what (N).
    pub(super) borne: f64,
    /// As in [`Column`].
    pub(super) contacts: f64,
    /// As in [`Column`].
    pub(super) held: f64,
}

/// The block that sinks deepest along a direction, if that is deeper than `allowed`; `None` where `allowed` is 0.
pub(super) fn deepest(columns: &[Column], allowed: f64) -> Option<Sunk> {
    let moving = || columns.iter().filter(|one| one.weight.is_some() && one.contacts > 0.0);
    // Most scenes could bear all of it anywhere.
    let softest = moving().map(Column::resistance).fold(f64::INFINITY, f64::min);
    if allowed <= 0.0 || total(columns) <= allowed * softest {
        return None;
    }
    let plans = Plans::of(columns);
    let depths = moving().map(|one| {
        let borne = borne(columns, &plans, one);
        ((one, borne), borne / one.resistance())
    });
    let ((one, borne), depth) = largest(depths)?;
    let Column { block, contacts, held, .. } = *one;
    (depth > allowed).then_some(Sunk { block, depth, borne, contacts, held })
}

/// What some blocks of a scene bear when time begins with their own weight, as the warning `load` estimates it (N), with the loads along gravity of the
/// blocks above, but not their own; 0 of each without gravity.
pub fn weights_borne(set: &ToleranceSet, scene: &Scene, blocks: &[usize]) -> Vec<f64> {
    let Some(mut columns) = ColumnSource::of(set, scene).along_gravity() else { return vec![0.0; blocks.len()] };
    let gravity = scene.simulation.gravity.components().map(Number::approximate);
    let pull = dot(gravity, gravity).sqrt();
    for load in &scene.simulation.loads {
        columns[load.block].pushed += dot(load.at_start(), gravity) / pull;
    }
    let plans = Plans::of(&columns);
    blocks.iter().map(|&block| carried(&columns, &plans, &columns[block])).collect()
}

#[cfg(test)]
mod tests {
    use super::super::pressing::worst;
    use super::{load as of_sunk, *};
    use crate::block::Block;
    use crate::simulation::PointLoad;
    use crate::{SceneBlock, Vec3};

    fn load(set: &ToleranceSet, scene: &Scene) -> Option<Warning> {
        of_sunk(set, scene, worst(&ColumnSource::of(set, scene), set, scene).sunk.as_ref())
    }

    /// Cubes of 1 m³ and 2,500 kg on a fixed slab, at these corners; gravity 10 m/s² along an axis.
    fn stacked(corners: &[[i32; 3]], down: usize) -> Scene {
        let turned = |c: [i32; 3]| {
            // The third coordinate is the height.
            let mut at = [c[0], c[1], c[2]];
            at.rotate_right((down + 1) % 3);
            Vec3::new(at[0], at[1], at[2]).map(|&c| Number::from_integer(c))
        };
        let cuboid = |low, high| Block::cuboid(&turned(low), &turned(high)).unwrap();
        let mut scene = Scene::on_fixed("slab", cuboid([-9, -9, -1], [9, 9, 0]));
        for &[x, y, z] in corners {
            scene.blocks.push(SceneBlock::new("cube", cuboid([x, y, z], [x + 1, y + 1, z + 1])));
        }
        scene.simulation.gravity = turned([0, 0, -10]);
        scene.simulation.materials[0].density = Number::from_integer(2500);
        scene
            .simulation
            .joints
            .all_mut()
            .for_each(|joint| joint.normal_stiffness = Some(Number::from_integer(125_000)));
        scene
    }

    fn set() -> ToleranceSet {
        ToleranceSet { penetration: Number::parse("1/8").unwrap(), ..ToleranceSet::ZERO }
    }

    #[test]
    fn the_lowest_of_a_tower_bears_all_of_it_whichever_way_is_down() {
        // 25 kN a cube over four contacts of 125 kN/m: 5 cm for each cube.
        for down in 0..3 {
            let tower: Vec<_> = (0..5).map(|z| [0, 0, z]).collect();
            let found = load(&set(), &stacked(&tower, down)).unwrap();
            assert_eq!((found.block, found.allowed), (Some(1), 0.125));
            assert!((found.found - 0.25).abs() < 1e-12, "{found:?}");
            assert_eq!(found.remedy, "normal_stiffness ≥ 250001 or penetration ≥ 0.250001");
            assert_eq!(load(&set(), &stacked(&tower[..2], down)), None, "two cubes sink 10 cm");
        }
    }

    #[test]
    fn what_stands_beside_does_not_count_and_what_overhangs_counts_in_part() {
        let beside: Vec<_> = (0..8).map(|x| [x, 0, 0]).collect();
        assert_eq!(load(&set(), &stacked(&beside, 2)), None);
        let mut scene = stacked(&[[0, 0, 0], [2, 0, 0]], 2);
        let beam = |low: [i32; 3], high: [i32; 3]| {
            let at = |c: [i32; 3]| Vec3::new(c[0], c[1], c[2]).map(|&c| Number::from_integer(c));
            SceneBlock::new("beam", Block::cuboid(&at(low), &at(high)).unwrap())
        };
        // 3 m long, 75 kN on its own four contacts: 15 cm. A third of it is over each cube, which sinks 10 cm.
        scene.blocks.push(beam([0, 0, 1], [3, 1, 2]));
        let set = ToleranceSet { penetration: Number::parse("1/5").unwrap(), ..set() };
        assert_eq!(load(&set, &scene), None);
        scene.blocks.push(beam([0, 0, 2], [3, 1, 3]));
        let found = load(&set, &scene).unwrap();
        // The lower beam has all of the upper one on its four contacts: 150 kN.
        assert_eq!(found.block, Some(3));
        assert!((found.found - 0.3).abs() < 1e-12, "{found:?}");
    }

    /// A load on a block at times: so much down, and something aside.
    fn load_on(block: usize, forces: &[(i32, i32)]) -> PointLoad {
        let at = Vec3::new(0, 0, 0).map(|&c: &i32| Number::from_integer(c));
        let force = |&(time, down): &(i32, i32)| {
            (Number::from_integer(time), Vec3::new(7, 0, -down).map(|&c| Number::from_integer(c)))
        };
        PointLoad { block, at, table: forces.iter().map(force).collect() }
    }

    #[test]
    fn what_blocks_bear_has_the_loads_at_the_start_of_those_above() {
        let mut scene = stacked(&[[0, 0, 0], [0, 0, 1], [3, 0, 0]], 2);
        let borne = |scene: &Scene| weights_borne(&set(), scene, &[1, 2, 3]);
        assert_eq!(borne(&scene), [50_000.0, 25_000.0, 25_000.0]);
        // A third of the way from 1 kN to 4 kN.
        scene.simulation.loads = vec![load_on(2, &[(-1, 1000), (2, 4000)]), load_on(0, &[(0, 500)])];
        assert_eq!(borne(&scene), [52_000.0, 25_000.0, 25_000.0]);
        // Later is not now, and more than it weighs lifts it off.
        scene.simulation.loads = vec![load_on(2, &[(0, 0), (9, 8000)]), load_on(3, &[(5, 1000)])];
        assert_eq!(borne(&scene), [50_000.0, 25_000.0, 25_000.0]);
        scene.simulation.loads = vec![load_on(2, &[(0, -30_000)])];
        assert_eq!(borne(&scene), [25_000.0, 25_000.0, 25_000.0]);
    }

    #[test]
    fn loads_count_with_the_most_that_they_press_down_at_any_time() {
        let mut scene = stacked(&[[0, 0, 0], [0, 0, 1], [3, 0, 0]], 2);
        // Four contacts of 125,000 N/m: 50 kN sink 10 cm, and 12.5 cm are allowed.
        scene
            .simulation
            .joints
            .all_mut()
            .for_each(|joint| joint.normal_stiffness = Some(Number::from_integer(125_000)));
        assert_eq!(load(&set(), &scene), None);
        for (block, forces, deepest) in [
            (2, &[(0, 0), (5, 20_000), (6, 0)][..], Some((1, 0.14))),
            (1, &[(0, 30_000)], Some((1, 0.16))),
            (3, &[(0, 40_000)], Some((3, 0.13))),
            (3, &[(-1, 90_000), (0, 0)], None),
            (1, &[(0, -30_000)], None),
            (0, &[(0, 90_000)], None),
        ] {
            scene.simulation.loads = vec![load_on(block, forces)];
            let found = load(&set(), &scene).map(|found| (found.block.unwrap(), (found.found * 1e6).round() / 1e6));
            assert_eq!(found, deepest, "block {block}: {forces:?}");
        }
    }

    #[test]
    fn a_grid_of_plans_leaves_nothing_out() {
        // Towers of 1 to 7 cubes in a row, over a slab that meets many squares.
        let corners: Vec<[i32; 3]> = (0..7).flat_map(|x| (0..=x).map(move |z| [x - 3, x - 3, z])).collect();
        let scene = stacked(&corners, 2);
        let columns = ColumnSource::of(&set(), &scene).along_gravity().unwrap();
        let plans = Plans::of(&columns);
        assert_eq!(plans.wide, [0]);
        for one in &columns {
            let all = columns.iter().filter(|other| other.middle() > one.middle() && other.weight.is_some());
            let above: f64 = all.map(|other| 25_000.0 * other.shared(one)).sum();
            assert!((carried(&columns, &plans, one) - above - one.weight.unwrap_or(0.0)).abs() < 1e-6);
        }
    }

    #[test]
    fn a_stiffness_derived_from_weight_is_not_mended_by_more_penetration() {
        let tower: Vec<_> = (0..5).map(|z| [0, 0, z]).collect();
        let mut scene = stacked(&tower, 2);
        scene.simulation.materials[0].young = Number::from_integer(1);
        scene.simulation.joints.all_mut().for_each(|joint| joint.normal_stiffness = None);
        // Twice as stiff as one cube needs, so five sink two and a half times as deep as is allowed.
        let found = load(&set(), &scene).unwrap();
        assert!((found.found - 0.3125).abs() < 1e-9 && !found.remedy.contains("penetration"), "{found:?}");
    }

    #[test]
    fn what_is_above_a_fixed_block_does_not_count() {
        let tower: Vec<_> = (0..5).map(|z| [0, 0, z]).collect();
        let mut scene = stacked(&tower, 2);
        scene.blocks[2].body.motion = crate::Motion::Fixed;
        let found = load(&set(), &scene).unwrap();
        assert_eq!(found.block, Some(3), "three cubes on the fixed one, one below it");
        assert!((found.found - 0.15).abs() < 1e-12, "{found:?}");
    }

    #[test]
    fn without_gravity_or_penetration_nothing_is_said() {
        let tower: Vec<_> = (0..5).map(|z| [0, 0, z]).collect();
        let mut scene = stacked(&tower, 2);
        assert_eq!(load(&ToleranceSet::ZERO, &scene), None);
        scene.simulation.gravity = Vec3::new(0, 0, 0).map(|&c: &i32| Number::from_integer(c));
        assert_eq!(load(&set(), &scene), None);
    }
}
