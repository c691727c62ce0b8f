//! Pins the audit of every step by `simulate`: that overlaps are looked at without being asked for and `--audit` adds passages, what it fills in
//! and says, that it objects to blocks that pass through one another and to nothing else, and that its bytes depend neither on threads nor on
//! interruptions. And what `check` and `report` say of the same.

use crate::place::Place;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Blocks that fall on a floor, askew and one on the other.
const FALL: &str = r#"
[simulation]
gravity = [1, 0, -10]
time_step = 0.005
steps = 40
settle = 2

[[block]]
name = "floor"
fixed = true
box = { min = [-9, -9, -1], max = [9, 9, 0] }

[[block]]
name = "low"
box = { min = [0, 0, 0.01], max = [1, 1, 1] }
spin = [0.3, 0.1, 0]

[[block]]
name = "high"
box = { min = [0.3, 0.2, 1.01], max = [1.3, 1.2, 2] }
velocity = [0.5, 0, -1]
"#;

/// A cube of 10 cm at 50 m/s, and a fixed plate of 5 cm that it is before and behind at the ends of the second step.
const SHOT: &str = r#"
[simulation]
gravity = [0, 0, 0]
time_step = 0.01
steps = 3

[[block]]
name = "plate"
fixed = true
box = { min = [0.75, -1, -1], max = [0.8, 1, 1] }

[[block]]
name = "shot"
motion = "rigid"
box = { min = [0, 0, 0], max = [0.1, 0.1, 0.1] }
velocity = [50, 0, 0]
"#;

fn step_rows(place: &Place, dir: &str) -> Vec<BTreeMap<String, String>> {
    place.rows(&format!("{dir}/steps.csv"))
}

fn totals_of(place: &Place, dir: &str) -> serde_json::Value {
    let run: serde_json::Value = serde_json::from_str(&place.read(&format!("{dir}/run.json"))).expect("JSON");
    run["totals"].clone()
}

/// Those of passages last.
const COLUMNS: [&str; 5] = ["unseen_pairs", "true_penetration_m", "explained_pairs", "passages", "undecided_passages"];

#[test]
fn a_sound_run_is_audited_to_the_same_bytes_whoever_does_it() {
    let place = Place::new();
    place.file("fall.toml", FALL);
    let args = ["simulate", "fall.toml", "--every", "7", "--audit", "--out"];
    let (code, out, err) = place.on_threads(1, &[&args[..], &["whole"]].concat());
    assert_eq!(code, 0, "{out}{err}");
    assert!(out.contains("\naudit            no unseen overlap and no passage in 42 steps"), "{out}");
    let steps = step_rows(&place, "whole");
    let depth = |row: &BTreeMap<String, String>| row["true_penetration_m"].parse::<f64>().expect("a depth");
    assert!(steps.len() == 42 && steps.iter().all(|row| row["unseen_pairs"] == "0" && row["passages"] == "0"));
    assert!(steps.iter().any(|row| depth(row) > 0.0), "something was hit");
    // In two sessions, on more threads.
    let halves = [&args[..], &["parts", "--resume", "--steps"]].concat();
    for until in ["17", "40"] {
        assert_eq!(place.on_threads(4, &[&halves[..], &[until]].concat()).0, 0);
    }
    let read = |dir: &str| fs::read(place.path(dir).join("steps.csv")).expect("steps.csv");
    assert!(read("whole") == read("parts"));
    assert_eq!(totals_of(&place, "whole")["audit"], totals_of(&place, "parts")["audit"]);
    // Without passages two columns are empty, with --no-audit all five; all others are the same, and no run is taken for another.
    for (dir, more, empty) in [("usual", &[][..], &COLUMNS[3..]), ("bare", &["--no-audit"], &COLUMNS[..])] {
        let (code, out, err) = place.run(&[&["simulate", "fall.toml", "--every", "7", "--out", dir], more].concat());
        assert_eq!(code, 0, "{out}{err}");
        for (mut audited, other) in steps.iter().cloned().zip(step_rows(&place, dir)) {
            audited.extend(empty.iter().map(|column| ((*column).to_owned(), String::new())));
            assert_eq!(audited, other);
        }
        let (code, _, err) = place.run(&[&args[..], &[dir, "--resume"]].concat());
        assert!(code == 2 && err.contains("audit: the run has"), "{err}");
    }
    let (mut whole, usual) = (totals_of(&place, "whole")["audit"].clone(), totals_of(&place, "usual")["audit"].clone());
    assert_eq!((&whole["passages"], &whole["undecided"]), (&0.into(), &0.into()));
    (whole["passages"], whole["undecided"]) = (serde_json::Value::Null, serde_json::Value::Null);
    assert_eq!(whole, usual);
    assert!(totals_of(&place, "bare").get("audit").is_none());
    for refused in [&["--engine", "exact", "--audit"][..], &["--no-audit", "--audit"]] {
        let (code, _, err) = place.run(&[&["simulate", "fall.toml"], refused].concat());
        assert!(code == 2 && err.contains("--audit"), "{err}");
    }
}

