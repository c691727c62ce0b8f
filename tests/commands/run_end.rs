//! Pins what the end of `simulate` says of a run: how still it was after settling, blocks that changed their volume, that a run which goes on has all it
//! was asked for, in which line another scene differs, energy that nothing put in, blocks that stand still in f32 though they move, strains that are not small,
//! and that a run of no step moves nothing.

use crate::place::Place;

/// A rigid bar that turns by 1/40 rad a step in free space.
const SPIN: &str = r#"
[simulation]
gravity = [0, 0, 0]
time_step = "1/200"
steps = 40
kinematics = "linear"

[[block]]
motion = "rigid"
box = { min = [-1, -1, -1], max = [1, 1, 1] }
spin = [0, 0, 5]

[[block]]
motion = "rigid"
box = { min = [9, -1, -1], max = [11, 1, 1] }
"#;

#[test]
fn a_block_that_changes_its_volume_is_named() {
    let place = Place::new();
    place.file("spin.toml", SPIN);
    let (code, out, err) = place.run(&["simulate", "spin.toml", "--out", "spun"]);
    // Along tangents the sides in the plane of turning grow by the root of 1 + (1/40)² a step: (1 + 1/1600)⁴⁰ = 1.025.
    let told = "\nvolume           block 0 has 1.025 times the volume that it began with; kinematics \"linear\" makes";
    assert!(code == 0 && out.contains(told), "{out}{err}");
    let (_, out, err) = place.run(&["simulate", "spin.toml", "--out", "document", "--format", "json"]);
    let document: serde_json::Value = serde_json::from_str(&out).unwrap_or_else(|why| panic!("{why} {err}"));
    let change = &document["volume_change"];
    assert_eq!((&change["block"], &change["blocks"]), (&0.into(), &1.into()), "{change}");
    assert!(
        (change["factor"].as_f64().expect("a factor") - (1.0 + 1.0 / 1600.0_f64).powi(40)).abs() < 1e-9,
        "{change}"
    );
    // 0.6 % is not told, and by `cayley` nothing grows.
    let (_, out, _) = place.run(&["simulate", "spin.toml", "--steps", "10", "--out", "short"]);
    assert!(out.contains("\nenergy ") && !out.contains("\nvolume "), "{out}");
    place.file("cayley.toml", &SPIN.replace("linear", "cayley"));
    let (_, out, _) = place.run(&["simulate", "cayley.toml", "--out", "cayley"]);
    assert!(out.contains("\nenergy ") && !out.contains("\nvolume "), "{out}");
}

#[test]
fn the_last_displacement_of_settling_is_told() {
    let place = Place::new();
    let scene = concat!(env!("CARGO_MANIFEST_DIR"), "/cases/handmade/rest_on_floor.toml");
    let args = ["simulate", scene, "--steps", "2", "--out", "run"];
    let (_, out, err) = place.run(&[&args[..], &["--format", "json"]].concat());
    let document: serde_json::Value = serde_json::from_str(&out).unwrap_or_else(|why| panic!("{why} {err}"));
    let moved: f64 = {
        let rows = place.rows("run/steps.csv");
        let last = rows.iter().find(|row| row["step"] == "0").expect("the last of settling");
        last["max_displacement_m"].parse().expect("a length")
    };
    assert_eq!(document["settled_displacement_m"].as_f64(), Some(moved));
    let (_, out, err) = place.run(&[&args[..], &["--overwrite"]].concat());
    let line = out.lines().find(|line| line.starts_with("settling ")).unwrap_or_else(|| panic!("{out}{err}"));
    let (start, told) = line.split_once("20 steps before; in the last a vertex moved ").expect("how far");
    let told: f64 = told.strip_suffix(" m at most").expect("metres").parse().expect("a length");
    assert!(start.trim() == "settling" && (told - moved).abs() <= 0.005 * moved, "{line} {moved}");
    // A run that does not settle has nothing to tell.
    place.file("spin.toml", SPIN);
    let (_, out, _) = place.run(&["simulate", "spin.toml", "--steps", "1", "--out", "spun", "--format", "json"]);
    assert!(
        out.contains("\"settled_displacement_m\": null") && !place.read("spun/run.json").contains("settled"),
        "{out}"
    );
}

