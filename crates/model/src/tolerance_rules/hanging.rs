//! Whether a block hangs from fixed points that are too soft to hold it: an estimate.

use super::column::{ColumnSource, Plans, across_and_against, box_along, carried, dot, gravity};
use super::load_sums::{LoadSums, load_sums};
use super::places::Places;
use super::shape::{Shape, gap_ahead, largest, length, minus};
use super::six_digits;
use super::warning::{Warning, WarningKind};
use crate::scene::Scene;
use crate::tolerance::ToleranceSet;
use std::cell::OnceCell;

/// The sine of 5°: a face that a force meets at less bears none of it worth counting.
const LEAST_SINE: f64 = 0.0871557;

/// The block that its fixed points alone hold and that moves furthest, for its size, before they do, if that is more than half of the smallest side of its box: its centroid then is where its
/// surface was. The springs of a block's fixed points, k together, move by F/k under what it bears along gravity (as [`load`](super::load::load) has it) and its loads, at any time.
/// Where another block stands against that force, no further away than the block may move, contacts bear it too, and nothing is said.
pub(super) fn hanging(set: &ToleranceSet, scene: &Scene, source: &ColumnSource<'_>) -> Option<Warning> {
    let held = |block: &usize| source.masses[*block].is_some() && source.held[*block] > 0.0;
    let hung: Vec<usize> = (0..scene.blocks.len()).filter(held).collect();
    if hung.is_empty() {
        return None;
    }
    let (loads, shapes, within) = (load_sums(scene), source.shapes(), set.penetration.approximate());
    let along_gravity = source.along_gravity().zip(gravity(scene)).map(|(columns, (down, _))| (columns, down));
    let plans = along_gravity.as_ref().map(|(columns, _)| Plans::of(columns));
    let places = OnceCell::new();
    let stretched = hung.into_iter().filter_map(|block| {
        let weight = along_gravity.as_ref().zip(plans.as_ref()).map_or([0.0; 3], |((columns, down), plans)| {
            down.map(|part| part * carried(columns, plans, &columns[block]))
        });
        let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let [low, high] = box_along(shapes[block].points.iter().copied(), axes);
        let allowed = (0..3).map(|k| high[k] - low[k]).fold(f64::INFINITY, f64::min) / 2.0;
        let moves = |force: [f64; 3]| (force, length(force) / source.held[block]);
        let beyond: Vec<_> = forces(&loads, block, weight).map(moves).filter(|(_, by)| *by > allowed).collect();
        let around = || places.get_or_init(|| Places::of(shapes));
        let against =
            if beyond.is_empty() { Vec::new() } else { stand_around(shapes, around(), block, [within, allowed]) };
        let is_free = |force: [f64; 3]| {
            let least = LEAST_SINE * length(force);
            !against.iter().any(|n| dot(force, *n) >= least)
        };
        let (_, found) = largest(beyond.into_iter().filter(|(force, _)| is_free(*force)))?;
        Some(((block, found, allowed), found / allowed))
    });
    let ((block, found, allowed), _) = largest(stretched)?;
    let points = scene.simulation.fixed_points.iter().filter(|point| point.block == block).count();
    let needed = six_digits(found * source.held[block] / (allowed * points as f64), true, false);
    let remedy = format!("stiffness of its {points} [[fixed_point]] ≥ {needed}");
    Some(Warning { kind: WarningKind::Hanging, block: Some(block), found, allowed, remedy })
}

/// The forces on a block where one may be the greatest: its loads together at each of their times, and what it bears along gravity (N).
fn forces(loads: &LoadSums, block: usize, weight: [f64; 3]) -> impl Iterator<Item = [f64; 3]> + '_ {
    let none = loads.get(&block).is_none().then_some([0.0; 3]);
    let sums = loads.get(&block).into_iter().flatten().copied().chain(none);
    sums.map(move |force| std::array::from_fn(|k| weight[k] + force[k]))
}

