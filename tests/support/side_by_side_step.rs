//! A step of the stepper beside the oracle's step from the same state.

use rockproof_differential::lockstep::state::{exact_mode, exact_state};
use rockproof_model::{Body, Number, Point, Scene, ToleranceSet};
use rockproof_oracle::step as exact;
use rockproof_stepper::dynamics::{Dynamics, StepRules};
use std::rc::Rc;

/// Lengths that differ by less are the same: f64 leaves 10⁻¹² or so in scenes of a few metres.
const CLOSE: f64 = 1e-8;

/// The oracle's steps of one scene, by the states that they begin in: whatever rules bring the stepper into one of them, the step is the same.
#[derive(Default)]
pub(crate) struct ExactSteps(Vec<(exact::State, Rc<ExactStep>)>);

type ExactStep = Result<exact::StepAnswer, exact::StepFailure>;

impl ExactSteps {
    fn from(&mut self, model: &exact::StepModel<'_>, before: &exact::State) -> Rc<ExactStep> {
        if let Some((_, known)) = self.0.iter().find(|(state, _)| state == before) {
            return Rc::clone(known);
        }
        let made = Rc::new(exact::exact_step(model, before, exact::KeptPrecision::Grid { exponent: 80 }));
        self.0.push((before.clone(), Rc::clone(&made)));
        made
    }
}

/// Runs a scene of f64 numbers by the rules M, and compares each step with the oracle's from the same state: the first
/// difference in words, if there is one.
pub(crate) fn first_difference<M: StepRules>(
    scene: &Scene,
    set: &ToleranceSet,
    steps: u32,
    oracle: &mut ExactSteps,
) -> Option<String> {
    let mut scene = scene.clone();
    scene.derive_stiffness(set);
    let mut dynamics = Dynamics::<f64, M>::with_rules(&scene, set).unwrap();
    let shapes = scene.shapes();
    let bodies: Vec<Body> = scene.blocks.iter().map(|block| block.body.clone()).collect();
    let model = exact::StepModel { shapes: &shapes, bodies: &bodies, simulation: &scene.simulation, tolerances: set };
    for step in 1..=steps {
        let before = exact_state(dynamics.state()).unwrap();
        let answer = oracle.from(&model, &before);
        let report = dynamics.step();
        let (answer, report) = match (&*answer, report) {
            (Ok(answer), Ok(report)) => (answer, report),
            (Err(_), Err(_)) => return None,
            (one, other) => {
                return Some(format!("step {step}: oracle {:?}, stepper {:?}", one.as_ref().err(), other.err()));
            }
        };
        let differs = |what: &str| Some(format!("step {step}: {what}"));
        let contacts: Vec<_> =
            dynamics.state().contacts.iter().map(|c| (c.blocks.map(|b| b as usize), c.contact)).collect();
        let features = |c: &[([usize; 2], rockproof_model::Contact)]| -> Vec<_> {
            c.iter().map(|(blocks, c)| (*blocks, c.key, c.entrance)).collect()
        };
        if features(&contacts) != features(&answer.contacts) {
            return differs("contacts");
        }
        if report.retries.len() != answer.retries.len() {
            return differs("retries");
        }
        let given_up = dynamics.modes().iter().zip(&answer.retries);
        if given_up.into_iter().any(|(modes, attempt)| modes.len() != attempt.solves as usize) {
            return differs("solves of an attempt given up");
        }
        let time_step = Number::from_rational(answer.time_step.clone()).approximate();
        if (report.time_step - time_step).abs() > CLOSE * time_step {
            return differs("time step");
        }
        let attempt = dynamics.modes().last().unwrap();
        let modes: Vec<Vec<exact::Mode>> =
            attempt.iter().map(|modes| modes.iter().map(|&m| exact_mode(m)).collect()).collect();
        if modes != answer.modes[1..] || report.iterations != answer.iterations {
            return differs("modes");
        }
        if let Some(what) = moved_apart(&exact_state(dynamics.state()).unwrap(), &answer.state) {
            return differs(what);
        }
    }
    None
}

fn moved_apart(one: &exact::State, other: &exact::State) -> Option<&'static str> {
    let far = |a: &Number, b: &Number, scale: f64| (a.approximate() - b.approximate()).abs() > CLOSE * scale;
    let apart = |a: &Point, b: &Point| a.components().into_iter().zip(b.components()).any(|(a, b)| far(a, b, 1.0));
    for (a, b) in one.blocks.iter().zip(&other.blocks) {
        if a.vertices.iter().zip(&b.vertices).any(|(a, b)| apart(a, b)) {
            return Some("coordinates");
        }
        // A velocity is a displacement over Δt, here a hundredth or less.
        if a.velocity.iter().zip(&b.velocity).any(|(a, b)| far(a, b, 1e3)) {
            return Some("velocity");
        }
    }
    for (a, b) in one.contacts.iter().zip(&other.contacts) {
        // Of an open contact nothing is remembered.
        if a.mode != exact::Mode::Open && a.anchors.iter().zip(&b.anchors).any(|(a, b)| apart(a, b)) {
            return Some("anchors");
        }
    }
    None
}
