//! What a run gains by what its steps leave out ([`Skips`]): scenes that profit, and scenes that cannot.

use crate::stepping::{SteppingError, cuboid, processor, wall};
use rockproof_model::{BlockError, Motion, Number, Precision, Scene, SceneBlock, ToleranceSpec, Vec3};
use rockproof_stepper::dynamics::{Dynamics, Skips};
use std::time::Instant;

/// A scene to measure.
#[derive(Clone, Copy, Debug)]
pub struct SkipScene {
    /// What moves in it.
    pub name: &'static str,
    /// Moving and fixed blocks.
    pub blocks: u16,
    /// Steps to make.
    pub steps: u32,
    make: fn(u16) -> Result<Scene, BlockError>,
}

/// The scenes: ten blocks of many move, a wall stands, everything flies.
#[must_use]
pub fn skip_scenes(quick: bool) -> [SkipScene; 3] {
    let sized = |blocks: u16, steps: u32| if quick { (blocks / 50, 2) } else { (blocks, steps) };
    let scene = |name, (blocks, steps), make| SkipScene { name, blocks, steps, make };
    [
        scene("ten move", sized(5000, 10), ten_move),
        scene("wall stands", sized(200, 50), wall),
        scene("all fly", sized(2000, 10), all_fly),
    ]
}

/// What is left out, by name.
pub const SKIPS: [(&str, Skips); 6] = [
    ("everything", Skips::ALL),
    ("not blocks", Skips { blocks: false, ..Skips::ALL }),
    ("not pairs", Skips { pairs: false, ..Skips::ALL }),
    ("not islands", Skips { islands: false, ..Skips::ALL }),
    ("not features", Skips { features: false, ..Skips::ALL }),
    ("nothing", Skips::NONE),
];

/// What the steps of a scene cost in each of [`SKIPS`].
#[derive(Clone, Debug)]
pub struct SkipCost {
    /// Blocks, fixed ones too.
    pub blocks: usize,
    /// Steps a second, by the clock.
    pub rates: [f64; 6],
    /// A step in time of processors (s), to hundredths of a second for all steps; none where the system does not tell.
    pub processor: [Option<f64>; 6],
}

/// Measures the steps of a scene, one choice after another, in turn step by step, so that what else the machine does hits all alike.
///
/// # Errors
/// When a step cannot be made.
pub fn skip_cost(scene: &SkipScene) -> Result<SkipCost, SteppingError> {
    let mut made = (scene.make)(scene.blocks)?;
    let set = ToleranceSpec::default().derive(&made.shapes(), Precision::F64)?;
    made.derive_stiffness(&set);
    let mut first = Dynamics::<f64>::new(&made, &set)?;
    // What is at rest is known to be so after a step.
    first.step()?;
    let mut all = SKIPS.map(|(_, skips)| {
        let mut dynamics = first.clone();
        dynamics.skip(skips);
        dynamics
    });
    let (mut seconds, mut busy) = ([0.0; 6], [Some(0.0); 6]);
    for _ in 0..scene.steps {
        for (k, dynamics) in all.iter_mut().enumerate() {
            let (begun, before) = (Instant::now(), processor());
            dynamics.step()?;
            seconds[k] += begun.elapsed().as_secs_f64();
            let taken = processor().zip(before).map(|(now, before)| now - before);
            busy[k] = busy[k].zip(taken).map(|(sum, taken)| sum + taken);
        }
    }
    let count = f64::from(scene.steps.max(1));
    Ok(SkipCost {
        blocks: first.state().blocks.len(),
        rates: seconds.map(|seconds| count / seconds.max(f64::MIN_POSITIVE)),
        processor: busy.map(|busy| busy.map(|seconds| seconds / count)),
    })
}

/// Cubes of 1 m in columns of ten on a fixed floor, without weight; the last ten fly above them.
fn ten_move(blocks: u16) -> Result<Scene, BlockError> {
    let columns = (i32::from(blocks) - 10).max(10) / 10;
    let side = (1..).find(|n| n * n >= columns).unwrap_or(1);
    let mut scene = Scene::on_fixed("floor", cuboid([0, 0, -1], [2 * side, 2 * side, 0])?);
    for number in 0..10 * columns {
        let (column, z) = (number / 10, number % 10);
        let (x, y) = (2 * (column % side), 2 * (column / side));
        let cube = cuboid([x, y, z], [x + 1, y + 1, z + 1])?;
        scene.blocks.push(SceneBlock::new(format!("cube_{number}"), cube));
    }
    for number in 0..10 {
        let mut flying =
            SceneBlock::new(format!("stone_{number}"), cuboid([2 * number, 0, 20], [2 * number + 1, 1, 21])?);
        flying.body.velocity.x = Number::from_integer(1);
        scene.blocks.push(flying);
    }
    Ok(weightless(scene))
}

/// Cubes of 1 m far apart, without weight, each with a velocity of its own.
fn all_fly(blocks: u16) -> Result<Scene, BlockError> {
    let blocks = i32::from(blocks);
    let side = (1..).find(|n| n * n * n >= blocks).unwrap_or(1);
    let mut scene = Scene::on_fixed("floor", cuboid([0, 0, -9], [1, 1, -8])?);
    for number in 0..blocks {
        let [x, y, z] = [number % side, number / side % side, number / (side * side)].map(|k| 4 * k);
        let mut cube = SceneBlock::new(format!("cube_{number}"), cuboid([x, y, z], [x + 1, y + 1, z + 1])?);
        cube.body.velocity.x = Number::from_integer(number % 3 - 1);
        cube.body.velocity.z = Number::from_integer(1);
        scene.blocks.push(cube);
    }
    Ok(weightless(scene))
}

fn weightless(mut scene: Scene) -> Scene {
    scene.simulation.gravity = Vec3::new(Number::ZERO, Number::ZERO, Number::ZERO);
    let moving = scene.blocks.iter_mut().filter(|block| !block.body.is_fixed());
    moving.for_each(|block| block.body.motion = Motion::Deformable);
    scene
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_choice_is_measured() {
        for scene in skip_scenes(true) {
            let cost = skip_cost(&scene).expect("steps");
            assert!(
                cost.blocks > usize::from(scene.blocks) / 2 && cost.rates.iter().all(|rate| *rate > 0.0),
                "{cost:?}"
            );
        }
    }
}
