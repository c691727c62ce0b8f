//! Pins `examine`: its answers about sound and unsound models, what it writes, and what it refuses.

use crate::place::Place;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

/// Two cubes on a fixed floor.
pub(crate) const SOUND: &str = r#"
[[block]]
name = "floor"
fixed = true
box = { min = [-1, -1, -1], max = [3, 3, 0] }
[[block]]
box = { min = [0, 0, 0], max = [1, 1, 1] }
[[block]]
box = { min = [1, 0, 0], max = [2, 1, 1] }
"#;

/// A cube of 10 cm at 50 m/s and a fixed plate of 5 cm: before and behind it at the ends of the second step.
const SHOT: &str = r#"
[simulation]
gravity = [0, 0, 0]
[tolerances]
preset = "auto"
max_displacement = 1
penetration = 0.01
[[block]]
name = "plate"
fixed = true
box = { min = [0.75, -1, -1], max = [0.8, 1, 1] }
[[block]]
motion = "rigid"
box = { min = [0, 0, 0], max = [0.1, 0.1, 0.1] }
velocity = [50, 0, 0]
"#;

/// Two cubes on a floor a kilometre from the origin, 10 µm apart: less than f32 resolves there.
const FAR_FROM_TIE: &str = r#"
[[block]]
fixed = true
box = { min = [999, -1, -1], max = [1003, 3, 0] }
[[block]]
box = { min = [1000, 0, 0], max = [1001, 1, 1] }
[[block]]
box = { min = ["100100001/100000", 0, 0], max = [1002, 1, 1] }
"#;

fn pairs_of(place: &Place, dir: &str) -> Vec<BTreeMap<String, String>> {
    place.rows(&format!("{dir}/pairs.csv"))
}

pub(crate) fn document_of(place: &Place, dir: &str) -> Value {
    serde_json::from_str(&place.read(&format!("{dir}/examine.json"))).expect("JSON")
}

/// Two cubes of a size one on the other, in OBJ.
fn stack(size: u32) -> String {
    let mut text = String::new();
    for block in 0..2 {
        text += &format!("o block{block}\n");
        for n in 0..8 {
            let [x, y, z] = [n & 1, n >> 1 & 1, block + (n >> 2 & 1)].map(|at| at * size);
            text += &format!("v {x} {y} {z}\n");
        }
        for [a, b, c, d] in [[1, 3, 4, 2], [1, 2, 6, 5], [1, 5, 7, 3], [2, 4, 8, 6], [3, 7, 8, 4], [5, 6, 8, 7]] {
            let [a, b, c, d] = [a, b, c, d].map(|v| v + 8 * block);
            text += &format!("f {a} {b} {c} {d}\n");
        }
    }
    text
}

#[test]
fn a_sound_model_is_safe_and_everything_about_it_is_written() {
    let place = Place::new();
    place.file("sound.toml", SOUND);
    let (code, out, err) = place.run(&["examine", "sound.toml", "--threads", "1"]);
    assert_eq!(code, 0, "{out}{err}");
    assert!(out.starts_with("safe: nothing is wrong with 3 neighbouring pairs under auto in f64\n"), "{out}");
    assert!(out.lines().count() <= 11, "the answer, nine lines and the next command: {out}");
    for told in ["3 blocks in 4 × 4 × 2 m", "all met by auto", "none in 3", "f64        0 of 3", "8 made", "next: "] {
        assert!(out.contains(told), "{told}: {out}");
    }
    let dir = "reports/examine-sound";
    let page = place.read(&format!("{dir}/index.html"));
    assert!(page.contains("nothing found (3)") && page.contains("default-src 'none'") && !page.contains("src=\"http"));
    let grid = place.read(&format!("{dir}/blocks.vtu"));
    let grid = roxmltree::Document::parse(&grid).expect("XML");
    let piece = grid.descendants().find(|node| node.has_tag_name("Piece")).expect("a piece");
    assert_eq!((piece.attribute("NumberOfCells"), piece.attribute("NumberOfPoints")), (Some("3"), Some("24")));
    let names: Vec<&str> = grid.descendants().filter_map(|node| node.attribute("Name")).collect();
    assert!(["worst_overlap_m", "lost_pairs", "passing_pairs", "f64_pairs"].iter().all(|name| names.contains(name)));
    assert_eq!(pairs_of(&place, dir).len(), 3);
    assert!(place.read(&format!("{dir}/examine.md")).starts_with("# sound.toml: safe\n"));
    let set = format!("{dir}/tolerances.toml");
    assert_eq!(place.run(&["check", "sound.toml", "--tolerances", &set]).0, 0);
    // The document on stdout is the one in the directory; the bytes do not depend on threads.
    let again = ["examine", "sound.toml", "--threads", "3", "--format", "json"];
    let (code, _, err) = place.run(&again);
    assert!(code == 2 && err.contains("holds an examination already; --overwrite"), "{err}");
    let before =
        ["examine.json", "pairs.csv", "examine.md", "index.html"].map(|name| place.read(&format!("{dir}/{name}")));
    let (code, out, err) = place.run(&[&again[..], &["--overwrite"]].concat());
    assert_eq!(code, 0, "{err}");
    let after =
        ["examine.json", "pairs.csv", "examine.md", "index.html"].map(|name| place.read(&format!("{dir}/{name}")));
    assert!(before == after && out == after[0]);
    let document = document_of(&place, dir);
    assert!(
        document["answer"] == "safe"
            && document["given"]["pairs_examined"] == 3
            && document["given"]["steps"]["made"] == 8
    );
    assert_eq!(document["given"]["overlaps"]["neighbours"], 3);
}

