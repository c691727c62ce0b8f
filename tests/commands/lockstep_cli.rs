//! Pins `simulate --lockstep`, `--free` and `--engine exact`: their tables are the documented ones, a run taken up again gives the
//! same bytes, state files replay, and exact runs are exact.

use crate::place::Place;
use rockproof_differential::lockstep::{free, table};
use std::fs;
use std::path::Path;

/// A slider whose numbers f32 does not hold.
pub(crate) const SLIDER: &str = r#"
[simulation]
gravity = [-6.1, 0, -8.1]
time_step = 0.01
steps = 4

[tolerances]
preset = "auto"

[[joint]]
friction = 0.3
normal_stiffness = 1e8

[[block]]
name = "incline"
fixed = true
box = { min = [-12, -2, -1], max = [4, 3, 0] }

[[block]]
name = "slider"
box = { min = [0.1, 0.1, 0], max = [1.1, 1.1, 1] }

[[measured_point]]
name = "centre"
block = "slider"
at = [0.6, 0.6, 0.5]
"#;

struct WorkDir(Place);

impl WorkDir {
    fn new() -> WorkDir {
        let place = Place::new();
        place.file("slider.toml", SLIDER);
        WorkDir(place)
    }

    /// Runs `simulate` into a directory; its exit code and what it printed.
    fn simulate(&self, out: &str, arguments: &[&str]) -> (i32, String) {
        let (code, out, err) = self.0.run(&[&["simulate", "slider.toml", "--out", out], arguments].concat());
        (code, out + &err)
    }

    fn replay(&self, file: &str) -> (i32, String) {
        let (code, out, err) = self.0.run(&["replay", file]);
        (code, out + &err)
    }

    fn rows(&self, name: &str) -> Vec<Vec<String>> {
        let mut reader = csv::ReaderBuilder::new().has_headers(false).from_path(self.0.path(name)).expect("a table");
        reader.records().map(|row| row.expect("a row").iter().map(str::to_owned).collect()).collect()
    }
}

#[test]
fn lockstep_writes_the_documented_tables_and_goes_on_to_the_same_bytes() {
    let place = WorkDir::new();
    let asked = ["--engine", "f32", "--lockstep"];
    let (code, said) = place.simulate("whole", &asked);
    assert_eq!(code, 0, "{said}");
    assert!(said.contains("lockstep") && said.contains("0 defect"), "{said}");
    let documented = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/lockstep.md")).expect("docs");
    for column in table::STEPS.iter().chain(&table::DIFFERENCES).chain(&free::COLUMNS) {
        assert!(documented.contains(&format!("`{column}`")), "docs/lockstep.md does not tell of {column}");
    }
    let steps = place.rows("whole/lockstep.csv");
    assert_eq!(steps[0], table::STEPS);
    assert_eq!(steps.len(), 1 + 4, "a row for each step");
    let differences = place.rows("whole/differences.csv");
    assert_eq!(differences[0], table::DIFFERENCES);
    // By cause, the differences are as many as the steps say.
    for (k, cause) in table::CAUSES.iter().enumerate() {
        let counted: usize = steps[1..].iter().map(|row| row[20 + k].parse::<usize>().expect("a count")).sum();
        assert_eq!(counted, differences[1..].iter().filter(|row| row[2] == cause.name()).count(), "{cause}");
    }
    assert!(steps[1..].iter().all(|row| row[19] == "0" && row[27].is_empty()), "nothing undecided, nothing failed");

    let shorter = [&asked[..], &["--steps", "2"]].concat();
    assert_eq!(place.simulate("parts", &shorter).0, 0);
    let rest = [&asked[..], &["--resume", "--steps", "4"]].concat();
    assert_eq!(place.simulate("parts", &rest).0, 0);
    for name in ["lockstep.csv", "differences.csv", "steps.csv"] {
        assert_eq!(place.0.read(&format!("parts/{name}")), place.0.read(&format!("whole/{name}")), "{name}");
    }
    // Without --lockstep it is another run.
    assert_eq!(place.simulate("parts", &["--engine", "f32", "--resume"]).0, 2);
}

