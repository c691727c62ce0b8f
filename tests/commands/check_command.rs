//! Pins what `check` says of a model's size, units and planarity, and what `--scale` does.

use crate::campaigns::WITHOUT_CASES;
use crate::place::{Place, rockproof};
use std::fs;
use std::path::{Path, PathBuf};

/// A cube of a size in OBJ, turned so that no face is parallel to an axis; its faces as squares or cut into triangles.
fn cube(dir: &Path, size: f64, digits: usize, triangles: bool) -> PathBuf {
    let ([s, c], [t, d]) = ([0.6, 0.8], [5.0 / 13.0, 12.0 / 13.0]);
    let mut text = String::new();
    for n in 0..8 {
        let [x, y, z] = [n & 1, n >> 1 & 1, n >> 2 & 1].map(|bit| f64::from(bit) * size / 3.0 * 3.0);
        let (x, y) = (c * x - s * y, s * x + c * y);
        let (y, z) = (d * y - t * z, t * y + d * z);
        text += &format!("v {x:.digits$} {y:.digits$} {z:.digits$}\n");
    }
    for [a, b, c, d] in [[1, 3, 4, 2], [1, 2, 6, 5], [1, 5, 7, 3], [2, 4, 8, 6], [3, 7, 8, 4], [5, 6, 8, 7]] {
        text += &match triangles {
            true => format!("f {a} {b} {c}\nf {a} {c} {d}\n"),
            false => format!("f {a} {b} {c} {d}\n"),
        };
    }
    let file = dir.join(format!("cube_{digits}_{triangles}.obj"));
    fs::write(&file, text).expect("written");
    file
}

