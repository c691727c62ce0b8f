//! What a finished campaign found, counted for a gate out of its `findings.csv` and `summary.csv`.

#[cfg(test)]
mod tests;

use super::config::{Baseline, FindingLimit};
use super::limit_count::LimitCount;
use super::tally_row::{TallyRow, of_set};
use rockproof_campaign::engine_counts::{ENGINE_COLUMNS, ENGINES, EngineRow};
use rockproof_campaign::steps::{STEP_FINDING_COLUMNS, STEP_SUMMARY_COLUMNS, StepSummaryRow};
use rockproof_campaign::summary::{SUMMARY_COLUMNS, SummaryRow};
use rockproof_differential::agreement::{AGREEMENT_COLUMNS, ChainSpan, EngineAnswers};
use rockproof_differential::finding::FINDING_COLUMNS;
use rockproof_differential::row::typed_rows;
use rockproof_model::files::open_table;
use rockproof_pairs::batch::BATCH;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Why a campaign cannot be counted.
#[derive(Debug, thiserror::Error)]
pub enum TallyError {
    /// A table that cannot be read.
    #[error("{file}: {source}")]
    Csv {
        /// The table.
        file: PathBuf,
        /// What is wrong, and where.
        source: csv::Error,
    },
    /// Rows of one origin that contradict each other.
    #[error("{file}: of the same pairs one row says that {} were examined, another {}", found[0], found[1])]
    Contradiction {
        /// The table.
        file: PathBuf,
        /// Both counts.
        found: [u64; 2],
    },
}

/// What a campaign found.
#[derive(Debug)]
pub struct CampaignTally {
    /// Every finding.
    pub rows: Vec<TallyRow>,
    /// Pairs examined by (family, set); a pair counts once for each set. Of a family that is not classified, pairs that make steps.
    examined: BTreeMap<(String, String), u64>,
    /// The same of pairs that make steps.
    moved: PairCounts,
    /// The same of pairs whose steps were looked through for passages and unseen overlaps.
    watched: BTreeMap<(String, String), u64>,
    /// What external engines were put through.
    pub engines: Vec<EngineRow>,
    /// Pairs that each engine was asked about and answered.
    answers: BTreeMap<String, EngineAnswers>,
}

/// How often a sort of finding occurred.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ClassCount {
    /// Findings.
    pub findings: u64,
    /// Pairs with such a finding; a pair counts once for each tolerance set.
    pub pairs: u64,
    /// The squares of these pairs' numbers in each batch, added up. Divided by `pairs` it is the design effect.
    pub squares: u64,
}

impl ClassCount {
    /// Counts findings by their pair's number and tolerance set.
    pub(crate) fn of(hits: &[(u64, &str)]) -> ClassCount {
        let pairs: BTreeSet<_> = hits.iter().collect();
        let mut batches: BTreeMap<u64, u64> = BTreeMap::new();
        for (index, _) in &pairs {
            *batches.entry(index / BATCH).or_default() += 1;
        }
        let squares = batches.values().map(|n| n * n).sum();
        ClassCount { findings: hits.len() as u64, pairs: pairs.len() as u64, squares }
    }
}

