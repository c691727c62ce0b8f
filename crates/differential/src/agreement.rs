//! How often two links of the chain of SPEC section 6 agree, and which kind of contact became which: the counts behind
//! `agreement.csv` and `confusion.csv`. Findings say what differs; these say of how many.

use super::agreement_record::{AgreementRecord, RecordedRow};
use super::answer_detail::AnswerDetail;
use super::row::{named, written};
use rockproof_model::text::noun;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize};
use std::collections::BTreeMap;

rockproof_model::named_enum! {
    /// Which two links of the chain are compared.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    pub enum ChainSpan: from_name, Display {
        /// From the ideal tolerances to the given ones, both exact.
        Tolerance = "tolerance",
        /// From the exact input to the rounded one, both classified exactly.
        Representation = "representation",
        /// From the exact to the engine's classification of the rounded input.
        Arithmetic = "arithmetic",
        /// From the exact classification of the exact input to the engine's of the rounded one: all that an engine's user sees.
        Whole = "whole",
    }
}

/// What was compared: under which set, which links, and for whom: `f32` or `f64` up to the rounded input, then an engine.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct ComparisonKey {
    /// The tolerance set.
    pub tolerances: String,
    /// The links.
    pub span: ChainSpan,
    /// The precision or the engine.
    pub engine: String,
}

/// Counts over pairs. A contact that is there on both sides, features and all, is *kept*.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct AgreementCounts {
    /// Pairs compared, those without an answer too.
    pub pairs: u64,
    /// Pairs with the same answer on both sides: contacts, kinds, features, entrances and signs of gaps.
    pub agreeing: u64,
    /// Pairs without an answer on the later side.
    pub silent: u64,
    /// Contacts on the earlier side.
    pub contacts: u64,
    /// Kept contacts with another entrance.
    pub entrance: u64,
    /// Kept contacts with the same entrance whose gap has another sign.
    pub gap_sign: u64,
    /// Σ of a² over batches, with a the agreeing pairs of a batch. Pairs of a batch share their blocks, so they agree or
    /// differ together; this and the next two say how much less they tell than as many independent ones.
    pub agreeing_squared: u64,
    /// Σ of a·n over batches, with n the pairs of a batch.
    pub agreeing_times_pairs: u64,
    /// Σ of n² over batches.
    pub pairs_squared: u64,
}

impl AgreementCounts {
    /// Adds the counts of other pairs.
    pub fn add(&mut self, other: &AgreementCounts) {
        let AgreementCounts { pairs, agreeing, silent, contacts, entrance, gap_sign, .. } = *other;
        self.pairs += pairs;
        self.agreeing += agreeing;
        self.silent += silent;
        self.contacts += contacts;
        self.entrance += entrance;
        self.gap_sign += gap_sign;
        self.agreeing_squared += other.agreeing_squared;
        self.agreeing_times_pairs += other.agreeing_times_pairs;
        self.pairs_squared += other.pairs_squared;
    }
}

/// How many pairs an engine answered; a pair counts once for each tolerance set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EngineAnswers {
    /// Pairs that it answered.
    pub answered: u64,
    /// Pairs that it was asked about.
    pub asked: u64,
    /// Pairs whose contacts it named; of the others that it answered it said only how the blocks lie.
    pub with_contacts: u64,
    /// How much it said in all its answers, those to changed pairs among them.
    pub detail: AnswerDetail,
}

impl EngineAnswers {
    /// Adds the answers to other pairs.
    pub fn add(&mut self, other: EngineAnswers) {
        self.answered += other.answered;
        self.asked += other.asked;
        self.with_contacts += other.with_contacts;
        self.detail = self.detail.plus(other.detail);
    }

    /// Adds what a row of `agreement.csv` says of the engine: its pairs, and those without an answer.
    pub fn add_row(&mut self, span: ChainSpan, [pairs, silent]: [u64; 2]) {
        let answered = pairs.saturating_sub(silent);
        match span {
            ChainSpan::Arithmetic => {
                self.asked += pairs;
                self.answered += answered;
            }
            // Only contacts are compared along the whole chain.
            ChainSpan::Whole => self.with_contacts += answered,
            ChainSpan::Tolerance | ChainSpan::Representation => {}
        }
    }

    /// Whether it answered less than half: what was compared then says next to nothing.
    pub fn are_too_few(self) -> bool {
        self.answered < self.asked - self.answered
    }

    /// How many it answered, in words.
    pub fn words(self) -> String {
        let detail = self.detail.incomplete_note().map_or(String::new(), |note| format!(", {note}"));
        format!("answered {} of {} {}{detail}", self.answered, self.asked, noun(self.asked, "pair", "pairs"))
    }
}

/// How a contact, or a pair where an engine says only that, was before and after: kinds of contact or states of a pair;
/// `none` for a contact that is not there.
type Transition = (String, String);

/// No contact.
pub const NONE: &str = "none";

/// All counts of a campaign. Adding is commutative; the order of rows is that of their keys.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "AgreementRows", into = "AgreementRows")]
pub struct Agreement {
    counts: BTreeMap<(String, ComparisonKey), AgreementCounts>,
    confusion: BTreeMap<(ComparisonKey, Transition), u64>,
}

/// The counts as lists, for JSON.
#[derive(Serialize, Deserialize)]
struct AgreementRows {
    counts: Vec<(String, ComparisonKey, AgreementCounts)>,
    confusion: Vec<(ComparisonKey, Transition, u64)>,
}

impl From<AgreementRows> for Agreement {
    fn from(rows: AgreementRows) -> Agreement {
        Agreement {
            counts: rows.counts.into_iter().map(|(family, compared, counts)| ((family, compared), counts)).collect(),
            confusion: rows.confusion.into_iter().map(|(compared, became, n)| ((compared, became), n)).collect(),
        }
    }
}

