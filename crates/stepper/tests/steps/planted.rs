//! No deliberate mistake in the open–close iteration and step control is dead: each makes f64 differ from the golden steps, or, where
//! these have no such tolerance, from SPEC's rules in a scene of our own.

use crate::golden::{F64, decided, golden, run, text};
use crate::step_mistakes::{ALL, Mistake, Mistaken, PLANTING, plant};
use crate::support::{cuboid, floor, n, scene, tolerances, v};
use rockproof_model::scene::SceneFormat;
use rockproof_model::{Motion, Precision, Scene, ToleranceSet};
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::dynamics::{Dynamics, StepRules};
use serde_json::Value;
use std::path::Path;

/// The step in which f64 first decides otherwise than the file, or none; and whether all numbers before are those of the file.
fn outcome(scene: &Value) -> (Option<i64>, bool) {
    match run::<f64, Mistaken>(scene, F64) {
        Ok(off) => (None, off <= 1.0),
        Err(other) => (Some(other.step), true),
    }
}

/// Scenes for damping, for tolerances that are no zeros, and for blocks between the search distance and the penetration depth.
fn own_scenes() -> Vec<(&'static str, Scene, ToleranceSet)> {
    let block = |low: &str| cuboid("block", ["0", "0", low], ["1", "3/2", "1"], Motion::Rigid);
    let mut dull = scene(vec![floor(), block("1/256")]);
    dull.simulation.gravity = v("1", "0", "-10");
    dull.blocks[1].body.velocity = v("1/4", "0", "-1/4");
    dull.blocks[1].body.spin = v("1/8", "1/16", "0");
    // Too fast for the full Δt, and slowed down on the way to the floor.
    let mut damped = scene(vec![floor(), cuboid("block", ["0", "0", "3/4"], ["1", "3/2", "7/4"], Motion::Rigid)]);
    damped.blocks[1].body.velocity = v("1", "0", "-12");
    damped.simulation.control.damping = n("16");
    // Between plates that it touches nothing turns it.
    let ceiling = cuboid("ceiling", ["-8", "-8", "1"], ["8", "8", "2"], Motion::Fixed);
    let mut sideways = scene(vec![floor(), block("0"), ceiling]);
    sideways.simulation.gravity = v("0", "0", "0");
    sideways.blocks[1].body.velocity = v("1/4", "0", "0");
    let tolerant =
        |equal: &str| ToleranceSet { open: n("1/1024"), close: n("1/1024"), equal: n(equal), ..tolerances() };
    vec![
        ("near", scene(vec![floor(), block("3/32")]), tolerances()),
        ("open and close", dull.clone(), tolerant("0")),
        ("equal", dull, tolerant("1/4")),
        ("damped", damped, tolerances()),
        ("touching, weightless and moving sideways", sideways, tolerances()),
        locking_and_sliding(),
        steep_dominoes(),
    ]
}

/// A scene in f64 with the set that it names.
fn with_set(name: &'static str, scene: Scene) -> (&'static str, Scene, ToleranceSet) {
    let set = scene.tolerances.clone().unwrap_or_default().derive(&scene.shapes(), Precision::F64).unwrap();
    (name, scene, set)
}

/// A golden scene with Δt four times and tan φ half as large: of the seven changes of its first attempt the sixth is one between locked and
/// sliding. `oracle/tests/steps/golden_steps.rs` has both scenes exactly.
pub(crate) fn locking_and_sliding() -> (&'static str, Scene, ToleranceSet) {
    let scenes = golden();
    let found = scenes.iter().find(|scene| scene["name"] == "fast_disp_cut").unwrap();
    let mut scene = Scene::parse(text(&found["scene"]), SceneFormat::Toml, Path::new("golden.toml")).unwrap();
    scene.simulation.control.time_step = n("1/32");
    scene.simulation.joints.other.friction = n("3/10");
    with_set("locking and sliding", scene)
}

/// The handmade dominoes with Δt twice and tan φ four times as large: friction locks and slides until the first attempt is given up.
fn steep_dominoes() -> (&'static str, Scene, ToleranceSet) {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../cases/handmade/dominoes.toml");
    let mut scene = Scene::load(Path::new(file)).unwrap();
    scene.simulation.control.time_step = n("1/200");
    scene.simulation.joints.other.friction = n("12/5");
    with_set("steep dominoes", scene)
}

/// All that 24 steps decide.
fn decisions<M: StepRules>(scene: &Scene, set: &ToleranceSet) -> Vec<Vec<String>> {
    let mut dynamics = Dynamics::<f64, M>::with_rules(scene, set).unwrap();
    let step = |_| match dynamics.step() {
        Ok(report) => decided(&dynamics, &report),
        Err(stopped) => vec![stopped.to_string()],
    };
    (0..24).map(step).collect()
}

#[test]
fn every_mistake_shows_in_a_step() {
    let (scenes, own) = (golden(), own_scenes());
    let _alone = PLANTING.lock();
    plant(Mistake::Nothing);
    let right: Vec<_> = scenes.iter().map(outcome).collect();
    let own_right: Vec<_> = own.iter().map(|(_, scene, set)| decisions::<SpecRules>(scene, set)).collect();
    let mut lost = Vec::new();
    for &(mistake, what) in ALL.iter().filter(|(mistake, _)| *mistake != Mistake::Nothing) {
        plant(mistake);
        let of_file = scenes.iter().zip(&right).filter(|(scene, right)| outcome(scene) != **right);
        let of_file = of_file.map(|(scene, _)| text(&scene["name"]));
        let of_own = own.iter().zip(&own_right);
        let of_own = of_own.filter(|((_, scene, set), right)| decisions::<Mistaken>(scene, set) != **right);
        // One is enough.
        match of_file.chain(of_own.map(|((name, _, _), _)| *name)).next() {
            Some(scene) => println!("{what}: {scene}"),
            None => lost.push(what),
        }
    }
    plant(Mistake::Nothing);
    assert_eq!(lost, Vec::<&str>::new());
}