#[test]
fn a_run_that_goes_on_with_nothing_to_do_says_what_it_has() {
    let place = Place::new();
    place.file("spin.toml", SPIN);
    let again = ["simulate", "spin.toml", "--out", "spun", "--resume", "--steps"];
    let (code, _, err) = place.run(&[&again[..], &["30"]].concat());
    assert!(code == 0 && !err.contains("no step was made"), "{err}");
    for steps in ["10", "30"] {
        let (code, _, err) = place.run(&[&again[..], &[steps]].concat());
        let told = format!(
            "note: spun has 30 steps and 0.15 s already, and {steps} steps were asked for: no step was made; more --steps or --time goes on\n"
        );
        assert!(code == 0 && err.contains(&told), "{err}");
    }
    let (code, _, err) = place.run(&[&again[..], &["31"]].concat());
    assert!(code == 0 && !err.contains("no step was made"), "{err}");
}

#[test]
fn the_first_line_of_another_scene_that_differs_is_named() {
    let place = Place::new();
    place.file("spin.toml", SPIN);
    let args = ["simulate", "spin.toml", "--steps", "1", "--out", "spun"];
    assert_eq!(place.run(&args).0, 0);
    let of_run = place.read("spun/scene.toml");
    let line = 1 + of_run.lines().position(|line| line == "spin = [0.0, 0.0, 5.0]").expect("the spin");
    place.file("spin.toml", &SPIN.replace("spin = [0, 0, 5]", "spin = [0, 0, 6]"));
    let (code, _, err) = place.run(&[&args[..], &["--resume", "--set", "search=0.2"]].concat());
    let told = format!(
        "  scene: line {line} of scene.toml: the run has `spin = [0.0, 0.0, 5.0]`, asked for is `spin = [0.0, 0.0, 6.0]`\n"
    );
    assert!(code == 2 && err.contains(&told) && err.contains("\n  search: the run has"), "{told}{err}");
    // A scene that is too large to be read is as none; a sparse file takes no space.
    let scene = std::fs::File::create(place.path("spun/scene.toml")).expect("a file");
    scene.set_len((1 << 30) + 1).expect("a length");
    let (code, _, err) = place.run(&[&args[..], &["--resume"]].concat());
    assert!(code == 2 && err.contains("scene: the run has \""), "{err}");
    // Without its scene a run has digests alone.
    std::fs::remove_file(place.path("spun/scene.toml")).expect("removed");
    let (code, _, err) = place.run(&[&args[..], &["--resume"]].concat());
    assert!(code == 2 && err.contains("scene: the run has \""), "{err}");
}

/// Springs of 1e300 N/m leave nothing of the masses in f64.
#[test]
fn a_system_that_cannot_be_solved_is_told_with_the_stiffnesses_to_look_at() {
    let place = Place::new();
    let blocks = SPIN.replace("gravity = [0, 0, 0]\n", "");
    let floor = "[[block]]\nfixed = true\nbox = { min = [-9, -9, -2], max = [9, 9, -1] }\n";
    place.file("stiff.toml", &format!("{blocks}\n{floor}[[joint]]\nfriction = 0\nnormal_stiffness = 1e300\n"));
    let (code, out, err) = place.run(&["simulate", "stiff.toml", "--force", "--out", "stiff"]);
    assert!(
        code == 1 && err.contains("a pivot is not positive; look at time_step, normal_stiffness, the stiffness of"),
        "{out}{err}"
    );
}

/// The line of the end with this name, if there is one.
fn line_of(out: &str, name: &str) -> Option<String> {
    out.lines().find_map(|line| line.strip_prefix(&format!("{name:<17}"))).map(str::to_owned)
}

/// An L and a tetrahedron whose edges graze: in step 107 a contact of two edges begins 16 mm deep.
const GRAZING: &str = r#"
[simulation]
gravity = [0, 0, 0]
time_step = 0.004187883902660488
steps = 120

[tolerances]
preset = "auto"
penetration = 0.02
search = 0.010864630944285043
max_displacement = 0.004345852377714017
territory = 0.0027161577360712607

[[joint]]
normal_stiffness = 22732813.02187336
friction = 0.6

