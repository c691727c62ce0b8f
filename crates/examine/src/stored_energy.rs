//! What springs of overlaps store at the start, and whether weights and loads explain it: a few steps need not show a block that is thrown.

use crate::extents::short;
use crate::overlaps::{Overlaps, pair_in_words};
use crate::pressed_springs::{PressedSpring, at_start, released};
use rockproof_model::simulation::motion_energy;
use rockproof_model::tolerance_rules::weights_borne;
use rockproof_model::{Number, Scene, SceneBlock, ToleranceSet, Vec3};
use rockproof_simulate::f64_vector::{dot, length, plus};
use rockproof_tune::hold_lowest;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// A pair of blocks whose springs store more than weights and loads explain.
#[derive(Clone, Debug, PartialEq)]
pub struct StoredEnergy {
    /// The blocks, the lower number first.
    pub blocks: [usize; 2],
    /// What the springs of the pair's contacts store (J).
    pub energy_j: f64,
    /// The most that is explained by the force that presses the blocks together, and the energy of their motion (J).
    pub explained_j: f64,
    /// The block that it would move, and its speed if all that its springs can give it became motion (m/s).
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
            "springs of blocks {pair} store {energy} J, their weights and loads explain {explained} J: released, that would throw block {block} at up to {} m/s, the more the shorter the steps are",
            short(speed)
        )
    }

    /// What mends it.
    pub fn remedy(scene: &Scene) -> &'static str {
        match scene.simulation.control.settle {
            0 => "blocks moved apart, or `settle` in [simulation]",
            _ => "blocks moved apart, or more steps of `settle`",
        }
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
    let scene = as_stepped(scene, set);
    unexplained(&scene, set, &at_start(&scene, set, overlaps))
}

/// The scene as steps of it are made: one of several blocks that fixes nothing with its lowest held, which are fixed then, and with stiffnesses.
pub(crate) fn as_stepped(scene: &Scene, set: &ToleranceSet) -> Scene {
    let mut scene = scene.clone();
    if scene.blocks.len() > 1 && scene.blocks.iter().all(|block| !block.body.is_fixed()) {
        hold_lowest(&mut scene);
    }
    scene.derive_stiffness(set);
    scene
}

/// The share of the smallest side of the smaller block by which it may rise from its springs.
const RISE: f64 = 0.01;

/// The pairs that store more than is explained and can give it to a block, the one that is furthest beyond it first. None where `dynamic` is 0: each step
/// begins at rest, so what springs give is gone with the step.
///
/// A contact of stiffness p that a force F presses is d = F/p deep and stores p·d²/2 = F·d/2; one on which the force is laid suddenly gets twice as deep
/// and stores 2F²/p. Released, n such contacts lift a block that weighs F by E/F − d above where it leaves them. So explained are 2F²/p, what one contact
/// alone stores that bears all of it, and F·s, s a hundredth of the smallest side of the blocks: they rise by no more than s. A contact is not meant to be
/// deeper than `penetration` g, so no more than F·g is explained. For F see [`pressing_force`].
/// A block that the scene has moving may have pressed its springs together by as much as its motion still has; after settling it has none.
/// **As much as is explained is explained.**
///
/// Springs on both sides of a block that hold one another in balance move nothing: what counts is what they can give it ([`released`]). After settling a
/// block is at rest with friction, too: where contacts, weight and loads leave no more than F unbalanced, its springs hold it.
pub(crate) fn unexplained(scene: &Scene, set: &ToleranceSet, springs: &[PressedSpring]) -> Vec<StoredEnergy> {
    if scene.simulation.control.dynamic == Number::ZERO {
        return Vec::new();
    }
    let mut of_pair: BTreeMap<[usize; 2], Vec<&PressedSpring>> = BTreeMap::new();
    let mut of_block: BTreeMap<usize, Vec<&PressedSpring>> = BTreeMap::new();
    for spring in springs {
        of_pair.entry(spring.blocks).or_default().push(spring);
        for block in spring.blocks.into_iter().filter(|&block| !scene.blocks[block].body.is_fixed()) {
            of_block.entry(block).or_default().push(spring);
        }
    }
    let movers: Vec<usize> = of_block.keys().copied().collect();
    let borne = weights_borne(set, scene, &movers);
    let moving: BTreeMap<usize, Moving<'_>> = movers
        .iter()
        .zip(borne)
        .map(|(&block, borne)| (block, Moving::of(scene, block, borne, &of_block[&block])))
        .collect();
    let penetration = set.penetration.approximate();
    let one = |(&blocks, springs): (&[usize; 2], &Vec<&PressedSpring>)| {
        let here = || blocks.into_iter().filter_map(|block| moving.get(&block));
        let energy_j = springs.iter().map(|spring| spring.energy_j()).sum();
        let force = pressing_force(&here().collect::<Vec<_>>(), springs);
        let rise = RISE * here().map(|one| one.smallest_side).fold(f64::INFINITY, f64::min);
        let motion: f64 = here().map(|one| one.motion_j).sum();
        let explained_j = force * penetration.min(2.0 * force / springs.first()?.stiffness + rise) + motion;
        let given = here().filter(|one| !one.is_held(force)).map(|one| (one, one.released_j));
        let (one, _) = given
            .filter(|&(_, given)| given > explained_j)
            .max_by(|(one, a), (two, b)| (a / one.mass).total_cmp(&(b / two.mass)))?;
        let thrown = (one.block, (2.0 * one.released_j / one.mass).sqrt());
        (energy_j > explained_j).then_some(StoredEnergy { blocks, energy_j, explained_j, thrown })
    };
    let mut found: Vec<StoredEnergy> = of_pair.iter().filter_map(one).collect();
    // A stable sort: of equal ones the first pair first.
    found.sort_by(|one, two| (two.energy_j / two.explained_j).total_cmp(&(one.energy_j / one.explained_j)));
    found
}

