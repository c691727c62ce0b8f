//! Hypotheses about how right answers are said wrongly: signs, entrances, normals, units.

use super::hypothesis::Hypothesis;
use super::question::Asked;
use crate::collision::CollisionQuery;
use crate::separation_state::{ReportedState, SeparationState};
use rockproof_model::{Contact, Entrance, EntranceKind, Sign};

/// What is said wrongly.
#[derive(Clone, Copy, Debug)]
enum SaidWrongly {
    /// The gap's sign is turned.
    GapTurned,
    /// The same where such a plane is the entrance.
    GapTurnedAt(EntranceKind),
    /// An overlap is given as a positive depth.
    DepthPositive,
    /// Numbers of the entrance exchanged.
    EntranceExchanged,
    /// Entrances v-f called f-v and the other way round, features as they are.
    EntranceRenamed,
    /// The normal points the other way.
    NormalTurned,
    /// The gap in millimetres.
    Millimetres,
    /// The gap's square.
    Squared,
    /// Blocks that touch are said to lie so.
    Touching(SeparationState),
}

/// The hypotheses about what is said wrongly.
pub(super) fn all() -> impl Iterator<Item = Box<dyn Hypothesis>> {
    let planes = [EntranceKind::VertexFace, EntranceKind::FaceVertex, EntranceKind::EdgeEdge];
    let touching = [SeparationState::Apart, SeparationState::Overlapping].map(SaidWrongly::Touching);
    let others = [
        SaidWrongly::DepthPositive,
        SaidWrongly::EntranceExchanged,
        SaidWrongly::EntranceRenamed,
        SaidWrongly::NormalTurned,
        SaidWrongly::Millimetres,
        SaidWrongly::Squared,
    ];
    let turned = std::iter::once(SaidWrongly::GapTurned).chain(planes.map(SaidWrongly::GapTurnedAt));
    turned.chain(others).chain(touching).map(|said| Box::new(said) as Box<dyn Hypothesis>)
}

impl Hypothesis for SaidWrongly {
    fn name(&self) -> String {
        match self {
            SaidWrongly::GapTurned => "gap-sign-turned".to_owned(),
            SaidWrongly::GapTurnedAt(kind) => format!("gap-sign-turned-at-{kind}"),
            SaidWrongly::DepthPositive => "depth-positive".to_owned(),
            SaidWrongly::EntranceExchanged => "entrance-exchanged".to_owned(),
            SaidWrongly::EntranceRenamed => "entrance-renamed".to_owned(),
            SaidWrongly::NormalTurned => "normal-turned".to_owned(),
            SaidWrongly::Millimetres => "gap-in-millimetres".to_owned(),
            SaidWrongly::Squared => "gap-squared".to_owned(),
            SaidWrongly::Touching(state) => format!("touching-is-{state}"),
        }
    }

    fn sentence(&self) -> String {
        match self {
            SaidWrongly::GapTurned => "with the sign of every gap turned".to_owned(),
            SaidWrongly::GapTurnedAt(kind) => format!("with the sign of the gap turned where the entrance is {kind}"),
            SaidWrongly::DepthPositive => "with overlaps given as positive gaps".to_owned(),
            SaidWrongly::EntranceExchanged => "with the features of the entrance exchanged".to_owned(),
            SaidWrongly::EntranceRenamed => "with entrances v-f called f-v and f-v called v-f".to_owned(),
            SaidWrongly::NormalTurned => "with the normal turned round: it points from A to B".to_owned(),
            SaidWrongly::Millimetres => "with the gap in millimetres".to_owned(),
            SaidWrongly::Squared => "with the square of the gap in place of the gap".to_owned(),
            SaidWrongly::Touching(state) => format!("but for blocks that touch, which are called {state}"),
        }
    }

    fn contacts(&self, asked: &Asked<'_>) -> Option<Vec<Contact>> {
        let mut contacts = asked.exact().to_vec();
        for contact in &mut contacts {
            let entrance = contact.entrance;
            match self {
                SaidWrongly::GapTurned => contact.gap = contact.gap.reversed(),
                SaidWrongly::GapTurnedAt(kind) if *kind == entrance.kind() => contact.gap = contact.gap.reversed(),
                SaidWrongly::GapTurnedAt(_) => {}
                SaidWrongly::DepthPositive if contact.gap.is_negative() => contact.gap = Sign::Positive,
                SaidWrongly::DepthPositive => {}
                SaidWrongly::EntranceExchanged => {
                    contact.entrance = Entrance::of_kind(entrance.kind(), entrance.swapped().numbers());
                }
                SaidWrongly::EntranceRenamed => {
                    contact.entrance = Entrance::of_kind(entrance.swapped().kind(), entrance.numbers());
                }
                SaidWrongly::NormalTurned
                | SaidWrongly::Millimetres
                | SaidWrongly::Squared
                | SaidWrongly::Touching(_) => return None,
            }
        }
        Some(contacts)
    }

    fn says_state(&self, asked: &Asked<'_>, said: ReportedState) -> Option<bool> {
        let blocks = &asked.question.blocks;
        let meant = match self {
            SaidWrongly::GapTurned => ReportedState { gap_m: said.gap_m.map(|gap| -gap), ..said },
            SaidWrongly::DepthPositive if said.state == SeparationState::Overlapping => {
                ReportedState { gap_m: said.gap_m.map(|gap| -gap), ..said }
            }
            SaidWrongly::NormalTurned => ReportedState { normal: said.normal.map(|normal| normal.map(|c| -c)), ..said },
            SaidWrongly::Millimetres => ReportedState { gap_m: said.gap_m.map(|gap| gap / 1000.0), ..said },
            SaidWrongly::Squared => {
                let root = |gap: f64| gap.abs().sqrt();
                let sign = if said.state == SeparationState::Overlapping { -1.0 } else { 1.0 };
                ReportedState { gap_m: said.gap_m.map(|gap| sign * root(gap)), ..said }
            }
            SaidWrongly::Touching(called) => {
                let (precision, accuracy) = (asked.question.precision, asked.question.accuracy);
                let (wrong, comparison) = CollisionQuery { blocks, precision, accuracy }.compare(said)?;
                return Some(match comparison.exact {
                    SeparationState::Touching => said.state == *called,
                    _ => wrong.is_none(),
                });
            }
            SaidWrongly::DepthPositive => said,
            SaidWrongly::GapTurnedAt(_) | SaidWrongly::EntranceExchanged | SaidWrongly::EntranceRenamed => return None,
        };
        asked.state_is_right(blocks, meant)
    }
}
