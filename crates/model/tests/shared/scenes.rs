//! What a scene says (docs/scene.md): each default where it says nothing, each value where it says everything, and both ends of what is allowed.

use rockproof_model::scene::SceneFormat;
use rockproof_model::simulation::{
    Control, FixedPoint, JointPair, JointProperties, Joints, Kinematics, Material, MeasuredPoint, PointLoad, Skips,
    Solver, Unconverged,
};
use rockproof_model::{Body, Criteria, LoadOptions, Motion, Number, Point, Precision, Preset, Scene, Simulation, Vec3};
use std::path::Path;

const BOX: &str = "[[block]]\nbox = { min = [0, 0, 0], max = [1, 2, 4] }\n";

fn number(text: &str) -> Number {
    Number::parse(text).expect("a number")
}

/// What a number without quotes stands for.
fn float(value: f64) -> Number {
    Number::from_f64(value).expect("finite")
}

fn point([x, y, z]: [&str; 3]) -> Point {
    Vec3::new(number(x), number(y), number(z))
}

fn parse(text: &str) -> Result<Scene, String> {
    Scene::parse(text, SceneFormat::Toml, Path::new("a.toml")).map_err(|error| error.to_string())
}

/// The column of defaults.
#[test]
fn a_scene_that_names_nothing_has_every_default() {
    let scene = parse(BOX).expect("a scene");
    let joint = JointProperties {
        friction: number("3/5"),
        cohesion: number("0"),
        tension: number("0"),
        normal_stiffness: None,
        shear_ratio: number("2/5"),
    };
    let wanted = Simulation {
        gravity: Vec3::new(number("0"), number("0"), float(-9.81)),
        control: Control {
            time_step: number("1/100"),
            dynamic: number("1"),
            damping: number("0"),
            settle: 0,
            kinematics: Kinematics::Cayley,
            unconverged: Unconverged::Stop,
            steps: None,
            duration: None,
            skips: Skips { blocks: true, pairs: true, islands: true, features: true },
            solver: Solver::Auto,
        },
        materials: vec![Material {
            name: "rock".to_string(),
            density: number("2600"),
            young: number("10000000000"),
            poisson: number("1/4"),
        }],
        joints: Joints { names: vec!["joint".to_string()], pairs: Vec::new(), other: joint.clone() },
        loads: Vec::new(),
        fixed_points: Vec::new(),
        measured_points: Vec::new(),
    };
    assert_eq!(scene.simulation, wanted);
    // Tables without keys say nothing either.
    let bare = format!("[simulation]\n[[joint]]\n[[material]]\nname = \"rock\"\n{BOX}");
    assert_eq!(parse(&bare).expect("a scene").simulation, wanted);
    let zero = || point(["0", "0", "0"]);
    let body = Body {
        motion: Motion::Deformable,
        material: 0,
        joint: 0,
        velocity: zero(),
        spin: zero(),
        stress: ["0"; 6].map(number),
    };
    let block = &scene.blocks[0];
    assert_eq!((&block.name[..], &block.body, &block.planarity), ("block_0", &body, &float(1e-9)));
    // No tolerances are those of `auto`.
    let set = scene.tolerances.clone().unwrap_or_default().derive(&scene.shapes(), Precision::F64).expect("a set");
    let auto = rockproof_model::preset::derive(Preset::Auto, &scene.shapes(), Precision::F64).expect("a set");
    assert_eq!(set, auto);
}

const EVERYTHING: &str = r#"
planarity = "1/1000"

[tolerances]
preset = "shi"
search = "1/3"
overlap_angle = 30
parallel_sine = "3/64"
max_rotation = 0.5
criteria = "revised"

[simulation]
gravity = ["1/3", -2, 0.1]
time_step = "1/1024"
time = "7/2"
dynamic = "1/2"
damping = 0.25
settle = 12
kinematics = "linear"
unconverged = "accept"
joint_materials = ["clay", "saw-cut", "rough"]
skips = ["islands", "blocks"]
solver = "conjugate-gradients"

[[material]]
name = "granite"
density = 2700
young = 5e10
poisson = "-1/5"

[[material]]
name = "shale"

