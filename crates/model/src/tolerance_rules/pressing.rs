//! What is worst along all directions in which weights and loads press blocks against others.

use super::along_faces::{AlongFaces, Effort, MOST};
use super::column::{Column, ColumnSource, gravity};
use super::load::{Sunk, deepest};
use super::load_sums::{load_sums, most_along};
use super::strain::{MAX_STRAIN, deformable, most_squashed};
use super::warning::{Warning, WarningKind};
use crate::number::Number;
use crate::scene::Scene;
use crate::tolerance::ToleranceSet;

/// What is worst along all directions in which something may be pressed.
#[derive(Default)]
pub(super) struct Worst {
    /// The block that sinks deepest, if that is deeper than `penetration`.
    pub(super) sunk: Option<Sunk>,
    /// The block that is squashed most, and its strain.
    pub(super) squashed: Option<(usize, f64)>,
    /// What the estimate along faces took.
    pub(super) effort: Effort,
}

impl Worst {
    fn add(&mut self, scene: &Scene, columns: &[Column], allowed: f64) {
        let sunk = deepest(columns, allowed);
        if self.sunk.as_ref().is_none_or(|before| sunk.as_ref().is_some_and(|next| next.depth > before.depth)) {
            self.sunk = sunk.or(self.sunk.take());
        }
        let squashed = most_squashed(scene, columns);
        if self.squashed.is_none_or(|(_, before)| squashed.is_some_and(|(_, next)| next > before)) {
            self.squashed = squashed.or(self.squashed);
        }
    }
}

/// The worst along gravity, with the most that loads press along it at any time, and along each face that something stands against.
pub(super) fn worst(source: &ColumnSource<'_>, set: &ToleranceSet, scene: &Scene) -> Worst {
    let (mut worst, allowed, loads) = (Worst::default(), set.penetration.approximate(), load_sums(scene));
    if let Some((mut columns, (down, _))) = source.along_gravity().zip(gravity(scene)) {
        for (block, sums) in &loads {
            columns[*block].pushed = most_along(sums, down);
        }
        worst.add(scene, &columns, allowed);
    }
    if !loads.is_empty() {
        let along_faces = AlongFaces { source, scene, loads, within: allowed, bearable: bearable(source, set, scene) };
        worst.effort = along_faces.each(MOST, |columns| worst.add(scene, columns, allowed));
    }
    worst
}

/// Directions along which loads press that were not looked along, since a model is too large.
pub(super) fn left_out(effort: &Effort) -> Option<Warning> {
    let [all, looked_along] = effort.directions.map(|count| count as f64);
    (looked_along < all).then(|| Warning {
        kind: WarningKind::Loads,
        block: None,
        found: all,
        allowed: looked_along,
        remedy: "fewer blocks with loads, or a part of the model".to_owned(),
    })
}

