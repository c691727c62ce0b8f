//! Scenes with closed forms: blocks of 1 m on one another, on a fixed floor.

use rockproof_model::simulation::{JointPair, JointProperties};
use rockproof_model::{
    Block, BlockError, Motion, Number, Precision, Scene, SceneBlock, SpecError, ToleranceSet, ToleranceSpec, Vec3,
};
use rockproof_stepper::dynamics::{Dynamics, SetupError, Solve, StepError};

/// Why a scene cannot be stepped.
#[derive(Debug, thiserror::Error)]
pub enum StepsError {
    /// A block is none.
    #[error(transparent)]
    Block(#[from] BlockError),
    /// There are no tolerances.
    #[error(transparent)]
    Tolerances(#[from] SpecError),
    /// The scene cannot be stepped.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// A step cannot be made.
    #[error(transparent)]
    Stopped(#[from] StepError),
}

/// Weight of a block of 1 m³ of the default material under 10 m/s² (N).
pub(super) const BLOCK_WEIGHT: f64 = 26_000.0;

/// Static steps before time starts.
const SETTLING: u32 = 20;

/// As many blocks of 1 m as there are stiffnesses, on one another, on a fixed floor whose top is z = 0. `stiffness[k]` is the normal
/// stiffness of the contacts under block `k + 1`, [`SETTLING`] static steps come first.
pub(super) fn column(stiffness: &[Number], motion: Motion) -> Result<Scene, BlockError> {
    let corner = |x, y, z| Vec3::new(Number::from_integer(x), Number::from_integer(y), Number::from_integer(z));
    let mut scene = Scene::on_fixed("floor", Block::cuboid(&corner(-1, -1, -1), &corner(2, 2, 0))?);
    let joints = &mut scene.simulation.joints;
    for (k, stiffness) in (0..).zip(stiffness) {
        let mut block =
            SceneBlock::new(format!("block_{}", k + 1), Block::cuboid(&corner(0, 0, k), &corner(1, 1, k + 1))?);
        block.body.motion = motion;
        block.body.joint = scene.blocks.len();
        joints.names.push(format!("joint_{}", k + 1));
        let properties = JointProperties { normal_stiffness: Some(stiffness.clone()), ..JointProperties::default() };
        joints.pairs.push(JointPair { one: scene.blocks.len() - 1, other: scene.blocks.len(), properties });
        scene.blocks.push(block);
    }
    scene.simulation.gravity = corner(0, 0, -10);
    scene.simulation.control.settle = SETTLING;
    Ok(scene)
}

/// The scene after its settling, under `auto` for this precision.
pub(super) fn settled<R: Solve>(scene: &Scene, precision: Precision) -> Result<Dynamics<R>, StepsError> {
    let mut scene = scene.clone();
    let set: ToleranceSet = ToleranceSpec::default().derive(&scene.shapes(), precision)?;
    scene.derive_stiffness(&set);
    let mut dynamics = Dynamics::<R>::new(&scene, &set)?;
    while dynamics.state().settling > 0 {
        dynamics.step()?;
    }
    Ok(dynamics)
}
