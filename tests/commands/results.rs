//! Pins what every command promises of a directory of results: nobody else's file is touched, one process at a time works there, and
//! nothing damaged is gone on from.

use crate::campaigns::{CASES_AS_FOUND, files};
use crate::place::rockproof_in;
use crate::processes::{begin, until};
use assert_cmd::Command;
use std::fs;
use std::path::{Path, PathBuf};

const SLIVERS: [&str; 10] = [
    "campaign",
    CASES_AS_FOUND,
    "--pairs",
    "192",
    "--family",
    "sliver,face_stack",
    "--tolerances",
    "auto",
    "--steps-every",
    "16",
];

const SCENE: &str = r#"
[tolerances]
preset = "shi"
[simulation]
time_step = 0.01
[[block]]
fixed = true
box = { min = [-1, -1, -1], max = [3, 3, 0] }
[[block]]
motion = "rigid"
box = { min = [0, 0, 0], max = [1, 1, 1] }
[[block]]
motion = "rigid"
box = { min = [1, 0, 0], max = [2, 1, 1] }
"#;

/// A folder of its own, with a scene.
struct WorkDir(tempfile::TempDir);

impl WorkDir {
    fn new() -> WorkDir {
        let place = WorkDir(crate::place::folder());
        fs::write(place.at("model.toml"), SCENE).expect("write");
        place
    }

