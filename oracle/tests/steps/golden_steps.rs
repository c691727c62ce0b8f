//! Every step of the 42 scenes that an independent implementation of SPEC section 5 worked out: attempts, Δt, solves, contacts, modes,
//! gaps, vertices and velocities.

use crate::support::golden_steps::{GoldenScene, GoldenStep, scenes};
use crate::support::project_file;
use crate::support::shapes::exact;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Signed};
use rockproof_model::simulation::Unconverged;
use rockproof_model::{Number, Precision, Scene};
use rockproof_oracle::step::{
    FailedAttempt, IterationEnd, KeptPrecision, Mode, RetryReason, State, StepAnswer, StepFailure, StepModel,
    certified_step, exact_step,
};
use std::sync::atomic::{AtomicUsize, Ordering};

/// The grid of the witness.
const KEEP: KeptPrecision = KeptPrecision::Grid { exponent: 252 };

fn power_of_ten(exponent: usize) -> BigRational {
    BigRational::from_integer(num_traits::pow(BigInt::from(10), exponent))
}

fn decimal(text: &str) -> BigRational {
    Number::parse(text).expect("a decimal number").to_rational()
}

/// Whether two values agree to 1e-27 of max(1, value).
fn agrees(found: &Number, expected: &str) -> bool {
    let expected = decimal(expected);
    let scale = expected.abs().max(BigRational::one());
    (found.to_rational() - expected).abs() * power_of_ten(27) <= scale
}

/// Whether a gap agrees in the 20 digits that are given; below 2⁻¹⁵⁰ m it is given as 0.
fn agrees_in_digits(found: &Number, expected: &str) -> bool {
    let (found, expected) = (found.to_rational(), decimal(expected));
    let smallest = BigRational::new(BigInt::one(), BigInt::one() << 150);
    (found - &expected).abs() <= (expected.abs() / power_of_ten(19)).max(smallest)
}

/// What disagrees in one step, in words; `set` has the velocities of the scene.
fn differences(expected: &GoldenStep, set: &State, before: &State, answer: &StepAnswer) -> Vec<String> {
    let mut found = Vec::new();
    let mut want = |what: &str, same: bool, got: String| {
        if !same {
            found.push(format!("{what}: {got}"));
        }
    };
    let settling = before.settling > 0;
    want("settling", settling == expected.settling, format!("{settling}"));
    want("time step", answer.time_step == exact(&expected.time_step), format!("{}", answer.time_step));
    want("solves", answer.iterations == expected.solves, format!("{}", answer.iterations));
    want("converged", answer.converged == expected.converged, format!("{:?}", answer.end));
    let given_up = |attempt: &FailedAttempt| ((attempt.reason, attempt.time_step.clone()), attempt.solves);
    let retried: Vec<_> = answer.retries.iter().map(given_up).collect();
    let retries: Vec<_> = expected.retries.iter().map(|retry| (retry.given_up(), retry.solves)).collect();
    want("retries", retried == retries, format!("{retried:?}"));
    let features = |(blocks, c): &([usize; 2], rockproof_model::Contact)| {
        (*blocks, c.kind(), c.key.numbers(), c.entrance.kind(), c.entrance.numbers())
    };
    let contacts: Vec<_> = answer.contacts.iter().map(features).collect();
    let expected_contacts: Vec<_> = expected.contacts.iter().map(|contact| contact.features()).collect();
    want("contacts", contacts == expected_contacts, format!("{contacts:?}"));
    let modes: Vec<_> = {
        let [.., last, after] = answer.modes.as_slice() else { panic!("a step has a solve") };
        last.iter().zip(after).map(|(last, after)| [*last, *after]).collect()
    };
    let expected_modes: Vec<_> = expected.contacts.iter().map(|contact| contact.modes()).collect();
    want("modes", modes == expected_modes, format!("{modes:?}, not {expected_modes:?}"));
    want("undecided", answer.levels.undecided == 0, format!("{:?}", answer.levels));
    want("gaps", answer.gaps.len() == expected.contacts.len(), format!("of {} contacts", answer.gaps.len()));
    for (k, (gaps, contact)) in answer.gaps.iter().zip(&expected.contacts).enumerate() {
        let same = agrees_in_digits(&gaps.before, &contact.gap_before) && agrees_in_digits(&gaps.after, &contact.gap);
        want("gaps", same, format!("contact {k}: {} {}", gaps.before.approximate(), gaps.after.approximate()));
    }
    for (block, (expected, state)) in expected.blocks.iter().zip(&answer.state.blocks).enumerate() {
        let Some(expected) = expected else { continue };
        let given = expected.vertices.iter().flatten();
        let same = given.zip(state.vertices.iter().flat_map(|v| v.components())).all(|(text, x)| agrees(x, text));
        want("vertices", same && state.vertices.len() == expected.vertices.len(), format!("block {block}"));
        // The file has the velocity that the last step of settling leaves; the state that follows it, the one that the scene sets.
        let settled = before.settling == 1 && state.velocity == set.blocks[block].velocity;
        let same = state.velocity.iter().zip(&expected.velocity).all(|(rate, text)| {
            let rate = if settled { &Number::ZERO } else { rate };
            agrees(rate, text)
        });
        want("velocity", same && [6, 12].contains(&expected.velocity.len()), format!("block {block}"));
    }
    found
}

