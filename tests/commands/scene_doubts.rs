//! Pins what scenes say that was called safe, or passed over, without a word: loads across gravity, given velocities, soft fixed points, initial stress, reflex edges without contacts,
//! laws of joints that apply to nothing, angles in place of friction, densities in another unit.
//!
//! Caught: nothing was said of any of these, and `examine` called almost all of the scenes "safe"; and notes, rules and numbers that were printed otherwise than they are.

use crate::place::Place;

/// What `examine` says, without a search: its exit code, its text and its notes.
fn examined(place: &Place, name: &str) -> (i32, String, String) {
    let (code, out, err) = place.run(&["examine", name, "--no-tune", "--out", "examined", "--overwrite"]);
    assert!(!out.is_empty(), "{err}");
    (code, out, err)
}

/// What a scene is warned of under this name, by `examine` and by `check` alike: the line of `examine`.
fn warned(scene: &str, about: &str, title: &str) -> Option<String> {
    let place = Place::new();
    place.file("scene.toml", scene);
    let (code, out, _) = examined(&place, "scene.toml");
    let line = out.lines().find(|line| line.starts_with(&format!("  i {about:<10} "))).map(str::to_owned);
    let (checked, text, err) = place.run(&["check", "scene.toml"]);
    assert_eq!((checked, text.contains(title)), (0, line.is_some()), "{text}{err}{out}");
    assert_eq!((code, out.starts_with("not decided: ")), (i32::from(line.is_some()), line.is_some()), "{out}");
    line
}

/// A cube of 1 m and 2500 kg against a wall at x = 0, with contacts of this stiffness, this gravity, and more.
fn against_wall(stiffness: &str, gravity: &str, more: &str) -> String {
    format!(
        "[simulation]\ngravity = {gravity}\ntime_step = \"1/100\"\n[[material]]\nname = \"m\"\ndensity = 2500\nyoung = 1e12\n\
         [[joint]]\nfriction = 0\nnormal_stiffness = {stiffness}\n[[block]]\nname = \"wall\"\nfixed = true\nbox = {{ min = [0, -2, -2], max = [1, 2, 2] }}\n\
         [[block]]\nname = \"b\"\nbox = {{ min = [-1, 0, 0], max = [0, 1, 1] }}\n{more}"
    )
}

fn load(force: &str) -> String {
    format!("[[load]]\nblock = \"b\"\nat = [-1, 0.5, 0.5]\nforce = {force}\n")
}

const SINKS: &str = "warning: a block may sink deeper than penetration under the blocks above it or under loads";

#[test]
fn loads_press_along_their_own_direction_with_gravity_across_and_without() {
    for gravity in ["[0, 0, 0]", "[0, 0, -9.81]"] {
        // Each step begins at rest, so nothing swings deeper than it rests.
        let still = |scene: String| scene.replace("time_step", "dynamic = 0\ntime_step");
        let told = |force: &str| warned(&still(against_wall("1e9", gravity, &load(force))), "load", SINKS);
        // 1e8 N on four contacts of 1e9 N/m; 2 cm are allowed.
        let found = told("[1e8, 0, 0]").expect("a warning");
        assert!(found.contains("found 0.025, allowed 0.02 (block 1): use normal_stiffness ≥ 1.25001e9"), "{found}");
        // At a slant with what it has along the normal of the wall.
        assert!(told("[1e8, 1e9, 0]").expect("a warning").contains("found 0.025,"));
        assert_eq!(told("[8.1e7, 0, 0]").map(|line| line.contains("found 0.02025,")), Some(true));
        assert_eq!(told("[7.9e7, 0, 0]"), None, "1.975 cm");
        assert_eq!(told("[-1e9, 0, 0]"), None, "away from the wall");
    }
}

