//! What all loads of a block are together over time.

use crate::number::Number;
use crate::scene::Scene;
use crate::simulation::PointLoad;
use std::collections::{BTreeMap, BTreeSet};

/// Of each block that can move and has loads what these are together (N) at 0 and at every later time of their tables. Between two of these times the sum is linear, so what is greatest is so at one of them.
pub(super) type LoadSums = BTreeMap<usize, Vec<[f64; 3]>>;

/// The sums of a scene's loads.
pub(super) fn load_sums(scene: &Scene) -> LoadSums {
    let mut loads: BTreeMap<usize, Vec<&PointLoad>> = BTreeMap::new();
    for load in scene.simulation.loads.iter().filter(|load| !scene.blocks[load.block].body.is_fixed()) {
        loads.entry(load.block).or_default().push(load);
    }
    let zero = Number::ZERO;
    let sums = |loads: Vec<&PointLoad>| {
        let tables = loads.iter().flat_map(|load| load.table.iter().map(|(time, _)| time));
        let times: BTreeSet<&Number> = tables.filter(|time| **time > zero).chain([&zero]).collect();
        let sum = |time: &&Number| {
            let forces = loads.iter().map(|load| load.force_at(time));
            forces.fold([0.0; 3], |sum: [f64; 3], force| std::array::from_fn(|k| sum[k] + force[k]))
        };
        times.iter().map(sum).collect()
    };
    loads.into_iter().map(|(block, loads)| (block, sums(loads))).collect()
}

/// The most that a block's loads together press along a direction at any time (N).
pub(super) fn most_along(sums: &[[f64; 3]], direction: [f64; 3]) -> f64 {
    sums.iter().map(|force| super::column::dot(*force, direction)).fold(f64::NEG_INFINITY, f64::max)
}
