//! What a step decided, in words that both sides share, and how two such answers differ.

use crate::compare::{Difference, Features, differences};
use crate::lockstep::state::float_mode;
use num_rational::BigRational;
use rockproof_model::{Block, Contact, Number};
use rockproof_oracle::step::{self as exact, CertifiedStep, FailedAttempt, StepAnswer};
use rockproof_stepper::Real;
use rockproof_stepper::dynamics::{DecidedStep, Mode, RetryReason, State, StepReport};

/// The decisions of one step.
#[derive(Clone, Debug, PartialEq)]
pub struct StepDecisions {
    /// Its contacts with their blocks, by pair and in SPEC order.
    pub contacts: Vec<([u32; 2], Contact)>,
    /// The modes of all contacts after each solve of the accepted attempt.
    pub modes: Vec<Vec<Mode>>,
    /// Whether no mode changed in the last of them.
    pub converged: bool,
    /// Why attempts were given up, in order.
    pub retries: Vec<RetryReason>,
    /// The Δt accepted (s).
    pub time_step: f64,
}

impl StepDecisions {
    /// The stepper's, from what it says of the step, its modes in every attempt, and the state after it.
    pub fn of_stepper<R: Real>(report: &StepReport, attempts: &[Vec<Vec<Mode>>], state: &State<R>) -> StepDecisions {
        StepDecisions {
            contacts: state.contacts.iter().map(|c| (c.blocks, c.contact)).collect(),
            modes: attempts.last().cloned().unwrap_or_default(),
            converged: report.converged,
            retries: report.retries.iter().map(|retry| retry.why).collect(),
            time_step: report.time_step,
        }
    }

    /// The stepper's of contacts that it found, from what it decided with them and its modes in every attempt.
    pub(super) fn of_decided(
        contacts: Vec<([u32; 2], Contact)>,
        decided: &DecidedStep,
        attempts: &[Vec<Vec<Mode>>],
    ) -> StepDecisions {
        StepDecisions {
            contacts,
            modes: attempts.last().cloned().unwrap_or_default(),
            converged: decided.converged,
            retries: decided.retries.iter().map(|retry| retry.why).collect(),
            time_step: decided.time_step,
        }
    }

    /// The oracle's.
    pub fn of_oracle(answer: &StepAnswer) -> StepDecisions {
        let StepAnswer { contacts, modes, converged, retries, time_step, .. } = answer;
        StepDecisions::exact(contacts, modes, *converged, retries, time_step)
    }

    /// The oracle's, of a step whose state was not asked for.
    pub fn of_certified(step: &CertifiedStep) -> StepDecisions {
        let CertifiedStep { contacts, modes, converged, retries, time_step, .. } = step;
        StepDecisions::exact(contacts, modes, *converged, retries, time_step)
    }

    fn exact(
        contacts: &[([usize; 2], Contact)],
        modes: &[Vec<exact::Mode>],
        converged: bool,
        retries: &[FailedAttempt],
        time_step: &BigRational,
    ) -> StepDecisions {
        let reason = |reason: exact::RetryReason| match reason {
            exact::RetryReason::NotConverged => RetryReason::NotConverged,
            exact::RetryReason::Displacement => RetryReason::Displacement,
            exact::RetryReason::Rotation => RetryReason::Rotation,
        };
        let after_solves = modes.iter().skip(1);
        StepDecisions {
            contacts: contacts.iter().map(|(pair, c)| (pair.map(|block| block as u32), *c)).collect(),
            modes: after_solves.map(|all| all.iter().map(|mode| float_mode(*mode)).collect()).collect(),
            converged,
            retries: retries.iter().map(|attempt| reason(attempt.reason)).collect(),
            time_step: Number::from_rational(time_step.clone()).approximate(),
        }
    }

    /// Whether those of two sides that are known are without a contact; no where neither is.
    pub(super) fn are_without_contacts(sides: [&Option<StepDecisions>; 2]) -> bool {
        let mut known = sides.into_iter().flatten().peekable();
        known.peek().is_some() && known.all(|decisions| decisions.contacts.is_empty())
    }

    /// Solves of the accepted attempt.
    pub fn iterations(&self) -> usize {
        self.modes.len()
    }

    /// The retries as one text.
    pub fn retries_text(&self) -> String {
        self.retries.iter().map(|why| why.name()).collect::<Vec<_>>().join(" ")
    }

    fn of_pair(&self, pair: [u32; 2]) -> Vec<Contact> {
        self.contacts.iter().filter(|(blocks, _)| *blocks == pair).map(|(_, contact)| *contact).collect()
    }

    /// The modes of a contact after each solve, by its blocks, kind and features.
    fn modes_of(&self, pair: [u32; 2], contact: &Contact) -> Option<Vec<Mode>> {
        let key = |c: &Contact| c.key;
        let place = self.contacts.iter().position(|(blocks, c)| *blocks == pair && key(c) == key(contact))?;
        self.modes.iter().map(|all| all.get(place).copied()).collect()
    }
}

/// What differs between two answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StepAnswerChange {
    /// A contact: missing, extra, its kind, entrance or sign of the gap.
    Contact(Difference),
    /// The mode of a contact after a solve.
    Mode,
    /// The number of solves.
    Iterations,
    /// Whether the iteration converged.
    Converged,
    /// The attempts given up.
    Retries,
    /// The Δt accepted, after the same retries: by more than [`SAME_TIME_STEP`].
    TimeStep,
    /// One side cannot make the step.
    Stopped,
}

