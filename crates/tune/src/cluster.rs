//! The part of a scene that is stepped for every candidate: a block that moves, those around it, and a ring that holds still.

use rayon::prelude::*;
use rockproof_model::simulation::Unconverged;
use rockproof_model::{Motion, Number, Scene, ToleranceSet, Vec3};
use rockproof_stepper::contact::{PreparedBlock, SpecRules, Tolerances, classify};
use std::collections::BTreeSet;

/// Blocks of a cluster at most.
const MAX_BLOCKS: usize = 14;

/// Contacts of a cluster at most, if fewer blocks have fewer: an exact step takes time for each of them, and more than in proportion.
const MAX_CONTACTS: usize = 192;

/// Settling steps of a cluster at most: where the oracle is asked, it makes these too.
const MAX_SETTLING: u32 = 5;

/// What holds a cluster.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClusterSupport {
    /// What the scene has as fixed.
    Given,
    /// Nothing: the scene is one block, and nothing would move if that were held.
    Nothing,
    /// Nothing in the scene is fixed: so many of its blocks, the lowest.
    Lowest(usize),
    /// Nothing in the scene is fixed, and all blocks are as low as one another: the largest.
    Largest,
    /// Nothing in the part is fixed: so many of its blocks, those further out.
    Ring(usize),
}

impl ClusterSupport {
    /// What is held, in words.
    pub fn sentence(self) -> String {
        match self {
            ClusterSupport::Given => "what the scene fixes held".to_owned(),
            ClusterSupport::Nothing => "nothing held".to_owned(),
            ClusterSupport::Lowest(1) => "its lowest block held, as the file fixes none".to_owned(),
            ClusterSupport::Lowest(count) => format!("its {count} lowest blocks held, as the file fixes none"),
            ClusterSupport::Largest => "its largest block held, as the file fixes none".to_owned(),
            ClusterSupport::Ring(count) => format!("the {count} further out held, as the file fixes none of them"),
        }
    }
}

/// A part of a scene.
#[derive(Clone, Debug)]
pub struct Cluster {
    /// The blocks of the part, as a scene.
    pub scene: Scene,
    /// Their numbers in the whole scene.
    pub members: Vec<usize>,
    /// Whether it is the whole scene.
    pub is_whole: bool,
    /// What holds it.
    pub held: ClusterSupport,
    /// Contacts of the part as it stands, but those of two blocks that are held, in f64.
    pub contacts: usize,
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
    /// The cluster around the block that has the most contacts of those that can move, the first of several; the whole scene where that
    /// is small. Where nothing in the whole scene is fixed, its lowest blocks are held, or the largest; where nothing in a part is, the further
    /// two thirds of it. Of a part with many contacts fewer blocks are taken. `neighbours` may touch; contacts are those under `set`. The part settles for no more than 5
    /// steps, and goes on where a step does not converge; all else of `[simulation]` is the scene's.
    pub fn of(scene: &Scene, neighbours: &[[usize; 2]], set: &ToleranceSet) -> Cluster {
        let count = scene.blocks.len();
        let contacts = contacts(scene, neighbours, set);
        let none_touch = contacts.iter().all(|(_, count)| *count == 0);
        let mut beside: Vec<Vec<usize>> = vec![Vec::new(); count];
        let mut touched = vec![0; count];
        for &([i, j], count) in contacts.iter().filter(|(_, count)| none_touch || *count > 0) {
            beside[i].push(j);
            beside[j].push(i);
            touched[i] += count;
            touched[j] += count;
        }
        let movable = |block: &usize| !scene.blocks[*block].body.is_fixed();
        let busiest = (0..count).filter(movable).rev().max_by_key(|block| touched[*block]).unwrap_or(0);
        let mut members: Vec<usize> = vec![busiest];
        let mut seen: BTreeSet<usize> = members.iter().copied().collect();
        let mut at = 0;
        while at < members.len() && members.len() < MAX_BLOCKS {
            for &next in &beside[members[at]] {
                if members.len() < MAX_BLOCKS && seen.insert(next) {
                    members.push(next);
                }
            }
            at += 1;
        }
        if count <= MAX_BLOCKS {
            members.extend((0..count).filter(|block| !seen.contains(block)));
        }
        loop {
            let mut cluster = Cluster::part(scene, &members);
            cluster.contacts = cluster.between(&contacts);
            if cluster.contacts <= MAX_CONTACTS || members.len() <= 2 {
                return cluster;
            }
            members.pop();
        }
    }