#[test]
fn loads_pass_on_to_what_stands_before() {
    // A row of two cubes, the first one loaded; the one behind it is held by three fixed points of 3e9 N/m as well.
    let behind = "[[block]]\nname = \"c\"\nbox = { min = [-2, 0, 0], max = [-1, 1, 1] }\n[[load]]\nblock = \"c\"\nat = [-2, 0.5, 0.5]\nforce = [1e8, 0, 0]\n\
        [[fixed_point]]\nblock = \"c\"\nat = [-2, 0.5, 0.5]\nstiffness = 3e9\n[[fixed_point]]\nblock = \"c\"\nat = [-2, 0, 0.5]\nstiffness = 3e9\n\
        [[fixed_point]]\nblock = \"c\"\nat = [-2, 0, 0]\nstiffness = 3e9\n";
    let found = warned(&against_wall("1e9", "[0, 0, 0]", behind), "load", SINKS).expect("a warning");
    assert!(found.contains("found 0.025, allowed 0.02 (block 1)"), "{found}");
}

#[test]
fn loads_across_gravity_squash() {
    let title = "warning: a block may be squashed by its weight, by loads or by its initial stress";
    let told = |force: &str| {
        warned(
            &against_wall("1e12", "[0, 0, -9.81]", &load(force)).replace("1e12\n[[joint", "1e9\n[[joint"),
            "strain",
            title,
        )
    };
    assert!(
        told("[1e8, 0, 0]").expect("a warning").contains("found 0.1, allowed 0.01 (block 1): use young ≥ 1.00001e10")
    );
    assert_eq!(told("[9.9e6, 0, 0]"), None);
}

#[test]
fn initial_stress_strains() {
    let title = "warning: a block may be squashed by its weight, by loads or by its initial stress";
    let told = |stress: &str| {
        let scene = against_wall("1e9", "[0, 0, 0]", "").replace("1e12\n[[joint", "5e9\n[[joint");
        warned(&format!("{scene}stress = [{stress}, 0, 0, 0, 0, 0]\n"), "strain", title)
    };
    // Along the stress 0.2, across it −ν times that with ν = 1/4: 0.2·√(1 + 2/16).
    assert!(told("-1e9").expect("a warning").contains("found 0.2121, allowed 0.01 (block 1): use young ≥ 1.06067e11"));
    assert_eq!(told("-4.7e7"), None);
}

#[test]
fn given_velocities_count_as_heights_do() {
    let title = "warning: a block that moves when time begins may be stopped only deeper than penetration";
    let told = |stiffness: &str, velocity: &str| {
        let scene = against_wall(stiffness, "[0, 0, 0]", &format!("velocity = {velocity}\n"));
        warned(&scene.replace("[-1, 0, 0], max = [0, 1, 1]", "[-1.04, 0, 0], max = [-0.04, 1, 1]"), "speed", title)
    };
    // 20 m/s · √(2500 kg/1e8 N/m) on one contact, of 2 cm.
    let found = told("1e8", "[20, 0, 0]").expect("a warning");
    assert!(found.contains("found 0.1, allowed 0.02 (block 1): use normal_stiffness ≥ 2.50001e9"), "{found}");
    assert!(told("2.49e9", "[20, 0, 0]").is_some());
    assert_eq!(told("2.51e9", "[20, 0, 0]"), None);
    assert_eq!(told("1e8", "[3.9, 0, 0]"), None);
}

#[test]
fn fixed_points_that_are_too_soft_are_told_where_they_alone_hold() {
    let title = "warning: a block may fall, since its fixed points alone hold it and are too soft";
    let told = |stiffness: &str, more: &str| {
        let point = format!("[[fixed_point]]\nblock = \"b\"\nat = [-0.5, 0.5, 1]\nstiffness = {stiffness}\n{more}");
        warned(&against_wall("1e9", "[0, 0, -10]", &point), "hanging", title)
    };
    let found = told("100", "").expect("a warning");
    assert!(
        found.contains("found 250, allowed 0.5 (block 1): use stiffness of its 1 [[fixed_point]] ≥ 50000.1"),
        "{found}"
    );
    assert_eq!(told("50001", ""), None);
    let floor = "[[block]]\nfixed = true\nbox = { min = [-2, -2, -1], max = [0, 2, 0] }\n";
    assert_eq!(told("100", floor), None, "a floor bears it");
}

