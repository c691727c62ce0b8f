//! Pins models that are no longer called safe without a word: overlaps deeper than `penetration` in the audited steps, loads that contacts cannot bear, energy that a heavy
//! free base does not explain, blocks that touch nothing, `young` in GPa, coordinates in f32 far from the origin; and what is said of slivers, falls and f32.
//!
//! Caught: all of these were "safe: nothing is wrong".

use crate::place::Place;
use std::fmt::Write;
use std::fs;

/// A cube of 1 m on a fixed plate of 4 m by 4 m by 1 m.
const CUBE: &str = "[[block]]\nbox = { min = [0, 0, 0], max = [4, 4, 1] }\nfixed = true\n\
    [[block]]\nname = \"b\"\nbox = { min = [1, 1, 1], max = [2, 2, 2] }\n";

/// What `examine` says, without a search: its exit code and its text.
fn examined(place: &Place, name: &str, more: &[&str]) -> (i32, String) {
    let args = ["examine", name, "--no-tune", "--out", "examined", "--overwrite"];
    let (code, out, err) = place.run(&[&args[..], more].concat());
    assert!(!out.is_empty(), "{err}");
    (code, out)
}

/// As of a file in metres whose tolerances are in millimetres. All is done as asked.
#[test]
fn tolerances_longer_than_the_model_are_doubted() {
    let place = Place::new();
    place.file("cube.toml", CUBE);
    let commands: [&[&str]; 5] = [
        &["check", "cube.toml"],
        &["classify", "cube.toml"],
        &["simulate", "cube.toml", "--steps", "1", "--out", "run", "--overwrite"],
        &["examine", "cube.toml", "--no-tune", "--out", "examined", "--overwrite"],
        &["tune", "cube.toml", "--candidates", "1", "--steps", "1", "--out", "tuned", "--overwrite"],
    ];
    for command in commands {
        let (code, _, err) = place.run(command);
        assert!(!err.contains("longer than the whole model"), "{command:?}: {err}");
        let (doubted, _, err) = place.run(&[command, &["--set", "search=147.9"]].concat());
        let told = "note: search is 147.9 m, longer than the whole model, which is 6 m from corner to corner; tolerances are in metres: 147.9 mm are 0.1479\n";
        assert_eq!((doubted, err.matches(told).count()), (code, 1), "{command:?}: {err}");
    }
}

/// A share of a block's size, taken for a length. Faces that are in one plane stay as they are.
#[test]
fn a_planarity_that_any_polygon_meets_is_doubted() {
    let place = Place::new();
    place.file("cube.toml", CUBE);
    place.file("two.toml", &CUBE.replace("fixed = true", ""));
    let campaign =
        ["campaign", "--real", "two.toml", "--family", "real", "--pairs", "16", "--out", "run", "--overwrite"];
    for command in
        [&["check", "cube.toml"][..], &["classify", "cube.toml"], &["convert", "cube.toml", "again.toml"], &campaign]
    {
        let told = |share: &str| {
            let (code, _, err) = place.run(&[command, &["--planarity", share]].concat());
            assert_eq!(code, 0, "{command:?}: {err}");
            std::fs::remove_file(place.path("again.toml")).ok();
            err.contains(&format!("note: planarity is {share}, a share of a block's size and no length: "))
        };
        assert_eq!(["5", "0.11", "0.1", "1e-3"].map(told), [true, true, false, false], "{command:?}");
    }
}

/// As a generator wrote it twice, with its corners in another order.
#[test]
fn blocks_given_twice_are_named() {
    let place = Place::new();
    let wedge = |name: &str, [a, b]: [&str; 2]| {
        format!(
            "[[block]]\nname = \"{name}\"\nvertices = [{a}, {b}, [0, 1, 0], [0, 0, 1]]\nfaces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]\n"
        )
    };
    let turned = "[[block]]\nname = \"b\"\nvertices = [[0, 0, 1], [0, 1, 0], [1, 0, 0], [0, 0, 0]]\nfaces = [[3, 1, 2], [3, 2, 0], [2, 1, 0], [1, 3, 0]]\n";
    let (one, other) = (wedge("a", ["[0, 0, 0]", "[1, 0, 0]"]), wedge("a", ["[0, 0, 0]", "[1.5, 0, 0]"]));
    let told = |blocks: &[&str]| {
        place.file("blocks.toml", &blocks.concat());
        place.run(&["check", "blocks.toml"]).2
    };
    assert!(!told(&[&one, &other]).contains("has the corners of"));
    let twice = "note: block 2 \"b\" has the corners of block 0 \"a\": a block that is given twice lies within itself, and contacts cannot hold that\n";
    assert!(told(&[&one, &other, turned]).contains(twice));
    assert!(
        told(&[&one, &one, turned]).contains("block 1 \"a\" has the corners of block 0 \"a\", and so has 1 more: ")
    );
}

