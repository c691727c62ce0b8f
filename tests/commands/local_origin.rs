//! Coordinates far larger than the model: `examine` says what a local origin mends, and `convert --origin` gives one.

use crate::place::Place;
use serde_json::Value;

/// A prism on a flank of five vertices, at eastings and northings: rounding the mean of the flank's vertices moves its plane by more than the prism overlaps.
const SITE: &str = r#"
planarity = 1e-8

[[joint]]
normal_stiffness = 1e10

[[block]]
name = "flank"
fixed = true
vertices = [[453216.45508773427, 5210880.12, 815.8414586181062], [453215.8815112979, 5210880.12, 815.0223065738172], [453215.8815112979, 5210884.12, 815.0223065738172], [453217.60224060697, 5210884.12, 817.4797627066843], [453217.60224060697, 5210882.503507186, 817.4797627066843], [453229.5615204429, 5210880.12, 806.6642356364895], [453228.9879440065, 5210880.12, 805.8450835922006], [453228.9879440065, 5210884.12, 805.8450835922006], [453230.7086733156, 5210884.12, 808.3025397250675], [453230.7086733156, 5210882.503507186, 808.3025397250675]]
faces = [[4, 3, 2, 1, 0], [5, 6, 7, 8, 9], [0, 1, 6, 5], [1, 2, 7, 6], [2, 3, 8, 7], [3, 4, 9, 8], [4, 0, 5, 9]]

[[block]]
name = "wedge"
motion = "rigid"
vertices = [[453221.5420729309, 5210879.762473922, 812.6457456132866], [453221.5420729309, 5210880.477526078, 812.6457456132866], [453222.2303646545, 5210881.907630389, 813.6287280664335], [453222.2303646545, 5210878.332369612, 813.6287280664335], [453223.18037701945, 5210879.762473922, 811.4985927405846], [453223.18037701945, 5210880.477526078, 811.4985927405846], [453223.8686687431, 5210881.907630389, 812.4815751937314], [453223.8686687431, 5210878.332369612, 812.4815751937314]]
faces = [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]

[[measured_point]]
name = "c"
block = "wedge"
at = [453222.7627284806, 5210880.12, 812.6455756079379]
"#;

fn examined(place: &Place, file: &str, options: &[&str]) -> (i32, String) {
    let common = ["examine", file, "--out", "examined", "--overwrite", "--no-tune"];
    let (code, out, err) = place.run(&[&common[..], options].concat());
    assert!(code < 2, "{err}");
    (code, out)
}

#[test]
fn examine_says_what_a_local_origin_mends_and_the_command_that_is_next_does_it() {
    let place = Place::new();
    place.file("site.toml", SITE);
    let (code, out) = examined(&place, "site.toml", &[]);
    assert_eq!(code, 1, "{out}");
    assert!(out.starts_with("not safe: 1 pair broken in f64, none of them relative to a local origin\n"), "{out}");
    assert!(out.contains(", but none relative to a local origin at (453210, 5210870, 800) (contacts"), "{out}");
    assert!(out.ends_with("next: rockproof convert site.toml site-local.toml --origin local\n"), "{out}");
    let (_, json) = examined(&place, "site.toml", &["--format", "json"]);
    let document: Value = serde_json::from_str(&json).expect("JSON");
    let expected =
        serde_json::json!({ "origin_m": [453_210.0, 5_210_870.0, 800.0], "pairs_broken": 0, "rules_violated": 0 });
    assert_eq!(document["local_origin"], expected);

    let (code, out, err) = place.run(&["convert", "site.toml", "site-local.toml", "--origin", "local"]);
    assert_eq!((code, out.as_str()), (0, "site-local.toml: 2 blocks\n"), "{err}");
    assert!(err.contains("the origin is now where (453210, 5210870, 800) was"), "{err}");
    let (_, out) = examined(&place, "site-local.toml", &[]);
    assert!(out.contains("✓ f64        0 of 1 neighbouring pair differs"), "{out}");

    // The points go along, exactly, and the way back ends where it began.
    let back = ["convert", "site-local.toml", "back.toml", "--origin=-453210,-5210870,-800"];
    assert_eq!(place.run(&back).0, 0);
    assert_eq!(place.run(&["convert", "site.toml", "same.toml"]).0, 0);
    assert_eq!(place.read("back.toml"), place.read("same.toml"));
}

/// At a northing of five thousand kilometres f32 has steps of half a metre: no block of 0.1 m has a shape.
#[test]
fn a_block_that_has_no_shape_in_f32_is_not_safe_there() {
    let place = Place::new();
    let cube = |from: [&str; 3], to: [&str; 3]| {
        format!("[[block]]\nbox = {{ min = [{}], max = [{}] }}\n", from.join(", "), to.join(", "))
    };
    let floor = cube(["0", "5210880", "0"], ["0.1", "5210880.1", "0.1"]);
    place.file("small.toml", &format!("{floor}{}", cube(["0", "5210880", "0.1"], ["0.1", "5210880.1", "0.2"])));
    let (code, out, err) = place.run(&["examine", "small.toml", "--precision", "f32", "--out", "examined"]);
    assert!(code == 1 && out.starts_with("not safe: "), "{out}{err}");
    assert!(out.contains("  i set        not looked for: block 0: "), "{out}");
    assert!(out.ends_with("next: rockproof convert small.toml small-local.toml --origin local\n"), "{out}");
}

#[test]
fn how_far_rounding_moves_vertices_is_said() {
    let place = Place::new();
    place.file("site.toml", SITE);
    let said = |file: &str, precision: &str| {
        let (code, _, err) = place.run(&["convert", file, "to.toml", "--precision", precision, "--overwrite"]);
        assert_eq!(code, 0, "{err}");
        err
    };
    let err = said("site.toml", "f64");
    assert!(!err.contains("moved"), "{err}");
    place.file("thirds.toml", "[[block]]\nbox = { min = [0, 0, 0], max = [1, \"1/3\", 1] }\n");
    let err = said("thirds.toml", "f32");
    // 1/3 is 0x3eaaaaab in f32, off by 2⁻²⁵/3.
    assert!(err.contains("f32 moved 4 of 8 vertices, by at most 9.934e-9 m"), "{err}");
}

#[test]
fn an_origin_is_three_numbers_or_local() {
    let place = Place::new();
    place.file("site.toml", SITE);
    for (origin, said) in [
        ("1,2", "2 numbers; allowed are three, X,Y,Z in metres, and `local`"),
        ("1,2,x", "\"x\": "),
        ("", "\"\": "),
        ("1e46,0,0", "site.toml: --origin: block 0 \"flank\": a coordinate of -1e46 m; beyond "),
    ] {
        let (code, _, err) = place.run(&["convert", "site.toml", "to.toml", "--origin", origin]);
        assert!(code == 2 && err.contains(said), "{origin}: {err}");
        assert!(!place.path("to.toml").exists());
    }
    place.file("near.toml", "[[block]]\nbox = { min = [200, 0, 0], max = [213, 1, 1] }\n");
    let (code, _, err) = place.run(&["convert", "near.toml", "to.toml", "--origin", "local"]);
    assert!(
        code == 0 && err.contains("the origin stays: coordinates are no more than 16 times as large as the model"),
        "{err}"
    );
}
