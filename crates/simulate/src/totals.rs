//! What a run comes to, over all its steps.

use crate::audit::AuditTotals;
use crate::energy_gain::EnergyBalance;
use crate::exact_float::ExactFloat;
use rockproof_model::simulation::step_in_words;
use rockproof_stepper::dynamics::{Mode, RetryReason, StepReport};
use serde::{Deserialize, Serialize};

/// Sums and extremes over the steps of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Totals {
    /// Steps, settling not counted.
    pub steps: u64,
    /// Steps of settling.
    pub settling: u64,
    /// The largest displacement of a vertex in the last step of settling (m); none without settling.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub settled: Option<ExactFloat>,
    /// Solves of the accepted attempts.
    pub iterations: u64,
    /// Solves of the step with the most.
    pub most_iterations: u32,
    /// Steps accepted without converging.
    pub unconverged: u64,
    /// Steps that [count as converged though friction had not settled](Totals::is_unsettled).
    #[serde(default, skip_serializing_if = "is_none")]
    pub unsettled: u64,
    /// The largest [`StepReport::friction_left`] of a step, 1 where it is more: where nothing else acts on a block it has no bound.
    #[serde(default, skip_serializing_if = "Extreme::is_none")]
    pub friction_left: Extreme,
    /// Attempts given up because modes still changed, because a vertex moved too far, because a block turned too far.
    pub retries: [u64; 3],
    /// The deepest overlap of a contact after a step, to first order, settling not counted (m).
    pub deepest: Extreme,
    /// The largest displacement of a vertex in a step, settling not counted (m).
    pub furthest: Extreme,
    /// The smallest Δt that was accepted (s), settling not counted; none before the first step.
    pub smallest_step: Option<ExactFloat>,
    /// Contacts after the last step: open, sliding, locked.
    pub contacts: [u64; 3],
    /// Kinetic energy after the last step (J).
    pub kinetic: ExactFloat,
    /// All other energy after the last step (J).
    pub potential: ExactFloat,
    /// The energy of the steps, settling left out, as far as a gain is looked for.
    #[serde(default)]
    pub balance: EnergyBalance,
    /// What the exact audit of the steps found; none without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub audit: Option<AuditTotals>,
}

/// A value and the step it belongs to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Extreme {
    /// The value.
    pub value: ExactFloat,
    /// The first step that has it.
    pub step: i64,
}

fn is_none(count: &u64) -> bool {
    *count == 0
}

impl Extreme {
    fn is_none(&self) -> bool {
        *self == Extreme::default()
    }

    fn add(&mut self, value: f64, step: i64) {
        if value > self.value.0 {
            *self = Extreme { value: ExactFloat(value), step };
        }
    }
}

impl Totals {
    /// The share of the forces on a block by which friction may be off before that is told: ten times what SPEC section 5 takes for settled, since blocks that
    /// strike one another have a few per cent now and then.
    const FRICTION_LEFT: f64 = 0.1;

    /// What mends a step in which friction does not settle.
    pub const SETTLES_FRICTION: &str = "a shorter time_step, or softer springs";

    /// Whether a step counts as converged though friction had not settled, so that blocks moved otherwise than it lets them.
    pub fn is_unsettled(report: &StepReport) -> bool {
        report.friction_left > Totals::FRICTION_LEFT
    }

    /// In how many steps friction had not settled, and in which it was furthest from it; `None` where there is no such step.
    pub fn unsettled_in_words(&self) -> Option<String> {
        if self.unsettled == 0 {
            return None;
        }
        let steps = if self.unsettled == 1 { "1 step".to_owned() } else { format!("{} steps", self.unsettled) };
        let Extreme { value, step } = self.friction_left;
        Some(format!(
            "not settled in {steps} (in {} by {:.0} % of the forces on a block), so that blocks move otherwise than friction lets them: {}",
            step_in_words(step),
            100.0 * value.0,
            Totals::SETTLES_FRICTION
        ))
    }

    /// Adds a step.
    pub fn add(&mut self, report: &StepReport) {
        if report.step > 0 {
            self.steps += 1;
            self.deepest.add(report.max_penetration, report.step);
            self.furthest.add(report.max_displacement, report.step);
            let smallest = self.smallest_step.map_or(f64::INFINITY, |s| s.0);
            self.smallest_step = Some(ExactFloat(smallest.min(report.time_step)));
        } else {
            self.settling += 1;
            self.settled = Some(ExactFloat(report.max_displacement));
        }
        self.iterations += u64::from(report.iterations);
        self.most_iterations = self.most_iterations.max(report.iterations);
        self.unconverged += u64::from(!report.converged);
        if Totals::is_unsettled(report) {
            self.unsettled += 1;
            self.friction_left.add(report.friction_left.min(1.0), report.step);
        }
        for retry in &report.retries {
            self.retries[retry.why as usize] += 1;
        }
        self.contacts = [Mode::Open, Mode::Sliding, Mode::Locked]
            .map(|mode| report.contacts.iter().map(|of_kind| u64::from(of_kind[mode as usize])).sum());
        (self.kinetic, self.potential) = (ExactFloat(report.kinetic), ExactFloat(report.potential()));
    }

    /// Retries with the names of their reasons.
    pub fn retries_by_reason(&self) -> [(&'static str, u64); 3] {
        [RetryReason::NotConverged, RetryReason::Displacement, RetryReason::Rotation]
            .map(|why| (why.name(), self.retries[why as usize]))
    }
}