/// Holds the end of an iteration against the modes of its solves.
fn counted(answer: &StepAnswer) {
    assert_eq!(answer.modes.len(), answer.iterations as usize + 1);
    let opens =
        |pair: &[Vec<Mode>]| pair[0].iter().zip(&pair[1]).any(|(a, b)| (*a == Mode::Open) != (*b == Mode::Open));
    let pairs: Vec<_> = answer.modes.windows(2).collect();
    let [earlier @ .., last] = pairs.as_slice() else { panic!("a step has a solve") };
    let (mut changes, mut same) = (0, 0);
    for pair in earlier {
        *(if pair[0] == pair[1] { &mut same } else { &mut changes }) += 1;
        let most = if opens(pair) { 6 } else { 12 };
        assert!(same < 7 && (pair[0] == pair[1] || changes < most), "an iteration went on: {:?}", answer.modes);
    }
    match answer.end {
        IterationEnd::Settled => assert!(!opens(last)),
        IterationEnd::Unchanged => assert!(last[0] == last[1] && same == 6),
        IterationEnd::Changing => assert!(last[0] != last[1] && if opens(last) { changes >= 5 } else { changes == 11 }),
    }
    assert_eq!(answer.converged, answer.end != IterationEnd::Changing);
}

/// The disagreements of a scene, to the first step that has any; and how many steps agree.
fn examine(scene: &GoldenScene) -> (usize, Vec<String>) {
    let shapes = scene.shapes();
    let model = scene.model(&shapes);
    let mut state = State::initial(&model);
    let set = {
        let mut unsettled = scene.simulation().clone();
        unsettled.control.settle = 0;
        State::initial(&StepModel { simulation: &unsettled, ..model })
    };
    for (done, expected) in scene.steps.iter().enumerate() {
        let place = format!("{} step {}", scene.name, expected.step);
        // Steps of settling are numbered up to 0.
        let number = done as i64 + 1 - i64::from(model.simulation.control.settle);
        if number != expected.step {
            return (done, vec![format!("{place}: numbered {number}")]);
        }
        let answer = match exact_step(&model, &state, KEEP) {
            Ok(answer) => answer,
            Err(why) => return (done, vec![format!("{place}: {why}")]),
        };
        counted(&answer);
        let found = differences(expected, &set, &state, &answer);
        if !found.is_empty() {
            return (done, found.into_iter().map(|what| format!("{place}: {what}")).collect());
        }
        state = answer.state;
    }
    let stopped = exact_step(&model, &state, KEEP).err().map(|why| why.to_string());
    match (&scene.stops, stopped) {
        (Some(expected), None) => (scene.steps.len(), vec![format!("{}: does not stop with {expected}", scene.name)]),
        _ => (scene.steps.len(), Vec::new()),
    }
}