impl StepAnswerChange {
    /// The name in tables and files.
    pub fn name(&self) -> &'static str {
        match self {
            StepAnswerChange::Contact(difference) => difference.change.name(),
            StepAnswerChange::Mode => "mode",
            StepAnswerChange::Iterations => "iterations",
            StepAnswerChange::Converged => "converged",
            StepAnswerChange::Retries => "retries",
            StepAnswerChange::TimeStep => "time-step",
            StepAnswerChange::Stopped => "stopped",
        }
    }
}

/// The largest relative difference of two Δt that is one of rounding.
pub const SAME_TIME_STEP: f64 = 1e-5;

/// One difference between two steps.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct StepDifference {
    /// What differs.
    pub change: StepAnswerChange,
    /// The blocks and the contact it is about, if it is about one.
    pub contact: Option<([u32; 2], Contact)>,
    /// Of [`StepAnswerChange::Mode`]: the first solve, from 1, after which the modes differ.
    pub solve: Option<usize>,
    /// What the first answer has.
    pub before: String,
    /// What the second answer has.
    pub after: String,
}

impl StepDifference {
    fn of_step(change: StepAnswerChange, before: impl ToString, after: impl ToString) -> StepDifference {
        let (before, after) = (before.to_string(), after.to_string());
        StepDifference { change, contact: None, solve: None, before, after }
    }

    /// That one side cannot make the step.
    pub fn stopped(before: impl ToString, after: impl ToString) -> StepDifference {
        StepDifference::of_step(StepAnswerChange::Stopped, before, after)
    }

    /// Whether it is one of contacts.
    pub fn is_of_contacts(&self) -> bool {
        matches!(self.change, StepAnswerChange::Contact(_))
    }
}

/// The differences between two answers: contacts by pair, then modes of contacts that both have, then the iteration.
/// Blocks give the features of contacts.
pub fn compare(before: &StepDecisions, after: &StepDecisions, blocks: &[&Block]) -> Vec<StepDifference> {
    let mut found = contact_differences(before, after, blocks);
    for &(pair, contact) in &before.contacts {
        let modes = before.modes_of(pair, &contact).zip(after.modes_of(pair, &contact));
        let Some((one, two)) = modes else { continue };
        if let Some(first) = one.iter().zip(&two).position(|(one, two)| one != two) {
            let (change, contact, solve) = (StepAnswerChange::Mode, Some((pair, contact)), Some(first + 1));
            let name = |modes: &[Mode]| modes[first].name().to_owned();
            found.push(StepDifference { change, contact, solve, before: name(&one), after: name(&two) });
        }
    }
    if before.iterations() != after.iterations() {
        found.push(StepDifference::of_step(StepAnswerChange::Iterations, before.iterations(), after.iterations()));
    }
    if before.converged != after.converged {
        found.push(StepDifference::of_step(StepAnswerChange::Converged, before.converged, after.converged));
    }
    if before.retries != after.retries {
        found.push(StepDifference::of_step(StepAnswerChange::Retries, before.retries_text(), after.retries_text()));
    } else if (before.time_step - after.time_step).abs() > SAME_TIME_STEP * before.time_step {
        found.push(StepDifference::of_step(StepAnswerChange::TimeStep, before.time_step, after.time_step));
    }
    found
}

fn contact_differences(before: &StepDecisions, after: &StepDecisions, blocks: &[&Block]) -> Vec<StepDifference> {
    let mut pairs: Vec<[u32; 2]> = before.contacts.iter().chain(&after.contacts).map(|(pair, _)| *pair).collect();
    pairs.sort_unstable();
    pairs.dedup();
    let mut found = Vec::new();
    for pair in pairs {
        let [Some(a), Some(b)] = pair.map(|block| blocks.get(block as usize)) else { continue };
        let features = Features { a: a.topology(), b: b.topology() };
        for difference in differences(&before.of_pair(pair), &after.of_pair(pair), features) {
            found.push(StepDifference {
                change: StepAnswerChange::Contact(difference),
                contact: difference.contact().map(|contact| (pair, contact)),
                solve: None,
                before: difference.before.as_ref().map_or(String::new(), described),
                after: difference.after.as_ref().map_or(String::new(), described),
            });
        }
    }
    found
}

/// A contact in a word or two: kind, features, entrance, sign of the gap.
pub fn described(contact: &Contact) -> String {
    let gap = ["overlap", "touch", "apart"][(contact.gap.as_i8() + 1).clamp(0, 2) as usize];
    format!("{} by {} {gap}", contact.key, contact.entrance)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rockproof_model::{ContactKey, Entrance, FaceId, Sign, VertexId};

    #[test]
    fn a_step_that_no_side_made_is_not_said_to_touch_nothing() {
        let (vertex, face) = (VertexId(0), FaceId(0));
        let contact = Contact {
            key: ContactKey::VertexFace(vertex, face),
            entrance: Entrance::VertexFace(vertex, face),
            gap: Sign::Zero,
        };
        let with = |contacts| {
            Some(StepDecisions { contacts, modes: Vec::new(), converged: true, retries: Vec::new(), time_step: 1.0 })
        };
        let (apart, touching) = (with(Vec::new()), with(vec![([0, 1], contact)]));
        for (sides, none) in [
            ([&apart, &apart], true),
            ([&apart, &None], true),
            ([&None, &apart], true),
            ([&apart, &touching], false),
            ([&touching, &None], false),
            ([&None, &None], false),
        ] {
            assert_eq!(StepDecisions::are_without_contacts(sides), none, "{sides:?}");
        }
    }
}
