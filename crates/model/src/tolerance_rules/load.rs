//! Whether a block sinks deeper than `penetration` under the blocks above it and under loads: an estimate. The rule of SPEC section 3 counts a block's own weight.

use super::six_digits;
use super::stiffness::{blocks_by_joint, nearby_softest};
use super::warning::{Warning, WarningKind};
use crate::block::Block;
use crate::number::Number;
use crate::scene::Scene;
use crate::simulation::{derive_stiffness_of, moving_blocks, smallest_face};
use crate::tolerance::ToleranceSet;
use std::collections::BTreeMap;

/// A block as others rest on it: its box along two directions across gravity and against gravity, its weight and what it rests on.
pub(super) struct Column {
    low: [f64; 3],
    high: [f64; 3],
    /// In N; `None` of a fixed block, which bears what is above it.
    pub(super) weight: Option<f64>,
    /// What loads press it down with (N), where they are counted; negative lifts it.
    pushed: f64,
    /// The softest normal stiffness it can meet times the corners of its smallest face (N/m).
    resistance: f64,
}

impl Column {
    fn middle(&self) -> f64 {
        f64::midpoint(self.low[2], self.high[2])
    }

    /// The area in which the plans of two boxes overlap (m²).
    pub(super) fn shared(&self, other: &Column) -> f64 {
        let side = |axis: usize| (self.high[axis].min(other.high[axis]) - self.low[axis].max(other.low[axis])).max(0.0);
        side(0) * side(1)
    }
}

/// The block that would sink deepest under its own weight, its loads and what those above it press down with, if that is deeper than `penetration`;
/// `None` where `penetration` is 0, which the rules refuse. `columns` are those of [`loaded_columns`].
///
/// Of each block above, that share counts which its plan (the box of its vertices across gravity) has over this block's plan; what is above a fixed
/// block in between does not count. Of equally deep blocks it is the first. The block rests on as many contacts as its smallest face has corners, each of the softest normal stiffness that
/// it can meet. Blocks lean on one another and arches carry what is above them, so this is an estimate, in f64.
pub(super) fn load(set: &ToleranceSet, scene: &Scene, columns: &[Column]) -> Option<Warning> {
    let allowed = set.penetration.approximate();
    let moving = || columns.iter().enumerate().filter(|(_, one)| one.weight.is_some() && one.resistance > 0.0);
    // Most scenes could bear all of it anywhere.
    let softest = moving().map(|(_, one)| one.resistance).fold(f64::INFINITY, f64::min);
    let total = total(columns);
    if allowed <= 0.0 || total.is_nan() || total <= allowed * softest {
        return None;
    }
    let plans = Plans::of(columns);
    let depths = moving().map(|(block, one)| (block, borne(columns, &plans, one) / one.resistance));
    let (block, depth) = depths.reduce(|deepest, next| if next.1 > deepest.1 { next } else { deepest })?;
    if depth <= allowed || !depth.is_finite() {
        return None;
    }
    let corners = smallest_face(&scene.blocks[block].block) as f64;
    let needed = depth * columns[block].resistance / (allowed * corners);
    // A stiffness that is derived may fall with a larger `penetration`, which then mends nothing.
    let deeper = ToleranceSet { penetration: Number::from_f64(depth).unwrap_or(Number::ZERO), ..set.clone() };
    let is_mended =
        self::columns(&deeper, scene).is_some_and(|then| then[block].resistance >= columns[block].resistance);
    let stiffness = format!("normal_stiffness ≥ {}", six_digits(needed, true, false));
    let penetration = is_mended.then(|| format!("penetration ≥ {}", six_digits(depth, true, false)));
    let remedy = [Some(stiffness), penetration].into_iter().flatten().collect::<Vec<_>>().join(" or ");
    Some(Warning { kind: WarningKind::Load, block: Some(block), found: depth, allowed, remedy })
}