impl CampaignTally {
    /// Reads the run in a directory.
    ///
    /// # Errors
    /// When its tables cannot be read: a count that nobody can read must not pass for none.
    pub fn read(dir: &Path) -> Result<CampaignTally, TallyError> {
        let mut rows: Vec<TallyRow> =
            table(&dir.join("findings.csv"), &FINDING_COLUMNS)?.into_iter().map(TallyRow::Pair).collect();
        let steps = dir.join("step_findings.csv");
        if steps.is_file() {
            rows.extend(table(&steps, &STEP_FINDING_COLUMNS)?.into_iter().map(TallyRow::Step));
        }
        let file = dir.join("summary.csv");
        let mut origins: BTreeMap<[String; 3], u64> = BTreeMap::new();
        for SummaryRow { family, form, tolerances, pairs, .. } in table(&file, &SUMMARY_COLUMNS)? {
            let known = *origins.entry([family, form, tolerances]).or_insert(pairs);
            if known != pairs {
                return Err(TallyError::Contradiction { file, found: [known, pairs] });
            }
        }
        let mut examined = BTreeMap::new();
        for ([family, _, set], pairs) in origins {
            *examined.entry((family, set)).or_default() += pairs;
        }
        let file = dir.join("step_summary.csv");
        let [moved, watched] = if file.is_file() { moved(&file)? } else { Default::default() };
        let classified: BTreeSet<String> = examined.keys().map(|(family, _)| family.clone()).collect();
        let unclassified = moved.iter().filter(|((family, _), _)| !classified.contains(family));
        examined.extend(unclassified.map(|(group, pairs)| (group.clone(), *pairs)));
        let file = dir.join(ENGINES);
        let engines: Vec<EngineRow> = if file.is_file() { table(&file, &ENGINE_COLUMNS)? } else { Vec::new() };
        let file = dir.join("agreement.csv");
        let mut answers = if file.is_file() { answers(&file)? } else { BTreeMap::new() };
        for row in &engines {
            answers.entry(row.engine.clone()).or_default().detail = row.detail();
        }
        Ok(CampaignTally { rows, examined, moved, watched, engines, answers })
    }

    /// The pairs that an engine was asked about and answered.
    pub fn answers(&self, engine: &str) -> EngineAnswers {
        self.answers.get(engine).copied().unwrap_or_default()
    }

    /// Pairs examined of each family; a pair counts once for each set.
    pub fn examined_by_family(&self) -> BTreeMap<String, u64> {
        by_family(&self.examined)
    }

    /// Pairs of each family that make steps; a pair counts once for each set.
    pub fn moved_by_family(&self) -> BTreeMap<String, u64> {
        by_family(&self.moved)
    }

    /// Families and tolerance sets under which pairs were examined.
    pub(crate) fn groups(&self) -> BTreeSet<(&str, &str)> {
        self.examined.keys().map(|(family, set)| (family.as_str(), set.as_str())).collect()
    }

    /// Pairs examined of these families under these sets; `watched` counts those whose steps were looked through instead.
    pub(crate) fn examined_of(&self, groups: &BTreeSet<(&str, &str)>, watched: bool) -> u64 {
        let counts = if watched { &self.watched } else { &self.examined };
        let of = counts.iter().filter(|((family, set), _)| groups.contains(&(family.as_str(), set.as_str())));
        of.map(|(_, pairs)| pairs).sum()
    }

    /// That no pair was examined that a limit could find something in; `None` where there was one.
    pub(crate) fn missing(&self, limit: &FindingLimit) -> Option<String> {
        let (pairs, what) = match limit {
            limit if limit.is_of_recovered() => return None,
            limit if limit.is_of_intrusions() => {
                (&self.watched, "made a step that was looked through for passages and unseen overlaps")
            }
            limit if limit.is_of_steps() => (&self.moved, "made a step"),
            _ => (&self.examined, "was examined"),
        };
        if of_limit(pairs, limit) > 0 {
            return None;
        }
        let of = [("family", &limit.family), ("tolerances", &limit.tolerances)].into_iter();
        let of: Vec<String> = of.filter_map(|(key, value)| Some(format!("{key} {}", value.as_ref()?))).collect();
        let of = if of.is_empty() { String::new() } else { format!(" with {}", of.join(", ")) };
        Some(format!("no pair{of} {what}"))
    }

    /// How often each sort of finding occurred whose causes a baseline holds, by fingerprint.
    pub fn by_class(&self, baseline: &Baseline) -> BTreeMap<String, ClassCount> {
        let known = |row: &&TallyRow| baseline.causes.iter().any(|cause| cause == row.common().cause.name());
        let of = self.rows.iter().filter(known);
        let mut hits: BTreeMap<String, Vec<(u64, &str)>> = BTreeMap::new();
        for row in of {
            hits.entry(row.fingerprint(baseline)).or_default().push((row.index(), row.common().tolerances));
        }
        hits.into_iter().map(|(fingerprint, hits)| (fingerprint, ClassCount::of(&hits))).collect()
    }