#[test]
fn overlapping_blocks_are_not_safe_and_are_named() {
    let place = Place::new();
    // Half of the second block is in the first.
    place.file(
        "sunk.toml",
        &SOUND.replace("min = [1, 0, 0], max = [2, 1, 1]", "min = [\"1/2\", 0, 0], max = [\"3/2\", 1, 1]"),
    );
    let (code, out, err) = place.run(&["examine", "sunk.toml", "--out", "found", "--candidates", "4"]);
    assert_eq!(code, 1, "{out}{err}");
    assert!(out.starts_with("not safe: 1 pair of blocks overlaps so that contacts cannot hold them\n"), "{out}");
    assert!(
        out.contains("(worst 1–2, 0.5000 m) overlaps deeper")
            && out.contains("; penetration is ")
            && out.contains("overlaps at the start"),
        "{out}"
    );
    assert!(out.ends_with("next: rockproof classify sunk.toml --pair 1,2\n"), "{out}");
    let lost: Vec<_> = pairs_of(&place, "found").into_iter().filter(|pair| pair["overlap"] == "lost").collect();
    assert_eq!(lost.len(), 1);
    assert_eq!([&lost[0]["block_a"], &lost[0]["block_b"], &lost[0]["overlap_m"]], ["1", "2", "0.5"]);
    let page = place.read("found/index.html");
    assert!(page.contains("overlap that contacts cannot hold (2)") && page.contains("nothing found (1)"));
    assert!(document_of(&place, "found")["given"]["steps"]["skipped"].is_string());
}

/// A factor that a scene does not take was advised, in the note and in the next command.
#[test]
fn units_of_a_scene_in_toml_are_not_settled_by_scale() {
    let place = Place::new();
    place.file(
        "large.toml",
        "[[block]]\nbox = { min = [0, 0, 0], max = [1000, 1000, 1000] }\n\
         [[block]]\nbox = { min = [0, 0, 1000], max = [1000, 1000, 2000] }\n",
    );
    let (code, out, err) = place.run(&["examine", "large.toml", "--no-tune", "--out", "found"]);
    assert!(code == 1 && out.starts_with("not safe: the units are in doubt"), "{out}{err}");
    let advice = "if the scene has millimetres, make it anew from what it was made of, with lengths times 1/1000";
    assert!(out.contains(advice) && !format!("{out}{err}").contains("--scale 1/1000"), "{out}{err}");
    assert!(out.ends_with("next: rockproof check large.toml\n"), "{out}");
    // On stdin, and by another name, it is a scene as well.
    let text = place.read("large.toml");
    place.file("large.txt", &text);
    for (stdin, args) in [
        (text.as_str(), &["check", "-"][..]),
        (&text, &["examine", "-", "--no-tune", "--out", "piped"]),
        ("", &["check", "large.txt", "--input-format", "toml"]),
    ] {
        let (_, out, err) = place.piped(stdin.as_bytes(), args);
        let said = format!("{out}{err}");
        assert!(said.contains(advice) && !said.contains("--scale 1/1000"), "{args:?}: {said}");
    }
    let (code, out, err) =
        place.run(&["examine", "large.toml", "--no-tune", "--out", "found", "--overwrite", "--scale", "1"]);
    assert!(code == 0 && out.starts_with("safe: "), "{out}{err}");
}

