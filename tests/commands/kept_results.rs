//! Nothing is lost: a campaign that is killed, interrupted within a chunk, or out of room on its disk goes on to the bytes of one that was never
//! disturbed.
#![cfg(target_os = "linux")]

use crate::campaigns;
use crate::engines::client;
use crate::processes::{signal, until};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

const SETTINGS: &str = "pairs = 256\nchunk = 32\nfamilies = [\"face_stack\", \"edge_cross\"]\nsteps_every = 0\n";

fn program() -> std::path::PathBuf {
    assert_cmd::cargo::cargo_bin("rockproof")
}

fn campaign(dir: &Path, out: &str, more: &[&str]) -> Command {
    let mut command = Command::new(program());
    command.current_dir(dir).args(["campaign", "settings.toml", "--out", out]).args(more);
    command.stdout(Stdio::null()).stderr(Stdio::null());
    command
}

/// Every file of a run that depends on its settings alone.
fn files(run: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = campaigns::files(run, "");
    // Times, and what depends on them.
    let own = ["run.json", "progress.json", "rockproof.manifest.json"];
    found.retain(|name, _| !own.contains(&name.as_str()));
    found
}

/// Waits for the first chunks of a run.
fn begun(run: &Path) {
    let size = || fs::metadata(run.join("findings.csv")).map_or(0, |about| about.len());
    until("nothing was found", || size() >= 4096);
}

#[test]
#[ignore = "ten seconds; .ci/run runs it"]
fn killed_interrupted_and_out_of_room_it_goes_on_to_the_same_bytes() {
    let dir = crate::place::folder();
    let dir = dir.path();
    fs::write(dir.join("settings.toml"), SETTINGS).expect("write");
    assert!(campaign(dir, "whole", &[]).status().expect("runs").success());
    let whole = files(&dir.join("whole"));
    assert!(whole.contains_key("findings.csv") && whole.len() > 6, "{:?}", whole.keys());
    let goes_on = |run: &str| {
        assert!(campaign(dir, run, &["--resume"]).status().expect("runs").success(), "{run}");
        let found = files(&dir.join(run));
        assert!(found.keys().eq(whole.keys()), "{run}: {:?}", found.keys());
        for (name, bytes) in &whole {
            assert!(found[name] == *bytes, "{run}: {name}");
        }
    };

    for (run, name) in [("killed", "KILL"), ("interrupted", "INT")] {
        let mut child = campaign(dir, run, &[]).spawn().expect("starts");
        begun(&dir.join(run));
        signal(&child, name);
        let code = child.wait().expect("ends").code();
        assert!(code == if name == "INT" { Some(130) } else { None } || code == Some(0), "{run}: {code:?}");
        goes_on(run);
    }

    // No file may grow beyond three quarters of what the largest needs at the end: writing fails as on a full disk, midway.
    let blocks = fs::metadata(dir.join("whole/progress.json")).expect("the place").len() * 3 / 4 / 512;
    let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" campaign settings.toml --out full");
    let output: Output =
        Command::new("sh").current_dir(dir).args(["-c", &script]).arg(program()).output().expect("runs");
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(2) && told.contains("full/") && told.contains("too large"), "{told}");
    goes_on("full");
}

/// Takes the table of engines out of a run: questions asked, processes started and failures recovered of its one engine.
fn engine_counts(run: &mut BTreeMap<String, Vec<u8>>) -> [u64; 3] {
    let table = String::from_utf8(run.remove("engines.csv").expect("a table of engines")).expect("text");
    let (head, row) = table.trim_end().split_once('\n').expect("a row");
    assert!(
        head.starts_with(
            "engine,asked,processes_started,recovered,not_compared,first_failures,contacts,entrances,gap_m,apart,"
        ),
        "{head}"
    );
    let counts: Vec<u64> = row.split(',').skip(1).take(4).map(|count| count.parse().expect("a count")).collect();
    [counts[0], counts[1], counts[2]]
}

#[test]
fn without_open_files_it_ends_and_goes_on() {
    let dir = crate::place::folder();
    let dir = dir.path();
    fs::write(dir.join("settings.toml"), format!("{SETTINGS}shrink_evaluations = 0\n")).expect("settings");
    for files in 4..=7 {
        let script = format!("ulimit -n {files}; exec \"$0\" campaign settings.toml --threads 1 --resume --out run");
        let mut shell = Command::new("timeout");
        let ended = shell.current_dir(dir).args(["20", "sh", "-c", &script]).arg(program()).output().expect("runs");
        let err = String::from_utf8_lossy(&ended.stderr);
        // So few are enough in the end.
        let told = ended.status.code() == Some(2) && err.contains("Too many open files");
        assert!(told || files > 4 && ended.status.success(), "{files}: {ended:?}");
    }
    let ended = campaign(dir, "run", &["--resume"]).output().expect("runs");
    assert!(ended.status.success(), "{ended:?}");
}

/// Case files are called after the engine among others, and no file system takes a name of more than 255 bytes.
#[test]
fn an_engine_may_have_a_name_of_300_characters() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let (name, command) = ("e".repeat(300), toml::Value::from(client()));
    let settings = format!(
        "engines = [\"{name}\"]\n{SETTINGS}shrink_evaluations = 0\n[[external]]\nname = \"{name}\"\ncommand = [{command}, \"none\"]\n"
    );
    fs::write(dir.join("settings.toml"), settings).expect("write");
    assert!(campaign(dir, "whole", &[]).status().expect("runs").success());
    let mut whole = files(&dir.join("whole"));
    let mut child = campaign(dir, "killed", &[]).spawn().expect("starts");
    begun(&dir.join("killed"));
    child.kill().expect("killed");
    child.wait().expect("ends");
    assert!(campaign(dir, "killed", &["--resume"]).status().expect("goes on").success());
    let mut resumed = files(&dir.join("killed"));
    // The session that went on starts a process of its own; nothing else may tell the two runs apart.
    let ([asked, started, recovered], after) = (engine_counts(&mut whole), engine_counts(&mut resumed));
    assert!(asked > 0 && recovered == 0, "{asked} questions, {recovered} recovered");
    assert!(after == [asked, started, recovered] || after == [asked, started + 1, recovered], "{after:?}");
    assert!(resumed.keys().eq(whole.keys()), "{:?}", resumed.keys());
    for (name, bytes) in &whole {
        assert!(resumed[name] == *bytes, "{name}: the bytes of a run that was never disturbed");
    }
    for run in ["whole", "killed"] {
        let names = [dir.join(run), dir.join(run).join("cases")]
            .into_iter()
            .flat_map(|folder| fs::read_dir(folder).expect("a folder"))
            .map(|entry| entry.expect("an entry").file_name());
        assert!(names.into_iter().all(|name| name.len() <= 255), "{run}");
    }
    let about = whole.iter().filter(|(name, _)| name.starts_with("cases/") && name.contains("eeeeeeee"));
    assert!(about.count() > 0, "cases about the engine: {:?}", whole.keys());
    let rows = String::from_utf8(whole["findings.csv"].clone()).expect("a table");
    assert!(rows.contains(&format!(",{name},")), "tables have its name in full");
}
