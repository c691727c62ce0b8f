//! How much external engines say of the contacts that they name: what they leave unsaid is not compared, and people must know of how many.

use rockproof_model::text::noun;
use serde::{Deserialize, Serialize};

/// How much an engine from outside said of the contacts in its answers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactDetail {
    /// Contacts that it named.
    pub contacts: u64,
    /// Those with an entrance, and so with the sign of the gap: neither is read without the other.
    pub entrances: u64,
    /// Those with `gap_m`, of which the sign alone is compared.
    pub gap_m: u64,
}

impl ContactDetail {
    /// What came on top of `before`.
    #[must_use]
    pub fn since(self, before: ContactDetail) -> ContactDetail {
        ContactDetail {
            contacts: self.contacts.saturating_sub(before.contacts),
            entrances: self.entrances.saturating_sub(before.entrances),
            gap_m: self.gap_m.saturating_sub(before.gap_m),
        }
    }

    /// The sums of both.
    #[must_use]
    pub fn plus(self, other: ContactDetail) -> ContactDetail {
        ContactDetail {
            contacts: self.contacts.saturating_add(other.contacts),
            entrances: self.entrances.saturating_add(other.entrances),
            gap_m: self.gap_m.saturating_add(other.gap_m),
        }
    }

    /// For how many contacts entrances and signs of gaps were given, of how many.
    pub fn share_note(self) -> String {
        format!("{} of {} {}", self.entrances, self.contacts, noun(self.contacts, "contact", "contacts"))
    }

    /// The same in words.
    pub fn note(self) -> String {
        format!("entrances and signs of gaps given for {}", self.share_note())
    }

    /// The same, where that is not all.
    pub fn incomplete_note(self) -> Option<String> {
        (self.entrances < self.contacts).then(|| self.note())
    }

    /// Whether entrances are given for a smaller share of the contacts than before, or no contacts are named any more. Of other pairs the share may
    /// be another by chance: there it is less where it was all and is not, or is none and was not.
    pub fn says_less_than(self, before: ContactDetail, same_pairs: bool) -> bool {
        let given = |detail: ContactDetail, of: ContactDetail| u128::from(detail.entrances) * u128::from(of.contacts);
        let is_smaller = given(self, before) < given(before, self);
        let is_certain = same_pairs || before.entrances == before.contacts || self.entrances == 0;
        (before.contacts > 0 && self.contacts == 0) || (is_smaller && is_certain)
    }
}
