use super::*;
use crate::lockstep::intrusion::{Intrusion, PairIntrusion};
use crate::lockstep::intrusion_case::{IntrusionCase, MAX_BLOCKS, NoCase, intrusion_case};
use rockproof_model::{Block, Number, SceneBlock, Vec3};

fn number(value: f64) -> Number {
    Number::from_f64(value).expect("a number")
}

fn cuboid(low: [f64; 3], high: [f64; 3]) -> SceneBlock {
    let [low, high] = [low, high].map(|[x, y, z]| Vec3::new(number(x), number(y), number(z)));
    let mut block = SceneBlock::new("block", Block::cuboid(&low, &high).expect("a block"));
    block.body.motion = Motion::Rigid;
    block
}

fn fixed(low: [f64; 3], high: [f64; 3]) -> SceneBlock {
    let mut block = cuboid(low, high);
    block.body.motion = Motion::Fixed;
    block
}

/// Blocks at rest in a row that a heavy one hits: the first, number 1, goes through a fixed plate, number 0. The row has so many blocks between,
/// and the last of these is near so many more. 70 others are far away.
fn driven(between: u32, beside: u32) -> (Scene, ToleranceSet) {
    let mut scene = Scene { blocks: vec![fixed([0.75, -1.0, -1.0], [0.8125, 1.0, 1.0])], ..Scene::default() };
    scene.blocks.push(cuboid([0.5, 0.0, 0.0], [0.625, 0.125, 0.125]));
    let mut end = 0.5;
    for place in 1..=between {
        let long = if place == between { f64::from(beside) / 16.0 } else { 0.0 };
        scene.blocks.push(cuboid([end - 0.125, 0.0, -long], [end, 0.125, 0.125 + long]));
        end -= 0.125;
    }
    let lowest = 0.0625 - f64::from(beside) / 16.0;
    for place in 0..beside {
        let low = lowest + f64::from(place) / 8.0;
        scene.blocks.push(cuboid([end, 0.15625, low + 0.03125], [end + 0.125, 0.25, low + 0.09375]));
    }
    let mut heavy = cuboid([end - 2.0, -1.0, -1.0], [end, 1.125, 1.125]);
    heavy.body.velocity = Vec3::new(number(50.0), Number::ZERO, Number::ZERO);
    scene.blocks.push(heavy);
    scene.blocks.extend((0..70).map(|k| fixed([9.0, 9.0, 2.0 * f64::from(k)], [10.0, 10.0, 2.0 * f64::from(k) + 1.0])));
    scene.simulation.gravity = Vec3::new(Number::ZERO, Number::ZERO, Number::ZERO);
    scene.simulation.control.time_step = number(0.0078125);
    let set = ToleranceSet {
        search: number(0.0625),
        territory: number(0.0078125),
        penetration: number(0.0078125),
        max_displacement: number(1.0),
        max_rotation: number(0.125),
        ..ToleranceSet::ZERO
    };
    scene.derive_stiffness(&set);
    (scene, set)
}

/// The passage of blocks 0 and 1 in the first step, and its case.
fn case(scene: &Scene, set: &ToleranceSet) -> Result<IntrusionCase, NoCase> {
    let mut dynamics = Dynamics::<f64, SpecRules>::with_rules(scene, set).expect("a scene");
    let before = dynamics.state().clone();
    dynamics.step().expect("a step");
    let exactly = ExactScene::new(scene, set);
    let states = [&before, dynamics.state()].map(|state| exact_state(state).expect("finite"));
    let all = Intrusions::among(&[0, 1], &exactly, states.each_ref(), &Number::ZERO);
    let passage: &PairIntrusion = all.between(Intrusion::Passage, [0, 1]).expect("a passage");
    let found = FoundIntrusion { kind: passage.kind, blocks: [0, 1], depth_m: passage.depth.expect("a depth") };
    intrusion_case(scene, set, Precision::F64, &before, found)
}

#[test]
fn a_case_has_what_drives_a_block_two_contacts_away_and_nothing_else() {
    let (scene, set) = driven(1, 0);
    let made = case(&scene, &set).expect("a case");
    assert!(scene.blocks.len() > MAX_BLOCKS && made.blocks == 4 && !made.causes.is_empty(), "{made:?}");
}

#[test]
fn of_many_blocks_at_one_distance_few_are_kept() {
    let (scene, set) = driven(1, 80);
    let made = case(&scene, &set).expect("a case");
    assert!((4..=MAX_BLOCKS).contains(&made.blocks) && !made.causes.is_empty(), "{made:?}");
}

#[test]
fn where_all_of_many_blocks_are_needed_their_number_is_told() {
    let (scene, set) = driven(66, 0);
    assert_eq!(case(&scene, &set), Err(NoCase::TooMany(69)));
}
