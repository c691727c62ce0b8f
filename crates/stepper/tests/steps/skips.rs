//! What a step leaves out changes no bit.

use crate::support::{begin, cuboid, floor, load, n, v, weightless};
use rockproof_model::{Motion, Scene};
use rockproof_stepper::dynamics::{Dynamics, Skips, Solve, StepReport};

const OTHERS: [Skips; 5] = [
    Skips::NONE,
    Skips { blocks: false, ..Skips::ALL },
    Skips { pairs: false, ..Skips::ALL },
    Skips { islands: false, ..Skips::ALL },
    Skips { features: false, ..Skips::ALL },
];

/// Makes the steps with everything left out that can be, and with other choices beside it, and holds the states to the same bits. Returns the
/// last report.
fn same_bits<R: Solve>(scene: &Scene, steps: usize) -> StepReport {
    let mut all: Dynamics<R> = begin(scene);
    let mut others = OTHERS.map(|skips| {
        let mut other: Dynamics<R> = begin(scene);
        other.skip(skips);
        other
    });
    let mut last = None;
    for step in 0..steps {
        let report = all.step().unwrap();
        for other in &mut others {
            assert_eq!(report, other.step().unwrap(), "step {step}");
            assert_eq!(all.modes(), other.modes(), "step {step}");
            // Zeros of both signs are equal, but not the same bits: they are written differently.
            assert_eq!(format!("{:?}", all.state()), format!("{:?}", other.state()), "step {step}");
        }
        last = Some(report);
    }
    last.unwrap()
}

/// Two columns of `high` cubes without weight on a floor, and a cube that flies against the top of one of them.
fn struck(high: u32, motion: Motion) -> Scene {
    let mut blocks = vec![floor()];
    for column in 0..2 {
        for k in 0..high {
            let (x, far) = ((2 * column).to_string(), (2 * column + 1).to_string());
            let (low, top) = (k.to_string(), (k + 1).to_string());
            blocks.push(cuboid(&format!("{column} {k}"), [&x, "0", &low], [&far, "1", &top], motion));
        }
    }
    let low = format!("{}/10", 10 * high + 1);
    let high = format!("{}/10", 10 * high + 11);
    let mut stone = cuboid("stone", ["1/4", "1/4", &low], ["5/4", "5/4", &high], motion);
    stone.body.velocity.z = n("-2");
    blocks.push(stone);
    weightless(blocks)
}

#[test]
fn a_column_at_rest_is_left_alone_until_it_is_struck() {
    for motion in [Motion::Rigid, Motion::Deformable] {
        let report = same_bits::<f64>(&struck(3, motion), 20);
        assert!(report.kinetic > 0.0);
        same_bits::<f32>(&struck(2, motion), 15);
    }
}

/// A tall column is a system that is not solved as a dense one.
#[test]
fn a_tall_column_is_left_alone_until_it_is_struck() {
    same_bits::<f64>(&struck(12, Motion::Deformable), 14);
}

#[test]
fn what_loads_and_settling_change_is_solved_again() {
    let cube = |x: i32| {
        let (low, high) = (x.to_string(), (x + 1).to_string());
        cuboid(&format!("cube {x}"), [&low, "0", "0"], [&high, "1", "1"], Motion::Rigid)
    };
    // The load begins after a few steps of rest.
    let mut scene = weightless(vec![floor(), cube(-3), cube(0)]);
    let table = [("0", v("0", "0", "0")), ("1/20", v("0", "0", "0")), ("1/10", v("1e4", "0", "3e4"))];
    scene.simulation.loads.push(load(1, v("-5/2", "1/2", "1"), &table));
    let report = same_bits::<f64>(&scene, 20);
    assert!(report.kinetic > 0.0, "{report:?}");
    // A velocity that is set when settling is over.
    let mut scene = weightless(vec![floor(), cube(-3), cube(0)]);
    scene.simulation.control.settle = 3;
    scene.blocks[1].body.velocity.x = n("1/2");
    let report = same_bits::<f64>(&scene, 6);
    assert!(report.kinetic > 0.0);
}

/// Static steps come to rest bit for bit, or nearly: whatever they do, it is the same.
#[test]
fn static_steps_under_weight_are_the_same() {
    let mut scene = struck(2, Motion::Rigid);
    scene.simulation.gravity = v("0", "0", "-10");
    scene.simulation.control.dynamic = n("0");
    same_bits::<f64>(&scene, 60);
}