/// A force (N) that sinks no block deeper than `penetration` and strains none by more than [`MAX_STRAIN`], wherever it presses: most scenes' loads together are less.
fn bearable(source: &ColumnSource<'_>, set: &ToleranceSet, scene: &Scene) -> f64 {
    let least = |all: &mut dyn Iterator<Item = f64>| all.filter(|one| *one > 0.0).fold(f64::INFINITY, f64::min);
    let softest = least(&mut source.contacts.iter().copied());
    // No plan of a block is smaller than its volume over its height, which is no more than twice its radius.
    let area = |block: usize| {
        Number::from_rational(scene.blocks[block].block.volume()).approximate() / (2.0 * source.shapes()[block].radius)
    };
    let weakest = MAX_STRAIN * least(&mut deformable(scene).map(|(block, young)| young * area(block)));
    let penetration = set.penetration.approximate();
    if penetration > 0.0 { weakest.min(penetration * softest) } else { weakest }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::block::{Block, BlockOptions};
    use crate::simulation::{FixedPoint, PointLoad};
    use crate::tolerance_rules::{WarningKind, warnings};
    use crate::topology::VertexId;
    use crate::{SceneBlock, Vec3};

    fn at(c: [i32; 3]) -> Vec3<Number> {
        Vec3::new(c[0], c[1], c[2]).map(|&c| Number::from_integer(c))
    }

    fn cuboid(low: [i32; 3], high: [i32; 3]) -> Block {
        Block::cuboid(&at(low), &at(high)).unwrap()
    }

    /// A rigid cube of 25 kN between a fixed floor and a fixed roof 1 m above it, beside a fixed wall, with contacts of 125,000 N/m and a load; how deep it sinks, if deeper than 12.5 cm.
    fn depth(force: [i32; 3], held: &[(i32, [i32; 3])]) -> Option<f64> {
        let mut scene = Scene::on_fixed("floor", cuboid([-9, -9, -1], [9, 9, 0]));
        for (low, high) in [([-9, -9, 2], [9, 9, 3]), ([1, -9, 0], [2, 9, 2]), ([0, 0, 0], [1, 1, 1])] {
            scene.blocks.push(SceneBlock::new("block", cuboid(low, high)));
        }
        scene.blocks.iter_mut().take(3).for_each(|block| block.body.motion = crate::Motion::Fixed);
        scene.blocks[3].body.motion = crate::Motion::Rigid;
        scene.simulation.gravity = at([0, 0, -10]);
        scene.simulation.materials[0].density = Number::from_integer(2500);
        let stiffness = Number::from_integer(125_000);
        scene.simulation.joints.all_mut().for_each(|joint| joint.normal_stiffness = Some(stiffness.clone()));
        scene.simulation.loads =
            vec![PointLoad { block: 3, at: at([0, 0, 0]), table: vec![(Number::ZERO, at(force))] }];
        let point =
            |&(stiffness, to)| FixedPoint { block: 3, at: at(to), stiffness: Some(Number::from_integer(stiffness)) };
        scene.simulation.fixed_points = held.iter().map(point).collect();
        let set =
            ToleranceSet { penetration: Number::parse("1/8").unwrap(), close: Number::ZERO, ..ToleranceSet::ZERO };
        let found = warnings(&set, &scene).into_iter().find(|warning| warning.kind == WarningKind::Load)?;
        assert_eq!(found.block, Some(3));
        Some((found.found * 1e9).round() / 1e9)
    }

    #[test]
    fn loads_press_where_something_stands_and_weights_hold_them_back() {
        assert_eq!(depth([100_000, 0, 0], &[]), Some(0.2), "onto the wall");
        assert_eq!(depth([-100_000, 0, 0], &[]), None, "away from it");
        assert_eq!(depth([0, 100_000, 0], &[]), None, "along it");
        assert_eq!(depth([0, 0, 100_000], &[]), Some(0.15), "lifted into the roof, less its weight");
        assert_eq!(depth([0, 0, -100_000], &[]), Some(0.25), "along gravity, with its weight");
    }

    #[test]
    fn fixed_points_bear_a_load_where_they_hold_a_block_on_all_sides() {
        let [at_origin, along_x, along_y] = [[0; 3], [1, 0, 0], [0, 1, 0]].map(|to| (200_000, to));
        let pushed = |held: &[(i32, [i32; 3])]| depth([100_000, 0, 0], held);
        assert_eq!(pushed(&[at_origin, along_x, along_y]), None, "100 kN on 1,100 kN/m");
        assert_eq!(pushed(&[(900_000, [0; 3])]), Some(0.2), "it turns about one");
        assert_eq!(pushed(&[at_origin, (200_000, [0, 2, 0]), along_y]), Some(0.2), "and about a line");
    }

    /// The cube of [`depth`] without gravity, under loads along x at its corner, by times.
    fn depth_of(tables: &[&[(i32, i32)]]) -> Option<f64> {
        let (source_set, mut scene) = cube_at_wall();
        let load = |table: &&[(i32, i32)]| PointLoad {
            block: 1,
            at: at([0, 0, 0]),
            table: table.iter().map(|&(time, force)| (Number::from_integer(time), at([force, 0, 0]))).collect(),
        };
        scene.simulation.loads = tables.iter().map(load).collect();
        let source = ColumnSource::of(&source_set, &scene);
        worst(&source, &source_set, &scene).sunk.map(|sunk| (sunk.depth * 1e9).round() / 1e9)
    }

    /// A rigid cube of 1 m beside a fixed wall, without gravity, with contacts of 125,000 N/m, and a set that allows 12.5 cm.
    fn cube_at_wall() -> (ToleranceSet, Scene) {
        let mut scene = Scene::on_fixed("wall", cuboid([1, -9, 0], [2, 9, 2]));
        scene.blocks.push(SceneBlock::new("cube", cuboid([0, 0, 0], [1, 1, 1])));
        scene.blocks[1].body.motion = crate::Motion::Rigid;
        scene.simulation.gravity = at([0, 0, 0]);
        let stiffness = Number::from_integer(125_000);
        scene.simulation.joints.all_mut().for_each(|joint| joint.normal_stiffness = Some(stiffness.clone()));
        let set = ToleranceSet { penetration: Number::parse("1/8").unwrap(), ..ToleranceSet::ZERO };
        (set, scene)
    }

    #[test]
    fn loads_of_a_block_are_added_at_each_time() {
        assert_eq!(depth_of(&[&[(0, 100_000)]]), Some(0.2));
        assert_eq!(depth_of(&[&[(0, 100_000)], &[(0, -100_000)]]), None, "they cancel");
        let late: &[(i32, i32)] = &[(0, 0), (5, 100_000), (6, 0)];
        assert_eq!(depth_of(&[late, late]), Some(0.4), "at one time");
        assert_eq!(depth_of(&[late, &[(6, 0), (7, 100_000), (8, 0)]]), Some(0.2), "at two times");
        // Between its own times: 100 kN on the way down meets half of the other's 100 kN on the way up.
        assert_eq!(depth_of(&[late, &[(0, 0), (10, 100_000)]]), Some(0.3));
        assert_eq!(depth_of(&[&[(-3, 400_000), (-1, 0)]]), None, "before time begins");
    }

    #[test]
    fn loads_across_a_face_press_nothing_but_rounding() {
        let (set, mut scene) = cube_at_wall();
        let force = Vec3::new("1e-3", "1e9", "0").map(|part| Number::parse(part).unwrap());
        scene.simulation.loads = vec![PointLoad { block: 1, at: at([0, 0, 0]), table: vec![(Number::ZERO, force)] }];
        scene.simulation.joints.all_mut().for_each(|joint| joint.normal_stiffness = Number::parse("1e-6").ok());
        assert_eq!(worst(&ColumnSource::of(&set, &scene), &set, &scene).sunk, None);
    }

    #[test]
    fn a_load_onto_a_slanting_face_is_added_to_the_weight() {
        let (set, mut scene) = cube_at_wall();
        // A prism that lies with a face of 45° on a fixed one; 40 kN along x, and a weight of 40 kN.
        let prism = |points: [[i32; 2]; 3]| {
            let at_y = |y: i32| points.map(|[x, z]| at([x, y, z]));
            let points = at_y(0).into_iter().chain(at_y(1)).collect();
            let faces: [&[u32]; 5] = [&[0, 1, 2], &[5, 4, 3], &[0, 3, 4, 1], &[1, 4, 5, 2], &[2, 5, 3, 0]];
            let loops = faces.iter().map(|face| face.iter().map(|&k| VertexId(k)).collect());
            Block::new(points, loops.collect(), &BlockOptions::default()).unwrap()
        };
        scene.blocks[0].block = prism([[0, 0], [1, 0], [1, 1]]);
        scene.blocks[1].block = prism([[0, 0], [1, 1], [0, 1]]);
        scene.simulation.gravity = at([0, 0, -10]);
        scene.simulation.materials[0].density = Number::from_integer(8000);
        let depth = |force: i32| {
            let mut scene = scene.clone();
            let table = vec![(Number::ZERO, at([force, 0, 0]))];
            scene.simulation.loads = vec![PointLoad { block: 1, at: at([0, 0, 0]), table }];
            worst(&ColumnSource::of(&set, &scene), &set, &scene).sunk.map(|sunk| sunk.depth)
        };
        // (F + W)·cos 45° on three contacts.
        let found = depth(40_000).unwrap();
        assert!((found - 80_000.0 * 0.5_f64.sqrt() / 375_000.0).abs() < 1e-9, "{found}");
        assert_eq!(depth(-40_000), None, "just lifted off");
    }

    #[test]
    fn depths_that_f64_does_not_hold_are_told() {
        let (set, mut scene) = cube_at_wall();
        let force = Vec3::new("1e308", "0", "0").map(|part| Number::parse(part).unwrap());
        scene.simulation.loads = vec![PointLoad { block: 1, at: at([0, 0, 0]), table: vec![(Number::ZERO, force)] }];
        scene.simulation.joints.all_mut().for_each(|joint| joint.normal_stiffness = Number::parse("1e-6").ok());
        let found = warnings(&set, &scene).into_iter().find(|warning| warning.kind == WarningKind::Load).unwrap();
        assert_eq!((found.block, found.found), (Some(1), f64::INFINITY));
    }
}