    /// Of the contacts of pairs those that its steps have to do with.
    fn between(&self, contacts: &[([usize; 2], usize)]) -> usize {
        let place = |block: usize| self.members.iter().position(|member| *member == block);
        let moves = |block: usize| place(block).map(|at| !self.scene.blocks[at].body.is_fixed());
        let counts = contacts.iter().filter_map(|&([i, j], count)| {
            let (one, other) = (moves(i)?, moves(j)?);
            (one || other).then_some(count)
        });
        counts.sum()
    }

    fn part(scene: &Scene, members: &[usize]) -> Cluster {
        let is_whole = members.len() == scene.blocks.len();
        let mut part = scene.clone();
        part.blocks = members.iter().map(|&block| scene.blocks[block].clone()).collect();
        let nothing_fixed = part.blocks.iter().all(|block| !block.body.is_fixed());
        let held = match nothing_fixed && members.len() > 1 {
            false => ClusterSupport::Given,
            true if is_whole => hold_lowest(&mut part),
            true => {
                let free = members.len().div_ceil(3);
                part.blocks[free..].iter_mut().for_each(|block| block.body.motion = Motion::Fixed);
                ClusterSupport::Ring(members.len() - free)
            }
        };
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
        control.settle = control.settle.min(MAX_SETTLING);
        // Counted, so that sets under which a step fails can be told apart.
        control.unconverged = Unconverged::Accept;
        Cluster { scene: part, members: members.to_vec(), is_whole, held, contacts: 0 }
    }

    /// As many steps as exact ones of the likely candidates take a part of `seconds`, by a rule of thumb that knows no clock: between 4 and 32.
    pub fn steps_for(&self, seconds: u64) -> u64 {
        let each = (self.contacts as u64 * self.unknowns() as u64).max(1);
        (2_000 * seconds / each).clamp(4, 32)
    }

    /// Unknowns of a step.
    pub fn unknowns(&self) -> usize {
        self.scene.blocks.iter().map(|block| block.body.motion.unknowns()).sum()
    }
}

/// Fixes the blocks that reach as far down along gravity as any, to a thousandth of the scene's height; where that is all of them, or gravity
/// pulls nowhere, the largest.
pub fn hold_lowest(scene: &mut Scene) -> ClusterSupport {
    let gravity = scene.simulation.gravity.map(Number::approximate);
    let depths: Vec<[f64; 2]> = scene
        .blocks
        .iter()
        .map(|block| {
            let along = |v: &Vec3<Number>| {
                let v = v.map(Number::approximate);
                gravity.x * v.x + gravity.y * v.y + gravity.z * v.z
            };
            let fold = |[low, high]: [f64; 2], depth: f64| [low.min(depth), high.max(depth)];
            block.block.vertices().iter().map(along).fold([f64::INFINITY, f64::NEG_INFINITY], fold)
        })
        .collect();
    let top = depths.iter().map(|[low, _]| *low).fold(f64::INFINITY, f64::min);
    let bottom = depths.iter().map(|[_, high]| *high).fold(f64::NEG_INFINITY, f64::max);
    let is_low: Vec<bool> = depths.iter().map(|[_, high]| *high >= bottom - (bottom - top) / 1000.0).collect();
    let low = is_low.iter().filter(|low| **low).count();
    if low < depths.len() {
        let blocks = scene.blocks.iter_mut().zip(&is_low).filter(|(_, low)| **low);
        blocks.for_each(|(block, _)| block.body.motion = Motion::Fixed);
        return ClusterSupport::Lowest(low);
    }
    let volumes: Vec<_> = scene.blocks.iter().map(|block| block.block.volume()).collect();
    let largest = (0..volumes.len()).rev().max_by(|&i, &j| volumes[i].cmp(&volumes[j]));
    if let Some(largest) = largest {
        scene.blocks[largest].body.motion = Motion::Fixed;
    }
    ClusterSupport::Largest
}

