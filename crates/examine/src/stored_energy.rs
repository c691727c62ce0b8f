//! What springs of overlaps store at the start, and whether weights and loads explain it: five steps need not show a block that is thrown.

use crate::extents::short;
use crate::overlaps::{Overlaps, pair_in_words};
use rayon::prelude::*;
use rockproof_model::simulation::PointLoad;
use rockproof_model::tolerance_rules::weights_borne;
use rockproof_model::{Number, Scene, SceneBlock, ToleranceSet, Vec3};
use rockproof_oracle::audit::OverlapSeverity;
use rockproof_oracle::{Pair, PreparedBlock};
use rockproof_stepper::Real;
use rockproof_stepper::dynamics::ContactState;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// A pair of blocks whose springs store more than weights and loads explain.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredEnergy {
    /// The blocks, the lower number first.
    pub blocks: [usize; 2],
    /// What the springs of the pair's contacts store (J).
    pub energy_j: f64,
    /// The most that is explained: the force that presses the blocks together times `penetration`, and the energy of their motion (J).
    pub explained_j: f64,
    /// The block that it would move, and its speed if all of the energy became motion of this block (m/s).
    pub thrown: (usize, f64),
}

impl StoredEnergy {
    /// What is wrong, without figures.
    pub const TITLE: &str = "springs of overlaps store more than weights explain, and may throw blocks";

    /// What was found, with the names that blocks of the scene have.
    pub fn sentence(&self, scene: &Scene) -> String {
        let [energy, explained] = [self.energy_j, self.explained_j].map(short);
        let (block, speed) = self.thrown;
        let pair = pair_in_words(self.blocks, scene);
        format!(
            "springs of blocks {pair} store {energy} J, their weights and loads explain {explained} J: released, that would throw block {block} at {} m/s",
            short(speed)
        )
    }

    /// What mends it.
    pub fn remedy() -> &'static str {
        "blocks moved apart, or `settle` in [simulation]"
    }

    /// For programs.
    pub fn json(&self) -> Value {
        json!({ "blocks": self.blocks, "energy_j": self.energy_j, "explained_j": self.explained_j, "block": self.thrown.0, "speed_m_s": self.thrown.1 })
    }
}

/// The pairs of a scene whose springs store more as the blocks stand than weights and loads explain, the one furthest beyond it first; none where the scene
/// settles before time begins, which makes overlaps what weights press.
pub fn unexplained_energy(scene: &Scene, set: &ToleranceSet, overlaps: &Overlaps) -> Vec<StoredEnergy> {
    if scene.simulation.control.settle > 0 {
        return Vec::new();
    }
    let mut scene = scene.clone();
    scene.derive_stiffness(set);
    unexplained(&scene, set, &at_start(&scene, set, overlaps))
}

/// What the springs of each pair store (J).
pub(crate) type PairEnergies = BTreeMap<[usize; 2], f64>;

/// What the springs of pairs that overlap and are held store as the blocks stand, from the exact contacts; joints have their stiffness.
pub(crate) fn at_start(scene: &Scene, set: &ToleranceSet, overlaps: &Overlaps) -> PairEnergies {
    let held = overlaps.all().filter(|(_, severity)| *severity == OverlapSeverity::Held);
    let energy = |[a, b]: [usize; 2]| {
        let prepared = [a, b].map(|block| PreparedBlock::new(&scene.blocks[block].block));
        let pair = Pair::new(&prepared[0], &prepared[1]);
        let contacts = pair.classify(set).contacts;
        let pressed = contacts.iter().filter(|contact| contact.gap.is_negative());
        let squares = pressed.map(|contact| Number::from_rational(pair.gap(&contact.entrance).squared).approximate());
        stiffness(scene, [a, b]) * squares.sum::<f64>() / 2.0
    };
    let held: Vec<[usize; 2]> = held.map(|(overlap, _)| overlap.blocks).collect();
    held.into_par_iter().map(|blocks| (blocks, energy(blocks))).collect()
}

/// The same of a state after settling, from the gaps that its last step left.
pub(crate) fn after_settling<R: Real>(scene: &Scene, contacts: &[ContactState<R>]) -> PairEnergies {
    let mut found = PairEnergies::new();
    for contact in contacts.iter().filter(|contact| contact.mode.is_closed()) {
        let (blocks, gap) = (contact.blocks.map(|block| block as usize), contact.gap.to_f64().min(0.0));
        *found.entry(blocks).or_default() += stiffness(scene, blocks) * gap * gap / 2.0;
    }
    found
}