    fn at(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn run(&self, arguments: &[&str]) -> (i32, String) {
        let (code, _, err) = rockproof_in(self.0.path(), arguments);
        (code, err)
    }

    /// The command must fail as one that is misused, say all of `wanted`, and change no file.
    fn refuses(&self, arguments: &[&str], wanted: &[&str]) {
        let before = files(self.0.path(), "");
        let (code, err) = self.run(arguments);
        assert!(code == 2 && wanted.iter().all(|part| err.contains(part)), "{arguments:?}: {code}: {err}");
        assert!(files(self.0.path(), "") == before, "{arguments:?} changed a file");
    }

    fn works(&self, arguments: &[&str]) {
        let (code, err) = self.run(arguments);
        assert!(code < 2, "{arguments:?}: {err}");
    }
}

/// Flips the lowest bit of a byte in the middle of the file.
fn flip(file: &Path) {
    let mut bytes = fs::read(file).expect("a file");
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    fs::write(file, bytes).expect("write");
}

#[test]
fn an_input_is_not_discarded() {
    let place = WorkDir::new();
    let simulate = ["--steps", "2", "--force", "--out", "stepped"];
    place.works(&[&["simulate", "model.toml"], &simulate[..]].concat());
    place.works(&["tune", "model.toml", "--candidates", "1", "--steps", "1", "--out", "tuned"]);
    let (scene, set) = (place.at("stepped/scene.toml"), place.at("tuned/tolerances.toml"));
    for file in [&scene, &set] {
        fs::write(file, fs::read_to_string(file).expect("a file") + "# mine\n").expect("write");
    }
    let again = [&["simulate", "stepped/scene.toml", "--overwrite"], &simulate[..]].concat();
    place.refuses(&again, &["stepped/scene.toml is an input", "--out DIR"]);
    place.refuses(&[&again[..], &["--engine", "exact"]].concat(), &["stepped/scene.toml is an input"]);
    for command in ["tune", "examine"] {
        let arguments =
            [command, "model.toml", "--tolerances", "tuned/tolerances.toml", "--out", "tuned", "--overwrite"];
        place.refuses(&arguments, &["tuned/tolerances.toml is an input"]);
    }
    for file in [&scene, &set] {
        assert!(fs::read_to_string(file).expect("a file").ends_with("# mine\n"));
    }
    place.works(&[&["simulate", "model.toml", "--overwrite"], &simulate[..]].concat());
}

/// A gate discards what an earlier one wrote, but not a case of it that its corpus names.
#[test]
fn a_gate_does_not_discard_its_corpus() {
    let place = WorkDir::new();
    let campaign = "[campaign]\npairs = 320\n[[limit]]\nengine = \"stepper-f32\"\ncount = 0\n";
    let gate = ["gate", "gate.toml", "--out", "out"];
    fs::write(place.at("gate.toml"), format!("corpus = []\nrotating_pairs = 320\n{campaign}")).expect("write");
    place.works(&gate);
    for (run, rotating) in [("fixed", 0), ("rotating", 320)] {
        let cases = place.at(&format!("out/{run}/cases"));
        let case = fs::read_dir(&cases).expect("cases").next().expect("a case").expect("a case").path();
        fs::write(&case, fs::read_to_string(&case).expect("a case") + "# mine\n").expect("write");
        let name = case.file_name().expect("a name").to_string_lossy().into_owned();
        for corpus in [format!("out/{run}/cases"), format!("out/{run}/cases/{name}")] {
            let text = format!("corpus = [\"{corpus}\"]\nrotating_pairs = {rotating}\n{campaign}");
            fs::write(place.at("gate.toml"), text).expect("write");
            place.refuses(&gate, &["is an input", "--out DIR"]);
        }
        assert!(fs::read_to_string(&case).expect("a case").ends_with("# mine\n"));
    }
    // Elsewhere they are examined.
    place.works(&["gate", "gate.toml", "--out", "other"]);
}

#[test]
fn other_peoples_files_are_named_and_left_alone() {
    let place = WorkDir::new();
    let simulate = ["simulate", "model.toml", "--steps", "2", "--force"];
    let tune = ["tune", "model.toml", "--candidates", "1", "--steps", "1"];
    let commands: [(&[&str], &str); 5] = [
        (&SLIVERS, "run.json"),
        (&simulate, "scene.toml"),
        (&["simulate", "model.toml", "--steps", "1", "--force", "--engine", "exact"], "state.json"),
        (&tune, "tolerances.toml"),
        (&["bench", "--error", "--quick"], "bench.csv"),
    ];
    for (command, name) in commands {
        let dir = format!("{}-{name}", command[0]);
        fs::create_dir(place.at(&dir)).expect("a folder");
        fs::write(place.at(&dir).join(name), "mine").expect("write");
        for start in [&["--overwrite"][..], &[]] {
            place.refuses(&[command, &["--out", &dir], start].concat(), &[name, "in the way"]);
        }
    }
    // Nor does a run go on over them, were it the very scene that it is asked to step.
    for (command, name) in [commands[0], commands[1], commands[3]] {
        let dir = format!("{}-{name}", command[0]);
        place.refuses(&[command, &["--out", &dir, "--resume"][..]].concat(), &[name, "in the way"]);
    }
    fs::create_dir(place.at("mine")).expect("a folder");
    fs::write(place.at("mine/scene.toml"), SCENE).expect("write");
    for start in ["--resume", "--overwrite"] {
        let own = ["simulate", "mine/scene.toml", "--steps", "2", "--force", "--out", "mine", start];
        place.refuses(&own, &["scene.toml", "in the way"]);
    }
    // Neither are the results of another command, nor cases that somebody put beside ours.
    place.works(&[&SLIVERS[..], &["--out", "run"]].concat());
    for start in ["--resume", "--overwrite"] {
        place.refuses(&[&simulate[..], &["--out", "run", start]].concat(), &["belongs to `rockproof campaign`"]);
        place.refuses(&[&tune[..], &["--out", "run", start]].concat(), &["belongs to `rockproof campaign`"]);
    }
    place.refuses(&["report", "run", "--out", "run"], &["belongs to `rockproof campaign`"]);
    fs::write(place.at("run/cases/my_own.toml"), "mine").expect("write");
    fs::write(place.at("run/.notes.csv.1.2.tmp"), "mine").expect("write");
    fs::write(place.at("run/.summary.csv.1.2.tmp"), "half").expect("write");
    place.works(&[&SLIVERS[..], &["--seed", "5", "--out", "run", "--overwrite"]].concat());
    assert_eq!(fs::read(place.at("run/cases/my_own.toml")).expect("still there"), b"mine");
    assert!(place.at("run/.notes.csv.1.2.tmp").exists(), "not ours");
    assert!(!place.at("run/.summary.csv.1.2.tmp").exists(), "what a kill left");
    // Every other case is one that the new run wrote.
    let findings = fs::read_to_string(place.at("run/findings.csv")).expect("findings");
    let steps = fs::read_to_string(place.at("run/step_findings.csv")).expect("findings");
    for entry in fs::read_dir(place.at("run/cases")).expect("cases") {
        let name = entry.expect("a case").file_name().to_string_lossy().into_owned();
        assert!(name == "my_own.toml" || findings.contains(&name) || steps.contains(&name), "{name}");
    }
    let manifest = fs::read_to_string(place.at("run/rockproof.manifest.json")).expect("a manifest");
    assert!(manifest.contains("\"cases/") && !manifest.contains("my_own"), "{manifest}");
}

#[test]
fn a_second_process_is_told_who_works_there() {
    let place = WorkDir::new();
    let mut first = begin(place.0.path(), &["campaign", "--pairs", "100000000", "--out", "run"]);
    let manifest = place.at("run/rockproof.manifest.json");
    until("it has begun", || manifest.exists());
    let second = [&SLIVERS[..], &["--out", "run", "--overwrite"]].concat();
    let (code, err) = place.run(&second);
    first.kill().expect("killed");
    first.wait().expect("ended");
    let holder = format!("process {}", first.id());
    assert!(code == 2 && err.contains(&holder) && err.contains("100000000") && err.contains("UTC"), "{err}");
    // The lock of a process that was killed is void.
    place.works(&second);
    assert!(!place.at("run/.rockproof.lock").exists());
}

#[test]
fn what_is_damaged_is_not_gone_on_from() {
    let place = WorkDir::new();
    let campaign = [&SLIVERS[..], &["--out", "campaign"]].concat();
    let run = ["simulate", "model.toml", "--steps", "3", "--force", "--contacts", "--lockstep", "--out", "run"];
    let tune = ["tune", "model.toml", "--candidates", "2", "--steps", "1", "--out", "tune"];
    let runs: [(&[&str], &str, &[&str]); 3] = [
        (&campaign, "campaign", &["findings.csv", "step_findings.csv", "progress.json"]),
        (
            &run,
            "run",
            &["steps.csv", "measured.csv", "contacts.csv", "lockstep.csv", "differences.csv", "checkpoint.jsonl"],
        ),
        (&tune, "tune", &["candidates.csv", "tune.json"]),
    ];
    for (command, dir, names) in runs {
        place.works(command);
        let resume = [command, &["--resume"]].concat();
        for name in names.iter().chain(&["rockproof.manifest.json"]) {
            let file = place.at(dir).join(name);
            let whole = fs::read(&file).expect(name);
            flip(&file);
            place.refuses(&resume, &[name]);
            if *name != "rockproof.manifest.json" {
                place.refuses(&resume, &["--overwrite"]);
                fs::remove_file(&file).expect("removed");
                place.refuses(&resume, &[name]);
            }
            fs::write(&file, whole).expect("write");
        }
        place.works(&resume);
    }
}

/// A library in front of the program's own takes the file system's locks away, as some network file systems have none.
#[cfg(target_os = "linux")]
#[test]
fn a_file_system_without_locks_is_told_once_a_directory() {
    let place = WorkDir::new();
    let (source, library) = (place.at("flock.c"), place.at("flock.so"));
    let without =
        "#include <errno.h>\nint flock(int file, int how) { (void)file, (void)how; errno = ENOSYS; return -1; }\n";
    fs::write(&source, without).expect("write");
    let made = std::process::Command::new("cc").args(["-shared", "-fPIC", "-o"]).args([&library, &source]).status();
    assert!(made.expect("a C compiler").success());
    // The gate works in two directories.
    let gate = "corpus = []\nrotating_pairs = 8\n[campaign]\npairs = 8\nfamilies = [\"edge_cross\"]\n\
                [[limit]]\ncause = \"defect\"\ncount = 0\n";
    fs::write(place.at("gate.toml"), gate).expect("write");
    let run = |more: &[&str]| {
        let mut command = Command::cargo_bin("rockproof").expect("the program");
        command.env("LD_PRELOAD", &library).current_dir(place.0.path()).args(["gate", "gate.toml", "--out", "out"]);
        let output = command.args(more).output().expect("runs");
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (code, err) = run(&[]);
    assert_eq!(code, Some(0), "{err}");
    for dir in ["out/fixed", "out/rotating"] {
        let told = format!("note: {dir}: this file system has no locks, so nothing keeps a second process out");
        assert_eq!(err.matches(&told).count(), 1, "{err}");
    }
    assert_eq!(run(&["--quiet"]), (Some(0), String::new()));
    let (code, err) = place.run(&["gate", "gate.toml", "--out", "out"]);
    assert!(code == 0 && !err.contains("no locks"), "{err}");
}

#[test]
fn progress_beyond_the_plan_is_refused() {
    let place = WorkDir::new();
    let campaign = [&SLIVERS[..], &["--out", "run"]].concat();
    place.works(&campaign);
    let file = place.at("run/progress.json");
    let text = fs::read_to_string(&file).expect("progress");
    let (body, _) = text.rsplit_once(",\"sha256\":").expect("a seal");
    let body = body.replace("\"pairs_done\":192", &format!("\"pairs_done\":{}", u64::MAX));
    // Whoever can make a seal is believed no more.
    let seal = rockproof_results::digest(body.as_bytes());
    fs::write(&file, format!("{body},\"sha256\":\"{seal}\"}}\n")).expect("write");
    let resume = [&campaign[..], &["--resume"]].concat();
    place.refuses(&resume, &["progress.json", "18446744073709551615 pairs are done", "192"]);
}

#[test]
fn a_grid_over_six_tolerances_has_files_of_bounded_names() {
    let place = WorkDir::new();
    let factor = "[\"1234567890123456789/1234567890123456790\"]";
    let axes = ["search", "territory", "penetration", "overlap_sine", "parallel_sine", "equal"];
    let grid: String = axes.iter().map(|axis| format!("{axis} = {factor}\n")).collect();
    let text = format!(
        "pairs = 192\nfamilies = [\"sliver\"]\ntolerances = []\nshrink_evaluations = 0\n[grid]\nbase = \"auto\"\n{grid}"
    );
    fs::write(place.at("grid.toml"), text).expect("write");
    place.works(&["campaign", "grid.toml", "--out", "run"]);
    let cases: Vec<String> = fs::read_dir(place.at("run/cases"))
        .expect("cases")
        .map(|entry| entry.expect("a case").file_name().to_string_lossy().into_owned())
        .collect();
    assert!(cases.iter().any(|name| name.len() > 120), "{cases:?}");
    assert!(cases.iter().all(|name| name.len() <= 125), "{cases:?}");
    let case = format!("run/cases/{}", cases[0]);
    place.works(&["replay", &case]);
    place.works(&["campaign", "grid.toml", "--out", "run", "--resume"]);
}
