//! A scene on the bench: loaded, its tolerances and stiffnesses derived as `simulate` does, and stepped.

use crate::case::CasePrecision;
use rockproof_model::scene::SceneFormat;
use rockproof_model::simulation::Control;
use rockproof_model::{
    Block, BlockError, BlockOptions, Number, NumberError, Scene, SceneError, SpecError, ToleranceSpec, Vec3,
    tolerance_rules,
};
use rockproof_simulate::Plan;
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::dynamics::{ContactState, Dynamics, SetupError, StepError, StepReport, StepRules};
use std::path::Path;

/// Why a case gives no figure.
#[derive(Debug, thiserror::Error)]
pub enum CaseFailure {
    /// No scene of this name is known.
    #[error("no scene is called `{0}`")]
    UnknownScene(String),
    /// The scene cannot be read.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// Its tolerances cannot be derived.
    #[error(transparent)]
    Tolerances(#[from] SpecError),
    /// A number is not one.
    #[error(transparent)]
    Number(#[from] NumberError),
    /// A shape is no block.
    #[error(transparent)]
    Shape(#[from] BlockError),
    /// A rule of SPEC section 3 is violated.
    #[error("the scene violates a rule: {0}")]
    Violated(String),
    /// The precision cannot hold it.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// A step cannot be made.
    #[error(transparent)]
    Stopped(#[from] StepError),
    /// It does not say how long to run.
    #[error("the scene does not say how long to run")]
    Endless,
    /// A case found something other than it measures.
    #[error("{0}")]
    Unexpected(String),
}

macro_rules! scenes {
    ($($name:literal),* $(,)?) => {
        /// The scenes of `cases/handmade` that cases run: name and text.
        pub const SCENES: &[(&str, &str)] =
            &[$(($name, include_str!(concat!("../../../cases/handmade/", $name, ".toml")))),*];
    };
}

scenes!(
    "arch_falls",
    "arch_stands",
    "compression",
    "compression_confined",
    "corner_impact",
    "corner_impact_deformable",
    "free_fall",
    "head_on_impact",
    "incline_0_settled",
    "incline_0_unsettled",
    "incline_1_2_settled",
    "incline_1_2_unsettled",
    "incline_1_4_settled",
    "incline_1_4_unsettled",
    "incline_4_5_settled",
    "incline_4_5_unsettled",
    "inclined_rests",
    "inclined_slides",
    "inclined_slides_and_topples",
    "inclined_topples",
    "patch_inclined_joint",
    "patch_joint",
    "ramp_load",
    "rest_on_floor",
    "rotation_cayley",
    "rotation_linear",
    "rotation_skew",
    "spring",
    "stack_of_10",
    "stress_release",
    "thrown_block",
    "wedge",
);

/// A scene of `cases/handmade`, by its name.
///
/// # Errors
/// When there is none, or it cannot be read.
pub fn scene(name: &str) -> Result<Scene, CaseFailure> {
    let text =
        SCENES.iter().find(|(known, _)| *known == name).ok_or_else(|| CaseFailure::UnknownScene(name.to_owned()))?;
    Ok(Scene::parse(text.1, SceneFormat::Toml, Path::new(name))?)
}

/// A number of a scene.
///
/// # Errors
/// When it is not finite.
pub fn number(value: f64) -> Result<Number, CaseFailure> {
    Ok(Number::from_f64(value)?)
}

/// A vector of a scene.
///
/// # Errors
/// When a component is not finite.
pub fn vector([x, y, z]: [f64; 3]) -> Result<Vec3<Number>, CaseFailure> {
    Ok(Vec3::new(number(x)?, number(y)?, number(z)?))
}

/// The tolerances of `auto` with εo and εc of 0: those of f32 are larger than the overlaps of a short step.
///
/// # Errors
/// Never; the names are known.
pub fn without_open_close_tolerance() -> Result<ToleranceSpec, CaseFailure> {
    let mut tolerances = ToleranceSpec::default();
    tolerances.set_text("open", "0")?;
    tolerances.set_text("close", "0")?;
    Ok(tolerances)
}

/// The cuboid of two corners (m).
///
/// # Errors
/// When it is no block.
pub fn cuboid(low: [f64; 3], high: [f64; 3]) -> Result<Block, CaseFailure> {
    Ok(Block::cuboid(&vector(low)?, &vector(high)?)?)
}

/// The block of these vertices (m) and faces.
///
/// # Errors
/// When it is no block.
pub fn polyhedron(points: impl IntoIterator<Item = [f64; 3]>, faces: Vec<Vec<u32>>) -> Result<Block, CaseFailure> {
    let points = points.into_iter().map(vector).collect::<Result<Vec<_>, _>>()?;
    Ok(Block::new(points, faces, &BlockOptions::default())?)
}

/// The faces of a prism on a base of four corners, which are 0 to 3 and 4 to 7 above them, against the clock seen from above.
pub fn hexahedron() -> Vec<Vec<u32>> {
    [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]].map(Vec::from).into()
}

/// A scene being stepped in the precision `R` by the rules `M`.
pub struct SteppedScene<R, M = SpecRules> {
    /// The scene, with its stiffnesses.
    pub scene: Scene,
    /// What is stepped.
    pub dynamics: Dynamics<R, M>,
    /// What the last step said of itself.
    pub last: Option<StepReport>,
    plan: Plan,
}

impl<R: CasePrecision, M: StepRules> SteppedScene<R, M> {
    /// A scene at its beginning.
    ///
    /// # Errors
    /// When it violates a rule or cannot be held in the precision.
    pub fn new(mut scene: Scene) -> Result<SteppedScene<R, M>, CaseFailure> {
        let default = ToleranceSpec::default();
        let set = scene.tolerances.as_ref().unwrap_or(&default).derive(&scene.shapes(), R::PRECISION)?;
        scene.derive_stiffness(&set);
        if let Some(violation) = tolerance_rules::check_scene(&set, &scene, R::PRECISION).first() {
            return Err(CaseFailure::Violated(violation.to_string()));
        }
        let control = &scene.simulation.control;
        let plan = Plan {
            steps: control.steps,
            time: control.duration.as_ref().map(Number::approximate),
            smallest_step: control.time_step.approximate() / f64::from(Control::SMALLEST),
            every: 1,
            contacts: false,
        };
        let dynamics = Dynamics::with_rules(&scene, &set)?;
        Ok(SteppedScene { scene, dynamics, last: None, plan })
    }

    /// A scene of `cases/handmade` at its beginning.
    ///
    /// # Errors
    /// As [`SteppedScene::new`] and [`scene`].
    pub fn open(name: &str) -> Result<SteppedScene<R, M>, CaseFailure> {
        SteppedScene::new(scene(name)?)
    }

    /// One step.
    ///
    /// # Errors
    /// When it cannot be made.
    pub fn step(&mut self) -> Result<&StepReport, CaseFailure> {
        let report = self.dynamics.step()?;
        Ok(self.last.insert(report))
    }

    /// Steps while something is left to settle.
    ///
    /// # Errors
    /// When a step cannot be made.
    pub fn settle(&mut self) -> Result<(), CaseFailure> {
        while self.dynamics.state().settling > 0 {
            self.step()?;
        }
        Ok(())
    }

    /// Steps as long as the scene says, calling `watch` after each step.
    ///
    /// # Errors
    /// When a step cannot be made, or the scene does not say how long.
    pub fn run_watched(&mut self, mut watch: impl FnMut(&Self)) -> Result<(), CaseFailure> {
        if self.plan.steps.is_none() && self.plan.time.is_none() {
            return Err(CaseFailure::Endless);
        }
        while !self.plan.is_over(self.dynamics.state()) {
            self.step()?;
            watch(self);
        }
        Ok(())
    }

    /// Steps as long as the scene says.
    ///
    /// # Errors
    /// As [`SteppedScene::run_watched`].
    pub fn run(&mut self) -> Result<(), CaseFailure> {
        self.run_watched(|_| ())
    }

    /// The time (s).
    pub fn time(&self) -> f64 {
        self.dynamics.state().time.to_f64()
    }

    /// Where the centroid of a block is (m).
    pub fn centroid(&self, block: usize) -> [f64; 3] {
        self.dynamics.centroid(block).components().map(R::to_f64)
    }

    /// The rates of a block's twelve unknowns.
    pub fn velocity(&self, block: usize) -> [f64; 12] {
        self.dynamics.state().blocks[block].velocity.map(R::to_f64)
    }

    /// The stress of a block (Pa).
    pub fn stress(&self, block: usize) -> [f64; 6] {
        self.dynamics.state().blocks[block].stress.map(R::to_f64)
    }

    /// Where a vertex of a block is (m).
    pub fn vertex(&self, block: usize, vertex: usize) -> [f64; 3] {
        self.dynamics.state().blocks[block].vertices[vertex].components().map(R::to_f64)
    }

    /// The mass of a block (kg): its density times its present volume.
    pub fn mass(&self, block: usize) -> f64 {
        let body = &self.scene.blocks[block].body;
        self.scene.simulation.materials[body.material].density.approximate() * self.dynamics.volume(block)
    }

    /// Momentum and what belongs to the other nine unknowns: `M v`.
    pub fn momenta(&self, block: usize) -> [f64; 12] {
        let (mass, rates) = (self.dynamics.mass(block), self.velocity(block));
        mass.map(|row| row.iter().zip(&rates).map(|(m, v)| m.to_f64() * v).sum())
    }

    /// Gravity (m/s²).
    pub fn gravity(&self) -> [f64; 3] {
        self.scene.simulation.gravity.components().map(Number::approximate)
    }

    /// The normal stiffness of a contact between two blocks (N/m), and its shear stiffness.
    pub fn stiffness(&self, one: usize, other: usize) -> [f64; 2] {
        let joint = |block: usize| self.scene.blocks[block].body.joint;
        let properties = self.scene.simulation.joints.between(joint(one), joint(other));
        let normal = properties.normal_stiffness.as_ref().map_or(f64::NAN, Number::approximate);
        [normal, normal * properties.shear_ratio.approximate()]
    }

    /// The contacts between two blocks after the last step; `one` has the lower number.
    pub fn contacts(&self, one: u32, other: u32) -> impl Iterator<Item = &ContactState<R>> {
        self.dynamics.state().contacts.iter().filter(move |contact| contact.blocks == [one, other])
    }

    /// The force that `other` exerts on `one` (N).
    pub fn force(&self, one: u32, other: u32) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for contact in self.contacts(one, other) {
            for (sum, force) in sum.iter_mut().zip(contact.force.components()) {
                *sum += force.to_f64();
            }
        }
        sum
    }
}

/// `|found − expected| / |expected|`.
pub fn relative(found: f64, expected: f64) -> f64 {
    ((found - expected) / expected).abs()
}

/// The largest of several errors; one that is no number is the largest.
pub fn worst(errors: impl IntoIterator<Item = f64>) -> f64 {
    errors
        .into_iter()
        .fold(0.0, |worst, error| if worst.is_nan() || error.is_nan() { f64::NAN } else { worst.max(error) })
}

/// The length of a vector.
pub fn length(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// `a − b`.
pub fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}
