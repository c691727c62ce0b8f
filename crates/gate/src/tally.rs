//! What a finished campaign found, counted for a gate out of its `findings.csv` and `summary.csv`.

use super::config::{Baseline, Limit};
use super::known::SEPARATOR;
use rockproof_campaign::pairs::BATCH;
use rockproof_campaign::steps::STEP_FINDING_COLUMNS;
use rockproof_differential::finding::FINDING_COLUMNS;
use serde::Deserialize;
use statrs::function::beta::checked_beta_reg;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// One row of `findings.csv` or of `step_findings.csv`.
#[derive(Clone, Debug)]
pub struct Row {
    record: csv::StringRecord,
    columns: &'static [&'static str],
}

impl Row {
    /// The value in a column of [`FINDING_COLUMNS`], or of [`STEP_FINDING_COLUMNS`], whose `kind` counts as before and after; empty
    /// for another.
    pub fn get(&self, column: &str) -> &str {
        let name = if self.is_of_step() && column.starts_with("kind_") { "kind" } else { column };
        self.columns.iter().position(|known| *known == name).and_then(|at| self.record.get(at)).unwrap_or("")
    }

    /// Whether it is about a step.
    pub fn is_of_step(&self) -> bool {
        self.columns.len() == STEP_FINDING_COLUMNS.len()
    }

    /// The number of the pair.
    pub fn index(&self) -> u64 {
        self.get("index").parse().unwrap_or(u64::MAX)
    }

    /// What makes it like others, for a baseline.
    pub fn fingerprint(&self, baseline: &Baseline) -> String {
        baseline.fields.iter().map(|field| self.get(field)).collect::<Vec<_>>().join(SEPARATOR)
    }

    /// Whether a limit is about it.
    pub fn is_of(&self, limit: &Limit) -> bool {
        let same = |wanted: &Option<String>, column: &str| wanted.as_ref().is_none_or(|w| w == self.get(column));
        let set = limit.tolerances.as_ref();
        let beyond = |least: f64| self.get("margin_ulps").parse::<f64>().is_ok_and(|ulps| ulps.abs() > least);
        let kind = limit.kind.as_ref();
        same(&limit.engine, "engine")
            && set.is_none_or(|set| of_set(self.get("tolerances"), set))
            && same(&limit.family, "family")
            && same(&limit.cause, "cause")
            && same(&limit.change, "change")
            && kind.is_none_or(|kind| [self.get("kind_before"), self.get("kind_after")].contains(&kind.as_str()))
            && limit.beyond_ulps.is_none_or(beyond)
    }
}

/// Whether a set is the wanted one, or that one changed by a ladder.
fn of_set(found: &str, wanted: &str) -> bool {
    found == wanted || found.split_once(':').is_some_and(|(base, _)| base == wanted)
}

/// What a campaign found.
pub struct Tally {
    /// Every finding.
    pub rows: Vec<Row>,
    /// Pairs examined by (family, set); a pair counts once for each set.
    examined: BTreeMap<(String, String), u64>,
}

/// How often a sort of finding occurred.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sorted {
    /// Findings.
    pub findings: u64,
    /// Pairs with such a finding; a pair counts once for each tolerance set.
    pub pairs: u64,
    /// The squares of these pairs' numbers in each batch, added up. Divided by `pairs` it is the design effect.
    pub squares: u64,
}

impl Sorted {
    /// Counts findings by their pair's number and tolerance set.
    fn of(hits: &[(u64, &str)]) -> Sorted {
        let pairs: BTreeSet<_> = hits.iter().collect();
        let mut batches: BTreeMap<u64, u64> = BTreeMap::new();
        for (index, _) in &pairs {
            *batches.entry(index / BATCH).or_default() += 1;
        }
        let squares = batches.values().map(|n| n * n).sum();
        Sorted { findings: hits.len() as u64, pairs: pairs.len() as u64, squares }
    }
}

/// What is found of a limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// Findings.
    pub findings: u64,
    /// Pairs with such a finding.
    pub pairs: u64,
    /// Pairs examined.
    pub examined: u64,
    /// How much less than independent pairs they tell: 1 for independent ones.
    pub design_effect: f64,
}

