//! What steps leave out changes no byte of a run: not of its tables and frames, and not of what identifies it.

use rockproof_model::scene::SceneFormat;
use rockproof_model::simulation::Skips;
use rockproof_model::{Precision, Scene, ToleranceSpec};
use rockproof_results::Start;
use rockproof_simulate::identity::{identity, with_tolerances};
use rockproof_simulate::run::{Ending, Run, headers};
use rockproof_simulate::{Plan, RunRecord};
use rockproof_stepper::dynamics::Dynamics;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// A block that lies still, one that settles down on it and slides off, one far away that never moves.
const SCENE: &str = r#"
[simulation]
gravity = [0.5, 0, -10]
time_step = 0.005

[tolerances]
preset = "auto"

[[block]]
fixed = true
box = { min = [-9, -9, -1], max = [9, 9, 0] }

[[block]]
motion = "rigid"
box = { min = [0, 0, 0], max = [1, 1, 1] }

[[block]]
box = { min = [0.25, 0.125, 1.001], max = [1.25, 1.125, 2] }
velocity = [0.01, 0, 0]
spin = [0, 0, 0.01]

[[block]]
motion = "rigid"
box = { min = [5, 5, 5], max = [6, 6, 6] }

[[fixed_point]]
block = 3
at = [5.5, 5.5, 5.5]
"#;

fn scene(skips: &str) -> Scene {
    let text = SCENE.replacen("[simulation]\n", &format!("[simulation]\n{skips}"), 1);
    Scene::parse(&text, SceneFormat::Toml, Path::new("scene.toml")).expect("a scene")
}

/// All files of a run but those that tell of seconds, and what a run says of itself and its scene.
fn run(mut scene: Scene) -> (BTreeMap<String, Vec<u8>>, String) {
    let dir = tempfile::tempdir().expect("a directory");
    let dir = dir.path().join("run");
    let set = ToleranceSpec::default().derive(&scene.shapes(), Precision::F64).expect("a set");
    scene.derive_stiffness(&set);
    let plan = Plan { steps: Some(90), time: None, smallest_step: 5e-6, every: 30, contacts: true };
    let about =
        format!("{:?}\n{}", identity(&scene, &set, "f64", &plan), with_tolerances(&scene, &set).expect("a text"));
    let mut dynamics = Dynamics::<f64>::new(&scene, &set).expect("a scene that can move");
    let begin = dynamics.state().clone();
    let (mut record, _) =
        RunRecord::open(&dir, identity(&scene, &set, "f64", &plan), headers(&plan).expect("headers"), Start::Fresh)
            .expect("a directory of results");
    let run = Run { scene: &scene, begin: &begin, precision: Precision::F64, plan, about: Default::default() };
    let ending = run.run(&mut dynamics, &mut record, &AtomicBool::new(false), &mut |_, _| {}).expect("a run");
    assert_eq!(ending, Ending::Finished);
    // Its lock goes with it.
    drop(record);
    let mut files = BTreeMap::new();
    for folder in [dir.clone(), dir.join("frames")] {
        for entry in fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            let name = path.strip_prefix(&dir).expect("inside").to_string_lossy().into_owned();
            if path.is_file() && ![".rockproof.lock", "run.json", "checkpoint.jsonl"].contains(&name.as_str()) {
                files.insert(name, fs::read(&path).expect("a file"));
            }
        }
    }
    (files, about)
}

#[test]
fn whatever_is_left_out_the_files_are_the_same() {
    let all = scene("");
    assert_eq!(all.simulation.control.skips, Skips::ALL);
    let (files, about) = run(all);
    assert!(files.contains_key("contacts.csv") && files.keys().any(|name| name.starts_with("frames")), "{files:?}");
    for skips in ["[]", "[\"blocks\", \"pairs\"]", "[\"islands\"]"] {
        let scene = scene(&format!("skips = {skips}\n"));
        assert_ne!(scene.simulation.control.skips, Skips::ALL);
        let (other_files, other_about) = run(scene);
        assert_eq!(other_about, about, "{skips}");
        assert_eq!(other_files.keys().collect::<Vec<_>>(), files.keys().collect::<Vec<_>>());
        for (name, bytes) in &files {
            assert!(other_files[name] == *bytes, "{skips}: {name} differs");
        }
    }
}
