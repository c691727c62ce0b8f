//! Pins the command `simulate`: what it writes, what it refuses and why, that a run killed or interrupted resumes with
//! byte-identical files, and that one which cannot go on says so and keeps its last good state.

use crate::campaigns::files;
use crate::place::Place;
use crate::processes::{begin, signal, until};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Child;

/// Blocks that fall on a floor, askew and one on the other: they hit, slide and come to rest.
const FALL: &str = r#"
[simulation]
gravity = [1, 0, -10]
time_step = 0.005
steps = 120
settle = 2

[tolerances]
preset = "auto"

[[block]]
name = "floor"
fixed = true
box = { min = [-9, -9, -1], max = [9, 9, 0] }

[[block]]
name = "low"
box = { min = [0, 0, 0.01], max = [1, 1, 1] }
spin = [0.3, 0.1, 0]

[[block]]
name = "middle"
box = { min = [0.3, 0.2, 1.03], max = [1.3, 1.2, 2] }
velocity = [0.5, 0, -1]

[[block]]
name = "high"
box = { min = [-0.4, 0.1, 2.05], max = [0.9, 0.8, 3] }

[[measured_point]]
name = "top"
block = "high"
at = [0, 0.5, 3]
"#;

/// A block much too fast for the largest displacement of a step.
const FAST: &str = r#"
[simulation]
time_step = 0.01
steps = 50

[[block]]
name = "shot"
box = { min = [0, 0, 0], max = [1, 1, 1] }

[[load]]
block = "shot"
at = [0.5, 0.5, 0.5]
table = [[0, 0, 0, 0], [0.1, 0, 0, 0], [0.11, 1e12, 0, 0]]
"#;

impl Place {
    /// Exit code, standard output and standard error of `rockproof simulate …`, run here.
    fn simulate(&self, args: &[&str]) -> (i32, String, String) {
        self.run(&[&["simulate"], args].concat())
    }

    fn finishes(&self, args: &[&str]) -> String {
        let (code, out, err) = self.simulate(args);
        assert_eq!(code, 0, "{args:?}: {err}");
        out
    }

    fn begin(&self, args: &[&str]) -> Child {
        begin(&self.path(""), &[&["simulate"], args].concat())
    }

    /// Waits until a run has written so many rows.
    fn wait_for_rows(&self, dir: &str, rows: usize) {
        let table = self.path(dir).join("steps.csv");
        let written = || fs::read(&table).map_or(0, |text| text.iter().filter(|b| **b == b'\n').count());
        until(&format!("no row {rows} in {}", table.display()), || written() > rows);
    }

    /// All files of a run with their bytes, but those that tell of seconds.
    fn files(&self, dir: &str) -> BTreeMap<String, Vec<u8>> {
        let mut found = files(&self.path(dir), "");
        found.retain(|name, _| !["run.json", "checkpoint.jsonl"].contains(&name.as_str()));
        found
    }

    fn run_json(&self, dir: &str) -> serde_json::Value {
        serde_json::from_slice(&fs::read(self.path(dir).join("run.json")).expect("run.json")).expect("JSON")
    }
}

fn rows(path: &Path) -> Vec<BTreeMap<String, String>> {
    csv::Reader::from_path(path).expect("a table").deserialize().map(|row| row.expect("a row")).collect()
}

