//! The part of a scene that is stepped for every candidate: a block that moves, those around it, and a ring that holds still.

use crate::model::simulation::Unconverged;
use crate::model::{Motion, Number, Scene};
use std::collections::BTreeSet;

/// Blocks of a cluster at most.
const MOST: usize = 14;

/// A part of a scene.
#[derive(Clone, Debug)]
pub struct Cluster {
    /// The blocks of the part, as a scene.
    pub scene: Scene,
    /// Their numbers in the whole scene.
    pub members: Vec<usize>,
    /// Whether it is the whole scene.
    pub is_whole: bool,
}

/// Pairs of blocks whose boxes, grown by a hundredth of their longest side, meet; the lower number first, ascending.
pub(super) fn neighbours(scene: &Scene) -> Vec<[usize; 2]> {
    let boxes: Vec<[[f64; 2]; 3]> = scene
        .blocks
        .iter()
        .map(|block| {
            let bounds = block.block.bounds();
            let (low, high) = (bounds.min.components(), bounds.max.components());
            let sides = [0, 1, 2].map(|k| [low[k].approximate(), high[k].approximate()]);
            let grown = sides.iter().map(|[low, high]| high - low).fold(0.0, f64::max) / 100.0;
            sides.map(|[low, high]| [low - grown, high + grown])
        })
        .collect();
    let meet =
        |i: usize, j: usize| (0..3).all(|k| boxes[i][k][0] <= boxes[j][k][1] && boxes[j][k][0] <= boxes[i][k][1]);
    let all = 0..boxes.len();
    all.clone().flat_map(|i| (i + 1..boxes.len()).map(move |j| [i, j])).filter(|[i, j]| meet(*i, *j)).collect()
}

impl Cluster {
    /// The cluster around the block that has the most neighbours of those that can move, the first of several; the whole scene where that
    /// is small. Where nothing in it is fixed, the further two thirds of it are.
    pub fn of(scene: &Scene, neighbours: &[[usize; 2]]) -> Cluster {
        let count = scene.blocks.len();
        let is_whole = count <= MOST;
        let mut part = scene.clone();
        let beside = |block: usize| {
            neighbours
                .iter()
                .filter(move |pair| pair.contains(&block))
                .map(move |[i, j]| if *i == block { *j } else { *i })
        };
        let movable = |block: &usize| !scene.blocks[*block].body.is_fixed();
        let busiest = (0..count).filter(movable).rev().max_by_key(|block| beside(*block).count()).unwrap_or(0);
        let mut members: Vec<usize> = vec![busiest];
        let mut seen: BTreeSet<usize> = members.iter().copied().collect();
        let mut at = 0;
        while at < members.len() && members.len() < MOST {
            for next in beside(members[at]) {
                if members.len() < MOST && seen.insert(next) {
                    members.push(next);
                }
            }
            at += 1;
        }
        if is_whole {
            members.extend((0..count).filter(|block| !seen.contains(block)));
        }
        part.blocks = members.iter().map(|&block| scene.blocks[block].clone()).collect();
        if part.blocks.iter().all(|block| !block.body.is_fixed()) && part.blocks.len() > 1 {
            let free = part.blocks.len().div_ceil(3);
            part.blocks[free..].iter_mut().for_each(|block| block.body.motion = Motion::Fixed);
        }
        // What is attached to blocks by number stays only where all of them are there.
        let place = |block: usize| members.iter().position(|member| *member == block);
        part.simulation.loads.retain_mut(|load| {
            place(load.block).is_some_and(|at| {
                load.block = at;
                true
            })
        });
        part.simulation.fixed_points.retain_mut(|point| {
            place(point.block).is_some_and(|at| {
                point.block = at;
                true
            })
        });
        part.simulation.measured_points.clear();
        let control = &mut part.simulation.control;
        control.settle = control.settle.clamp(2, 5);
        control.dynamic = Number::from_integer(1);
        control.unconverged = Unconverged::Accept;
        Cluster { scene: part, members, is_whole }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::speed::stepping::wall;

    #[test]
    fn a_cluster_is_connected_and_holds_on_to_something() {
        let scene = wall(60).expect("a wall");
        let near = neighbours(&scene);
        let cluster = Cluster::of(&scene, &near);
        assert!(!cluster.is_whole && cluster.scene.blocks.len() == MOST);
        let fixed = cluster.scene.blocks.iter().filter(|block| block.body.is_fixed()).count();
        assert!(fixed > 0 && fixed < MOST, "{fixed}");
        let touches = |k: usize| {
            near.iter().any(|[i, j]| {
                let other = |b: usize| cluster.members.contains(&b) && b != cluster.members[k];
                (*i == cluster.members[k] && other(*j)) || (*j == cluster.members[k] && other(*i))
            })
        };
        assert!((0..MOST).all(touches));
    }

    #[test]
    fn a_small_scene_is_its_own_cluster() {
        let scene = wall(4).expect("a wall");
        let cluster = Cluster::of(&scene, &neighbours(&scene));
        assert!(cluster.is_whole && cluster.scene.blocks.len() == 5);
        assert_eq!(cluster.scene.blocks.iter().filter(|block| block.body.is_fixed()).count(), 1);
    }
}