[[joint]]
between = ["rough", "saw-cut"]
friction_angle = 45
cohesion = 1000
tension = "1/7"
normal_stiffness = 8e9
shear_stiffness = 1e9

[[joint]]
friction = "1/2"
normal_stiffness = 1e8
shear_ratio = "3/7"

[[block]]
name = "base"
fixed = true
joint = "rough"
box = { min = [0, 0, 0], max = [1, 2, 4] }

[[block]]
planarity = 0
motion = "rigid"
material = "shale"
velocity = [1, 0, "1/3"]
spin = [0, 2, 0]
stress = [1, 2, 3, 4, 5, "-1/6"]
vertices = [[0, 0, 5], [1, 0, 5], [0, 1, 5], [0, 0, 6]]
faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]

[[block]]
name = "third"
box = { min = [9, 0, 0], max = [10, 1, 1] }

[[set]]
blocks = "all"
velocity = [7, 7, 7]
joint = "saw-cut"

[[set]]
blocks = [2, "base"]
velocity = [8, 8, 8]
stress = [6, 5, 4, 3, 2, 1]
material = "shale"

[[load]]
block = "third"
at = [9, 0, 0]
force = [1, 2, "1/3"]

[[load]]
block = 1
at = [0, 0, 5]
table = [[0, 0, 0, 0], ["1/2", 1, 0, -100]]

[[fixed_point]]
block = "base"
at = [1, 2, 4]
stiffness = "5/2"

[[fixed_point]]
block = 0
at = [0, 0, 0]

[[measured_point]]
block = "third"
at = [9, 0, 1]

[[measured_point]]
name = "top"
block = 1
at = [0, 0, 6]

[[measured_point]]
block = 1
at = [0, 0, 5]
"#;

#[test]
fn a_scene_that_names_everything_has_what_it_names() {
    let scene = parse(EVERYTHING).expect("a scene");
    let found = &scene.simulation;
    assert_eq!(found.gravity, Vec3::new(number("1/3"), number("-2"), float(0.1)));
    assert_eq!(
        found.control,
        Control {
            time_step: number("1/1024"),
            dynamic: number("1/2"),
            damping: number("1/4"),
            settle: 12,
            kinematics: Kinematics::Linear,
            unconverged: Unconverged::Accept,
            steps: None,
            duration: Some(number("7/2")),
            skips: Skips { blocks: true, pairs: false, islands: true, features: false },
            solver: Solver::ConjugateGradients,
        }
    );
    let material = |name: &str, density: &str, young: &str, poisson: &str| Material {
        name: name.to_string(),
        density: number(density),
        young: number(young),
        poisson: number(poisson),
    };
    let granite = material("granite", "2700", "50000000000", "-1/5");
    assert_eq!(found.materials, [granite, material("shale", "2600", "10000000000", "1/4")]);
    assert_eq!(found.joints.names, ["clay", "saw-cut", "rough"]);
    let named = JointProperties {
        // 45° is 1 exactly.
        friction: number("1"),
        cohesion: number("1000"),
        tension: number("1/7"),
        normal_stiffness: Some(number("8000000000")),
        shear_ratio: number("1/8"),
    };
    let other = JointProperties {
        friction: number("1/2"),
        cohesion: number("0"),
        tension: number("0"),
        normal_stiffness: Some(number("100000000")),
        shear_ratio: number("3/7"),
    };
    assert_eq!(found.joints.pairs, [JointPair { one: 2, other: 1, properties: named.clone() }]);
    assert_eq!(found.joints.other, other);
    for (one, two, wanted) in [(1, 2, &named), (2, 1, &named), (2, 2, &other), (0, 1, &other), (1, 1, &other)] {
        assert_eq!(found.joints.between(one, two), wanted, "{one} on {two}");
    }
    // Later tables override earlier ones, key by key.
    let zero = || point(["0", "0", "0"]);
    let stressed = || ["6", "5", "4", "3", "2", "1"].map(number);
    let body = |motion, material, velocity: &str| Body {
        motion,
        material,
        joint: 1,
        velocity: point([velocity; 3]),
        spin: zero(),
        stress: stressed(),
    };
    let tetrahedron = Body {
        spin: point(["0", "2", "0"]),
        stress: ["1", "2", "3", "4", "5", "-1/6"].map(number),
        ..body(Motion::Rigid, 1, "7")
    };
    let wanted = [body(Motion::Fixed, 1, "8"), tetrahedron, body(Motion::Deformable, 1, "8")];
    assert_eq!(scene.blocks.iter().map(|b| b.body.clone()).collect::<Vec<_>>(), wanted);
    assert_eq!(scene.blocks.iter().map(|b| b.name.as_str()).collect::<Vec<_>>(), ["base", "block_1", "third"]);
    let planarity = ["1/1000", "0", "1/1000"].map(number);
    assert_eq!(scene.blocks.iter().map(|b| b.planarity.clone()).collect::<Vec<_>>(), planarity);
    let load = |block, at, table: &[(&str, [&str; 3])]| PointLoad {
        block,
        at: point(at),
        table: table.iter().map(|(time, force)| (number(time), point(*force))).collect(),
    };
    assert_eq!(found.loads[1], load(1, ["0", "0", "5"], &[("0", ["0"; 3]), ("1/2", ["1", "0", "-100"])]));
    let constant = &found.loads[0];
    assert_eq!((constant.block, &constant.at), (2, &point(["9", "0", "0"])));
    assert!(!constant.table.is_empty() && constant.table.iter().all(|(_, f)| *f == point(["1", "2", "1/3"])));
    let held = |stiffness: Option<&str>, at| FixedPoint { block: 0, at: point(at), stiffness: stiffness.map(number) };
    assert_eq!(found.fixed_points, [held(Some("5/2"), ["1", "2", "4"]), held(None, ["0"; 3])]);
    let measured = |name: &str, block, at| MeasuredPoint { name: name.to_string(), block, at: point(at) };
    let points = [("point_0", 2, ["9", "0", "1"]), ("top", 1, ["0", "0", "6"]), ("point_2", 1, ["0", "0", "5"])];
    assert_eq!(found.measured_points, points.map(|(name, block, at)| measured(name, block, at)));
}

