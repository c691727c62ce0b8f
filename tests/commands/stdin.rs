//! `-` stands for stdin: every command answers as it does to the file, and names `<stdin>` in errors.

use crate::place::Place;
use std::fs;
use std::path::{Path, PathBuf};

fn project(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

fn bytes(name: &str) -> Vec<u8> {
    fs::read(project(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// One file of every format that is read.
const MODELS: [&str; 13] = [
    "cases/real/smallEdge.dda",
    "cases/real/voronoi_120.txt",
    "cases/handmade/slope_failure.toml",
    "tests/fixtures/box.ply",
    "tests/fixtures/cells.msh",
    "tests/fixtures/surfaces.msh",
    "tests/fixtures/cells.vtu",
    "tests/fixtures/two_cubes.obj",
    "tests/fixtures/two_cubes.vtk",
    "tests/fixtures/two_cubes_version_5.vtk",
    "tests/fixtures/two_wedges.stl",
    "tests/fixtures/l_block_triangles.obj",
    "cases/handmade/wedge.toml",
];

#[test]
fn the_format_of_every_model_is_found_from_its_contents() {
    let place = Place::new();
    for model in MODELS {
        let file = project(model).display().to_string();
        let options = ["--planarity", "1e-4", "--format", "json"];
        let (code, out, err) = place.run(&[&["check", &file], &options[..]].concat());
        assert_ne!(code, 2, "{model}: {err}");
        let piped = place.piped(&bytes(model), &[&["check", "-"], &options[..]].concat());
        assert_eq!(piped, (code, out.replace(&file, "<stdin>"), err.replace(&file, "<stdin>")), "{model}");
    }
}

#[test]
fn what_begins_as_no_format_does_needs_its_name() {
    let place = Place::new();
    for contents in [&b"once upon a time"[..], b"1 2 3\n4 5 6\n"] {
        let (code, _, err) = place.piped(contents, &["check", "-"]);
        assert!(code == 2 && err.contains("<stdin>: ") && err.contains("--input-format"), "{err}");
        assert!(err.contains("toml, dda, obj, stl, ply, msh, vtk, vtu, voro"), "{err}");
    }
    // The name is believed whatever the contents look like, and that of a file less than what is said.
    let cubes = bytes("tests/fixtures/two_cubes.obj");
    let (code, _, err) = place.piped(&cubes, &["classify", "-", "--input-format", "vtk"]);
    assert!(code == 2 && err.contains("<stdin>:1: ") && err.contains("vtk"), "{err}");
    fs::write(place.path("cubes.txt"), &cubes).expect("write");
    assert_eq!(place.run(&["classify", "cubes.txt"]).0, 2);
    let named = place.run(&["classify", "cubes.txt", "--input-format", "obj"]);
    assert_eq!(named.0, 0, "{}", named.2);
    assert_eq!(named, place.piped(&cubes, &["classify", "-"]));
    let (code, _, err) = place.piped(&cubes, &["classify", "-", "--input-format", "dxf"]);
    assert!(code == 2 && err.contains("known are toml, dda"), "{err}");
}

#[test]
fn errors_name_stdin_and_the_line() {
    let place = Place::new();
    let text = String::from_utf8(bytes("tests/fixtures/two_cubes.obj")).expect("UTF-8").replacen("v ", "v x", 1);
    for command in [&["check", "-"][..], &["classify", "-"], &["tune", "-"], &["examine", "-"], &["simulate", "-"]] {
        let (code, out, err) = place.piped(text.as_bytes(), command);
        assert!(code == 2 && out.is_empty() && err.contains("error: <stdin>:"), "{command:?}: {err}");
    }
    // Files that a scene names are looked for in the current directory.
    let scene = b"[[block]]\nfile = \"cubes.obj\"\n";
    let (code, _, err) = place.piped(scene, &["check", "-"]);
    assert!(code == 2 && err.contains("error: <stdin>:") && err.contains("cubes.obj: No such file"), "{err}");
    place.file("cubes.obj", &text.replacen("v x", "v ", 1));
    assert_eq!(place.piped(scene, &["classify", "-"]).0, 0);
    let (code, _, err) = place.piped(b"[case]\n\xff", &["replay", "-"]);
    assert!(code == 2 && err.contains("<stdin>: line 2: byte 7"), "{err}");
    let (code, _, err) = place.piped(b"", &["check", "-"]);
    assert!(code == 2 && err.contains("<stdin>: it is empty"), "{err}");
    let (code, _, err) = place.piped(b"{}", &["replay", "-"]);
    assert!(code == 2 && err.contains("<stdin>: no state file"), "{err}");
    let (code, _, err) = place.piped(&bytes(CASE), &["shrink", "-"]);
    assert!(code == 2 && err.contains("--out"), "{err}");
}

const CASE: &str = "cases/regressions/v-e-arithmetic-foot-region.toml";

#[test]
fn every_command_answers_as_to_the_file() {
    let place = Place::new();
    let edge = bytes("cases/real/smallEdge.dda");
    fs::write(place.path("edge.dda"), &edge).expect("write");
    let (code, _, err) = place.piped(&edge, &["convert", "-", "piped.toml"]);
    assert_eq!((code, place.run(&["convert", "edge.dda", "named.toml"]).0), (0, 0), "{err}");
    assert_eq!(place.read("piped.toml"), place.read("named.toml"));
    let run = ["--steps", "3", "--force"];
    let (_, _, err) = place.piped(&edge, &[&["simulate", "-"], &run[..]].concat());
    place.run(&[&["simulate", "edge.dda"], &run[..]].concat());
    let tables = ["reports/simulate-stdin/steps.csv", "reports/simulate-edge/steps.csv"].map(|name| place.read(name));
    assert_eq!(tables[0], tables[1], "{err}");
    let few = ["--candidates", "1", "--steps", "1"];
    let (_, _, err) = place.piped(&edge, &[&["tune", "-"], &few[..]].concat());
    place.run(&[&["tune", "edge.dda"], &few[..]].concat());
    let tables = ["reports/tune-stdin/candidates.csv", "reports/tune-edge/candidates.csv"].map(|name| place.read(name));
    assert_eq!(tables[0], tables[1], "{err}");
    let (code, out, err) = place.piped(&edge, &["examine", "-", "--no-tune", "--steps", "0"]);
    let named = place.run(&["examine", "edge.dda", "--no-tune", "--steps", "0"]);
    assert_eq!(
        (code, out.replace("reports/examine-stdin", "reports/examine-edge").replace(" FILE ", " edge.dda ")),
        (named.0, named.1),
        "{err}"
    );
    assert!(place.read("reports/examine-stdin/examine.md").contains("stdin"));

    let case = bytes(CASE);
    let file = project(CASE).display().to_string();
    assert_eq!(place.piped(&case, &["replay", "-"]), place.run(&["replay", &file]));
    let small = ["--evaluations", "50", "--out"];
    let (code, _, err) = place.piped(&case, &[&["shrink", "-"], &small[..], &["piped-case.toml"]].concat());
    assert_eq!(code, 0, "{err}");
    place.run(&[&["shrink", &file], &small[..], &["named-case.toml"]].concat());
    assert_eq!(place.read("piped-case.toml"), place.read("named-case.toml"));
    let step = bytes("fuzz/corpus/state/step_000002.json");
    let file = project("fuzz/corpus/state/step_000002.json").display().to_string();
    let named = place.run(&["replay", &file]);
    assert!(named.0 != 2, "{}", named.2);
    assert_eq!(place.piped(&step, &["replay", "-"]), named);
}
