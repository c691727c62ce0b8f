//! Files and names by others: each message names its file and says a thing once, values are checked and cut, nothing is a command to a
//! terminal, a runner or a spreadsheet, no device is read to its end, and no file outside a run is opened.

use crate::gates::gate;
use crate::lockstep_cli::SLIDER;
use crate::place::rockproof_in;
use assert_cmd::Command;
use std::fs;
use std::path::Path;

pub(crate) const CASE: &str = include_str!("../../cases/regressions/f-v-arithmetic-vertex-face-depth.toml");
const CUBES: &str = include_str!("../fixtures/two_cubes.obj");

/// The arguments are refused, and the message holds each of the parts once.
pub(crate) fn refused(dir: &Path, arguments: &[&str], parts: &[&str]) {
    let (code, out, err) = rockproof_in(dir, arguments);
    assert_eq!(code, 2, "{arguments:?}: {out}{err}");
    for part in parts {
        assert_eq!(err.matches(part).count(), 1, "{arguments:?}: {part} once in {err}");
    }
    let clean = !err.contains("panicked") && err.len() < 2000 && !err.contains(|c: char| c.is_control() && c != '\n');
    assert!(clean, "{arguments:?}: {err:?}");
}

/// `text` with one thing changed, which must be there.
pub(crate) fn change(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "{from}");
    text.replacen(from, to, 1)
}

#[test]
fn cases_are_checked_as_scenes_are() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let long = "x".repeat(100_000);
    for (from, to, parts) in [
        ("search = 0.0", "search = -1", vec!["`search` is -1", "0 or more"]),
        ("overlap_sine = 0.0", "overlap_sine = 7", vec!["`overlap_sine` is 7", "0 to 1"]),
        ("parallel_sine = 0.0", "parallel_sine = \"11/10\"", vec!["`parallel_sine`", "0 to 1"]),
        ("engine = \"stepper-f32\"", "engine = \"abacus\"", vec!["engine is \"abacus\"", "--engine-command"]),
        (
            "engine = \"stepper-f32\"",
            "engine = \"a\\u001b[31m\\n::error::b\"",
            vec!["engine is \"a\\u{1b}[31m\\n::error::b\""],
        ),
        ("cause = \"arithmetic\"", &format!("cause = \"{long}\""), vec!["cause is \"xxx", "…"]),
        ("margin = -0.0000000006835666174770334", "margin = nan", vec!["margin is \"NaN\"", "finite"]),
        ("margin_ulps = -0.011468344791801564", "margin_ulps = inf", vec!["margin_ulps is \"inf\"", "finite"]),
        (
            "origin = \"",
            "found_state = \"far\"\norigin = \"",
            vec!["found_state is \"far\"", "apart, touching and overlapping"],
        ),
        (
            "origin = \"",
            "found_state = \"apart\"\norigin = \"",
            vec!["found_state is \"apart\"", "none without states"],
        ),
        ("origin = \"", "check = \"mirror\"\norigin = \"", vec!["check is \"mirror\"", "swap, renumber"]),
        (
            "origin = \"",
            "check = \"swap\"\norigin = \"",
            vec!["change is \"extra\"", "allowed are failure, crash, timeout"],
        ),
        ("cause = \"arithmetic\"", "cause = \"toler\"", vec!["case.toml:3: cause is \"toler\""]),
        ("kind = \"f-v\"", "kind = \"v-q\"", vec!["case.toml:12: a contact of", "is \"v-q 0/0 by ", ", gap sign "]),
        ("gap_sign = ", "gap_sign = 5 # ", vec!["case.toml:12: a contact of", ", gap sign 5\""]),
        (
            "feature_a = 0",
            "feature_a = 99",
            vec!["case.toml:12:", "f-v 99/0", "the vertices, edges and faces of the two blocks"],
        ),
        ("entrance_b = 0", "entrance_b = 4", vec!["the vertices, edges and faces of the two blocks"]),
    ] {
        fs::write(dir.join("case.toml"), change(CASE, from, to)).expect("write");
        for command in ["replay", "shrink"] {
            refused(dir, &[command, "case.toml"], &[&["case.toml:"][..], &parts].concat());
        }
    }
    fs::write(dir.join("case.toml"), change(CASE, "origin = \"", "origin = \"\\u001b[31m\\n::error::b"))
        .expect("write");
    let (code, out, err) = rockproof_in(dir, &["replay", "case.toml"]);
    assert!(code == 0 && out.contains("from \\u{1b}[31m\\n::error::b"), "{out}{err}");
    assert!(!out.contains('\u{1b}'), "{out:?}");
}