/// Named tolerances are what they are named; the others are the preset's.
#[test]
fn tolerances_stand_over_their_preset() {
    let scene = parse(EVERYTHING).expect("a scene");
    let spec = scene.tolerances.as_ref().expect("tolerances");
    let set = spec.derive(&scene.shapes(), Precision::F64).expect("a set");
    let mut wanted = rockproof_model::preset::derive(Preset::Shi, &scene.shapes(), Precision::F64).expect("a set");
    wanted.search = number("1/3");
    wanted.parallel_sine = number("3/64");
    wanted.max_rotation = number("1/2");
    wanted.criteria = Criteria::Revised;
    // sin 30° as an f64: within one unit in the last place of a half.
    assert!((set.overlap_sine.as_f64().expect("an f64") - 0.5).abs() <= f64::EPSILON / 2.0);
    wanted.overlap_sine = set.overlap_sine.clone();
    assert_eq!(set, wanted);
}

#[test]
fn steps_joint_materials_and_skips_have_their_other_forms() {
    let all = format!(
        "[simulation]\nsteps = 40\nskips = []\n[[joint]]\nbetween = [\"b\", \"a\"]\n[[joint]]\nbetween = [\"b\", \"c\"]\n{BOX}"
    );
    let found = parse(&all).expect("a scene").simulation;
    assert_eq!((found.control.steps, found.control.duration), (Some(40), None));
    assert_eq!(found.control.skips, Skips { blocks: false, pairs: false, islands: false, features: false });
    // Those in `between`, in the order read; a block that names none has the first.
    assert_eq!(found.joints.names, ["b", "a", "c"]);
    let dir = tempfile::tempdir().expect("a directory");
    std::fs::write(
        dir.path().join("more.obj"),
        "o t\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n",
    )
    .expect("written");
    let text = format!("{BOX}[[block]]\nfile = \"more.obj\"\nmotion = \"rigid\"\n{BOX}");
    std::fs::write(dir.path().join("a.toml"), text).expect("written");
    let scene = Scene::load_with(dir.path().join("a.toml"), &LoadOptions::default()).expect("a scene");
    let shapes: Vec<(usize, Motion)> = scene.blocks.iter().map(|b| (b.block.vertices().len(), b.body.motion)).collect();
    assert_eq!(shapes, [(8, Motion::Deformable), (4, Motion::Rigid), (8, Motion::Deformable)]);
}