[[block]]
vertices = [[0.6245631309117813, 0.628106207891546, 0.6245631309117813], [0.8354368690882187, 0.628106207891546, 0.6245631309117813], [0.8354368690882187, 0.628106207891546, 0.6940967689552056], [0.6940967689552056, 0.628106207891546, 0.6940967689552056], [0.6940967689552056, 0.628106207891546, 0.8354368690882187], [0.6245631309117813, 0.628106207891546, 0.8354368690882187], [0.6245631309117813, 0.8318937921084539, 0.6245631309117813], [0.8354368690882187, 0.8318937921084539, 0.6245631309117813], [0.8354368690882187, 0.8318937921084539, 0.6940967689552056], [0.6940967689552056, 0.8318937921084539, 0.6940967689552056], [0.6940967689552056, 0.8318937921084539, 0.8354368690882187], [0.6245631309117813, 0.8318937921084539, 0.8354368690882187]]
faces = [[0, 1, 2, 3, 4, 5], [11, 10, 9, 8, 7, 6], [1, 0, 6, 7], [2, 1, 7, 8], [3, 2, 8, 9], [4, 3, 9, 10], [5, 4, 10, 11], [0, 5, 11, 6]]
motion = "deformable"
velocity = [-2.8351410131163535, -2.8351410131163535, 0.0]
spin = [1.697655687120834, 1.0182051804493921, -0.19451521283223827]

[[block]]
vertices = [[0.3666632622616386, 0.37925623558162647, 0.8292314606881342], [0.16374632722348773, 0.15593747099999916, 0.8647923237061566], [0.14243589450256483, 0.40504662630909033, 0.5952076762938434], [0.3975641054974352, 0.1349533736909097, 0.6808165645590009]]
faces = [[0, 1, 3], [0, 2, 1], [0, 3, 2], [1, 2, 3]]
motion = "rigid"
velocity = [23.79463627121388, 23.79463627121388, 0.0]
spin = [0.5204759393417779, -0.024242291214482046, 0.49680214682896917]
"#;

#[test]
fn energy_that_neither_gravity_nor_loads_put_in_is_told() {
    let place = Place::new();
    place.file("grazing.toml", GRAZING);
    let (code, out, err) = place.run(&["simulate", "grazing.toml", "--out", "grazing"]);
    let told = "2460 J from step 106 to 107 that neither gravity nor loads put in, 30 % of the most that motion, strain and springs held until then: it comes of contacts that begin deep or turn, of strains that are not small";
    assert!(code == 0 && line_of(&out, "gained").as_deref() == Some(told), "{out}{err}");
    // In two sessions, too, and for programs.
    let halves =
        ["simulate", "grazing.toml", "--every", "7", "--out", "halves", "--format", "json", "--resume", "--steps"];
    for (until, step) in [("80", None), ("120", Some(107))] {
        let (_, out, err) = place.run(&[&halves[..], &[until]].concat());
        let document: serde_json::Value = serde_json::from_str(&out).unwrap_or_else(|why| panic!("{why} {err}"));
        assert_eq!(document["energy_gained"]["to_step"].as_i64(), step, "{document}");
    }
    // By tangents a bar that turns gets longer and faster at its ends; by `cayley` it does not.
    for (kinematics, expected) in [("linear", true), ("cayley", false)] {
        place.file("spin.toml", &SPIN.replace("linear", kinematics));
        let (_, out, _) = place.run(&["simulate", "spin.toml", "--steps", "100", "--out", kinematics]);
        assert_eq!(
            line_of(&out, "gained").is_some_and(|told| told.contains("kinematics \"linear\"")),
            expected,
            "{out}"
        );
    }
}

/// A cube that a load pushes, and a heavier one that falls on a floor: all of it is put in.
#[test]
fn work_of_loads_and_of_weight_is_no_gain() {
    let place = Place::new();
    let text = "[simulation]\ngravity = [0, 0, -10]\ntime_step = \"1/200\"\nsteps = 120\n\
        [[block]]\nfixed = true\nbox = { min = [-5, -5, -1], max = [5, 5, 0] }\n\
        [[block]]\nmotion = \"rigid\"\nbox = { min = [0, 0, 1], max = [1, 1, 2] }\n\
        [[block]]\nbox = { min = [-2, -2, 0], max = [-1, -1, 1] }\n\
        [[load]]\nblock = 2\nat = [-2, \"-3/2\", \"1/2\"]\ntable = [[0, 0, 0, 0], [\"1/10\", 40000, 0, 0], [\"1/5\", 0, 0, 0]]\n";
    place.file("pushed.toml", text);
    for engine in ["stepper-f64", "stepper-f32"] {
        let (code, out, err) = place.run(&["simulate", "pushed.toml", "--engine", engine, "--out", engine]);
        assert!(code == 0 && line_of(&out, "gained").is_none(), "{out}{err}");
        let kinetic = out.lines().find(|line| line.starts_with("energy  ")).expect("a line");
        assert!(!kinetic.contains(" 0 J kinetic"), "something moved: {kinetic}");
    }
}

