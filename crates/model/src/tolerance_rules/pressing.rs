//! The directions in which loads press blocks against others, whatever gravity does: those of faces that something stands against.

use super::column::{Column, ColumnSource, across_and_against, box_along, dot, gravity, point};
use super::strain::{MAX_STRAIN, deformable};
use crate::block::Block;
use crate::number::Number;
use crate::scene::Scene;
use crate::simulation::PointLoad;
use crate::tolerance::ToleranceSet;
use crate::topology::VertexId;
use std::collections::BTreeMap;

/// The blocks along each direction in which something may be pressed: gravity, with the most that loads press along it at any time, and the directions of [`pushes`].
/// Along those a weight counts only where it holds back: what it presses with is estimated along gravity.
pub(super) fn loaded_columns(source: &ColumnSource<'_>, set: &ToleranceSet, scene: &Scene) -> Vec<Vec<Column>> {
    let along_gravity = source.along_gravity().map(|mut columns| {
        let down = gravity(scene).map_or([0.0; 3], |(down, _)| down);
        for load in &scene.simulation.loads {
            columns[load.block].pushed += forces(load).map(|force| dot(force, down)).fold(f64::NEG_INFINITY, f64::max);
        }
        columns
    });
    let pulls = scene.simulation.gravity.components().map(Number::approximate);
    let pushes = if may_press(source, set, scene) { pushes(set, scene) } else { Pushes::new() };
    let along = pushes.into_values().map(|(direction, pushed)| {
        let mut columns = source.along(direction, dot(pulls, direction).min(0.0));
        pushed.into_iter().for_each(|(block, force)| columns[block].pushed = force);
        columns
    });
    along_gravity.into_iter().chain(along).collect()
}

/// The forces of a load from time 0 on, at the ends of the stretches on which it is linear (N).
pub(super) fn forces(load: &PointLoad) -> impl Iterator<Item = [f64; 3]> {
    let later = load.table.iter().filter(|(time, _)| *time > Number::ZERO);
    later.map(|(_, force)| force.components().map(Number::approximate)).chain([load.at_start()])
}

/// Whether all loads together could press a block deeper than `penetration` or strain it by more than [`MAX_STRAIN`], as most scenes' cannot.
fn may_press(source: &ColumnSource<'_>, set: &ToleranceSet, scene: &Scene) -> bool {
    if scene.simulation.loads.is_empty() {
        return false;
    }
    let size = |force: [f64; 3]| dot(force, force).sqrt();
    let total: f64 = scene.simulation.loads.iter().map(|load| forces(load).map(size).fold(0.0, f64::max)).sum();
    let least = |all: &mut dyn Iterator<Item = f64>| all.filter(|one| *one > 0.0).fold(f64::INFINITY, f64::min);
    let softest = least(&mut source.contacts.iter().copied());
    // No plan of a block is smaller than its volume over the diagonal of its box.
    let area = |block: usize| {
        let shape = &scene.blocks[block].block;
        let [low, high] =
            box_along(shape.vertices().iter().map(point), [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        let diagonal = size(std::array::from_fn(|k| high[k] - low[k]));
        Number::from_rational(shape.volume()).approximate() / diagonal
    };
    let weakest = least(&mut deformable(scene).map(|(block, young)| young * area(block)));
    total > set.penetration.approximate() * softest || total > MAX_STRAIN * weakest
}

/// Directions (unit vectors) by their rounded components, each with the blocks that loads press along it and how much at most (N).
type Pushes = BTreeMap<[i64; 3], ([f64; 3], BTreeMap<usize, f64>)>;

/// What a load presses a block with along each face that something stands against, gravity's direction left out; of several loads on one block the sum of what each presses at most.
///
/// A contact pushes along the normal of a face of one of the two blocks (but for crossing edges). So a load F presses with F·n along the outward normal n of a face of its block that
/// another block is wholly in front of, and along −n for a face of another block that the loaded one is wholly in front of, where the two overlap seen along n. How far
/// apart they are does not matter: the load goes on. In front means by no more than `penetration` behind the plane. Of a block that is not convex, whatever is ahead of a face stands against it.
fn pushes(set: &ToleranceSet, scene: &Scene) -> Pushes {
    let down = gravity(scene).map(|(down, _)| down);
    let mut loads: BTreeMap<usize, Vec<&PointLoad>> = BTreeMap::new();
    for load in scene.simulation.loads.iter().filter(|load| !scene.blocks[load.block].body.is_fixed()) {
        loads.entry(load.block).or_default().push(load);
    }
    let shapes: Vec<Shape<'_>> =
        if loads.is_empty() { Vec::new() } else { scene.shapes().into_iter().map(Shape::of).collect() };
    let mut pushes = Pushes::new();
    for (block, loads) in loads {
        let pressed = |n: [f64; 3]| -> f64 {
            loads.iter().map(|load| forces(load).map(|force| dot(force, n)).fold(0.0, f64::max)).sum()
        };
        for n in directions_against(&shapes, block, set.penetration.approximate(), |n| pressed(n) > 0.0) {
            if down.is_some_and(|down| dot(down, n) > 1.0 - 1e-12) {
                continue;
            }
            let (_, blocks) = pushes.entry(n.map(|part| (part * 1e7).round() as i64)).or_insert((n, BTreeMap::new()));
            blocks.insert(block, pressed(n));
        }
    }
    pushes
}

/// Whether anything stands against a block that is pushed by a force, as [`pushes`] has it.
pub(super) fn stands_against(set: &ToleranceSet, scene: &Scene, block: usize, force: [f64; 3]) -> bool {
    let shapes: Vec<Shape<'_>> = scene.shapes().into_iter().map(Shape::of).collect();
    !directions_against(&shapes, block, set.penetration.approximate(), |n| dot(force, n) > 0.0).is_empty()
}

/// A block in f64.
struct Shape<'b> {
    block: &'b Block,
    points: Vec<[f64; 3]>,
    /// The outward unit normal of each face with area, and its loop.
    faces: Vec<([f64; 3], &'b [VertexId])>,
}

impl Shape<'_> {
    fn of(block: &Block) -> Shape<'_> {
        let points: Vec<[f64; 3]> = block.vertices().iter().map(point).collect();
        let normal = |face: &[VertexId]| {
            let arm = |vertex: VertexId| -> [f64; 3] {
                std::array::from_fn(|k| points[vertex.index()][k] - points[face[0].index()][k])
            };
            let sum = face[1..].windows(2).fold([0.0; 3], |sum: [f64; 3], pair| {
                let ([a, b, c], [x, y, z]) = (arm(pair[0]), arm(pair[1]));
                [sum[0] + b * z - c * y, sum[1] + c * x - a * z, sum[2] + a * y - b * x]
            });
            let length = dot(sum, sum).sqrt();
            (length > 0.0).then(|| sum.map(|part| part / length))
        };
        let faces = block.topology().faces().iter().filter_map(|face| Some((normal(face)?, face.as_slice()))).collect();
        Shape { block, points, faces }
    }

    fn corners<'s>(&'s self, face: &'s [VertexId]) -> impl Iterator<Item = [f64; 3]> + 's {
        face.iter().map(|vertex| self.points[vertex.index()])
    }
}