#[test]
fn steps_that_end_deeper_than_penetration_are_not_called_safe() {
    let place = Place::new();
    let scene =
        CUBE.replace("[1, 1, 1]", "[1, 1, 1.01]") + "velocity = [0, 0, -50]\n[[joint]]\nnormal_stiffness = 1e7\n";
    place.file("fast.toml", &scene);
    let (code, out) = examined(&place, "fast.toml", &[]);
    let said = "not decided: blocks overlap deeper than penetration after steps, held only by contacts closed before; a block that moves when time begins may be stopped only deeper than penetration\n";
    assert!(code == 1 && out.starts_with(said), "{out}");
    assert!(out.contains("  i steps ") && out.contains("deeper than penetration after 6 of 8 steps"), "{out}");
    assert!(out.contains("  i speed ") && out.contains("next: rockproof check fast.toml"), "{out}");
    place.file("slow.toml", &scene.replace("-50", "-1"));
    let (code, out) = examined(&place, "slow.toml", &[]);
    assert!(code == 0 && out.contains("  ✓ steps "), "{out}");
}

#[test]
fn loads_that_contacts_cannot_bear_are_told_also_where_they_come_later() {
    let place = Place::new();
    let told = |load: &str| {
        place.file("load.toml", &format!("{CUBE}[[load]]\nblock = \"b\"\nat = [1.5, 1.5, 2]\n{load}\n"));
        let (code, checked, _) = place.run(&["check", "load.toml"]);
        let said = checked
            .contains("warning: a block may sink deeper than penetration under the blocks above it or under loads");
        let (examined, out) = examined(&place, "load.toml", &[]);
        assert_eq!((code, examined, out.starts_with("not decided: ")), (0, i32::from(said), said), "{checked}{out}");
        checked
            .lines()
            .skip_while(|line| !line.contains("·corners of its smallest face) ≤ penetration"))
            .nth(1)
            .map(str::to_owned)
    };
    // F/(4·1e10 N/m), and the weight.
    let found = told("force = [0, 0, -3e9]").expect("a warning");
    assert!(found.starts_with("    found      7.500064e-2, allowed 2.000000e-2, by block 1"), "{found}");
    let later = told("table = [[0, 0, 0, 0], [0.2, 0, 0, 0], [0.21, 0, 0, -1e10]]").expect("a warning");
    assert!(later.contains("2.500006e-1"), "{later}");
    assert_eq!(told("force = [0, 0, -9e7]"), None, "2 mm");
    assert_eq!(told("table = [[-1, 0, 0, -1e10], [0, 0, 0, 0]]"), None, "before time begins");
}

/// The weight of a block below presses nothing together with the block on it.
#[test]
fn a_heavy_free_base_does_not_explain_the_energy_of_what_stands_on_it() {
    let place = Place::new();
    let scene = "[[block]]\nbox = { min = [0, 0, -2], max = [100, 100, 0] }\n\
        [[block]]\nbox = { min = [50, 50, -0.01], max = [51, 51, 1] }\n[[joint]]\nnormal_stiffness = 1e10\n";
    for (name, base) in [("free.toml", ""), ("fixed.toml", "fixed = true\n")] {
        let text = scene.replacen("max = [100, 100, 0] }\n", &format!("max = [100, 100, 0] }}\n{base}"), 1);
        place.file(name, &text);
        let (code, out) = examined(&place, name, &[]);
        // 2600 kg · 1.01 · 9.81 · (2 · 2.6 µm + 0.01 m)
        let said = "springs of blocks 0–1 store 2.000e6 J, their weights and loads explain 257.7 J";
        assert!(code == 1 && out.starts_with("not decided: ") && out.contains(said), "{name}: {out}");
        let (_, out, _) = place.run(&["check", name]);
        assert!(out.contains(said), "{name}: {out}");
    }
    // The other way round the large one presses, 1.3e6 N on each of four springs: at rest there, nothing is told.
    let turned = "[[block]]\nfixed = true\nbox = { min = [0, 0, -1], max = [9, 9, 0] }\n\
        [[block]]\nbox = { min = [4, 4, 0], max = [5, 5, 1] }\n\
        [[block]]\nbox = { min = [3, 3, 0.98], max = [6, 6, 3.98] }\n[[joint]]\nnormal_stiffness = 1e7\n";
    place.file("turned.toml", turned);
    let (_, out) = examined(&place, "turned.toml", &[]);
    assert!(!out.contains("  i energy "), "{out}");
}

