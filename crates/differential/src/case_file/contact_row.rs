//! Contacts in case files.

use rockproof_model::{Contact, ContactKey, ContactKind, Entrance, EntranceKind, Sign};
use serde::{Deserialize, Serialize};
use std::fmt;

/// A contact as written in files; the names are those of `classify`'s columns.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ContactRow {
    kind: String,
    feature_a: u32,
    feature_b: u32,
    entrance: String,
    entrance_a: u32,
    entrance_b: u32,
    gap_sign: i8,
}

impl From<&Contact> for ContactRow {
    fn from(c: &Contact) -> ContactRow {
        let ([feature_a, feature_b], [entrance_a, entrance_b]) = (c.key.numbers(), c.entrance.numbers());
        ContactRow {
            kind: c.kind().name().to_owned(),
            feature_a,
            feature_b,
            entrance: c.entrance.kind().name().to_owned(),
            entrance_a,
            entrance_b,
            gap_sign: c.gap.as_i8(),
        }
    }
}

impl ContactRow {
    /// The contact, or `None` if a name or sign is not one.
    pub fn contact(&self) -> Option<Contact> {
        let key = ContactKey::of_kind(ContactKind::from_name(&self.kind)?, [self.feature_a, self.feature_b]);
        let entrance = Entrance::of_kind(EntranceKind::from_name(&self.entrance)?, [self.entrance_a, self.entrance_b]);
        let gap = match self.gap_sign {
            -1 => Sign::Negative,
            0 => Sign::Zero,
            1 => Sign::Positive,
            _ => return None,
        };
        Some(Contact { key, entrance, gap })
    }
}

impl fmt::Display for ContactRow {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ContactRow { kind, feature_a, feature_b, entrance, entrance_a, entrance_b, gap_sign } = self;
        write!(f, "{kind} {feature_a}/{feature_b} by {entrance} {entrance_a}/{entrance_b}, gap sign {gap_sign}")
    }
}

/// The rows of a list of contacts.
pub fn contact_rows(contacts: &[Contact]) -> Vec<ContactRow> {
    contacts.iter().map(ContactRow::from).collect()
}