#[test]
fn the_end_tells_the_true_penetration_and_without_an_audit_that_it_does_not() {
    let place = Place::new();
    place.file("fall.toml", FALL);
    let (code, out, err) = place.run(&["simulate", "fall.toml", "--out", "usual"]);
    assert_eq!(code, 0, "{out}{err}");
    let deepest = totals_of(&place, "usual")["audit"]["deepest"].clone();
    let blocks = [0, 1].map(|k| deepest["blocks"][k].to_string());
    assert!(out.contains("\npenetration      ") && !out.contains("in contacts"), "{out}");
    let told = format!(" m at most, of blocks {} and {} in step {}\n", blocks[0], blocks[1], deepest["step"]);
    assert!(out.contains(&told), "{told}{out}");
    let told = "\naudit            no unseen overlap in 42 steps; passages not looked for (--audit does)\n";
    assert!(out.contains(told), "{out}");
    let (_, out, _) = place.run(&["simulate", "fall.toml", "--out", "bare", "--no-audit"]);
    assert!(
        out.contains("\nin contacts      overlap of ") && out.contains(", to first order; others are not known\n"),
        "{out}"
    );
    assert!(!out.contains("penetration  ") && !out.contains("audit  "), "{out}");
}

/// A cube that is sunk 30 cm into a fixed floor: deeper than contacts begin.
const SUNK: &str = r#"
[simulation]
gravity = [0, 0, -10]
time_step = 0.01
steps = 4

[[block]]
fixed = true
box = { min = [-1, -1, -1], max = [2, 2, 0] }

[[block]]
box = { min = [0, 0, -0.3], max = [1, 1, 0.7] }
"#;

#[test]
fn a_cube_that_falls_through_the_floor_is_told_first_without_being_asked_for() {
    let place = Place::new();
    place.file("sunk.toml", SUNK);
    let (code, out, err) = place.run(&["simulate", "sunk.toml", "--force", "--out", "usual"]);
    assert_eq!(code, 1, "{out}{err}");
    let told = "audit            blocks overlap where no contact holds them: 1 pair overlaps unseen by contacts after 4 of 4 steps (worst 0–1, 0.3";
    assert!(out.starts_with(told), "{out}");
    assert!(
        out.contains("\npenetration      0.3") && out.contains(" m at most, of blocks 0 and 1 in step 4\n"),
        "{out}"
    );
    for row in step_rows(&place, "usual") {
        let depth: f64 = row["true_penetration_m"].parse().expect("a depth");
        assert!(row["unseen_pairs"] == "1" && depth > 0.3 && row["passages"].is_empty(), "{row:?}");
        assert_eq!(row["max_penetration_m"], "0.0", "contacts know nothing of it");
    }
    let (code, out, err) = place.run(&["simulate", "sunk.toml", "--force", "--format", "json", "--out", "json"]);
    let found: serde_json::Value = serde_json::from_str(&out).expect("JSON");
    assert!(code == 1 && found["audit"]["objects"] == true && found["audit"]["passages"].is_null(), "{out}{err}");
    assert_eq!(found["audit"]["steps_unseen"], 4);
    let (code, out, err) = place.run(&["simulate", "sunk.toml", "--force", "--no-audit", "--out", "bare"]);
    assert_eq!(code, 0, "{out}{err}");
    assert!(out.contains("; without --no-audit they are followed\n"), "{out}");
}

/// A cube that flies through a plate, whose springs are far too soft to stop it.
const THROUGH: &str = r#"
[simulation]
gravity = [0, 0, 0]
time_step = 0.0001
steps = 110

[[joint]]
normal_stiffness = 1e5

[[block]]
fixed = true
box = { min = [-1, -1, -0.5], max = [1, 1, 0] }

[[block]]
motion = "rigid"
velocity = [0, 0, -100]
box = { min = [-0.25, -0.25, 0], max = [0.25, 0.25, 0.5] }
"#;

