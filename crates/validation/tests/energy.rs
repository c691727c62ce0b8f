//! Energy of what falls and comes to rest, in the runs of the table that take little time, and of a wall at rest.

use rayon::prelude::*;
use rockproof_model::Motion;
use rockproof_stepper::Real;
use rockproof_stepper::contact::{ContactRules, SpecRules};
use rockproof_stepper::dynamics::StepRules;
use rockproof_validation::energy::{DropScene, EnergyResult, EnergyRun, STEP_GOAL, SUM_GOAL};
use rockproof_validation::wall::Wall;

/// Runs of few steps: rigid and deformable, at Δt of 5 and 10 ms. Without optimisation single bricks and pairs alone.
fn quick() -> Vec<EnergyRun> {
    let (scenes, variants) = if cfg!(debug_assertions) { (3, 1) } else { (DropScene::ALL.len(), 2) };
    let mut runs = Vec::new();
    for scene in &DropScene::ALL[..scenes] {
        for motion in [Motion::Rigid, Motion::Deformable] {
            for time_step in [5e-3, 1e-2] {
                runs.extend(EnergyRun::variants(*scene, motion, time_step).take(variants));
            }
        }
    }
    runs
}

#[test]
fn what_falls_gains_next_to_nothing() {
    let results: Vec<EnergyResult> = quick().into_par_iter().map(|run| run.measure::<SpecRules>().unwrap()).collect();
    for result in &results {
        let run = &result.run;
        assert!(result.worst.gain <= STEP_GOAL, "{run:?}: {:?}", result.worst);
        assert!(result.drop > 1e3 && result.left < 0.8, "{run:?}: {} J, {} left", result.drop, result.left);
    }
    let mean = results.iter().map(|result| result.gained).sum::<f64>() / results.len() as f64;
    assert!(mean <= SUM_GOAL, "{mean}");
}

/// Velocities a thousandth too large after every step.
struct Faster;

impl ContactRules for Faster {}

impl StepRules for Faster {
    fn rate<R: Real>(dynamic: R, twice_mean: R, before: R) -> R {
        dynamic * (twice_mean - before) * R::from_f64(1.001)
    }
}

#[test]
fn a_thousandth_more_velocity_is_seen() {
    for run in EnergyRun::variants(DropScene::Tumbling, Motion::Rigid, 5e-3) {
        let gained = run.measure::<Faster>().unwrap().gained;
        assert!(gained > SUM_GOAL, "{run:?}: {gained}");
    }
}

#[test]
fn a_small_wall_stays_where_it_settled() {
    let wall = Wall { bricks: 3, courses: 4, motion: Motion::Rigid, settling: 60, steps: 20 };
    let drift = wall.measure().unwrap();
    assert!(drift.settled > 0.0 && drift.settled < 1e-3, "{} m", drift.settled);
    assert!(drift.drift[1] < 0.01 * drift.settled && drift.weight < 1e-3, "{:?} m, {}", drift.drift, drift.weight);
}