#[test]
fn state_files_are_checked_and_open_no_other_file() {
    let dir = crate::place::folder();
    let dir = dir.path();
    // A lockstep run that leaves a state file, and the scene's measured point with a name that is a formula.
    let scene = change(&change(SLIDER, "steps = 4", "steps = 2"), "\"centre\"", "\"=1+1\"");
    fs::write(dir.join("slider.toml"), scene).expect("write");
    let (code, out, err) =
        rockproof_in(dir, &["simulate", "slider.toml", "--engine", "f32", "--lockstep", "--out", "run"]);
    assert_eq!(code, 0, "{out}{err}");
    let measured = fs::read_to_string(dir.join("run/measured.csv")).expect("a table");
    assert!(measured.contains(",'=1+1,"), "no spreadsheet calculates it: {measured}");
    let (code, out, err) =
        rockproof_in(dir, &["simulate", "slider.toml", "--engine", "exact", "--steps", "1", "--out", "exact"]);
    assert_eq!(code, 0, "{out}{err}");
    let measured = fs::read_to_string(dir.join("exact/measured.csv")).expect("a table");
    assert!(measured.contains(",'=1+1,"), "no spreadsheet calculates it: {measured}");
    let state = fs::read_dir(dir.join("run/states")).expect("states").next().expect("a state").expect("a file");
    let text = fs::read_to_string(state.path()).expect("a state");
    let value: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let with = |place: &[&str], to: serde_json::Value| {
        let mut changed = value.clone();
        *place.iter().fold(&mut changed, |value, key| &mut value[*key]) = to;
        fs::write(dir.join("state.json"), changed.to_string()).expect("write");
    };
    with(&["step"], value["step"].clone());
    assert_eq!(rockproof_in(dir, &["replay", "state.json"]).0, 0, "unchanged");
    let scene = value["scene"].as_str().expect("a scene");
    fs::write(dir.join("secret.obj"), CUBES).expect("write");
    let outside = format!("{scene}\n[[block]]\nfile = \"secret.obj\"\n");
    let negative = change(scene, "search = ", "search = -1 # ");
    for (place, to, part) in [
        (&["engine"][..], "f16".into(), "`f16` is no engine"),
        (&["state", "time"], "NaN".into(), "not finite"),
        (&["state", "time"], (-1.0).into(), "0 or more"),
        (&["state", "last_time_step"], 0.0.into(), "more than 0"),
        (&["state", "step"], u64::MAX.into(), "2^53"),
        (&["step"], i64::MIN.into(), "step = -9223372036854775808"),
        (&["scene"], outside.into(), "names a `file`"),
        (&["scene"], negative.into(), "0 or more"),
        (&["format"], "\u{1b}[31m".into(), "\\u{1b}[31m"),
    ] {
        with(place, to);
        refused(dir, &["replay", "state.json"], &["state.json:", part]);
    }
}