/// All that blocks weigh and loads press down with (N).
pub(super) fn total(columns: &[Column]) -> f64 {
    columns.iter().filter_map(|one| Some(one.weight? + one.pushed.max(0.0))).sum()
}

/// What a block bears with its own weight and its own loads (N).
pub(super) fn borne(columns: &[Column], plans: &Plans, one: &Column) -> f64 {
    carried(columns, plans, one) + one.pushed
}

/// All blocks, each with the most that its loads press it down with at any time; `None` without gravity. Of several loads on one block the sum of what each presses at most.
pub(super) fn loaded_columns(set: &ToleranceSet, scene: &Scene) -> Option<Vec<Column>> {
    let mut columns = columns(set, scene)?;
    let gravity = scene.simulation.gravity.components().map(Number::approximate);
    let pull = dot(gravity, gravity).sqrt();
    let down = gravity.map(|part| part / pull);
    for load in &scene.simulation.loads {
        let later = load.table.iter().filter(|(time, _)| *time > Number::ZERO);
        let forces = later.map(|(_, force)| force.components().map(Number::approximate)).chain([load.at_start()]);
        let down = forces.map(|force| dot(force, down)).fold(f64::NEG_INFINITY, f64::max);
        columns[load.block].pushed += down;
    }
    Some(columns)
}

/// What some blocks of a scene bear when time begins with their own weight, as the warning `load` estimates it (N), with the loads along gravity of the
/// blocks above, but not their own; 0 of each without gravity.
pub fn weights_borne(set: &ToleranceSet, scene: &Scene, blocks: &[usize]) -> Vec<f64> {
    let Some(mut columns) = columns(set, scene) else { return vec![0.0; blocks.len()] };
    let gravity = scene.simulation.gravity.components().map(Number::approximate);
    let pull = dot(gravity, gravity).sqrt();
    for load in &scene.simulation.loads {
        columns[load.block].pushed += dot(load.at_start(), gravity) / pull;
    }
    let plans = Plans::of(&columns);
    blocks.iter().map(|&block| carried(&columns, &plans, &columns[block])).collect()
}

