//! A path that says otherwise than the fast one: its row, and the file that brings the pair back.

use super::compare::Deviation;
use super::paths::{PathName, Question};
use rockproof_differential::case_file::{Case, CaseDescription, ContactRow, contact_rows};
use rockproof_differential::compare::{AnswerChange, Features, differences};
use rockproof_differential::finding::{Cause, FindingScope};
use rockproof_model::Contact;
use rockproof_model::text::{EXCERPT_LENGTH, csv_cell, excerpt};
use rockproof_pairs::batch::PairCase;
use rockproof_results::bounded;
use serde::{Deserialize, Serialize};

/// One row of `disagreements.csv`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct DisagreementRow {
    /// The seed of the comparison.
    pub seed: u64,
    /// The pair's number.
    pub index: u64,
    /// Its family.
    pub family: String,
    /// How it came about.
    pub form: String,
    /// The tolerance set.
    pub tolerances: String,
    /// `exact`, or `f32` where the pair is taken as an engine in f32 sees it.
    pub input: String,
    /// Who says otherwise than the fast path; `fast` where that gives no answer.
    pub path: String,
    /// The first difference; `failure` where the path gives no contacts, or the right ones and says something wrong of them.
    pub change: String,
    /// The kind of the contact that it is about.
    pub kind: String,
    /// What else there is to say.
    pub note: String,
    /// The case file, by its path in the directory; empty where there is none.
    pub case: String,
}

/// The columns of `disagreements.csv`.
pub const DISAGREEMENT_COLUMNS: [&str; 11] =
    ["seed", "index", "family", "form", "tolerances", "input", "path", "change", "kind", "note", "case"];

/// A path that says otherwise than the fast one about a pair of a seed.
#[derive(Clone, Debug)]
pub struct Disagreement {
    row: DisagreementRow,
    case: Case,
}

impl Disagreement {
    /// What a deviation about a pair, its seed and its tolerance set amount to.
    pub(super) fn of(
        (seed, pair, set): (u64, &PairCase, &str),
        question: Question<'_>,
        deviation: Deviation,
    ) -> Disagreement {
        let Question { a, b, tolerances } = question;
        let features = Features { a: a.topology(), b: b.topology() };
        let changed = |found: &Vec<Contact>| differences(&deviation.expected, found, features).into_iter().next();
        let first = deviation.found.as_ref().and_then(changed);
        let change = first.map_or(AnswerChange::Failure, |difference| difference.change).name().to_owned();
        let kind = first.map_or(String::new(), |difference| difference.kinds());
        let row = DisagreementRow {
            seed,
            index: pair.index,
            family: pair.family.to_owned(),
            form: pair.form.name().to_owned(),
            tolerances: set.to_owned(),
            input: "exact".to_owned(),
            path: deviation.path.name().to_owned(),
            change: change.clone(),
            kind: kind.clone(),
            note: deviation.note.as_deref().map_or(String::new(), |note| csv_cell(&excerpt(note, EXCERPT_LENGTH))),
            case: String::new(),
        };
        let about = CaseDescription {
            // The exact answer to the pair as it stands is what the case expects; no rounding comes into it.
            engine: FindingScope::Any.to_string(),
            cause: Cause::Defect.name().to_owned(),
            change,
            kind,
            predicate: String::new(),
            features: String::new(),
            margin: None,
            margin_ulps: None,
            origin: format!("{} {} under {set}, seed {seed}, index {}", row.family, row.form, row.index),
            note: Some(note(deviation.path, deviation.note.as_deref())),
            check: None,
            states: None,
            found_state: None,
            expected: contact_rows(&deviation.expected),
            found: contact_rows(deviation.found.as_deref().unwrap_or_default()),
            changed: None,
        };
        let case = Case { about, a: a.clone(), b: b.clone(), tolerances: tolerances.clone() };
        Disagreement { row, case }
    }

    /// The same of a pair as an engine in f32 sees it.
    pub(super) fn in_f32(mut self) -> Disagreement {
        self.row.input = "f32".to_owned();
        self.case.about.origin += ", rounded to f32";
        self
    }

    /// Its row without a case file.
    pub fn row(&self) -> &DisagreementRow {
        &self.row
    }

    /// Its row with a case file.
    pub(super) fn into_row(self, case: String) -> DisagreementRow {
        DisagreementRow { case, ..self.row }
    }

    /// The name and the text of its case file, which can be read again; a mistaken path may name contacts of features that there are not, which no case may
    /// hold. `None` where not even the blocks and the tolerances make one.
    pub(super) fn case_file(&self) -> Option<(String, String)> {
        let none: Vec<ContactRow> = Vec::new();
        let without = |expected: &[ContactRow], found: &[ContactRow]| {
            let mut case = self.case.clone();
            (case.about.expected, case.about.found) = (expected.to_vec(), found.to_vec());
            let text = case.to_toml().ok()?;
            Case::from_toml(&text, String::new()).ok().map(|_| text)
        };
        let (expected, found) = (&self.case.about.expected, &self.case.about.found);
        let text = without(expected, found).or_else(|| without(expected, &none)).or_else(|| without(&none, found));
        let text = text.or_else(|| without(&none, &none))?;
        let input = if self.row.input == "exact" { "" } else { "-f32" };
        let stem = format!("{}-{}-{}{input}", self.row.path, self.row.family, self.row.index);
        Some((format!("{}.toml", bounded(&stem.replace('_', "-"))), text))
    }
}

/// What a case says of who deviates.
fn note(path: PathName, more: Option<&str>) -> String {
    let who = match path {
        PathName::Fast => "the fast path gives no answer",
        PathName::Wide => "found by the stepper in 512 bits; expected is the fast path's answer",
        PathName::Settled => {
            "found by the stepper in 512 bits without counting comparisons; expected is the fast path's answer"
        }
        PathName::Plain => "found by the plain path; expected is the fast path's answer",
        PathName::Gmp => "found by the plain path in GMP; expected is the fast path's answer",
    };
    more.map_or(who.to_owned(), |more| format!("{who}: {}", excerpt(more, EXCERPT_LENGTH)))
}
