use super::*;
use crate::contact::{PreparedBlock, Tolerances};
use crate::dynamics::Dynamics;
use rockproof_model::{Block, Motion, Number, Precision, Scene, SceneBlock, ToleranceSpec, Vec3};

fn cuboid(low: [f64; 3], high: [f64; 3]) -> Block {
    let at = |corner: [f64; 3]| {
        let [x, y, z] = corner.map(|x| Number::from_f64(x).expect("finite"));
        Vec3::new(x, y, z)
    };
    Block::cuboid(&at(low), &at(high)).expect("a block")
}

#[test]
fn distances_are_counted_rounded_up_and_without_end() {
    let mut travel = BlockTravel::of(3);
    for (distance, units) in [
        (0.0, 0),
        (1e-300, 1),
        (0.5, UNITS / 2),
        (0.5 + 1e-12, UNITS / 2 + 1),
        (1.0, UNITS),
        (f64::INFINITY, MAX_UNITS),
        (f64::NAN, MAX_UNITS),
        (1e300, MAX_UNITS),
    ] {
        let before = travel.0[1];
        travel.add(1, distance, 1.0);
        assert_eq!(travel.0[1] - before, units, "{distance}");
    }
    travel.0[1] = u64::MAX - 1;
    travel.add(1, 1.0, 1.0);
    assert_eq!(travel.0, [0, u64::MAX, 0]);
    // Nothing is known without a margin.
    travel.add(2, 1.0, 0.0);
    travel.add(2, 1.0, f64::NAN);
    assert_eq!(travel.0[2], 2 * MAX_UNITS);
}

#[test]
fn the_farthest_coordinate_counts() {
    let at = |x: f64, y: f64, z: f64| Vector::new(x, y, z);
    let before = [at(0.0, 0.0, 0.0), at(1.0, 2.0, 3.0)];
    assert!(farthest(&before, &before) == 0.0);
    assert!(farthest(&before, &[at(0.0, 0.25, -0.5), at(1.0, 2.125, 3.0)]) == 0.5);
    assert!(farthest(&before, &[at(0.0, 0.0, 0.0), at(0.0, 2.0, 3.0)]) == 1.0);
}

/// What a pair knows after looks at which its blocks had moved by so many units.
fn known_after(moved: &[[u64; 2]]) -> Vec<bool> {
    let set = ToleranceSpec::default();
    let [a, b] = [cuboid([0.0; 3], [1.0; 3]), cuboid([0.0, 0.0, 1.0], [1.0, 1.0, 2.0])];
    let scene =
        Scene { blocks: vec![SceneBlock::new("a", a.clone()), SceneBlock::new("b", b.clone())], ..Scene::default() };
    let set = set.derive(&scene.shapes(), Precision::F64).expect("tolerances");
    let tolerances = Tolerances::<f64>::new(&set).expect("in range");
    let [a, b] = [a, b].map(|block| PreparedBlock::new(&block).expect("a block"));
    let request = ClassificationRequest { a: &a, b: &b, tolerances: &tolerances, kept: &[], among: None };
    let mut watched = NeighbourList::default();
    let known = |&[one, two]: &[u64; 2]| {
        let travel = BlockTravel(vec![7, one, 7, two]);
        watched.nearby([1, 3], &travel, request, skin(tolerances.search)).is_some()
    };
    moved.iter().map(known).collect()
}

#[test]
fn features_are_found_when_blocks_are_calm_and_forgotten_when_either_has_moved_on() {
    let few = UNITS / CALM_SHARE / 8;
    let calm = usize::from(LOOKS_BEFORE_LISTING);
    let mut looks: Vec<[u64; 2]> = (0..calm as u64).map(|k| [k * few, few]).collect();
    assert_eq!(known_after(&looks), vec![false; calm]);
    let found = [LOOKS_BEFORE_LISTING.into(), 2].map(|k: u64| k * few);
    looks.push(found);
    assert_eq!(known_after(&looks)[calm..], [true]);
    for [one, two] in [[0, 0], [USED_UP, 0], [0, USED_UP], [USED_UP, USED_UP], [USED_UP + 1, 0], [0, USED_UP + 1]] {
        let mut looks = looks.clone();
        looks.push([found[0] + one, found[1] + two]);
        assert_eq!(known_after(&looks)[calm + 1], one <= USED_UP && two <= USED_UP, "{one} {two}");
        const { assert!(USED_UP < UNITS) };
    }
    // Never while they move on.
    let restless: Vec<[u64; 2]> = (0..50).map(|k| [k * UNITS / CALM_SHARE / 2, 0]).collect();
    assert_eq!(known_after(&restless), [false; 50]);
    // Those of one that has moved on are found again.
    looks.extend(vec![[9 * UNITS, 0]; calm + 2]);
    let known = known_after(&looks);
    assert_eq!((&known[calm + 1..2 * calm + 1], &known[2 * calm + 1..]), (&vec![false; calm][..], &[true, true][..]));
}

/// A cube that falls on a floor from hardly more than `search` above it.
fn fall(forget: bool) -> String {
    let mut scene = Scene::on_fixed("floor", cuboid([-2.0, -2.0, -1.0], [3.0, 3.0, 0.0]));
    let mut cube = SceneBlock::new("cube", cuboid([0.0, 0.0, 0.0652], [1.0, 1.0, 1.0652]));
    cube.body.motion = Motion::Rigid;
    scene.blocks.push(cube);
    let set = ToleranceSpec::default().derive(&scene.shapes(), Precision::F64).expect("tolerances");
    scene.simulation.control.time_step = Number::from_f64(1.0 / 4096.0).expect("finite");
    scene.derive_stiffness(&set);
    let mut dynamics = Dynamics::<f64>::new(&scene, &set).expect("a scene");
    for _ in 0..700 {
        dynamics.step().expect("a step");
        if forget {
            dynamics.travel = BlockTravel::of(2);
        }
    }
    format!("{:?}", dynamics.state().blocks)
}

#[test]
fn forgetting_the_motion_of_a_block_is_seen() {
    assert_eq!(fall(false), fall(false));
    assert_ne!(fall(false), fall(true));
}