#[test]
fn units_in_doubt_are_settled_by_scale() {
    let place = Place::new();
    place.file("stack.obj", &stack(1000));
    let examine = |more: &[&str]| place.run(&[&["examine", "stack.obj", "--no-tune", "--out", "found"], more].concat());
    let (code, out, err) = examine(&[]);
    assert_eq!(code, 1, "{out}{err}");
    assert!(out.starts_with("not safe: the units are in doubt") && out.contains("millimetres"), "{out}");
    assert!(out.ends_with("next: rockproof examine stack.obj --scale 1/1000 --out found --overwrite\n"), "{out}");
    let (code, out, err) = examine(&["--scale", "1/1000", "--overwrite"]);
    assert_eq!(code, 0, "{out}{err}");
    assert!(out.contains("2 blocks in 1 × 1 × 2 m") && out.contains("its lowest block held"), "{out}");
    let next = out.lines().last().and_then(|line| line.strip_prefix("next: rockproof ")).expect("a command");
    assert_eq!(next, "simulate stack.obj --scale 1/1000 --hold-lowest --steps 100 --audit");
    let (code, out, err) = place.run(&next.replace("100", "2").split(' ').collect::<Vec<_>>());
    assert_eq!(code, 0, "{out}{err}");
    assert!(place.read("found/index.html").contains("rockproof check stack.obj --scale 1"));
    let (_, out, err) = examine(&["--scale", "1", "--overwrite"]);
    assert!(out.contains("2 blocks in 1000 × 1000 × 2000 m") && !out.contains("doubt"), "{out}{err}");
}

#[test]
fn a_set_that_mends_the_tolerances_is_examined_and_written() {
    let place = Place::new();
    let broken = format!("[tolerances]\npreset = \"shi\"\nsearch = 0.01\n{SOUND}");
    place.file("broken.toml", &broken);
    let (code, out, err) = place.run(&["examine", "broken.toml", "--out", "found"]);
    assert_eq!(code, 1, "{out}{err}");
    assert!(out.starts_with("safe with another set, found/tolerances.toml (under shi, changed: "), "{out}");
    assert!(out.contains("violated by shi, changed in f64") && out.contains("0 rules violated instead of "), "{out}");
    assert!(place.read("found/tune.md").contains("[tolerances]"));
    let next = out.lines().last().and_then(|line| line.strip_prefix("next: rockproof ")).expect("a command");
    let (code, out, err) = place.run(&next.split(' ').collect::<Vec<_>>());
    assert_eq!(code, 0, "{next}: {out}{err}");
}

/// Two bricks on a third and one on both, of which nothing is fixed; rounding puts the joint between two of them nowhere near a tie.
const WALL: &str = r#"
[[block]]
box = { min = [0, 0, 0], max = [2, 1, "1/2"] }
[[block]]
box = { min = [0, 0, "1/2"], max = [1, 1, 1] }
[[block]]
box = { min = [1, 0, "1/2"], max = [2, 1, 1] }
[[block]]
box = { min = ["1/2", 0, 1], max = ["3/2", 1, "3/2"] }
"#;

#[test]
fn no_set_is_recommended_with_which_a_safe_model_is_not_safe() {
    let place = Place::new();
    place.file("wall.toml", WALL);
    let (code, out, err) = place.run(&["examine", "wall.toml", "--out", "found"]);
    assert!(code == 0 && out.starts_with("safe: "), "{out}{err}");
    let set = out.lines().find(|line| line.contains(" set ")).expect("a line about the set");
    assert!(set.contains("with which the whole model does no better"), "{out}");
    // Whatever is written as the set to use is safe, here the set given.
    let (code, out, err) =
        place.run(&["examine", "wall.toml", "--tolerances", "found/tolerances.toml", "--no-tune", "--out", "again"]);
    assert_eq!(code, 0, "{out}{err}");
    // Where nothing is looked for nothing is recommended.
    assert!(place.read("again/tolerances.csv").starts_with("tolerance,given\n"));
    assert!(place.read("again/index.html").contains("No other one is recommended"));
}

