//! What a step of a large scene costs: time by phase, and memory.

use rockproof_differential::lockstep::state::NotFinite;
use rockproof_model::{
    Block, BlockError, BlockOptions, Number, Precision, Scene, SceneBlock, SpecError, ToleranceSpec, Vec3,
};
use rockproof_stepper::dynamics::{Dynamics, SetupError, Solve, StepError};
use std::time::{Duration, Instant};

/// Why steps cannot be timed.
#[derive(Debug, thiserror::Error)]
pub enum SteppingError {
    /// A brick or a piece is no block.
    #[error(transparent)]
    Block(#[from] BlockError),
    /// There are no tolerances for the scene.
    #[error(transparent)]
    Tolerances(#[from] SpecError),
    /// The scene cannot be stepped.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// A step cannot be made.
    #[error(transparent)]
    Stopped(#[from] StepError),
    /// A state is not finite.
    #[error(transparent)]
    NotFinite(#[from] NotFinite),
}

/// The cuboid of two corners (m).
pub(crate) fn cuboid(low: [i32; 3], high: [i32; 3]) -> Result<Block, BlockError> {
    let [low, high] = [low, high].map(|corner| {
        let [x, y, z] = corner.map(Number::from_integer);
        Vec3::new(x, y, z)
    });
    Block::cuboid(&low, &high)
}

/// A brick wall in running bond on a fixed floor: bricks of 2 m × 1 m × 1 m, about as many courses as bricks in a course.
///
/// # Errors
/// When a brick is no block.
pub fn wall(bricks: u16) -> Result<Scene, BlockError> {
    let bricks = i32::from(bricks);
    let per_course = (1..).find(|n| n * n >= bricks).unwrap_or(1);
    let mut scene = Scene::on_fixed("floor", cuboid([0, 0, 0], [2 * per_course + 1, 1, 1])?);
    for brick in 0..bricks {
        let (course, place) = (brick / per_course, brick % per_course);
        let (x, z) = (2 * place + course % 2, course + 1);
        let block = cuboid([x, 0, z], [x + 2, 1, z + 1])?;
        scene.blocks.push(SceneBlock::new(format!("brick_{brick}"), block));
    }
    scene.share_shapes();
    Ok(scene)
}

/// Cubes of 1 m on one another, on a fixed floor. They settle for a tenth as many steps as there are cubes, at least for 100: let go at
/// once, a tower of a thousand springs back, and where its cubes hardly touch they lock and slide in turn at every Δt. Of more cubes, or
/// in f32, some still do, and Δt is cut.
///
/// # Errors
/// When a cube is no block.
pub fn stack(cubes: u16) -> Result<Scene, BlockError> {
    let cube = |low: i32| cuboid([0, 0, low], [1, 1, low + 1]);
    let mut scene = Scene::on_fixed("floor", cube(0)?);
    scene.simulation.control.settle = u32::from(cubes / 10).max(100);
    for number in 1..=i32::from(cubes) {
        scene.blocks.push(SceneBlock::new(format!("cube_{number}"), cube(number)?));
    }
    scene.share_shapes();
    Ok(scene)
}

/// A mass of rock cut by three sets of inclined joints, on a fixed base that dips by 14°: parallelepipeds in layers, each layer moved by
/// half a block against the one below; about as many layers as blocks along each side of a layer.
///
/// # Errors
/// When a piece is no block.
pub fn rock(blocks: u16) -> Result<Scene, BlockError> {
    let blocks = i64::from(blocks);
    let side = (1..).find(|n| n * n * n >= blocks).unwrap_or(1);
    // Sixteenths of a metre; all corners are sums of these and of their halves.
    let edges: [[i64; 3]; 3] = [[32, 0, 8], [4, 32, 0], [-4, 4, 16]];
    let corner = |halves: [i64; 3]| {
        let along = |axis: usize| (0..3).map(|k| halves[k] * edges[k][axis]).sum::<i64>() as f64 / 32.0;
        let number = |axis| Number::from_f64(along(axis)).unwrap_or(Number::ZERO);
        Vec3::new(number(0), number(1), number(2))
    };
    let piece = |low: [i64; 3], size: [i64; 3]| {
        let far = |k: usize, axis: usize| low[axis] + if k >> axis & 1 == 1 { size[axis] } else { 0 };
        let vertices = (0..8).map(|k| corner([0, 1, 2].map(|axis| far(k, axis)))).collect();
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [1, 3, 7, 5], [3, 2, 6, 7], [2, 0, 4, 6]];
        Block::new(vertices, faces.map(Vec::from).to_vec(), &BlockOptions { planarity: Number::ZERO })
    };
    let mut scene = Scene::on_fixed("base", piece([-2, -2, -2], [2 * side + 5, 2 * side + 5, 2])?);
    for number in 0..blocks {
        let (layer, place) = (number / (side * side), number % (side * side));
        let moved = layer % 2;
        let block = piece([2 * (place % side) + moved, 2 * (place / side) + moved, 2 * layer], [2; 3])?;
        scene.blocks.push(SceneBlock::new(format!("piece_{number}"), block));
    }
    scene.share_shapes();
    Ok(scene)
}

/// What the steps of one scene cost.
#[derive(Clone, Debug)]
pub struct SteppingCost {
    /// Blocks, the fixed one too.
    pub blocks: usize,
    /// Contacts of the last step.
    pub contacts: usize,
    /// Steps that were timed.
    pub steps: u32,
    /// Attempts given up, a step.
    pub retries: f64,
    /// Solves a step, those of attempts given up included.
    pub solves: f64,
    /// A step (s).
    pub step: f64,
    /// A step, in time of processors (s), to hundredths of a second for all steps; none where the system does not tell. Other programs
    /// bear on it less.
    pub processor: Option<f64>,
    /// Shares of the time of [`SteppingCost::PHASES`].
    pub shares: [f64; 8],
    /// The most memory that the process held, without what it held before the scene was made (bytes); none where the system does not
    /// tell.
    pub memory: Option<u64>,
}

impl SteppingCost {
    /// What a step is made of: boxes and pairs; classification; then the open–close iteration: orders of elimination, adding up forces,
    /// matrices and their factors, solving by them, judging the contacts; and moving the blocks.
    pub const PHASES: [&'static str; 8] =
        ["rough", "detection", "order", "assembly", "factor", "solve", "judge", "update"];
}

/// Makes `steps` steps of a scene after settling for two steps, or for more if the scene wants it, and says what they cost. For memory to
/// mean something, larger scenes must come after smaller ones.
///
/// # Errors
/// When a step cannot be made.
pub fn stepping<R: Solve>(
    make: impl FnOnce() -> Result<Scene, BlockError>,
    steps: u32,
    precision: Precision,
) -> Result<SteppingCost, SteppingError> {
    let before = memory("VmRSS:");
    let mut scene = make()?;
    let settle = &mut scene.simulation.control.settle;
    *settle = (*settle).max(2);
    let set = ToleranceSpec::default().derive(&scene.shapes(), precision)?;
    scene.derive_stiffness(&set);
    let mut dynamics = Dynamics::<R>::new(&scene, &set)?;
    drop(scene);
    while dynamics.state().settling > 0 {
        dynamics.step()?;
    }
    let (earlier, solves) = (phases(&dynamics), dynamics.iteration_times().solves);
    let (begun, busy) = (Instant::now(), processor());
    let mut retries = 0;
    for _ in 0..steps {
        retries += dynamics.step()?.retries.len();
    }
    let seconds = begun.elapsed().as_secs_f64();
    let busy = processor().zip(busy).map(|(now, before)| now - before);
    let now = phases(&dynamics);
    let memory = memory("VmHWM:").zip(before).map(|(most, before)| most.saturating_sub(before));
    let count = f64::from(steps.max(1));
    Ok(SteppingCost {
        blocks: dynamics.state().blocks.len(),
        contacts: dynamics.state().contacts.len(),
        steps,
        retries: retries as f64 / count,
        solves: (dynamics.iteration_times().solves - solves) as f64 / count,
        step: seconds / count,
        processor: busy.map(|seconds| seconds / count),
        shares: std::array::from_fn(|k| (now[k] - earlier[k]).as_secs_f64() / seconds.max(f64::MIN_POSITIVE)),
        memory,
    })
}

fn phases<R: Solve>(dynamics: &Dynamics<R>) -> [Duration; 8] {
    let (phases, iteration_times) = (dynamics.phases(), dynamics.iteration_times());
    let iteration = [
        iteration_times.order,
        iteration_times.assembly,
        iteration_times.factor,
        iteration_times.substitution,
        iteration_times.judgement,
    ];
    let [order, assembly, factor, substitution, judgement] = iteration;
    [phases.rough, phases.contacts, order, assembly, factor, substitution, judgement, phases.update]
}

/// An entry of Linux's `/proc/self/status` in bytes.
fn memory(entry: &str) -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(entry))?;
    line.trim().strip_suffix(" kB")?.trim().parse::<u64>().ok().map(|kilobytes| 1024 * kilobytes)
}

/// The time that processors gave to this process (s), from Linux's `/proc/self/stat`, which counts in hundredths of a second.
pub(crate) fn processor() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/stat").ok()?;
    // The second entry, the name, is in brackets and may hold anything.
    let mut entries = text.rsplit_once(')')?.1.split_whitespace().skip(11);
    let mut next = || entries.next()?.parse::<f64>().ok();
    Some((next()? + next()?) / 100.0)
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
    fn cubes_of_a_stack_touch_by_their_corners() {
        let stack = stepping::<f64>(|| stack(5), 3, Precision::F64).expect("steps");
        assert_eq!((stack.blocks, stack.contacts, stack.solves), (6, 20, 1.0));
    }

    #[test]
    fn pieces_of_rock_share_their_joints() {
        let scene = rock(27).expect("a mass");
        assert_eq!(scene.blocks.len(), 28);
        // Every piece has the volume of the first, and the first layer lies on the base.
        let volumes: Vec<_> = scene.blocks[1..].iter().map(|block| block.block.volume()).collect();
        assert!(volumes.iter().all(|volume| *volume == volumes[0]));
        let vertices = |block: usize| scene.blocks[block].block.vertices();
        assert_eq!(vertices(1)[1], vertices(2)[0]);
        assert_eq!(vertices(1)[2], vertices(4)[0]);
    }

    #[test]
    fn steps_are_counted_and_timed() {
        let wall = stepping::<f64>(|| wall(6), 2, Precision::F64).expect("steps");
        assert_eq!((wall.blocks, wall.steps), (7, 2));
        let rock = stepping::<f32>(|| rock(12), 2, Precision::F32).expect("steps");
        assert_eq!((rock.blocks, rock.steps), (13, 2));
        for cost in [wall, rock] {
            assert!(cost.contacts > 20 && cost.solves >= 1.0 && cost.step > 0.0, "{cost:?}");
            let all: f64 = cost.shares.iter().sum();
            assert!(all > 0.2 && all < 1.01, "{cost:?}");
        }
    }
}
