//! What a step of a large scene costs: time by phase, and memory.

use crate::lockstep::state::NotFinite;
use crate::model::simulation::derive_stiffness;
use crate::model::{Block, BlockError, Motion, Number, Precision, Scene, SceneBlock, SpecError, ToleranceSpec, Vec3};
use crate::stepper::dynamics::{Dynamics, SetupError, Solve, Stopped};
use std::time::{Duration, Instant};

/// Why steps cannot be timed.
#[derive(Debug, thiserror::Error)]
pub enum SteppingError {
    /// A brick is no block.
    #[error(transparent)]
    Block(#[from] BlockError),
    /// There are no tolerances for the wall.
    #[error(transparent)]
    Tolerances(#[from] SpecError),
    /// The wall cannot be stepped.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// A step cannot be made.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// A state is not finite.
    #[error(transparent)]
    NotFinite(#[from] NotFinite),
}

/// A brick wall in running bond on a fixed floor: bricks of 2 m × 1 m × 1 m, about as many courses as bricks in a course.
///
/// # Errors
/// When a brick is no block.
pub fn wall(bricks: u16) -> Result<Scene, BlockError> {
    let bricks = i32::from(bricks);
    let per_course = (1..).find(|n| n * n >= bricks).unwrap_or(1);
    let corner = |x, y, z| Vec3::new(Number::from_integer(x), Number::from_integer(y), Number::from_integer(z));
    let length = 2 * per_course + 1;
    let mut floor = SceneBlock::new("floor", Block::cuboid(&corner(0, 0, 0), &corner(length, 1, 1))?);
    floor.body.motion = Motion::Fixed;
    let mut scene = Scene { blocks: vec![floor], ..Scene::default() };
    for brick in 0..bricks {
        let (course, place) = (brick / per_course, brick % per_course);
        let (x, z) = (2 * place + course % 2, course + 1);
        let block = Block::cuboid(&corner(x, 0, z), &corner(x + 2, 1, z + 1))?;
        scene.blocks.push(SceneBlock::new(format!("brick_{brick}"), block));
    }
    Ok(scene)
}

/// What the steps of one scene cost.
#[derive(Clone, Debug)]
pub struct Cost {
    /// Blocks, the fixed one too.
    pub blocks: usize,
    /// Contacts of the last step.
    pub contacts: usize,
    /// Steps that were timed.
    pub steps: u32,
    /// Solves a step.
    pub iterations: f64,
    /// A step (s).
    pub step: f64,
    /// Shares of the time of [`Cost::PHASES`].
    pub shares: [f64; 4],
    /// The most memory that the process held, without what it held before the scene was made (bytes); none where the system does not
    /// tell.
    pub memory: Option<u64>,
}

impl Cost {
    /// What a step is made of.
    pub const PHASES: [&'static str; 4] = ["rough", "contacts", "iteration", "update"];
}

/// Makes `steps` steps of a wall after two of settling, and says what they cost. For memory to mean something, larger walls must come
/// after smaller ones.
///
/// # Errors
/// When a step cannot be made.
pub fn stepping<R: Solve>(bricks: u16, steps: u32, precision: Precision) -> Result<Cost, SteppingError> {
    let before = memory("VmRSS:");
    let mut scene = wall(bricks)?;
    scene.simulation.control.settle = 2;
    let set = ToleranceSpec::default().derive(&scene.shapes(), precision)?;
    let bodies: Vec<_> = scene.blocks.iter().map(|block| (&block.block, &block.body)).collect();
    derive_stiffness(&mut scene.simulation, &bodies, &set);
    let mut dynamics = Dynamics::<R>::new(&scene, &set)?;
    while dynamics.state().settling > 0 {
        dynamics.step()?;
    }
    let earlier = phases(&dynamics);
    let begun = Instant::now();
    let mut iterations = 0;
    for _ in 0..steps {
        iterations += dynamics.step()?.iterations;
    }
    let seconds = begun.elapsed().as_secs_f64();
    let spent: [f64; 4] = std::array::from_fn(|k| (phases(&dynamics)[k] - earlier[k]).as_secs_f64());
    let memory = memory("VmHWM:").zip(before).map(|(most, before)| most.saturating_sub(before));
    let count = f64::from(steps.max(1));
    Ok(Cost {
        blocks: scene.blocks.len(),
        contacts: dynamics.state().contacts.len(),
        steps,
        iterations: f64::from(iterations) / count,
        step: seconds / count,
        shares: spent.map(|phase| phase / seconds.max(f64::MIN_POSITIVE)),
        memory,
    })
}

fn phases<R: Solve>(dynamics: &Dynamics<R>) -> [Duration; 4] {
    let phases = dynamics.phases();
    [phases.rough, phases.contacts, phases.iteration, phases.update]
}

/// An entry of Linux's `/proc/self/status` in bytes.
fn memory(entry: &str) -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(entry))?;
    line.trim().strip_suffix(" kB")?.trim().parse::<u64>().ok().map(|kilobytes| 1024 * kilobytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wall_stands_in_bond() {
        let scene = wall(10).expect("a wall");
        assert_eq!(scene.blocks.len(), 11);
        let low = |block: usize| scene.blocks[block].block.vertices()[0].map(Number::approximate);
        assert_eq!((low(1).x, low(5).x, low(5).z, low(9).x), (0.0, 1.0, 2.0, 0.0));
    }

    #[test]
    fn steps_of_a_wall_are_counted_and_timed() {
        let cost = stepping::<f64>(6, 2, Precision::F64).expect("steps");
        assert_eq!((cost.blocks, cost.steps), (7, 2));
        assert!(cost.contacts > 20 && cost.iterations >= 1.0 && cost.step > 0.0, "{cost:?}");
        let all: f64 = cost.shares.iter().sum();
        assert!(all > 0.2 && all < 1.01, "{cost:?}");
    }
}