#[test]
fn pairs_that_pass_through_one_another_are_named() {
    let place = Place::new();
    place.file("shot.toml", SHOT);
    let (code, out, err) = place.run(&["examine", "shot.toml", "--no-tune", "--steps", "3", "--out", "found"]);
    assert_eq!(code, 1, "{out}{err}");
    assert!(
        out.contains("1 pair passes through one another") && out.contains("1 passage within a step (worst 0–1"),
        "{out}"
    );
    let passed: Vec<_> = pairs_of(&place, "found").into_iter().filter(|pair| !pair["passage_m"].is_empty()).collect();
    assert!(passed.len() == 1 && passed[0]["block_a"] == "0" && passed[0]["block_b"] == "1", "{passed:?}");
    assert!(place.read("found/index.html").contains("passes through another (2)"));
    let (_, out, _) = place.run(&["examine", "shot.toml", "--no-tune", "--steps", "0", "--out", "unstepped"]);
    assert!(out.contains("none were asked for"), "{out}");
}

#[test]
fn differences_far_from_the_origin_are_kept_as_cases() {
    let place = Place::new();
    place.file("far.toml", FAR_FROM_TIE);
    let (code, out, err) = place.run(&["examine", "far.toml", "--no-tune", "--out", "found"]);
    assert!(code == 0 || code == 1, "{err}");
    let document = document_of(&place, "found");
    assert!(document["given"]["f32"]["pairs_differing"].as_u64() > Some(0), "{out}");
    let cases: Vec<PathBuf> =
        fs::read_dir(place.path("found/cases")).expect("cases").map(|e| e.expect("one").path()).collect();
    assert!(!cases.is_empty());
    let (code, out, err) = place.run(&["replay", cases[0].to_str().expect("text")]);
    assert_eq!(code, 0, "{out}{err}");
}

#[test]
fn bad_input_and_directories_of_others_exit_with_2() {
    let place = Place::new();
    place.file("sound.toml", SOUND);
    place.file("bad.obj", "v 0 0 0\nf 1 2 3\n");
    let wrong: [(&[&str], &str); 5] = [
        (&["missing.toml"], "missing.toml"),
        (&["bad.obj"], "bad.obj:2: "),
        (&["sound.toml", "--set", "search=-1"], "search"),
        (&["sound.toml", "--precision", "f16"], "f32 and f64"),
        (&["sound.toml", "--no-tune", "--candidates", "3"], "--candidates"),
    ];
    for (args, word) in wrong {
        let (code, _, err) = place.run(&[&["examine", "--out", "found"], args].concat());
        assert!(code == 2 && err.contains(word), "{args:?}: {code} {err}");
    }
    assert!(!place.path("found").exists(), "nothing is written for bad input");
    // A page that somebody else made, and a directory of another command.
    fs::create_dir(place.path("page")).expect("a directory");
    place.file("page/index.html", "mine");
    let (code, _, err) = place.run(&["examine", "sound.toml", "--out", "page", "--overwrite"]);
    assert!(code == 2 && err.contains("index.html") && place.read("page/index.html") == "mine", "{err}");
    let (code, _, err) = place.run(&["simulate", "sound.toml", "--steps", "1", "--out", "run"]);
    assert_eq!(code, 0, "{err}");
    let (code, _, err) = place.run(&["examine", "sound.toml", "--out", "run", "--overwrite"]);
    assert!(code == 2 && err.contains("belongs to `rockproof simulate`"), "{err}");
}

/// The audit is of settling too: its count of steps is larger than that of the steps asked for.
#[test]
fn steps_of_settling_are_told_beside_the_others() {
    let place = Place::new();
    let two = "[[block]]\nfixed = true\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\n\
               [[block]]\nbox = { min = [0, 0, 1], max = [1, 1, 2] }\n";
    for (settle, made, audited) in [(0, "2 made, ", 2), (3, "2 made after 3 of settling, ", 5)] {
        place.file("two.toml", &format!("[simulation]\nsettle = {settle}\n{two}"));
        let (code, out, err) =
            place.run(&["examine", "two.toml", "--steps", "2", "--no-tune", "--out", &made.len().to_string()]);
        let line = out.lines().find(|line| line.contains(" steps ")).expect("a line on steps");
        assert!(
            code == 0 && line.contains(made) && line.contains(&format!("no passage in {audited} steps")),
            "{out}{err}"
        );
    }
}

#[test]
fn what_was_not_tried_is_said_beside_safe() {
    let place = Place::new();
    let two = "[[block]]\nfixed = true\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\n\
               [[block]]\nbox = { min = [0, 0, 1], max = [1, 1, 2] }\n";
    place.file("two.toml", two);
    let (code, out, err) = place.run(&["examine", "two.toml", "--steps", "0", "--no-tune", "--out", "two"]);
    assert!(code == 0 && out.lines().next().is_some_and(|line| line.ends_with(", but no step was made")), "{out}{err}");
}
