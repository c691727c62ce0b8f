//! Scenes of a few blocks for the exact step.

use super::shapes::{number, point, revised};
use rockproof_model::simulation::{Body, Control, Kinematics, Motion, Simulation};
use rockproof_model::{Block, ToleranceSet};
use rockproof_oracle::step::{KeptPrecision, State, StepAnswer, StepModel, exact_step};

/// Blocks, how they move, and the tolerances.
#[derive(Clone)]
pub(crate) struct Scene {
    pub(crate) blocks: Vec<Block>,
    pub(crate) bodies: Vec<Body>,
    pub(crate) simulation: Simulation,
    pub(crate) tolerances: ToleranceSet,
}

impl Scene {
    /// Blocks with their motions; density 2000, E = 10¹⁰, ν = 1/4, p_n = 10⁹, p_s = p_n/2, Δt = 1/100, `linear`.
    pub(crate) fn new(blocks: Vec<(Block, Motion)>, friction: &str, gravity: [&str; 3]) -> Scene {
        let bodies = blocks.iter().map(|(_, motion)| Body { motion: *motion, ..Body::default() }).collect();
        let mut simulation = Simulation { gravity: point(gravity), ..Simulation::default() };
        simulation.materials[0].density = number("2000");
        simulation.control = Control { kinematics: Kinematics::Linear, ..Control::default() };
        let joint = &mut simulation.joints.other;
        joint.normal_stiffness = Some(number("1000000000"));
        joint.shear_ratio = number("1/2");
        joint.friction = number(friction);
        let tolerances = revised(&[("max_displacement", "1/10"), ("max_rotation", "1/10")]);
        Scene { blocks: blocks.into_iter().map(|(b, _)| b).collect(), bodies, simulation, tolerances }
    }

    /// One step.
    pub(crate) fn step(&self, state: &State, keep: KeptPrecision) -> StepAnswer {
        let shapes: Vec<&Block> = self.blocks.iter().collect();
        exact_step(&self.model(&shapes), state, keep).unwrap()
    }

    /// The state the scene begins with.
    pub(crate) fn start(&self) -> State {
        let shapes: Vec<&Block> = self.blocks.iter().collect();
        State::initial(&self.model(&shapes))
    }

    /// What the step is told.
    pub(crate) fn model<'a>(&'a self, shapes: &'a [&'a Block]) -> StepModel<'a> {
        StepModel { shapes, bodies: &self.bodies, simulation: &self.simulation, tolerances: &self.tolerances }
    }
}
