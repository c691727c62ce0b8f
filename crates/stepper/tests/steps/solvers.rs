//! Steps by conjugate gradients without a factor: closed forms, and the same decisions and energies as by a factor.

use crate::support::{begin, cuboid, floor, n, near, scene};
use rockproof_model::simulation::Solver;
use rockproof_model::{Motion, Scene};
use rockproof_stepper::dynamics::{Dynamics, StepReport};

/// Cubes of 1 m on one another: of twelve, deformable, or twenty, rigid, the system is not solved as a dense one.
fn stack(motion: Motion, solver: Solver) -> Scene {
    let cubes = if motion == Motion::Rigid { 20 } else { 12 };
    let cube =
        |k: u32| cuboid(&format!("cube {k}"), ["0", "0", &k.to_string()], ["1", "1", &(k + 1).to_string()], motion);
    let mut scene = scene([floor()].into_iter().chain((0..cubes).map(cube)).collect());
    scene.simulation.control.solver = solver;
    scene
}

/// In rest, each joint bears the weight of what is above it: 20 kN a cube, by four springs of 1e8 N/m. A cube that is pressed weighs less, by
/// some millionths, since its volume is less.
#[test]
fn a_stack_presses_by_its_weight() {
    for (motion, relative) in [(Motion::Deformable, 1e-5), (Motion::Rigid, 1e-6)] {
        let mut scene = stack(motion, Solver::ConjugateGradients);
        scene.simulation.control.dynamic = n("0");
        let mut dynamics: Dynamics<f64> = begin(&scene);
        for _ in 0..1000 {
            dynamics.step().unwrap();
        }
        let cubes = scene.blocks.len() as u32 - 1;
        for below in 0..cubes {
            let joint = dynamics.state().contacts.iter().filter(|contact| contact.blocks == [below, below + 1]);
            let (gaps, forces): (Vec<f64>, Vec<f64>) = joint.map(|contact| (contact.gap, contact.force.z)).unzip();
            let weight = 2e4 * f64::from(cubes - below);
            assert_eq!(gaps.len(), 4);
            near(-forces.iter().sum::<f64>(), weight, relative);
            gaps.iter().for_each(|gap| near(-gap, weight / 4e8, relative));
        }
    }
}

/// A stack that falls by a centimetre swings: whatever solves, the decisions are the same, and energies to eleven digits.
#[test]
fn a_stack_swings_as_by_a_factor() {
    for motion in [Motion::Deformable, Motion::Rigid] {
        let by = |solver: Solver| {
            let mut scene = stack(motion, solver);
            for block in &mut scene.blocks {
                block.body.velocity.z = n("-1/2");
            }
            let mut dynamics: Dynamics<f64> = begin(&scene);
            let steps = |dynamics: &mut Dynamics<f64>| -> (StepReport, Vec<Vec<Vec<_>>>) {
                (dynamics.step().unwrap(), dynamics.modes().to_vec())
            };
            (0..25).map(|_| steps(&mut dynamics)).collect::<Vec<_>>()
        };
        let (factor, gradients) = (by(Solver::Factor), by(Solver::ConjugateGradients));
        assert!(factor != gradients, "{motion:?}: last bits show that another solver was at work");
        let most = factor.iter().fold(0.0f64, |most, (report, _)| most.max(report.kinetic));
        for (step, ((one, modes), (other, others))) in factor.iter().zip(&gradients).enumerate() {
            assert_eq!(modes, others, "{motion:?}, step {step}");
            let apart = (one.kinetic - other.kinetic).abs();
            assert!(most > 1e3 && apart <= 1e-11 * most, "{motion:?}, step {step}: {apart} of {most}");
        }
        assert_eq!(by(Solver::Auto), factor, "{motion:?}: small systems have a factor");
    }
}