impl From<Agreement> for AgreementRows {
    fn from(agreement: Agreement) -> AgreementRows {
        AgreementRows {
            counts: agreement.counts.into_iter().map(|((family, compared), c)| (family, compared, c)).collect(),
            confusion: agreement.confusion.into_iter().map(|((compared, became), n)| (compared, became, n)).collect(),
        }
    }
}

/// The columns of `agreement.csv`.
pub const AGREEMENT_COLUMNS: [&str; 13] = [
    "family",
    "tolerances",
    "span",
    "engine",
    "pairs",
    "agreeing",
    "silent",
    "contacts",
    "entrance",
    "gap_sign",
    "agreeing_squared",
    "agreeing_times_pairs",
    "pairs_squared",
];

/// The columns of `confusion.csv`: so many contacts of kind `before` became kind `after`.
pub const CONFUSION_COLUMNS: [&str; 6] = ["tolerances", "span", "engine", "before", "after", "contacts"];

fn span<'d, D: Deserializer<'d>>(deserializer: D) -> Result<ChainSpan, D::Error> {
    let text = String::deserialize(deserializer)?;
    ChainSpan::from_name(&text).ok_or_else(|| {
        let allowed = ChainSpan::ALL.map(ChainSpan::name).join(", ");
        D::Error::custom(format!("span is \"{text}\", which is none of {allowed}"))
    })
}

/// A row of `agreement.csv`; the fields are its columns, and so are those of [`AgreementCounts`].
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct AgreementRow {
    /// The family.
    #[serde(deserialize_with = "named")]
    pub family: String,
    /// The tolerance set.
    #[serde(deserialize_with = "named")]
    pub tolerances: String,
    /// Which links are compared.
    #[serde(deserialize_with = "span")]
    pub span: ChainSpan,
    /// The precision or the engine.
    #[serde(deserialize_with = "named")]
    pub engine: String,
    /// How often they agree.
    pub counts: AgreementCounts,
}

impl AgreementRow {
    fn new(family: &str, compared: &ComparisonKey, counts: AgreementCounts) -> AgreementRow {
        let ComparisonKey { tolerances, span, engine } = compared.clone();
        AgreementRow { family: family.to_owned(), tolerances, span, engine, counts }
    }

    /// What was compared.
    pub fn key(&self) -> ComparisonKey {
        ComparisonKey { tolerances: self.tolerances.clone(), span: self.span, engine: self.engine.clone() }
    }
}

/// A row of `confusion.csv`; the fields are its columns.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ConfusionRow {
    /// The tolerance set.
    #[serde(deserialize_with = "named")]
    pub tolerances: String,
    /// Which links are compared.
    #[serde(deserialize_with = "span")]
    pub span: ChainSpan,
    /// The precision or the engine.
    #[serde(deserialize_with = "named")]
    pub engine: String,
    /// The kind of contact, or the state of the pair, before; [`NONE`] where there is no contact.
    #[serde(deserialize_with = "named")]
    pub before: String,
    /// The same after.
    #[serde(deserialize_with = "named")]
    pub after: String,
    /// How many became so.
    pub contacts: u64,
}

impl Agreement {
    /// What an engine was asked and answered.
    pub fn answers(&self, engine: &str) -> EngineAnswers {
        let mut answers = EngineAnswers::default();
        for ((_, key), counts) in self.counts.iter().filter(|((_, key), _)| key.engine == engine) {
            answers.add_row(key.span, [counts.pairs, counts.silent]);
        }
        answers
    }

    /// Adds the counts of `other`.
    pub fn add(&mut self, other: Agreement) {
        for (key, counts) in other.counts {
            self.counts.entry(key).or_default().add(&counts);
        }
        for (key, times) in other.confusion {
            *self.confusion.entry(key).or_default() += times;
        }
    }

    /// Adds the comparisons of some pairs.
    pub fn add_record(&mut self, record: AgreementRecord) {
        for row in record.rows {
            let RecordedRow { family, tolerances, span, engine, counts, transitions } = row;
            let compared = ComparisonKey { tolerances: tolerances.to_string(), span, engine: engine.into() };
            for ([before, after], times) in transitions {
                let key = (compared.clone(), (before.to_owned(), after.to_owned()));
                *self.confusion.entry(key).or_default() += times;
            }
            self.counts.entry((family.to_string(), compared)).or_default().add(&counts);
        }
    }

    /// Makes all that was added so far one batch.
    pub fn close_batch(&mut self) {
        for counts in self.counts.values_mut() {
            counts.agreeing_squared = counts.agreeing * counts.agreeing;
            counts.agreeing_times_pairs = counts.agreeing * counts.pairs;
            counts.pairs_squared = counts.pairs * counts.pairs;
        }
    }

    /// `agreement.csv`.
    ///
    /// # Errors
    /// Those of the CSV writer.
    pub fn to_csv(&self) -> Result<Vec<u8>, csv::Error> {
        let rows = self.counts.iter().map(|((family, compared), counts)| AgreementRow::new(family, compared, *counts));
        written(&AGREEMENT_COLUMNS, rows)
    }

    /// `confusion.csv`.
    ///
    /// # Errors
    /// Those of the CSV writer.
    pub fn confusion_to_csv(&self) -> Result<Vec<u8>, csv::Error> {
        let row = |((compared, (before, after)), times): (&(ComparisonKey, Transition), &u64)| {
            let ComparisonKey { tolerances, span, engine } = compared.clone();
            ConfusionRow { tolerances, span, engine, before: before.clone(), after: after.clone(), contacts: *times }
        };
        written(&CONFUSION_COLUMNS, self.confusion.iter().map(row))
    }
}
