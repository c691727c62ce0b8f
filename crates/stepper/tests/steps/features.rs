//! Steps that look at nearby pairs of features alone give the same bits as steps that look at all.

use crate::support::{cuboid, floor, handmade, n, scene};
use rockproof_model::{Motion, Precision, Scene, ToleranceSet, ToleranceSpec, Vec3};
use rockproof_stepper::dynamics::{Dynamics, Skips, Solve};

/// Of pairs of blocks whose nearby features are known: the most after a step, how often there were fewer than after the step before, and how
/// many there are at the end.
#[derive(Debug, Default)]
struct Known {
    most: usize,
    losses: usize,
    last: usize,
}

/// Makes the steps with and without, and holds both to the same bits. Ends early where a step cannot be made; then neither can.
fn same_bits<R: Solve>(scene: &Scene, set: &ToleranceSet, steps: usize) -> Known {
    let mut one = Dynamics::<R>::new(scene, set).unwrap();
    let mut other = one.clone();
    one.skip(Skips::ALL);
    other.skip(Skips { features: false, ..Skips::ALL });
    let mut known = Known::default();
    for step in 0..steps {
        let (report, expected) = (one.step(), other.step());
        assert_eq!(format!("{report:?}"), format!("{expected:?}"), "step {step}");
        if report.is_err() {
            break;
        }
        assert_eq!(one.modes(), other.modes(), "step {step}");
        assert_eq!(format!("{:?}", one.state()), format!("{:?}", other.state()), "step {step}");
        let now = one.pairs_with_known_features();
        known.most = known.most.max(now);
        known.losses += usize::from(now < known.last);
        known.last = now;
        assert_eq!(other.pairs_with_known_features(), 0);
    }
    known
}

fn of_file<R: Solve>(name: &str, precision: Precision, steps: usize) -> Known {
    let (mut scene, set) = handmade(name, precision);
    scene.derive_stiffness(&set);
    same_bits::<R>(&scene, &set, steps)
}

#[test]
fn scenes_of_the_paper_are_the_same() {
    let mut losses = 0;
    for (name, steps, knows) in [
        ("tumbling_bricks.toml", 250, true),
        ("bricks_in_a_bin.toml", 250, false),
        ("slope_failure.toml", 150, true),
        ("arch_stands.toml", 60, true),
        ("arch_falls.toml", 120, true),
        ("dominoes.toml", 150, true),
        ("corner_impact_deformable.toml", 200, false),
        ("crossing_ridges.toml", 100, true),
        ("quasi_parallel_edges.toml", 100, true),
        ("approaching_vertices.toml", 200, false),
        ("joint_tears.toml", 80, false),
        ("wedge.toml", 100, false),
        ("inclined_slides.toml", 100, false),
        ("stack_of_10.toml", 60, true),
    ] {
        let by_f64 = of_file::<f64>(name, Precision::F64, steps);
        let by_f32 = of_file::<f32>(name, Precision::F32, steps);
        assert!(!knows || by_f64.most > 0 && by_f32.most > 0, "{name}: {by_f64:?} {by_f32:?}");
        losses += by_f64.losses + by_f32.losses;
    }
    assert!(losses > 20, "{losses}");
}

/// A notched block is not convex: all is looked at.
#[test]
fn blocks_that_are_not_convex_are_looked_at_in_full() {
    for known in [
        of_file::<f64>("brick_in_a_notch.toml", Precision::F64, 120),
        of_file::<f32>("brick_in_a_notch.toml", Precision::F32, 120),
    ] {
        assert_eq!(known.most, 0, "{known:?}");
    }
}

/// Bricks in running bond; the last courses are thrown.
fn wall(motion: Motion, thrown: bool) -> Scene {
    let mut blocks = vec![floor()];
    for course in 0..4i32 {
        for place in 0..3i32 {
            let x = 2 * place - 4 + course % 2;
            let [low, high] = [x, x + 2].map(|x| x.to_string());
            let [bottom, top] = [course, course + 1].map(|z| z.to_string());
            let mut brick = cuboid(&format!("{course} {place}"), [&low, "0", &bottom], [&high, "1", &top], motion);
            if thrown && course > 1 {
                brick.body.velocity = Vec3::new(n("3/2"), n("1/2"), n("1"));
            }
            blocks.push(brick);
        }
    }
    let mut scene = scene(blocks);
    scene.simulation.control.settle = 3;
    scene
}

#[test]
fn walls_that_stand_and_walls_that_fall_are_the_same() {
    for motion in [Motion::Rigid, Motion::Deformable] {
        for (thrown, steps) in [(false, 40), (true, 120)] {
            let scene = wall(motion, thrown);
            for precision in [Precision::F64, Precision::F32] {
                let mut scene = scene.clone();
                let set = ToleranceSpec::default().derive(&scene.shapes(), precision).unwrap();
                scene.derive_stiffness(&set);
                let known = match precision {
                    Precision::F64 => same_bits::<f64>(&scene, &set, steps),
                    Precision::F32 => same_bits::<f32>(&scene, &set, steps),
                };
                // Standing, all pairs that touch; thrown, those at the foot of the wall.
                assert!(known.most >= 10, "{known:?}");
                assert!(!thrown || known.losses > 0, "{known:?}");
            }
        }
    }
}
