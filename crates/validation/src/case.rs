//! A line of the table: what is known, what must hold, and how to measure it.

use crate::lab::Failure;
use rockproof_model::Precision;
use rockproof_stepper::dynamics::{Solve, StepRules};

/// A precision in which the stepper runs a case.
pub trait Engine: Solve {
    /// Its name in tables.
    const NAME: &'static str;
    /// Its precision, by which tolerances are derived.
    const PRECISION: Precision;
}

impl Engine for f32 {
    const NAME: &'static str = "f32";
    const PRECISION: Precision = Precision::F32;
}

impl Engine for f64 {
    const NAME: &'static str = "f64";
    const PRECISION: Precision = Precision::F64;
}

/// What a run showed.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// How far it is from the closed form, in the unit that the case names; 0 is perfect.
    pub error: f64,
    /// What was seen, in words and figures.
    pub seen: String,
}

impl Measured {
    /// An error, and what was seen.
    pub fn new(error: f64, seen: impl Into<String>) -> Measured {
        Measured { error, seen: seen.into() }
    }
}

/// Runs a case once.
type Run = Box<dyn Fn() -> Result<Measured, Failure> + Send + Sync>;

/// One case in both precisions.
pub struct Case {
    /// What it is called; one of its kind.
    pub name: String,
    /// The closed form.
    pub known: String,
    /// What `error` of [`Measured`] is.
    pub error: &'static str,
    /// The largest error allowed in f64; `None` where the case only shows something.
    pub bound: Option<f64>,
    f32: Run,
    f64: Run,
}

impl Case {
    /// Measures in f32.
    ///
    /// # Errors
    /// When the scene cannot be run to its end.
    pub fn f32(&self) -> Result<Measured, Failure> {
        (self.f32)()
    }

    /// Measures in f64.
    ///
    /// # Errors
    /// When the scene cannot be run to its end.
    pub fn f64(&self) -> Result<Measured, Failure> {
        (self.f64)()
    }

    /// Whether a measurement in f64 keeps the bound; what has none keeps it. An error that is no number does not.
    pub fn holds(&self, measured: &Measured) -> bool {
        self.bound.is_none_or(|bound| measured.error <= bound)
    }
}

/// What can be measured by the rules `M` in either precision.
pub trait Measure: Clone + Send + Sync + 'static {
    /// Measures once.
    ///
    /// # Errors
    /// When the scene cannot be run to its end.
    fn measure<R: Engine, M: StepRules>(&self) -> Result<Measured, Failure>;

    /// The case that measures this.
    fn case<M: StepRules>(
        self,
        name: impl Into<String>,
        known: impl Into<String>,
        (error, bound): (&'static str, Option<f64>),
    ) -> Case {
        let other = self.clone();
        Case {
            name: name.into(),
            known: known.into(),
            error,
            bound,
            f32: Box::new(move || self.measure::<f32, M>()),
            f64: Box::new(move || other.measure::<f64, M>()),
        }
    }
}
