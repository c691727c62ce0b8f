//! Pins what is no violated rule and no overlap, and yet makes a model untrustworthy: loads of blocks above, modes that never change, units, steps that did not
//! converge, overlaps deeper than `penetration`; and what is neither, fixed blocks that overlap.
//!
//! Caught: all of these were called safe, and the fixed blocks were not.

use crate::examine_command::document_of;
use crate::place::Place;
use std::fmt::Write;

/// Rigid cubes of 1 m on one another on a fixed slab, of this stiffness.
fn tower(cubes: u32, stiffness: &str) -> String {
    let mut text = format!(
        "[tolerances]\npreset = \"auto\"\n[[joint]]\nnormal_stiffness = {stiffness}\n[[block]]\nfixed = true\nbox = {{ min = [-2, -2, -1], max = [3, 3, 0] }}\n"
    );
    for z in 0..cubes {
        let _ = writeln!(text, "[[block]]\nmotion = \"rigid\"\nbox = {{ min = [0, 0, {z}], max = [1, 1, {}] }}", z + 1);
    }
    text
}

#[test]
fn a_tower_that_sinks_through_itself_is_not_called_safe() {
    let place = Place::new();
    place.file("tower.toml", &tower(20, "110000"));
    let (code, out, err) = place.run(&["check", "tower.toml"]);
    let warning = "warning: a block may sink deeper than penetration under the blocks above it or under loads";
    assert!(code == 0 && out.contains(warning) && out.contains("by block 1\n"), "{out}{err}");
    let (code, out, err) = place.run(&["examine", "tower.toml", "--no-tune", "--out", "soft"]);
    assert!(code == 1 && out.starts_with("not decided: a block may sink deeper than penetration"), "{out}{err}");
    // 20 · 2600 · 9.81 N on four contacts.
    assert!(out.contains("i load       a block may sink deeper than penetration under the blocks above it or under loads: found 1.159, allowed 0.0625 (block 1)"), "{out}");
    assert_eq!(document_of(&place, "soft")["given"]["warnings"][0]["about"], "load");
    // As stiff as it says.
    let needed = out.split("normal_stiffness ≥ ").nth(2).and_then(|rest| rest.split(' ').next()).expect("a remedy");
    place.file("tower.toml", &tower(20, needed));
    let (code, out, err) = place.run(&["examine", "tower.toml", "--no-tune", "--out", "stiff"]);
    assert!(code == 0 && !out.contains("i load"), "{needed}: {out}{err}");
}

#[test]
fn modes_that_never_change_are_not_called_safe() {
    let place = Place::new();
    place.file("two.toml", &tower(1, "1e9"));
    for (set, about) in [("close=1/20", "close"), ("open=1e9", "open"), ("equal=1", "equal")] {
        let (code, out, err) = place.run(&["examine", "two.toml", "--no-tune", "--set", set, "--out", about]);
        assert!(code == 1 && out.starts_with("not decided: "), "{out}{err}");
        assert!(out.contains(&format!("  i {about:<10} ")) && out.contains("next: rockproof check"), "{out}");
    }
}

#[test]
fn steps_that_did_not_converge_are_counted() {
    let place = Place::new();
    let mut scene = tower(0, "1e12").replace("= 1e12", "= 1e12\nfriction = \"1/10\"");
    scene += "[simulation]\ntime_step = \"1/10\"\nunconverged = \"accept\"\ngravity = [3, 2, -9]\n";
    for (block, motion) in [
        ("[0, 0, 0], max = [1, 1, 3]", "spin = [1, 0, 1]"),
        ("[0, 0, 3], max = [1, 1, 4]", "velocity = [1, 0, -1]"),
        ("[1, 0, 0], max = [2, 1, 3]", "velocity = [-1, 1, 0]"),
    ] {
        let _ = writeln!(scene, "[[block]]\nbox = {{ min = {block} }}\n{motion}");
    }
    place.file("fast.toml", &scene);
    let (_, out, err) = place.run(&["examine", "fast.toml", "--no-tune", "--out", "fast"]);
    let count = document_of(&place, "fast")["given"]["steps"]["unconverged"].as_u64().expect("a count");
    assert!(count > 0, "{out}{err}");
    assert!(
        out.contains(&format!("  i steps      8 made, {count} of them taken though the iteration had not converged")),
        "{out}"
    );
}