/// A cube flush in the corner of a fixed L, and the same L as two boxes.
fn corner(gap: &str, is_split: bool) -> String {
    let l = "vertices = [[-1, -2, -1], [4, -2, -1], [4, -2, 0], [0, -2, 0], [0, -2, 3], [-1, -2, 3], [-1, 3, -1], [4, 3, -1], [4, 3, 0], [0, 3, 0], [0, 3, 3], [-1, 3, 3]]\n\
        faces = [[0, 1, 2, 3, 4, 5], [11, 10, 9, 8, 7, 6], [0, 6, 7, 1], [1, 7, 8, 2], [2, 8, 9, 3], [3, 9, 10, 4], [4, 10, 11, 5], [5, 11, 6, 0]]\n";
    let boxes = "box = { min = [-1, -2, -1], max = [4, 3, 0] }\n[[block]]\nfixed = true\nbox = { min = [-1, -2, 0], max = [0, 3, 3] }\n";
    let l = if is_split { boxes } else { l };
    format!(
        "[simulation]\ngravity = [0, 0, -10]\n[[joint]]\nnormal_stiffness = 1e10\n[[block]]\nname = \"L\"\nfixed = true\n{l}[[block]]\nname = \"cube\"\nbox = {{ min = [{gap}, 0, 0], max = [1, 1, 1] }}\n"
    )
}

#[test]
fn a_block_on_a_reflex_edge_has_no_contact_there_and_that_is_told() {
    let title = "warning: a block lies on a reflex edge of another one, where SPEC's rules give no contact";
    let told = |scene: &str| warned(scene, "reflex", title);
    let found = told(&corner("0", false)).expect("a warning");
    let said = "block 1 (cube) lies on the reflex edge 3-9 of block 0 (L), and SPEC's rules give no contact there: block 0 (L) split along this edge into convex blocks";
    assert!(found.ends_with(said), "{found}");
    assert_eq!(told(&corner("0", true)), None, "as it says");
    // A little off the wall its corners touch the floor, but not the wall.
    assert!(told(&corner("1e-6", false)).expect("a warning").ends_with(said));
    assert_eq!(told(&corner("0.25", false)), None, "off the edge by more than territory");
    // A hook on the edge of a wall that is wider: here the ends of the reflex edge lie on a convex one.
    let hook = "[simulation]\ngravity = [0, 0, 0]\n[[joint]]\nnormal_stiffness = 1e10\n[[block]]\nfixed = true\nbox = { min = [0, -1, -5], max = [1, 2, 0] }\n[[block]]\nname = \"hook\"\n\
        vertices = [[-1, 0, -2], [0, 0, -2], [0, 0, 0], [2, 0, 0], [2, 0, 1], [-1, 0, 1], [-1, 1, -2], [0, 1, -2], [0, 1, 0], [2, 1, 0], [2, 1, 1], [-1, 1, 1]]\n\
        faces = [[0, 1, 2, 3, 4, 5], [11, 10, 9, 8, 7, 6], [0, 6, 7, 1], [1, 7, 8, 2], [2, 8, 9, 3], [3, 9, 10, 4], [4, 10, 11, 5], [5, 11, 6, 0]]\n";
    let found = told(hook).expect("a warning");
    assert!(found.contains("block 0 lies on the reflex edge 2-8 of block 1 (hook)"), "{found}");
}