#[test]
fn the_headline_says_how_many_blocks_touch_nothing() {
    let place = Place::new();
    let mut scene = CUBE.to_owned();
    for x in 1..=3 {
        let _ = writeln!(scene, "[[block]]\nbox = {{ min = [{}, 0, 0], max = [{}, 1, 1] }}", 10 * x, 10 * x + 1);
    }
    place.file("apart.toml", &scene);
    let (_, out) = examined(&place, "apart.toml", &[]);
    let said = "safe: nothing is wrong with 1 neighbouring pair under auto in f64, but 3 of 5 blocks touch nothing\n";
    assert!(out.starts_with(said), "{out}");
}

#[test]
fn young_in_gigapascals_is_doubted() {
    let place = Place::new();
    let young = |pascals: &str| {
        place.file("young.toml", &format!("[[material]]\nname = \"rock\"\nyoung = {pascals}\n{CUBE}"));
        examined(&place, "young.toml", &[])
    };
    let (code, out) = young("50");
    assert!(
        code == 1
            && out.starts_with("not decided: a block may be squashed by its weight, by loads or by its initial stress"),
        "{out}"
    );
    // 2600 kg/m³ · 9.81 m/s² · 1 m/50 Pa.
    assert!(out.contains("  i strain     a block may be squashed by its weight, by loads or by its initial stress: found 255.1, allowed 0.01 (block 1): use young ≥ 1.275"), "{out}");
    let (_, checked, _) = place.run(&["check", "young.toml"]);
    assert!(
        checked.contains("because    strains are taken for small, and rock breaks long before: young is in Pa"),
        "{checked}"
    );
    assert_eq!(young("50e9").0, 0);
}

/// Two cubes of 1 m on one another, so far off along y, as a binary STL or as a PLY with this type of coordinates.
fn cubes(file: &str, away: f64, kind: &str) -> Vec<u8> {
    let (mut triangles, mut ply_points, mut ply_faces) = (Vec::<u8>::new(), String::new(), String::new());
    for (number, base) in [0.0, 1.0].into_iter().enumerate() {
        let corner = |k: usize| [(k & 1) as f64, away + (k >> 1 & 1) as f64, base + (k >> 2) as f64];
        (0..8).for_each(|k| {
            let [x, y, z] = corner(k);
            let _ = writeln!(ply_points, "{x} {y} {z}");
        });
        for [a, b, c, d] in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
            let _ =
                writeln!(ply_faces, "4 {} {} {} {}", a + 8 * number, b + 8 * number, c + 8 * number, d + 8 * number);
            for triangle in [[a, b, c], [a, c, d]] {
                triangles.extend([0; 12]);
                let numbers = triangle.into_iter().flat_map(corner);
                triangles.extend(numbers.flat_map(|number| (number as f32).to_le_bytes()));
                triangles.extend([0; 2]);
            }
        }
    }
    if file.ends_with("stl") {
        let mut all = vec![b' '; 80];
        all.extend(24_u32.to_le_bytes());
        return [all, triangles].concat();
    }
    let properties = ["x", "y", "z"].map(|axis| format!("property {kind} {axis}\n")).concat();
    let header = format!(
        "ply\nformat ascii 1.0\nelement vertex 16\n{properties}element face 12\nproperty list uchar int vertex_indices\nend_header\n"
    );
    (header + &ply_points + &ply_faces).into_bytes()
}

#[test]
fn coordinates_in_f32_far_from_the_origin_are_doubted() {
    let place = Place::new();
    for (file, kind, is_single) in [
        ("cubes.stl", "", true),
        ("cubes.ply", "float", true),
        ("cubes.ply", "float32", true),
        ("cubes.ply", "double", false),
    ] {
        for (away, is_coarse) in [(16_384.0, true), (4_096.0, false)] {
            fs::write(place.path(file), cubes(file, away, kind)).expect("write");
            let told = is_single && is_coarse;
            let (code, out) = examined(&place, file, &[]);
            assert_eq!(
                (code, out.starts_with("not decided: coordinates of the file were rounded to f32\n")),
                (i32::from(told), told),
                "{out}"
            );
            let said = "the file has coordinates in f32, which at 16385 m are 0.001953 m apart, and the shortest edge is 1 m: export it relative to a local origin, or in double precision";
            let (_, _, err) = place.run(&["check", file]);
            assert_eq!((out.contains(said), err.contains(said)), (told, told), "{file} {kind} {away}: {out}{err}");
        }
    }
}