#[test]
fn a_block_that_is_too_slow_for_f32_is_told() {
    let place = Place::new();
    let slow = |speed: &str| {
        format!(
            "[simulation]\ngravity = [0, 0, 0]\ntime_step = \"1/1000\"\nsteps = 100\n\
             [[block]]\nfixed = true\nbox = {{ min = [300, 0, -3], max = [301, 1, -2] }}\n\
             [[block]]\nmotion = \"rigid\"\nvelocity = [{speed}, 0, 0]\nbox = {{ min = [300, 0, 0], max = [301, 1, 1] }}\n"
        )
    };
    place.file("slow.toml", &slow("0.015"));
    let told = |name: &str, engine: &str| {
        let (code, out, err) = place.run(&["simulate", name, "--engine", engine, "--out", "run", "--overwrite"]);
        assert_eq!(code, 0, "{out}{err}");
        line_of(&out, "standing still")
    };
    // Half of a last place there is 15.26 µm, a step 15 µm.
    let expected = "block 1 stood still along x from step 1 on at a speed of 0.0150 m/s, and is 0.0015 m behind: f32 has no numbers for such short steps there";
    assert_eq!(told("slow.toml", "stepper-f32").as_deref(), Some(expected));
    assert_eq!(told("slow.toml", "stepper-f64"), None);
    place.file("faster.toml", &slow("0.016"));
    assert_eq!(told("faster.toml", "stepper-f32"), None);
    // At rest on the floor springs ask for the same tiny step again and again.
    let rest = slow("0").replace("[0, 0, 0]\ntime", "[0, 0, -10]\ntime").replace("-2]", "0]");
    place.file("rest.toml", &rest);
    assert_eq!(told("rest.toml", "stepper-f32"), None);
}

/// A contact that slides holds a block along its normal alone.
#[test]
fn a_block_that_slides_too_slowly_for_f32_is_told() {
    let place = Place::new();
    let text = "[simulation]\ngravity = [0, 0, -10]\ntime_step = 0.0001\nsteps = 200\nsettle = 20\n[[joint]]\nfriction = 0\nnormal_stiffness = 1e9\n\
         [[block]]\nfixed = true\nbox = { min = [597, 598, 599], max = [603, 602, 600] }\n\
         [[block]]\nmotion = \"rigid\"\nvelocity = [0.25, 0, 0]\nbox = { min = [600, 600, 600], max = [601, 601, 601] }\n";
    place.file("ice.toml", text);
    let told = |name: &str| {
        let tolerances = ["--set", "open=1e-6", "--set", "close=1e-6", "--out", "run", "--overwrite"];
        let (code, out, err) = place.run(&[&["simulate", name, "--engine", "stepper-f32"][..], &tolerances].concat());
        assert_eq!(code, 0, "{out}{err}");
        line_of(&out, "standing still")
    };
    // Half of a last place at 600 m is 30.5 µm, a step 25 µm: after 200 of them 5 mm are missing.
    let expected = "block 1 stood still along x from step 1 on at a speed of 0.2500 m/s, and is 0.0050 m behind";
    let found = told("ice.toml").unwrap_or_default();
    assert!(found.starts_with(expected), "{found}");
    // What friction holds is at rest.
    let rough = text.replace("friction = 0", "friction = 1").replace("velocity = [0.25, 0, 0]\n", "");
    place.file("rough.toml", &rough);
    assert_eq!(told("rough.toml"), None);
}