#[test]
fn a_lockstep_in_which_nothing_touches_says_so() {
    let place = WorkDir::new();
    let flying = SLIDER
        .replace("min = [0.1, 0.1, 0], max = [1.1, 1.1, 1]", "min = [0.1, 0.1, 5], max = [1.1, 1.1, 6]")
        .replace("at = [0.6, 0.6, 0.5]", "at = [0.6, 0.6, 5.5]");
    place.0.file("flying.toml", &flying);
    for (scene, told) in [("flying.toml", true), ("slider.toml", false)] {
        let run = ["simulate", scene, "--out", scene.trim_end_matches(".toml"), "--lockstep", "--steps", "2"];
        let (code, out, err) = place.0.run(&run);
        assert_eq!(code, 0, "{out}{err}");
        let line = out.lines().find(|line| line.starts_with("lockstep  ")).expect("a line");
        assert_eq!(line.ends_with("2 steps differ; no blocks touched in any of them"), told, "{line}");
    }
}

#[test]
fn state_files_replay() {
    let place = WorkDir::new();
    // At the incline's edge: the ideal tolerances have crossing edges where territories have vertices.
    let edge =
        SLIDER.replace("min = [0.1, 0.1, 0], max = [1.1, 1.1, 1]", "min = [3.002, 0.1, 0], max = [4.002, 1.1, 1]");
    assert_ne!(edge, SLIDER);
    place.0.file("slider.toml", &edge.replace("at = [0.6", "at = [3.5"));
    let (code, said) = place.simulate("run", &["--engine", "f32", "--lockstep"]);
    assert_eq!(code, 0, "{said}");
    let differences = place.rows("run/differences.csv");
    let named = differences[1..].iter().map(|row| row[17].clone()).find(|name| !name.is_empty());
    let name = named.unwrap_or_else(|| panic!("no state file in {differences:?}"));
    let file = format!("run/states/{name}");
    let (code, said) = place.replay(&file);
    assert_eq!(code, 0, "{said}");
    assert!(said.contains("oracle") && said.contains("stepper"), "{said}");

    let text = place.0.read(&file);
    place.0.file(&file, &text.replacen("\"converged\": true", "\"converged\": false", 1));
    let (code, said) = place.replay(&file);
    assert_eq!(code, 1, "{said}");
    for broken in [text.replacen("rockproof-step-1", "rockproof-step-9", 1), text[..40].to_owned()] {
        place.0.file(&file, &broken);
        let (code, said) = place.replay(&file);
        assert_eq!(code, 2, "{said}");
        assert!(said.contains(&name), "{said}");
    }
}

#[test]
fn the_exact_trajectory_stands_beside_the_stepper_s() {
    let place = WorkDir::new();
    let (code, said) = place.simulate("free", &["--free", "--steps", "3"]);
    assert_eq!(code, 0, "{said}");
    let rows = place.rows("free/free.csv");
    assert_eq!(rows[0], free::COLUMNS);
    assert_eq!(rows.len(), 1 + 3);
    for row in &rows[1..] {
        let divergence: f64 = row[3].parse().expect("a distance");
        assert!(divergence < 1e-12, "{row:?}");
    }
}

#[test]
fn an_exact_run_says_what_it_keeps() {
    let place = WorkDir::new();
    let (code, said) = place.simulate("exact", &["--engine", "exact", "--steps", "2"]);
    assert_eq!(code, 0, "{said}");
    // The model is 16 m long.
    assert!(said.contains("within 2^-252 m"), "{said}");
    let rows = place.rows("exact/trajectory.csv");
    assert_eq!(rows.len(), 1 + 2);
    assert_eq!(place.rows("exact/measured.csv").len(), 1 + 2);
    assert_eq!(place.simulate("exact", &["--engine", "exact", "--steps", "2"]).0, 2, "it holds a run");
    let (code, said) =
        place.simulate("exact", &["--engine", "exact", "--steps", "2", "--overwrite", "--grid-exponent", "100"]);
    assert!(code == 0 && said.contains("within 2^-100 m"), "{said}");
    assert_eq!(place.simulate("other", &["--engine", "exact", "--lockstep"]).0, 2);
    // A grid of metres moves every vertex, one of 2^-4000000000 m holds no number.
    for exponent in ["0", "63", "4096", "4000000000"] {
        let (code, said) = place.simulate("grid", &["--engine", "exact", "--steps", "1", "--grid-exponent", exponent]);
        assert!(code == 2 && said.contains("is not in 64..=4095"), "{said}");
    }
    // The exact side calculates in no more bits than 4,096.
    let (code, said) = place.simulate("fine", &["--engine", "exact", "--steps", "1", "--grid-exponent", "4095"]);
    let told = "4,096 bits do not tell where the new positions are on a grid of 2^-4095 m: a coarser grid";
    assert!(code == 1 && said.contains(told), "{code} {said}");
    // Of a run without exact steps they would say nothing.
    for options in [&["--fractions"][..], &["--grid-exponent", "100"], &["--lockstep", "--fractions"]] {
        let (code, said) = place.simulate("stepper", &[&["--steps", "1"], options].concat());
        assert!(code == 2 && said.contains("they need --engine exact or --free"), "{options:?}: {said}");
    }
}

