//! Pins `tune`: what it says and writes, that it goes on to the same bytes, what it refuses, and that the reference is not stale.

use assert_cmd::Command;
use std::fs;
use std::path::{Path, PathBuf};

fn rockproof(args: &[&str]) -> (i32, String, String) {
    let output = Command::cargo_bin("rockproof").expect("the program").args(args).output().expect("runs");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("UTF-8");
    (output.status.code().expect("a code"), text(output.stdout), text(output.stderr))
}

fn path(dir: &Path, name: &str) -> String {
    dir.join(name).to_string_lossy().into_owned()
}

/// Two blocks on a floor, under tolerances that break rules.
const SCENE: &str = r#"
[tolerances]
preset = "shi"
search = 0.01

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

#[test]
fn a_search_goes_on_to_the_same_bytes_and_its_set_keeps_the_rules() {
    let dir = tempfile::tempdir().expect("a directory");
    let scene = path(dir.path(), "scene.toml");
    fs::write(&scene, SCENE).expect("write");
    let (whole, parts) = (path(dir.path(), "whole"), path(dir.path(), "parts"));
    let (code, printed, err) = rockproof(&["tune", &scene, "--candidates", "8", "--out", &whole, "--threads", "1"]);
    assert!(code == 0 || code == 1, "{err}");
    for word in ["```toml", "[tolerances]", "author", "breaks", "Trade-offs", "8 candidates"] {
        assert!(printed.contains(word), "{word}: {printed}");
    }
    let (code, _, err) = rockproof(&["tune", &scene, "--candidates", "3", "--out", &parts]);
    assert!(code == 0 || code == 1, "{err}");
    let (code, _, err) = rockproof(&["tune", &scene, "--candidates", "8", "--out", &parts]);
    assert!(code == 2 && err.contains("--resume"), "{err}");
    let (code, _, err) = rockproof(&["tune", &scene, "--candidates", "8", "--seed", "2", "--out", &parts, "--resume"]);
    assert!(code == 2 && err.contains("seed"), "{err}");
    let (code, _, err) = rockproof(&["tune", &scene, "--candidates", "8", "--out", &parts, "--resume"]);
    assert!(code == 0 || code == 1, "{err}");
    for name in ["candidates.csv", "tune.md", "tolerances.toml"] {
        let read = |dir: &str| fs::read_to_string(Path::new(dir).join(name)).expect("a file");
        assert_eq!(read(&whole), read(&parts), "{name}");
    }
    let set = path(Path::new(&whole), "tolerances.toml");
    let (code, printed, err) = rockproof(&["check", &scene, "--tolerances", &set]);
    assert_eq!(code, 0, "{printed}{err}");
}

#[test]
fn bad_input_exits_with_2() {
    let dir = tempfile::tempdir().expect("a directory");
    let (scene, lone) = (path(dir.path(), "scene.toml"), path(dir.path(), "lone.toml"));
    fs::write(&scene, SCENE).expect("write");
    fs::write(&lone, "[[block]]\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\n").expect("write");
    let out = path(dir.path(), "out");
    let missing = path(dir.path(), "missing.toml");
    let wrong: [(&[&str], &str); 7] = [
        (&[&missing], "missing.toml"),
        (&[&lone], "near"),
        (&[&scene, "--candidates", "0"], "--candidates"),
        (&[&scene, "--budget", "x"], "--budget"),
        (&[&scene, "--engine", "f16"], "f32 and f64"),
        (&[&scene, "--set", "search=-1"], "search"),
        (&[&scene, "--tolerances", "nothing"], "nothing"),
    ];
    for (args, word) in wrong {
        let all: Vec<&str> = ["tune"].iter().chain(args).chain(&["--out", out.as_str()]).copied().collect();
        let (code, _, err) = rockproof(&all);
        assert!(code == 2 && err.contains(word), "{args:?}: {code} {err}");
    }
    assert!(!PathBuf::from(&out).exists(), "nothing is written for bad input");
}

#[test]
fn the_reference_in_reports_is_not_stale() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let dir = tempfile::tempdir().expect("a directory");
    let out = path(dir.path(), "out");
    let model = path(root, "cases/real/openpit_rock.dda");
    let (code, _, err) = rockproof(&["tune", &model, "--candidates", "2", "--out", &out]);
    assert!(code == 0 || code == 1, "{err}");
    let rows = |file: PathBuf| {
        let mut reader = csv::Reader::from_path(file).expect("a table");
        let header = reader.headers().expect("a header").clone();
        let rows = reader.records().take(2).collect::<Result<Vec<_>, _>>().expect("rows");
        (header, rows)
    };
    let (header, now) = rows(Path::new(&out).join("candidates.csv"));
    let (kept_header, kept) = rows(root.join("reports/tune_openpit/candidates.csv"));
    assert_eq!(header, kept_header);
    for (row, kept) in now.iter().zip(&kept) {
        for ((name, value), kept) in header.iter().zip(row).zip(kept) {
            match name {
                // Which is best depends on those that come after.
                "best" => {}
                // The order of sums in a sparse solve is the library's own matter.
                "penetration_m" => {
                    let [value, kept] = [value, kept].map(|text| text.parse::<f64>().expect("a depth"));
                    assert!((value - kept).abs() <= 1e-6 * kept, "{value} {kept}");
                }
                _ => assert_eq!(value, kept, "{name}: after a change that is meant, run reports/regenerate"),
            }
        }
    }
}
