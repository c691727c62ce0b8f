//! The 42 scenes of `tests/golden/golden_steps.json`, whose steps an independent implementation of SPEC section 5 worked out in 400 bits.

use super::shapes::exact;
use num_rational::BigRational;
use rockproof_model::scene::SceneFormat;
use rockproof_model::{Block, Body, ContactKind, EntranceKind, Precision, Scene, Simulation, ToleranceSet};
use rockproof_oracle::step::{Mode, RetryReason, StepModel};
use serde::Deserialize;
use std::path::Path;

/// A scene and the steps expected of it.
pub(crate) struct GoldenScene {
    pub(crate) name: String,
    pub(crate) steps: Vec<GoldenStep>,
    /// Why no step follows the last.
    pub(crate) stops: Option<String>,
    scene: Scene,
    bodies: Vec<Body>,
    tolerances: ToleranceSet,
}

/// What is expected of one step.
#[derive(Deserialize)]
pub(crate) struct GoldenStep {
    pub(crate) step: i64,
    pub(crate) settling: bool,
    pub(crate) time_step: String,
    pub(crate) solves: u32,
    pub(crate) retries: Vec<GoldenRetry>,
    pub(crate) converged: bool,
    pub(crate) contacts: Vec<GoldenContact>,
    pub(crate) blocks: Vec<Option<GoldenBlock>>,
}

/// An attempt given up.
#[derive(Deserialize)]
pub(crate) struct GoldenRetry {
    reason: String,
    time_step: String,
    pub(crate) solves: u32,
}

/// A contact in a step.
#[derive(Deserialize)]
pub(crate) struct GoldenContact {
    a: usize,
    b: usize,
    kind: String,
    feature_a: u32,
    feature_b: u32,
    entrance: String,
    entrance_a: u32,
    entrance_b: u32,
    pub(crate) gap_before: String,
    pub(crate) gap: String,
    mode: String,
    mode_after: String,
}

/// A moving block after a step.
#[derive(Deserialize)]
pub(crate) struct GoldenBlock {
    pub(crate) vertices: Vec<[String; 3]>,
    pub(crate) velocity: Vec<String>,
}

#[derive(Deserialize)]
struct RawScene {
    name: String,
    scene: String,
    steps: Vec<GoldenStep>,
    stops: Option<String>,
}

/// All scenes of the file, in its order.
pub(crate) fn scenes() -> Vec<GoldenScene> {
    let raw: Vec<RawScene> =
        serde_json::from_str(include_str!("../../../tests/golden/golden_steps.json")).expect("the golden file reads");
    raw.into_iter().map(scene).collect()
}

fn scene(raw: RawScene) -> GoldenScene {
    let mut scene = Scene::parse(&raw.scene, SceneFormat::Toml, Path::new(&raw.name)).expect("the scene reads");
    let spec = scene.tolerances.clone().expect("the scene has tolerances");
    let tolerances = spec.resolve(&scene.shapes(), Precision::F64).expect("the tolerances resolve");
    scene.derive_stiffness(&tolerances);
    let bodies = scene.blocks.iter().map(|block| block.body.clone()).collect();
    GoldenScene { name: raw.name, steps: raw.steps, stops: raw.stops, scene, bodies, tolerances }
}

impl GoldenScene {
    /// The blocks as they begin.
    pub(crate) fn shapes(&self) -> Vec<&Block> {
        self.scene.shapes()
    }

    /// How it is stepped.
    pub(crate) fn simulation(&self) -> &Simulation {
        &self.scene.simulation
    }

    /// What a step is told.
    pub(crate) fn model<'a>(&'a self, shapes: &'a [&'a Block]) -> StepModel<'a> {
        StepModel { shapes, bodies: &self.bodies, simulation: &self.scene.simulation, tolerances: &self.tolerances }
    }
}

impl GoldenRetry {
    /// Why, and the Δt.
    pub(crate) fn given_up(&self) -> (RetryReason, BigRational) {
        let reason = match self.reason.as_str() {
            "not-converged" => RetryReason::NotConverged,
            "displacement" => RetryReason::Displacement,
            "rotation" => RetryReason::Rotation,
            other => panic!("reason {other}"),
        };
        (reason, exact(&self.time_step))
    }
}

impl GoldenContact {
    /// Blocks, kind, features, and entrance with its features.
    pub(crate) fn features(&self) -> ([usize; 2], ContactKind, [u32; 2], EntranceKind, [u32; 2]) {
        let kind = ContactKind::from_name(&self.kind).expect("a kind");
        let entrance = EntranceKind::from_name(&self.entrance).expect("an entrance");
        let (features, planes) = ([self.feature_a, self.feature_b], [self.entrance_a, self.entrance_b]);
        ([self.a, self.b], kind, features, entrance, planes)
    }

    /// The mode in the last solve, and the one with which the contact goes on.
    pub(crate) fn modes(&self) -> [Mode; 2] {
        [&self.mode, &self.mode_after].map(|name| match name.as_str() {
            "open" => Mode::Open,
            "sliding" => Mode::Sliding,
            "locked" => Mode::Locked,
            other => panic!("mode {other}"),
        })
    }
}
