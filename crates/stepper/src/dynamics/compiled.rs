//! The step by the rules of SPEC, compiled in this crate once for each scalar.
//!
//! Generic code is compiled in every crate that uses it. [`Dynamics`] by [`Spec`] is used in many; so its work goes through the functions
//! of [`CompiledSteps`], which have no type parameter left. Steps by other rules, those of tests, take the generic way.

use crate::contact::Spec;
use crate::dynamics::engine::Dynamics;
use crate::dynamics::given::Given;
use crate::dynamics::report::{StepReport, Stopped};
use crate::dynamics::setup::SetupError;
use crate::dynamics::state::State;
use crate::real::Real;
use crate::wide::Wide;
use rockproof_model::{Scene, ToleranceSet};

/// What [`Dynamics`] does by the rules of SPEC in this scalar.
pub trait CompiledSteps: Real {
    /// [`Dynamics::with_rules`].
    ///
    /// # Errors
    /// As there.
    fn begin(scene: &Scene, set: &ToleranceSet) -> Result<Dynamics<Self, Spec>, SetupError>;

    /// [`Dynamics::restore`].
    ///
    /// # Errors
    /// As there.
    fn restore(dynamics: &mut Dynamics<Self, Spec>, state: State<Self>) -> Result<(), SetupError>;

    /// [`Dynamics::step`], or [`Dynamics::step_given`].
    ///
    /// # Errors
    /// As there.
    fn step(dynamics: &mut Dynamics<Self, Spec>, given: Option<&Given<'_>>) -> Result<StepReport, Stopped>;
}

macro_rules! compiled {
    ($($scalar:ty),*) => {$(
        impl CompiledSteps for $scalar {
            #[inline(never)]
            fn begin(scene: &Scene, set: &ToleranceSet) -> Result<Dynamics<Self, Spec>, SetupError> {
                Dynamics::begin(scene, set)
            }

            #[inline(never)]
            fn restore(dynamics: &mut Dynamics<Self, Spec>, state: State<Self>) -> Result<(), SetupError> {
                dynamics.go_on_from(state)
            }

            #[inline(never)]
            fn step(dynamics: &mut Dynamics<Self, Spec>, given: Option<&Given<'_>>) -> Result<StepReport, Stopped> {
                dynamics.make_step(given)
            }
        }
    )*};
}

compiled!(f32, f64, Wide);