#[test]
fn fixed_blocks_may_overlap() {
    let place = Place::new();
    let base = |low: i32, high: i32| {
        format!("[[block]]\nfixed = true\nbox = {{ min = [{low}, -2, -1], max = [{high}, 3, 0] }}\n")
    };
    let cube = "[[block]]\nbox = { min = [1, 0, 0], max = [2, 1, 1] }\n";
    place.file("bases.toml", &(base(-2, 1) + &base(0, 3) + cube));
    let (code, out, err) = place.run(&["check", "bases.toml"]);
    assert!(code == 0 && out.contains("overlaps: none in "), "{out}{err}");
    let (code, out, err) = place.run(&["simulate", "bases.toml", "--steps", "3", "--audit"]);
    assert!(code == 0, "{out}{err}");
    // One of them free, it is lost.
    place.file("free.toml", &(base(-2, 1) + &base(0, 3).replace("fixed = true", "") + cube));
    let (code, out, err) = place.run(&["check", "free.toml"]);
    assert!(
        code == 1 && out.contains("overlap deeper than penetration") | out.contains("overlaps deeper than penetration"),
        "{out}{err}"
    );
}

#[test]
fn bricks_in_millimetres_are_doubted_and_a_wrong_factor_does_not_help() {
    let place = Place::new();
    let brick = |z: i32| format!("[[block]]\nbox = {{ min = [0, 0, {z}], max = [240, 115, {}] }}\n", z + 71);
    place.file("bricks.toml", &(brick(0) + &brick(71) + &brick(142)));
    assert_eq!(place.run(&["convert", "bricks.toml", "bricks.obj"]).0, 0);
    for (scale, is_doubted) in [(None, true), (Some("1000"), true), (Some("1/1000"), false), (Some("1"), false)] {
        let scale: Vec<&str> = scale.into_iter().flat_map(|factor| ["--scale", factor]).collect();
        let arguments = [&["examine", "bricks.obj", "--no-tune", "--overwrite", "--out", "out"][..], &scale].concat();
        let (code, out, err) = place.run(&arguments);
        assert_eq!(
            (code, out.contains("the units are in doubt")),
            (i32::from(is_doubted), is_doubted),
            "{scale:?}: {out}{err}"
        );
    }
}

#[test]
fn overlaps_deeper_than_penetration_are_told_and_not_called_good() {
    let place = Place::new();
    let mut scene = tower(0, "1e9").replace("[[joint]]\nnormal_stiffness = 1e9\n", "");
    scene += "[[block]]\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\n[simulation]\ntime_step = \"1/100\"\n\
              [[load]]\nblock = 1\nat = [\"1/2\", \"1/2\", 1]\ntable = [[0, 0, 0, 0], [\"1/10\", 0, 0, 0], [\"2/10\", 0, 0, -1e11]]\n";
    place.file("pressed.toml", &scene);
    let (code, out, err) = place.run(&["simulate", "pressed.toml", "--steps", "40", "--audit", "--out", "run"]);
    assert!(code == 0 && out.contains("; deeper than penetration after "), "{out}{err}");
    let (_, out, err) = place.run(&["report", "run", "--format", "markdown"]);
    assert!(out.contains("deeper than penetration") && !out.contains("✅ run"), "{out}{err}");
}