/// A wedge that friction lets slide, with a time step in which the forces of friction change from solve to solve to the last.
#[test]
fn friction_that_does_not_settle_is_told_and_makes_nothing_safe() {
    let place = Place::new();
    let wedge = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/cases/handmade/wedge.toml"));
    let wedge = wedge.expect("a scene").replace("friction = \"21/88\"", "friction = 0.3");
    place.file("short.toml", &wedge);
    place.file("long.toml", &wedge.replace("time_step = \"1/100\"", "time_step = 0.3"));
    let (code, out, err) = place.run(&["simulate", "long.toml", "--steps", "3", "--out", "long"]);
    let told = line_of(&out, "friction").unwrap_or_default();
    assert!(code == 0 && told.starts_with("not settled in 1 step (in step 1 by 25 % of the forces"), "{out}{err}");
    let (_, out, err) = place.run(&["simulate", "long.toml", "--steps", "3", "--out", "json", "--format", "json"]);
    let document: serde_json::Value = serde_json::from_str(&out).unwrap_or_else(|why| panic!("{why} {err}"));
    let unsettled = &document["friction_not_settled"];
    assert!(unsettled["steps"] == 1 && unsettled["worst_step"] == 1, "{unsettled}");
    assert_eq!((&document["unconverged"], &document["rules_violated"]), (&0.into(), &serde_json::json!([])));
    let (code, out, err) = place.run(&["report", "long", "--format", "markdown"]);
    assert!(code == 0 && out.contains("long: friction not settled in 1 step"), "{out}{err}");
    let examine = |name| place.run(&["examine", name, "--no-tune", "--out", "examined", "--overwrite"]);
    let (code, out, err) = examine("long.toml");
    assert!(code != 0 && out.starts_with("not decided: friction does not settle in a step"), "{out}{err}");
    assert!(out.contains(" made after 20 of settling, friction not settled in 1 of them"), "{out}");
    let (_, out, err) = place.run(&["simulate", "short.toml", "--steps", "3", "--out", "short"]);
    assert!(line_of(&out, "friction").is_none() && out.contains("\nunconverged "), "{out}{err}");
    let (code, out, err) = examine("short.toml");
    assert!(code == 0 && out.starts_with("safe"), "{out}{err}");
}

#[test]
fn a_block_that_shear_strains_is_told_though_its_volume_stays() {
    let place = Place::new();
    let held = |x: u8, y: u8| format!("[[fixed_point]]\nblock = 0\nat = [{x}, {y}, 0]\nstiffness = 1e7\n");
    let text = format!(
        "[simulation]\ngravity = [0, 0, 0]\ntime_step = 0.002\nsteps = 400\n[[material]]\nname = \"m\"\nyoung = 1e5\npoisson = 0.3\n\
         [[block]]\nbox = {{ min = [0, 0, 0], max = [1, 1, 1] }}\n{}{}{}{}[[load]]\nblock = 0\nat = [0.5, 0.5, 1]\nforce = [20000, 0, 0]\n",
        held(0, 0),
        held(1, 0),
        held(0, 1),
        held(1, 1)
    );
    place.file("shear.toml", &text);
    let (code, out, err) = place.run(&["simulate", "shear.toml", "--out", "soft"]);
    let told = line_of(&out, "strain");
    assert!(code == 0 && line_of(&out, "volume").is_none(), "{out}{err}");
    assert_eq!(
        told.as_deref(),
        Some("lines in block 0 are 0.673 to 1.481 times as long as they began: steps take strains for small")
    );
    place.file("stiff.toml", &text.replace("1e5", "1e9"));
    let (_, out, _) = place.run(&["simulate", "stiff.toml", "--out", "stiff"]);
    assert!(line_of(&out, "strain").is_none() && out.contains("\ndisplacement  "), "{out}");
}

#[test]
fn a_run_of_no_step_says_that_nothing_will_move() {
    let place = Place::new();
    place.file("spin.toml", SPIN);
    let note = "note: no step is asked for, so nothing will move: only the beginning is written";
    let (code, out, err) = place.run(&["simulate", "spin.toml", "--steps", "0", "--out", "still"]);
    assert!(code == 0 && err.contains(note) && out.contains("no step was made"), "{out}{err}");
    // What settles moves.
    place.file("settling.toml", &SPIN.replace("steps = 40", "steps = 40\nsettle = 2"));
    for args in [&["settling.toml", "--steps", "0"][..], &["spin.toml", "--steps", "1"]] {
        let (code, _, err) = place.run(&[&["simulate"], args, &["--out", "run", "--overwrite"]].concat());
        assert!(code == 0 && !err.contains("nothing will move"), "{err}");
    }
}
