//! Broken input, reader by reader: the program exits 2, says where and what, and never panics.

// Longer than 400 lines: one bad input after another, all with what they are told.

use assert_cmd::Command;
use std::path::Path;

/// File name, contents, parts of the message; the first part is the place.
type Case = (&'static str, String, &'static [&'static str]);

fn run(arguments: &[&str], directory: &Path) -> (Option<i32>, String) {
    let output = Command::cargo_bin("rockproof").unwrap().args(arguments).current_dir(directory).output().unwrap();
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

fn check_all(cases: &[Case]) {
    let directory = crate::place::folder();
    let mut wrong = Vec::new();
    for (i, (name, contents, parts)) in cases.iter().enumerate() {
        let name = name.replacen('.', &format!("{i}."), 1);
        std::fs::write(directory.path().join(&name), contents).unwrap();
        let (code, message) = run(&["check", &name], directory.path());
        let place = parts[0].replacen('.', &format!("{i}."), 1);
        let says_all = message.contains(&place) && parts[1..].iter().all(|part| message.contains(part));
        if code != Some(2) || !says_all || message.contains("panicked") || message.len() > 4000 {
            wrong.push(format!("case {i}, expected {parts:?}, exit {code:?}:\n{message}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

const DDA: &str = include_str!("../../cases/real/smallAngle.dda");
const VTK: &str = include_str!("../fixtures/two_cubes.vtk");
const VTK5: &str = include_str!("../fixtures/two_cubes_version_5.vtk");
const CELL: &str = "7 4 (0,0,0) (1,0,0) (0,1,0) (0,0,1) 4 (1,2,0) (3,1,0) (3,2,1) (3,0,2)";
const MESH: &str = "[[block]]
name = \"rock\"
vertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
";
const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

/// `text` with one thing changed, which must be there.
fn change(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "{from}");
    text.replacen(from, to, 1)
}

#[test]
fn the_unchanged_files_are_good() {
    let directory = crate::place::folder();
    let files = [("a.dda", DDA), ("a.vtk", VTK), ("b.vtk", VTK5), ("a.voro", CELL), ("a.toml", MESH), ("a.obj", OBJ)];
    for (name, contents) in files {
        std::fs::write(directory.path().join(name), contents).unwrap();
        let (code, message) = run(&["check", name], directory.path());
        assert_eq!(code, Some(0), "{name}: {message}");
    }
}

#[test]
fn broken_dda_files() {
    check_all(&[
        ("a.dda", String::new(), &["a.dda:1:", "the file ends where \"#_DDA_DataFile_Version_1.0\""]),
        ("a.dda", "hello world".into(), &["a.dda:1:", "found \"hello\""]),
        ("a.dda", DDA[..300].into(), &["a.dda:", "the file ends where a coordinate of a vertex"]),
        ("a.dda", change(DDA, "0 3.0 0\n", "0 nan 0\n"), &["a.dda:10:", "nan is not a finite number"]),
        ("a.dda", change(DDA, "0 3.0 0\n", "0 inf 0\n"), &["a.dda:10:", "inf is not a finite number"]),
        ("a.dda", change(DDA, "0 3.0 0\n", "0 1e999 0\n"), &["a.dda:10:", "1e999 is not a finite number"]),
        ("a.dda", change(DDA, "0 3.0 0\n", "0 3,0 0\n"), &["a.dda:10:", "found \"3,0\"", "a decimal number"]),
        ("a.dda", change(DDA, "LENGTH 2", "LENGTH 4000000000"), &["a.dda:6:", "found \"POINTS\""]),
        (
            "a.dda",
            change(DDA, "LENGTH 2", "LENGTH 99999999999999999999"),
            &["a.dda:2:", "allowed is at most 4294967295"],
        ),
        ("a.dda", change(DDA, "LENGTH 2", "LENGTH -2"), &["a.dda:2:", "found \"-2\"", "a whole number"]),
        ("a.dda", change(DDA, "6 6\n", "6 7\n"), &["a.dda:4:", "is 12; allowed is at most 11"]),
        ("a.dda", change(DDA, "6 6\n", "5 7\n"), &["a.dda:4:", "vertex of the list 5 is in two slices"]),
        ("a.dda", change(DDA, "6 6\n", "6 5\n"), &["a.dda:4:", "vertex of the list 11 is in no slice"]),
        ("a.dda", change(DDA, "POINTS 12", "POINTS 11"), &["a.dda:6:", "points is 11; allowed is 12"]),
        ("a.dda", change(DDA, "BLOCK_FACES 2", "BLOCK_FACES 1"), &["a.dda:", "BLOCK_FACES is 1; allowed is 2"]),
        ("a.dda", change(DDA, "\n0 1 2 3 0 3 4", "\n0 1 2 9 0 3 4"), &["a.dda:21:", "block 0: face 0 names vertex 9"]),
        (
            "a.dda",
            change(DDA, "fixedFlag int\n1", "fixedFlag int\n7"),
            &["a.dda:", "a fixedFlag is 7; allowed is 0 to 1"],
        ),
        ("a.dda", change(DDA, "EDGES 18", "EDGES 19"), &["a.dda:", "found \"EDGES\""]),
        ("a.dda", format!("{DDA}\nrubbish"), &["a.dda:", "found \"rubbish\" where \"SCALARS\""]),
        ("a.dda", format!("{DDA}\n/////Boundaries///\nBond: x"), &["a.dda:", "found \"x\""]),
        ("a.dda", format!("{DDA}\0"), &["a.dda:", "is 0x00, which is not text"]),
    ]);
}

#[test]
fn broken_voro_files() {
    check_all(&[
        ("a.txt", String::new(), &["a.txt:", "there is no block in it"]),
        ("a.txt", "\n \n".into(), &["a.txt:", "there is no block in it"]),
        ("a.txt", change(CELL, "7 4", "7 5"), &["a.txt:1:", "found \"4\" where a vertex (x,y,z)"]),
        ("a.txt", change(CELL, "7 4", "7 3"), &["a.txt:1:", "found \"(0,0,1)\""]),
        ("a.txt", format!("{CELL}\n{}", &CELL[..20]), &["a.txt:2:", "the file ends where a vertex (x,y,z)"]),
        ("a.txt", format!("{CELL} 9"), &["a.txt:1:", "found \"9\" after 4 faces"]),
        ("a.txt", change(CELL, "(1,0,0)", "(1,0)"), &["a.txt:1:", "found \"(1,0)\""]),
        ("a.txt", change(CELL, "(1,0,0)", "(1,NaN,0)"), &["a.txt:1:", "NaN is not a finite number"]),
        ("a.txt", change(CELL, "(1,2,0)", "(1,2,4)"), &["a.txt:1:", "is 4; allowed is 0 to 3"]),
        ("a.txt", change(CELL, "(1,2,0)", "(1,2,-1)"), &["a.txt:1:", "found \"-1\""]),
        (
            "a.txt",
            change(CELL, "(1,2,0)", "(0,2,1)"),
            &["a.txt:1:", "block 0 \"cell_7\": faces 0 and", "both run edge"],
        ),
        ("a.txt", change(CELL, "4 (1,2,0)", "4000000000 (1,2,0)"), &["a.txt:1:", "the file ends where a face"]),
        ("a.voro", format!("{CELL}\nid 4"), &["a.voro:2:", "found \"id\" where the number of a cell"]),
    ]);
}

#[test]
fn broken_obj_files() {
    check_all(&[
        ("a.obj", String::new(), &["a.obj:", "there is no block in it"]),
        ("a.obj", "o nothing\n".into(), &["a.obj:", "there is no block in it"]),
        ("a.obj", change(OBJ, "v 1 0 0", "v 1 0"), &["a.obj:2:", "\"v\" with 2 numbers"]),
        ("a.obj", change(OBJ, "v 1 0 0", "v 1 0 0 2"), &["a.obj:2:", "no weight but 1"]),
        ("a.obj", change(OBJ, "v 1 0 0", "v 1 0 infinity"), &["a.obj:2:", "infinity is not a finite number"]),
        ("a.obj", change(OBJ, "v 1 0 0", "v 1 0 0x10"), &["a.obj:2:", "found \"0x10\""]),
        ("a.obj", change(OBJ, "f 1 3 2", "f 1 3"), &["a.obj:5:", "a face of 2 vertices"]),
        ("a.obj", change(OBJ, "f 1 3 2", "f 1 3 5"), &["a.obj:5:", "is 5; allowed is 1 to 4"]),
        ("a.obj", change(OBJ, "f 1 3 2", "f 1 3 0"), &["a.obj:5:", "is 0; allowed is 1 to 4"]),
        ("a.obj", change(OBJ, "f 1 3 2", "f 1 3 -5"), &["a.obj:5:", "is -5; allowed is 1 to 4, or -4 to -1"]),
        ("a.obj", change(OBJ, "f 1 3 2", "f 1/a 3 2"), &["a.obj:5:", "found \"1/a\""]),
        ("a.obj", change(OBJ, "f 1 3 2", "f 1 3 99999999999999999999"), &["a.obj:5:", "allowed is 1 to 4"]),
        ("a.obj", change(OBJ, "f 1 3 2", "face 1 3 2"), &["a.obj:5:", "found \"face\""]),
        ("a.obj", change(OBJ, "f 3 1 4\n", ""), &["a.obj:5:", "block 0:", "at least 4 vertices and 4 faces"]),
        ("a.obj", change(OBJ, "f 3 1 4", "f 3 1 1"), &["a.obj:8:", "face 3 visits vertex 0 twice"]),
        ("a.obj", format!("{OBJ}v 5 5 5\n"), &["a.obj:9:", "vertex 5 of the file is in no face"]),
        ("a.obj", change(OBJ, "v 0 0 1", "v 0 0 -1"), &["a.obj:5:", "the volume is -1.666667e-1"]),
        ("a.obj", change(OBJ, "v 0 0 1", "v 0 0 0"), &["a.obj:4:", "vertices 0 and 3 are the same point (0, 0, 0)"]),
    ]);
}

#[test]
fn broken_vtk_files() {
    check_all(&[
        ("a.vtk", String::new(), &["a.vtk:1:", "the file ends"]),
        ("a.vtk", "# vtk DataFile Version 3.0\ntitle\n".into(), &["a.vtk:3:", "the file ends where \"ASCII\""]),
        ("a.vtk", change(VTK, "ASCII", "BINARY"), &["a.vtk:3:", "a BINARY file cannot be read"]),
        ("a.vtk", change(VTK, "# vtk", "vtk"), &["a.vtk:1:", "# vtk DataFile Version"]),
        ("a.vtk", change(VTK, "UNSTRUCTURED_GRID", "POLYDATA"), &["a.vtk:5:", "the dataset POLYDATA cannot be read"]),
        ("a.vtk", change(VTK, "POINTS 16", "POINTS 17"), &["a.vtk:24:", "found \"CELLS\""]),
        (
            "a.vtk",
            change(VTK, "POINTS 16", "POINTS 15"),
            &["a.vtk:22:", "found \"-0\" where one of each of the sections"],
        ),
        ("a.vtk", change(VTK, "CELLS 2 64", "CELLS 2 65"), &["a.vtk:24:", "is 65; allowed is 64"]),
        ("a.vtk", change(VTK, "31 6 4 0", "30 6 4 0"), &["a.vtk:", "the size of the cell list"]),
        ("a.vtk", change(VTK, "31 6 4 0", "31 7 4 0"), &["a.vtk:25:", "the cell is shorter than its faces"]),
        ("a.vtk", change(VTK, "31 6 4 0", "31 5 4 0"), &["a.vtk:25:", "the end of the cell behind its last face"]),
        ("a.vtk", change(VTK, "31 6 4 0", "31 6 4 16"), &["a.vtk:25:", "is 16; allowed is 0 to 15"]),
        ("a.vtk", change(VTK, "\n42\n42", "\n42\n5"), &["a.vtk:31:", "cell 1 of type 5 cannot be read"]),
        ("a.vtk", change(VTK, "CELL_TYPES 2\n42\n42", "CELL_TYPES 1\n42"), &["a.vtk:30:", "is 1; allowed is 2"]),
        ("a.vtk", change(VTK, "CELL_TYPES", "CELL_KINDS"), &["a.vtk:29:", "found \"CELL_KINDS\""]),
        (
            "a.vtk",
            VTK[..VTK.find("CELL_TYPES").unwrap()].into(),
            &["a.vtk:", "the file ends where the section CELL_TYPES"],
        ),
        ("a.vtk", change(VTK5, "0 31 62", "0 63 62"), &["a.vtk:", "an offset is 63; allowed is 0 to 62"]),
        ("a.vtk", change(VTK5, "0 31 62", "0 31 61"), &["a.vtk:", "the last offset is 61; allowed is 62"]),
        ("a.vtk", change(VTK5, "CELLS 3", "CELLS 4000000000"), &["a.vtk:", "found \"CONNECTIVITY\""]),
        ("a.vtk", change(VTK, "-0 0 0", "-0 0 1e310"), &["a.vtk:7:", "1e310 is not a finite number"]),
    ]);
}

#[test]
fn broken_toml_scenes() {
    let faces = "[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]";
    let with_faces = |f: &str| change(MESH, faces, f);
    let with_vertex = |v: &str| change(MESH, "[1, 0, 0]", v);
    let with_tolerance = |t: &str| format!("{MESH}[tolerances]\n{t}\n");
    check_all(&[
        ("a.toml", String::new(), &["a.toml:", "there is no block in it"]),
        ("a.toml", "[[block]\n".into(), &["a.toml:1:", "not valid TOML"]),
        ("a.toml", format!("{MESH}[[block]]\nname = \"x\nbox = 1"), &["a.toml:6:", "not valid TOML"]),
        ("a.toml", format!("rocks = 1\n{MESH}"), &["a.toml:1:", "unknown key `rocks` in the scene; known are"]),
        ("a.toml", change(MESH, "name", "nmae"), &["a.toml:2:", "unknown key `nmae` in [[block]]"]),
        ("a.toml", change(MESH, "\"rock\"", "\" rock\""), &["a.toml:2:", "`name`"]),
        ("a.toml", "block = 3".into(), &["a.toml:1:", "found 3 where `block`"]),
        ("a.toml", "[[block]]\nname = \"x\"\n".into(), &["a.toml:1:", "a block without a shape"]),
        ("a.toml", format!("{MESH}file = \"a.dda\"\n"), &["a.toml:1:", "vertices and faces and file"]),
        ("a.toml", with_vertex("[1, 0]"), &["a.toml:3:", "vertex 1, an array of 3 coordinates"]),
        ("a.toml", with_vertex("[1, 0, true]"), &["a.toml:3:", "found true", "coordinate of vertex 1"]),
        ("a.toml", with_vertex("[1, 0, nan]"), &["a.toml:3:", "nan is not a finite number"]),
        ("a.toml", with_vertex("[1, 0, 1e999]"), &["a.toml:3:", "1e999"]),
        ("a.toml", with_vertex("[1, 0, \"1/0\"]"), &["a.toml:3:", "\"1/0\" divides by zero"]),
        ("a.toml", with_vertex("[1, 0, \"one\"]"), &["a.toml:3:", "\"one\" is not a number; allowed are decimals"]),
        ("a.toml", with_vertex("[1, 0, \"1e999999999\"]"), &["a.toml:3:", "exponent outside ±1200"]),
        ("a.toml", with_vertex("[1, 0, \"1e400\"]"), &["a.toml:3:", "overflows when rounded to f64"]),
        ("a.toml", with_faces("[[0, 2, -1]]"), &["a.toml:4:", "found -1", "face 0"]),
        ("a.toml", with_faces("[[0, 2, 1.0]]"), &["a.toml:4:", "found 1.0"]),
        ("a.toml", with_faces("[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0]]"), &["a.toml:4:", "face 3 has 2 vertices"]),
        (
            "a.toml",
            with_faces("[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 9]]"),
            &["a.toml:4:", "face 3 names vertex 9; vertices are numbered 0 to 3"],
        ),
        (
            "a.toml",
            with_faces("[[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 2, 3]]"),
            &["a.toml:4:", "block 0 \"rock\"", "both run edge 0 to 2"],
        ),
        ("a.toml", with_faces("[[1, 2, 0], [3, 1, 0], [3, 2, 1], [3, 0, 2]]"), &["a.toml:1:", "the volume is -1.6"]),
        ("a.toml", change(MESH, "[0, 0, 1]]", "[0, 0, 1], [2, 2, 2]]"), &["a.toml:3:", "vertex 4 belongs to no face"]),
        ("a.toml", change(MESH, "[0, 1, 0]", "[2, 0, 0]"), &["a.toml:4:", "face 0 has no area"]),
        ("a.toml", format!("planarity = -1\n{MESH}"), &["a.toml:1:", "`planarity` is -1; allowed is 0 or more"]),
        ("a.toml", "[[block]]\nbox = { min = [0, 0, 0] }".into(), &["a.toml:2:", "`box` with `min` and `max`"]),
        (
            "a.toml",
            "[[block]]\nbox = { min = [0, 0, 0], max = [1, 1, 0] }".into(),
            &["a.toml:2:", "is 0; allowed is below z of `max`, 0"],
        ),
        ("a.toml", "[[block]]\nfile = \"none.dda\"".into(), &["a.toml:1:", "`file` none.dda: No such file"]),
        ("a.toml", "[[block]]\nfile = \"a.toml\"".into(), &["a.toml:1:", "a scene can take blocks from"]),
        ("a.toml", with_tolerance("serach = 1"), &["a.toml:6:", "unknown tolerance `serach`"]),
        ("a.toml", with_tolerance("search = -0.5"), &["a.toml:6:", "allowed is 0 or more"]),
        ("a.toml", with_tolerance("overlap_angle = 3\noverlap_sine = 0.1"), &["a.toml:7:", "both given"]),
        ("a.toml", with_tolerance("preset = \"automatic\""), &["a.toml:6:", "\"auto\", \"shi\" or \"zero\""]),
        ("a.toml", with_tolerance("preset = 1"), &["a.toml:6:", "tolerance `preset` is 1"]),
        ("a.toml", with_tolerance("criteria = true"), &["a.toml:6:", "found true"]),
        ("a.toml", format!("[tolerances]\nsearch = 1\n{MESH}"), &["no preset is named", "territory, penetration"]),
        (
            "a.toml",
            format!("{MESH}\n[[set]]\nblocks = []\nvelocity = [0, 0, 1]"),
            &["`blocks` of [[set]] is []", "or \"all\""],
        ),
        ("a.toml", format!("tolerances = 3\n{MESH}"), &["a.toml:1:", "`tolerances`, a table"]),
    ]);
}

#[test]
fn files_that_are_none() {
    let directory = crate::place::folder();
    let path = |name: &str| directory.path().join(name);
    std::fs::write(path("good.obj"), OBJ).unwrap();
    std::fs::write(path("large.obj"), change(OBJ, "v 1 0 0", "v 1e39 0 0")).unwrap();
    std::fs::write(path("third.toml"), change(MESH, "[1, 0, 0]", "[\"1/3\", 0, 0]")).unwrap();
    std::fs::write(path("bytes.toml"), [0x5b, 0x0a, 0xff, 0xfe]).unwrap();
    std::fs::write(path("loose.toml"), "search = 1\n[[block]]\n").unwrap();
    std::fs::write(path("above.toml"), "search = 1\n[tolerances]\npreset = \"auto\"\n").unwrap();
    std::fs::write(path("beside.toml"), "[tolerances]\npreset = \"auto\"\n[tolerance]\nsearch = 1\n").unwrap();
    std::fs::create_dir(path("folder.dda")).unwrap();
    std::fs::write(path("empty"), "").unwrap();
    for name in ["good.step", "good"] {
        std::fs::copy(path("good.obj"), path(name)).unwrap();
    }
    let cases: [(&[&str], &[&str]); 25] = [
        (&["check", "missing.dda"], &["missing.dda:", "No such file"]),
        (&["check", "folder.dda"], &["folder.dda:", "directory"]),
        (&["check", "bytes.toml"], &["bytes.toml:2:", "byte 2 of the file is 0xff"]),
        (&["check", "good.step"], &["good.step:", "cannot tell the format", "CAD programs export STL and OBJ"]),
        (&["check", "missing.xyz"], &["missing.xyz:", "No such file"]),
        (&["check", "."], &[".:", "directory"]),
        (&["check", "empty"], &["empty: it is empty"]),
        (&["check", "good"], &["good:", "cannot tell the format"]),
        (&["check"], &["<FILE>"]),
        (&["check", "good.obj", "--planarity", "-1"], &["--planarity", "must be 0 or more"]),
        (&["check", "good.obj", "--planarity", "x"], &["--planarity", "is not a number"]),
        (&["check", "large.obj", "--precision", "f32"], &["large.obj: block 0", "overflows when rounded to f32"]),
        (&["check", "good.obj", "--precision", "f32", "--set", "open=1e39"], &["tolerance `open` overflows"]),
        (&["check", "good.obj", "--precision", "f16"], &["--precision", "f32 and f64"]),
        (&["check", "good.obj", "--tolerances", "strict"], &["--tolerances strict", "neither a preset"]),
        (
            &["check", "good.obj", "--tolerances", "above.toml"],
            &["above.toml:1:", "unknown key `search`", "[tolerances]"],
        ),
        (&["check", "good.obj", "--tolerances", "beside.toml"], &["beside.toml:3:", "unknown key `tolerance`"]),
        (&["check", "good.obj", "--tolerances", "loose.toml"], &["loose.toml:2:", "unknown tolerance `block`"]),
        (&["check", "good.obj", "--set", "search"], &["--set search", "NAME=VALUE"]),
        (&["check", "good.obj", "--set", "search=1", "open=x"], &["--set open=x", "is not a number"]),
        (&["convert", "good.obj", "out.dda"], &["out.dda:", "known are .toml, .obj, .stl, .ply, .msh, .vtk and .vtu"]),
        (&["convert", "good.obj", "nowhere/out.toml"], &["nowhere/out.toml", "No such file"]),
        (&["convert", "third.toml", "out.obj"], &["out.obj", "vertex 1: 1/3 is not an f64", "--precision f64 rounds"]),
        (&["convert", "good.obj", "bytes.toml"], &["bytes.toml: it is there already", "--overwrite"]),
        (&["convert", "missing.obj", "out.obj"], &["missing.obj:", "No such file"]),
    ];
    for (arguments, parts) in cases {
        let (code, message) = run(arguments, directory.path());
        assert_eq!(code, Some(2), "{arguments:?}: {message}");
        assert!(parts.iter().all(|part| message.contains(part)), "{arguments:?}: {message}");
        assert!(!path("out.obj").exists() && !path("out.dda").exists(), "{arguments:?}");
    }
}

/// Few bytes, or some thousand, that ask for gigabytes or for hours.
#[test]
fn greedy_files() {
    let fractions: Vec<String> = (0..40)
        .map(|i| {
            let coordinate = |axis: usize| format!("\"1/{}{}\"", "9".repeat(900), 3 * (3 * i + axis) + 1000);
            format!("[{}, {}, {}]", coordinate(0), coordinate(1), coordinate(2))
        })
        .collect();
    let mesh = format!("[[block]]\nvertices = [{}]\nfaces = [[0, 1, 2]]\n", fractions.join(", "));
    check_all(&[
        ("a.toml", format!("x = {}", "[".repeat(100_000)), &["a.toml:1:", "not valid TOML"]),
        ("a.toml", format!("{}\n{MESH}", "[a.".repeat(50_000)), &["a.toml:1:", "not valid TOML"]),
        (
            "a.toml",
            change(MESH, "[1, 0, 0]", &format!("[\"{}\", 0, 0]", "7".repeat(100_000))),
            &["a.toml:3:", "digits"],
        ),
        ("a.toml", mesh, &["a.toml:1:", "no common denominator below 2^65536"]),
        ("a.obj", "f 1 2 3\n".repeat(10_000), &["a.obj:1:", "there is no vertex above it"]),
        ("a.dda", "#_DDA_DataFile_Version_1.0 POINTS_START_LENGTH 4294967295 ".into(), &["a.dda:1:", "the file ends"]),
        ("a.vtk", change(VTK, "POINTS 16", "FIELD x 1 y 4294967295 4294967295 int"), &["a.vtk:", "the file ends"]),
    ]);
}

#[test]
fn violated_rules_exit_1_with_what_would_satisfy_them() {
    let directory = crate::place::folder();
    std::fs::write(directory.path().join("a.obj"), OBJ).unwrap();
    let mut command = Command::cargo_bin("rockproof").unwrap();
    let output = command.current_dir(&directory).args(["check", "a.obj", "--set", "search=1/200"]).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    let table = String::from_utf8(output.stdout).unwrap();
    for part in [
        "rules: 1 violated\n  search ≥ 2·max_displacement\n",
        "found      5.000000e-3, allowed 1.000000e-2\n",
        "satisfied  by search ≥ 0.0100001 or max_displacement ≤ 0.0025\n",
    ] {
        assert!(table.contains(part), "{table}");
    }
}

#[test]
fn convert_writes_what_loads_again() {
    let directory = crate::place::folder();
    std::fs::write(directory.path().join("a.dda"), DDA).unwrap();
    for (from, to, note) in [
        ("a.dda", "a.toml", ""),
        ("a.toml", "b.obj", "which blocks are fixed (1 is)"),
        ("b.obj", "c.vtk", ""),
        ("c.vtk", "d.toml", ""),
    ] {
        let (code, message) = run(&["convert", from, to], directory.path());
        assert_eq!(code, Some(0), "{message}");
        assert!(message.contains(note), "{message}");
        assert_eq!(run(&["check", to], directory.path()).0, Some(0), "{to}");
    }
    // What is there is replaced where that is said.
    assert_eq!(run(&["convert", "a.toml", "b.obj"], directory.path()).0, Some(2));
    assert_eq!(run(&["convert", "a.toml", "b.obj", "--overwrite"], directory.path()).0, Some(0));
    // A third is no f64, so OBJ and VTK want to be told that it is to be rounded.
    std::fs::write(directory.path().join("third.toml"), change(MESH, "[1, 0, 0]", "[\"1/3\", 0, 0]")).unwrap();
    assert_eq!(run(&["convert", "third.toml", "e.vtk", "--precision", "f64"], directory.path()).0, Some(0));
    let leftovers = std::fs::read_dir(&directory)
        .unwrap()
        .filter(|entry| entry.as_ref().is_ok_and(|entry| entry.file_name().to_string_lossy().ends_with(".tmp")));
    assert_eq!(leftovers.count(), 0);
}

/// A reader that closes early is no reason to panic, nor an error, also where a table is longer than what is written at once.
#[test]
#[cfg(unix)]
fn a_closed_pipe_is_no_panic() {
    let file = |name: &str| format!("{}/cases/real/{name}", env!("CARGO_MANIFEST_DIR"));
    let [short, long] = ["smallAngle.dda", "voronoi_120.txt"].map(file);
    let as_table = |format| vec!["classify", &long, "--planarity", "1e-4", "--format", format];
    for arguments in [vec!["check", &short], as_table("csv"), as_table("json")] {
        let mut child = std::process::Command::new(assert_cmd::cargo::cargo_bin("rockproof"))
            .args(&arguments)
            .stdout(std::process::Stdio::piped())
            .stderr(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn a_scene_and_a_block_file_are_called_what_they_are_where_a_case_is_expected() {
    let directory = crate::place::folder();
    let at = |name: &str| directory.path().join(name);
    std::fs::write(at("scene.toml"), "[[block]]\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\n").unwrap();
    std::fs::write(at("blocks.dda"), DDA).unwrap();
    std::fs::write(at("surface.stl"), [0xff; 100]).unwrap();
    for command in ["replay", "shrink"] {
        for (file, what) in [("scene.toml", "a scene"), ("blocks.dda", "a block file"), ("surface.stl", "a block file")]
        {
            let (code, message) = run(&[command, file], directory.path());
            assert!(code == Some(2) && message.contains(&format!("{file}: this is {what}, not a case")), "{message}");
        }
    }
}

#[test]
fn a_byte_order_mark_is_skipped_in_every_format_of_text() {
    let directory = crate::place::folder();
    let marked = |name: &str, text: &[u8]| {
        std::fs::write(directory.path().join(name), [b"\xef\xbb\xbf", text].concat()).unwrap();
        let (code, message) = run(&["check", name, "--planarity", "1e-4"], directory.path());
        assert!(code == Some(0) || code == Some(1), "{name}: {code:?} {message}");
        assert!(!message.contains("feff"), "{name}: {message}");
    };
    marked("a.dda", DDA.as_bytes());
    marked("a.toml", b"[[block]]\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\n");
    marked("a.txt", include_bytes!("../../cases/real/voronoi_120.txt"));
    marked("a.obj", include_bytes!("../fixtures/two_cubes.obj"));
    marked("a.vtk", include_bytes!("../fixtures/two_cubes.vtk"));
    marked("a.vtu", include_bytes!("../fixtures/cells.vtu"));
    marked("a.msh", include_bytes!("../fixtures/cells.msh"));
    marked("a.ply", include_bytes!("../fixtures/box.ply"));
    marked("a.stl", include_bytes!("../fixtures/two_wedges.stl"));
}

/// A PLY file whose header does not say the format, or whose elements end early: on which line that is seen.
#[test]
fn a_ply_file_without_a_format_or_an_end_is_told_with_its_line() {
    let text = "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\nelement face 4\n\
                property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";
    let short: String = text.split_inclusive('\n').take(16).collect();
    check_all(&[
        ("a.ply", change(text, "format ascii 1.0\n", ""), &["a.ply:2:", "\"element vertex 4\"", "`format ascii 1.0`"]),
        ("b.ply", short, &["b.ply:16:", "the last of 4 elements \"face\""]),
    ]);
}