/// What stands after the box of the first block, and whether it is allowed: each limit, and what is just beyond it.
const LIMITS: [(&str, &[&str], &[&str]); 22] = [
    ("[simulation]\ntime_step = #", &["\"1e-300\""], &["0", "-1"]),
    ("[simulation]\nsteps = #", &["1", "1000000"], &["0", "-1", "1.5"]),
    ("[simulation]\ntime = #", &["\"1e-300\""], &["0", "\"-1e-300\""]),
    ("[simulation]\ndynamic = #", &["0", "1"], &["\"-1e-300\"", "\"1000000000000000000001/1000000000000000000000\""]),
    ("[simulation]\ndamping = #", &["0", "1e9"], &["\"-1e-300\""]),
    ("[simulation]\nsettle = #", &["0", "7"], &["-1"]),
    ("[simulation]\ngravity = #", &["[0, 0, 0]"], &["[0, 0]", "[0, 0, 0, 0]", "[0, 0, nan]", "[0, 0, inf]"]),
    ("[[material]]\nname = \"a\"\ndensity = #", &["\"1e-300\""], &["0", "-1"]),
    ("[[material]]\nname = \"a\"\nyoung = #", &["\"1e-300\""], &["0", "-1"]),
    (
        "[[material]]\nname = \"a\"\npoisson = #",
        &["0", "\"-99999999999999999999/100000000000000000000\"", "\"49999999999999999999/100000000000000000000\""],
        &["-1", "\"1/2\"", "0.5", "2"],
    ),
    ("[[joint]]\nfriction = #", &["0", "100"], &["\"-1e-300\""]),
    ("[[joint]]\nfriction_angle = #", &["0", "89.99"], &["90", "-0.001", "100"]),
    ("[[joint]]\ncohesion = #", &["0"], &["\"-1e-300\""]),
    ("[[joint]]\ntension = #", &["0"], &["\"-1e-300\""]),
    ("[[joint]]\nnormal_stiffness = #", &["\"1e-300\""], &["0", "-1"]),
    ("[[joint]]\nshear_ratio = #", &["0", "9"], &["\"-1e-300\""]),
    ("[[joint]]\nnormal_stiffness = 1\nshear_stiffness = #", &["0", "9"], &["\"-1e-300\""]),
    ("planarity = #", &["0", "1"], &["\"-1e-300\""]),
    ("[[fixed_point]]\nblock = 0\nat = [0, 0, 0]\nstiffness = #", &["\"1e-300\""], &["0", "-1"]),
    // The longest side is 4: as far outside the box and no further.
    (
        "[[measured_point]]\nblock = 0\nat = #",
        &["[-4, -4, 8]", "[5, 6, 8]", "[0.5, 1, 2]"],
        &["[0, 0, \"8000000000000000000001/1000000000000000000000\"]", "[-4.001, 0, 0]", "[5.001, 0, 0]"],
    ),
    (
        "[[load]]\nblock = 0\nat = [0, 0, 0]\ntable = #",
        &["[[3, 0, 0, 0]]", "[[0, 0, 0, 0], [\"1e-300\", 0, 0, 0]]"],
        &["[]", "[[0, 0, 0, 0], [0, 1, 0, 0]]", "[[1, 0, 0, 0], [0, 0, 0, 0]]", "[[0, 0, 0]]"],
    ),
    ("[[set]]\nblocks = #", &["[0]", "\"all\"", "[\"block_0\"]"], &["[1]", "[-1]", "[\"block_1\"]", "\"most\""]),
];

#[test]
fn what_is_allowed_begins_and_ends_where_the_page_says() {
    for (pattern, allowed, refused) in LIMITS {
        for (value, is_allowed) in allowed.iter().map(|v| (v, true)).chain(refused.iter().map(|v| (v, false))) {
            let text = format!("{BOX}{}\n", pattern.replace('#', value));
            let found = parse(&text);
            assert_eq!(found.is_ok(), is_allowed, "{text}: {:?}", found.err());
        }
    }
}
