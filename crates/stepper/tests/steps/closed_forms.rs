//! The float dynamics against closed forms that need no scene file, one for each part: inertia, weight, normal springs,
//! friction, elasticity, kinematics, areas, transfer.

use crate::support::{cuboid, n, tolerances};
use rockproof_model::scene::SceneBlock;
use rockproof_model::simulation::Kinematics;
use rockproof_model::{Motion, Number, Scene, Vec3};
use rockproof_stepper::dynamics::{Dynamics, Mode, Solve, StepReport};

fn v(x: &str, y: &str, z: &str) -> Vec3<Number> {
    Vec3::new(n(x), n(y), n(z))
}

fn floor() -> SceneBlock {
    cuboid("floor", ["-5", "-5", "-1"], ["5", "5", "0"], Motion::Fixed)
}

fn scene(blocks: Vec<SceneBlock>) -> Scene {
    let mut scene = Scene { blocks, ..Scene::default() };
    scene.simulation.gravity = v("0", "0", "-10");
    scene.simulation.materials[0].density = n("2000");
    scene.simulation.joints.other.normal_stiffness = Some(n("1e8"));
    scene
}

fn run<R: Solve>(scene: &Scene, steps: usize) -> (Dynamics<R>, Vec<StepReport>) {
    let mut scene = scene.clone();
    scene.derive_stiffness(&tolerances());
    let mut dynamics = Dynamics::<R>::new(&scene, &tolerances()).unwrap();
    let reports = (0..steps).map(|_| dynamics.step().unwrap()).collect();
    (dynamics, reports)
}

fn near(found: f64, expected: f64, relative: f64) {
    assert!((found - expected).abs() <= relative * expected.abs(), "{found} for {expected}");
}

#[test]
fn a_block_falls_and_flies_as_galileo_says() {
    let mut block = cuboid("one", ["0", "0", "0"], ["1", "2", "3"], Motion::Deformable);
    block.body.velocity = v("1/2", "1/4", "1");
    let (dynamics, reports) = run::<f64>(&scene(vec![block]), 10);
    let at = dynamics.centroid(0);
    near(at.x, 0.5 + 0.05, 1e-13);
    near(at.y, 1.0 + 0.025, 1e-13);
    near(at.z, 1.5 + 0.1 - 5.0 * 0.01, 1e-13);
    near(reports[9].time, 0.1, 1e-13);
    assert!(reports.iter().all(|r| r.iterations == 1 && r.converged && r.retries.is_empty()));
    let energy = |r: &StepReport| r.kinetic + r.potential();
    near(energy(&reports[9]), energy(&reports[0]), 1e-12);
}

#[test]
fn a_settled_block_rests_on_its_springs() {
    for motion in [Motion::Rigid, Motion::Deformable] {
        let mut scene = scene(vec![floor(), cuboid("one", ["0", "0", "0"], ["1", "1", "1"], motion)]);
        scene.simulation.control.settle = 200;
        let (dynamics, reports) = run::<f64>(&scene, 220);
        let last = reports.last().unwrap();
        let contacts = &dynamics.state().contacts;
        assert_eq!(contacts.len(), 4, "{contacts:?}");
        let force: f64 = contacts.iter().map(|c| if c.blocks == [0, 1] { -c.force.z } else { f64::NAN }).sum();
        // The weight is that of the present volume (docs/step.md).
        near(force, 20000.0 * dynamics.volume(1), 1e-9);
        if motion == Motion::Rigid {
            near(last.max_penetration, 20000.0 / (4.0 * 1e8), 1e-9);
        }
        assert!(contacts.iter().all(|c| c.mode == Mode::Locked));
    }
}

#[test]
fn a_block_slides_down_a_smooth_incline() {
    // Gravity leans by 3-4-5 instead of the plane.
    let mut scene = scene(vec![floor(), cuboid("one", ["0", "0", "0"], ["1", "1", "1"], Motion::Rigid)]);
    scene.simulation.gravity = v("6", "0", "-8");
    scene.simulation.control.settle = 60;
    for (friction, expected) in [("0", 6.0), ("1/4", 4.0), ("1/2", 2.0), ("4/5", 0.0)] {
        scene.simulation.joints.other.friction = n(friction);
        let (dynamics, _) = run::<f64>(&scene, 60 + 20);
        let settled = run::<f64>(&scene, 60).0.centroid(1).x;
        let slid = dynamics.centroid(1).x - settled;
        println!("tan φ = {friction}: {slid} for {}", 0.5 * expected * 0.04);
        if expected == 0.0 {
            // The static slip of the springs: m·6 / (4·p_s).
            assert!(slid.abs() < 12000.0 / (4.0 * 4e7), "{slid}");
        } else {
            near(slid, 0.5 * expected * 0.04, 2e-3);
        }
    }
}

#[test]
fn a_turning_block_keeps_its_volume_by_cayley_and_swells_linearly() {
    for (kinematics, swells) in [(Kinematics::Cayley, false), (Kinematics::Linear, true)] {
        let mut block = cuboid("one", ["-1", "-1", "-1"], ["1", "1", "1"], Motion::Rigid);
        block.body.spin = v("0", "0", "1");
        let mut scene = scene(vec![block]);
        scene.simulation.gravity = v("0", "0", "0");
        scene.simulation.control.kinematics = kinematics;
        let (dynamics, _) = run::<f64>(&scene, 100);
        let growth = dynamics.volume(0) / 8.0 - 1.0;
        if swells {
            // Each step multiplies lengths across the axis by √(1 + (ωΔt)²), the volume by its square.
            near(growth, 1.0001f64.powi(100) - 1.0, 1e-9);
        } else {
            assert!(growth.abs() < 1e-12, "{growth}");
        }
        near(dynamics.state().blocks[0].velocity[5], 1.0, 1e-12);
    }
}

#[test]
fn f32_does_the_same_with_fewer_digits() {
    let mut scene = scene(vec![floor(), cuboid("one", ["0", "0", "0"], ["1", "1", "1"], Motion::Rigid)]);
    scene.simulation.control.settle = 40;
    let (dynamics, _) = run::<f32>(&scene, 60);
    let force: f64 = dynamics.state().contacts.iter().map(|c| -f64::from(c.force.z)).sum();
    near(force, 20000.0, 1e-2);
}