/// Runs a campaign with these settings whose pairs all make one step; its rows about depths, and the case of the first.
fn depths(place: &Place, settings: &str, family: &str, seed: &str) -> (Vec<String>, Option<String>) {
    place.file("settings.toml", settings);
    let pairs = ["--pairs", "32", "--family", family, "--tolerances", "shi", "--engine", "stepper-f32"];
    let steps = ["--steps-every", "1", "--steps", "1", "--seed", seed, "--out", family];
    let (code, out, err) = place.run(&[&["-q", "campaign", "settings.toml"], &pairs[..], &steps].concat());
    assert_eq!(code, 0, "{out}{err}");
    let rows = place.read(&format!("{family}/step_findings.csv"));
    let rows: Vec<String> =
        rows.lines().filter(|row| DEPTHS.iter().any(|change| row.contains(change))).map(str::to_owned).collect();
    let case = rows.iter().find_map(|row| row.rsplit(',').next().filter(|case| !case.is_empty()));
    let case = case.map(|case| format!("{family}/{case}"));
    (rows, case)
}

const DEPTHS: [&str; 2] = [",deeper,", ",shallower,"];

/// A case about depths is replayed, made small and judged by a gate by its depths, whatever else differs in its step.
#[test]
fn a_case_about_depths_is_held_to_its_depths() {
    let place = Place::new();
    let (rows, case) = depths(&place, "", "edge_cross", "22");
    let case = case.unwrap_or_else(|| panic!("{rows:?}"));
    let (code, out, err) = place.run(&["replay", &case]);
    assert!(code == 0 && out.contains("\narithmetic deeper: ") && out.contains("\npenetration "), "{out}{err}");
    let (code, out, err) = place.run(&["shrink", &case, "--evaluations", "50", "--out", "small.json"]);
    assert!(code == 0 && place.read("small.json").contains("\"arithmetic deeper: "), "{out}{err}");
    place.file("gate.toml", "corpus = [\"case.json\"]\n[campaign]\npairs = 16\n");
    let text = place.read(&case);
    let words = text.lines().find(|line| line.contains("arithmetic deeper: ")).expect("what differs");
    let (before, after) = words.split_once(" → ").expect("two depths");
    let before_m: f64 = before.rsplit(' ').next().expect("a depth").parse().expect("a number");
    let after_m: f64 = after.trim_matches(['"', ',']).parse().expect("a number");
    // As deep as recorded, and four times as much deeper.
    for (share, passes) in [(1.0, true), (0.25, false)] {
        let recorded = format!("{before} → {:e}\"", before_m + share * (after_m - before_m));
        place.file("case.json", &text.replace(words, &recorded));
        let (code, out, err) = place.run(&["gate", "gate.toml"]);
        assert_eq!(out.contains("nor what the case records: arithmetic deeper: "), !passes, "{code} {out}{err}");
    }
}

/// The depth of blocks that are not convex jumps by its definition: that the same step by the same decisions ends in another one says nothing.
#[test]
fn depths_of_concave_blocks_are_no_finding_where_no_decision_differs() {
    let place = Place::new();
    // To make cases of them would take ten times as long as to find them.
    let (rows, _) = depths(&place, "cases_per_cause = 0\n", "concave_notch", "3");
    assert!(
        rows.iter().all(|row| ["iteration", "classification"].iter().any(|effect| row.contains(effect))),
        "{rows:?}"
    );
}
