//! States after a step that deviate by more than rounding, though all decisions are the same.

use crate::lockstep::answer::{StepDecisions, compare};
use crate::lockstep::run::{ComparedStep, KEPT_PRECISION, Lockstep, NEARLY_AT_REST, wide_stepper};
use crate::lockstep::state::exact_state;
use crate::lockstep::state_errors::{anchor_error, largest_distance, rate_error};
use rockproof_model::{Number, Precision};
use rockproof_oracle::step as exact;
use rockproof_stepper::dynamics::{Solve, State, StepRules};
use std::fmt;

/// A deviation of the state after a step that is no rounding: the stepper's own code has it in 512 bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    /// What deviates.
    pub what: DriftQuantity,
    /// By how much: of velocities a share of the largest rate of the block, otherwise a share of `max_displacement`.
    pub error: f64,
}

/// What of a state deviates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DriftQuantity {
    /// Anchors of closed contacts.
    Anchors,
    /// Velocities.
    Velocity,
    /// Vertices.
    Displacement,
}

impl DriftQuantity {
    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self {
            DriftQuantity::Anchors => "anchors",
            DriftQuantity::Velocity => "velocity",
            DriftQuantity::Displacement => "displacement",
        }
    }
}

impl fmt::Display for Drift {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let of = if self.what == DriftQuantity::Velocity { "its rate" } else { "max_displacement" };
        write!(f, "{}: {:e} of {of} in 512 bits", self.what.name(), self.error)
    }
}

/// Errors of a state beyond these are looked at in 512 bits: of velocities as a share, of anchors as a share of `max_displacement`.
fn suspicious(precision: Precision) -> f64 {
    match precision {
        Precision::F32 => 0.125,
        Precision::F64 => 1e-6,
    }
}

/// In 512 bits nothing of this size is rounding; the oracle's state is kept to 2⁻⁸⁰ m.
const ROUNDING: f64 = 1e-6;

impl<R: Solve, M: StepRules> Lockstep<R, M> {
    /// How far the stepper's own code, in 512 bits, comes from the oracle's step from the state `before`, where the step that was `compared`
    /// decided as the oracle does and yet ended elsewhere. `None` where that is rounding, where 512 bits decide otherwise or leave a
    /// comparison unsettled.
    pub fn drift(&mut self, before: &State<R>, compared: &ComparedStep) -> Option<Drift> {
        let reach = self.rounded().tolerances().max_displacement.approximate();
        let own = compared.stepper.is_some() && compared.oracle.is_some() && !compared.differs();
        let beyond = |error: Option<f64>, limit: f64| error.is_some_and(|error| error > limit);
        let limit = suspicious(self.precision());
        let is_suspicious = beyond(compared.velocity, limit)
            || beyond(compared.anchors, limit * reach)
            || beyond(compared.displacement.map(|(error, _)| error), limit);
        if !own || !is_suspicious {
            return None;
        }
        let all = self.deviations_in_wide(before, reach)?;
        all.into_iter().find(|drift| drift.error > ROUNDING)
    }

    fn deviations_in_wide(&mut self, before: &State<R>, reach: f64) -> Option<[Drift; 3]> {
        let start = exact_state(before).ok()?;
        let (rounded, wide) = self.rounded_and_wide();
        let exact = rounded.step(&start, KEPT_PRECISION).ok()?;
        let step = wide_stepper(wide, rounded)?.step(before).ok()?;
        let (answer, after) = step.outcome.ok()?;
        if step.unsettled > 0
            || !compare(&StepDecisions::of_oracle(&exact), &answer, &rounded.scene().shapes()).is_empty()
        {
            return None;
        }
        let after = rounded.kept(exact_state(&after).ok()?);
        let distance =
            |(a, b): (&exact::BlockState, &exact::BlockState)| largest_distance(a.vertices.iter().zip(&b.vertices));
        let time_step = Number::from_rational(exact.time_step.clone()).approximate();
        let slow = reach / time_step * NEARLY_AT_REST;
        let vertices = after.blocks.iter().zip(&exact.state.blocks).map(distance).fold(0.0, f64::max);
        let anchors = anchor_error(&after, &exact.state).unwrap_or(0.0);
        Some([
            Drift { what: DriftQuantity::Anchors, error: anchors / reach },
            Drift { what: DriftQuantity::Velocity, error: rate_error(&start, &after, &exact.state, slow) },
            Drift { what: DriftQuantity::Displacement, error: vertices / reach },
        ])
    }
}
