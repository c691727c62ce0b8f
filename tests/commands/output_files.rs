//! Files that a command is told to write: one that is there already is replaced only where that is allowed, and named where it is not.

use crate::place::Place;
use std::fs;

const CASE: &str = include_str!("../../cases/regressions/v-e-arithmetic-foot-region.toml");

#[test]
fn shrink_replaces_its_own_case_and_other_files_where_that_is_said() {
    let place = Place::new();
    place.file("case.toml", CASE);
    place.file("notes.txt", "mine");
    let to_notes = ["shrink", "case.toml", "--evaluations", "20", "--out", "notes.txt"];
    let (code, _, err) = place.run(&to_notes);
    assert!(code == 2 && err.contains("notes.txt: it is there already; --overwrite replaces it"), "{err}");
    assert_eq!(place.read("notes.txt"), "mine");
    let (code, _, err) = place.run(&[&to_notes[..], &["--overwrite"]].concat());
    assert_eq!(code, 0, "{err}");
    assert!(place.read("notes.txt").starts_with("[case]"));
    assert_eq!(place.read("case.toml"), CASE);
    // The case itself is what it makes smaller, if it is one.
    let (code, _, err) = place.run(&["shrink", "case.toml", "--evaluations", "20"]);
    assert_eq!(code, 0, "{err}");
    assert_eq!(place.read("case.toml"), place.read("notes.txt"));
    place.file("scene.toml", "[[block]]\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\n");
    let before = place.read("scene.toml");
    let (code, _, err) = place.run(&["shrink", "scene.toml"]);
    assert!(code == 2 && err.contains("scene.toml"), "{err}");
    assert_eq!(place.read("scene.toml"), before);
}

/// Every command that writes a directory of results: what is no directory is named, and nothing is written.
#[test]
fn a_directory_whose_name_a_file_has_is_refused_and_the_file_stays() {
    let place = Place::new();
    place.file("taken", "mine");
    place.file(
        "scene.toml",
        "[[block]]\nfixed = true\nbox = { min = [0, 0, 0], max = [3, 3, 1] }\n\
         [[block]]\nbox = { min = [1, 1, 1], max = [2, 2, 2] }\n",
    );
    let campaign = "pairs = 16\nfamilies = [\"face_stack\"]\n";
    place.file("settings.toml", campaign);
    place.file("gate.toml", &format!("corpus = []\n[campaign]\n{campaign}[[limit]]\ncause = \"defect\"\ncount = 0\n"));
    let (code, _, err) = place.run(&["campaign", "settings.toml", "--part", "1/1", "--out", "part"]);
    assert_eq!(code, 0, "{err}");
    let commands: [&[&str]; 10] = [
        &["campaign", "settings.toml"],
        &["campaign", "settings.toml", "--resume"],
        &["campaign", "--stress"],
        &["merge", "part"],
        &["report", "part"],
        &["gate", "gate.toml"],
        &["bench", "--error"],
        &["simulate", "scene.toml", "--steps", "1"],
        &["simulate", "scene.toml", "--steps", "1", "--resume"],
        &["tune", "scene.toml", "--candidates", "1", "--resume"],
    ];
    let examine: &[&str] = &["examine", "scene.toml", "--overwrite"];
    let before = fs::read_dir(place.path(".")).expect("a folder").count();
    for command in commands.into_iter().chain([examine]) {
        for out in ["taken", "taken/run"] {
            let (code, printed, err) = place.run(&[command, &["--out", out]].concat());
            let told =
                format!("taken is no directory, so no results can be written to {out}; --out DIR writes elsewhere\n");
            assert!(code == 2 && printed.is_empty() && err.contains(&told), "{command:?}: {code} {printed}{err}");
            assert!(!err.contains("os error"), "{command:?}: {err}");
        }
    }
    assert_eq!(place.read("taken"), "mine");
    assert_eq!(fs::read_dir(place.path(".")).expect("a folder").count(), before);
}

#[test]
fn a_gate_replaces_its_own_junit_report_alone() {
    let place = Place::new();
    let gate =
        "corpus = []\n[campaign]\npairs = 16\nfamilies = [\"face_stack\"]\n[[limit]]\ncause = \"defect\"\ncount = 0\n";
    place.file("gate.toml", gate);
    let gate = |junit: &str| place.run(&["gate", "gate.toml", "--junit", junit]);
    let theirs = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"unit tests\" tests=\"0\"/>\n";
    for (name, text) in [("theirs.xml", theirs), ("notes.txt", "mine"), ("empty.xml", "")] {
        place.file(name, text);
        let (code, _, err) = gate(name);
        assert!(code == 2 && err.contains(&format!("{name}: it is there already and no JUnit report")), "{err}");
        assert_eq!(place.read(name), text);
    }
    fs::write(place.path("picture.png"), [0x89, 0x50, 0xff]).expect("write");
    let (code, _, err) = gate("picture.png");
    assert!(code == 2 && err.contains("picture.png"), "{err}");
    let (code, _, err) = gate("gate.toml");
    assert!(code == 2 && err.contains("gate.toml"), "{err}");
    assert!(!place.path("reports").exists(), "it is said before the work begins");
    for _ in 0..2 {
        let (code, _, err) = gate("junit.xml");
        assert_eq!(code, 0, "{err}");
        assert!(place.read("junit.xml").contains("<testsuites name=\"rockproof gate\""));
    }
}

#[test]
fn a_gate_writes_its_baseline_over_no_other_file() {
    let place = Place::new();
    for text in ["mine = true\n", "", "[[block]]\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\n"] {
        place.file("known.toml", text);
        place.file("gate.toml", "corpus = []\n[campaign]\npairs = 16\n[baseline]\nfile = \"known.toml\"\n");
        let (code, _, err) = place.run(&["gate", "gate.toml", "--update-baseline"]);
        assert!(code == 2 && err.contains("known.toml is no baseline"), "{err}");
        assert!(place.read("known.toml") == text && !place.path("reports").exists());
    }
}

#[test]
fn man_replaces_pages_of_this_program_alone() {
    let place = Place::new();
    let (code, _, err) = place.run(&["man", "man1"]);
    assert_eq!(code, 0, "{err}");
    let page = place.read("man1/rockproof-campaign.1");
    place.file("man1/rockproof-campaign.1", &page.replace("campaign", "companion"));
    place.file("man1/mine.1", "mine");
    let (code, _, err) = place.run(&["man", "man1"]);
    assert_eq!(code, 0, "{err}");
    assert!(place.read("man1/rockproof-campaign.1") == page && place.read("man1/mine.1") == "mine");
    place.file("man1/rockproof-tune.1", "mine");
    fs::remove_file(place.path("man1/rockproof-check.1")).expect("a page");
    let (code, _, err) = place.run(&["man", "man1"]);
    assert!(code == 2 && err.contains("rockproof-tune.1: it is there already and no manual page"), "{err}");
    assert_eq!(place.read("man1/rockproof-tune.1"), "mine");
    assert!(!place.path("man1/rockproof-check.1").exists(), "nothing is written then");
}