#[test]
fn a_cube_that_contacts_closed_before_do_not_stop_is_told_from_the_middle_on() {
    let place = Place::new();
    place.file("through.toml", THROUGH);
    for (dir, more) in [("usual", &[][..]), ("full", &["--audit"]), ("single", &["--engine", "stepper-f32"])] {
        let (code, out, err) = place.run(&[&["simulate", "through.toml", "--out", dir], more].concat());
        assert_eq!(code, 1, "{out}{err}");
        let told = "audit            blocks pass through one another: past the middle of one another after 51 of 110 steps (first 0–1, step 51, where a contact closed before measures 0.5072 m and pushes against the shorter way out)";
        assert!(out.starts_with(told), "{out}");
        // From where half a plate and half a cube are behind it until the other side has contacts.
        for row in step_rows(&place, dir) {
            let step: u64 = row["step"].parse().expect("a step");
            assert_eq!(row["unseen_pairs"], if (51..=101).contains(&step) { "1" } else { "0" }, "{step}");
        }
        assert_eq!(totals_of(&place, dir)["audit"]["first_past_middle"]["step"], 51);
    }
    // Ten times as stiff a spring stops it before the middle, and it comes back.
    place.file("back.toml", &THROUGH.replace("1e5", "1e7"));
    let (code, out, err) = place.run(&["simulate", "back.toml", "--out", "back"]);
    let told = "contacts that were closed before, and no block is past the middle of another; passages";
    assert!(code == 0 && out.contains(told), "{out}{err}");
}

#[test]
fn a_block_that_passes_through_another_within_a_step_is_told() {
    let place = Place::new();
    place.file("shot.toml", SHOT);
    // Tolerances that break the rules: the step is far too long.
    let args =
        ["simulate", "shot.toml", "--force", "--set", "max_displacement=1", "--set", "penetration=1/100", "--out"];
    assert_eq!(place.run(&[&args[..], &["bare", "--no-audit"]].concat()).0, 0, "nobody looks");
    let (code, out, err) = place.run(&[&args[..], &["usual"]].concat());
    assert!(code == 0 && out.contains("passages not looked for"), "{out}{err}");
    let (code, out, err) = place.run(&[&args[..], &["shot", "--audit"]].concat());
    assert_eq!(code, 1, "{out}{err}");
    let told = "audit            blocks pass through one another: 1 passage within a step (worst 0–1, ";
    assert!(
        out.starts_with(told)
            && out.contains("\npenetration      none: no two blocks overlap by more than rounding after any step\n"),
        "{out}"
    );
    let passages: Vec<String> = step_rows(&place, "shot").into_iter().map(|row| row["passages"].clone()).collect();
    assert_eq!(passages, ["0", "1", "0"]);
    assert_eq!(totals_of(&place, "shot")["audit"]["worst_passage"]["step"], 2);
    // A report on it begins with that; on the other it says that nobody looked.
    let (code, out, err) = place.run(&["report", "shot", "--format", "markdown"]);
    assert!(code == 0 && out.contains("❌ shot: blocks pass through one another: 1 passage"), "{out}{err}");
    let (code, out, err) = place.run(&["report", "bare", "--format", "markdown"]);
    assert!(code == 0 && out.contains("bare: not audited"), "{out}{err}");
    let (code, out, err) = place.run(&["report", "shot", "bare", "--out", "page"]);
    assert_eq!(code, 0, "{out}{err}");
    let page = fs::read_to_string(place.path("page/report.html")).expect("a page");
    assert!(page.contains("Do blocks pass through one another?") && page.contains("bare: not audited"));
    let table = fs::read_to_string(place.path("page/tables/audit.csv")).expect("a table");
    assert!(table.lines().nth(1).is_some_and(|row| row.starts_with("shot,f64,finished,3,0,0,,,1,0,0-1,")), "{table}");
}

/// What a run of [`SHOT`] begins with.
const SHOOT: [&str; 8] =
    ["simulate", "shot.toml", "--force", "--audit", "--set", "max_displacement=1", "--set", "penetration=1/100"];