#[test]
fn messages_name_their_file_and_say_things_once() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let write = |name: &str, text: &str| fs::write(dir.join(name), text).expect("write");
    write("two.obj", CUBES);
    write("few.toml", "search = 1\n");
    write("large.toml", "preset = \"auto\"\nsearch = 1e39\n");
    write("big.obj", &CUBES.replace("v 1 ", "v 1e39 "));
    for (name, text, part) in [
        ("engines.toml", "engines = [\"abacus\"]\n", "\"abacus\""),
        ("families.toml", "families = [\"pyramids\"]\n", "\"pyramids\""),
        ("sets.toml", "tolerances = [\"loose\"]\n", "\"loose\""),
        ("keys.toml", "pears = 3\n", "\"pears\""),
        ("pairs.toml", "pairs = 0\n", "pairs is 0"),
        ("nobody.toml", "engines = []\n", "no engine is named"),
        ("scale.toml", "scale = 0\n", "scale is 0; allowed is above 0"),
        ("weld.toml", "weld = -1\n", "weld is -1; allowed is 0 or more"),
        ("planarity.toml", "planarity = -1\n", "planarity is -1; allowed is 0 or more"),
        ("stress.toml", "stress = true\nfamilies = [\"sliver\"]\n", "no families"),
        ("dumb.toml", "engines = [\"mine\"]\n[[external]]\nname = \"mine\"\ncommand = \"true\"\n", "does not answer"),
        ("none.toml", "[[external]]\nname = \"f32\"\ncommand = \"x\"\n", "\"f32\":"),
    ] {
        write(name, text);
        let place = format!("error: {name}");
        let (code, _, err) = rockproof_in(dir, &["campaign", name, "--out", "unused"]);
        assert!(code == 2 && err.starts_with(&place) && err.contains(part), "{name}: {err}");
    }
    refused(dir, &["classify", "two.obj", "--tolerances", "few.toml"], &["two.obj", "few.toml", "no preset is named"]);
    refused(dir, &["check", "two.obj", "--tolerances", "few.toml"], &["few.toml", "no preset is named"]);
    refused(dir, &["tune", "two.obj", "--tolerances", "few.toml"], &["few.toml", "no preset is named"]);
    for arguments in [
        &["classify", "two.obj", "--engine", "f32", "--tolerances", "large.toml"][..],
        &["check", "two.obj", "--precision", "f32", "--tolerances", "large.toml"],
        &["tune", "two.obj", "--engine", "f32", "--tolerances", "large.toml", "--candidates", "1"],
        &["simulate", "two.obj", "--engine", "f32", "--tolerances", "large.toml", "--steps", "1", "--out", "unused"],
    ] {
        refused(dir, arguments, &["two.obj", "large.toml", "overflows"]);
    }
    refused(dir, &["classify", "big.obj", "--engine", "f32"], &["big.obj: block 0", "overflows"]);
    for arguments in
        [&["replay", "gone.toml"][..], &["replay", "gone.json"], &["campaign", "gone.toml"], &["gate", "gone.toml"]]
    {
        refused(dir, arguments, &["No such file", "gone."]);
    }
    for command in ["campaign", "gate", "tune"] {
        refused(dir, &[command, "two.obj", "--threads", "1025"], &["1 to 1024"]);
    }
}

#[test]
fn the_environment_asks_for_no_more_threads_than_an_option() {
    for name in ["RAYON_NUM_THREADS", "RAYON_RS_NUM_CPUS"] {
        let told = |number: &str| {
            let mut command = Command::cargo_bin("rockproof").expect("the program");
            let output = command.args(["replay", "gone.toml"]).env(name, number).output().expect("runs");
            assert_eq!(output.status.code(), Some(2));
            String::from_utf8_lossy(&output.stderr).contains(&format!("{name} is {number}; allowed are 1 to 1024"))
        };
        assert_eq!(["1024", "1025", "many", ""].map(told), [false, true, false, false]);
    }
}

/// Tables of campaigns hold the names of sets as they are, so no set has one that a spreadsheet calculates.
#[test]
fn no_set_is_called_like_a_formula() {
    let dir = crate::place::folder();
    let dir = dir.path();
    for stem in ["=1+1", "+x", "-2", "@SUM(A1)"] {
        let name = format!("{stem}.toml");
        fs::write(dir.join(&name), "preset = \"auto\"\n").expect("write");
        fs::write(dir.join("settings.toml"), format!("pairs = 16\ntolerances = [\"{name}\"]\n")).expect("write");
        let parts = [&format!("{name}: in tables its set"), "at the beginning", "rename the file"];
        refused(dir, &["campaign", "settings.toml", "--out", "run"], &parts);
        let inline = format!("--tolerances={name}");
        refused(dir, &["campaign", "--pairs", "16", &inline, "--out", "run"], &parts);
        refused(dir, &["campaign", "--stress", "--pairs", "16", &inline, "--out", "run"], &parts);
        let ran = gate(dir, &format!("corpus = []\n[campaign]\npairs = 16\ntolerances = [\"{name}\"]\n"), &[], false);
        assert!(ran.code == 2 && ran.err.contains(parts[0]), "{name}: {}", ran.err);
    }
    // Called as a set is, it is told so, and not of spreadsheets.
    fs::write(dir.join("auto.toml"), "preset = \"auto\"\n").expect("write");
    let parts = ["auto.toml: \"auto\" is a tolerance set of its own", "rename the file"];
    refused(dir, &["campaign", "--pairs", "16", "--tolerances=auto.toml", "--out", "run"], &parts);
    assert!(!dir.join("run").exists(), "nothing is written");
}

