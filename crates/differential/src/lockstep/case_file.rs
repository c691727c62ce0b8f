//! A state file: one step that stepper and oracle did not make alike, to be made again.

use crate::lockstep::answer::{StepDecisions, described};
use crate::lockstep::intrusion::{PairIntrusion, WatchedStep};
use crate::lockstep::run::ComparedStep;
use crate::lockstep::state::exact_state;
use rockproof_model::decision::{Feature, Side};
use rockproof_model::files::read_text;
use rockproof_model::scene::SceneFormat;
use rockproof_model::text::{EXCERPT_LENGTH, excerpt};
use rockproof_model::{Block, Contact, Precision, Scene, ToleranceSet, Topology};
use rockproof_simulate::checkpoint::SavedState;
use rockproof_stepper::Real;
use rockproof_stepper::dynamics::ContactState;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// More steps than a run can make; what is counted in f64 somewhere stays exact below it.
const MAX_STEPS: u64 = 1 << 53;

/// What a state file holds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StepCase {
    /// [`StepCase::FORMAT`].
    pub format: String,
    /// The version that wrote it.
    pub version: String,
    /// `f32` or `f64`.
    pub engine: String,
    /// The step's number.
    pub step: i64,
    /// What differed: cause, change, and what about.
    pub differences: Vec<String>,
    /// The scene as it was run, in TOML: exact, stiffnesses derived, every tolerance given.
    pub scene: String,
    /// The state before the step.
    pub state: SavedState,
    /// What the oracle answers from the engine's numbers.
    pub expected: Expected,
}

/// The oracle's answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Expected {
    /// Blocks, then kind, features, entrance and sign of each contact.
    pub contacts: Vec<String>,
    /// The modes of all contacts after each solve.
    pub modes: Vec<Vec<String>>,
    /// Why attempts were given up.
    pub retries: Vec<String>,
    /// Whether the iteration converged.
    pub converged: bool,
    /// Passages within the step and unseen overlaps after it, in a case that is about one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub intrusions: Option<Vec<String>>,
}

impl Expected {
    /// An answer in words.
    pub fn of(answer: &StepDecisions) -> Expected {
        let contact = |(pair, contact): &([u32; 2], _)| format!("{}-{} {}", pair[0], pair[1], described(contact));
        Expected {
            contacts: answer.contacts.iter().map(contact).collect(),
            modes: answer.modes.iter().map(|all| all.iter().map(|mode| mode.name().to_owned()).collect()).collect(),
            retries: answer.retries.iter().map(|why| why.name().to_owned()).collect(),
            converged: answer.converged,
            intrusions: None,
        }
    }

    /// What is to be recorded of a step: an answer, and of a step that was looked through what was found there.
    pub fn of_step(step: &ComparedStep) -> Option<Expected> {
        let words = |one: &PairIntrusion| format!("{}-{} {}", one.blocks[0], one.blocks[1], one.kind.name());
        let all = |watched: &WatchedStep| watched.oracle.found.iter().map(words).collect();
        let intrusions = step.watched.as_ref().map(all);
        Some(Expected { intrusions, ..Expected::of(step.oracle.as_ref()?) })
    }
}

