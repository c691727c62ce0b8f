//! Steps do not depend on the number of threads. Here, and not beside the stepper, since the crates below have compiled its steps with optimisation.

use crate::bricks::{BRICKS, bricks};
use rockproof_model::simulation::Solver;
use rockproof_model::{Motion, Scene, ToleranceSet};
use rockproof_stepper::dynamics::{Dynamics, StepReport};

#[test]
fn steps_are_the_same_bits_on_any_number_of_threads() {
    same_bits_on(&[3]);
}

#[test]
#[ignore = "twelve seconds; .ci/run runs it"]
fn steps_are_the_same_bits_on_more_numbers_of_threads_at_full_size() {
    same_bits_on(&[2, 3, 5]);
}

#[test]
fn steps_without_a_factor_are_the_same_bits_on_any_number_of_threads() {
    same_bits_without_a_factor(&[3]);
}

#[test]
#[ignore = "four seconds; .ci/run runs it"]
fn steps_without_a_factor_are_the_same_bits_on_more_numbers_of_threads_at_full_size() {
    same_bits_without_a_factor(&[2, 3]);
}

fn same_bits_without_a_factor(numbers: &[usize]) {
    for (size, twice, motion) in [
        ([9, 1, 32], true, Motion::Deformable),
        ([7, 7, 7], false, Motion::Rigid),
        ([6, 6, 8], false, Motion::Deformable),
    ] {
        let (mut scene, set) = bricks(size, twice, motion);
        scene.simulation.control.solver = Solver::ConjugateGradients;
        same_bits(&scene, &set, numbers);
    }
}

fn same_bits_on(numbers: &[usize]) {
    for (size, twice, motion, _) in BRICKS {
        let (scene, set) = bricks(size, twice, motion);
        same_bits(&scene, &set, numbers);
    }
}

fn same_bits(scene: &Scene, set: &ToleranceSet, numbers: &[usize]) {
    let by = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| {
            let mut dynamics = Dynamics::<f64>::new(scene, set).expect("a scene");
            let reports: Vec<StepReport> = (0..2).map(|_| dynamics.step().expect("a step that converges")).collect();
            // Zeros of both signs are equal, but not the same bits: they are written differently.
            (reports, dynamics.modes().to_vec(), format!("{:?}", dynamics.state()))
        })
    };
    let one = by(1);
    for &threads in numbers {
        assert!(by(threads) == one, "{} blocks on {threads} threads", scene.blocks.len());
    }
}
