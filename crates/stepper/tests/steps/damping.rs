//! Viscous damping against closed forms: the discrete formula of a damped flight, its convergence to exp(−ct), settling without it.

use crate::support::{begin, cube, floor, n, scene, v, weightless};
use rockproof_model::{Motion, Scene};
use rockproof_stepper::Wide;
use rockproof_stepper::dynamics::{Dynamics, Solve};

/// A cube that flies and turns without weight; c in 1/s.
fn flight(time_step: &str, damping: &str) -> Scene {
    let mut scene = weightless(vec![cube()]);
    scene.blocks[0].body.velocity = v("2", "0", "-1");
    scene.blocks[0].body.spin = v("0", "0", "1/2");
    scene.simulation.control.time_step = n(time_step);
    scene.simulation.control.damping = n(damping);
    scene
}

/// Every step takes rates by (1 − x)/(1 + x), x = cΔt/2, and the centroid along by Δt times the mean of both velocities.
fn flies_by_the_formula<R: Solve>(accuracy: f64) {
    let mut dynamics = begin::<R>(&flight("1/128", "8"));
    let share: f64 = (1.0 - 1.0 / 32.0) / (1.0 + 1.0 / 32.0);
    let mut x = 0.5;
    for step in 1..=20 {
        dynamics.step().unwrap();
        x += 2.0 * share.powi(step - 1) * (1.0 + share) / 256.0;
        let found = dynamics.state().blocks[0].velocity.map(R::to_f64);
        for (place, first) in [(0, 2.0), (2, -1.0), (5, 0.5)] {
            let known = first * share.powi(step);
            assert!((found[place] - known).abs() <= accuracy * known.abs(), "step {step}: {found:?}");
        }
        let at = dynamics.centroid(0).x.to_f64();
        assert!((at - x).abs() <= accuracy * x, "step {step}: {at} for {x}");
    }
}

#[test]
fn a_damped_flight_is_that_of_the_discrete_formula_in_every_scalar() {
    flies_by_the_formula::<f64>(1e-13);
    flies_by_the_formula::<f32>(1e-5);
    flies_by_the_formula::<Wide>(1e-14);
}

/// The velocity after a second of a flight with c = 2/s, over exp(−2), less 1.
fn error(steps: u32) -> f64 {
    let mut dynamics = begin::<f64>(&flight(&format!("1/{steps}"), "2"));
    (0..steps).for_each(|_| drop(dynamics.step().unwrap()));
    dynamics.state().blocks[0].velocity[0] / (2.0 * (-2.0f64).exp()) - 1.0
}

#[test]
fn halving_the_time_step_quarters_what_is_missing_of_the_exponential() {
    // ln((1 − x)/(1 + x)) = −2x − 2x³/3 − …: in all −c³Δt²t/12 too much.
    let errors = [64, 128, 256].map(error);
    assert!((errors[0] + 8.0 / 12.0 / 4096.0).abs() < 1e-6, "{errors:?}");
    for two in errors.windows(2) {
        assert!((two[0] / two[1] - 4.0).abs() < 0.01, "{errors:?}");
    }
}

#[test]
fn a_falling_block_reaches_the_speed_at_which_damping_bears_its_weight() {
    let mut falling = scene(vec![cube()]);
    falling.simulation.control.damping = n("10");
    let mut dynamics = begin::<f64>(&falling);
    (0..400).for_each(|_| drop(dynamics.step().unwrap()));
    let [before, speed] = [dynamics.centroid(0).z, dynamics.state().blocks[0].velocity[2]];
    assert!((speed + 1.0).abs() < 1e-12, "{speed}");
    let report = dynamics.step().unwrap();
    assert!((dynamics.centroid(0).z - before + report.time_step).abs() < 1e-12);
}

#[test]
fn settling_is_not_damped() {
    let settled = |damping: &str| {
        let mut scene = scene(vec![floor(), cube()]);
        scene.blocks[1].body.motion = Motion::Deformable;
        (scene.simulation.control.settle, scene.simulation.control.damping) = (5, n(damping));
        let mut dynamics: Dynamics<f64> = begin(&scene);
        (0..5).for_each(|_| drop(dynamics.step().unwrap()));
        dynamics.state().clone()
    };
    assert_eq!(settled("0"), settled("100"));
}
