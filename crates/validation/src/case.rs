//! A line of the table: what is known, what must hold, and how to measure it.

use crate::stepped_scene::CaseFailure;
use rockproof_model::Precision;
use rockproof_stepper::dynamics::{Solve, StepRules};

/// A precision in which the stepper runs a case.
pub trait CasePrecision: Solve {
    /// Its name in tables.
    const NAME: &'static str;
    /// Its precision, by which tolerances are derived.
    const PRECISION: Precision;
}

impl CasePrecision for f32 {
    const NAME: &'static str = "f32";
    const PRECISION: Precision = Precision::F32;
}

impl CasePrecision for f64 {
    const NAME: &'static str = "f64";
    const PRECISION: Precision = Precision::F64;
}

/// What a run showed.
#[derive(Clone, Debug, PartialEq)]
pub struct CaseMeasurement {
    /// How far it is from the closed form, in the unit that the case names; 0 is perfect.
    pub error: f64,
    /// What was seen, in words and figures.
    pub seen: String,
}

impl CaseMeasurement {
    /// An error, and what was seen.
    pub fn new(error: f64, seen: impl Into<String>) -> CaseMeasurement {
        CaseMeasurement { error, seen: seen.into() }
    }
}

/// Runs a case once.
type Run = Box<dyn Fn() -> Result<CaseMeasurement, CaseFailure> + Send + Sync>;

/// One case in both precisions.
pub struct ValidationCase {
    /// What it is called; one of its kind.
    pub name: String,
    /// The closed form.
    pub known: String,
    /// What `error` of [`CaseMeasurement`] is.
    pub error: &'static str,
    /// The largest error allowed in f64; `None` where the case only shows something.
    pub bound: Option<f64>,
    f32: Run,
    f64: Run,
}

impl ValidationCase {
    /// Measures in f32.
    ///
    /// # Errors
    /// When the scene cannot be run to its end.
    pub fn f32(&self) -> Result<CaseMeasurement, CaseFailure> {
        (self.f32)()
    }

    /// Measures in f64.
    ///
    /// # Errors
    /// When the scene cannot be run to its end.
    pub fn f64(&self) -> Result<CaseMeasurement, CaseFailure> {
        (self.f64)()
    }

    /// Whether a measurement in f64 keeps the bound; what has none keeps it. An error that is no number does not.
    pub fn holds(&self, measured: &CaseMeasurement) -> bool {
        self.bound.is_none_or(|bound| measured.error <= bound)
    }
}

/// What can be measured by the rules `M` in either precision.
pub trait Measure: Clone + Send + Sync + 'static {
    /// Measures once.
    ///
    /// # Errors
    /// When the scene cannot be run to its end.
    fn measure<R: CasePrecision, M: StepRules>(&self) -> Result<CaseMeasurement, CaseFailure>;

    /// The case that measures this.
    fn case<M: StepRules>(
        self,
        name: impl Into<String>,
        known: impl Into<String>,
        (error, bound): (&'static str, Option<f64>),
    ) -> ValidationCase {
        let other = self.clone();
        ValidationCase {
            name: name.into(),
            known: known.into(),
            error,
            bound,
            f32: Box::new(move || self.measure::<f32, M>()),
            f64: Box::new(move || other.measure::<f64, M>()),
        }
    }
}