/// The decimals that a remedy is written in, not the f64 that it was calculated in.
#[test]
fn what_a_rule_says_would_satisfy_it_does() {
    let place = Place::new();
    let cases = concat!(env!("CARGO_MANIFEST_DIR"), "/cases/real/slope_joints.dda");
    let violated = |set: &[&str]| {
        let (_, out, _) = place.run(&[&["check", cases, "--tolerances", "shi"][..], set].concat());
        (out.contains("penetration ≥ max_displacement\n    found"), out)
    };
    let (is_violated, out) = violated(&[]);
    assert!(is_violated, "{out}");
    let remedies =
        out.split("satisfied  by penetration ≥ ").nth(1).and_then(|rest| rest.lines().next()).expect("a remedy");
    let (more, less) = remedies.split_once(" or max_displacement ≤ ").expect("two remedies");
    for set in [format!("penetration={more}"), format!("max_displacement={less}")] {
        let (is_violated, out) = violated(&["--set", &set]);
        assert!(!is_violated, "{set}: {out}");
    }
}

/// A cube of 1 m in a fixed floor, so many hundredths of a metre deep, with more to say of the scene.
fn sunk(hundredths: i32, more: &str) -> String {
    format!(
        "[tolerances]\npreset = \"auto\"\npenetration = \"1/10\"\n[[block]]\nname = \"floor\"\nfixed = true\nbox = {{ min = [-2, -2, -1], max = [3, 3, 0] }}\n\
         [[block]]\nname = \"cube\"\nbox = {{ min = [0, 0, \"-{hundredths}/100\"], max = [1, 1, \"{}/100\"] }}\n{more}",
        100 - hundredths
    )
}

/// Five steps are too few to see a block fly that springs of an overlap have thrown.
#[test]
fn springs_that_store_more_than_weights_explain_are_told() {
    let place = Place::new();
    let stiff = "[[joint]]\nnormal_stiffness = 1e9\n";
    place.file("sunk.toml", &sunk(9, stiff));
    let (code, out, err) = place.run(&["examine", "sunk.toml", "--no-tune", "--out", "sunk"]);
    // 4 · 1e9 N/m · (0.09 m)²/2, and 2600 · 9.81 N · (2 · 25.5 µm + 0.01 m); √(2 · 1.62e7 J/2600 kg).
    let said = "springs of blocks 0–1 (floor, cube) store 1.620e7 J, their weights and loads explain 256.4 J: released, that would throw block 1 at up to 111.6 m/s, the more the shorter the steps are";
    assert!(code == 1 && out.starts_with(&format!("not decided: {said}\n")), "{out}{err}");
    assert!(out.contains(&format!("  i energy     {said}: use ")) && out.contains("next: rockproof check"), "{out}");
    let document = document_of(&place, "sunk");
    let energy = &document["given"]["unexplained_energy"][0];
    assert_eq!((&energy["blocks"], &energy["block"]), (&serde_json::json!([0, 1]), &1.into()), "{energy}");
    let (code, out, err) = place.run(&["check", "sunk.toml"]);
    assert!(
        code == 0 && out.contains("warning: springs of overlaps store more than weights explain") && out.contains(said),
        "{out}{err}"
    );
    // No set makes it right: the search may find one with a larger penetration, and that explains nothing.
    let (code, out, err) = place.run(&["examine", "sunk.toml", "--out", "tuned"]);
    assert!(code == 1 && out.starts_with("not decided: "), "{out}{err}");
}

/// The upper face of the floor is bent by 2 mm in one corner, so an overlap of 1 mm is excused; its contacts push as any.
#[test]
fn what_uneven_faces_excuse_stores_energy_as_well() {
    let place = Place::new();
    let floor = |height: &str| {
        format!(
            "planarity = 1e-3\n[[block]]\nfixed = true\nvertices = [[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0], [0, 0, 1], [4, 0, 1], [4, 4, {height}], [0, 4, 1]]\n\
             faces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]\n[[block]]\nbox = {{ min = [1, 1, 1], max = [2, 2, 2] }}\n"
        )
    };
    let told = energy_line(&place, &floor("\"501/500\"")).expect("a warning");
    assert!(told.contains("springs of blocks 0–1 store ") && told.contains("explain 255"), "{told}");
    let (_, out, _) = place.run(&["check", "one.toml"]);
    assert!(out.contains("overlaps by no more than rounding or the unevenness of faces"), "{out}");
    assert_eq!(energy_line(&place, &floor("1")), None);
}