#[test]
fn a_passage_has_its_cause_and_a_case_that_replays() {
    let place = Place::new();
    // A third block that has nothing to do with it is left out of the case.
    let far = "\n[[block]]\nname = \"far\"\nfixed = true\nbox = { min = [9, 9, 9], max = [10, 10, 10] }\n";
    let [plate, shot] = SHOT.split_once("[[block]]\nname = \"shot\"").map(|(one, two)| [one, two]).expect("two blocks");
    place.file("shot.toml", &format!("{plate}{far}\n[[block]]\nname = \"shot\"{shot}"));
    let (code, out, err) = place.run(&[&SHOOT[..], &["--out", "whole"]].concat());
    assert_eq!(code, 1, "{out}{err}");
    let case = "cases/passage_0-2_step_000002.json";
    assert!(out.contains(&format!("\ncause            passage 0–2, step 2: step-length; {case}\n")), "{out}");
    let rows = place.rows("whole/intrusions.csv");
    let cell = |column: &str| rows[0][column].clone();
    let cells = ["step", "change", "block_a", "block_b", "cause", "before", "after", "case_blocks", "case"].map(cell);
    assert_eq!(cells, ["2", "passage", "0", "2", "step-length", "none", "passage", "2", case]);
    assert!(rows.len() == 1 && place.read("whole/rockproof.manifest.json").contains(case));
    let (code, out, err) = place.run(&["replay", &format!("whole/{case}")]);
    assert_eq!(code, 0, "{out}{err}");
    assert!(out.contains("step 2 in f64") && out.contains("step-length: passage 0-1: none → passage"), "{out}");
    // Made smaller it is the first step of two blocks that begin where these were.
    let (code, out, err) =
        place.run(&["shrink", &format!("whole/{case}"), "--out", "small.json", "--evaluations", "600"]);
    assert!(
        code == 0 && out.starts_with("before: step 2 of 2 blocks, 16 vertices, 12 faces\nafter:  step 1 of 2"),
        "{out}{err}"
    );
    let (code, out, err) = place.run(&["replay", "small.json"]);
    assert!(code == 0 && out.contains("step-length: passage 0-1: none → passage"), "{out}{err}");
    // A run that was interrupted between has the same, and JSON and a report tell it.
    for (steps, code) in [("1", 0), ("3", 1)] {
        let more = ["--out", "parts", "--resume", "--every", "1", "--format", "json", "--steps", steps];
        let ran = place.run(&[&SHOOT[..], &more].concat());
        assert_eq!(ran.0, code, "{}{}", ran.1, ran.2);
        let document: serde_json::Value = serde_json::from_str(&ran.1).expect("JSON");
        let causes = document["intrusions"].as_array().expect("a list");
        assert_eq!(causes.iter().filter(|one| one["cause"] == "step-length").count() as i32, code);
    }
    for file in ["intrusions.csv", case] {
        assert_eq!(place.read(&format!("whole/{file}")), place.read(&format!("parts/{file}")), "{file}");
    }
    let (code, out, err) = place.run(&["report", "whole", "--out", "page"]);
    assert_eq!(code, 0, "{out}{err}");
    let table = place.read("page/tables/audit_causes.csv");
    let row = table.lines().nth(1).expect("a row");
    assert!(row.starts_with("whole,2,passage,0-2,") && row.contains(",step-length,none,passage,2,"), "{table}");
    // A run that is sound has neither.
    place.file("fall.toml", FALL);
    assert_eq!(place.run(&["simulate", "fall.toml", "--audit", "--steps", "2", "--out", "sound"]).0, 0);
    assert!(!place.path("sound/intrusions.csv").exists() && !place.path("sound/cases").exists());
}

/// A heavy block that pushes a row of so many and one more at rest through [`SHOT`]'s plate, by contacts that the step itself finds; and 70 blocks
/// far away.
fn pushed(row: usize) -> String {
    let block = |about: &str, min: [f64; 3], max: [f64; 3]| {
        format!("[[block]]\n{about}box = {{ min = {min:?}, max = {max:?} }}\n")
    };
    let (fixed, rigid) = ("fixed = true\n", "motion = \"rigid\"\n");
    let mut text = "[simulation]\ngravity = [0, 0, 0]\ntime_step = 0.01\nsteps = 1\n".to_owned();
    text += &block(fixed, [0.75, -1.0, -1.0], [0.8, 1.0, 1.0]);
    (0..70).for_each(|k| text += &block(fixed, [9.0, 9.0, f64::from(2 * k)], [10.0, 10.0, f64::from(2 * k + 1)]));
    // Eighths, so that they touch exactly.
    let begin = |place: usize| 0.5 - place as f64 / 8.0;
    (0..=row).for_each(|k| text += &block(rigid, [begin(k), 0.0, 0.0], [begin(k) + 0.125, 0.125, 0.125]));
    let heavy =
        block(&format!("{rigid}velocity = [50, 0, 0]\n"), [begin(row) - 2.0, -1.0, -1.0], [begin(row), 1.125, 1.125]);
    text + &heavy
}

