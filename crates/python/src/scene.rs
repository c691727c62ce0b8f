//! Scenes in motion, step by step.

use crate::arguments::{Arithmetic, input_error};
use crate::model::Model;
use crate::number::{fractions, near};
use crate::tolerances::{Tolerances, set_for, spec_of};
use num_rational::BigRational;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rockproof_differential::lockstep::Trajectory;
use rockproof_differential::lockstep::trajectory::default_grid;
use rockproof_model::scene::SceneFormat;
use rockproof_model::simulation::step_in_words;
use rockproof_model::{Contact, LoadOptions, Number, Point, Precision, Scene, ToleranceSet, ToleranceSpec, Vec3};
use rockproof_oracle::step::{Mode as ExactMode, RetryReason as ExactReason, StepAnswer};
use rockproof_stepper::dynamics::{Dynamics, RetryReason, Solve, StepReport};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Blocks in motion: what `simulate` runs, step by step.
///
/// `source` is the path of a scene (.toml), a text of one (`Scene(text=…)`), or a Model. `tolerances` are those of the scene, or "auto".
///
/// Each arithmetic has a state of its own, which begins where the scene does: `step("f64")` and `step("exact")` in turn follow two runs side by side.
#[pyclass(frozen, name = "Scene", module = "rockproof")]
pub(crate) struct PyScene {
    scene: Scene,
    spec: ToleranceSpec,
    place: String,
    runs: Mutex<Runs>,
}

/// The states begun.
#[derive(Default)]
struct Runs {
    f32: Option<Dynamics<f32>>,
    f64: Option<Dynamics<f64>>,
    exact: Option<Trajectory>,
}

/// A contact after a step.
#[pyclass(frozen, module = "rockproof", get_all)]
#[derive(Clone)]
pub(crate) struct StepContact {
    /// The numbers of its blocks, the lower one first: A and B of the contact.
    blocks: (usize, usize),
    /// "v-v", "v-e", "e-v", "v-f", "f-v" or "e-e".
    kind: &'static str,
    /// A's feature.
    feature_a: u32,
    /// B's feature.
    feature_b: u32,
    /// "open", "sliding" or "locked": the mode with which it goes on.
    mode: &'static str,
    /// The gap in metres after the last solve, to first order; negative overlaps.
    gap_m: f64,
}

#[pymethods]
impl StepContact {
    fn __repr__(&self) -> String {
        let (i, j) = self.blocks;
        let StepContact { kind, feature_a, feature_b, mode, gap_m, .. } = self;
        format!("<StepContact {kind} {feature_a},{feature_b} of blocks {i},{j}: {mode}, {gap_m:?} m>")
    }
}

/// A step that was made.
#[pyclass(frozen, module = "rockproof")]
pub(crate) struct Step {
    number: i64,
    time: f64,
    time_step: f64,
    iterations: u32,
    converged: bool,
    retries: Vec<String>,
    contacts: Vec<StepContact>,
    vertices: Vec<Vec<Point>>,
}

#[pymethods]
impl Step {
    /// Its number from 1; steps of settling have the numbers before.
    #[getter]
    fn number(&self) -> i64 {
        self.number
    }

    /// The time after it, in s.
    #[getter]
    fn time(&self) -> f64 {
        self.time
    }

    /// The time step that was accepted, in s.
    #[getter]
    fn time_step(&self) -> f64 {
        self.time_step
    }

    /// Solves of the accepted attempt.
    #[getter]
    fn iterations(&self) -> u32 {
        self.iterations
    }

    /// Whether the open–close iteration converged.
    #[getter]
    fn converged(&self) -> bool {
        self.converged
    }

    /// Why attempts before were given up, in order: "not-converged", "displacement", "rotation".
    #[getter]
    fn retries(&self) -> Vec<String> {
        self.retries.clone()
    }

    /// The contacts, by pair of blocks.
    #[getter]
    fn contacts(&self) -> Vec<StepContact> {
        self.contacts.clone()
    }

