//! A second Ctrl-C, or TERM or HUP, ends the program at once, whatever the first waits for: a step, a candidate, a pair. The first ends an exact run.
#![cfg(unix)]

use crate::place::Place;
use crate::processes::{begin, signal, until};
use std::fmt::Write;
use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// What each command works at does not end within this time after the first signal.
const WAITS: Duration = Duration::from_secs(3);
/// What "at once" may take on a busy machine; less than the first signal was waited for.
const AT_ONCE: Duration = Duration::from_secs(2);

/// Sends both signals to a command whose work takes much longer than the test.
fn ends_at_the_second(dir: &Path, command: &[&str], [first, second]: [&str; 2]) {
    let what = format!("{first} and {second} to {}", command.join(" "));
    let out = format!("out-{}-{second}", command[0]);
    let said = dir.join("said");
    let mut child = Command::new(assert_cmd::cargo::cargo_bin("rockproof"))
        .args(command)
        .args(["--out", &out])
        .current_dir(dir)
        .stdout(Stdio::null())
        .stderr(File::create(&said).expect("a file"))
        .spawn()
        .expect("starts");
    until(&what, || dir.join(&out).join("rockproof.manifest.json").exists());
    // `simulate` listens to signals a moment later.
    std::thread::sleep(Duration::from_secs(1));
    signal(&child, first);
    let told = || fs::read_to_string(&said).unwrap_or_default();
    until(&what, || told().contains("stopping in good order"));
    let waited = Instant::now();
    while waited.elapsed() < WAITS {
        assert!(
            child.try_wait().expect("a child").is_none(),
            "{what}: the first ended it, so the second shows nothing"
        );
        std::thread::sleep(Duration::from_millis(20));
    }
    let begin = Instant::now();
    signal(&child, second);
    let status = loop {
        if let Some(status) = child.try_wait().expect("a child") {
            break status;
        }
        if begin.elapsed() > AT_ONCE {
            child.kill().expect("a kill");
            child.wait().expect("an end");
            panic!("{what}: still runs {AT_ONCE:?} after the second");
        }
        std::thread::sleep(Duration::from_millis(5));
    };
    assert_eq!(status.code(), Some(130), "{what}: {}", told());
    assert!(told().contains("stopped at once"), "{what}: {}", told());
}

/// A floor, and cubes on it that touch each other: so many along it, across it and upwards.
fn cubes([along, across, up]: [u32; 3]) -> String {
    let mut scene = "[simulation]\ntime_step = 0.01\n[tolerances]\npreset = \"auto\"\n[[block]]\nfixed = true\n\
                     box = { min = [-1, -1, -1], max = [99, 99, 0] }\n"
        .to_owned();
    for (x, y, z) in (0..along).flat_map(|x| (0..across).flat_map(move |y| (0..up).map(move |z| (x, y, z)))) {
        let (x1, y1, z1) = (x + 1, y + 1, z + 1);
        writeln!(scene, "[[block]]\nbox = {{ min = [{x}, {y}, {z}], max = [{x1}, {y1}, {z1}] }}").expect("a string");
    }
    scene
}

#[test]
#[ignore = "twelve seconds; .ci/run runs it"]
fn a_second_signal_ends_the_program_at_once() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let campaign =
        "pairs = 64\nsteps_every = 1\nsteps = 100000\nfamilies = [\"face_stack\"]\ntolerances = [\"auto\"]\n";
    fs::write(dir.join("campaign.toml"), campaign).expect("write");
    fs::write(dir.join("bed.toml"), cubes([14, 14, 2])).expect("write");
    fs::write(dir.join("tower.toml"), cubes([1, 1, 40])).expect("write");
    ends_at_the_second(dir, &["campaign", "campaign.toml"], ["INT", "INT"]);
    let free = ["simulate", "bed.toml", "--free", "--steps", "1", "--force"];
    ends_at_the_second(dir, &free, ["TERM", "HUP"]);
    ends_at_the_second(dir, &["tune", "tower.toml", "--steps", "10000", "--candidates", "1"], ["INT", "TERM"]);
}

/// An exact step of 392 cubes takes much longer than the test, and nobody waits for it.
#[test]
fn an_exact_run_stops_within_a_step() {
    let place = Place::new();
    place.file("bed.toml", &cubes([14, 14, 2]));
    let arguments = ["simulate", "bed.toml", "--engine", "exact", "--steps", "1", "--force", "--out", "out"];
    let mut run = begin(&place.path("."), &arguments);
    until("the run begins", || place.path("out/rockproof.manifest.json").exists());
    // It listens to signals a moment later.
    std::thread::sleep(Duration::from_millis(500));
    let signalled = Instant::now();
    signal(&run, "TERM");
    let mut status = None;
    until("the run stops", || {
        status = run.try_wait().expect("a child");
        status.is_some() || signalled.elapsed() > Duration::from_secs(10)
    });
    if status.is_none() {
        run.kill().expect("a kill");
        run.wait().expect("an end");
    }
    assert_eq!(status.and_then(|status| status.code()), Some(130));
    let about: serde_json::Value = serde_json::from_str(&place.read("out/run.json")).expect("JSON");
    assert_eq!((&about["ending"], &about["steps"]), (&"interrupted".into(), &0.into()), "{about}");
}

/// The exact trajectory is kept in no checkpoint, so nobody is sent to `--resume`.
#[test]
fn an_interrupted_run_beside_the_exact_trajectory_does_not_promise_to_go_on() {
    let place = Place::new();
    place.file("slider.toml", crate::lockstep_cli::SLIDER);
    let run = |out: &str, mode: &[&str]| {
        let arguments = [&["simulate", "slider.toml", "--steps", "100000", "--out", out][..], mode].concat();
        let mut command = Command::new(env!("CARGO_BIN_EXE_rockproof"));
        command.current_dir(place.path(".")).args(arguments).stdout(Stdio::piped()).stderr(Stdio::null());
        let child = command.spawn().expect("starts");
        let table = place.path(out).join("steps.csv");
        until("steps are made", || {
            std::fs::read(&table).is_ok_and(|rows| rows.iter().filter(|b| **b == b'\n').count() > 2)
        });
        signal(&child, "INT");
        let ended = child.wait_with_output().expect("an end");
        assert_eq!(ended.status.code(), Some(130));
        String::from_utf8(ended.stdout).expect("text")
    };
    let out = run("free", &["--free"]);
    assert!(out.contains("\ninterrupted; what was done is kept, but --free cannot be resumed\n"), "{out}");
    assert!(run("plain", &[]).contains("\ninterrupted; --resume goes on\n"));
}
