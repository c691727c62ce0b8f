//! What makes blocks move: scenes say it, come back from being written, and are refused with line, key and range.

use num_rational::BigRational;
use proptest::prelude::*;
use rockproof_model::scene::{SceneFormat, write_toml};
use rockproof_model::simulation::{
    Control, FixedPoint, JointPair, JointProperties, Kinematics, Material, MeasuredPoint, PointLoad, Skips, Solver,
    Unconverged,
};
use rockproof_model::{
    Block, Body, Motion, Number, Precision, Rule, Scene, SceneBlock, Simulation, Vec3, tolerance_rules,
};
use std::path::Path;

const PAGE: &str = include_str!("../../../docs/scene.md");
const BOX: &str = "[[block]]\nname = \"base\"\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\n";

fn parse(text: &str) -> Result<Scene, String> {
    Scene::parse(text, SceneFormat::Toml, Path::new("a.toml")).map_err(|error| error.to_string())
}

fn example() -> &'static str {
    PAGE.split("```toml\n").nth(1).unwrap().split("```").next().unwrap()
}

fn number(text: &str) -> Number {
    Number::parse(text).unwrap()
}

#[test]
fn the_example_of_the_page_says_what_it_says_and_meets_the_rules() {
    let scene = parse(example()).unwrap();
    let joint = scene.simulation.joints.between(0, 0);
    assert_eq!((&joint.friction, &joint.shear_ratio), (&number("1/2"), &number("2/5")));
    assert_eq!(scene.blocks[0].body.motion, Motion::Fixed);
    assert_eq!(scene.simulation.measured_points[0].block, 1);
    assert_eq!(scene.simulation.loads[0].table[1].1.z, number("-100"));
    let set = scene.tolerances.as_ref().unwrap().derive(&scene.shapes(), Precision::F64).unwrap();
    assert_eq!(tolerance_rules::check_scene(&set, &scene, Precision::F64), []);
}

#[test]
fn the_weight_rule_ties_exactly_and_names_the_remedy() {
    // 2600 kg at 10 m/s² on 4 corners: 6500 N each. With p = 6.5e6 N/m the overlap is 1/1000 m.
    let text = format!(
        "{BOX}fixed = true\n[[block]]\nbox = {{ min = [0, 0, 1], max = [1, 1, 2] }}\n[simulation]\ngravity = [0, -6, -8]\n\
         [[joint]]\nnormal_stiffness = 6.5e6\n"
    );
    let scene = parse(&text).unwrap();
    let mut set = rockproof_model::ToleranceSpec::default().derive(&scene.shapes(), Precision::F64).unwrap();
    set.penetration = number("1/1000");
    let broken = |set: &_| {
        let all = tolerance_rules::check_scene(set, &scene, Precision::F64);
        all.into_iter().find(|violation| violation.rule == Rule::Stiffness)
    };
    assert_eq!(broken(&set), None);
    set.penetration = number("999999999999999999/1000000000000000000000");
    let violation = broken(&set).unwrap();
    assert_eq!(violation.place.unwrap().block, 1);
    assert!(violation.remedy.starts_with("normal_stiffness ≥ 6.50001e6"), "{violation}");
}