fn stiffness(scene: &Scene, blocks: [usize; 2]) -> f64 {
    let [one, other] = blocks.map(|block| scene.blocks[block].body.joint);
    let normal = &scene.simulation.joints.between(one, other).normal_stiffness;
    normal.as_ref().map_or(0.0, Number::approximate)
}

/// The pairs that store more than is explained, the one that is furthest beyond it first.
///
/// A contact of stiffness p that a force F presses is d = F/p deep and stores p·d²/2 = F·d/2; one on which the force is laid suddenly gets twice as deep
/// and stores F·2d. Neither is meant to be deeper than `penetration` g, so contacts that share a force F store no more than F·g together. For F stands,
/// of the two blocks, the greatest of what one bears (the estimate of the warning `load`), the scene's loads added, and of what its initial stress
/// presses on the largest side of its box. A block that the scene has moving may have pressed its springs together by as much as its motion still has.
/// **As much as is explained is explained.**
pub(crate) fn unexplained(scene: &Scene, set: &ToleranceSet, energies: &PairEnergies) -> Vec<StoredEnergy> {
    let is_moving = |block: &usize| !scene.blocks[*block].body.is_fixed();
    let movers: Vec<usize> = energies.keys().flatten().copied().filter(is_moving).collect();
    let borne = weights_borne(set, scene, &movers);
    let loads: f64 = scene.simulation.loads.iter().map(greatest).sum();
    let forces: BTreeMap<usize, f64> =
        movers.iter().zip(borne).map(|(&block, weight)| (block, (weight + loads).max(pressed(scene, block)))).collect();
    let penetration = set.penetration.approximate();
    let one = |(&blocks, &energy_j): (&[usize; 2], &f64)| {
        let moving = || blocks.into_iter().filter(|block| forces.contains_key(block));
        let motion: f64 =
            moving().map(|block| mass(scene, block) * length(&scene.blocks[block].body.velocity).powi(2) / 2.0).sum();
        let explained_j = moving().map(|block| forces[&block]).fold(0.0, f64::max) * penetration + motion;
        let lightest = moving().map(|block| (mass(scene, block), block)).min_by(|one, two| one.0.total_cmp(&two.0));
        let (mass, block) = lightest?;
        let thrown = (block, (2.0 * energy_j / mass).sqrt());
        (energy_j > explained_j).then_some(StoredEnergy { blocks, energy_j, explained_j, thrown })
    };
    let mut found: Vec<StoredEnergy> = energies.iter().filter_map(one).collect();
    // A stable sort: of equal ones the first pair first.
    found.sort_by(|one, two| (two.energy_j / two.explained_j).total_cmp(&(one.energy_j / one.explained_j)));
    found
}

/// The greatest force of a load (N).
fn greatest(load: &PointLoad) -> f64 {
    load.table.iter().map(|(_, force)| length(force)).fold(0.0, f64::max)
}

fn length(vector: &Vec3<Number>) -> f64 {
    vector.components().into_iter().map(|part| part.approximate().powi(2)).sum::<f64>().sqrt()
}

/// In kg.
fn mass(scene: &Scene, block: usize) -> f64 {
    let SceneBlock { block, body, .. } = &scene.blocks[block];
    let density = scene.simulation.materials[body.material].density.approximate();
    density * Number::from_rational(block.volume()).approximate()
}

/// What the initial stress of a block presses at most on the largest side of its box (N).
fn pressed(scene: &Scene, block: usize) -> f64 {
    let SceneBlock { block, body, .. } = &scene.blocks[block];
    // The Frobenius norm of a stress is at least its largest principal value.
    let [normal, shear] = [&body.stress[..3], &body.stress[3..]]
        .map(|parts| parts.iter().map(|part| part.approximate().powi(2)).sum::<f64>());
    let bounds = block.bounds();
    let [x, y, z] =
        [0, 1, 2].map(|k| bounds.max.components()[k].approximate() - bounds.min.components()[k].approximate());
    (normal + 2.0 * shear).sqrt() * (x * y).max(y * z).max(z * x)
}
