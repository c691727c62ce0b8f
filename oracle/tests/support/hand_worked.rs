//! Pairs whose contacts were worked out by hand from SPEC section 4, each with its derivation.
//!
//! Unless a case says otherwise: s = 1/10, r = 1/50, g = 1/20, so = sp = ε = 0, `revised`; A is the upper block. With
//! so = 0 a cone passes a plane when no edge at the vertex descends below it, and every plane that passes is a true exit.

mod concave;
mod criteria;
mod exits;
mod kept;
mod kinds;
mod measures;
mod ties;
mod true_exits;

use super::shapes::exact;
use num_rational::BigRational;
use rockproof_model::{Block, Contact, ContactKey, ContactKind, Entrance, EntranceKind, Sign, ToleranceSet};

/// A pair with the contacts it must have.
pub(crate) struct Case {
    /// Unique among the cases.
    pub(crate) name: &'static str,
    /// How the contacts follow from SPEC section 4.
    pub(crate) derivation: &'static str,
    pub(crate) a: Block,
    pub(crate) b: Block,
    pub(crate) tolerances: ToleranceSet,
    /// The contacts that the step before left closed.
    pub(crate) kept: Vec<ContactKey>,
    pub(crate) expected: Vec<Row>,
}

/// An expected contact: kind, feature of A, feature of B; entrance kind, its features; `h·|h|` of the gap h in m².
pub(crate) type Row = (&'static str, u32, u32, &'static str, u32, u32, &'static str);

impl Case {
    /// The expected contacts, each with the square of its gap.
    pub(crate) fn contacts(&self) -> Vec<(Contact, BigRational)> {
        self.expected.iter().map(contact).collect()
    }
}

fn contact(&(kind, a, b, entrance, entrance_a, entrance_b, gap): &Row) -> (Contact, BigRational) {
    let (gap_sign, squared) = match gap.split_at(1) {
        ("-", squared) => (Sign::Negative, exact(squared)),
        ("+", squared) => (Sign::Positive, exact(squared)),
        _ => (Sign::Zero, exact(gap)),
    };
    let kind = ContactKind::from_name(kind).unwrap();
    let entrance = Entrance::of_kind(EntranceKind::from_name(entrance).unwrap(), [entrance_a, entrance_b]);
    (Contact { key: ContactKey::of_kind(kind, [a, b]), entrance, gap: gap_sign }, squared)
}

/// All hand-worked cases.
pub(crate) fn cases() -> Vec<Case> {
    [
        kinds::cases(),
        ties::cases(),
        criteria::cases(),
        measures::cases(),
        concave::cases(),
        exits::cases(),
        true_exits::cases(),
        kept::cases(),
    ]
    .into_iter()
    .flatten()
    .collect()
}
