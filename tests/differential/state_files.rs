//! State files: what is none is refused with what is allowed.

use rockproof_differential::lockstep::StepCase;
use serde_json::{Value, json};

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
