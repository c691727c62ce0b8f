//! A scene in the stepper's precision: what does not change from step to step.

use crate::contact::{Collapsed, ToleranceOverflow, Tolerances};
use crate::dynamics::displacement::BlockVector;
use crate::dynamics::material::{Elastic, Joint};
use crate::dynamics::state::{BlockState, ContactState, State};
use crate::real::Real;
use crate::vector::Vector;
use rockproof_model::simulation::{Kinematics, Motion, Simulation, Solver, Unconverged};
use rockproof_model::{Block, Number, Scene, ToleranceSet, Vec3};

/// Why a scene cannot be stepped.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SetupError {
    /// A number that the precision cannot hold.
    #[error("`{what}` overflows in the stepper's precision")]
    Overflow {
        /// Its name in files.
        what: &'static str,
    },
    /// A block that rounding collapsed.
    #[error("block {block}: {what}")]
    Collapsed {
        /// The block.
        block: usize,
        /// The feature.
        what: Collapsed,
    },
    /// A tolerance out of range.
    #[error(transparent)]
    Tolerance(#[from] ToleranceOverflow),
    /// A joint whose stiffness nobody chose.
    #[error("a joint has no normal stiffness; `model::simulation::derive_stiffness` chooses one")]
    NoStiffness,
    /// A state of some other scene.
    #[error("the state has {found} {what}, the scene has {expected}")]
    Mismatch {
        /// What differs.
        what: &'static str,
        /// In the state.
        found: usize,
        /// In the scene.
        expected: usize,
    },
    /// A state with a contact that the scene cannot have.
    #[error("contact {contact} of the state is of blocks or features that the scene does not have")]
    NoSuchContact {
        /// Its place in the state.
        contact: usize,
    },
}

/// A number in the stepper's precision.
pub(super) fn near<R: Real>(what: &'static str, number: &Number) -> Result<R, SetupError> {
    R::from_number(number).ok_or(SetupError::Overflow { what })
}

/// A vector in the stepper's precision.
pub(super) fn near_vector<R: Real>(what: &'static str, v: &Vec3<Number>) -> Result<Vector<R>, SetupError> {
    Ok(Vector::new(near(what, &v.x)?, near(what, &v.y)?, near(what, &v.z)?))
}

/// A scene, rounded.
#[derive(Clone, Debug)]
pub(super) struct SceneSetup<R> {
    pub(super) blocks: Vec<Block>,
    pub(super) bodies: Vec<BodySetup<R>>,
    pub(super) gravity: Vector<R>,
    pub(super) joints: Vec<Joint<R>>,
    joint_of: Vec<Vec<usize>>,
    pub(super) loads: Vec<SetupLoad<R>>,
    pub(super) held: Vec<HeldPoint<R>>,
    /// The block of each measured point.
    pub(super) measured: Vec<usize>,
    pub(super) control: ControlSetup<R>,
    pub(super) limits: StepLimits<R>,
    pub(super) tolerances: Tolerances<R>,
}

/// What a block is made of and how it moves.
#[derive(Clone, Debug)]
pub(super) struct BodySetup<R> {
    pub(super) motion: Motion,
    pub(super) elastic: Elastic<R>,
    pub(super) joint: usize,
    pub(super) velocity: BlockVector<R>,
    stress: [R; 6],
}

/// A force on a point.
#[derive(Clone, Debug)]
pub(super) struct SetupLoad<R> {
    pub(super) block: usize,
    table: Vec<(R, Vector<R>)>,
}

/// A point held by a spring.
#[derive(Clone, Debug)]
pub(super) struct HeldPoint<R> {
    pub(super) block: usize,
    pub(super) at: Vector<R>,
    pub(super) stiffness: R,
}

/// How time is cut into steps.
#[derive(Clone, Copy, Debug)]
pub(super) struct ControlSetup<R> {
    pub(super) time_step: R,
    pub(super) dynamic: R,
    pub(super) damping: R,
    pub(super) kinematics: Kinematics,
    pub(super) unconverged: Unconverged,
    pub(super) solver: Solver,
}

/// The tolerances of the open–close iteration and of step control.
#[derive(Clone, Copy, Debug)]
pub struct StepLimits<R> {
    /// ε of Eq. (1).
    pub equal: R,
    /// εo in m.
    pub open: R,
    /// εc in m.
    pub close: R,
    /// u in m.
    pub displacement: R,
    /// ω in rad.
    pub rotation: R,
}

impl<R: Real> SetupLoad<R> {
    /// The force at a time: linear between entries, constant outside.
    pub(super) fn force(&self, time: R) -> Vector<R> {
        let (first, last) = (self.table[0], self.table[self.table.len() - 1]);
        if time.below(first.0) {
            return first.1;
        }
        let between = self.table.windows(2).find(|two| time.below(two[1].0));
        between.map_or(last.1, |two| {
            let ((t0, f0), (t1, f1)) = (two[0], two[1]);
            f0 + (f1 - f0) * ((time - t0) / (t1 - t0))
        })
    }
}