/// The directions along which another block stands against a block, no more than `reach` before it.
fn stand_around(shapes: &[Shape<'_>], places: &Places, block: usize, [within, reach]: [f64; 2]) -> Vec<[f64; 3]> {
    let own = &shapes[block];
    let mut against = Vec::new();
    // Blocks that face one another are no further apart than both radii, and `reach`, along a normal, and both radii along either direction across it.
    let widest = |radius: f64| 2.0 * (own.radius + radius) + reach;
    for other in places.near(own.centre, widest(places.radius)).filter(|other| *other != block) {
        let other = &shapes[other];
        let (arm, widest) = (minus(other.centre, own.centre), widest(other.radius));
        if dot(arm, arm) > widest * widest {
            continue;
        }
        let stands = |owner: &Shape<'_>, face: usize, ahead: &Shape<'_>| {
            let axes = across_and_against(owner.faces[face].normal);
            let of_ahead = box_along(ahead.points.iter().copied(), axes);
            let are_convex = owner.is_convex && ahead.is_convex;
            gap_ahead(owner.face_box(face, axes), of_ahead, are_convex, within).is_some_and(|gap| gap <= reach)
        };
        let of_own = (0..own.faces.len()).filter(|&face| stands(own, face, other));
        against.extend(of_own.map(|face| own.faces[face].normal));
        let of_other = (0..other.faces.len()).filter(|&face| stands(other, face, own));
        against.extend(of_other.map(|face| other.faces[face].normal.map(|part| -part)));
    }
    against
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::Number;
    use crate::simulation::{FixedPoint, PointLoad};
    use crate::{Block, SceneBlock, Vec3};

    fn at(c: [i32; 3]) -> Vec3<Number> {
        Vec3::new(c[0], c[1], c[2]).map(|&c| Number::from_integer(c))
    }

    /// A cube of 1 m and 25 kN on one fixed point of 10 kN/m, at this height above a fixed slab, under forces by times.
    fn moved(height: i32, pull: i32, tables: &[&[(i32, [i32; 3])]]) -> Option<f64> {
        let cuboid = |low, high| Block::cuboid(&at(low), &at(high)).unwrap();
        let mut scene = Scene::on_fixed("slab", cuboid([-9, -9, -1], [9, 9, 0]));
        scene.blocks.push(SceneBlock::new("cube", cuboid([0, 0, height], [1, 1, height + 1])));
        scene.simulation.gravity = at([0, 0, -pull]);
        scene.simulation.materials[0].density = Number::from_integer(2500);
        let stiffness = Some(Number::from_integer(10_000));
        scene.simulation.fixed_points = vec![FixedPoint { block: 1, at: at([0, 0, height]), stiffness }];
        let load = |table: &&[(i32, [i32; 3])]| PointLoad {
            block: 1,
            at: at([0, 0, height]),
            table: table.iter().map(|&(time, force)| (Number::from_integer(time), at(force))).collect(),
        };
        scene.simulation.loads = tables.iter().map(load).collect();
        let set = ToleranceSet { penetration: Number::parse("1/50").unwrap(), ..ToleranceSet::ZERO };
        hanging(&set, &scene, &ColumnSource::of(&set, &scene)).map(|warning| warning.found)
    }

    #[test]
    fn a_floor_bears_a_block_where_it_is_within_reach() {
        assert_eq!(moved(0, 10, &[]), None, "flush");
        assert_eq!(moved(5, 10, &[]), Some(2.5), "5 m below");
        assert_eq!(moved(1, 10, &[]), Some(2.5), "further than half of its side");
        assert_eq!(moved(0, -10, &[]), Some(2.5), "gravity away from it");
    }

    #[test]
    fn a_face_that_the_force_hardly_meets_bears_nothing() {
        // 5° to the floor are 875 of 10,000.
        assert_eq!(moved(0, 0, &[&[(0, [10_000, 0, -1])]]).map(|by| by.round()), Some(1.0));
        assert!(moved(0, 0, &[&[(0, [10_000, 0, -874])]]).is_some());
        assert_eq!(moved(0, 0, &[&[(0, [10_000, 0, -876])]]), None);
    }

    #[test]
    fn loads_of_a_block_are_added_at_each_time() {
        let late: &[(i32, [i32; 3])] = &[(0, [0, 0, 0]), (5, [0, 0, 4000]), (6, [0, 0, 0])];
        assert_eq!(moved(0, 0, &[late]), None, "40 cm of the 50 that are allowed");
        assert_eq!(moved(0, 0, &[late, late]), Some(0.8), "at one time");
        assert_eq!(moved(0, 0, &[late, &[(6, [0, 0, 0]), (7, [0, 0, 4000])]]), None, "at two times");
        let up_and_down: &[(i32, [i32; 3])] = &[(0, [0, 0, 6000]), (1, [0, 0, -90_000])];
        assert_eq!(moved(0, 0, &[up_and_down]), Some(0.6), "the larger one is borne by the floor");
    }
}