/// What `examine` says of the energy of overlaps, if anything.
fn energy_line(place: &Place, scene: &str) -> Option<String> {
    place.file("one.toml", scene);
    let (_, out, err) = place.run(&["examine", "one.toml", "--no-tune", "--out", "one", "--overwrite"]);
    assert!(!out.is_empty(), "{err}");
    out.lines().find(|line| line.starts_with("  i energy ")).map(str::to_owned)
}

const STIFF: &str = "[[joint]]\nnormal_stiffness = 1e9\n";

#[test]
fn what_weights_loads_stresses_and_settling_explain_is_no_warning() {
    let place = Place::new();
    let is_told = |scene: &str| energy_line(&place, scene).is_some();
    // At rest: 2600 · 9.81 N on four springs that give way by 2 cm, and twice that, where a weight laid on suddenly comes to.
    let at_rest = "[[joint]]\nnormal_stiffness = 318825\n";
    assert!(!is_told(&sunk(2, at_rest)) && !is_told(&sunk(4, at_rest)));
    // What 25.5 kN · 0.1 m explain is 2551 J; 4 · 318825/2 N/m · h² are no more up to 6.3 cm.
    assert!(!is_told(&sunk(6, at_rest)) && is_told(&sunk(7, at_rest)));
    // 2e5 J.
    assert!(is_told(&sunk(1, STIFF)));
    // 8.03 MN · (2 · 8.03 mm + 10 mm) are 2.1e5 J, 7.53 MN · 25.1 mm are 1.9e5 J.
    let load = "[[load]]\nblock = 1\nat = [0.5, 0.5, 0.5]\nforce = [0, 0, -8e6]\n";
    assert!(!is_told(&sunk(1, &format!("{STIFF}{load}"))));
    let weaker = load.replace("8e6", "7.5e6");
    assert!(is_told(&sunk(1, &format!("{STIFF}{weaker}"))));
    assert!(!is_told(&sunk(1, &format!("stress = [0, 0, -8.1e6, 0, 0, 0]\n{STIFF}"))));
    assert!(!is_told(&sunk(1, &format!("{STIFF}[simulation]\nsettle = 200\n"))), "settled");
    assert!(!is_told(&sunk(0, STIFF)), "touching");
}

/// Loads elsewhere, the other way or later do not hold a block down when time begins.
#[test]
fn only_loads_that_press_the_pair_together_at_the_start_explain_its_energy() {
    let place = Place::new();
    let other = "[[block]]\nname = \"other\"\nbox = { min = [0, 2, 0], max = [1, 3, 1] }\n";
    let above = "[[block]]\nname = \"above\"\nbox = { min = [0, 0, \"99/100\"], max = [1, 1, \"199/100\"] }\n";
    let is_told = |block: &str, force: &str| {
        let at = if block == "other" { "[0.5, 2.5, 0.5]" } else { "[0.5, 0.5, 0.5]" };
        let load = format!("[[load]]\nblock = \"{block}\"\nat = {at}\n{force}\n");
        energy_line(&place, &sunk(1, &format!("{other}{above}{STIFF}{load}"))).is_some()
    };
    let down = "force = [0, 0, -9e6]";
    assert!(!is_told("cube", down) && !is_told("above", down), "what stands on the cube presses it as well");
    assert!(is_told("floor", down) && is_told("other", down));
    assert!(is_told("cube", "force = [0, 0, 9e6]") && is_told("cube", "force = [9e6, 0, 0]"));
    assert!(is_told("cube", "table = [[0, 0, 0, 0], [100, 0, 0, 0], [200, 0, 0, -9e6]]"));
    assert!(!is_told("cube", "table = [[-100, 0, 0, 0], [100, 0, 0, -18e6]]"), "half of it at t = 0");
}