#[test]
fn laws_that_apply_to_nothing_are_named_with_what_holds_instead() {
    let place = Place::new();
    let told = |joints: &str, own: &str| {
        let scene = against_wall("1e9", "[0, 0, -9.81]", own)
            .replace("[[joint]]\nfriction = 0\nnormal_stiffness = 1e9\n", joints);
        place.file("laws.toml", &scene);
        let (_, _, examined) = examined(&place, "laws.toml");
        let (_, _, checked) = place.run(&["check", "laws.toml"]);
        let (code, _, run) = place.run(&["simulate", "laws.toml", "--steps", "1", "--out", "run", "--overwrite"]);
        let note = |err: &str| err.lines().find(|line| line.contains("applies to no two blocks")).map(str::to_owned);
        assert_eq!(
            (code, note(&checked), note(&run)),
            (0, note(&examined), note(&examined)),
            "{examined}{checked}{run}"
        );
        note(&checked)
    };
    let found = told("[[joint]]\nbetween = [\"clay\", \"sand\"]\nfriction = 0.5\n", "").expect("a note");
    assert!(
        found.ends_with("between \"clay\" and \"sand\" (no block has the joint material \"sand\"); between \"clay\" and \"clay\" the defaults hold: friction 0.6, cohesion 0 Pa, tension 0 Pa, normal_stiffness derived, shear_ratio 0.4"),
        "{found}"
    );
    let found = told("[[joint]]\nfriction = 0.25\n[[joint]]\nbetween = [\"clay\", \"sand\"]\nfriction = 0.5\n", "")
        .expect("a note");
    assert!(found.contains("the [[joint]] without `between` holds: friction 0.25,"), "{found}");
    let found = told(
        "[[joint]]\nbetween = [\"clay\", \"sand\"]\n[[joint]]\nbetween = [\"sand\", \"sand\"]\n",
        "joint = \"sand\"\n",
    )
    .expect("a note");
    assert!(
        found.contains(
            "(only one block has the joint material \"sand\"); each pair of their joint materials has one of its own"
        ),
        "{found}"
    );
    let found = told("[[joint]]\nfriction = 0.25\n[[joint]]\nbetween = [\"clay\", \"clay\"]\n", "").expect("a note");
    assert!(found.contains("the [[joint]] without `between` applies to no two blocks"), "{found}");
    assert_eq!(told("[[joint]]\nbetween = [\"clay\", \"sand\"]\nfriction = 0.5\n", "joint = \"sand\"\n"), None);
    assert_eq!(told("[[joint]]\nbetween = [\"clay\", \"clay\"]\n", ""), None);
}

#[test]
fn friction_in_degrees_and_densities_in_other_units_are_doubted() {
    let of = |friction: &str, density: &str| {
        let scene = against_wall("1e10", "[0, 0, -9.81]", "");
        scene.replace("friction = 0", &format!("friction{friction}")).replace("= 2500", &format!("= {density}"))
    };
    let title = "warning: friction may be an angle: it is tan φ, and no rock has so much";
    let told = |friction: &str| warned(&of(friction, "2500"), "friction", title);
    let found = told(" = 30").expect("a warning");
    assert!(
        found.ends_with("found 30, allowed 5: use `friction_angle` where degrees are meant, or friction ≤ 5"),
        "{found}"
    );
    assert!(told(" = \"5.0000001\"").is_some());
    assert_eq!((told(" = 5"), told("_angle = 30")), (None, None));
    let title = "warning: a density may be in another unit: it is in kg/m³, and no rock has this one";
    let told = |density: &str| warned(&of(" = 0", density), "density", title);
    assert!(told("2.6").expect("a warning").ends_with("found 2.6, allowed 100 (block 1): use density ≥ 100 (kg/m³)"));
    assert!(told("2.5e6").expect("a warning").ends_with("allowed 10000 (block 1): use density ≤ 10000 (kg/m³)"));
    assert_eq!((told("100"), told("10000")), (None, None));
}

#[test]
fn without_gravity_nothing_falls() {
    let place = Place::new();
    for (gravity, is_told) in [("[0, 0, 0]", false), ("[0, 0, -9.81]", true)] {
        let scene = against_wall("1e9", gravity, "").replace("fixed = true\n", "");
        place.file("loose.toml", &scene);
        let (code, _, err) = place.run(&["simulate", "loose.toml", "--steps", "1", "--out", "run", "--overwrite"]);
        assert_eq!((code, err.contains("the model falls as a whole")), (0, is_told), "{err}");
    }
}

