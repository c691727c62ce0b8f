//! Deliberate mistakes in the stepper's open–close iteration and step control, one at a time: each is found by comparing
//! its steps with the oracle's on a few scenes, and without a mistake no step differs.

use crate::side_by_side_step::{ExactSteps, first_difference};
use crate::step_mistakes::{ALL, Mistake, Mistaken, PLANTING, plant};
use rockproof_model::scene::{SceneBlock, SceneFormat};
use rockproof_model::simulation::{PointLoad, Unconverged};
use rockproof_model::{Block, Motion, Number, Precision, Scene, ToleranceSet, Vec3};
use std::path::Path;

fn n(text: &str) -> Number {
    Number::parse(text).unwrap()
}

fn v([x, y, z]: [&str; 3]) -> Vec3<Number> {
    Vec3::new(n(x), n(y), n(z))
}

fn tolerances() -> ToleranceSet {
    ToleranceSet {
        search: n("1/8"),
        territory: n("1/64"),
        penetration: n("1/16"),
        overlap_sine: n("1/16"),
        parallel_sine: n("1/16"),
        max_displacement: n("1/16"),
        max_rotation: n("1/8"),
        ..ToleranceSet::ZERO
    }
}

fn cuboid(min: [&str; 3], max: [&str; 3], motion: Motion) -> SceneBlock {
    let mut block = SceneBlock::new("block", Block::cuboid(&v(min), &v(max)).unwrap());
    block.body.motion = motion;
    block
}

/// A scene of f64 numbers throughout, so that the stepper has the same ones; after `equal` no number is rounded.
struct Case {
    name: &'static str,
    scene: Scene,
    set: ToleranceSet,
    steps: u32,
}

fn case(name: &'static str, blocks: Vec<SceneBlock>, gravity: [&str; 3], steps: u32) -> Case {
    let mut scene = Scene { blocks, ..Scene::default() };
    scene.simulation.gravity = v(gravity);
    scene.simulation.control.time_step = n("1/128");
    scene.simulation.control.unconverged = Unconverged::Accept;
    scene.simulation.materials[0].density = n("2048");
    let joint = &mut scene.simulation.joints.other;
    joint.normal_stiffness = Some(n("134217728"));
    joint.shear_ratio = n("1/2");
    joint.friction = n("1/2");
    Case { name, scene, set: tolerances(), steps }
}

fn floor() -> SceneBlock {
    cuboid(["-8", "-8", "-1"], ["8", "8", "0"], Motion::Fixed)
}