/// The greatest force that may press the moving blocks of a pair with these springs together (N): of what each of them bears (the estimate of the warning
/// `load`) with its loads as far as they press the pair together when time begins, and of what the initial stress of either presses on the largest side of its box.
///
/// A block that stands on the other is pressed onto it by no more than it bears itself, however heavy the other: springs that push it along u, with c the part of u
/// against gravity, carry F·c ≤ what it bears. So weights press with no more than (what the upper block bears with its loads)/c; loads of the lower one come on top.
fn pressing_force(pair: &[&Moving<'_>], springs: &[&PressedSpring]) -> f64 {
    let loaded = |one: &Moving<'_>| one.loaded_against(one.pushed_along(springs));
    let either = pair.iter().map(|one| one.borne + loaded(one)).fold(0.0, f64::max);
    let upper = pair.iter().map(|one| (one, one.lifted(springs))).find(|(_, lifted)| *lifted > 0.0);
    let weights = upper.map_or(either, |(upper, lifted)| {
        let below: f64 = pair.iter().filter(|one| one.block != upper.block).map(|one| loaded(one)).sum();
        either.min((upper.borne + loaded(upper)) / lifted + below)
    });
    pair.iter().map(|one| pressed(one.scene, one.block)).fold(weights, f64::max)
}

/// A block that its springs may move.
struct Moving<'s> {
    block: usize,
    scene: &'s Scene,
    /// In kg.
    mass: f64,
    /// In m.
    smallest_side: f64,
    /// Its weight and what stands on it (N).
    borne: f64,
    /// Its own loads when time begins (N).
    load: [f64; 3],
    /// What its springs can give it (J).
    released_j: f64,
    /// What it moves with (J).
    motion_j: f64,
    /// What contacts, weight and loads leave unbalanced after settling (N); `None` where the scene does not settle.
    unbalanced: Option<f64>,
}

impl<'s> Moving<'s> {
    fn of(scene: &'s Scene, block: usize, borne: f64, springs: &[&PressedSpring]) -> Moving<'s> {
        let shape = &scene.blocks[block].block;
        let mass = mass(scene, block);
        let centroid = near(&shape.centroid().map(|c| Number::from_rational(c.clone())));
        let loads = scene.simulation.loads.iter().filter(|load| load.block == block);
        let load = loads.map(|load| load.at_start()).fold([0.0; 3], plus);
        let settles = scene.simulation.control.settle > 0;
        let weight = near(&scene.simulation.gravity).map(|g| g * mass);
        let contacts = springs.iter().map(|spring| spring.force.map(|f| f * spring.side(block)));
        let unbalanced = settles.then(|| length(contacts.fold(plus(weight, load), plus)));
        let motion_j = if settles { 0.0 } else { motion_energy(shape, &scene.blocks[block].body, mass) };
        let released_j = released(springs, block, centroid);
        let smallest_side = sides(scene, block).into_iter().fold(f64::INFINITY, f64::min);
        Moving { block, scene, mass, smallest_side, borne, load, released_j, motion_j, unbalanced }
    }

    /// The direction in which these springs of a pair push it; 0 where they push nowhere.
    fn pushed_along(&self, springs: &[&PressedSpring]) -> [f64; 3] {
        let push = springs.iter().map(|spring| spring.push(self.block)).fold([0.0; 3], plus);
        let size = length(push);
        push.map(|part| if size > 0.0 { part / size } else { 0.0 })
    }

    /// What its loads press it with against the other block of a pair that pushes it along this direction (N).
    fn loaded_against(&self, along: [f64; 3]) -> f64 {
        (-dot(self.load, along)).max(0.0)
    }

    /// The part against gravity of the direction in which these springs push it; 0 without gravity.
    fn lifted(&self, springs: &[&PressedSpring]) -> f64 {
        let gravity = near(&self.scene.simulation.gravity);
        let pull = length(gravity);
        if pull > 0.0 { -dot(self.pushed_along(springs), gravity) / pull } else { 0.0 }
    }

    /// Whether what is unbalanced after settling is no more than this force (N).
    fn is_held(&self, force: f64) -> bool {
        self.unbalanced.is_some_and(|unbalanced| unbalanced <= force)
    }
}

fn near(vector: &Vec3<Number>) -> [f64; 3] {
    vector.components().map(Number::approximate)
}

/// The sides of a block's box (m).
fn sides(scene: &Scene, block: usize) -> [f64; 3] {
    let bounds = scene.blocks[block].block.bounds();
    [0, 1, 2].map(|k| bounds.max.components()[k].approximate() - bounds.min.components()[k].approximate())
}

/// In kg.
fn mass(scene: &Scene, block: usize) -> f64 {
    let SceneBlock { block, body, .. } = &scene.blocks[block];
    let density = scene.simulation.materials[body.material].density.approximate();
    density * Number::from_rational(block.volume()).approximate()
}

/// What the initial stress of a block presses at most on the largest side of its box (N).
fn pressed(scene: &Scene, block: usize) -> f64 {
    let body = &scene.blocks[block].body;
    // The Frobenius norm of a stress is at least its largest principal value.
    let [normal, shear] = [&body.stress[..3], &body.stress[3..]]
        .map(|parts| parts.iter().map(|part| part.approximate().powi(2)).sum::<f64>());
    let [x, y, z] = sides(scene, block);
    (normal + 2.0 * shear).sqrt() * (x * y).max(y * z).max(z * x)
}
