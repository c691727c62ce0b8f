//! What a case says of the finding that it keeps.

use super::ContactRow;
use crate::compare::AnswerChange;
use rockproof_model::{Contact, ContactKey};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;

/// What a case is about, as written in the file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CaseDescription {
    /// An engine's name, `f32` or `f64` for every engine that rounds to it, or `any`.
    pub engine: String,
    /// The cause.
    pub cause: String,
    /// The change.
    pub change: String,
    /// The kind of the contact it is about, or `v-v to v-e` where the kind changed; empty where any will do.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub kind: String,
    /// The deciding predicate, under the cause `engine` the one nearest to a tie; empty where no trace tells.
    #[serde(default)]
    pub predicate: String,
    /// The features it was asked of.
    #[serde(default)]
    pub features: String,
    /// Its exact relative margin; 0 is a tie.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub margin: Option<f64>,
    /// The margin in units of the engine's roundoff.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub margin_ulps: Option<f64>,
    /// Where it came from: family, form, tolerance set, seed and index.
    #[serde(default)]
    pub origin: String,
    /// What the engine said when it gave no answer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub note: Option<String>,
    /// How the pair was changed (`swap`, `renumber`, `translate`, `scale`, `far-block`) where the engine gave no usable answer only then.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub check: Option<String>,
    /// How the blocks lie and how the engine says they do, where it says only that: `apart 0.5, said overlapping -0.1`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub states: Option<String>,
    /// What such an engine says of the pair as it stands, where the case is about the same pair changed. Cases of earlier versions do not tell.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub found_state: Option<String>,
    /// The contacts before the link that is the cause: under tolerance the exact ones without tolerances, under
    /// representation the exact ones of the exact input, else the exact ones of the rounded input.
    pub expected: Vec<ContactRow>,
    /// The contacts after it.
    pub found: Vec<ContactRow>,
    /// What an external engine said of the pair exchanged, numbered otherwise, moved or scaled, in the numbering of the pair itself, where it contradicts itself so.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub changed: Option<Vec<ContactRow>>,
}

impl CaseDescription {
    /// What the engine said of how the blocks lie, as [`ReportedState`](crate::separation_state::ReportedState) is shown.
    pub fn said_state(&self) -> Option<&str> {
        self.states.as_deref()?.split_once(", said ").map(|(_, said)| said)
    }

    /// Whether it is about an engine that says only how blocks lie, and otherwise once the pair is changed.
    pub fn is_contradiction_of_states(&self) -> bool {
        self.states.is_some() && AnswerChange::from_name(&self.change).is_some_and(AnswerChange::is_metamorphic)
    }

    /// Whether it may have `found_state`.
    pub(super) fn can_have_found_state(&self) -> bool {
        self.check.is_some() || self.is_contradiction_of_states()
    }

    /// How the pair is changed that it is about; `None` where it is about the pair as it stands.
    pub fn checked_change(&self) -> Option<AnswerChange> {
        let name = self.check.as_ref().unwrap_or(&self.change);
        AnswerChange::from_name(name).filter(|change| change.is_metamorphic())
    }

    /// The contacts of all lists, each with the key of its list and its place there.
    pub(super) fn rows(&self) -> impl Iterator<Item = (&'static str, usize, &ContactRow)> {
        let changed = self.changed.as_deref().unwrap_or_default();
        let lists = [("expected", &self.expected[..]), ("found", &self.found), ("changed", changed)];
        lists.into_iter().flat_map(|(list, rows)| rows.iter().enumerate().map(move |(at, row)| (list, at, row)))
    }

    /// The contacts that both answers name, and name differently.
    pub fn differing_contacts(&self) -> BTreeSet<ContactKey> {
        let contacts = |rows: &[ContactRow]| -> Vec<Contact> { rows.iter().filter_map(ContactRow::contact).collect() };
        let found = contacts(&self.found);
        let differs = |right: &Contact| found.iter().any(|one| one.key == right.key && one != right);
        contacts(&self.expected).into_iter().filter(differs).map(|contact| contact.key).collect()
    }
}