#[test]
fn every_step_is_that_of_the_independent_implementation() {
    let scenes = scenes();
    assert_eq!(scenes.len(), 42);
    let next = AtomicUsize::new(0);
    let work = || {
        let mut answers = Vec::new();
        while let Some(scene) = scenes.get(next.fetch_add(1, Ordering::Relaxed)) {
            answers.push(examine(scene));
        }
        answers
    };
    let answers: Vec<_> = std::thread::scope(|scope| {
        let threads = [(); 2].map(|()| scope.spawn(work));
        threads.into_iter().flat_map(|thread| thread.join().expect("a thread ends")).collect()
    });
    let found: Vec<&String> = answers.iter().flat_map(|(_, found)| found).collect();
    assert!(found.is_empty(), "{found:#?}");
    let agreeing: usize = answers.iter().map(|(steps, _)| steps).sum();
    assert_eq!(agreeing, 297);
}

/// Of each attempt that did not converge, its solves.
fn given_up(answer: &StepAnswer) -> Vec<u32> {
    assert!(answer.retries.iter().all(|tried| tried.end == IterationEnd::Changing));
    answer.retries.iter().map(|tried| tried.solves).collect()
}

#[test]
fn contacts_that_only_lock_or_slide_have_twelve_solves() {
    // fast_disp_cut with Δt four times and tan φ half as large: of seven changes the sixth is one between locked and sliding.
    let scenes = scenes();
    let scene = scenes.iter().find(|scene| scene.name == "fast_disp_cut").expect("the scene is there");
    let shapes = scene.shapes();
    let mut simulation = scene.simulation().clone();
    simulation.control.time_step = Number::parse("1/32").expect("a number");
    simulation.joints.other.friction = Number::parse("3/10").expect("a number");
    let model = StepModel { simulation: &simulation, ..scene.model(&shapes) };
    let answer = exact_step(&model, &State::initial(&model), KEEP).expect("a step");
    counted(&answer);
    assert_eq!(given_up(&answer), [9]);
    // The dominoes of cases/handmade, with tan φ of 12/5: friction locks and slides, and the twelfth change ends the attempt.
    let mut scene = Scene::load(project_file("cases/handmade/dominoes.toml")).expect("the scene reads");
    scene.simulation.control.time_step = Number::parse("1/200").expect("a number");
    scene.simulation.joints.other.friction = Number::parse("12/5").expect("a number");
    let tolerances = scene.tolerances.clone().unwrap_or_default().resolve(&scene.shapes(), Precision::F64);
    let tolerances = tolerances.expect("the tolerances resolve");
    scene.derive_stiffness(&tolerances);
    let (shapes, bodies) = (scene.shapes(), scene.blocks.iter().map(|block| block.body.clone()).collect::<Vec<_>>());
    let model = StepModel { shapes: &shapes, bodies: &bodies, simulation: &scene.simulation, tolerances: &tolerances };
    let answer = exact_step(&model, &State::initial(&model), KEEP).expect("a step");
    counted(&answer);
    assert_eq!(given_up(&answer), [17]);
}

#[test]
fn an_attempt_that_fails_at_the_smallest_time_step_is_taken_whatever_its_displacements_or_stops_the_run() {
    let scenes = scenes();
    let scene = scenes.iter().find(|scene| scene.name == "hit_unconverged_accepted").expect("the scene is there");
    let shapes = scene.shapes();
    let model = scene.model(&shapes);
    let start = State::initial(&model);
    let answer = exact_step(&model, &start, KEEP).expect("accepted");
    assert_eq!((answer.end, answer.converged, answer.retries.len()), (IterationEnd::Changing, false, 5));
    assert!(
        answer
            .retries
            .iter()
            .all(|tried| tried.reason == RetryReason::NotConverged && tried.end == IterationEnd::Changing)
    );
    // SPEC asks the limits after convergence only.
    let mut still = model.tolerances.clone();
    still.max_displacement = Number::ZERO;
    let taken = exact_step(&StepModel { tolerances: &still, ..model }, &start, KEEP).expect("accepted");
    assert_eq!((taken.time_step, taken.state), (answer.time_step, answer.state));
    let mut strict = scene.simulation().clone();
    strict.control.unconverged = Unconverged::Stop;
    let stopped = certified_step(&StepModel { simulation: &strict, ..model }, &start);
    assert_eq!(stopped.unwrap_err(), StepFailure::NotConverged);
}