/// Why a state file cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum StepCaseError {
    /// It cannot be read.
    #[error(transparent)]
    Io(#[from] std::io::Error),
    /// It is no state file.
    #[error("no state file: {0}")]
    Json(#[from] serde_json::Error),
    /// It has another format.
    #[error("the format is `{0}`, not `{expected}`", expected = StepCase::FORMAT)]
    Format(String),
    /// The engine has no name that is known.
    #[error("`{0}` is no engine; f32 and f64 are")]
    Engine(String),
    /// Its state is none.
    #[error("its state: {0}")]
    State(String),
    /// Its scene cannot be read.
    #[error("its scene: {0}")]
    Scene(Box<dyn std::error::Error + Send + Sync>),
}

impl StepCase {
    /// The name of the format.
    pub const FORMAT: &'static str = "rockproof-step-1";

    /// Whether a file may be a state file, by its name.
    pub fn is_named(path: &Path) -> bool {
        path.extension().is_some_and(|extension| extension == "json")
    }

    /// The file's name for a step.
    pub fn name_of(step: i64) -> String {
        format!("step_{}{:06}.json", if step < 0 { "-" } else { "" }, step.unsigned_abs())
    }

    /// Reads a state file.
    ///
    /// # Errors
    /// When it is none.
    pub fn load(path: &Path) -> Result<StepCase, StepCaseError> {
        StepCase::parse(&read_text(path)?)
    }

    /// Reads the text of a state file.
    ///
    /// # Errors
    /// When it is none.
    pub fn parse(text: &str) -> Result<StepCase, StepCaseError> {
        let case: StepCase = serde_json::from_str(text)?;
        if case.format != StepCase::FORMAT {
            return Err(StepCaseError::Format(excerpt(&case.format, EXCERPT_LENGTH)));
        }
        let precision = case.precision()?;
        let (scene, _) = case.scene()?;
        match precision {
            Precision::F32 => case.check::<f32>(&scene)?,
            Precision::F64 => case.check::<f64>(&scene)?,
        }
        Ok(case)
    }

    /// Refuses a state that no run is in: numbers that are not finite, a time before the beginning, a Δt that is none, another step than
    /// the next, contacts that the scene cannot have.
    fn check<R: Real>(&self, scene: &Scene) -> Result<(), StepCaseError> {
        let state = self.state.state::<R>().map_err(|error| StepCaseError::State(error.to_string()))?;
        exact_state(&state).map_err(|error| StepCaseError::State(error.to_string()))?;
        let refuse = |what: &str, allowed: &str| {
            Err(StepCaseError::State(format!("`{what}` is not allowed; allowed is {allowed}")))
        };
        if self.state.time.0 < 0.0 {
            return refuse(&format!("time = {:?}", self.state.time.0), "0 or more");
        }
        if self.state.last_time_step.0 <= 0.0 {
            return refuse(&format!("last_time_step = {:?}", self.state.last_time_step.0), "more than 0");
        }
        if self.state.step > MAX_STEPS {
            return refuse(&format!("step = {}", self.state.step), "up to 2^53");
        }
        let next = match self.state.settling {
            0 => self.state.step as i64 + 1,
            settling => 1 - i64::from(settling),
        };
        if self.step != next {
            return refuse(&format!("step = {}", self.step), &format!("{next}, the step after the state's"));
        }
        check_contacts(&scene.shapes(), &state.contacts).map_err(StepCaseError::State)
    }

    /// The text of the file.
    ///
    /// # Errors
    /// None that writing to memory has.
    pub fn text(&self) -> Result<Vec<u8>, serde_json::Error> {
        let mut text = serde_json::to_vec_pretty(self)?;
        text.push(b'\n');
        Ok(text)
    }

    /// The engine's precision.
    ///
    /// # Errors
    /// When the engine is none of the two.
    pub fn precision(&self) -> Result<Precision, StepCaseError> {
        match self.engine.as_str() {
            "f32" => Ok(Precision::F32),
            "f64" => Ok(Precision::F64),
            other => Err(StepCaseError::Engine(excerpt(other, EXCERPT_LENGTH))),
        }
    }

    /// Its scene, with the tolerances it was run with.
    ///
    /// # Errors
    /// When the text is no scene.
    pub fn scene(&self) -> Result<(Scene, ToleranceSet), StepCaseError> {
        // It holds its blocks itself, so that it opens no other file.
        let table: toml::Table = toml::from_str(&self.scene).map_err(|e| StepCaseError::Scene(e.into()))?;
        let blocks = table.get("block").and_then(toml::Value::as_array);
        if blocks.into_iter().flatten().any(|block| block.get("file").is_some()) {
            return Err(StepCaseError::Scene(
                "a block names a `file`; allowed are `vertices` and `faces`, or `box`".into(),
            ));
        }
        let scene = Scene::parse(&self.scene, SceneFormat::Toml, Path::new("state file"))
            .map_err(|e| StepCaseError::Scene(e.into()))?;
        let set = scene
            .tolerances
            .clone()
            .unwrap_or_default()
            .derive(&scene.shapes(), self.precision()?)
            .map_err(|e| StepCaseError::Scene(e.into()))?;
        Ok((scene, set))
    }
}

/// Refuses contacts of blocks and features that there are not, and contacts of which two have the same name.
fn check_contacts<R>(blocks: &[&Block], contacts: &[ContactState<R>]) -> Result<(), String> {
    let mut places = BTreeMap::new();
    for (place, state) in contacts.iter().enumerate() {
        let ([a, b], Contact { key, entrance, .. }) = (state.blocks, state.contact);
        let pair = [a, b].map(|block| blocks.get(block as usize));
        let [Some(block_a), Some(block_b)] = pair else {
            let last = blocks.len().saturating_sub(1);
            return Err(format!("contact {place} is of blocks {a} and {b}; allowed are 0 to {last}"));
        };
        if a >= b {
            return Err(format!("contact {place} is of blocks {a} and {b}; allowed is the lower number first"));
        }
        let topologies = [block_a.topology(), block_b.topology()];
        let has = |feature: &Feature| feature.is_in(topologies[usize::from(feature.side() == Side::B)]);
        if !key.features().iter().chain(&entrance.features()).all(has) {
            return Err(format!(
                "contact {place} of blocks {a} and {b} is {key} by {entrance}; allowed are {}",
                topologies.map(features_of).join(" and ")
            ));
        }
        if let Some(first) = places.insert(([a, b], key), place) {
            return Err(format!(
                "contact {place} of blocks {a} and {b} is {key}, as contact {first} is; allowed is each contact once"
            ));
        }
    }
    Ok(())
}

/// The features of a block, for messages.
fn features_of(topology: &Topology) -> String {
    let (vertices, edges, faces) = (topology.vertex_count(), topology.edges().len(), topology.faces().len());
    format!("vertices 0 to {}, edges 0 to {}, faces 0 to {}", vertices - 1, edges - 1, faces - 1)
}
