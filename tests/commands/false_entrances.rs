//! Contacts that push where nothing met, or through a face that another block covers: `simulate`, its report and `examine` tell them, and nothing else is called so.

use crate::place::Place;
use serde_json::Value;

/// A block without friction on a floor that ends at x = `seam`, where another floor begins flush with it; gravity pulls it down and to the right, as on a slope of 30°.
fn slope(seam: f64) -> String {
    let floor = |from: f64, to: f64| {
        format!("[[block]]\nfixed = true\nbox = {{ min = [{from}, -2, -1], max = [{to}, 2, 0] }}\n")
    };
    format!(
        "[simulation]\ngravity = [4.999999999999999, 0, -8.660254037844387]\ntime_step = 0.01\nsettle = 100\n[[joint]]\nfriction = 0\n{}{}\
         [[block]]\nmotion = \"rigid\"\nbox = {{ min = [-0.5, -0.5, 0], max = [0.5, 0.5, 0.5] }}\n",
        floor(-3.0, seam),
        floor(seam, 8.0)
    )
}

/// A block that falls past a ledge, 3 mm beside it.
const LEDGE: &str = r#"
[simulation]
gravity = [0, 0, -10]
time_step = 0.01
[[block]]
fixed = true
box = { min = [0.503, -1, -2], max = [1.5, 1, -0.4] }
[[block]]
box = { min = [-0.5, -0.5, 0], max = [0.5, 0.5, 1] }
"#;

/// The line of `simulate` on false entrances, and the same in JSON.
fn told(place: &Place, scene: &str, steps: &str) -> (Option<String>, Value) {
    place.file("scene.toml", scene);
    let run = ["simulate", "scene.toml", "--steps", steps, "--out", "run", "--overwrite"];
    let (code, out, err) = place.run(&run);
    assert_eq!(code, 0, "{out}{err}");
    let line = out.lines().find_map(|line| line.strip_prefix("false entrances  ")).map(str::to_owned);
    let (_, json, _) = place.run(&[&run[..], &["--format", "json"]].concat());
    let document: Value = serde_json::from_str(&json).expect("JSON");
    (line, document["audit"]["false_entrances"].clone())
}

#[test]
fn a_seam_that_stops_what_slides_over_it_is_told() {
    let place = Place::new();
    let (line, json) = told(&place, &slope(0.6), "25");
    let line = line.expect("a line");
    let said = "contacts pushed a block out through a face that another block covers in ";
    assert!(line.starts_with(said) && line.contains(" (first 1–2 into 0, step 21, "), "{line}");
    assert_eq!(
        (&json["covered"]["blocks"], &json["covered"]["into"]),
        (&serde_json::json!([1, 2]), &0.into()),
        "{json}"
    );
    assert_eq!(json["unmet"], Value::Null);
    let (_, out, _) = place.run(&["report", "run", "--out", "report"]);
    assert!(out.contains("run: false entrances: contacts pushed a block out"), "{out}");
    let (code, out, _) = place.run(&["examine", "scene.toml", "--steps", "25", "--no-tune", "--out", "examined"]);
    let answer = "not decided: contacts push blocks where nothing holds them (false entrances), so that they move otherwise than rock does\n";
    assert!(code == 1 && out.starts_with(answer), "{out}");
    assert!(out.contains("  i steps ") && out.contains("; false entrances: contacts pushed"), "{out}");
    let document: Value = serde_json::from_str(&place.read("examined/examine.json")).expect("JSON");
    let steps = &document["given"]["steps"]["steps_with_false_entrances"];
    assert!(steps["covered"].as_u64() > Some(0) && steps["unmet"] == 0, "{steps}");
    // With a seam lengthwise as well each corner is at another pair of blocks; together they count as before, but for what corners of the floor bear.
    let lengthwise = slope(0.6)
        .replace("-2, -1], max = [0.6, 2, 0]", "-2, -1], max = [0.6, 0, 0]")
        .replace("-2, -1], max = [8, 2, 0]", "-2, -1], max = [8, 0, 0]");
    let others = |from: f64, to: f64| {
        format!("[[block]]\nfixed = true\nbox = {{ min = [{from}, 0, -1], max = [{to}, 2, 0] }}\n")
    };
    let (line, _) = told(&place, &format!("{lengthwise}{}{}", others(-3.0, 0.6), others(0.6, 8.0)), "25");
    let line = line.expect("a line");
    assert!(line.starts_with(said) && line.contains("step 21, with 36.6 % of"), "{line}");
    // Before the seam is reached, and on a floor in one piece.
    assert_eq!(told(&place, &slope(0.6), "15").0, None);
    assert_eq!(told(&place, &slope(7.0), "25").0, None);
}