#[test]
fn a_small_overlap_that_lifts_a_block_is_told_and_one_that_hardly_does_is_not() {
    let place = Place::new();
    let stiff = |stiffness: &str| format!("[[joint]]\nnormal_stiffness = {stiffness}\n");
    // 2,000 J are less than 25.5 kN · `penetration`, and yet lift the cube by 7.7 cm; of 2e5 J/m² the springs lift it by 0.6 cm.
    let scene = |stiffness| sunk(9, &stiff(stiffness)).replace("-9/100", "-1/1000").replace("91/100", "999/1000");
    let told = energy_line(&place, &scene("1e9")).expect("a warning");
    assert!(
        told.contains("store 2000 J") && told.contains("explain 256.4 J") && told.contains("at up to 1.24 m/s"),
        "{told}"
    );
    assert_eq!(energy_line(&place, &scene("1e8")), None);
}

/// Each step begins at rest there.
#[test]
fn static_analysis_throws_no_block() {
    let place = Place::new();
    let told = |dynamic: &str| energy_line(&place, &sunk(9, &format!("{STIFF}[simulation]\ndynamic = {dynamic}\n")));
    assert_eq!(told("0"), None);
    assert!(told("0.5").is_some());
}

#[test]
fn springs_that_hold_one_another_in_balance_throw_nothing() {
    let place = Place::new();
    let between = |right: &str, settle: u32| {
        let wall = |from: &str, to: &str| {
            format!("[[block]]\nfixed = true\nbox = {{ min = [{from}, -1, -1], max = [{to}, 2, 2] }}\n")
        };
        let cube = "[[block]]\nbox = { min = [\"-1/100\", 0, 0], max = [\"101/100\", 1, 1] }\n";
        let walls = wall("-1", "0") + &wall(right, "2");
        energy_line(
            &place,
            &format!(
                "[simulation]\nsettle = {settle}\n[tolerances]\npreset = \"auto\"\npenetration = \"1/10\"\n{walls}{cube}{STIFF}"
            ),
        )
    };
    assert_eq!((between("1", 200), between("1", 0)), (None, None));
    // A gap of 2 cm on the right: the springs on the left throw it there, and after settling they are at rest.
    let told = between("\"103/100\"", 0).expect("a warning");
    assert!(told.contains("or `settle` in [simulation]"), "{told}");
}

/// What blocks move and turn with may be in their springs for a while.
#[test]
fn energy_of_motion_explains_energy_of_springs() {
    let place = Place::new();
    let with = |motion: &str| energy_line(&place, &sunk(1, &format!("{motion}\n{STIFF}"))).is_some();
    // 2e5 J: ½ · 2600 kg · (12.4 m/s)², and ½ · 433 kg·m² · (30.4 1/s)² about any axis through the centroid.
    assert!(with("velocity = [0, 0, 12.3]") && !with("velocity = [0, 0, 12.5]"));
    assert!(with("spin = [0, 30.3, 0]") && !with("spin = [0, 30.5, 0]"));
}

#[test]
fn fixed_blocks_alone_are_not_called_safe() {
    let place = Place::new();
    place.file(
        "fixed.toml",
        &sunk(0, "fixed = true\nvelocity = [1, 0, 0]\n[[load]]\nblock = \"cube\"\nat = [0, 0, 0]\nforce = [1, 0, 0]\n[[fixed_point]]\nblock = \"cube\"\nat = [0, 0, 0]\n"),
    );
    let (code, out, err) = place.run(&["examine", "fixed.toml", "--no-tune", "--out", "fixed"]);
    assert!(code == 1 && out.starts_with("not decided: every block is fixed, so nothing moves\n"), "{out}{err}");
    let ignored = "ignored, since fixed blocks never move: velocity, load, fixed point of block 1";
    assert!(err.contains(ignored), "{err}");
    let (_, _, err) = place.run(&["check", "fixed.toml"]);
    assert!(err.contains(ignored), "{err}");
    let (code, _, err) = place.run(&["simulate", "fixed.toml", "--steps", "1", "--out", "moved"]);
    assert!(code == 0 && err.contains(ignored) && err.contains("every block is fixed, so nothing will move"), "{err}");
}