/// The rule that is printed is the one that is applied: F·min(g, 2F/p + s), not F·g.
#[test]
fn the_rule_about_energy_is_printed_as_it_is_applied() {
    let place = Place::new();
    let scene = "[simulation]\ngravity = [0, 0, -10]\n[[material]]\nname = \"m\"\ndensity = 2500\n[[joint]]\nnormal_stiffness = 1e9\n[[block]]\nfixed = true\nbox = { min = [-4, -4, -1], max = [5, 5, 0] }\n\
        [[block]]\nbox = { min = [0, 0, \"-1/200\"], max = [1, 1, \"199/200\"] }\n";
    place.file("over.toml", scene);
    let (_, out, err) = place.run(&["check", "over.toml"]);
    assert!(
        out.contains(
            "  (energy of the springs between two blocks) ≤ F·min(penetration, 2F/p + s) + (energy of their motion)\n"
        ),
        "{out}{err}"
    );
    assert!(out.contains("no more than 2F²/p") && out.contains("a hundredth of its smallest side"), "{out}");
    // 25,000 N · (2 · 25,000 N/1e9 N/m + 0.01 m)
    assert!(out.contains("store 50000 J, their weights and loads explain 251.2 J"), "{out}");
}

#[test]
fn numbers_in_errors_are_decimals_as_they_were_written() {
    let place = Place::new();
    let scene = against_wall("1e9", "[0, 0, -9.81]", "");
    for (from, to, said) in [
        ("\"1/100\"", "-0.01", "`time_step` of [simulation] is -0.01; allowed is more than 0"),
        ("= 2500", "= -0.1", "`density` of [[material]] is -0.1; allowed is more than 0"),
        ("friction = 0", "friction_angle = 95.3", "`friction_angle` of [[joint]] is 95.3; allowed is "),
        (
            "[simulation]",
            "[tolerances]\npreset = \"auto\"\nsearch = -0.01\n[simulation]",
            "tolerance `search` is -0.01; allowed is ",
        ),
    ] {
        place.file("negative.toml", &scene.replace(from, to));
        let (code, _, err) = place.run(&["check", "negative.toml"]);
        assert!(code == 2 && err.contains(said), "{err}");
    }
}

#[test]
fn the_line_of_f32_says_where_f32_cannot_hold_the_coordinates() {
    let place = Place::new();
    let said = "; f32 cannot hold these coordinates: at 5.400e6 m neighbouring ones are 0.5 m apart, and the shortest edge is 1 m";
    for (away, is_told) in [("5400000", true), ("4000", false)] {
        let number = |by: f64| (away.parse::<f64>().expect("a number") + by).to_string();
        let scene = format!(
            "[[block]]\nfixed = true\nbox = {{ min = [0, {}, 0], max = [4, {away}, 1] }}\n[[block]]\nbox = {{ min = [1, {}, 1], max = [2, {}, 2] }}\n",
            number(-4.0),
            number(-3.0),
            number(-2.0)
        );
        place.file("far.toml", &scene);
        let (code, out, _) = examined(&place, "far.toml");
        let line = out.lines().find(|line| line.contains(" f32 ")).expect("a line");
        assert_eq!((code, line.ends_with(said), line.starts_with("  i ")), (0, is_told, is_told), "{out}");
    }
}