    /// Where the vertices of each block are, in metres, to the nearest float.
    #[getter]
    fn positions(&self) -> Vec<Vec<(f64, f64, f64)>> {
        self.vertices.iter().map(|block| block.iter().map(near).collect()).collect()
    }

    /// The same exactly: triples of Fraction.
    #[getter]
    fn exact_positions(&self) -> Vec<Vec<(BigRational, BigRational, BigRational)>> {
        self.vertices.iter().map(|block| block.iter().map(fractions).collect()).collect()
    }

    fn __repr__(&self) -> String {
        format!("<Step {}: {:?} s, {} contacts>", self.number, self.time, self.contacts.len())
    }
}

#[pymethods]
impl PyScene {
    #[new]
    #[pyo3(signature = (source=None, *, text=None, tolerances=None))]
    fn new(
        py: Python<'_>,
        source: Option<&Bound<'_, PyAny>>,
        text: Option<&str>,
        tolerances: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<PyScene> {
        let (scene, place) = match (source, text) {
            (None, Some(text)) => {
                let name = Path::new("scene.toml");
                (Scene::parse(text, SceneFormat::Toml, name).map_err(input_error)?, String::new())
            }
            (Some(source), None) => match source.cast::<Model>() {
                Ok(model) => (model.get().scene.clone(), model.get().place()),
                Err(_) => {
                    let path: PathBuf = source.extract()?;
                    let scene = py.detach(|| Scene::load(&path)).map_err(input_error)?;
                    (scene, format!("{}: ", path.display()))
                }
            },
            _ => return Err(input_error("a scene is a path, a Model, or text=…: one of them")),
        };
        let spec = spec_of(tolerances, scene.tolerances.as_ref())?;
        Ok(PyScene { scene, spec, place, runs: Mutex::default() })
    }

    /// The blocks at the beginning.
    #[getter]
    fn model(&self) -> Model {
        Model { scene: self.scene.clone(), path: None, options: LoadOptions::default() }
    }

    /// The tolerances, complete, for an arithmetic ("f64", "f32" or "exact").
    #[pyo3(signature = (arithmetic="f64"))]
    fn tolerances(&self, arithmetic: &str) -> PyResult<Tolerances> {
        Ok(Tolerances(self.set(Arithmetic::named(arithmetic, "arithmetic")?)?.into()))
    }

    /// Makes the next step in an arithmetic: "f64" or "f32" (the float code), or "exact" (the oracle; coordinates are kept to 2^-256 of the model's size).
    ///
    /// Raises InputError where the scene cannot begin (a joint without stiffness, a block that rounding destroys), RuntimeError where the step cannot be
    /// made; the state is then as before.
    #[pyo3(signature = (arithmetic="f64"))]
    fn step(&self, py: Python<'_>, arithmetic: &str) -> PyResult<Step> {
        let arithmetic = Arithmetic::named(arithmetic, "arithmetic")?;
        py.detach(|| {
            let mut runs = self.runs.lock().unwrap_or_else(PoisonError::into_inner);
            match arithmetic {
                Arithmetic::Float(Precision::F64) => self.float_step(&mut runs.f64, arithmetic),
                Arithmetic::Float(Precision::F32) => self.float_step(&mut runs.f32, arithmetic),
                Arithmetic::Exact => self.exact_step(&mut runs.exact),
            }
        })
    }

    /// Forgets all steps: every arithmetic begins anew.
    fn reset(&self) {
        *self.runs.lock().unwrap_or_else(PoisonError::into_inner) = Runs::default();
    }

    fn __repr__(&self) -> String {
        format!("<Scene: {}{} blocks>", self.place, self.scene.blocks.len())
    }
}

impl PyScene {
    fn set(&self, arithmetic: Arithmetic) -> PyResult<ToleranceSet> {
        set_for(&self.spec, &self.scene.shapes(), arithmetic.precision())
    }