    /// Counts what a limit is about.
    pub fn count(&self, limit: &FindingLimit) -> LimitCount {
        if limit.is_of_recovered() {
            let of = self.engines.iter().filter(|row| limit.engine.as_ref().is_none_or(|name| *name == row.engine));
            return LimitCount {
                findings: of.map(|row| row.recovered).sum(),
                pairs: 0,
                examined: 0,
                design_effect: 1.0,
            };
        }
        let of = self.rows.iter().filter(|row| row.is_of(limit));
        let hits: Vec<(u64, &str)> = of.map(|row| (row.index(), row.common().tolerances)).collect();
        let sorted = ClassCount::of(&hits);
        let examined = if limit.is_of_intrusions() { &self.watched } else { &self.examined };
        LimitCount {
            findings: sorted.findings,
            pairs: sorted.pairs,
            examined: of_limit(examined, limit),
            design_effect: if sorted.pairs == 0 { 1.0 } else { sorted.squares as f64 / sorted.pairs as f64 },
        }
    }
}

/// The pairs of the families and sets that a limit is about.
fn of_limit(pairs: &PairCounts, limit: &FindingLimit) -> u64 {
    let of = pairs.iter().filter(|((family, set), _)| {
        limit.family.as_ref().is_none_or(|wanted| wanted == family)
            && limit.tolerances.as_ref().is_none_or(|wanted| of_set(set, wanted))
    });
    of.map(|(_, pairs)| pairs).sum()
}

/// Pairs by (family, set).
type PairCounts = BTreeMap<(String, String), u64>;

fn by_family(counts: &PairCounts) -> BTreeMap<String, u64> {
    let mut families = BTreeMap::new();
    for ((family, _), pairs) in counts {
        *families.entry(family.clone()).or_default() += pairs;
    }
    families
}

/// Pairs that make steps, and those of them whose steps were looked through: as many as the engine has of them that takes the most.
fn moved(file: &Path) -> Result<[PairCounts; 2], TallyError> {
    let mut by_engine: BTreeMap<[String; 3], [u64; 2]> = BTreeMap::new();
    for StepSummaryRow { family, tolerances, engine, pairs, watched, .. } in table(file, STEP_SUMMARY_COLUMNS)? {
        let known = by_engine.entry([family, tolerances, engine]).or_default();
        // At most: of a pair several steps may be looked through.
        *known = [known[0] + pairs, known[1] + pairs.min(watched)];
    }
    let mut counts: [PairCounts; 2] = Default::default();
    for ([family, set, _], pairs) in by_engine {
        for (counts, pairs) in counts.iter_mut().zip(pairs) {
            let most = counts.entry((family.clone(), set.clone())).or_insert(pairs);
            *most = pairs.max(*most);
        }
    }
    Ok(counts)
}

/// What is read of a row of `agreement.csv`.
#[derive(Deserialize)]
struct AnswerRow {
    span: ChainSpan,
    engine: String,
    pairs: u64,
    silent: u64,
}

/// What engines answered.
fn answers(file: &Path) -> Result<BTreeMap<String, EngineAnswers>, TallyError> {
    let mut answers: BTreeMap<String, EngineAnswers> = BTreeMap::new();
    for AnswerRow { span, engine, pairs, silent } in table(file, &AGREEMENT_COLUMNS)? {
        // Those of spans that no engine takes part in are of a precision.
        if matches!(span, ChainSpan::Arithmetic | ChainSpan::Whole) {
            answers.entry(engine).or_default().add_row(span, [pairs, silent]);
        }
    }
    Ok(answers)
}

/// The rows of a table, which has these columns.
fn table<T: DeserializeOwned>(file: &Path, columns: &[&str]) -> Result<Vec<T>, TallyError> {
    let at = |source| TallyError::Csv { file: file.to_owned(), source };
    let opened = open_table(file).map_err(|error| at(error.into()))?;
    typed_rows(opened, columns).and_then(Iterator::collect).map_err(at)
}
