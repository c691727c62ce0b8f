//! Point loads with time tables, fixed points, measured points.
//!
//! Without contacts a step is d = vΔt + FΔt²/2m and v' = v + FΔt/m with the force F at its end.

use crate::support::{begin, cube, load, n, near, run, scene, tolerances, v, weightless};
use rockproof_model::simulation::{FixedPoint, MeasuredPoint};
use rockproof_model::{Motion, Scene};
use rockproof_stepper::dynamics::Dynamics;

/// m = 2000 kg, Δt = 1/100 s.
const MASS: f64 = 2000.0;
const STEP: f64 = 0.01;

fn pushed(table: &[(&str, [&str; 3])], at: [&str; 3]) -> Scene {
    let mut scene = weightless(vec![cube()]);
    let table: Vec<_> = table.iter().map(|(t, f)| (*t, v(f[0], f[1], f[2]))).collect();
    scene.simulation.loads.push(load(0, v(at[0], at[1], at[2]), &table));
    scene
}

const CENTRE: [&str; 3] = ["1/2", "1/2", "1/2"];

#[test]
fn a_force_that_grows_with_time_is_taken_at_the_end_of_each_step() {
    // F = 4000 t N: v after n steps is c Δt² n(n+1)/2m, the way c Δt³ n(n+1)(2n+1)/12m, with c = 4000 N/s.
    let scene = pushed(&[("0", ["0", "0", "0"]), ("1", ["4000", "0", "0"])], CENTRE);
    let (dynamics, _) = run::<f64>(&scene, 50);
    let c = 4000.0 * STEP * STEP / MASS;
    near(dynamics.state().blocks[0].velocity[0], c * 50.0 * 51.0 / 2.0, 1e-12);
    near(dynamics.centroid(0).x - 0.5, c * STEP * 50.0 * 51.0 * 101.0 / 12.0, 1e-12);
}

#[test]
fn outside_its_table_a_force_is_constant() {
    // 100 N before 1/10 s, 300 N from 1/5 s on, linear between: 120, 140 … at the ends of steps 11 to 20.
    let table = [("1/10", ["100", "0", "0"]), ("1/5", ["300", "0", "0"])];
    let (dynamics, _) = run::<f64>(&pushed(&table, CENTRE), 30);
    let forces = 10.0 * 100.0 + (1..=10).map(|k| 100.0 + 20.0 * f64::from(k)).sum::<f64>() + 10.0 * 300.0;
    near(dynamics.state().blocks[0].velocity[0], forces * STEP / MASS, 1e-12);
}

#[test]
fn a_force_beside_the_centroid_turns_the_block() {
    // At (1, 1/2, 1/2) along y: the moment is 1/2 m · 600 N about z, the moment of inertia of a cube m/6.
    let (dynamics, _) = run::<f64>(&pushed(&[("0", ["0", "600", "0"])], ["1", "1/2", "1/2"]), 1);
    let velocity = dynamics.state().blocks[0].velocity;
    near(velocity[1], 600.0 * STEP / MASS, 1e-12);
    near(velocity[5], 300.0 * STEP / (MASS / 6.0), 1e-12);
    assert!(velocity[3] == 0.0 && velocity[4] == 0.0, "{velocity:?}");
}

#[test]
fn a_load_moves_with_its_point() {
    // The block flies at 1 m/s; the load stays at its centroid and never turns it.
    let mut scene = pushed(&[("0", ["0", "600", "0"])], CENTRE);
    scene.blocks[0].body.velocity = v("1", "0", "0");
    let (dynamics, _) = run::<f64>(&scene, 50);
    let state = dynamics.state();
    near(state.load_points[0].x, 1.0, 1e-13);
    assert!(state.blocks[0].velocity[3..6].iter().all(|w| w.abs() < 1e-13), "{:?}", state.blocks[0].velocity);
}

#[test]
fn a_block_hangs_on_its_fixed_points() {
    // Two springs of 2e6 and 6e6 N/m above the centroid bear 20 kN: x with W = (k1 + k2) x.
    for motion in [Motion::Rigid, Motion::Deformable] {
        let mut scene = scene(vec![cube()]);
        scene.blocks[0].body.motion = motion;
        scene.simulation.control.settle = 400;
        for stiffness in ["2e6", "6e6"] {
            let stiffness = Some(n(stiffness));
            scene.simulation.fixed_points.push(FixedPoint { block: 0, at: v("1/2", "1/2", "1"), stiffness });
        }
        let (dynamics, reports) = run::<f64>(&scene, 400);
        let state = dynamics.state();
        let weight = 20000.0 * dynamics.volume(0);
        let stretch = weight / 8e6;
        for at in &state.fixed_points {
            near(1.0 - at.z, stretch, 1e-9);
            assert!((at.x - 0.5).abs() < 1e-12 && (at.y - 0.5).abs() < 1e-12, "{at:?}");
        }
        near(reports[399].springs, 0.5 * 8e6 * stretch * stretch, 1e-9);
    }
}

#[test]
fn a_measured_point_turns_with_its_block() {
    // By `cayley` each step turns by 2·atan(ωΔt/2), in 100 steps by a hundred times that.
    let mut scene = weightless(vec![cube()]);
    scene.blocks[0].body.spin = v("0", "0", "4");
    scene.simulation.measured_points.push(MeasuredPoint {
        name: "corner".to_owned(),
        block: 0,
        at: v("1", "1/2", "1/2"),
    });
    let mut dynamics: Dynamics<f64> = Dynamics::new(&scene, &tolerances()).unwrap();
    for step in 1..=100 {
        dynamics.step().unwrap();
        let angle = 2.0 * f64::from(step) * (4.0 * STEP / 2.0).atan();
        let at = dynamics.state().measured_points[0];
        let (x, y) = (0.5 + 0.5 * angle.cos(), 0.5 + 0.5 * angle.sin());
        assert!((at.x - x).abs() < 1e-12 && (at.y - y).abs() < 1e-12 && at.z == 0.5, "{at:?} for {x} {y}");
    }
}

#[test]
fn points_of_fixed_blocks_stay() {
    let mut scene = scene(vec![cube()]);
    scene.blocks[0].body.motion = Motion::Fixed;
    scene.simulation.loads.push(load(0, v("1", "1", "1"), &[("0", v("1e9", "0", "0"))]));
    scene.simulation.measured_points.push(MeasuredPoint { name: "one".to_owned(), block: 0, at: v("1", "1", "1") });
    let mut dynamics = begin::<f64>(&scene);
    let before = dynamics.state().clone();
    dynamics.step().unwrap();
    let after = dynamics.state();
    assert!(after.blocks == before.blocks && after.load_points == before.load_points);
    assert_eq!(after.measured_points, before.measured_points);
}