#[test]
fn broken_scenes_name_line_key_and_range() {
    let tail = |text: &str| format!("{BOX}{text}");
    let cases: [(&str, &[&str]); 46] = [
        ("[simulation]\ngravity = [0, 0]", &["a.toml:5:", "`gravity`, an array of 3"]),
        ("[simulation]\ntime_step = 0", &["a.toml:5:", "`time_step` of [simulation] is 0", "more than 0"]),
        ("[simulation]\ntime_step = \"x\"", &["a.toml:5:", "`time_step`", "not a number"]),
        ("[simulation]\nsteps = 0", &["a.toml:5:", "`steps` of [simulation] is 0", "1 to"]),
        ("[simulation]\nsteps = 1.5", &["a.toml:5:", "found 1.5", "a whole number"]),
        ("[simulation]\nsteps = 1\ntime = 1", &["a.toml:6:", "`time` beside `steps`"]),
        ("[simulation]\ntime = -1", &["a.toml:5:", "`time` of [simulation] is -1"]),
        ("[simulation]\ndynamic = 1.5", &["a.toml:5:", "`dynamic`", "0 to 1"]),
        ("[simulation]\ndamping = -1", &["a.toml:5:", "`damping` of [simulation] is -1", "0 or more"]),
        ("[simulation]\ndamping = \"1/s\"", &["a.toml:5:", "`damping`", "not a number"]),
        ("[simulation]\nsettle = -1", &["a.toml:5:", "`settle`", "is -1"]),
        ("[simulation]\nkinematics = \"cubic\"", &["a.toml:5:", "\"cubic\"", "\"linear\" or \"cayley\""]),
        ("[simulation]\nunconverged = 1", &["a.toml:5:", "`unconverged`"]),
        ("[simulation]\nskips = [\"blocks\", \"contacts\"]", &["a.toml:5:", "`skips`", "\"contacts\"", "\"islands\""]),
        ("[simulation]\nskips = \"all\"", &["a.toml:5:", "`skips` of [simulation]"]),
        (
            "[simulation]\nsolver = \"cholesky\"",
            &["a.toml:5:", "`solver` of [simulation]", "\"cholesky\"", "\"auto\", \"factor\", \"conjugate-gradients\""],
        ),
        ("[simulation]\nsolver = 1", &["a.toml:5:", "`solver` of [simulation]"]),
        ("[simulation]\nsetle = 1", &["a.toml:5:", "unknown key `setle`", "settle"]),
        ("[simulation]\njoint_materials = []", &["a.toml:5:", "one name or more"]),
        ("[simulation]\njoint_materials = [\"a\", \"a\"]", &["a.toml:5:", "not taken"]),
        ("[[material]]\ndensity = 1", &["a.toml:4:", "no `name`"]),
        ("[[material]]\nname = \"a\"\ndensity = 0", &["a.toml:6:", "`density`", "more than 0"]),
        ("[[material]]\nname = \"a\"\nyoung = -1", &["a.toml:6:", "`young`", "more than 0"]),
        ("[[material]]\nname = \"a\"\npoisson = 0.5", &["a.toml:6:", "`poisson`", "less than 1/2"]),
        ("[[material]]\nname = \"a\"\npoisson = -1", &["a.toml:6:", "more than -1"]),
        ("[[material]]\nname = \"a\"\n[[material]]\nname = \"a\"", &["a.toml:7:", "not taken"]),
        ("[[joint]]\nfriction = -1", &["a.toml:5:", "`friction`", "0 or more"]),
        ("[[joint]]\nfriction_angle = 90", &["a.toml:5:", "less than 90"]),
        ("[[joint]]\nfriction = 1\nfriction_angle = 9", &["a.toml:6:", "one of them"]),
        ("[[joint]]\ncohesion = -1", &["a.toml:5:", "`cohesion`"]),
        ("[[joint]]\nnormal_stiffness = 0", &["a.toml:5:", "`normal_stiffness`"]),
        ("[[joint]]\nshear_stiffness = 1", &["a.toml:5:", "`normal_stiffness` beside it"]),
        ("[[joint]]\n[[joint]]", &["a.toml:5:", "a second [[joint]]"]),
        ("[[joint]]\nbetween = [\"a\"]", &["a.toml:5:", "two names"]),
        (
            "[[joint]]\nbetween = [\"a\", \"b\"]\n[[joint]]\nbetween = [\"b\", \"a\"]",
            &["a.toml:7:", "no [[joint]] above"],
        ),
        ("motion = \"free\"", &["a.toml:4:", "`motion`", "\"rigid\""]),
        ("motion = \"rigid\"\nfixed = true", &["a.toml:5:", "`fixed` beside `motion`"]),
        ("material = \"chalk\"", &["a.toml:4:", "\"chalk\"", "\"rock\""]),
        ("joint = \"clay\"", &["a.toml:4:", "\"clay\"", "\"joint\""]),
        ("stress = [1, 2, 3]", &["a.toml:4:", "an array of 6"]),
        ("[[set]]\nblocks = [1]", &["a.toml:5:", "is 1", "0 to 0", "\"base\""]),
        ("[[set]]\nblocks = [\"bas\"]", &["a.toml:5:", "\"bas\"", "\"base\""]),
        ("[[load]]\nblock = 0\nat = [0, 0, 0]", &["a.toml:4:", "no `force`"]),
        (
            "[[load]]\nblock = 0\nat = [0, 0, 0]\ntable = [[1, 0, 0, 0], [1, 0, 0, 0]]",
            &["a.toml:7:", "the time before it, 1"],
        ),
        ("[[fixed_point]]\nblock = 0\nat = [0, 0, 0]\nstiffness = 0", &["a.toml:7:", "`stiffness`"]),
        ("[[measured_point]]\nblock = 0\nat = [0, 0, 2.5]", &["a.toml:6:", "(0, 0, 2.5)", "within 1 m", "\"base\""]),
    ];
    for (text, parts) in cases {
        let message = parse(&tail(text)).expect_err(text);
        assert!(parts.iter().all(|part| message.contains(part)), "{text}: {message}");
    }
}

fn any_number() -> impl Strategy<Value = Number> {
    (any::<i32>(), 1..i32::MAX).prop_map(|(n, d)| Number::from_rational(BigRational::new(n.into(), d.into())))
}

