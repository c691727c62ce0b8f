//! Hypotheses about what an engine says in every answer, whatever it is asked: one sign of gaps, one kind of entrance, one state.

use super::hypothesis::Hypothesis;
use super::question::{PreparedQuestion, Reply};
use crate::external::protocol::UNNAMED;
use crate::separation_state::{ReportedState, SeparationState};
use rockproof_model::{Contact, Entrance, EntranceKind, Sign};

/// What is always the same.
#[derive(Clone, Copy, Debug)]
enum Constant {
    /// The sign of every contact's gap.
    GapSign(Sign),
    /// How blocks are said to lie.
    State(SeparationState),
    /// The gap of a state, which is 0.
    GapOfState,
    /// The kind of every entrance.
    Entrance(EntranceKind),
}

/// The hypotheses about what is always the same. Those that leave something open come last.
pub(super) fn all() -> impl Iterator<Item = Box<dyn Hypothesis>> {
    let signs = [Sign::Positive, Sign::Zero, Sign::Negative].map(Constant::GapSign);
    let states = SeparationState::ALL.map(Constant::State);
    let entrances = [EntranceKind::VertexFace, EntranceKind::FaceVertex, EntranceKind::EdgeEdge];
    let all = signs.into_iter().chain(states).chain([Constant::GapOfState]).chain(entrances.map(Constant::Entrance));
    all.map(|constant| Box::new(constant) as Box<dyn Hypothesis>)
}

impl Hypothesis for Constant {
    fn name(&self) -> String {
        match self {
            Constant::GapSign(Sign::Positive) => "gap-sign-always-positive".to_owned(),
            Constant::GapSign(Sign::Zero) => "gap-sign-always-zero".to_owned(),
            Constant::GapSign(Sign::Negative) => "gap-sign-always-negative".to_owned(),
            Constant::State(state) => format!("always-{state}"),
            Constant::GapOfState => "gap-always-0".to_owned(),
            Constant::Entrance(kind) => format!("entrance-always-{kind}"),
        }
    }

    fn sentence(&self) -> String {
        match self {
            Constant::GapSign(sign) => format!("but that the sign of every gap is {}", sign.as_i8()),
            Constant::State(state) => format!("but that blocks are called {state} however they lie"),
            Constant::GapOfState => "but that every gap is 0".to_owned(),
            Constant::Entrance(kind) => format!(
                "but that every entrance is {kind} (of those that should be another kind features and signs of gaps were not looked at)"
            ),
        }
    }

    fn contacts(&self, asked: &PreparedQuestion<'_>) -> Option<Vec<Contact>> {
        let exact = asked.exact();
        Some(match *self {
            Constant::GapSign(gap) => exact.iter().map(|contact| Contact { gap, ..*contact }).collect(),
            Constant::Entrance(kind) => exact.iter().map(|contact| with_entrance(contact, kind, asked)).collect(),
            Constant::State(_) | Constant::GapOfState => return None,
        })
    }

    fn says_state(&self, asked: &PreparedQuestion<'_>, said: ReportedState) -> Option<bool> {
        match *self {
            Constant::State(state) => {
                let (wrong, comparison) = asked.compare_state(said, asked.question.accuracy)?;
                Some(if comparison.exact == state { wrong.is_none() } else { said.state == state })
            }
            Constant::GapOfState => {
                let is_right = asked.state_is_right(ReportedState { gap_m: None, ..said })?;
                Some(is_right && said.gap_m == Some(0.0))
            }
            Constant::GapSign(_) | Constant::Entrance(_) => None,
        }
    }

    /// Where the engine says something else of it.
    fn is_refuted(&self, asked: &PreparedQuestion<'_>) -> bool {
        let named = |said: &&Contact| said.entrance != UNNAMED;
        match (*self, &asked.question.reply) {
            (Constant::GapSign(sign), Reply::Contacts(said)) => said.iter().filter(named).any(|one| one.gap != sign),
            (Constant::Entrance(kind), Reply::Contacts(said)) => {
                said.iter().filter(named).any(|one| one.entrance.kind() != kind)
            }
            (Constant::State(state), Reply::State(said)) => said.state != state,
            (Constant::GapOfState, Reply::State(said)) => said.gap_m.is_some_and(|gap| gap != 0.0),
            _ => false,
        }
    }

    fn leaves_open(&self) -> bool {
        matches!(self, Constant::Entrance(_))
    }
}

/// A contact with an entrance of a kind. Which one such an engine takes for another kind is open, and the gap is that of its plane: both are what
/// this engine said.
fn with_entrance(contact: &Contact, kind: EntranceKind, asked: &PreparedQuestion<'_>) -> Contact {
    if contact.entrance.kind() == kind {
        return *contact;
    }
    let is_meant =
        |said: &&Contact| said.key == contact.key && said.entrance.kind() == kind && said.entrance != UNNAMED;
    let said = match &asked.question.reply {
        Reply::Contacts(said) => said.iter().find(is_meant),
        Reply::State(_) | Reply::Nothing(_) => None,
    };
    said.copied().unwrap_or(Contact { entrance: Entrance::of_kind(kind, contact.entrance.numbers()), ..*contact })
}