impl Tally {
    /// Reads the run in a directory.
    ///
    /// # Errors
    /// When its tables cannot be read.
    pub fn read(dir: &Path) -> Result<Tally, csv::Error> {
        let mut rows = table(&dir.join("findings.csv"), &FINDING_COLUMNS)?;
        let steps = dir.join("step_findings.csv");
        if steps.is_file() {
            rows.extend(table(&steps, &STEP_FINDING_COLUMNS)?);
        }
        let mut origins: BTreeMap<[String; 3], u64> = BTreeMap::new();
        for row in csv::Reader::from_path(dir.join("summary.csv"))?.into_records() {
            let row = row?;
            let text = |at: usize| row.get(at).unwrap_or("").to_owned();
            origins.insert([text(0), text(1), text(2)], text(3).parse().unwrap_or(0));
        }
        let mut examined = BTreeMap::new();
        for ([family, _, set], pairs) in origins {
            *examined.entry((family, set)).or_default() += pairs;
        }
        Ok(Tally { rows, examined })
    }

    /// Pairs examined of each family; a pair counts once for each set.
    pub fn examined_by_family(&self) -> BTreeMap<String, u64> {
        let mut families = BTreeMap::new();
        for ((family, _), pairs) in &self.examined {
            *families.entry(family.clone()).or_default() += pairs;
        }
        families
    }

    /// How often each sort of finding occurred whose causes a baseline holds, by fingerprint; findings about steps are none of
    /// them.
    pub fn sorted(&self, baseline: &Baseline) -> BTreeMap<String, Sorted> {
        let known = |row: &&Row| baseline.causes.iter().any(|cause| cause == row.get("cause"));
        let of = self.rows.iter().filter(|row| !row.is_of_step()).filter(known);
        let mut hits: BTreeMap<String, Vec<(u64, &str)>> = BTreeMap::new();
        for row in of {
            hits.entry(row.fingerprint(baseline)).or_default().push((row.index(), row.get("tolerances")));
        }
        hits.into_iter().map(|(fingerprint, hits)| (fingerprint, Sorted::of(&hits))).collect()
    }

    /// Counts what a limit is about.
    pub fn count(&self, limit: &Limit) -> Found {
        let of = self.rows.iter().filter(|row| row.is_of(limit));
        let hits: Vec<(u64, &str)> = of.map(|row| (row.index(), row.get("tolerances"))).collect();
        let sorted = Sorted::of(&hits);
        let wanted = |wanted: &Option<String>, found: &str| wanted.as_ref().is_none_or(|w| w == found);
        let counted = self.examined.iter().filter(|((family, set), _)| {
            wanted(&limit.family, family) && limit.tolerances.as_ref().is_none_or(|w| of_set(set, w))
        });
        Found {
            findings: sorted.findings,
            pairs: sorted.pairs,
            examined: counted.map(|(_, pairs)| pairs).sum(),
            design_effect: if sorted.pairs == 0 { 1.0 } else { sorted.squares as f64 / sorted.pairs as f64 },
        }
    }
}

fn table(file: &Path, columns: &'static [&'static str]) -> Result<Vec<Row>, csv::Error> {
    let rows = csv::Reader::from_path(file)?.into_records();
    rows.map(|row| row.map(|record| Row { record, columns })).collect()
}

impl Found {
    /// The share of pairs with such a finding.
    pub fn rate(&self) -> f64 {
        if self.examined == 0 { 0.0 } else { self.pairs as f64 / self.examined as f64 }
    }

    /// How likely it is to find as many or more by chance where the true share is `rate`: the exact binomial tail (Clopper
    /// and Pearson 1934). The sixteen pairs of a batch share a base and are not independent, so pairs found and examined are
    /// first divided by the design effect (Korn and Graubard 1998), which for rare findings is Σx²/Σx over the batches.
    pub fn chance(&self, rate: f64) -> f64 {
        let (found, examined) = (self.pairs as f64 / self.design_effect, self.examined as f64 / self.design_effect);
        if self.pairs == 0 || rate >= 1.0 {
            return 1.0;
        }
        if rate <= 0.0 {
            return 0.0;
        }
        checked_beta_reg(found, (examined - found + 1.0).max(1.0), rate).unwrap_or(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chance_is_the_binomial_tail() {
        let found = |pairs, examined, design_effect| Found { findings: pairs, pairs, examined, design_effect };
        // P(X ≥ 2), X binomial of 10 and 0.1: 1 − 0.9¹⁰ − 10·0.1·0.9⁹.
        let tail = 1.0 - 0.9f64.powi(10) - 0.9f64.powi(9);
        assert!((found(2, 10, 1.0).chance(0.1) - tail).abs() < 1e-12);
        assert_eq!(found(0, 10, 1.0).chance(0.0), 1.0);
        assert_eq!(found(1, 10, 1.0).chance(0.0), 0.0);
        assert!(found(40, 1000, 8.0).chance(0.02) > found(40, 1000, 1.0).chance(0.02), "clustered pairs tell less");
    }
}