/// All blocks; `None` without gravity.
fn columns(set: &ToleranceSet, scene: &Scene) -> Option<Vec<Column>> {
    let mut simulation = scene.simulation.clone();
    let bodies: Vec<_> = scene.blocks.iter().map(|b| (&b.block, &b.body)).collect();
    let moving = moving_blocks(&bodies);
    derive_stiffness_of(&mut simulation, &moving, set);
    let gravity = simulation.gravity.components().map(Number::approximate);
    let pull = dot(gravity, gravity).sqrt();
    if pull == 0.0 || !pull.is_finite() {
        return None;
    }
    let axes = across_and_against(gravity.map(|g| g / pull));
    let joints = blocks_by_joint(&simulation, &scene.blocks);
    let softest = nearby_softest(&simulation, &joints);
    let mut weights = vec![None; scene.blocks.len()];
    for one in &moving {
        weights[one.number] = Some(simulation.materials[one.body.material].density.approximate() * one.volume * pull);
    }
    let column = |(weight, &(block, body)): (Option<f64>, &(&Block, _))| {
        let body: &crate::simulation::Body = body;
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for vertex in block.vertices() {
            let at = vertex.components().map(Number::approximate);
            for (axis, direction) in axes.into_iter().enumerate() {
                let along = dot(at, direction);
                low[axis] = low[axis].min(along);
                high[axis] = high[axis].max(along);
            }
        }
        Column { low, high, weight, pushed: 0.0, resistance: softest(body.joint) * smallest_face(block) as f64 }
    };
    Some(weights.into_iter().zip(&bodies).map(column).collect())
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Two directions across a unit vector, and the one against it.
fn across_and_against(down: [f64; 3]) -> [[f64; 3]; 3] {
    let [x, y, z] = down;
    // The axis that it lies along least.
    let least = (0..3).min_by(|&i, &j| down[i].abs().total_cmp(&down[j].abs())).unwrap_or(0);
    let mut first = down.map(|d| -d * down[least]);
    first[least] += 1.0;
    let length = dot(first, first).sqrt();
    let [a, b, c] = first.map(|f| f / length);
    [[a, b, c], [y * c - z * b, z * a - x * c, x * b - y * a], [-x, -y, -z]]
}

/// The blocks by the squares of a grid across gravity that their plans meet.
pub(super) struct Plans {
    /// The side of a square (m): half of the blocks are no longer.
    side: f64,
    squares: BTreeMap<[i64; 2], Vec<usize>>,
    /// Blocks that meet more squares than are worth a list.
    wide: Vec<usize>,
}

/// Squares that a plan may meet before it is in a list of its own.
const SQUARES: i64 = 64;

impl Plans {
    pub(super) fn of(columns: &[Column]) -> Plans {
        let mut sides: Vec<f64> =
            columns.iter().map(|one| (0..2).map(|k| one.high[k] - one.low[k]).fold(0.0, f64::max)).collect();
        sides.sort_by(f64::total_cmp);
        let side = sides.get(sides.len() / 2).copied().unwrap_or(1.0);
        let mut plans = Plans { side, squares: BTreeMap::new(), wide: Vec::new() };
        for (block, one) in columns.iter().enumerate() {
            match plans.squares_of(one) {
                None => plans.wide.push(block),
                Some(squares) => squares.for_each(|at| plans.squares.entry(at).or_default().push(block)),
            }
        }
        plans
    }

    /// `None` where there are too many.
    fn squares_of(&self, one: &Column) -> Option<impl Iterator<Item = [i64; 2]> + use<>> {
        let [[x, to_x], [y, to_y]] =
            [0, 1].map(|k| [one.low[k], one.high[k]].map(|at| (at / self.side).floor() as i64));
        let count = to_x.saturating_sub(x).saturating_add(1).saturating_mul(to_y.saturating_sub(y).saturating_add(1));
        (count <= SQUARES).then(|| (x..=to_x).flat_map(move |i| (y..=to_y).map(move |j| [i, j])))
    }

    /// The blocks whose plans may overlap that of a block, each once.
    fn near(&self, one: &Column) -> Vec<usize> {
        let listed = |at| self.squares.get(&at).into_iter().flatten();
        let mut near: Vec<usize> = match self.squares_of(one) {
            Some(squares) => squares.flat_map(listed).copied().collect(),
            None => self.squares.values().flatten().copied().collect(),
        };
        near.extend(&self.wide);
        near.sort_unstable();
        near.dedup();
        near
    }
}

/// The weight of a block and of what stands above it with what that is pressed down with (N).
fn carried(columns: &[Column], plans: &Plans, one: &Column) -> f64 {
    let above = |other: &&Column| other.middle() > one.middle() && other.shared(one) > 0.0;
    let over: Vec<&Column> = plans.near(one).into_iter().map(|k| &columns[k]).filter(above).collect();
    let fixed: Vec<&Column> = over.iter().copied().filter(|other| other.weight.is_none()).collect();
    let is_borne = |other: &Column| fixed.iter().any(|f| f.middle() < other.middle() && f.shared(other) > 0.0);
    let loads = over
        .iter()
        .filter(|other| !is_borne(other))
        .filter_map(|other| Some((other.weight? + other.pushed).max(0.0) * other.shared(one) / other.shared(other)));
    one.weight.unwrap_or(0.0) + loads.sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::{load as of_columns, *};
    use crate::simulation::PointLoad;
    use crate::{SceneBlock, Vec3};

    fn load(set: &ToleranceSet, scene: &Scene) -> Option<Warning> {
        of_columns(set, scene, &loaded_columns(set, scene)?)
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
        let columns = columns(&set(), &stacked(&corners, 2)).unwrap();
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
