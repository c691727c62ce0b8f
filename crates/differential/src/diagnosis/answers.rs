//! Hypotheses about how right answers are said wrongly: signs, entrances, normals, units.

use super::hypothesis::Hypothesis;
use super::question::{PreparedQuestion, Reply};
use crate::separation_state::{ReportedState, SeparationState};
use rockproof_model::decision::Feature;
use rockproof_model::{Contact, ContactKey, Entrance, EntranceKind, Sign};

/// No contact is reported, whatever the blocks do.
struct NoContacts;

impl Hypothesis for NoContacts {
    fn name(&self) -> String {
        "no-contacts".to_owned()
    }

    fn sentence(&self) -> String {
        "but that no contact at all is reported".to_owned()
    }

    fn contacts(&self, _: &PreparedQuestion<'_>) -> Option<Vec<Contact>> {
        Some(Vec::new())
    }
}

/// No more than so many contacts of a pair are listed, whichever: an array is full.
struct AtMost(usize);

/// The largest such array that is looked for.
const LARGEST_ARRAY: usize = 16;

impl Hypothesis for AtMost {
    fn name(&self) -> String {
        format!("at-most-{}-contacts", self.0)
    }

    fn sentence(&self) -> String {
        let noun = if self.0 == 1 { "contact" } else { "contacts" };
        format!("but that no more than {} {noun} of a pair are listed", self.0)
    }

    /// Those that it lists, if they are as many as there may be.
    fn contacts(&self, asked: &PreparedQuestion<'_>) -> Option<Vec<Contact>> {
        let exact = asked.exact();
        let Reply::Contacts(said) = &asked.question.reply else { return None };
        if exact.len() <= self.0 {
            return Some(exact.to_vec());
        }
        let is_listed = |contact: &&Contact| said.iter().any(|one| one.key == contact.key);
        let listed: Vec<Contact> = exact.iter().filter(is_listed).copied().collect();
        Some(if listed.len() == self.0 { listed } else { exact[..self.0].to_vec() })
    }

    fn leaves_open(&self) -> bool {
        true
    }
}

/// What is said wrongly.
#[derive(Clone, Copy, Debug)]
enum WrongReply {
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
    /// Features numbered from 1.
    FromOne(Numbered),
    /// A normal of length 0.
    NormalZero,
    /// The gap in a unit of which so many make a metre.
    Unit(u16),
    /// The gap's square.
    Squared,
    /// Blocks that touch are said to lie so.
    Touching(SeparationState),
}

/// Which features are numbered from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Numbered {
    All,
    Vertices,
    Edges,
    Faces,
}

impl Numbered {
    fn name(self) -> &'static str {
        match self {
            Numbered::All => "features",
            Numbered::Vertices => "vertices",
            Numbered::Edges => "edges",
            Numbered::Faces => "faces",
        }
    }

    /// The numbers that features have then.
    fn next(self, features: [Feature; 2]) -> [u32; 2] {
        features.map(|feature| {
            let (of, number) = match feature {
                Feature::Vertex(_, v) => (Numbered::Vertices, v.index()),
                Feature::Edge(_, e) => (Numbered::Edges, e.index()),
                Feature::Face(_, f) => (Numbered::Faces, f.index()),
            };
            number as u32 + u32::from(self == Numbered::All || self == of)
        })
    }
}

/// The hypothesis that needs no other: nothing is reported. Tolerances, rules and kinds left out come to the same for many pairs.
pub(super) fn simplest() -> Box<dyn Hypothesis> {
    Box::new(NoContacts)
}

/// The hypotheses about what is said wrongly.
pub(super) fn all() -> impl Iterator<Item = Box<dyn Hypothesis>> {
    let planes = [EntranceKind::VertexFace, EntranceKind::FaceVertex, EntranceKind::EdgeEdge];
    let touching = [SeparationState::Apart, SeparationState::Overlapping].map(WrongReply::Touching);
    let others = [
        WrongReply::DepthPositive,
        WrongReply::EntranceExchanged,
        WrongReply::EntranceRenamed,
        WrongReply::NormalTurned,
        WrongReply::FromOne(Numbered::All),
        WrongReply::FromOne(Numbered::Vertices),
        WrongReply::FromOne(Numbered::Edges),
        WrongReply::FromOne(Numbered::Faces),
        WrongReply::NormalZero,
        WrongReply::Unit(1000),
        WrongReply::Unit(100),
        WrongReply::Squared,
    ];
    let turned = std::iter::once(WrongReply::GapTurned).chain(planes.map(WrongReply::GapTurnedAt));
    let wrong = turned.chain(others).chain(touching).map(|said| Box::new(said) as Box<dyn Hypothesis>);
    wrong.chain((1..=LARGEST_ARRAY).map(|most| Box::new(AtMost(most)) as Box<dyn Hypothesis>))
}