#[test]
fn blocks_that_pass_one_another_and_are_pushed_are_told() {
    let place = Place::new();
    let (line, json) = told(&place, LEDGE, "60");
    let line = line.expect("a line");
    assert!(
        line.starts_with("contacts pushed blocks apart that never met in ") && line.contains("(first 0–1, step "),
        "{line}"
    );
    assert_eq!((&json["unmet"]["share"], &json["covered"]), (&1.0.into(), &Value::Null), "{json}");
    // With less than the 3 mm a step nothing is pushed; nor where the block lands on the ledge.
    assert_eq!(
        told(
            &place,
            &LEDGE.replace("[simulation]", "[tolerances]\npreset = \"auto\"\nmax_displacement = 0.002\n[simulation]"),
            "200"
        )
        .0,
        None
    );
    assert_eq!(told(&place, &LEDGE.replace("0.503", "0.4"), "60").0, None);
}

/// In the corner of a floor and a wall each pushes into the other, rightly; in a bond of cubes every corner is at a seam and nothing moves.
#[test]
fn corners_and_bonds_are_held_by_true_entrances() {
    let place = Place::new();
    let cube = |more: &str, [x, y, z]: [f64; 3], [dx, dy, dz]: [f64; 3]| {
        format!("[[block]]\n{more}\nbox = {{ min = [{x}, {y}, {z}], max = [{}, {}, {}] }}\n", x + dx, y + dy, z + dz)
    };
    let corner = "[simulation]\ngravity = [4, 0, -9]\ntime_step = 0.01\nsettle = 20\n".to_owned()
        + &cube("fixed = true", [-3.0, -2.0, -1.0], [4.0, 4.0, 1.0])
        + &cube("fixed = true", [1.0, -2.0, -1.0], [1.0, 4.0, 3.0])
        + &cube("", [-0.01, -0.5, 0.0], [1.0, 1.0, 1.0]);
    assert_eq!(told(&place, &corner, "60").0, None);
    // Side by side, overlapping by a nanometre, the second lower by a micrometre: what stands on the first does not push it into the second.
    let aside = "[simulation]\ngravity = [2, 0, -10]\ntime_step = 0.01\nsettle = 100\n[[joint]]\nfriction = 0.6\n"
        .to_owned()
        + "[[block]]\nfixed = true\nbox = { min = [-1, -0.4, -1], max = [0, 0.4, 0] }\n"
        + "[[block]]\nfixed = true\nbox = { min = [-1e-9, -0.9, -1], max = [1, 0.9, -1e-6] }\n"
        + "[[block]]\nmotion = \"rigid\"\nbox = { min = [-0.99999, -0.5, 0], max = [1e-5, 0.5, 1] }\n";
    assert_eq!(told(&place, &aside, "40").0, None);
    let mut bond = cube("fixed = true", [-1.0, -1.0, -1.0], [4.0, 4.0, 1.0]);
    for (x, z) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0), (0.5, 2.0)] {
        bond += &cube("", [x, 0.0, z], [1.0, 1.0, 1.0]);
    }
    assert_eq!(told(&place, &bond, "40").0, None);
}
