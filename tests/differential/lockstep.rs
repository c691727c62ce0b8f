//! The stepper's code in 512 bits beside the oracle, on the scenes of cases/handmade: contacts, modes after each solve, number of
//! solves and retries of every step must be the same, from the same state; exact ties aside, which are counted.

use rockproof_differential::finding::Cause;
use rockproof_differential::lockstep::answer::{StepDecisions, compare};
use rockproof_differential::lockstep::run::KEPT_PRECISION;
use rockproof_differential::lockstep::scene::ExactScene;
use rockproof_differential::lockstep::state::exact_state;
use rockproof_differential::lockstep::state_errors::{anchor_error, largest_distance, rate_error};
use rockproof_differential::lockstep::wide::{WideDecisions, WideStep, WideStepper};
use rockproof_differential::lockstep::{ComparedLinks, ComparedStep, Drift, Lockstep, StepCase};
use rockproof_model::{Number, Precision, Scene};
use rockproof_oracle::step as exact;
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::dynamics::{Dynamics, State};
use std::path::PathBuf;

/// Unknowns of the largest scene in the quick test: 512 bits take seconds a step beyond.
const MAX_UNKNOWNS: usize = 150;

/// The scenes, by name.
fn scenes() -> Vec<(String, ExactScene)> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("cases/handmade");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let load = |path: &PathBuf| {
        let mut scene = Scene::load(path).unwrap();
        let set = scene.tolerances.clone().unwrap_or_default().derive(&scene.shapes(), Precision::F64).unwrap();
        scene.derive_stiffness(&set);
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        (name, ExactScene::new(&scene, &set).rounded(Precision::F64).unwrap())
    };
    files.iter().map(load).collect()
}

/// Steps with unsettled comparisons, and those of them that differ.
#[derive(Debug, Default)]
struct Ties {
    steps: usize,
    /// Those whose step before had some, too.
    lasting: usize,
    differing: Vec<String>,
}

/// What f64 and fewer bits settle is as in 512 bits, and nothing else is.
fn sooner_is_the_same(step: &str, sooner: &WideDecisions, stepped: &WideStep) {
    assert_eq!(sooner.is_unsettled(), stepped.unsettled > 0, "{step}: unsettled comparisons");
    let WideDecisions::Settled(sooner) = sooner else { return };
    match (sooner, &stepped.outcome) {
        (Ok(sooner), Ok((stepped, _))) => assert_eq!(sooner, stepped, "{step}"),
        (sooner, stepped) => assert!(sooner.is_err() && stepped.is_err(), "{step}"),
    }
}

/// Runs a scene in 512 bits, each state rounded to f64, beside the oracle.
fn agree(name: &str, scene: &ExactScene, steps: usize) -> Ties {
    let mut state: State<f64> = Dynamics::<f64>::new(scene.scene(), scene.tolerances()).unwrap().state().clone();
    let mut wide = WideStepper::<SpecRules>::new(scene).unwrap();
    let shapes = scene.scene().shapes();
    let (mut ties, mut before) = (Ties::default(), false);
    for _ in 0..steps {
        let number = state.step as i64 + 1 - i64::from(state.settling);
        let exact = scene.step(&exact_state(&state).unwrap(), KEPT_PRECISION);
        let stepped = wide.step(&state).unwrap();
        sooner_is_the_same(&format!("{name}, step {number}"), &wide.decide(&state).unwrap(), &stepped);
        let tied = stepped.unsettled > 0;
        ties.steps += usize::from(tied);
        ties.lasting += usize::from(tied && before);
        before = tied;
        let (exact, (answer, after)) = match (exact, stepped.outcome) {
            (Ok(exact), Ok(stepped)) => (exact, stepped),
            (exact, stepped) => panic!("{name}, step {number}: {:?}, {:?}", exact.err(), stepped.err()),
        };
        let found = compare(&StepDecisions::of_oracle(&exact), &answer, &shapes);
        let own = scene.kept(exact_state(&after).unwrap());
        if found.is_empty() {
            same_state(&format!("{name}, step {number}"), &exact_state(&state).unwrap(), &own, &exact.state);
        } else {
            let text = format!("{name}, step {number}, {} unsettled: {found:?}", stepped.unsettled);
            assert!(stepped.unsettled > 0, "{text}");
            ties.differing.push(text);
        }
        state = after.in_scalar();
    }
    ties
}

