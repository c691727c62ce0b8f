//! State files: what is none is refused with what is allowed; and one is made smaller as long as its step shows the same.

use rockproof_campaign::steps::shrink::shrink;
use rockproof_differential::lockstep::{ReplayedStep, StepCase};
use rockproof_model::Scene;
use rockproof_model::scene::SceneFormat;
use serde_json::{Value, json};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

/// The second step of a box on an incline, whose four vertices are in contact with it.
const SLIDER: &str = include_str!("../../fuzz/corpus/state/step_000002.json");

/// Why the state file is none after a change, if it is none.
fn refused(change: impl FnOnce(&mut Value)) -> Option<String> {
    let mut file: Value = serde_json::from_str(SLIDER).expect("JSON");
    change(&mut file);
    StepCase::parse(&file.to_string()).err().map(|error| error.to_string())
}

#[test]
fn contacts_are_those_that_the_scene_can_have() {
    let contact = |place: usize, key: &'static str, to: [u32; 2]| {
        refused(move |file| file["state"]["contacts"][place][key] = json!(to)).expect("refused")
    };
    assert_eq!(refused(|_| ()), None);
    let allowed =
        "allowed are vertices 0 to 7, edges 0 to 11, faces 0 to 5 and vertices 0 to 7, edges 0 to 11, faces 0 to 5";
    for (place, key, to, message) in [
        (0, "entrance_features", [99, 99], "contact 0 of blocks 0 and 1 is f-v 1/0 by f-v 99/99; "),
        (1, "entrance_features", [u32::MAX, 0], "contact 1 of blocks 0 and 1 is f-v 1/1 by f-v 4294967295/0; "),
        (2, "entrance_features", [6, 2], "contact 2 of blocks 0 and 1 is f-v 1/2 by f-v 6/2; "),
        (3, "features", [1, 8], "contact 3 of blocks 0 and 1 is f-v 1/8 by f-v 1/3; "),
    ] {
        assert_eq!(contact(place, key, to), format!("its state: {message}{allowed}"));
    }
    for (place, key, to, message) in [
        (0, "blocks", [0, 2], "contact 0 is of blocks 0 and 2; allowed are 0 to 1"),
        (0, "blocks", [1, 0], "contact 0 is of blocks 1 and 0; allowed is the lower number first"),
        (
            3,
            "features",
            [1, 0],
            "contact 3 of blocks 0 and 1 is f-v 1/0, as contact 0 is; allowed is each contact once",
        ),
    ] {
        assert_eq!(contact(place, key, to), format!("its state: {message}"));
    }
}

#[test]
fn the_step_is_the_one_after_the_state() {
    for step in [i64::MIN, 0, 1, 3, i64::MAX] {
        let error = refused(|file| file["step"] = step.into()).expect("refused");
        let text = format!("`step = {step}` is not allowed; allowed is 2, the step after the state's");
        assert!(error.contains(&text), "{error}");
    }
    // Steps of settling come before the first, the last of them as number 0.
    let settling = |step: i64| refused(|file| (file["state"]["settling"], file["step"]) = (3.into(), step.into()));
    assert_eq!((settling(-2), settling(2).is_some()), (None, true));
}

/// The wedges that overlap unseen after the step (`cases/regressions/README.md`).
const UNSEEN: &str = include_str!("../../cases/regressions/step-step-length-unseen.json");

/// The same with more than it takes: a third block, gravity, spin, cohesion, and a later step.
fn cluttered() -> String {
    let mut file: Value = serde_json::from_str(UNSEEN).expect("JSON");
    let scene = file["scene"].as_str().expect("a scene").to_owned();
    let scene = scene.replacen("gravity = [0.0, 0.0, 0.0]", "gravity = [0.0, 0.0, -0.125]", 1);
    let scene = scene.replacen("cohesion = 0.0", "cohesion = 64.0", 1);
    let far = "\n[[block]]\nname = \"far\"\nfixed = true\nbox = { min = [9.0, 9.0, 9.0], max = [10.0, 10.0, 10.0] }\n";
    let scene = scene + far;
    let parsed = Scene::parse(&scene, SceneFormat::Toml, Path::new("scene")).expect("a scene");
    let corners = parsed.blocks[2].block.vertices().iter().map(|v| v.components().map(|c| c.approximate()));
    let corners: Vec<[f64; 3]> = corners.collect();
    file["scene"] = scene.into();
    (file["step"], file["state"]["step"]) = (8.into(), 7.into());
    let blocks = file["state"]["blocks"].as_array_mut().expect("blocks");
    blocks.push(json!({ "vertices": corners, "velocity": vec![0.0; 12], "stress": vec![0.0; 6] }));
    file.to_string()
}

#[test]
fn a_state_file_is_made_smaller_while_its_step_shows_the_same() {
    let mut big = StepCase::parse(&cluttered()).expect("a state file");
    // What the step shows now is what the file is to record.
    let step = ReplayedStep::of(&big).expect("it is made");
    let words: Vec<String> = step.differences().iter().map(|one| one.words().to_owned()).collect();
    assert_eq!(words, ["step-length unseen blocks 0-1: none → unseen"]);
    let made = AtomicU64::new(0);
    let small = shrink(&big, 40, &made).expect("it is shown");
    assert!((4..=40).contains(&made.load(Ordering::Relaxed)), "{made:?} steps were made");
    let (scene, _) = small.scene().expect("a scene");
    assert_eq!((small.step, scene.blocks.len()), (1, 2), "the block that is not needed is gone, and the steps before");
    let simulation = &scene.simulation;
    assert!(simulation.gravity.z.is_zero() && simulation.joints.other.cohesion.is_zero(), "and so is what acts");
    let again = ReplayedStep::of(&small).expect("it is made");
    assert!(again.is_expected(&small) && again.missing(&small).is_none() && again.differences().len() == 1);
    // With one step to make nothing can be tried.
    assert_eq!(shrink(&big, 1, &made).expect("it is shown").scene().expect("a scene").0.blocks.len(), 3);
    big.differences = vec!["step-length passage blocks 0-1: none → passage".to_owned()];
    let error = shrink(&big, 40, &made).expect_err("it shows something else").to_string();
    assert!(error.contains("shows none of the differences that the file records (step-length passage"), "{error}");
}
