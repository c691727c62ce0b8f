//! `examine` as a library: what it answers in memory, what it tells meanwhile, and that it can be stopped.

use rockproof_examine::{
    CheckError, CheckedModel, Examination, Naming, Settings, Stage, Verdict, WorkProgress, document, examine,
    findings_table, pair_table, worst_cases,
};
use rockproof_model::scene::SceneFormat;
use rockproof_model::{Precision, Scene};
use rockproof_report::table::TableCell;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

const WITHOUT_SEARCH: Settings = Settings { steps: Some(2), candidates: 0, threads: 1 };

/// A cube on a fixed floor, with this much of it in the floor.
fn model(sunk: &str) -> CheckedModel {
    let text = format!(
        "[[block]]\nfixed = true\nbox = {{ min = [-1, -1, -1], max = [2, 2, 0] }}\n\
         [[block]]\nbox = {{ min = [0, 0, {sunk}], max = [1, 1, 1] }}\n"
    );
    let scene = Scene::parse(&text, SceneFormat::Toml, Path::new("model.toml")).expect("a scene");
    checked(scene, Precision::F64).expect("a model")
}

fn checked(scene: Scene, precision: Precision) -> Result<CheckedModel, CheckError> {
    let spec = scene.tolerances.clone().unwrap_or_default();
    let set = spec.derive(&scene.shapes(), precision).expect("a set");
    CheckedModel::new((PathBuf::from("model.toml"), None), scene, (spec, set), precision)
}

fn examined(model: CheckedModel, seen: &WorkProgress) -> Option<Examination> {
    examine(model, &WITHOUT_SEARCH, seen, &AtomicBool::new(false)).expect("an examination")
}

fn naming(dir: Option<PathBuf>) -> Naming {
    let [read, tolerances] = [const { String::new() }; 2];
    Naming { file: "model.toml".to_owned(), read, tolerances, units_are_meant: false, dir, is_usual_dir: false }
}

#[test]
fn an_answer_without_a_directory_names_no_file_of_it() {
    let found = examined(model("0"), &WorkProgress::default()).expect("an end");
    let cases = worst_cases(&found);
    let verdict = Verdict::of(&found, &cases, &naming(None));
    assert!(verdict.is_safe && verdict.next.is_none(), "{}", verdict.text());
    assert!(!verdict.text().contains("next:"), "{}", verdict.text());
    assert!(document(&found, &verdict)["next"].is_null());
    let verdict = Verdict::of(&found, &cases, &naming(Some(PathBuf::from("found"))));
    assert_eq!(verdict.next.as_deref(), Some("rockproof simulate model.toml --steps 100 --audit"));
}

#[test]
fn findings_are_the_pairs_with_something_to_say() {
    let sound = examined(model("0"), &WorkProgress::default()).expect("an end");
    assert_eq!([pair_table(&sound).rows.len(), findings_table(&sound).rows.len()], [1, 0]);
    let sunk = examined(model("-0.5"), &WorkProgress::default()).expect("an end");
    let [row] = &findings_table(&sunk).rows[..] else { panic!("one pair") };
    assert_eq!(row[..3], [TableCell::Count(0), TableCell::Count(1), TableCell::Number(0.5)]);
    let verdict = Verdict::of(&sunk, &worst_cases(&sunk), &naming(None));
    assert!(!verdict.is_safe && verdict.answer == "not safe");
}

#[test]
fn progress_is_told_and_the_work_can_be_stopped() {
    let seen = WorkProgress::default();
    assert!(seen.now().is_none());
    examined(model("0"), &seen).expect("an end");
    let now = seen.now().expect("a part");
    assert_eq!((now.stage, now.done, now.total), (Stage::Steps, 2, 2));
    // Asked from the beginning, and while the one pair is looked at for overlaps.
    let stopped =
        |stop: &AtomicBool, seen: &WorkProgress| examine(model("0"), &WITHOUT_SEARCH, seen, stop).expect("no error");
    assert!(stopped(&AtomicBool::new(true), &WorkProgress::default()).is_none());
    let (seen, stop) = (WorkProgress::default(), AtomicBool::new(false));
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while seen.now().is_none() {
                std::hint::spin_loop();
            }
            stop.store(true, Ordering::SeqCst);
        });
        let long = Settings { steps: Some(1_000_000), ..WITHOUT_SEARCH };
        assert!(examine(model("0"), &long, &seen, &stop).expect("no error").is_none());
    });
}

#[test]
fn what_a_precision_cannot_hold_is_named() {
    let text = "[tolerances]\npreset = \"auto\"\nsearch = 1\npenetration = 1\nterritory = 0\nopen = 0\nclose = 0\nmax_displacement = 1\n\
                [[block]]\nname = \"long\"\nbox = { min = [0, 0, 0], max = [1e39, 1, 1] }\n";
    let scene = Scene::parse(text, SceneFormat::Toml, Path::new("model.toml")).expect("a scene");
    assert!(checked(scene.clone(), Precision::F64).is_ok());
    let error = checked(scene, Precision::F32).expect_err("too long");
    assert_eq!(error.to_string(), "block 0 \"long\": a coordinate overflows when rounded to f32");
}