#[test]
fn a_run_leaves_tables_pictures_and_what_they_were_made_from() {
    let place = Place::new();
    place.file("fall.toml", FALL);
    let out = place.finishes(&["fall.toml", "--contacts", "--every", "50"]);
    assert!(out.contains("120 steps") && out.contains("written to reports/simulate-fall: steps.csv"), "{out}");
    let files = place.files("reports/simulate-fall");
    let frames = [0, 50, 100, 120];
    let pictures = frames.iter().flat_map(|step| ["blocks", "contacts"].map(|p| format!("frames/{p}_{step:06}.vtu")));
    let tables = [
        "steps.csv",
        "measured.csv",
        "contacts.csv",
        "blocks.pvd",
        "contacts.pvd",
        "scene.toml",
        "rockproof.manifest.json",
    ];
    let mut expected: Vec<String> = pictures.chain(tables.map(str::to_owned)).collect();
    expected.sort();
    assert_eq!(files.keys().cloned().collect::<Vec<_>>(), expected);
    let dir = place.path("reports/simulate-fall");
    let steps = rows(&dir.join("steps.csv"));
    assert_eq!((steps.len(), steps[0]["step"].as_str(), steps[121]["step"].as_str()), (122, "-1", "120"));
    let contacts = rows(&dir.join("contacts.csv"));
    let total: usize = steps.iter().map(|row| row["contacts"].parse::<usize>().expect("a count")).sum();
    assert_eq!(contacts.len(), total);
    assert!(["open", "sliding", "locked"].iter().all(|mode| contacts.iter().any(|row| row["mode"] == *mode)));
    assert_eq!(rows(&dir.join("measured.csv")).iter().filter(|row| row["point"] == "top").count(), 122);
    let run = place.run_json("reports/simulate-fall");
    assert_eq!((&run["engine"], &run["ending"], &run["blocks"]), (&"f64".into(), &"finished".into(), &4.into()));
    assert_eq!(run["totals"]["steps"], 120);
    // The scene it kept makes the same run.
    fs::copy(dir.join("scene.toml"), place.path("again.toml")).expect("copy");
    place.finishes(&["again.toml", "--contacts", "--every", "50", "--out", "again"]);
    assert_eq!(place.files("again"), files);
}

#[test]
fn options_choose_precision_length_and_place() {
    let place = Place::new();
    place.file("fall.toml", FALL);
    let last = |dir: &str| rows(&place.path(dir).join("steps.csv")).pop().expect("a row");
    place.finishes(&["fall.toml", "--steps", "7", "--out", "steps"]);
    assert_eq!(last("steps")["step"], "7");
    place.finishes(&["fall.toml", "--time", "0.05", "--out", "time"]);
    // Whole steps of at most 5 ms, some of them cut.
    let time: f64 = last("time")["time_s"].parse().expect("a number");
    assert!((0.05 - 5e-6..0.055).contains(&time), "{:?}", last("time"));
    place.finishes(&["fall.toml", "--time", "1/20", "--out", "fraction"]);
    assert_eq!(last("fraction"), last("time"));
    place.finishes(&["fall.toml", "--time", "0.05", "--steps", "4", "--out", "both"]);
    assert_eq!(last("both")["step"], "4");
    // Before anything touches: an impact is nothing that two precisions share to a per cent.
    place.finishes(&["fall.toml", "--steps", "5", "--engine", "f32", "--out", "f32"]);
    let (single, double) = (last("f32"), rows(&place.path("steps").join("steps.csv")).remove(6));
    assert_eq!(single["step"], double["step"]);
    let energy = |row: &BTreeMap<String, String>| row["kinetic_J"].parse::<f64>().expect("a number");
    assert!(single != double && (energy(&single) / energy(&double) - 1.0).abs() < 1e-2, "{single:?} {double:?}");
    place.finishes(&["fall.toml", "--steps", "7", "--set", "max_displacement=1/200", "--out", "set"]);
    assert!(last("set")["retries"].starts_with("displacement@0.005"), "{:?}", last("set"));
    assert_eq!(place.run_json("set")["max_displacement"], "1/200");
    place.finishes(&[
        "fall.toml",
        "--steps",
        "1",
        "--tolerances",
        "zero",
        "--planarity",
        "0",
        "--force",
        "--out",
        "zero",
    ]);
    assert_eq!(place.run_json("zero")["parallel_sine"], "0");
    assert!(!place.path("steps").join("contacts.csv").exists(), "only on request");
}

/// What steps leave out changes no byte, and a run may go on with another choice.
#[test]
fn what_steps_leave_out_changes_no_file() {
    let place = Place::new();
    place.file("fall.toml", FALL);
    place.file("some.toml", &FALL.replace("settle = 2", "settle = 2\nskips = [\"blocks\", \"islands\"]"));
    place.finishes(&["fall.toml", "--contacts", "--out", "all"]);
    let all = place.files("all");
    place.finishes(&["fall.toml", "--contacts", "--skips", "none", "--out", "none"]);
    assert!(place.files("none") == all);
    place.finishes(&["some.toml", "--contacts", "--out", "some"]);
    assert!(place.files("some") == all);
    place.finishes(&["some.toml", "--contacts", "--steps", "60", "--skips", "pairs,features", "--out", "parts"]);
    place.finishes(&["fall.toml", "--contacts", "--resume", "--out", "parts"]);
    assert!(place.files("parts") == all);
}

