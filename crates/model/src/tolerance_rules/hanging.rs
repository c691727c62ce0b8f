//! Whether a block hangs from fixed points that are too soft to hold it: an estimate.

use super::column::{Column, ColumnSource, Plans, carried, dot, gravity};
use super::pressing::{forces, stands_against};
use super::six_digits;
use super::warning::{Warning, WarningKind};
use crate::scene::Scene;
use crate::simulation::PointLoad;
use crate::tolerance::ToleranceSet;

/// The block that its fixed points alone hold and that moves furthest, for its size, before they do, if that is more than half of the smallest side of its box: its centroid then is where its
/// surface was. The springs of a block's fixed points, k together, move by F/k under what it bears along gravity (as [`load`](super::load::load) has it, `columns`) and its loads.
/// Where another block stands against that force contacts bear it too, and nothing is said.
pub(super) fn hanging(set: &ToleranceSet, scene: &Scene, source: &ColumnSource<'_>) -> Option<Warning> {
    let held = |block: usize| source.masses[block].is_some() && source.held[block] > 0.0;
    let hung: Vec<usize> = (0..scene.blocks.len()).filter(|&block| held(block)).collect();
    if hung.is_empty() {
        return None;
    }
    let columns = source.along_gravity().map(|columns| (Plans::of(&columns), columns));
    let stretched = hung.into_iter().filter_map(|block| {
        let stiffness = source.held[block];
        let force = greatest_force(scene, columns.as_ref(), block);
        let bounds = scene.blocks[block].block.bounds();
        let side = |k: usize| bounds.max.components()[k].approximate() - bounds.min.components()[k].approximate();
        let allowed = (0..3).map(side).fold(f64::INFINITY, f64::min) / 2.0;
        let size = dot(force, force).sqrt();
        let is_beyond = size / stiffness > allowed && !stands_against(set, scene, block, force);
        is_beyond.then_some((block, size / stiffness, allowed, size))
    });
    let worse = |one: &(usize, f64, f64, f64), other: &(usize, f64, f64, f64)| other.1 / other.2 > one.1 / one.2;
    let (block, found, allowed, force) =
        stretched.reduce(|one, other| if worse(&one, &other) { other } else { one })?;
    let points = scene.simulation.fixed_points.iter().filter(|point| point.block == block).count();
    let needed = six_digits(force / (allowed * points as f64), true, false);
    let remedy = format!("stiffness of its {points} [[fixed_point]] ≥ {needed}");
    Some(Warning { kind: WarningKind::Hanging, block: Some(block), found, allowed, remedy })
}

/// The greatest force on a block: what it bears along gravity, with all its loads when time begins or with one of them at any time (N).
fn greatest_force(scene: &Scene, columns: Option<&(Plans, Vec<Column>)>, block: usize) -> [f64; 3] {
    let weight = columns.zip(gravity(scene)).map_or([0.0; 3], |((plans, columns), (down, _))| {
        let weight = carried(columns, plans, &columns[block]);
        down.map(|part| part * weight)
    });
    let loads: Vec<&PointLoad> = scene.simulation.loads.iter().filter(|load| load.block == block).collect();
    let sum = |forces: &mut dyn Iterator<Item = [f64; 3]>| {
        forces.fold(weight, |sum, force| std::array::from_fn(|k| sum[k] + force[k]))
    };
    let at_start = sum(&mut loads.iter().map(|load| load.at_start()));
    let alone = loads.iter().flat_map(|load| forces(load)).map(|force| sum(&mut std::iter::once(force)));
    let larger = |one: [f64; 3], other: [f64; 3]| if dot(other, other) > dot(one, one) { other } else { one };
    alone.fold(larger(weight, at_start), larger)
}