impl Hypothesis for WrongReply {
    fn name(&self) -> String {
        match self {
            WrongReply::GapTurned => "gap-sign-turned".to_owned(),
            WrongReply::GapTurnedAt(kind) => format!("gap-sign-turned-at-{kind}"),
            WrongReply::DepthPositive => "depth-positive".to_owned(),
            WrongReply::EntranceExchanged => "entrance-exchanged".to_owned(),
            WrongReply::EntranceRenamed => "entrance-renamed".to_owned(),
            WrongReply::NormalTurned => "normal-turned".to_owned(),
            WrongReply::FromOne(Numbered::All) => "numbered-from-1".to_owned(),
            WrongReply::FromOne(numbered) => format!("{}-numbered-from-1", numbered.name()),
            WrongReply::NormalZero => "normal-zero".to_owned(),
            WrongReply::Unit(of_metre) => format!("gap-in-{}", unit(*of_metre)),
            WrongReply::Squared => "gap-squared".to_owned(),
            WrongReply::Touching(state) => format!("touching-is-{state}"),
        }
    }

    fn sentence(&self) -> String {
        match self {
            WrongReply::GapTurned => "with the sign of every gap turned".to_owned(),
            WrongReply::GapTurnedAt(kind) => format!("with the sign of the gap turned where the entrance is {kind}"),
            WrongReply::DepthPositive => "with overlaps given as positive gaps".to_owned(),
            WrongReply::EntranceExchanged => "with the features of the entrance exchanged".to_owned(),
            WrongReply::EntranceRenamed => "with entrances v-f called f-v and f-v called v-f".to_owned(),
            WrongReply::NormalTurned => "with the normal turned round: it points from A to B".to_owned(),
            WrongReply::FromOne(numbered) => format!("with {} numbered from 1 instead of 0", numbered.name()),
            WrongReply::NormalZero => "with a normal of length 0".to_owned(),
            WrongReply::Unit(of_metre) => format!("with the gap in {}", unit(*of_metre)),
            WrongReply::Squared => "with the square of the gap in place of the gap".to_owned(),
            WrongReply::Touching(state) => format!("but for blocks that touch, which are called {state}"),
        }
    }

    fn contacts(&self, asked: &PreparedQuestion<'_>) -> Option<Vec<Contact>> {
        let mut contacts = asked.exact().to_vec();
        for contact in &mut contacts {
            let entrance = contact.entrance;
            match self {
                WrongReply::GapTurned => contact.gap = contact.gap.reversed(),
                WrongReply::GapTurnedAt(kind) if *kind == entrance.kind() => contact.gap = contact.gap.reversed(),
                WrongReply::GapTurnedAt(_) => {}
                WrongReply::DepthPositive if contact.gap.is_negative() => contact.gap = Sign::Positive,
                WrongReply::DepthPositive => {}
                WrongReply::EntranceExchanged => {
                    contact.entrance = Entrance::of_kind(entrance.kind(), entrance.swapped().numbers());
                }
                WrongReply::EntranceRenamed => {
                    contact.entrance = Entrance::of_kind(entrance.swapped().kind(), entrance.numbers());
                }
                WrongReply::FromOne(numbered) => {
                    contact.key = ContactKey::of_kind(contact.key.kind(), numbered.next(contact.key.features()));
                    contact.entrance = Entrance::of_kind(entrance.kind(), numbered.next(entrance.features()));
                }
                WrongReply::NormalZero
                | WrongReply::NormalTurned
                | WrongReply::Unit(_)
                | WrongReply::Squared
                | WrongReply::Touching(_) => {
                    return None;
                }
            }
        }
        Some(contacts)
    }

    fn says_state(&self, asked: &PreparedQuestion<'_>, said: ReportedState) -> Option<bool> {
        let meant = match self {
            WrongReply::GapTurned => ReportedState { gap_m: said.gap_m.map(|gap| -gap), ..said },
            WrongReply::DepthPositive if said.state == SeparationState::Overlapping => {
                ReportedState { gap_m: said.gap_m.map(|gap| -gap), ..said }
            }
            WrongReply::NormalTurned => ReportedState { normal: said.normal.map(|normal| normal.map(|c| -c)), ..said },
            WrongReply::NormalZero if said.normal.is_none_or(|normal| normal.iter().any(|&part| part != 0.0)) => said,
            WrongReply::NormalZero => ReportedState { normal: None, ..said },
            WrongReply::Unit(of_metre) => {
                ReportedState { gap_m: said.gap_m.map(|gap| gap / f64::from(*of_metre)), ..said }
            }
            WrongReply::Squared => {
                let root = |gap: f64| gap.abs().sqrt();
                let sign = if said.state == SeparationState::Overlapping { -1.0 } else { 1.0 };
                ReportedState { gap_m: said.gap_m.map(|gap| sign * root(gap)), ..said }
            }
            WrongReply::Touching(called) => {
                let (wrong, comparison) = asked.compare_state(said, asked.question.accuracy)?;
                return Some(match comparison.exact {
                    SeparationState::Touching => said.state == *called,
                    _ => wrong.is_none(),
                });
            }
            WrongReply::DepthPositive => said,
            WrongReply::GapTurnedAt(_)
            | WrongReply::EntranceExchanged
            | WrongReply::EntranceRenamed
            | WrongReply::FromOne(_) => return None,
        };
        asked.state_is_right(meant)
    }
}

/// The name of a unit of which so many make a metre.
fn unit(of_metre: u16) -> &'static str {
    if of_metre == 100 { "centimetres" } else { "millimetres" }
}