#[test]
fn mistakes_exit_with_2_and_say_where() {
    let place = Place::new();
    place.file("fall.toml", FALL);
    place.file("endless.toml", &FALL.replace("steps = 120\n", ""));
    place.file("wrong.toml", &FALL.replace("settle = 2", "settle = -2"));
    place.file("huge.toml", &FALL.replace("gravity = [1,", "gravity = [1e60,"));
    // Told before it is looked how deep blocks overlap, which would end with 1.
    place.file("overlap.toml", &FALL.replace("min = [0, 0, 0.01]", "min = [0, 0, -0.5]"));
    assert_eq!(place.simulate(&["overlap.toml", "--out", "new"]).0, 1);
    place.finishes(&["fall.toml", "--steps", "3", "--out", "done"]);
    let before = place.files("done");
    for (args, told) in [
        (vec!["none.toml"], "none.toml"),
        (vec!["endless.toml"], "--steps N or --time T"),
        (vec!["wrong.toml"], "wrong.toml:6: "),
        (vec!["huge.toml", "--engine", "f32", "--force"], "overflows in the stepper's precision"),
        (vec!["fall.toml", "--time", "0"], "above 0"),
        (vec!["fall.toml", "--time", "soon"], "above 0"),
        (vec!["fall.toml", "--time", "1e400"], "above 0"),
        (vec!["fall.toml", "--steps", "-3"], "-3"),
        (vec!["fall.toml", "--every", "0"], "--every"),
        (vec!["fall.toml", "--skips", "pairs,contacts"], "contacts\" is none of blocks, pairs, islands, features, all"),
        (vec!["fall.toml", "--solver", "cholesky"], "must be one of auto, factor, conjugate-gradients"),
        (vec!["fall.toml", "--engine", "f16"], "stepper-f64, stepper-f32"),
        (vec!["fall.toml", "--tolerances", "loose"], "auto, shi, zero"),
        (vec!["fall.toml", "--set", "serch=1"], "serch"),
        (vec!["fall.toml", "--planarity", "-1"], "0 or more"),
        (vec!["fall.toml", "--resume", "--overwrite"], "cannot be used with"),
        (vec!["overlap.toml", "--out", "done"], "--resume goes on with it, --overwrite discards it"),
        (vec!["fall.toml", "--out", "done"], "--resume goes on with it, --overwrite discards it"),
        (
            vec!["fall.toml", "--out", "done", "--resume", "--engine", "f32"],
            "engine: the run has \"f64\", asked for is",
        ),
        (vec!["fall.toml", "--out", "done", "--resume", "--set", "open=0.001"], "open: the run has"),
        (vec!["fall.toml", "--out", "done", "--resume", "--every", "3"], "every: the run has 10, asked for is 3"),
        (vec!["fall.toml", "--out", "fall.toml"], "fall.toml"),
    ] {
        let (code, out, err) = place.simulate(&args);
        assert_eq!(code, 2, "{args:?}: {out}{err}");
        assert!(err.contains(told) && !err.contains("panicked"), "{args:?}: {err}");
    }
    place.file("fall.toml", &FALL.replace("0.5, 0, -1", "0.5, 0, -2"));
    let (code, _, err) = place.simulate(&["fall.toml", "--out", "done", "--resume"]);
    assert!(code == 2 && err.contains("scene: line ") && err.contains(" of scene.toml: the run has "), "{err}");
    assert_eq!(place.files("done"), before, "nothing was touched");
    assert!(!place.path("reports").exists());
    place.finishes(&["fall.toml", "--steps", "3", "--out", "done", "--overwrite"]);
    assert_ne!(place.files("done"), before);
}

