//! The stepper's own code in 512 bits, one step from a given state: what remains different there is no rounding.

use crate::lockstep::answer::StepDecisions;
use crate::lockstep::scene::ExactScene;
use crate::lockstep::state::converted;
use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use rockproof_stepper::dynamics::{Dynamics, SetupError, State, StepError, StepRules};
use rockproof_stepper::real::Real;
use rockproof_stepper::wide::{Wide, count_unsettled};

/// A scene in the wide scalar.
#[derive(Debug)]
pub struct WideStepper<M> {
    dynamics: Dynamics<Wide, M>,
    /// One thread, because unsettled comparisons are counted where they are made.
    alone: ThreadPool,
}

/// Why there is no wide stepper.
#[derive(Debug, thiserror::Error)]
pub enum WideError {
    /// The scene cannot be stepped.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The system gives no thread.
    #[error(transparent)]
    Thread(#[from] ThreadPoolBuildError),
}

/// A step in the wide scalar.
#[derive(Clone, Debug)]
pub struct WideStep {
    /// What it decided, and the state after it, or why it cannot be made.
    pub outcome: Result<(StepDecisions, State<Wide>), StepError>,
    /// Comparisons that 512 bits left unsettled: exact ties, or nearly. Where there are none, every decision is the exact one.
    pub unsettled: u64,
}

impl<M: StepRules> WideStepper<M> {
    /// A stepper of the scene, whose numbers 512 bits hold exactly: it is a rounded one.
    ///
    /// # Errors
    /// When a block collapses.
    pub fn new(scene: &ExactScene) -> Result<WideStepper<M>, WideError> {
        let dynamics = Dynamics::with_rules(scene.scene(), scene.tolerances())?;
        Ok(WideStepper { dynamics, alone: ThreadPoolBuilder::new().num_threads(1).build()? })
    }

    /// One step from a state of the scene.
    ///
    /// # Errors
    /// When the state is none of the scene.
    pub fn step<R: Real>(&mut self, state: &State<R>) -> Result<WideStep, SetupError> {
        let state: State<Wide> = converted(state);
        let dynamics = &mut self.dynamics;
        let (made, unsettled) = self.alone.install(|| {
            count_unsettled(|| {
                dynamics.restore(state)?;
                Ok::<_, SetupError>(dynamics.step())
            })
        });
        let outcome = made?.map(|report| {
            let state = self.dynamics.state().clone();
            (StepDecisions::of_stepper(&report, self.dynamics.modes(), &state), state)
        });
        Ok(WideStep { outcome, unsettled })
    }
}
