//! A scene as the oracle steps it: as it is, or with every number as an engine has it.

use crate::lockstep::run::KEPT_EXPONENT;
use num_bigint::BigInt;
use num_rational::BigRational;
use rockproof_model::simulation::{JointProperties, Simulation};
use rockproof_model::{Block, Body, Contact, Number, Precision, Scene, ToleranceSet, Vec3};
use rockproof_oracle::PreparedBlock;
use rockproof_oracle::step::{
    self, CertifiedStep, DecidedAttempt, EnclosedStep, KeptPrecision, ModeMargin, StepAnswer, StepFailure, StepModel,
};

/// A number that an engine's precision cannot hold, by its name in files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` overflows in the engine's precision")]
pub struct NumberOverflow(pub &'static str);

/// Contacts with their blocks, by pair and in SPEC order.
pub(super) type BlockContacts = Vec<([usize; 2], Contact)>;

/// Everything of a scene that does not change from step to step, owned.
#[derive(Clone, Debug)]
pub struct ExactScene {
    scene: Scene,
    bodies: Vec<Body>,
    tolerances: ToleranceSet,
}

impl ExactScene {
    /// The scene as it is. Its joints have stiffnesses ([`rockproof_model::simulation::derive_stiffness`]).
    pub fn new(scene: &Scene, set: &ToleranceSet) -> ExactScene {
        let bodies = scene.blocks.iter().map(|block| block.body.clone()).collect();
        ExactScene { scene: scene.clone(), bodies, tolerances: set.clone() }
    }

    /// The scene as an engine of a precision has it: every number rounded to nearest. Of a joint, p_n and p_s are what is
    /// rounded; the ratio becomes their quotient.
    ///
    /// # Errors
    /// The name of a number that overflows.
    pub fn rounded(&self, precision: Precision) -> Result<ExactScene, NumberOverflow> {
        let round = Rounder(precision);
        let mut scene = self.scene.clone();
        for block in &mut scene.blocks {
            block.block = block.block.rounded(precision).ok_or(NumberOverflow("vertices"))?;
            round.vector("velocity", &mut block.body.velocity)?;
            round.vector("spin", &mut block.body.spin)?;
            block.body.stress.iter_mut().try_for_each(|stress| round.number("stress", stress))?;
        }
        round.simulation(&mut scene.simulation)?;
        Ok(ExactScene::new(&scene, &self.tolerances.rounded(precision).map_err(NumberOverflow)?))
    }

    /// The same scene with other tolerances.
    #[must_use]
    pub fn with_tolerances(&self, set: ToleranceSet) -> ExactScene {
        ExactScene { tolerances: set, ..self.clone() }
    }

    /// The same scene with another full Δt (s).
    #[must_use]
    pub fn with_time_step(&self, time_step: Number) -> ExactScene {
        let mut scene = self.clone();
        scene.scene.simulation.control.time_step = time_step;
        scene
    }

    /// Whether another version of the same scene has the same numbers.
    pub fn same_numbers(&self, other: &ExactScene) -> bool {
        let blocks = self.scene.blocks.iter().zip(&other.scene.blocks);
        self.tolerances == other.tolerances
            && self.bodies == other.bodies
            && self.scene.simulation == other.scene.simulation
            && blocks.into_iter().all(|(one, two)| one.block.vertices() == two.block.vertices())
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The tolerances.
    pub fn tolerances(&self) -> &ToleranceSet {
        &self.tolerances
    }

    /// The state in which the scene begins.
    pub fn begin(&self) -> step::State {
        self.with_model(step::State::initial)
    }

    /// One step.
    ///
    /// # Errors
    /// Why the oracle cannot make it.
    pub fn step(&self, state: &step::State, keep: KeptPrecision) -> Result<StepAnswer, StepFailure> {
        self.with_model(|model| step::exact_step(model, state, keep))
    }

    /// What one step decides, without the state after it.
    ///
    /// # Errors
    /// Why the oracle cannot make it.
    pub fn decide(&self, state: &step::State) -> Result<CertifiedStep, StepFailure> {
        self.with_model(|model| step::certified_step(model, state))
    }

    /// As [`ExactScene::step`], with the contacts that it would find.
    ///
    /// # Errors
    /// Why the oracle cannot make it.
    pub(super) fn step_with(
        &self,
        state: &step::State,
        keep: KeptPrecision,
        contacts: BlockContacts,
    ) -> Result<StepAnswer, StepFailure> {
        self.with_model(|model| step::exact_step_with(model, state, keep, contacts))
    }

    /// As [`ExactScene::decide`], with the contacts that it would find.
    ///
    /// # Errors
    /// Why the oracle cannot make it.
    pub(super) fn decide_with(
        &self,
        state: &step::State,
        contacts: BlockContacts,
    ) -> Result<CertifiedStep, StepFailure> {
        self.with_model(|model| step::certified_step_with(model, state, contacts))
    }

    /// The pairs of blocks that a step classifies.
    pub(super) fn neighbours(&self, prepared: &[PreparedBlock]) -> Vec<[usize; 2]> {
        self.with_model(|model| step::neighbours(model, prepared))
    }

    /// What one step decides, and how it moves the blocks.
    ///
    /// # Errors
    /// Why the oracle cannot make it.
    pub fn enclose(&self, state: &step::State) -> Result<EnclosedStep, StepFailure> {
        self.with_model(|model| step::enclosed_step(model, state))
    }

    /// How close the modes of a step that is decided were, solve by solve and contact by contact; empty where that is not known.
    pub fn mode_margins(&self, state: &step::State, decided: DecidedAttempt<'_>) -> Vec<Vec<ModeMargin>> {
        self.with_model(|model| step::mode_margins(model, state, decided)).unwrap_or_default()
    }

    /// The blocks where a state has them.
    pub fn blocks_at(&self, state: &step::State) -> Vec<Block> {
        (0..self.scene.blocks.len()).map(|block| self.block_at(state, block)).collect()
    }

    /// A block, by its number, where a state has it.
    pub fn block_at(&self, state: &step::State, block: usize) -> Block {
        self.scene.blocks[block].block.with_vertices(state.blocks[block].vertices.clone())
    }

    /// A state after a step as the oracle keeps it (`KEPT_PRECISION`): vertices of blocks that may move rounded to the grid, a half away from zero. What both
    /// sides make exactly is then the same on both, blocks that touch among it.
    pub fn kept(&self, mut state: step::State) -> step::State {
        let scale = BigInt::from(1) << KEPT_EXPONENT;
        let kept = |value: &Number| {
            let units = (value.to_rational() * &scale).round().to_integer();
            Number::from_rational(BigRational::new(units, scale.clone()))
        };
        let moving = state.blocks.iter_mut().zip(&self.bodies).filter(|(_, body)| !body.is_fixed());
        for vertex in moving.flat_map(|(block, _)| &mut block.vertices) {
            *vertex = vertex.map(kept);
        }
        state
    }

    fn with_model<T>(&self, ask: impl FnOnce(&StepModel<'_>) -> T) -> T {
        let shapes = self.scene.shapes();
        let (bodies, simulation, tolerances) = (&self.bodies, &self.scene.simulation, &self.tolerances);
        ask(&StepModel { shapes: &shapes, bodies, simulation, tolerances })
    }
}

/// Rounds numbers in place.
#[derive(Clone, Copy)]
struct Rounder(Precision);

impl Rounder {
    fn number(self, name: &'static str, number: &mut Number) -> Result<(), NumberOverflow> {
        let near = number.rounded(self.0).ok_or(NumberOverflow(name))?;
        *number = Number::from_f64(near).map_err(|_| NumberOverflow(name))?;
        Ok(())
    }

    fn vector(self, name: &'static str, v: &mut Vec3<Number>) -> Result<(), NumberOverflow> {
        [&mut v.x, &mut v.y, &mut v.z].into_iter().try_for_each(|c| self.number(name, c))
    }

    fn joint(self, joint: &mut JointProperties) -> Result<(), NumberOverflow> {
        self.number("friction", &mut joint.friction)?;
        self.number("cohesion", &mut joint.cohesion)?;
        self.number("tension", &mut joint.tension)?;
        let Some(normal) = &mut joint.normal_stiffness else {
            return self.number("shear_ratio", &mut joint.shear_ratio);
        };
        let mut shear = normal.times(&joint.shear_ratio);
        self.number("shear_stiffness", &mut shear)?;
        self.number("normal_stiffness", normal)?;
        if normal.is_zero() {
            return self.number("shear_ratio", &mut joint.shear_ratio);
        }
        joint.shear_ratio = Number::from_rational(shear.to_rational() / normal.to_rational());
        Ok(())
    }

    fn simulation(self, simulation: &mut Simulation) -> Result<(), NumberOverflow> {
        self.vector("gravity", &mut simulation.gravity)?;
        self.number("time_step", &mut simulation.control.time_step)?;
        self.number("dynamic", &mut simulation.control.dynamic)?;
        self.number("damping", &mut simulation.control.damping)?;
        for material in &mut simulation.materials {
            self.number("density", &mut material.density)?;
            self.number("young", &mut material.young)?;
            self.number("poisson", &mut material.poisson)?;
        }
        simulation.joints.all_mut().try_for_each(|joint| self.joint(joint))?;
        for load in &mut simulation.loads {
            self.vector("at", &mut load.at)?;
            for (time, force) in &mut load.table {
                self.number("load", time)?;
                self.vector("load", force)?;
            }
        }
        for fixed in &mut simulation.fixed_points {
            self.vector("at", &mut fixed.at)?;
            fixed.stiffness.as_mut().map_or(Ok(()), |k| self.number("stiffness", k))?;
        }
        for point in &mut simulation.measured_points {
            self.vector("at", &mut point.at)?;
        }
        Ok(())
    }
}
