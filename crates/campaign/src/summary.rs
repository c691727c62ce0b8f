//! How many findings of which sort: the counts behind `summary.csv` and the table at the end of a campaign.

use rockproof_differential::finding::Finding;
use rockproof_differential::row::written;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// Where pairs come from and under which set they were examined.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct PairGroup {
    /// The family.
    pub family: String,
    /// The form.
    pub form: String,
    /// The tolerance set.
    pub tolerances: String,
}

/// What was found.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct FindingClass {
    /// Whom it is about.
    pub engine: String,
    /// The cause.
    pub cause: String,
    /// The change.
    pub change: String,
    /// The contact's kind, empty for a failure.
    pub kind: String,
}

/// Counts of pairs and findings. Adding is commutative; the order of rows is that of their keys.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "SummaryRows", into = "SummaryRows")]
pub struct Summary {
    pairs: BTreeMap<PairGroup, u64>,
    findings: BTreeMap<(PairGroup, FindingClass), u64>,
}

/// A summary as lists, for JSON.
#[derive(Serialize, Deserialize)]
struct SummaryRows {
    pairs: Vec<(PairGroup, u64)>,
    findings: Vec<(PairGroup, FindingClass, u64)>,
}

impl From<SummaryRows> for Summary {
    fn from(rows: SummaryRows) -> Summary {
        Summary {
            pairs: rows.pairs.into_iter().collect(),
            findings: rows.findings.into_iter().map(|(origin, class, count)| ((origin, class), count)).collect(),
        }
    }
}

impl From<Summary> for SummaryRows {
    fn from(summary: Summary) -> SummaryRows {
        SummaryRows {
            pairs: summary.pairs.into_iter().collect(),
            findings: summary.findings.into_iter().map(|((origin, class), count)| (origin, class, count)).collect(),
        }
    }
}

/// A row of `summary.csv`; the fields are its columns.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct SummaryRow {
    /// The family.
    pub family: String,
    /// The form.
    pub form: String,
    /// The tolerance set.
    pub tolerances: String,
    /// Pairs examined of these three.
    pub pairs: u64,
    /// Whom the findings are about; empty, as what follows, where there are none.
    pub engine: String,
    /// The cause.
    pub cause: String,
    /// The change.
    pub change: String,
    /// The contact's kind, empty for a failure.
    pub kind: String,
    /// How many findings.
    pub findings: u64,
}

/// The columns of `summary.csv`: `pairs` were examined under the set, `findings` of the sort were made.
pub const SUMMARY_COLUMNS: [&str; 9] =
    ["family", "form", "tolerances", "pairs", "engine", "cause", "change", "kind", "findings"];

impl Summary {
    /// Counts a pair examined under a tolerance set.
    pub fn add_pair(&mut self, origin: PairGroup) {
        *self.pairs.entry(origin).or_default() += 1;
    }

    /// Counts a finding.
    pub fn add_finding(&mut self, finding: &Finding) {
        let origin = PairGroup {
            family: finding.family.to_string(),
            form: finding.form.to_string(),
            tolerances: finding.set.to_string(),
        };
        let class = FindingClass {
            engine: finding.scope.to_string(),
            cause: finding.cause.to_string(),
            change: finding.difference.change.to_string(),
            kind: finding.kind().map_or(String::new(), |k| k.to_string()),
        };
        *self.findings.entry((origin, class)).or_default() += 1;
    }

    /// Adds the counts of `other`.
    pub fn add(&mut self, other: Summary) {
        for (key, count) in other.pairs {
            *self.pairs.entry(key).or_default() += count;
        }
        for (key, count) in other.findings {
            *self.findings.entry(key).or_default() += count;
        }
    }

    /// Pairs examined, by where they come from.
    pub fn examined(&self) -> impl Iterator<Item = (&PairGroup, u64)> {
        self.pairs.iter().map(|(origin, count)| (origin, *count))
    }

    /// All findings.
    pub fn total(&self) -> u64 {
        self.findings.values().sum()
    }

    /// Findings whose cause or change is `kind`.
    pub fn count_of(&self, kind: &str) -> u64 {
        self.findings.iter().filter(|((_, s), _)| s.cause == kind || s.change == kind).map(|(_, count)| count).sum()
    }

    /// Pairs by family, and findings by family.
    pub fn by_family(&self) -> BTreeMap<&str, [u64; 2]> {
        let mut families: BTreeMap<&str, [u64; 2]> = BTreeMap::new();
        for (origin, count) in &self.pairs {
            families.entry(&origin.family).or_default()[0] += count;
        }
        for ((origin, _), count) in &self.findings {
            families.entry(&origin.family).or_default()[1] += count;
        }
        families
    }

    /// Findings by engine, cause and change, and within these by kind.
    pub fn by_class(&self) -> BTreeMap<&FindingClass, u64> {
        let mut sorts = BTreeMap::new();
        for ((_, class), count) in &self.findings {
            *sorts.entry(class).or_default() += count;
        }
        sorts
    }

    /// The rows of `summary.csv`: for each group of pairs one for each class of findings, or one without findings.
    pub fn rows(&self) -> Vec<SummaryRow> {
        let nothing =
            || FindingClass { engine: String::new(), cause: String::new(), change: String::new(), kind: String::new() };
        let mut rows = Vec::new();
        for (origin, pairs) in &self.pairs {
            let row = |class: &FindingClass, findings| SummaryRow {
                family: origin.family.clone(),
                form: origin.form.clone(),
                tolerances: origin.tolerances.clone(),
                pairs: *pairs,
                engine: class.engine.clone(),
                cause: class.cause.clone(),
                change: class.change.clone(),
                kind: class.kind.clone(),
                findings,
            };
            let before = rows.len();
            let from = (origin.clone(), nothing());
            let found = self.findings.range(from..).take_while(|((o, _), _)| o == origin);
            rows.extend(found.map(|((_, class), count)| row(class, *count)));
            if rows.len() == before {
                rows.push(row(&nothing(), 0));
            }
        }
        rows
    }

    /// `summary.csv`.
    ///
    /// # Errors
    /// Those of the CSV writer.
    pub fn to_csv(&self) -> Result<Vec<u8>, csv::Error> {
        written(&SUMMARY_COLUMNS, self.rows())
    }
}
/// How many rows each of these tables has below its header, by its name: whoever reads it sees whether it was cut off.
pub(crate) fn row_counts(tables: &[(&str, Vec<u8>)]) -> csv::Result<Map<String, Value>> {
    let count = |table: &[u8]| {
        csv::Reader::from_reader(table).into_byte_records().try_fold(0u64, |count, row| row.map(|_| count + 1))
    };
    tables.iter().map(|(name, table)| Ok(((*name).to_owned(), count(table)?.into()))).collect()
}