/// The number of contacts of each pair in f64; none where the set or a block cannot be had in it.
fn contacts(scene: &Scene, pairs: &[[usize; 2]], set: &ToleranceSet) -> Vec<([usize; 2], usize)> {
    let prepared: Vec<_> = scene.blocks.iter().map(|block| PreparedBlock::<f64>::new(&block.block).ok()).collect();
    let tolerances = Tolerances::new(set).ok();
    let count = |&[i, j]: &[usize; 2]| {
        let both = prepared[i].as_ref().zip(prepared[j].as_ref()).zip(tolerances.as_ref());
        ([i, j], both.map_or(0, |((a, b), tolerances)| classify::<f64, SpecRules>(a, b, tolerances).len()))
    };
    pairs.par_iter().map(count).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rockproof_bench::stepping::wall;
    use rockproof_model::preset::{Preset, derive};
    use rockproof_model::{Block, Precision};

    fn auto(scene: &Scene) -> ToleranceSet {
        derive(Preset::Auto, &scene.shapes(), Precision::F64).expect("a set")
    }

    #[test]
    fn a_cluster_is_connected_and_holds_on_to_something() {
        let scene = wall(60).expect("a wall");
        let near = neighbours(&scene);
        let cluster = Cluster::of(&scene, &near, &auto(&scene));
        assert!(!cluster.is_whole && cluster.scene.blocks.len() == MAX_BLOCKS && cluster.contacts > 0);
        let fixed = cluster.scene.blocks.iter().filter(|block| block.body.is_fixed()).count();
        assert!(fixed > 0 && fixed < MAX_BLOCKS, "{fixed}");
        let touches = |k: usize| {
            near.iter().any(|[i, j]| {
                let other = |b: usize| cluster.members.contains(&b) && b != cluster.members[k];
                (*i == cluster.members[k] && other(*j)) || (*j == cluster.members[k] && other(*i))
            })
        };
        assert!((0..MAX_BLOCKS).all(touches));
    }

    #[test]
    fn a_small_scene_is_its_own_cluster() {
        let scene = wall(4).expect("a wall");
        let cluster = Cluster::of(&scene, &neighbours(&scene), &auto(&scene));
        assert!(cluster.is_whole && cluster.scene.blocks.len() == 5);
        assert_eq!(cluster.scene.blocks.iter().filter(|block| block.body.is_fixed()).count(), 1);
    }

    #[test]
    fn what_nobody_fixed_is_held_at_its_lowest_or_largest() {
        let whole = Number::from_integer;
        let cuboid = |low: [i32; 3], high: [i32; 3]| {
            let [low, high] = [low, high].map(|[x, y, z]| Vec3::new(whole(x), whole(y), whole(z)));
            rockproof_model::SceneBlock::new("block", Block::cuboid(&low, &high).expect("a box"))
        };
        let fixed = |blocks: Vec<rockproof_model::SceneBlock>| {
            let scene = Scene { blocks, ..Scene::default() };
            let cluster = Cluster::of(&scene, &neighbours(&scene), &auto(&scene));
            let held: Vec<usize> =
                (0..cluster.members.len()).filter(|&at| cluster.scene.blocks[at].body.is_fixed()).collect();
            (cluster.held, held.into_iter().map(|at| cluster.members[at]).collect::<BTreeSet<_>>())
        };
        let low = [cuboid([0, 0, 1], [2, 1, 2]), cuboid([0, 0, 0], [1, 1, 1]), cuboid([1, 0, 0], [2, 1, 1])];
        assert_eq!(fixed(low.to_vec()), (ClusterSupport::Lowest(2), BTreeSet::from([1, 2])));
        let level = [cuboid([0, 0, 0], [1, 1, 1]), cuboid([1, 0, 0], [3, 1, 1]), cuboid([3, 0, 0], [4, 1, 1])];
        assert_eq!(fixed(level.to_vec()), (ClusterSupport::Largest, BTreeSet::from([1])));
    }
}
