//! The step by the rules of SPEC, compiled in this crate once for each scalar.
//!
//! Generic code is compiled in every crate that uses it. [`Dynamics`] by [`SpecRules`] is used in many; so its work goes through the functions
//! of [`CompiledSteps`], which have no type parameter left. Steps by other rules, those of tests, take the generic way.

use crate::contact::SpecRules;
use crate::double::Double;
use crate::dynamics::decided::DecidedStep;
use crate::dynamics::prescribed::PrescribedStep;
use crate::dynamics::report::{StepError, StepReport};
use crate::dynamics::setup::SetupError;
use crate::dynamics::state::State;
use crate::dynamics::step::Dynamics;
use crate::real::Real;
use crate::wide::Wide;
use rockproof_model::{Contact, Scene, ToleranceSet};

/// What [`Dynamics`] does by the rules of SPEC in this scalar.
pub trait CompiledSteps: Real {
    /// [`Dynamics::with_rules`].
    ///
    /// # Errors
    /// As there.
    fn begin(scene: &Scene, set: &ToleranceSet) -> Result<Dynamics<Self, SpecRules>, SetupError>;

    /// [`Dynamics::restore`].
    ///
    /// # Errors
    /// As there.
    fn restore(dynamics: &mut Dynamics<Self, SpecRules>, state: State<Self>) -> Result<(), SetupError>;

    /// [`Dynamics::step`], or [`Dynamics::step_prescribed`].
    ///
    /// # Errors
    /// As there.
    fn step(
        dynamics: &mut Dynamics<Self, SpecRules>,
        prescribed: Option<&PrescribedStep<'_>>,
    ) -> Result<StepReport, StepError>;

    /// [`Dynamics::decide_prescribed`].
    ///
    /// # Errors
    /// As there.
    fn decide(
        dynamics: &mut Dynamics<Self, SpecRules>,
        contacts: &[([u32; 2], Contact)],
    ) -> Result<DecidedStep, StepError>;
}

macro_rules! compiled {
    ($($scalar:ty),*) => {$(
        impl CompiledSteps for $scalar {
            #[inline(never)]
            fn begin(scene: &Scene, set: &ToleranceSet) -> Result<Dynamics<Self, SpecRules>, SetupError> {
                Dynamics::begin(scene, set)
            }

            #[inline(never)]
            fn restore(dynamics: &mut Dynamics<Self, SpecRules>, state: State<Self>) -> Result<(), SetupError> {
                dynamics.continue_from(state)
            }

            #[inline(never)]
            fn step(dynamics: &mut Dynamics<Self, SpecRules>, prescribed: Option<&PrescribedStep<'_>>) -> Result<StepReport, StepError> {
                dynamics.make_step(prescribed)
            }

            #[inline(never)]
            fn decide(dynamics: &mut Dynamics<Self, SpecRules>, contacts: &[([u32; 2], Contact)]) -> Result<DecidedStep, StepError> {
                dynamics.make_decisions(contacts)
            }
        }
    )*};
}

compiled!(f32, f64, Double, Wide);
