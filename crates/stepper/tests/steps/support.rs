//! Small scenes.

use rockproof_model::scene::SceneBlock;
use rockproof_model::simulation::PointLoad;
use rockproof_model::{Block, Motion, Number, Precision, Scene, ToleranceSet, Vec3};
use rockproof_stepper::dynamics::{Dynamics, Solve, StepReport};
use std::path::Path;

pub(crate) fn n(text: &str) -> Number {
    Number::parse(text).unwrap()
}

pub(crate) fn v(x: &str, y: &str, z: &str) -> Vec3<Number> {
    Vec3::new(n(x), n(y), n(z))
}

/// Without Eq. (1), εo and εc; displacements up to 1/16 m, rotations up to 1/8.
pub(crate) fn tolerances() -> ToleranceSet {
    ToleranceSet {
        search: n("1/8"),
        territory: n("1/100"),
        penetration: n("1/16"),
        overlap_sine: n("1/20"),
        parallel_sine: n("1/20"),
        max_displacement: n("1/16"),
        max_rotation: n("1/8"),
        ..ToleranceSet::ZERO
    }
}

pub(crate) fn cuboid(name: &str, min: [&str; 3], max: [&str; 3], motion: Motion) -> SceneBlock {
    let corner = |c: [&str; 3]| v(c[0], c[1], c[2]);
    let mut block = SceneBlock::new(name, Block::cuboid(&corner(min), &corner(max)).unwrap());
    block.body.motion = motion;
    block
}

/// A rigid cube of 1 m³ with its low corner at the origin.
pub(crate) fn cube() -> SceneBlock {
    cuboid("cube", ["0", "0", "0"], ["1", "1", "1"], Motion::Rigid)
}

pub(crate) fn floor() -> SceneBlock {
    cuboid("floor", ["-5", "-5", "-1"], ["5", "5", "0"], Motion::Fixed)
}

/// Gravity 10 m/s² downwards, 2000 kg/m³, springs of 1e8 N/m, shear springs of 2/5 of that.
pub(crate) fn scene(blocks: Vec<SceneBlock>) -> Scene {
    let mut scene = Scene { blocks, ..Scene::default() };
    scene.simulation.gravity = v("0", "0", "-10");
    scene.simulation.materials[0].density = n("2000");
    scene.simulation.joints.other.normal_stiffness = Some(n("1e8"));
    scene
}

pub(crate) fn weightless(blocks: Vec<SceneBlock>) -> Scene {
    let mut scene = scene(blocks);
    scene.simulation.gravity = v("0", "0", "0");
    scene
}

/// A force by a table of (time, force).
pub(crate) fn load(block: usize, at: Vec3<Number>, table: &[(&str, Vec3<Number>)]) -> PointLoad {
    PointLoad { block, at, table: table.iter().map(|(time, force)| (n(time), force.clone())).collect() }
}

pub(crate) fn begin<R: Solve>(scene: &Scene) -> Dynamics<R> {
    Dynamics::new(scene, &tolerances()).unwrap()
}

pub(crate) fn run<R: Solve>(scene: &Scene, steps: usize) -> (Dynamics<R>, Vec<StepReport>) {
    let mut dynamics = begin(scene);
    let reports = (0..steps).map(|_| dynamics.step().unwrap()).collect();
    (dynamics, reports)
}

/// A scene of `cases/handmade` with its tolerances.
pub(crate) fn handmade(name: &str, precision: Precision) -> (Scene, ToleranceSet) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../cases/handmade").join(name);
    let scene = Scene::load(file).unwrap();
    let set = scene.tolerances.clone().unwrap().derive(&scene.shapes(), precision).unwrap();
    (scene, set)
}

/// Its stiffnesses chosen, and at its beginning.
pub(crate) fn beginning<R: Solve>(mut scene: Scene, set: &ToleranceSet) -> Dynamics<R> {
    scene.derive_stiffness(set);
    Dynamics::new(&scene, set).unwrap()
}

#[track_caller]
pub(crate) fn near(found: f64, expected: f64, relative: f64) {
    assert!((found - expected).abs() <= relative * expected.abs(), "{found} for {expected}");
}
