//! `--weld` through the program: surfaces whose faces have corners of their own, a little apart, wherever a model is read.

use crate::campaigns::WITHOUT_CASES;
use crate::place::Place;
use serde_json::Value;

/// Two cubes, one on the other, in OBJ. Every face has its own corners, each off by up to so much.
fn soup(apart: f64) -> String {
    let mut text = String::new();
    let mut count = 0;
    for block in 0..2 {
        text += &format!("o block{block}\n");
        for face in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
            for (number, corner) in face.into_iter().enumerate() {
                let at = [corner & 1, corner >> 1 & 1, (corner >> 2 & 1) + block].map(f64::from);
                let off = apart * f64::from((count + number as i32) % 3) / 3.0;
                text += &format!("v {:.12} {:.12} {:.12}\n", at[0] + off, at[1], at[2]);
            }
            text += &format!("f {} {} {} {}\n", count + 1, count + 2, count + 3, count + 4);
            count += 4;
        }
    }
    text
}

fn document(place: &Place, args: &[&str]) -> Value {
    let (_, out, err) = place.run(args);
    serde_json::from_str(&out).unwrap_or_else(|e| panic!("{args:?}: {e}: {out}{err}"))
}

/// Blocks that shrink to a point: that is said beside what is left of them, and how many there would be.
#[test]
fn what_a_weld_larger_than_the_blocks_makes_of_them_is_said() {
    let place = Place::new();
    place.file("cubes.obj", &soup(0.0));
    for command in [&["check", "cubes.obj"][..], &["classify", "cubes.obj"], &["simulate", "cubes.obj", "--steps", "1"]]
    {
        let (code, _, err) = place.run(&[command, &["--weld", "1e9"]].concat());
        assert!(code == 2 && !err.contains("without it"), "no block can be used without it either: {err}");
    }
    place.file("cell.txt", &std::fs::read_to_string("cases/real/voronoi_120.txt").expect("cells"));
    let options = ["--planarity", "1e-4", "--weld", "1e9"];
    for command in [&["check", "cell.txt"][..], &["classify", "cell.txt"]] {
        let (code, _, err) = place.run(&[command, &options].concat());
        let told = "note: --weld 1000000000 made one vertex of all that are no further apart, in the file's unit of length, and of 120 blocks 0 can be used; without it 120 can\n";
        assert_eq!((code, err.matches(told).count()), (2, 1), "{command:?}: {err}");
    }
}

#[test]
fn a_distance_of_many_digits_is_cut_in_messages() {
    let place = Place::new();
    place.file("cell.txt", &std::fs::read_to_string("cases/real/voronoi_120.txt").expect("cells"));
    place.file("cubes.obj", &soup(0.0));
    for (file, told) in [("cell.txt", "note: --weld 1000"), ("cubes.obj", "--weld 1000")] {
        let (code, _, err) = place.run(&["check", file, "--planarity", "1e-4", "--weld", "1e400"]);
        assert!(code == 2 && err.contains(told) && err.contains("000… "), "{err}");
        assert!(!err.contains(&"0".repeat(250)), "{err}");
    }
}

#[test]
fn vertices_are_joined_wherever_a_model_is_read() {
    let place = Place::new();
    place.file("soup.obj", &soup(1e-9));
    place.file("joined.obj", &soup(0.0));
    let options = ["--planarity", "1e-6"];
    let weld = ["--planarity", "1e-6", "--weld", "1e-8"];
    // Which distance does it is said.
    let (code, _, err) = place.run(&[&["check", "soup.obj"], &options[..]].concat());
    assert!(code == 2 && err.contains("with --weld 1e-9 the faces of every block join"), "{err}");
    for command in
        [&["classify", "soup.obj"][..], &["convert", "soup.obj", "out.toml"], &["simulate", "soup.obj", "--steps", "1"]]
    {
        let (code, _, err) = place.run(&[command, &options].concat());
        assert!(code == 2 && err.contains("--weld joins vertices"), "{command:?}: {err}");
    }
    assert!(!place.path("out.toml").exists());
    let checked = document(&place, &[&["check", "soup.obj", "--format", "json"], &weld[..]].concat());
    assert_eq!(
        [&checked["vertices"], &checked["faces"], &checked["concave"]].map(Value::as_u64),
        [Some(16), Some(12), Some(0)]
    );
    let touching = document(&place, &[&["classify", "soup.obj", "--format", "json"], &weld[..]].concat());
    assert!(touching["pairs"][0]["contacts"].as_array().is_some_and(|contacts| contacts.len() >= 4), "{touching}");
    let (code, _, err) = place.run(&[&["convert", "soup.obj", "out.toml"], &weld[..]].concat());
    assert_eq!(code, 0, "{err}");
    assert_eq!(place.read("out.toml").matches("\n  [").count(), 2 * (8 + 6));
    // At one place, corners are joined by a distance of 0 and by nothing less.
    assert_eq!(place.run(&["check", "joined.obj"]).0, 2);
    assert_eq!(place.run(&["classify", "joined.obj", "--weld", "0"]).0, 0);
}

#[test]
fn campaigns_join_vertices_of_real_files() {
    let place = Place::new();
    place.file("soup.obj", &soup(1e-9));
    let args = [
        "campaign",
        WITHOUT_CASES,
        "--pairs",
        "16",
        "--family",
        "real",
        "--real",
        "soup.obj",
        "--planarity",
        "1e-6",
        "--tolerances",
        "auto",
    ];
    let (code, _, err) = place.run(&[&args[..], &["--out", "none"]].concat());
    assert!(code == 2 && err.contains("soup.obj:"), "{err}");
    assert!(!place.path("none").exists());
    let (code, _, err) = place.run(&[&args[..], &["--out", "found", "--weld", "1e-8"]].concat());
    assert_eq!(code, 0, "{err}");
    let run: Value = serde_json::from_str(&place.read("found/run.json")).expect("JSON");
    assert_eq!((run["pairs"].as_u64(), !run["configuration"]["weld"].is_null()), (Some(16), true), "{run}");
    // The same, as a file says it; another distance is another run.
    place.file("c.toml", "cases_per_cause = 0\npairs = 16\nfamilies = [\"real\"]\nreal = [\"soup.obj\"]\nplanarity = 1e-6\nweld = 1e-8\ntolerances = [\"auto\"]\n");
    assert_eq!(place.run(&["campaign", "c.toml", "--out", "again"]).0, 0);
    assert_eq!(place.read("again/summary.csv"), place.read("found/summary.csv"));
    let (code, _, err) = place.run(&["campaign", "c.toml", "--out", "again", "--resume", "--weld", "1e-7"]);
    assert!(code == 2 && err.contains("weld"), "{err}");
    let (code, _, err) = place.run(&["campaign", "--pairs", "16", "--weld", "1e-8", "--out", "none"]);
    assert!(code == 2 && err.contains("--weld is about the files of --real"), "{err}");
}

#[test]
fn joining_everything_and_joining_nothing_are_said() {
    let place = Place::new();
    place.file("joined.obj", &soup(0.0));
    let (code, _, err) = place.run(&["check", "joined.obj", "--weld", "10"]);
    assert!(code == 2 && err.contains("--weld 10 joins all vertices of block block0_0, "), "{err}");
    place.file("scene.toml", "[[block]]\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\n");
    let (code, _, err) = place.run(&["check", "scene.toml", "--weld", "1e-6"]);
    assert!(code == 0 && err.contains("note: --weld joins vertices of the files that a scene names; "), "{err}");
    let (_, _, err) = place.run(&["check", "scene.toml"]);
    assert!(!err.contains("--weld"), "{err}");
}