#[test]
fn blocks_that_touch_nothing_are_named() {
    let place = Place::new();
    let far = "[[block]]\nname = \"roof\"\nbox = { min = [0, 0, 5], max = [1, 1, 6] }\n";
    place.file("apart.toml", &sunk(0, far));
    let told = "1 block touches nothing, being apart from all others by more than search: 2 (roof)";
    let (code, _, err) = place.run(&["check", "apart.toml"]);
    assert!(code == 0 && err.contains(told), "{err}");
    let (code, out, err) = place.run(&["examine", "apart.toml", "--no-tune", "--out", "apart"]);
    assert!(code == 0 && out.contains("  i model ") && out.contains(told), "{out}{err}");
    place.file("near.toml", &sunk(0, ""));
    let (_, _, err) = place.run(&["check", "near.toml"]);
    assert!(!err.contains("touches nothing"), "{err}");
}

/// Two cubes of 1 m, 0.2 m from one another along a side, turned about z by the angle whose cosine is 3/5. Their boxes meet.
#[test]
fn turned_blocks_whose_boxes_alone_are_near_touch_nothing() {
    let place = Place::new();
    let cube = |from: f64| {
        let corner =
            |[u, v, z]: [f64; 3]| format!("[{}, {}, {z}]", (3.0 * u - 4.0 * v) / 5.0, (4.0 * u + 3.0 * v) / 5.0);
        let [low, high] = [from, from + 1.0];
        let side = |z: f64| [[low, 0.0, z], [high, 0.0, z], [high, 1.0, z], [low, 1.0, z]].map(corner).join(", ");
        format!(
            "[[block]]\nvertices = [{}, {}]\nfaces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]\n",
            side(0.0),
            side(1.0)
        )
    };
    let pair = |gap: f64| cube(0.0) + &cube(1.0 + gap);
    place.file("apart.toml", &pair(0.25));
    let (code, out, err) = place.run(&["check", "apart.toml", "--format", "json"]);
    let document: serde_json::Value = serde_json::from_str(&out).expect("a document");
    assert_eq!((code, &document["touch_nothing"]), (0, &serde_json::json!([0, 1])), "{err}");
    let (code, out, err) = place.run(&["examine", "apart.toml", "--no-tune", "--out", "apart"]);
    let told = "not decided: no two blocks are near enough to touch (search is 0.03 m)\n";
    assert!(code == 1 && out.starts_with(told) && !out.contains("  ✓ f64"), "{out}{err}");
    place.file("near.toml", &pair(0.0234375));
    let (_, out, _) = place.run(&["check", "near.toml", "--format", "json"]);
    let document: serde_json::Value = serde_json::from_str(&out).expect("a document");
    assert_eq!(document["touch_nothing"], serde_json::json!([]));
}

/// The set that the search recommends holds the overlap, whose springs then throw the block: the line on the set says so.
#[test]
fn why_a_recommended_set_is_not_safe_is_told() {
    let place = Place::new();
    let scene = "[[block]]\nfixed = true\nbox = { min = [0, 0, 0], max = [3, 3, 1] }\n[[block]]\nbox = { min = [1, 1, 0.9], max = [2, 2, 2] }\n";
    place.file("over.toml", scene);
    let (code, out, err) = place.run(&["examine", "over.toml", "--out", "over"]);
    assert!(
        code == 1 && out.starts_with("not safe: 1 pair of blocks overlaps so that contacts cannot hold them"),
        "{out}{err}"
    );
    assert!(out.contains(", and not decided (springs of blocks 0–1 store "), "{out}");
}