/// An OBJ of boxes with these sides on one another.
fn boxes(sides: &[f64]) -> String {
    let (mut text, mut z) = (String::new(), 0.0);
    for (number, side) in sides.iter().enumerate() {
        let _ = writeln!(text, "o b{number}");
        for k in 0..8 {
            let at = |bit: usize| if k >> bit & 1 == 1 { *side } else { 0.0 };
            let _ = writeln!(text, "v {} {} {}", at(0), at(1), z + at(2));
        }
        for face in [[1, 3, 4, 2], [5, 6, 8, 7], [1, 2, 6, 5], [3, 7, 8, 4], [1, 5, 7, 3], [2, 4, 8, 6]] {
            let [a, b, c, d] = face.map(|vertex| vertex + 8 * number);
            let _ = writeln!(text, "f {a} {b} {c} {d}");
        }
        z += side;
    }
    text
}

#[test]
fn units_are_doubted_only_where_most_blocks_and_not_one_of_few_are_too_small_or_large() {
    let place = Place::new();
    let doubted = |sides: &[f64]| {
        place.file("boxes.obj", &boxes(sides));
        let (_, _, err) = place.run(&["check", "boxes.obj"]);
        err.contains("half of the blocks are ")
    };
    let (small, large) = (1e-4, 200.0);
    for (sides, is_doubted) in [
        (&[4.0, small][..], false),
        (&[small, small], true),
        (&[small], true),
        (&[4.0, small, small], false),
        (&[small, small, small, 4.0], true),
        (&[small, small, 4.0, 4.0], false),
        (&[large, 4.0], false),
        (&[large, large, large, 4.0, 4.0], true),
    ] {
        assert_eq!(doubted(sides), is_doubted, "{sides:?}");
    }
}

#[test]
fn what_no_tolerance_mends_in_f32_is_said_and_the_search_is_in_f32() {
    let place = Place::new();
    let far = CUBE.replace("[0, 0, 0], max = [4, 4, 1]", "[0, 4649776, 0], max = [4, 4649780, 1]");
    place.file("far.toml", &far.replace("[1, 1, 1], max = [2, 2, 2]", "[1, 4649777, 1], max = [2, 4649778, 2]"));
    let (code, out) = examined(&place, "far.toml", &["--precision", "f32"]);
    let said =
        "rule violated, and no tolerances keep all in f32 at such coordinates: only a local origin helps, or f64";
    assert!(code == 1 && out.starts_with("not safe: ") && out.contains(said), "{out}");
    assert!(out.ends_with("next: rockproof convert far.toml far-local.toml --origin local\n"), "{out}");
    // Of a model that is itself so large no other origin makes coordinates smaller.
    place.file("wide.toml", &CUBE.replace("max = [4, 4, 1]", "max = [4, 4649780, 1]"));
    let (_, out) = examined(&place, "wide.toml", &["--precision", "f32"]);
    assert!(out.ends_with("next: rockproof examine wide.toml --precision f64 --out examined --overwrite\n"), "{out}");
    let (_, out, _) = place.run(&["check", "far.toml", "--precision", "f32"]);
    assert!(out.contains("satisfied  by all coordinates ≤ ") && !out.contains("territory ≥ 14"), "{out}");
    // A territory that is only too small can be mended, in the same precision.
    place.file("near.toml", CUBE);
    let (_, out) = examined(&place, "near.toml", &["--precision", "f32", "--set", "territory=1e-6"]);
    assert!(out.ends_with("next: rockproof tune near.toml --set 'territory=1e-6' --engine stepper-f32\n"), "{out}");
    let (_, out, _) = place.run(&["check", "near.toml", "--precision", "f32", "--set", "territory=1e-6"]);
    assert!(out.contains("satisfied  by territory ≥ "), "{out}");
}

/// Of blocks as heavy as one another the one that lies highest is named.
#[test]
fn the_fall_is_that_of_a_block_that_can_fall() {
    let place = Place::new();
    let scene =
        format!("{CUBE}[[block]]\nbox = {{ min = [1, 1, 20], max = [2, 2, 21] }}\n[[joint]]\nnormal_stiffness = 1e7\n");
    place.file("fall.toml", &scene);
    let (code, out) = examined(&place, "fall.toml", &[]);
    assert!(code == 0 && out.contains("  i fall       block 2, falling 21 m, would end "), "{out}");
}
