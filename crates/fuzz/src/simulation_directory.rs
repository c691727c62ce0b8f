//! The directory of `simulate` with one file damaged: a run that goes on makes what a whole run makes, byte by byte, or an error names a file.

use crate::Target;
use crate::dice::Dice;
use crate::reach::Reach;
use crate::run_directory::{Damage, files, input, write};
use crate::scratch::{new_folder, scratch};
use rockproof_model::scene::SceneFormat;
use rockproof_model::{Precision, Scene, ToleranceSet, ToleranceSpec};
use rockproof_results::{MANIFEST, Start};
use rockproof_simulate::identity::{identity, with_tolerances};
use rockproof_simulate::run::{Ending, Run, headers};
use rockproof_simulate::{Plan, RunRecord};
use rockproof_stepper::dynamics::Dynamics;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

/// A block that falls onto another one.
const SCENE: &str = r#"
[simulation]
gravity = [0.5, 0, -10]
time_step = 0.005

[[block]]
fixed = true
box = { min = [-9, -9, -1], max = [9, 9, 0] }

[[block]]
box = { min = [0, 0, 0.0001], max = [1, 1, 1] }
spin = [0, 0, 0.01]

[[measured_point]]
block = 1
at = [1, 1, 1]
"#;

/// What a run goes on from.
const GONE_ON_FROM: [&str; 5] = [MANIFEST, "checkpoint.jsonl", "steps.csv", "measured.csv", "contacts.csv"];
/// The steps of the run that is damaged; its last checkpoint is before its end.
const STEPS: u64 = 5;
/// The steps after which it has gone on far enough.
const MORE: u64 = 7;
/// A run that goes on makes no more steps than this, whatever its checkpoint says is left to do.
const MAX_STEPS: u64 = 20;

/// The scene ready to run.
fn scene() -> &'static (Scene, ToleranceSet) {
    static READY: OnceLock<(Scene, ToleranceSet)> = OnceLock::new();
    READY.get_or_init(|| {
        let mut scene = Scene::parse(SCENE, SceneFormat::Toml, Path::new("scene.toml")).expect("a scene");
        let set = ToleranceSpec::default().derive(&scene.shapes(), Precision::F64).expect("a set");
        scene.derive_stiffness(&set);
        (scene, set)
    })
}

/// Runs for so many steps in all, or says why not: the kind and the message.
fn run_into(dir: &Path, steps: u64, start: Start) -> Result<Ending, (String, String)> {
    let (scene, set) = scene();
    let plan = Plan { steps: Some(steps), time: None, smallest_step: 5e-6, every: 2, contacts: true };
    let mut dynamics = Dynamics::<f64>::new(scene, set).expect("a scene that can move");
    let begin = dynamics.state().clone();
    let (mut record, saved) =
        RunRecord::open(dir, identity(scene, set, "f64", &plan), headers(&plan).expect("headers"), start)
            .map_err(|error| (Reach::variant(&error), error.to_string()))?;
    // As the command says it.
    let unusable =
        |error: String| ("State".to_owned(), format!("{}: the checkpoint cannot be used: {error}", dir.display()));
    match saved {
        None => {
            let text = with_tolerances(scene, set).expect("a scene's text");
            record.write("scene.toml", text.as_bytes()).expect("a file");
        }
        Some(saved) => {
            let state = saved.state().map_err(|error| unusable(error.to_string()))?;
            dynamics.restore(state).map_err(|error| unusable(error.to_string()))?;
        }
    }
    let (stop, mut made) = (AtomicBool::new(false), 0);
    let run = Run { scene, begin: &begin, precision: Precision::F64, plan, about: Default::default() };
    let ending = run.run(&mut dynamics, &mut record, &stop, &mut |_, _| {
        made += 1;
        stop.store(made >= MAX_STEPS, Ordering::Relaxed);
    });
    ending.map_err(|error| ("Run".to_owned(), error.to_string()))
}

/// The files of a run of so many steps.
fn made(steps: u64) -> BTreeMap<String, Vec<u8>> {
    let folder = new_folder();
    let dir = folder.path().join("run");
    let ending = run_into(&dir, steps, Start::Fresh).expect("a run of a few steps");
    assert_eq!(ending, Ending::Finished);
    files(&dir, "")
}

/// The files of the run that is damaged.
pub(crate) fn begun() -> &'static BTreeMap<String, Vec<u8>> {
    static FILES: OnceLock<BTreeMap<String, Vec<u8>>> = OnceLock::new();
    FILES.get_or_init(|| made(STEPS))
}

/// The files of a run that makes all steps at once, without those that tell of seconds.
fn whole() -> &'static BTreeMap<String, Vec<u8>> {
    static FILES: OnceLock<BTreeMap<String, Vec<u8>>> = OnceLock::new();
    FILES.get_or_init(|| {
        let mut files = made(MORE);
        files.retain(|name, _| name.ends_with(".csv") || name.ends_with(".vtu") || name.ends_with(".toml"));
        files
    })
}

/// A run that goes on.
pub(crate) fn simulation_directory(bytes: &[u8], reach: &mut Reach) {
    let Some(damage) = Damage::of(bytes, &GONE_ON_FROM) else { return reach.count("too-short") };
    let dir = scratch().join("simulated");
    write(&dir, begun());
    damage.apply(&dir);
    match run_into(&dir, MORE, Start::Resume) {
        Ok(_) if damage.resealed => reach.count("resealed-run"),
        Ok(ending) => {
            assert_eq!(ending, Ending::Finished, "{} was believed", damage.name);
            let found = files(&dir, "");
            for (name, bytes) in whole() {
                assert!(found.get(name) == Some(bytes), "{} was believed: {name} is another one", damage.name);
            }
            reach.count("whole");
        }
        Err((kind, message)) => {
            assert!(message.contains(&*dir.to_string_lossy()), "no file is named: {message}");
            assert!(message.len() < 8_000, "a message of {} bytes: {message}", message.len());
            reach.count(kind);
        }
    }
}

/// An input of [`simulation_directory`].
pub(crate) fn simulation_directory_input(_: &Target, dice: &mut Dice) -> Vec<u8> {
    input(&GONE_ON_FROM, begun(), dice)
}