/// A cube that touches a ceiling falls; where closed contacts pull as much as it weighs it hangs: `check` warns, `simulate` tells it, and `examine` does not call the model safe.
#[test]
fn contacts_that_pull_a_block_up_are_warned_of() {
    let scene = |open: &str, gravity: &str| {
        format!(
            "[tolerances]\npreset = \"auto\"\n{open}[simulation]\ngravity = {gravity}\ntime_step = 0.01\nsteps = 2\n[[block]]\nname = \"ceiling\"\nfixed = true\n\
             box = {{ min = [-2, -2, 0], max = [2, 2, 1] }}\n[[block]]\nname = \"b\"\nbox = {{ min = [-0.5, -0.5, -1], max = [0.5, 0.5, 0] }}\n[[joint]]\nnormal_stiffness = 1e8\n"
        )
    };
    let warned = |open: &str, gravity: &str, precision: &str| {
        let place = Place::new();
        place.file("scene.toml", &scene(open, gravity));
        let (_, checked, _) = place.run(&["check", "scene.toml", "--precision", precision, "--format", "json"]);
        let checked: serde_json::Value = serde_json::from_str(&checked).expect("a document");
        let of_pull = checked["warnings"].as_array().expect("warnings").iter().find(|one| one["about"] == "pull");
        let engine = format!("stepper-{precision}");
        let (_, _, made) = place.run(&["simulate", "scene.toml", "--engine", &engine, "--out", "made"]);
        assert_eq!(made.contains("a block may hang or stick"), of_pull.is_some(), "{made}");
        let (code, examined, _) = place.run(&["examine", "scene.toml", "--precision", precision, "--steps", "1"]);
        assert_eq!(
            (code, examined.starts_with("safe:")),
            if of_pull.is_some() { (1, false) } else { (0, true) },
            "{examined}"
        );
        of_pull.cloned()
    };
    // 26 kN, and four contacts of 1e8 N/m that pull over the gap that f32 cannot tell from none.
    let (down, none) = ("[0, 0, -10]", "[0, 0, 0]");
    let told = warned("", down, "f32").expect("f32 pulls");
    assert_eq!((&told["block"], &told["allowed"]), (&1.into(), &26000.0.into()), "{told}");
    assert_eq!((warned("", down, "f64"), warned("", none, "f32")), (None, None));
    // 26 kN over 4e8 N/m are 6.5e-5 m.
    assert_eq!(warned("open = 6.49e-5\n", down, "f64"), None);
    let told = warned("open = 6.51e-5\n", down, "f64").expect("pulls");
    assert_eq!(told["remedy"], "open ≤ 6.49999e-5", "{told}");
}

/// A run tells at its begin what `check` warns of, for its end shows only the steps.
#[test]
fn a_run_tells_what_check_warns_of() {
    let place = Place::new();
    let scene = |low: &str, high: &str, more: &str| {
        format!(
            "[simulation]\ngravity = [0, 0, -10]\ntime_step = 0.001\nsteps = 2\n[[block]]\nname = \"floor\"\nfixed = true\nbox = {{ min = [-2, -2, -1], max = [2, 2, 0] }}\n\
             [[block]]\nname = \"b\"\nbox = {{ min = [0, 0, {low}], max = [1, 1, {high}] }}\n{more}"
        )
    };
    let told = |scene: String| {
        place.file("a b.toml", &scene);
        let (_, _, err) = place.run(&["simulate", "a b.toml", "--out", "made", "--overwrite"]);
        err.lines().find(|line| line.contains("warns of this model")).map(str::to_owned)
    };
    let begin = "note: `rockproof check 'a b.toml'` warns of this model, whatever the steps show: ";
    assert_eq!(told(scene("0", "1", "")), None);
    let deep = told(scene("-0.006", "0.994", "")).expect("springs that throw");
    assert_eq!(deep, format!("{begin}springs of overlaps store more than weights explain, and may throw blocks"));
    let fast = told(scene("0", "1", "velocity = [0, 0, -100]\n")).expect("a fast block");
    assert_eq!(fast, format!("{begin}a block that moves when time begins may be stopped only deeper than penetration"));
    let thin = told(scene("0", "0.02", "[tolerances]\npreset = \"auto\"\npenetration = 0.03\n")).expect("a thin block");
    assert!(thin.starts_with(&format!("{begin}a block may be passed through, or lie within another")), "{thin}");
}