/// Whatever is long in a file of settings, a gate, a baseline or a case, its message is short and says what is wrong and what is allowed.
#[test]
fn messages_cut_long_values() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let long = "x".repeat(100_000);
    let write = |name: &str, text: &str| fs::write(dir.join(name), text).expect("write");
    let short = |arguments: &[&str], parts: &[&str]| {
        let (code, out, err) = rockproof_in(dir, arguments);
        assert_eq!(code, 2, "{parts:?}: {} bytes", out.len() + err.len());
        assert!(err.len() < 4000, "{parts:?}: {} bytes", err.len());
        for part in parts {
            assert!(err.contains(part), "{part} in {err}");
        }
        assert!(err.contains('…'), "{err}");
    };
    let external = format!("[[external]]\nname = \"a\"\ncommand = \"x\"\n[[external]]\nname = \"{long}");
    for (text, parts) in [
        (format!("families = [\"{long}\"]"), ["family \"xxx", "…\" does not exist; there are "]),
        (format!("tolerances = [\"{long}\"]"), ["tolerance set \"xxx", "…\" does not exist; there are auto"]),
        (format!("engines = [\"{long}\"]"), ["engine \"xxx", "…\" does not exist; there are stepper-f32"]),
        (format!("[grid]\nbase = \"{long}\""), ["base \"xxx", "…\" is no tolerance set; there are auto"]),
        (format!("{external} \"\ncommand = \"x\""), ["engine name \"xxx", "…\": allowed are letters"]),
        (format!("{external}\"\ncommand = \"'{long}\""), ["line 6", "a quote is not closed"]),
        (format!("{long} = 1"), ["line 1", "is no key here; allowed are"]),
        (format!("\"{}\" = 1", "y\\n".repeat(50_000)), ["line 1", "is no key here; allowed are"]),
        (format!("pairs = \"{long}\""), ["line 1: pairs is \"xxx", "allowed is a whole number from 0"]),
    ] {
        write("settings.toml", &text);
        short(&["campaign", "settings.toml", "--out", "unused"], &[&["settings.toml line "][..], &parts].concat());
    }
    let around = |text: &str| format!("corpus = []\n[campaign]\npairs = 16\n{text}");
    for (text, parts) in [
        (around(&format!("families = [\"{long}\"]")), ["family \"xxx", "there are "]),
        (around(&format!("[[limit]]\ncount = 0\nengine = \"{long}\"")), ["line 4: engine is \"xxx", "allowed are any"]),
        (around(&format!("[[limit]]\ncount = 0\ncause = \"{long}\"")), ["line 4: cause is \"xxx", "allowed are "]),
        (around(&format!("[[limit]]\ncount = 0\nfamily = \"{long}\"")), ["line 4: family \"xxx", "there are "]),
        (
            around(&format!("[baseline]\nfile = \"k.toml\"\nfields = [\"{long}\"]")),
            ["line 6: baseline.fields has \"xxx", "allowed are family"],
        ),
        (around(&format!("[[limit]]\n{long} = 0")), ["line 5: \"xxx", "\" is no key here; allowed are engine, "]),
        (around("[baseline]\nfile = \"known.toml\""), ["known.toml line 1: \"xxx", "is no key here"]),
    ] {
        write("known.toml", &format!("{long} = 1\n"));
        write("gate.toml", &text);
        short(&["gate", "gate.toml"], &parts);
    }
    for (from, to, parts) in [
        ("[case]", format!("[case]\n{long} = 1"), ["line 2", "expected one of"]),
        ("engine = \"stepper-f32\"", format!("engine = {{ {long} = 1 }}"), ["line 2", "expected a string"]),
        ("kind = \"f-v\"", format!("kind = \"{long}\""), ["expected, found or changed is \"", "allowed are kinds v-v"]),
    ] {
        write("case.toml", &change(CASE, from, &to));
        for command in ["replay", "shrink"] {
            short(&[command, "case.toml"], &[&["case.toml:"][..], &parts].concat());
        }
    }
}

