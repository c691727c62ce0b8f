//! A row of `diagnosis.csv`, and what it says in words.

use crate::finding::FAR_FROM_TIE;
use serde::{Deserialize, Serialize};

rockproof_model::named_enum! {
    /// What a row of a diagnosis says.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    #[serde(rename_all = "kebab-case")]
    pub enum DiagnosisVerdict: Display {
        /// The hypothesis explains the answers, and no right answer that was looked at speaks against it.
        Explains = "explains",
        /// So does this one, the same answers as the one above it, and the engine gave nothing that tells the two apart.
        AsWell = "as-well",
        /// No hypothesis explains them, and they are so near to ties that rounding can be the reason.
        Rounding = "rounding",
        /// No hypothesis explains them, nor does rounding.
        Unexplained = "unexplained",
        /// They were right when the engine was asked again.
        NotRepeated = "not-repeated",
        /// The hypothesis explains some, and right answers speak against it.
        Contradicted = "contradicted",
    }
}

/// One row of `diagnosis.csv`. The fields are its columns.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct DiagnosisRow {
    /// The engine.
    pub engine: String,
    /// What the row says.
    pub verdict: DiagnosisVerdict,
    /// The hypothesis; empty where the row is about none.
    pub hypothesis: String,
    /// What it says, to go on "answers are exact …"; of unexplained answers that all are near ties, where that is so; else empty.
    pub sentence: String,
    /// Differing answers that the row is about.
    pub answers: u64,
    /// Differing answers looked at.
    pub differing: u64,
    /// Differing answers of the campaign.
    pub all_differing: u64,
    /// Right answers that speak against the hypothesis.
    pub contradicted: u64,
    /// Right answers looked at.
    pub agreeing: u64,
    /// One of the answers, the furthest from a tie of those that have a case file: that file, or else its pair and set.
    pub example: String,
}

/// The columns of `diagnosis.csv`.
pub const DIAGNOSIS_COLUMNS: [&str; 10] = [
    "engine",
    "verdict",
    "hypothesis",
    "sentence",
    "answers",
    "differing",
    "all_differing",
    "contradicted",
    "agreeing",
    "example",
];

/// What the sentence of unexplained answers says where all of them are near ties.
pub(super) const ALL_NEAR_TIES: &str = "all of them near ties";

/// Hypotheses that are no mistake of an engine declared to calculate in f32.
const IN_SINGLE: [&str; 3] = ["input-in-f32", "calculated-in-f32", "state-in-f32"];

/// So many of the differing answers may stay unexplained before it is said beside an explanation: one in so many.
const SMALL_PART: u64 = 4;

impl DiagnosisRow {
    /// The row in a sentence; `None` for what only the table tells.
    pub fn words(&self) -> Option<String> {
        self.words_beside(0)
    }

    /// The same beside so many answers of its engine that nothing explains.
    fn words_beside(&self, left: u64) -> Option<String> {
        let DiagnosisRow { engine, sentence, answers, differing, agreeing, example, .. } = self;
        let of = format!("{answers} of {differing} differing answers");
        let are = if *answers == 1 { "is" } else { "are" };
        Some(match self.verdict {
            DiagnosisVerdict::Explains => {
                let against = match self.contradicted {
                    0 => format!("no right answer of {agreeing} speaks against it"),
                    n => format!("{n} right answers of {agreeing} speak against it, all next to a tie"),
                };
                let advice = match IN_SINGLE.contains(&self.hypothesis.as_str()) {
                    true => format!(" If it is meant to calculate in f32, declare it as {engine}:f32."),
                    false => String::new(),
                };
                format!("{engine}: {of} {are} exact {sentence}; {against}.{advice}")
            }
            DiagnosisVerdict::AsWell => {
                format!("{engine}: as well {sentence}: nothing that was asked tells the two apart.")
            }
            DiagnosisVerdict::Rounding => {
                // Where rounding does not explain the others, it need not be what these have in common with them.
                let or = match left {
                    0 => String::new(),
                    _ => format!(", or what is wrong with the {left} further off"),
                };
                format!(
                    "{engine}: {of} {are} within {FAR_FROM_TIE} roundoffs of a tie: rounding can be the reason{or}."
                )
            }
            DiagnosisVerdict::Unexplained if sentence == ALL_NEAR_TIES => format!(
                "{engine}: {of} {are} within {FAR_FROM_TIE} roundoffs of a tie, so rounding can be the reason, though not such rounding as \
                 explains the others; see {example}."
            ),
            DiagnosisVerdict::Unexplained => format!("{engine}: no hypothesis explains {of}; see {example}."),
            DiagnosisVerdict::NotRepeated => {
                format!(
                    "{engine}: {of} {are} right when asked again: what it answers depends on what it was asked before or on chance, or \
                     its program was changed since."
                )
            }
            DiagnosisVerdict::Contradicted => return None,
        })
    }
}

/// What a diagnosis says, a line for each row that people need.
pub fn diagnosis_lines(rows: &[DiagnosisRow]) -> Vec<String> {
    let unexplained = |engine: &str| {
        let of = rows.iter().filter(|row| row.engine == engine && row.verdict == DiagnosisVerdict::Unexplained);
        of.map(|row| row.answers).sum::<u64>()
    };
    let line = |row: &DiagnosisRow| {
        let left = unexplained(&row.engine);
        let mut words = row.words_beside(left)?;
        if row.verdict == DiagnosisVerdict::Explains && left * SMALL_PART >= row.differing {
            words += &format!(" It is not all: nothing explains {left} of them.");
        }
        Some(words)
    };
    rows.iter().filter_map(line).collect()
}