#[test]
fn a_model_in_millimetres_is_doubted_and_can_be_scaled() {
    let dir = crate::place::folder();
    let file = cube(dir.path(), 1000.0, 5, false);
    let file = file.to_str().expect("text");
    let args = |more: &[&'static str]| [&["check", file, "--planarity", "1e-6"][..], more].concat().join(" ");
    let run = |more| rockproof(&args(more).split(' ').collect::<Vec<_>>());
    let (_, out, err) = run(&[]);
    assert!(out.contains("extent") && out.contains("shortest          1000 m: an edge of block 0"), "{out}");
    assert!(err.contains("millimetres") && err.contains("`convert --scale 1/1000 --precision f64`"), "{err}");
    let (_, out, err) = run(&["--scale", "1/1000"]);
    assert!(out.contains("shortest             1 m") && !err.contains("millimetres"), "{out}{err}");
    assert_eq!(run(&["--scale", "0"]).0, 2);
    // Converted so, it is the same model in metres.
    let metres = dir.path().join("metres.toml");
    let metres = metres.to_str().expect("text");
    let (code, _, err) = rockproof(&["convert", file, metres, "--planarity", "1e-6", "--scale", "1/1000"]);
    assert_eq!(code, 0, "{err}");
    let (_, out, err) = rockproof(&["check", metres]);
    assert!(out.contains("shortest             1 m") && !err.contains("millimetres"), "{out}{err}");
    let (code, _, err) = rockproof(&["check", metres, "--scale", "2"]);
    assert!(code == 2 && err.contains("TOML"), "{err}");
}

/// A cube of a millimetre was said to have a volume of 0.000000 m³.
#[test]
fn a_small_volume_is_told_in_significant_digits() {
    let dir = crate::place::folder();
    let file = dir.path().join("cube.toml");
    for (size, told) in [(0.001, "1.00000e-9"), (0.0625, "2.44141e-4"), (0.5, "0.125000")] {
        fs::write(&file, format!("[[block]]\nbox = {{ min = [0, 0, 0], max = [{size}, {size}, {size}] }}\n"))
            .expect("write");
        let (_, out, err) = rockproof(&["check", &file.to_string_lossy()]);
        let row = out.lines().find(|line| line.trim_start().starts_with("volume"));
        assert_eq!(row, Some(format!("  volume    {told:>12} m³").as_str()), "{out}{err}");
    }
}

/// The cube of side 4 with its top drawn in to an apex: a pit above the floor, and through it below.
fn cube_with_apex(height: i32) -> String {
    let base = "[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0], [0, 0, 4], [4, 0, 4], [4, 4, 4], [0, 4, 4]";
    let faces = "[0, 3, 2, 1], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7], [4, 5, 8], [5, 6, 8], [6, 7, 8], [7, 4, 8]";
    format!("[[block]]\nname = \"rock\"\nvertices = [{base}, [2, 2, {height}]]\nfaces = [{faces}]\n")
}

#[test]
fn a_solid_that_pierces_itself_is_refused() {
    let dir = crate::place::folder();
    let file = dir.path().join("pierced.toml");
    let (model, out) = (file.to_string_lossy().into_owned(), dir.path().join("run").to_string_lossy().into_owned());
    let check = ["check", &model];
    let simulate = ["simulate", &model, "--steps", "1", "--out", &out];
    fs::write(&file, cube_with_apex(-1)).expect("written");
    for command in [&check[..], &simulate, &[&simulate[..], &["--force"]].concat()] {
        let (code, _, err) = rockproof(command);
        let said = ["pierced.toml", "\"rock\"", "faces 5 and 0 meet", "edge 5-8 of face 5 crosses or touches face 0"];
        assert!(code == 2 && said.iter().all(|part| err.contains(part)), "{command:?}: {err}");
    }
    assert!(!dir.path().join("run").exists());
    // With the apex above the floor it is a block.
    fs::write(&file, cube_with_apex(1)).expect("written");
    for command in [&check[..], &simulate] {
        let (code, _, err) = rockproof(command);
        assert_eq!(code, 0, "{command:?}: {err}");
    }
}

/// Two cubes in millimetres, one a millimetre above the other and half over its edge.
fn two_cubes_in_millimetres() -> String {
    let mut text = String::new();
    for block in 0..2 {
        text += &format!("o block_{block}\n");
        for corner in 0..8 {
            let [x, y, z] = [corner & 1, corner >> 1 & 1, block + (corner >> 2 & 1)].map(|at| 1000 * at);
            text += &format!("v {} {y} {}\n", x + 500 * block, z + block);
        }
        for [a, b, c, d] in [[1, 3, 4, 2], [1, 2, 6, 5], [1, 5, 7, 3], [2, 4, 8, 6], [3, 7, 8, 4], [5, 6, 8, 7]] {
            let [a, b, c, d] = [a, b, c, d].map(|corner| corner + 8 * block);
            text += &format!("f {a} {b} {c} {d}\n");
        }
    }
    text
}

#[test]
fn every_command_reads_a_file_in_millimetres_as_its_conversion() {
    let dir = crate::place::folder();
    let path = |name: &str| dir.path().join(name).to_str().expect("text").to_owned();
    let [mm, metres] = ["two.obj", "two.toml"].map(path);
    fs::write(&mm, two_cubes_in_millimetres()).expect("written");
    let scale = ["--scale", "1/1000"];
    let run = |args: &[&str]| {
        let (code, out, err) = rockproof(args);
        assert!(code == 0 || code == 1, "{args:?}: {code} {err}");
        out
    };
    run(&["convert", &mm, &metres, scale[0], scale[1]]);
    let both = |before: &[&str], after: &[&str], result: &dyn Fn(&str, &str) -> String| {
        let of = |file: &str, more: &[&str], name: &str| {
            let out = path(&format!("{}-{name}", before[0]));
            let mut args = [before, &[file], more, after].concat();
            if before[0] != "classify" {
                args.extend(["--out", &out]);
            }
            let printed = run(&args);
            result(&printed, &out)
        };
        let (scaled, converted) = (of(&mm, &scale, "scaled"), of(&metres, &[], "converted"));
        assert!(scaled == converted && scaled.lines().count() > 1, "{before:?}\n{scaled}\n{converted}");
        assert!(of(&mm, &[], "plain") != scaled, "{before:?} without a scale");
    };
    let file = |name: &'static str| {
        move |_: &str, out: &str| fs::read_to_string(std::path::Path::new(out).join(name)).expect("a table")
    };
    both(&["classify"], &["--format", "csv"], &|printed, _| printed.to_owned());
    both(&["simulate"], &["--steps", "2", "--force"], &file("steps.csv"));
    both(&["tune"], &["--candidates", "2", "--steps", "1"], &file("candidates.csv"));
    both(&["examine"], &["--no-tune", "--steps", "0"], &file("tolerances.csv"));
    both(&["campaign", WITHOUT_CASES, "--family", "real", "--pairs", "128", "--real"], &[], &file("findings.csv"));
    // Not for scenes, which have other lengths as well, nor without files that it is about.
    for args in
        [&["classify", &*metres][..], &["simulate", &*metres], &["tune", &*metres], &["campaign", "--real", &*metres]]
    {
        let (code, _, err) = rockproof(&[args, &["--scale", "2"]].concat());
        assert!(code == 2 && err.contains("two.toml: a scale is for files of coordinates"), "{args:?}: {err}");
    }
    let (code, _, err) = rockproof(&["campaign", "--scale", "2"]);
    assert!(code == 2 && err.contains("--scale is about the files of --real"), "{err}");
    let settings = path("campaign.toml");
    fs::write(&settings, format!("real = ['{mm}']\nscale = 0\n")).expect("written");
    let (code, _, err) = rockproof(&["campaign", &settings]);
    assert!(code == 2 && err.contains("scale is 0; allowed is above 0"), "{err}");
}

#[test]
fn the_planarity_that_merges_triangles_is_named() {
    let dir = crate::place::folder();
    let file = cube(dir.path(), 1.0, 8, true);
    let (_, out, err) = rockproof(&["check", file.to_str().expect("text")]);
    assert!(out.contains("concave              1") && out.contains("rules: all met"), "rounding bent it: {out}");
    assert!(err.contains("they are 6, and 0 blocks concave instead of 1"), "{err}");
    let planarity = err.split("--planarity ").nth(1).and_then(|rest| rest.split(' ').next()).expect("a planarity");
    let (_, out, err) = rockproof(&["check", file.to_str().expect("text"), "--planarity", planarity]);
    assert!(out.contains("faces                6") && out.contains("concave              0"), "{out}");
    assert!(!err.contains("nearly coplanar"), "{err}");
}