#[cfg(unix)]
#[test]
fn no_device_is_read_to_its_end() {
    let dir = crate::place::folder();
    let dir = dir.path();
    for name in ["zeros.toml", "zeros.json"] {
        std::os::unix::fs::symlink("/dev/zero", dir.join(name)).expect("a link");
    }
    let gates = "corpus = [\"zeros.toml\"]\n";
    for (arguments, gate_text) in [
        (&["campaign", "zeros.toml"][..], ""),
        (&["gate", "zeros.toml"], ""),
        (&["replay", "zeros.toml"], ""),
        (&["replay", "zeros.json"], ""),
        (&["shrink", "zeros.toml"], ""),
        (&["gate", "gate.toml"], gates),
        (&["gate", "gate.toml"], "corpus = []\n[baseline]\nfile = \"zeros.toml\"\n"),
    ] {
        fs::write(dir.join("gate.toml"), gate_text).expect("write");
        refused(dir, arguments, &["this is a device", "zeros."]);
    }
    let link = |run: &str, name: &str| {
        fs::create_dir_all(dir.join(run)).expect("a folder");
        std::os::unix::fs::symlink("/dev/zero", dir.join(run).join(name)).expect("a link");
    };
    link("run", "rockproof.manifest.json");
    refused(dir, &["campaign", "--pairs", "1", "--out", "run"], &["not a file"]);
    fs::create_dir_all(dir.join("made")).expect("a folder");
    fs::write(dir.join("made/findings.csv"), "").expect("write");
    link("made", "run.json");
    refused(dir, &["report", "made"], &["run.json: this is a folder, a device or a pipe"]);
}

#[test]
fn a_report_reads_nothing_outside_of_the_run() {
    let dir = crate::place::folder();
    let dir = dir.path();
    let (code, _, err) = rockproof_in(
        dir,
        &["campaign", "--pairs", "64", "--family", "face_stack", "--steps-every", "0", "--out", "run"],
    );
    assert_eq!(code, 0, "{err}");
    fs::write(dir.join("secret.toml"), CASE).expect("write");
    let table = fs::read_to_string(dir.join("run/findings.csv")).expect("findings");
    let with = |to: &str| {
        let line = |line: &str| line.rsplit_once(",cases/").map_or(line.to_owned(), |(row, _)| format!("{row},{to}"));
        let changed: Vec<String> = table.lines().map(line).collect();
        fs::write(dir.join("run/findings.csv"), changed.join("\n") + "\n").expect("write");
    };
    let absolute = dir.join("secret.toml").display().to_string();
    for outside in ["../secret.toml", "cases/../../secret.toml", &absolute] {
        with(outside);
        refused(dir, &["report", "run", "--out", "page"], &["findings.csv: line", "in the directory of the run"]);
    }
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("../../secret.toml", dir.join("run/cases/link.toml")).expect("a link");
        with("cases/link.toml");
        refused(dir, &["report", "run", "--out", "page"], &["link.toml", "outside of the run"]);
    }
    fs::write(dir.join("run/findings.csv"), &table).expect("write");
    assert_eq!(rockproof_in(dir, &["report", "run", "--out", "page"]).0, 0, "unchanged");
}

#[cfg(unix)]
#[test]
fn the_name_of_a_case_is_no_command_to_the_runner() {
    let dir = crate::place::folder();
    let dir = dir.path();
    fs::create_dir(dir.join("corpus")).expect("a folder");
    let expected = "expected = [{ kind = \"v-v\", feature_a = 0, feature_b = 0, entrance = \"v-f\", entrance_a = 0, entrance_b = 0, gap_sign = 1 }]";
    let name = "a\n::error title=planted::b \u{1b}[31m##[error]c.toml";
    fs::write(dir.join("corpus").join(name), change(CASE, "expected = []", expected)).expect("write");
    let ran = gate(dir, "corpus = [\"corpus\"]\n[campaign]\npairs = 16\n", &[], true);
    assert_eq!(ran.code, 1, "{}{}", ran.out, ran.err);
    let text = format!("{}{}", ran.out, ran.err);
    let commands: Vec<&str> = text.lines().filter(|line| line.trim_start().starts_with("::")).collect();
    assert!(
        commands.len() == 1 && commands[0].starts_with("::error file=corpus/a%0A%3A%3Aerror title=planted"),
        "{text}"
    );
    assert!(text.contains("corpus/a\\n::error title=planted"), "{text}");
    assert!(commands[0].contains("\\u{1b}[31m") && !text.contains('\u{1b}'), "nor one to a terminal: {text:?}");
    // A broken one is told of as well.
    fs::write(dir.join("corpus").join(name), "[case]\n\"b\\n::error title=planted::c\" = 1\n").expect("write");
    let ran = gate(dir, "corpus = [\"corpus\"]\n[campaign]\npairs = 16\n", &[], true);
    assert_eq!(ran.code, 2, "{}{}", ran.out, ran.err);
    assert!(!ran.err.lines().any(|line| line.trim_start().starts_with("::")), "{}", ran.err);
    assert!(!ran.err.contains("##["), "{}", ran.err);
}