/// The states after a step are the same but for the last bits of velocities and anchors. A velocity is known as well as the grid of places
/// lets it be, 2/Δt of half a unit (4e-25 m): 1e-20 m/s for the shortest steps here, so it is held against 1 m/s where blocks are slower.
fn same_state(step: &str, before: &exact::State, own: &exact::State, right: &exact::State) {
    for (a, b) in own.blocks.iter().zip(&right.blocks) {
        let apart = largest_distance(a.vertices.iter().zip(&b.vertices));
        assert!(apart == 0.0, "{step}: a vertex is off by {apart:e} m");
    }
    let velocity = rate_error(before, own, right, 1.0);
    assert!(velocity < 1e-20, "{step}: a velocity is off by {velocity:e}");
    let anchor = anchor_error(own, right).unwrap_or(0.0);
    assert!(anchor < 1e-23, "{step}: an anchor is off by {anchor:e} m");
    let modes = |state: &exact::State| state.contacts.iter().map(|contact| contact.mode).collect::<Vec<_>>();
    assert_eq!(modes(own), modes(right), "{step}: what is remembered of modes");
}

#[test]
fn stepper_and_oracle_make_the_same_first_steps() {
    let [mut unsettled, mut lasting] = [0; 2];
    for (name, scene) in scenes() {
        let unknowns: usize = scene.scene().blocks.iter().map(|block| block.body.motion.unknowns()).sum();
        if unknowns <= MAX_UNKNOWNS {
            let ties = agree(&name, &scene, 4);
            println!("{name}: {ties:#?}");
            unsettled += ties.steps;
            lasting += ties.lasting;
        }
    }
    assert!(
        unsettled > lasting && lasting > 0,
        "{unsettled} steps with unsettled comparisons, {lasting} after one with such"
    );
}

/// Scenes of cases/handmade, damped: blocks that strike one another, one that slides, one that strains, one on springs.
#[test]
fn stepper_and_oracle_make_the_same_damped_steps() {
    // At 1 ms the corners touch in the steps 21 to 25.
    for (name, time_step, steps) in [
        ("corner_impact_deformable", "1/1000", 27),
        ("incline_1_4_unsettled", "1/100", 8),
        ("stress_release", "1/100", 4),
        ("spring", "1/100", 8),
    ] {
        let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("cases/handmade/{name}.toml"));
        let mut scene = Scene::load(&path).unwrap();
        let control = &mut scene.simulation.control;
        (control.damping, control.time_step) = (Number::parse("1/3").unwrap(), Number::parse(time_step).unwrap());
        let set = scene.tolerances.clone().unwrap_or_default().derive(&scene.shapes(), Precision::F64).unwrap();
        scene.derive_stiffness(&set);
        let ties = agree(name, &ExactScene::new(&scene, &set).rounded(Precision::F64).unwrap(), steps);
        assert!(ties.differing.is_empty(), "{name}: {ties:#?}");
    }
}

#[test]
#[ignore = "minutes; cargo test --release --test differential lockstep:: -- --ignored --nocapture"]
fn stepper_and_oracle_make_the_same_200_steps() {
    for (name, scene) in scenes() {
        let ties = agree(&name, &scene, 200);
        println!("{name}: {} steps with unsettled comparisons, {} differ", ties.steps, ties.differing.len());
        ties.differing.iter().for_each(|text| println!("  {text}"));
    }
}

/// A step case of a campaign of 10 million pairs, made again; and what of its state is no rounding.
fn made_again(name: &str) -> (ComparedStep, Option<Drift>) {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/step_cases").join(name);
    let case = StepCase::load(&path).unwrap();
    let (scene, set) = case.scene().unwrap();
    let mut lockstep =
        Lockstep::<f64, SpecRules>::new(&scene, &set, Precision::F64, ComparedLinks::All).unwrap().watching();
    lockstep.restore(case.state.state().unwrap()).unwrap();
    let before = lockstep.state().clone();
    let compared = lockstep.step().1;
    let drift = lockstep.drift(&before, &compared);
    (compared, drift)
}

/// A block so far off that f64 keeps its place to a millionth of what it may move in a step: the state in 512 bits must not be rounded to f64 before
/// it is compared.
#[test]
fn a_fall_far_off_is_no_defect() {
    let (compared, drift) = made_again("fall_far_off.json");
    assert!(compared.displacement.is_some_and(|(error, _)| error > 1e-6), "{:?}", compared.displacement);
    assert_eq!((compared.differences.len(), drift), (0, None));
}

/// A tongue that touches both walls of its groove: exactly it moves along them, and rounded to any number of bits its place overlaps one of them
/// by rounding. The diagonals by which the ends of the groove are cut into triangles pass through the tongue, and are no part of the groove.
#[test]
fn an_overlap_of_a_rounded_touch_is_rounding() {
    let (compared, _) = made_again("touching_notch.json");
    assert_eq!((compared.differences.len(), compared.watched.unwrap().attributed), (0, vec![]));
}

/// A step of 4 s that turns a block inside out ends the run on both sides.
#[test]
fn an_inverted_block_ends_the_run_on_both_sides() {
    let (compared, _) = made_again("inverted_block.json");
    assert!(compared.oracle.is_none() && compared.stepper.is_none());
    assert_eq!(compared.failure.matches("block 0 is inverted").count(), 2, "{}", compared.failure);
    assert!(compared.differences.iter().all(|one| one.cause == Cause::Tolerance), "{:?}", compared.differences);
}