fn positive() -> impl Strategy<Value = Number> {
    (1..i32::MAX, 1..i32::MAX).prop_map(|(n, d)| Number::from_rational(BigRational::new(n.into(), d.into())))
}

fn vector() -> impl Strategy<Value = Vec3<Number>> {
    [any_number(), any_number(), any_number()].prop_map(|[x, y, z]| Vec3::new(x, y, z))
}

fn joint() -> impl Strategy<Value = JointProperties> {
    ([positive(), positive(), positive(), positive()], prop::option::of(positive())).prop_map(
        |([friction, cohesion, tension, shear_ratio], normal_stiffness)| JointProperties {
            friction,
            cohesion,
            tension,
            normal_stiffness,
            shear_ratio,
        },
    )
}

fn body() -> impl Strategy<Value = Body> {
    let stress = [any_number(), any_number(), any_number(), any_number(), any_number(), any_number()];
    (0..3_usize, 0..2_usize, 0..2_usize, vector(), vector(), stress).prop_map(
        |(motion, material, joint, velocity, spin, stress)| Body {
            motion: Motion::ALL[motion],
            material,
            joint,
            velocity,
            spin,
            stress,
        },
    )
}

fn simulation() -> impl Strategy<Value = Simulation> {
    let run = prop_oneof![Just(None), Just(Some(Err(7_u64))), positive().prop_map(|t| Some(Ok(t)))];
    (vector(), positive(), run, 0..9_u32, any::<[bool; 3]>(), [joint(), joint()], [positive(), positive()], vector())
        .prop_map(
            |(gravity, time_step, run, settle, [linear, accept, skips], [pair, other], [density, young], force)| {
                let mut simulation = Simulation { gravity, ..Simulation::default() };
                simulation.control = Control {
                    time_step,
                    dynamic: number("1/3"),
                    damping: if accept { Number::ZERO } else { density.clone() },
                    settle,
                    kinematics: if linear { Kinematics::Linear } else { Kinematics::Cayley },
                    unconverged: if accept { Unconverged::Accept } else { Unconverged::Stop },
                    steps: run.as_ref().and_then(|run| run.as_ref().err().copied()),
                    duration: run.and_then(Result::ok),
                    skips: Skips { pairs: skips, islands: accept, blocks: linear, features: !skips },
                    solver: Solver::ALL[settle as usize % Solver::ALL.len()],
                };
                let second = Material { name: "a \"second\" é".to_string(), density, young, poisson: number("-1/3") };
                simulation.materials.push(second);
                simulation.joints.names = vec!["wet".to_string(), "dry".to_string()];
                simulation.joints.pairs = vec![JointPair { one: 1, other: 0, properties: pair }];
                simulation.joints.other = other;
                let at = Vec3::new(number("1/3"), number("2"), number("-1"));
                let table = vec![(Number::ZERO, force.clone()), (number("1/7"), force.clone())];
                simulation.loads = vec![
                    PointLoad { block: 1, at: at.clone(), table },
                    PointLoad { block: 0, at: at.clone(), table: vec![(number("1/3"), force.clone())] },
                    PointLoad { block: 0, at: at.clone(), table: vec![(Number::ZERO, force)] },
                ];
                simulation.fixed_points = vec![FixedPoint { block: 0, at: at.clone(), stiffness: None }];
                simulation.measured_points = vec![MeasuredPoint { name: "tip".to_string(), block: 1, at }];
                simulation
            },
        )
}

proptest! {
    #[test]
    fn every_simulation_survives_being_written(simulation in simulation(), bodies in [body(), body()]) {
        let cube = Block::cuboid(&Vec3::new(Number::ZERO, Number::ZERO, Number::ZERO), &Vec3::new(number("1"), number("1"), number("1"))).unwrap();
        let blocks = bodies.map(|body| SceneBlock { body, ..SceneBlock::new("same name", cube.clone()) });
        let scene = Scene { blocks: blocks.into(), tolerances: None, simulation };
        let text = write_toml(&scene);
        let again = parse(&text).map_err(|error| TestCaseError::fail(format!("{error}\n{text}")))?;
        prop_assert_eq!(&again.simulation, &scene.simulation);
        let bodies = |scene: &Scene| scene.blocks.iter().map(|b| b.body.clone()).collect::<Vec<_>>();
        prop_assert_eq!(bodies(&again), bodies(&scene));
    }
}

#[test]
fn handmade_cases_load_and_meet_every_rule() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../cases/handmade");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let scene = Scene::load(&path).unwrap_or_else(|error| panic!("{error}"));
        let shapes = scene.shapes();
        let set = scene.tolerances.as_ref().unwrap().derive(&shapes, Precision::F64).unwrap();
        assert_eq!(tolerance_rules::check_scene(&set, &scene, Precision::F64), [], "{}", path.display());
        count += 1;
    }
    assert!(count >= 16, "{count}");
}