#[test]
fn violated_rules_stop_a_run_before_it_begins() {
    let place = Place::new();
    place.file("fall.toml", FALL);
    let loose = ["fall.toml", "--steps", "2", "--set", "search=1/1000", "--out", "out"];
    let (code, out, err) = place.simulate(&loose);
    assert_eq!(code, 1);
    assert!(out.starts_with("rules: ") && out.contains("search ≥ 2·max_displacement"), "{out}");
    assert!(out.contains("satisfied  by search ≥") && err.contains("--force"), "{out}{err}");
    assert!(!place.path("out").exists());
    let (code, _, err) = place.simulate(&[&loose[..], &["--force"]].concat());
    assert!(code == 0 && err.contains("search ≥ 2·max_displacement"), "{err}");
    assert!(place.run_json("out")["violated"].as_array().is_some_and(|rules| !rules.is_empty()));
    // The stiffness rule is one of them.
    place.file("soft.toml", &format!("{FALL}\n[[joint]]\nnormal_stiffness = 1\n"));
    let (code, out, _) = place.simulate(&["soft.toml"]);
    assert!(code == 1 && out.contains("normal_stiffness"), "{out}");
}

#[test]
#[ignore = "ten seconds; .ci/run runs it"]
fn a_killed_run_goes_on_to_the_same_bytes() {
    let place = Place::new();
    place.file("fall.toml", FALL);
    for engine in ["f64", "f32"] {
        let args = |out| ["fall.toml", "--contacts", "--every", "7", "--engine", engine, "--out", out];
        let [whole, killed] = ["whole", "killed"].map(|name| format!("{name}_{engine}"));
        place.finishes(&args(&whole));
        let mut cut_short = 0;
        for rows in [1, 23, 60, 95] {
            let mut child = place.begin(&[&args(&killed)[..], &["--resume"]].concat());
            place.wait_for_rows(&killed, rows);
            child.kill().expect("a kill");
            child.wait().expect("an end");
            cut_short += usize::from(place.files(&killed) != place.files(&whole));
        }
        assert!(cut_short > 1, "the kills came too late to show anything");
        place.finishes(&[&args(&killed)[..], &["--resume"]].concat());
        let (expected, found) = (place.files(&whole), place.files(&killed));
        let differ: Vec<_> = expected.keys().filter(|name| found.get(*name) != expected.get(*name)).collect();
        assert!(differ.is_empty() && found.len() == expected.len(), "{engine}: {differ:?} differ");
    }
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_ends_in_good_order_and_goes_on() {
    let place = Place::new();
    place.file("fall.toml", FALL);
    let args = |out| ["fall.toml", "--steps", "100000", "--every", "1000", "--out", out];
    let mut child = place.begin(&args("out"));
    place.wait_for_rows("out", 20);
    signal(&child, "INT");
    assert_eq!(child.wait().expect("an end").code(), Some(130));
    let run = place.run_json("out");
    assert_eq!(run["ending"], "interrupted");
    let done = run["step"].as_u64().expect("a step");
    assert!((15..100_000).contains(&done), "{done}");
    let until = (done + 9).to_string();
    let length = ["fall.toml", "--steps", &until, "--every", "1000", "--out"];
    place.finishes(&[&length[..], &["out", "--resume"]].concat());
    place.finishes(&[&length[..], &["whole"]].concat());
    assert!(place.files("out") == place.files("whole"));
}

#[test]
fn a_run_that_cannot_go_on_says_where_and_keeps_the_last_good_state() {
    let place = Place::new();
    place.file("fast.toml", FAST);
    let (code, out, err) = place.simulate(&["fast.toml", "--out", "out"]);
    assert_eq!(code, 1, "{out}{err}");
    assert!(err.starts_with("error: step ") && err.contains("block 0") && err.contains("displacement"), "{err}");
    assert!(out.contains("the last good state is kept"), "{out}");
    let run = place.run_json("out");
    assert_eq!((&run["ending"], &run["stopped"]["block"]), (&"stopped".into(), &0.into()));
    let (step, last) = (run["stopped"]["step"].as_u64().expect("a step"), run["step"].as_u64().expect("a step"));
    assert_eq!((last + 1, rows(&place.path("out/steps.csv")).len() as u64), (step, last));
    let files = place.files("out");
    assert!(files.contains_key(&format!("frames/blocks_{last:06}.vtu")), "{:?}", files.keys());
    // It stops there again, and nothing changes.
    let (code, _, again) = place.simulate(&["fast.toml", "--out", "out", "--resume"]);
    assert_eq!((code, again), (1, err));
    assert_eq!(place.files("out"), files);
}

#[test]
fn help_shows_examples() {
    let help = Place::new().finishes(&["--help"]);
    for told in ["rockproof simulate incline.toml --time 0.5", "--resume", "Exit status"] {
        assert!(help.contains(told), "{help}");
    }
}

/// A model that fixes nothing falls, which is said; `--hold-lowest` fixes what `examine` holds, which names that.
#[test]
fn a_model_that_fixes_nothing_stands_on_its_lowest_blocks() {
    let dir = crate::place::folder();
    let path = |name: &str| dir.path().join(name).to_str().expect("text").to_owned();
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let run = |args: &[&str]| {
        let output = assert_cmd::Command::cargo_bin("rockproof").expect("built").args(args).output().expect("runs");
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("UTF-8");
        assert!(output.status.success(), "{args:?}: {}", text(output.stderr));
        (text(output.stdout), text(output.stderr))
    };
    let mesh = root.join("cases/meshes/arch_mm.stl");
    let [arch, falls, stands, examined] = ["arch.toml", "falls", "stands", "examined"].map(path);
    run(&["convert", mesh.to_str().expect("text"), &arch, "--scale", "1/1000"]);
    let energy = |out: &str| {
        let mut rows = csv::Reader::from_path(std::path::Path::new(out).join("steps.csv")).expect("a table");
        let at = rows.headers().expect("names").iter().position(|name| name == "kinetic_J").expect("a column");
        let last = rows.records().last().expect("a step").expect("a row");
        last[at].parse::<f64>().expect("a number")
    };
    let note = "falls as a whole";
    let (_, said) = run(&["simulate", &arch, "--steps", "20", "--out", &falls]);
    assert!(said.contains(note), "{said}");
    let (_, said) = run(&["simulate", &arch, "--steps", "20", "--hold-lowest", "--out", &stands]);
    assert!(!said.contains(note) && said.contains("2 lowest blocks held"), "{said}");
    let [falling, standing] = [&falls, &stands].map(|out| energy(out));
    assert!(standing < falling / 100.0, "{standing} J, {falling} J");
    let scene = rockproof_model::Scene::load(std::path::Path::new(&stands).join("scene.toml")).expect("a scene");
    let fixed: Vec<usize> = (0..13).filter(|block| scene.blocks[*block].body.is_fixed()).collect();
    assert_eq!(fixed, [11, 12], "the footings");
    let (_, said) = run(&["simulate", &format!("{stands}/scene.toml"), "--steps", "1", "--out", &path("again")]);
    assert!(!said.contains(note), "{said}");
    let (answer, _) = run(&["examine", &arch, "--no-tune", "--out", &examined]);
    assert!(answer.ends_with("--hold-lowest --steps 100 --audit\n"), "{answer}");
}

/// Four cubes that nothing holds: their first step does not converge, and what helps is said.
#[test]
fn a_loose_model_that_does_not_converge_is_told_to_hold_its_lowest_blocks() {
    let place = Place::new();
    let cube = |x: u8, z: u8| format!("[[block]]\nbox = {{ min = [{x}, 0, {z}], max = [{}, 1, {}] }}\n", x + 1, z + 1);
    let cubes: String = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(x, z)| cube(x, z)).concat();
    place.file("loose.toml", &format!("[simulation]\ntime_step = 0.01\n{cubes}"));
    let (code, _, err) = place.run(&["simulate", "loose.toml", "--steps", "3", "--out", "falls"]);
    assert!(code == 1 && err.contains("does not converge at the smallest time step"), "{err}");
    assert!(err.ends_with("; perhaps since nothing is fixed: --hold-lowest fixes the lowest blocks\n"), "{err}");
    let (code, _, err) = place.run(&["simulate", "loose.toml", "--steps", "3", "--hold-lowest", "--out", "stands"]);
    assert!(code == 0 && !err.contains("nothing is fixed"), "{err}");
}