    /// The scene with every stiffness derived, and its tolerances.
    fn ready(&self, arithmetic: Arithmetic) -> PyResult<(Scene, ToleranceSet)> {
        let set = self.set(arithmetic)?;
        let mut scene = self.scene.clone();
        scene.derive_stiffness(&set);
        Ok((scene, set))
    }

    fn float_step<R: Solve>(&self, run: &mut Option<Dynamics<R>>, arithmetic: Arithmetic) -> PyResult<Step> {
        if run.is_none() {
            let (scene, set) = self.ready(arithmetic)?;
            *run = Some(Dynamics::new(&scene, &set).map_err(|error| input_error(format!("{}{error}", self.place)))?);
        }
        let dynamics = run.as_mut().ok_or_else(|| PyRuntimeError::new_err("the scene did not begin"))?;
        let report = dynamics.step().map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
        of_floats(dynamics, &report)
    }

    fn exact_step(&self, run: &mut Option<Trajectory>) -> PyResult<Step> {
        if run.is_none() {
            let (scene, set) = self.ready(Arithmetic::Exact)?;
            *run = Some(Trajectory::new(&scene, &set, default_grid(&scene)));
        }
        let trajectory = run.as_mut().ok_or_else(|| PyRuntimeError::new_err("the scene did not begin"))?;
        let number = trajectory.next_number();
        let answer = trajectory
            .step()
            .map_err(|error| PyRuntimeError::new_err(format!("{}: {error}", step_in_words(number))))?;
        Ok(of_oracle(number, &answer))
    }
}

fn contact(blocks: [usize; 2], contact: &Contact, mode: &'static str, gap_m: f64) -> StepContact {
    let [i, j] = blocks;
    let [feature_a, feature_b] = contact.key.numbers();
    StepContact { blocks: (i, j), kind: contact.kind().name(), feature_a, feature_b, mode, gap_m }
}

fn of_floats<R: Solve>(dynamics: &Dynamics<R>, report: &StepReport) -> PyResult<Step> {
    let state = dynamics.state();
    let number = |value: R| Number::from_f64(value.to_f64()).map_err(input_error);
    let point = |at: rockproof_stepper::Vector<R>| {
        let [x, y, z] = at.components();
        Ok(Vec3::new(number(x)?, number(y)?, number(z)?))
    };
    let vertices = state.blocks.iter().map(|block| block.vertices.iter().map(|at| point(*at)).collect());
    let contacts = state
        .contacts
        .iter()
        .map(|now| contact(now.blocks.map(|block| block as usize), &now.contact, now.mode.name(), now.gap.to_f64()));
    Ok(Step {
        number: report.step,
        time: report.time,
        time_step: report.time_step,
        iterations: report.iterations,
        converged: report.converged,
        retries: report.retries.iter().map(|retry| retry.why.name().to_owned()).collect(),
        contacts: contacts.collect(),
        vertices: vertices.collect::<PyResult<_>>()?,
    })
}

fn of_oracle(number: i64, answer: &StepAnswer) -> Step {
    let mode = |mode| match mode {
        ExactMode::Open => "open",
        ExactMode::Sliding => "sliding",
        ExactMode::Locked => "locked",
    };
    let retry = |reason| match reason {
        ExactReason::NotConverged => RetryReason::NotConverged.name(),
        ExactReason::Displacement => RetryReason::Displacement.name(),
        ExactReason::Rotation => RetryReason::Rotation.name(),
    };
    let contacts = answer.state.contacts.iter().zip(&answer.gaps);
    let contacts =
        contacts.map(|(now, gap)| contact(now.blocks, &now.contact, mode(now.mode), gap.after.approximate()));
    Step {
        number,
        time: answer.state.time.approximate(),
        time_step: Number::from_rational(answer.time_step.clone()).approximate(),
        iterations: answer.iterations,
        converged: answer.converged,
        retries: answer.retries.iter().map(|attempt| retry(attempt.reason).to_owned()).collect(),
        contacts: contacts.collect(),
        vertices: answer.state.blocks.iter().map(|block| block.vertices.clone()).collect(),
    }
}
