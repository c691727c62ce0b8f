//! The stepper's own code in 512 bits, one step from a given state: what remains different there is no rounding.

use crate::lockstep::answer::StepDecisions;
use crate::lockstep::scene::ExactScene;
use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use rockproof_model::ToleranceSet;
use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::dynamics::{
    BlockContacts, DoubleDecisions, DoubleSteps, Dynamics, SetupError, State, StepError, StepRules,
};
use rockproof_stepper::real::Real;
use rockproof_stepper::wide::{BITS, Wide, count_unsettled, in_bits};
use std::any::TypeId;

/// Bits in which the iteration of a step is made first: it seldom has a comparison that these leave unsettled.
pub const FEWER_BITS: u32 = 128;

/// A scene in the wide scalar.
#[derive(Debug)]
pub struct WideStepper<M> {
    dynamics: Dynamics<Wide, M>,
    /// The same in fewer bits, if it can be made.
    in_fewer_bits: Option<Dynamics<Wide, M>>,
    /// The same in two f64, by the rules of SPEC alone, if it can be made.
    in_double: Option<DoubleSteps>,
    tolerances: ToleranceSet,
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

/// What a step in the wide scalar decides.
#[derive(Clone, Debug)]
pub enum WideDecisions {
    /// What it decided, or why it cannot be made, with no comparison that rounding may have turned.
    Settled(Result<StepDecisions, StepError>),
    /// 512 bits leave a comparison unsettled, an exact tie, or nearly: what comes of it would not tell a mistake from rounding.
    Unsettled,
}

/// A step in the wide scalar.
#[derive(Clone, Debug)]
pub struct WideStep {
    /// What it decided, and the state after it, or why it cannot be made.
    pub outcome: Result<(StepDecisions, State<Wide>), StepError>,
    /// Comparisons that 512 bits left unsettled: exact ties, or nearly. Where there are none, every decision is the exact one.
    pub unsettled: u64,
}

impl WideDecisions {
    fn of(outcome: Result<StepDecisions, StepError>, unsettled: u64) -> WideDecisions {
        if unsettled == 0 { WideDecisions::Settled(outcome) } else { WideDecisions::Unsettled }
    }

    /// Whether a comparison stayed unsettled.
    pub fn is_unsettled(&self) -> bool {
        matches!(self, WideDecisions::Unsettled)
    }
}

impl<M: StepRules> WideStepper<M> {
    /// A stepper of the scene, whose numbers 512 bits hold exactly: it is a rounded one.
    ///
    /// # Errors
    /// When a block collapses.
    pub fn new(scene: &ExactScene) -> Result<WideStepper<M>, WideError> {
        let alone = ThreadPoolBuilder::new().num_threads(1).build()?;
        let made = |bits| alone.install(|| in_bits(bits, || Dynamics::with_rules(scene.scene(), scene.tolerances())));
        let (dynamics, in_fewer_bits) = (made(BITS)?, made(FEWER_BITS).ok());
        let in_double = match TypeId::of::<M>() == TypeId::of::<SpecRules>() {
            true => alone.install(|| DoubleSteps::begin(scene.scene(), scene.tolerances())),
            false => None,
        };
        Ok(WideStepper { dynamics, in_fewer_bits, in_double, tolerances: scene.tolerances().clone(), alone })
    }

    /// What one step from a state of the scene decides, as [`WideStepper::step`] has it where nothing stays unsettled. Contacts are found in two f64 or in
    /// f64 wherever that settles a comparison, and the rest is made in two f64 or in fewer bits if these settle all its comparisons. Nothing is made after
    /// contacts that 512 bits do not settle.
    ///
    /// # Errors
    /// When the state is none of the scene.
    pub fn decide<R: Real + Sync>(&mut self, state: &State<R>) -> Result<WideDecisions, SetupError> {
        let set = &self.tolerances;
        let in_double = self.in_double.as_mut();
        let found = in_double.and_then(|in_double| {
            let found = self.alone.install(|| in_double.decide(state, set))?;
            Some((found, in_double.modes()))
        });
        let contacts = match found {
            Some((DoubleDecisions { contacts: None, .. }, _)) => return Ok(WideDecisions::Unsettled),
            Some((DoubleDecisions { contacts: Some(contacts), decided: Some(decided) }, modes)) => {
                return Ok(WideDecisions::Settled(Ok(StepDecisions::of_decided(contacts, &decided, modes))));
            }
            found => found.and_then(|(found, _)| found.contacts),
        };
        if let Some(decisions) = self.decide_in_fewer_bits(state, contacts) {
            return Ok(decisions);
        }
        let WideStep { outcome, unsettled } = self.step(state)?;
        Ok(WideDecisions::of(outcome.map(|(decisions, _)| decisions), unsettled))
    }

    /// The same with these contacts, which 512 bits settle, or with those that can be found in f64.
    fn decide_in_fewer_bits<R: Real>(
        &mut self,
        state: &State<R>,
        contacts: Option<BlockContacts>,
    ) -> Option<WideDecisions> {
        let state: State<Wide> = state.in_scalar();
        let in_fewer_bits = self.in_fewer_bits.as_mut()?;
        let (dynamics, set) = (&mut self.dynamics, &self.tolerances);
        self.alone.install(|| {
            let (restored, in_restoring) =
                count_unsettled(|| in_bits(FEWER_BITS, || in_fewer_bits.restore(state.clone())));
            restored.ok()?;
            let (contacts, in_contacts) =
                contacts.map(|contacts| (contacts, 0)).or_else(|| in_fewer_bits.filtered_contacts(set))?;
            if in_contacts > 0 {
                return Some(WideDecisions::Unsettled);
            }
            let work = || in_bits(FEWER_BITS, || in_fewer_bits.decide_prescribed(&contacts));
            let (decided, in_iteration) = count_unsettled(work);
            if let (Ok(decided), 0) = (decided, in_restoring + in_iteration) {
                let decisions = StepDecisions::of_decided(contacts, &decided, in_fewer_bits.modes());
                return Some(WideDecisions::Settled(Ok(decisions)));
            }
            let work = || dynamics.restore(state).map(|()| dynamics.decide_prescribed(&contacts));
            let (decided, unsettled) = count_unsettled(work);
            let outcome = decided.ok()?.map(|decided| StepDecisions::of_decided(contacts, &decided, dynamics.modes()));
            Some(WideDecisions::of(outcome, unsettled))
        })
    }

    /// One step from a state of the scene.
    ///
    /// # Errors
    /// When the state is none of the scene.
    pub fn step<R: Real>(&mut self, state: &State<R>) -> Result<WideStep, SetupError> {
        let state: State<Wide> = state.in_scalar();
        let dynamics = &mut self.dynamics;
        let work = || dynamics.restore(state).map(|()| dynamics.step());
        let (report, unsettled) = self.alone.install(|| count_unsettled(work));
        let outcome = report?.map(|report| {
            let state = self.dynamics.state().clone();
            (StepDecisions::of_stepper(&report, self.dynamics.modes(), &state), state)
        });
        Ok(WideStep { outcome, unsettled })
    }
}