#[test]
fn the_planarity_that_reads_a_file_is_named_once() {
    let file = "cases/real/voronoi_120.txt";
    let (code, _, err) = rockproof(&["check", file]);
    assert_eq!(code, 2);
    assert!(err.lines().count() < 8 && err.contains("and 117 more of this sort"), "{err}");
    let planarity = err.split("--planarity ").nth(1).and_then(|rest| rest.lines().next()).expect("a planarity");
    assert_ne!(rockproof(&["check", file, "--planarity", planarity]).0, 2, "{planarity}");
    let (code, _, err) = rockproof(&["classify", file]);
    assert!(code == 2 && err.contains("--planarity"), "{err}");
}

#[test]
fn merging_that_changes_no_shape_is_not_said_to() {
    let dir = crate::place::folder();
    let file = dir.path().join("cube.obj");
    // A corner pulled out where the cut of a face ends, so that the cube stays convex.
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1.0000001 1 1\nf 1 3 4 2\nf 1 2 6 5\nf 1 5 7 3\nf 2 4 8\nf 2 8 6\nf 3 7 8 4\nf 5 6 8 7\n";
    fs::write(&file, text).expect("written");
    let (code, _, err) = rockproof(&["check", file.to_str().expect("text")]);
    assert_eq!(code, 0, "{err}");
    assert!(err.contains("7 faces, of which some are nearly coplanar: with --planarity 1e-7 they are 6\n"), "{err}");
}

#[test]
fn blocks_that_overlap_are_named_where_they_have_names() {
    let dir = crate::place::folder();
    let file = dir.path().join("overlap.toml");
    let at = |number: i32, name: &str| {
        format!("[[block]]\n{name}box = {{ min = [{number}, 0, 0], max = [{number}.75, 1, 1] }}\n")
    };
    let sunk = |name: &str| format!("[[block]]\n{name}box = {{ min = [0.5, 0, 0], max = [0.9, 1, 1] }}\n");
    let pairs = |text: String| {
        fs::write(&file, text).expect("written");
        rockproof(&["check", file.to_str().expect("text")]).1
    };
    let out = pairs(at(0, "name = \"b2_4\"\n") + &sunk("name = \"b3_4\"\n"));
    assert!(out.contains("\n  0–1 (b2_4, b3_4)       0.2500 m  "), "{out}");
    let out = pairs(at(0, "") + &sunk("name = \"lid\"\n"));
    assert!(out.contains("\n  0–1 (block_0, lid)       0.2500 m  "), "{out}");
    // A number is no name.
    let out = pairs(at(0, "name = \"0\"\n") + &sunk(""));
    assert!(out.contains("\n  0–1               0.2500 m  "), "{out}");
}

#[test]
#[cfg(target_os = "linux")]
fn a_stdout_without_room_is_named() {
    for arguments in
        [&["check", "cases/real/smallEdge.dda"][..], &["classify", "cases/real/smallEdge.dda", "--format", "csv"]]
    {
        let full = fs::OpenOptions::new().write(true).open("/dev/full").expect("a device");
        let ended = std::process::Command::new(env!("CARGO_BIN_EXE_rockproof"))
            .args(arguments)
            .stdout(full)
            .output()
            .expect("an end");
        let err = String::from_utf8_lossy(&ended.stderr);
        assert_eq!(ended.status.code(), Some(2), "{err}");
        assert!(err.contains("error: stdout: No space left on device"), "{err}");
    }
}

/// The flat corner is one face with what a planarity of 1e-5 merges, and that is further from its neighbour's plane than one of its triangles is.
#[test]
fn triangles_that_were_merged_may_merge_further() {
    let place = Place::new();
    place.file(
        "corner.obj",
        "v 0 0 0\n\
         v 2 0 0\n\
         v 1.2 1.2 1e-06\n\
         v 0 2 0\n\
         v -8 2 -0.048\n\
         v -8 -8 -0.048\n\
         v 2 -8 -0.048\n\
         v 2 0 -3\n\
         v 1.2 1.2 -3\n\
         v 0 2 -3\n\
         v -8 2 -3\n\
         v -8 -8 -3\n\
         v 2 -8 -3\n\
         f 1 2 3\n\
         f 1 3 4\n\
         f 1 6 7 2\n\
         f 1 4 5 6\n\
         f 13 12 11 10 9 8\n\
         f 3 2 8 9\n\
         f 4 3 9 10\n\
         f 5 4 10 11\n\
         f 6 5 11 12\n\
         f 7 6 12 13\n\
         f 2 7 13 8\n",
    );
    let (code, _, err) = place.run(&["check", "corner.obj", "--planarity", "1e-5"]);
    let told = "10 faces, of which some are nearly coplanar: with --planarity 1e-3 they are 9";
    assert!(code == 0 && err.contains(told), "{err}");
}
