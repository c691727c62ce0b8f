//! The stepper's code in 512 bits beside the oracle, on the scenes of cases/handmade: contacts, modes after each solve, number of
//! solves and retries of every step must be the same, from the same state; exact ties aside, which are counted.

use rockproof::lockstep::answer::{Answer, compare};
use rockproof::lockstep::run::KEEP;
use rockproof::lockstep::scene::ExactScene;
use rockproof::lockstep::state::{converted, exact_state};
use rockproof::lockstep::wide::WideStepper;
use rockproof::model::simulation::derive_stiffness;
use rockproof::model::{Precision, Scene};
use rockproof::stepper::contact::Spec;
use rockproof::stepper::dynamics::{Dynamics, State};
use std::path::PathBuf;

/// The scenes, by name.
fn scenes() -> Vec<(String, ExactScene)> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("cases/handmade");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let load = |path: &PathBuf| {
        let mut scene = Scene::load(path).unwrap();
        let set = scene.tolerances.clone().unwrap_or_default().derive(&scene.shapes(), Precision::F64).unwrap();
        let bodies: Vec<_> = scene.blocks.iter().map(|block| (&block.block, &block.body)).collect();
        derive_stiffness(&mut scene.simulation, &bodies, &set);
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        (name, ExactScene::new(&scene, &set).rounded(Precision::F64).unwrap())
    };
    files.iter().map(load).collect()
}

/// Steps with unsettled comparisons, and those of them that differ.
#[derive(Debug, Default)]
struct Ties {
    steps: usize,
    differing: Vec<String>,
}

/// Runs a scene in 512 bits, each state rounded to f64, beside the oracle.
fn agree(name: &str, scene: &ExactScene, steps: usize) -> Ties {
    let mut state: State<f64> = Dynamics::<f64>::new(scene.scene(), scene.tolerances()).unwrap().state().clone();
    let mut wide = WideStepper::<Spec>::new(scene).unwrap();
    let shapes = scene.scene().shapes();
    let mut ties = Ties::default();
    for _ in 0..steps {
        let number = state.step as i64 + 1 - i64::from(state.settling);
        let exact = scene.step(&exact_state(&state).unwrap(), KEEP);
        let stepped = wide.step(&state).unwrap();
        ties.steps += usize::from(stepped.unsettled > 0);
        let (exact, (answer, after)) = match (exact, stepped.outcome) {
            (Ok(exact), Ok(stepped)) => (exact, stepped),
            (exact, stepped) => panic!("{name}, step {number}: {:?}, {:?}", exact.err(), stepped.err()),
        };
        let found = compare(&Answer::of_oracle(&exact), &answer, &shapes);
        if !found.is_empty() {
            let text = format!("{name}, step {number}, {} unsettled: {found:?}", stepped.unsettled);
            assert!(stepped.unsettled > 0, "{text}");
            ties.differing.push(text);
        }
        state = converted(&after);
    }
    ties
}

#[test]
fn stepper_and_oracle_make_the_same_first_steps() {
    for (name, scene) in scenes() {
        let ties = agree(&name, &scene, 4);
        println!("{name}: {ties:#?}");
    }
}

#[test]
#[ignore = "minutes; cargo test --release --test lockstep -- --ignored --nocapture"]
fn stepper_and_oracle_make_the_same_200_steps() {
    for (name, scene) in scenes() {
        let ties = agree(&name, &scene, 200);
        println!("{name}: {} steps with unsettled comparisons, {} differ", ties.steps, ties.differing.len());
        ties.differing.iter().for_each(|text| println!("  {text}"));
    }
}