impl<R: Real> SceneSetup<R> {
    pub(super) fn new(scene: &Scene, set: &ToleranceSet) -> Result<SceneSetup<R>, SetupError> {
        let simulation = &scene.simulation;
        let elastic = simulation.materials.iter().map(Elastic::new).collect::<Result<Vec<_>, _>>()?;
        let body = |body: &rockproof_model::Body| -> Result<BodySetup<R>, SetupError> {
            let mut velocity = [R::ZERO; 12];
            for (k, number) in body.velocity.components().into_iter().chain(body.spin.components()).enumerate() {
                velocity[k] = near("velocity", number)?;
            }
            let mut stress = [R::ZERO; 6];
            for (k, number) in body.stress.iter().enumerate() {
                stress[k] = near("stress", number)?;
            }
            let (motion, joint) = (body.motion, body.joint);
            if motion == Motion::Fixed {
                velocity = [R::ZERO; 12];
            }
            Ok(BodySetup { motion, elastic: elastic[body.material], joint, velocity, stress })
        };
        let bodies = scene.blocks.iter().map(|block| body(&block.body)).collect::<Result<Vec<_>, _>>()?;
        let (joints, joint_of) = joint_table(simulation)?;
        let stiffest = joints.iter().fold(R::ZERO, |most, joint: &Joint<R>| most.larger(joint.normal));
        let loads = simulation.loads.iter().map(|load| {
            let entry = |(time, force): &(Number, Vec3<Number>)| Ok((near("load", time)?, near_vector("load", force)?));
            let table = load.table.iter().map(entry).collect::<Result<Vec<_>, SetupError>>()?;
            Ok(SetupLoad { block: load.block, table })
        });
        let held = simulation.fixed_points.iter().map(|point| {
            let stiffness = point.stiffness.as_ref().map_or(Ok(stiffest), |k| near("stiffness", k))?;
            Ok(HeldPoint { block: point.block, at: near_vector("fixed_point", &point.at)?, stiffness })
        });
        let control = &simulation.control;
        Ok(SceneSetup {
            blocks: scene.blocks.iter().map(|block| block.block.clone()).collect(),
            bodies,
            gravity: near_vector("gravity", &simulation.gravity)?,
            joints,
            joint_of,
            loads: loads.collect::<Result<Vec<_>, SetupError>>()?,
            held: held.collect::<Result<Vec<_>, SetupError>>()?,
            measured: simulation.measured_points.iter().map(|point| point.block).collect(),
            control: ControlSetup {
                time_step: near("time_step", &control.time_step)?,
                dynamic: near("dynamic", &control.dynamic)?,
                damping: near("damping", &control.damping)?,
                kinematics: control.kinematics,
                unconverged: control.unconverged,
                solver: control.solver,
            },
            limits: StepLimits {
                equal: near("equal", &set.equal)?,
                open: near("open", &set.open)?,
                close: near("close", &set.close)?,
                displacement: near("max_displacement", &set.max_displacement)?,
                rotation: near("max_rotation", &set.max_rotation)?,
            },
            tolerances: Tolerances::new(set)?,
        })
    }

    /// The state in which the scene begins.
    pub(super) fn begin(&self, scene: &Scene) -> Result<State<R>, SetupError> {
        let simulation = &scene.simulation;
        let settling = simulation.control.settle;
        let block = |(block, body): (&Block, &BodySetup<R>)| {
            let vertices = block.vertices().iter().map(|v| near_vector("vertices", v)).collect::<Result<_, _>>()?;
            let velocity = if settling > 0 { [R::ZERO; 12] } else { body.velocity };
            Ok(BlockState { vertices, velocity, stress: body.stress })
        };
        let points = |points: Vec<&Vec3<Number>>| {
            points.into_iter().map(|at| near_vector("at", at)).collect::<Result<Vec<_>, SetupError>>()
        };
        Ok(State {
            step: 0,
            time: R::ZERO,
            settling,
            last_time_step: self.control.time_step,
            blocks: self.blocks.iter().zip(&self.bodies).map(block).collect::<Result<_, SetupError>>()?,
            load_points: points(simulation.loads.iter().map(|p| &p.at).collect())?,
            fixed_points: points(simulation.fixed_points.iter().map(|p| &p.at).collect())?,
            measured_points: points(simulation.measured_points.iter().map(|p| &p.at).collect())?,
            contacts: Vec::new(),
        })
    }

    /// Whether a contact is of two blocks, the lower number first, and of features that they have.
    pub(super) fn has(&self, contact: &ContactState<R>) -> bool {
        let [a, b] = contact.blocks.map(|block| self.blocks.get(block as usize).map(Block::topology));
        let (Some(a), Some(b)) = (a, b) else { return false };
        let [i, j] = contact.blocks;
        let [of_a, of_b] = contact.contact.key.features();
        i < j && of_a.is_in(a) && of_b.is_in(b)
    }

    /// The joint between the surfaces of two blocks.
    pub(super) fn joint(&self, a: usize, b: usize) -> &Joint<R> {
        &self.joints[self.joint_of[self.bodies[a].joint][self.bodies[b].joint]]
    }
}

/// Joints, and for two joint materials the place of theirs.
type JointTable<R> = (Vec<Joint<R>>, Vec<Vec<usize>>);

/// All joints, and the place of each pair of joint materials among them.
fn joint_table<R: Real>(simulation: &Simulation) -> Result<JointTable<R>, SetupError> {
    let all: Vec<_> = simulation.joints.all().collect();
    let count = simulation.joints.names.len();
    let place = |i: usize, j: usize| {
        let properties = simulation.joints.between(i, j);
        all.iter().position(|candidate| std::ptr::eq(*candidate, properties)).unwrap_or(all.len() - 1)
    };
    let table = (0..count).map(|i| (0..count).map(|j| place(i, j)).collect()).collect();
    Ok((all.into_iter().map(Joint::new).collect::<Result<_, _>>()?, table))
}