fn cases() -> Vec<Case> {
    let mut all = Vec::new();
    for friction in ["0", "1/4", "3/4", "1"] {
        // An incline of 3-4-5, gravity turned: slides, creeps or sticks. It begins overlapping a little.
        let mut incline = case(
            "incline",
            vec![floor(), cuboid(["0", "0", "-0.0001220703125"], ["1", "2", "1"], Motion::Rigid)],
            ["6", "0.5", "-8"],
            12,
        );
        incline.scene.simulation.joints.other.friction = n(friction);
        all.push(incline);
    }
    // A block falls on its corners, turning.
    let mut falls = case(
        "falls",
        vec![floor(), cuboid(["0", "0", "0.015625"], ["1", "1.5", "1"], Motion::Deformable)],
        ["1", "0", "-10"],
        24,
    );
    falls.scene.blocks[1].body.velocity = v(["0.5", "0.25", "-1"]);
    falls.scene.blocks[1].body.spin = v(["0.25", "-0.5", "0.125"]);
    // The same, damped, and so fast that Δt is cut.
    for (name, speed) in [("falls, damped", "-1"), ("falls fast, damped", "-12")] {
        let mut damped = case(name, falls.scene.blocks.clone(), ["1", "0", "-10"], 12);
        damped.scene.blocks[1].body.velocity = v(["0.5", "0.25", speed]);
        damped.scene.simulation.control.damping = n("8");
        all.push(damped);
    }
    all.push(falls);
    // The same with tolerances that are no zeros.
    let mut dull = case(
        "dull",
        vec![floor(), cuboid(["0", "0", "0.00390625"], ["1", "1.5", "1"], Motion::Rigid)],
        ["1", "0", "-10"],
        24,
    );
    dull.scene.blocks[1].body.velocity = v(["0.25", "0", "-0.25"]);
    dull.scene.blocks[1].body.spin = v(["0.125", "0.0625", "0"]);
    dull.set.open = n("1/1024");
    dull.set.close = n("1/1024");
    dull.set.equal = n("1/4");
    all.push(dull);
    // Glued to the floor and pulled: up off the middle, and along.
    // What slides while nothing presses it never settles exactly, and f64 sees no misfit earlier; so that scene makes one step.
    for (name, force, cohesion, tension, steps) in [
        ("glued and torn off", ["0", "0", "65536"], "8192", "32768", 1),
        ("glued and pulled up", ["0", "0", "65536"], "8192", "131072", 8),
        ("glued and pushed", ["32768", "4096", "-1024"], "16384", "8192", 8),
        ("glued and dragged", ["131072", "4096", "1024"], "16384", "65536", 8),
    ] {
        let mut glued = case(
            name,
            vec![floor(), cuboid(["0", "0", "-0.0001220703125"], ["1", "1", "0.5"], Motion::Rigid)],
            ["0", "0", "-10"],
            steps,
        );
        glued.scene.simulation.joints.other.cohesion = n(cohesion);
        glued.scene.simulation.joints.other.tension = n(tension);
        glued.scene.simulation.loads =
            vec![PointLoad { block: 1, at: v(["0.625", "0.5", "0.5"]), table: vec![(n("0"), v(force))] }];
        all.push(glued);
    }
    // Too fast, and turning too fast.
    let mut fast = case("fast", vec![cuboid(["0", "0", "0"], ["1", "1", "2"], Motion::Rigid)], ["0", "0", "-10"], 2);
    fast.scene.blocks[0].body.velocity = v(["0", "0", "-12"]);
    all.push(fast);
    let mut turning = case(
        "turning",
        vec![cuboid(["-0.25", "-0.25", "0"], ["0.25", "0.25", "0.25"], Motion::Rigid)],
        ["0", "0", "0"],
        2,
    );
    turning.scene.blocks[0].body.spin = v(["0", "0", "20"]);
    turning.set.max_displacement = n("1/4");
    all.push(turning);
    // Two blocks on one another, one thrown: many modes change, and not all attempts converge.
    for speed in ["1", "2", "3"] {
        let mut pile = case(
            "pile",
            vec![
                floor(),
                cuboid(["0", "0", "-0.000030517578125"], ["1", "1", "1"], Motion::Deformable),
                cuboid(["0.25", "0.125", "0.99993896484375"], ["1.25", "1.125", "1.5"], Motion::Rigid),
            ],
            ["0", "0", "-10"],
            16,
        );
        pile.scene.blocks[2].body.velocity = v([speed, "0.5", "-0.5"]);
        pile.scene.blocks[2].body.spin = v(["0.5", "1", "0.25"]);
        all.push(pile);
    }
    // Touching exactly, pressed together.
    all.push(case(
        "touches",
        vec![floor(), cuboid(["0", "0", "0"], ["1", "1", "1"], Motion::Rigid)],
        ["1", "0", "-10"],
        6,
    ));
    // Touching plates above and below exactly, pressed by nothing.
    let mut sideways = case(
        "touches, weightless",
        vec![
            floor(),
            cuboid(["0", "0", "0"], ["1", "1", "1"], Motion::Rigid),
            cuboid(["-4", "-4", "1"], ["4", "4", "2"], Motion::Fixed),
        ],
        ["0", "0", "0"],
        2,
    );
    sideways.scene.blocks[1].body.velocity = v(["0.25", "0", "0"]);
    all.push(sideways);
    // Overlapping by more than `penetration`, and apart by more than it.
    all.push(case(
        "deep",
        vec![floor(), cuboid(["0", "0", "-0.09375"], ["1", "1", "1"], Motion::Rigid)],
        ["0", "0", "-10"],
        2,
    ));
    all.push(case(
        "near",
        vec![floor(), cuboid(["0", "0", "0.09375"], ["1", "1", "1"], Motion::Rigid)],
        ["0", "0", "-10"],
        2,
    ));
    // A seventh solve, and contacts kept, of the golden steps. In its fourth step f64 ends the first scene a solve early.
    all.push(golden("tension_shear", 3));
    all.push(golden("deep_kept", 8));
    // A sixth change, and a twelfth, in which contacts only lock or slide.
    let mut slips = golden("fast_disp_cut", 1);
    slips.scene.simulation.control.time_step = n("1/32");
    slips.scene.simulation.joints.other.friction = n("3/10");
    all.push(slips);
    all.push(steep_dominoes());
    all
}

/// A scene of the golden steps, and how many of its steps f64 makes with the decisions of the file.
fn golden(name: &'static str, steps: u32) -> Case {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden/golden_steps.json");
    let scenes: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap();
    let found = scenes.as_array().unwrap().iter().find(|scene| scene["name"] == name).unwrap();
    let scene = Scene::parse(found["scene"].as_str().unwrap(), SceneFormat::Toml, file.as_ref()).unwrap();
    let set = scene.tolerances.clone().unwrap_or_default().derive(&scene.shapes(), Precision::F64).unwrap();
    Case { name, scene, set, steps }
}

/// The first step of the handmade dominoes, with Δt twice and tan φ four times as large: friction locks and slides until the attempt is given up.
fn steep_dominoes() -> Case {
    let mut scene =
        Scene::load(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/cases/handmade/dominoes.toml"))).unwrap();
    scene.simulation.control.time_step = n("1/200");
    scene.simulation.joints.other.friction = n("12/5");
    let set = scene.tolerances.clone().unwrap_or_default().derive(&scene.shapes(), Precision::F64).unwrap();
    scene.derive_stiffness(&set);
    Case { name: "steep dominoes", scene, set, steps: 1 }
}

#[test]
fn every_mistake_is_found_and_none_where_there_is_none() {
    let _alone = PLANTING.lock();
    let mut cases: Vec<(Case, ExactSteps)> = cases().into_iter().map(|case| (case, ExactSteps::default())).collect();
    let mut lost = Vec::new();
    for &(mistake, what) in ALL {
        plant(mistake);
        let found = cases.iter_mut().find_map(|(case, oracle)| {
            Some((case.name, first_difference::<Mistaken>(&case.scene, &case.set, case.steps, oracle)?))
        });
        println!("{what}: {found:?}");
        if (mistake == Mistake::Nothing) != found.is_none() {
            lost.push((what, found));
        }
    }
    assert!(lost.is_empty(), "{lost:?}");
    assert!(ALL.len() > 12);
}