#[test]
fn the_cause_of_a_passage_is_found_among_many_blocks() {
    let place = Place::new();
    for (row, told) in [
        (1, "step-length; cases/passage_0-71_step_000001.json"),
        (66, "unknown: 69 blocks show it, no fewer were found, and no more than 64 are stepped exactly"),
    ] {
        place.file("shot.toml", &pushed(row));
        let out_dir = format!("run_{row}");
        let (code, out, err) = place.run(&[&SHOOT[..], &["--out", &out_dir]].concat());
        assert_eq!(code, 1, "{out}{err}");
        assert!(out.contains(&format!("\ncause            passage 0–71, step 1: {told}\n")), "{out}");
        let rows = place.rows(&format!("{out_dir}/intrusions.csv"));
        let of_pair = rows.iter().find(|cells| cells["block_b"] == "71").expect("a row");
        assert_eq!(of_pair["case_blocks"], if row == 1 { "4" } else { "69" });
    }
    let (code, out, err) = place.run(&["replay", "run_1/cases/passage_0-71_step_000001.json"]);
    assert!(code == 0 && out.contains("step-length: passage 0-1: none → passage"), "{out}{err}");
}

/// The wedges of `cases/regressions/step-step-length-unseen.json`, which touch at a corner and overlap unseen after the first step.
#[test]
fn an_overlap_that_no_contact_sees_any_more_has_its_cause() {
    let place = Place::new();
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/regressions/step-step-length-unseen.json");
    let case: serde_json::Value = serde_json::from_str(&fs::read_to_string(file).expect("a case")).expect("JSON");
    place.file("wedges.toml", case["scene"].as_str().expect("a scene"));
    let args = ["simulate", "wedges.toml", "--force", "--audit", "--steps", "1", "--out", "run"];
    let (code, out, err) = place.run(&args);
    assert_eq!(code, 1, "{out}{err}");
    let case = "cases/unseen_0-1_step_000001.json";
    assert!(out.contains(&format!("\ncause            unseen 0–1, step 1: step-length; {case}\n")), "{out}");
    let (code, out, err) = place.run(&["replay", &format!("run/{case}")]);
    assert!(code == 0 && out.contains("step-length: unseen 0-1: none → unseen"), "{out}{err}");
}

#[test]
fn overlaps_that_no_contact_sees_are_told_with_the_worst_pair_and_step() {
    let place = Place::new();
    let model = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/real/slope_joints.dda");
    let args = ["simulate", model.to_str().expect("text"), "--force", "--steps", "2", "--out"];
    let (code, out, err) = place.run(&[&args[..], &["audited"]].concat());
    assert_eq!(code, 1, "{out}{err}");
    let told = "blocks overlap where no contact holds them: up to 19 pairs overlap unseen by contacts after 2 of 2 steps (worst 2–3, 1.1694 m";
    assert!(out.contains(told), "{out}");
    assert!(step_rows(&place, "audited").iter().all(|row| row["unseen_pairs"] == "19"));
    // Without it the end says what the beginning said, and how to look.
    let (code, out, err) = place.run(&[&args[..], &["bare", "--no-audit"]].concat());
    assert_eq!(code, 0, "{out}{err}");
    assert!(
        out.contains("\nmodel            19 pairs (worst 2–3, 1.1694 m) overlap deeper") && out.contains("--no-audit"),
        "{out}"
    );
}

#[test]
fn check_warns_of_a_fall_and_does_not_object_to_it() {
    let place = Place::new();
    let soft =
        FALL.replace("[[block]]\nname = \"floor\"", "[[joint]]\nnormal_stiffness = 1e7\n\n[[block]]\nname = \"floor\"");
    place.file("soft.toml", &soft);
    place.file("stiff.toml", &soft.replace("1e7", "1e12"));
    let (code, out, err) = place.run(&["check", "soft.toml"]);
    assert!(code == 0 && out.contains("rules: all met"), "{out}{err}");
    assert!(
        out.contains("warning: a fall may end deeper than penetration") && out.contains("1.000000e7, needed is "),
        "{out}"
    );
    let (code, out, err) = place.run(&["check", "stiff.toml"]);
    assert!(code == 0 && !out.contains("warning"), "{out}{err}");
}