/// The directions n along which another block stands against a block, of those for which `is_asked`.
fn directions_against(
    shapes: &[Shape<'_>],
    block: usize,
    within: f64,
    is_asked: impl Fn([f64; 3]) -> bool,
) -> Vec<[f64; 3]> {
    let own = &shapes[block];
    let others = || shapes.iter().enumerate().filter(|(other, _)| *other != block).map(|(_, other)| other);
    let of_own = own.faces.iter().filter(|(n, _)| is_asked(*n));
    let of_own = of_own.filter(|(n, face)| others().any(|other| is_ahead(*n, (own, face), other, within)));
    let of_others =
        others().flat_map(|other| other.faces.iter().map(move |(n, face)| (other, n.map(|part| -part), face)));
    let of_others = of_others.filter(|(_, n, _)| is_asked(*n));
    let of_others = of_others.filter(|(other, n, face)| is_ahead(n.map(|part| -part), (other, face), own, within));
    of_own.map(|(n, _)| *n).chain(of_others.map(|(_, n, _)| n)).collect()
}

/// Whether a block is in front of a face of another one and overlaps it seen along the normal.
fn is_ahead(normal: [f64; 3], (owner, face): (&Shape<'_>, &[VertexId]), other: &Shape<'_>, within: f64) -> bool {
    let axes = across_and_against(normal);
    let [face_low, face_high] = box_along(owner.corners(face), axes);
    let [low, high] = box_along(other.points.iter().copied(), axes);
    // The third axis is against the normal: what is in front of the face is lower.
    let is_convex = owner.block.is_convex() && other.block.is_convex();
    let is_in_front = if is_convex { high[2] <= face_high[2] + within } else { low[2] < face_low[2] - within };
    // What touches along an edge alone does not overlap, but for rounding.
    let overlap = |axis: usize| face_high[axis].min(high[axis]) - face_low[axis].max(low[axis]);
    is_in_front && (0..2).all(|axis| overlap(axis) > 1e-6 * (face_high[axis] - face_low[axis]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::FixedPoint;
    use crate::tolerance_rules::{WarningKind, warnings};
    use crate::{SceneBlock, Vec3};

    fn at(c: [i32; 3]) -> Vec3<Number> {
        Vec3::new(c[0], c[1], c[2]).map(|&c| Number::from_integer(c))
    }

    fn cuboid(low: [i32; 3], high: [i32; 3]) -> Block {
        Block::cuboid(&at(low), &at(high)).unwrap()
    }

    /// A rigid cube of 25 kN between a fixed floor and a fixed roof 1 m above it, beside a fixed wall, with contacts of 125,000 N/m and a load; how deep it sinks, if deeper than 12.5 cm.
    fn depth(force: [i32; 3], held: Option<i32>) -> Option<f64> {
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
            |stiffness| FixedPoint { block: 3, at: at([0, 0, 0]), stiffness: Some(Number::from_integer(stiffness)) };
        scene.simulation.fixed_points = held.map(point).into_iter().collect();
        let set =
            ToleranceSet { penetration: Number::parse("1/8").unwrap(), close: Number::ZERO, ..ToleranceSet::ZERO };
        let found = warnings(&set, &scene).into_iter().find(|warning| warning.kind == WarningKind::Load)?;
        assert_eq!(found.block, Some(3));
        Some((found.found * 1e9).round() / 1e9)
    }

    #[test]
    fn loads_press_where_something_stands_and_weights_hold_them_back() {
        assert_eq!(depth([100_000, 0, 0], None), Some(0.2), "onto the wall");
        assert_eq!(depth([100_000, 0, 0], Some(500_000)), None, "10 cm with a fixed point");
        assert_eq!(depth([-100_000, 0, 0], None), None, "away from it");
        assert_eq!(depth([0, 100_000, 0], None), None, "along it");
        assert_eq!(depth([0, 0, 100_000], None), Some(0.15), "lifted into the roof, less its weight");
        assert_eq!(depth([0, 0, -100_000], None), Some(0.25), "along gravity, with its weight");
    }
}
