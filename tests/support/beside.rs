//! A step of the stepper beside the oracle's step from the same state.

use rockproof::model::simulation::derive_stiffness;
use rockproof::model::{Body, Number, Point, Scene, ToleranceSet, Vec3};
use rockproof::oracle::step as exact;
use rockproof::stepper::Vector;
use rockproof::stepper::dynamics::{BlockState, ContactState, Dynamics, Mode, State, StepRules};

fn number(value: f64) -> Number {
    Number::from_f64(value).unwrap()
}

fn point(v: Vector<f64>) -> Point {
    Vec3::new(number(v.x), number(v.y), number(v.z))
}

fn mode(mode: Mode) -> exact::Mode {
    match mode {
        Mode::Open => exact::Mode::Open,
        Mode::Sliding => exact::Mode::Sliding,
        Mode::Locked => exact::Mode::Locked,
    }
}

/// A state of the stepper, every number as the exact one it is.
fn exact_state(state: &State<f64>) -> exact::State {
    let block = |block: &BlockState<f64>| exact::BlockState {
        vertices: block.vertices.iter().map(|&v| point(v)).collect(),
        velocity: block.velocity.map(number),
        stress: block.stress.map(number),
    };
    let contact = |c: &ContactState<f64>| exact::ContactMemory {
        blocks: c.blocks.map(|block| block as usize),
        contact: c.contact,
        mode: mode(c.mode),
        anchors: c.anchors.map(point),
    };
    exact::State {
        time: number(state.time),
        settling: state.settling,
        blocks: state.blocks.iter().map(block).collect(),
        load_points: state.load_points.iter().map(|&v| point(v)).collect(),
        fixed_points: state.fixed_points.iter().map(|&v| point(v)).collect(),
        contacts: state.contacts.iter().map(contact).collect(),
    }
}

/// Lengths that differ by less are the same: f64 leaves 10⁻¹² or so in scenes of a few metres.
const CLOSE: f64 = 1e-8;

/// Runs a scene of f64 numbers by the rules M, and compares each step with the oracle's from the same state: the first
/// difference in words, if there is one.
pub(crate) fn first_difference<M: StepRules>(scene: &Scene, set: &ToleranceSet, steps: u32) -> Option<String> {
    let mut scene = scene.clone();
    let bodies: Vec<_> = scene.blocks.iter().map(|block| (&block.block, &block.body)).collect();
    derive_stiffness(&mut scene.simulation, &bodies, set);
    let mut dynamics = Dynamics::<f64, M>::with_rules(&scene, set).unwrap();
    let shapes = scene.shapes();
    let bodies: Vec<Body> = scene.blocks.iter().map(|block| block.body.clone()).collect();
    let model = exact::StepModel { shapes: &shapes, bodies: &bodies, simulation: &scene.simulation, tolerances: set };
    for step in 1..=steps {
        let before = exact_state(dynamics.state());
        let answer = exact::exact_step(&model, &before, exact::Keep::Grid { exponent: 80 });
        let report = dynamics.step();
        let (answer, report) = match (answer, report) {
            (Ok(answer), Ok(report)) => (answer, report),
            (Err(_), Err(_)) => return None,
            (one, other) => {
                return Some(format!("step {step}: oracle {:?}, stepper {:?}", one.err(), other.err()));
            }
        };
        let differs = |what: &str| Some(format!("step {step}: {what}"));
        let contacts: Vec<_> =
            dynamics.state().contacts.iter().map(|c| (c.blocks.map(|b| b as usize), c.contact)).collect();
        let features = |c: &[([usize; 2], rockproof::model::Contact)]| -> Vec<_> {
            c.iter().map(|(blocks, c)| (*blocks, c.kind, c.a, c.b, c.entrance)).collect()
        };
        if features(&contacts) != features(&answer.contacts) {
            return differs("contacts");
        }
        if report.retries.len() != answer.cuts.len() {
            return differs("retries");
        }
        let time_step = Number::from_rational(answer.time_step.clone()).approximate();
        if (report.time_step - time_step).abs() > CLOSE * time_step {
            return differs("time step");
        }
        let attempt = dynamics.modes().last().unwrap();
        let modes: Vec<Vec<exact::Mode>> =
            attempt.iter().map(|modes| modes.iter().map(|&m| mode(m)).collect()).collect();
        if modes != answer.modes[1..] || report.iterations != answer.iterations {
            return differs("modes");
        }
        if let Some(what) = moved_apart(&exact_state(dynamics.state()), &answer.state) {
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
