//! What changed between two campaigns: which sorts of findings are new, gone, more or less frequent, with the statistics of the gate.

#[cfg(test)]
mod tests;

use super::CONFIDENCE;
use super::known_findings::ClassGrowth;
use super::tally::{CampaignTally, ClassCount};
use super::tally_row::TallyRow;
use rockproof_differential::finding::Cause;
use rockproof_differential::lockstep::Intrusion;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// What makes two findings of one sort.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct ComparedClass {
    /// Whom they are about.
    pub engine: String,
    /// Why the answer changed.
    pub cause: String,
    /// What changed.
    pub change: String,
    /// What decided it; empty where no trace tells, and of external engines.
    pub predicate: String,
}

rockproof_model::named_enum! {
    /// How a sort of findings fared, the sorts to look at first before others.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
    #[serde(rename_all = "lowercase")]
    pub enum Trend {
        /// There is none in the run before.
        New = "new",
        /// More pairs have one.
        More = "more",
        /// As many pairs have one, but others.
        Other = "other",
        /// Fewer pairs have one.
        Fewer = "fewer",
        /// There is none in the run after.
        Gone = "gone",
        /// The same pairs; of campaigns over different pairs a difference that may be chance.
        Same = "same",
    }
}

/// A sort of findings in both campaigns. Index 0 is the run before, 1 the run after.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClassChange {
    /// The sort.
    #[serde(flatten)]
    pub class: ComparedClass,
    /// How it fared.
    pub trend: Trend,
    /// Findings.
    pub findings: [u64; 2],
    /// Pairs with such a finding; a pair counts once for each tolerance set.
    pub pairs: [u64; 2],
    /// Pairs in which there could have been one.
    pub examined: [u64; 2],
    /// Pairs that have one in this run only. Empty where the campaigns are over different pairs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub only: Option<[u64; 2]>,
    /// How likely a difference so large or larger is by chance, in the direction seen. Empty where both are over the same pairs: there nothing is
    /// left to chance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub chance: Option<f64>,
    /// The number of the first pair that has one in the run after only, or else in the run before only.
    pub pair: Option<u64>,
}

/// What changed between two campaigns.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FindingComparison {
    /// Every sort of findings, those to look at first.
    pub classes: Vec<ClassChange>,
    /// Families under tolerance sets that one of them alone examined, as `family under set`: left out of all counts.
    pub left_out: [Vec<String>; 2],
    /// Pairs of the families and under the sets that both examined; 0 where nothing can be said.
    pub examined: [u64; 2],
}

/// What of two campaigns can be compared.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Comparable {
    /// The numbers of the pairs that both examined; nothing where number and pair do not go together.
    pub same_pairs: Option<Vec<Range<u64>>>,
    /// Whom findings may be about, as `findings.csv` has it: what takes part in both.
    pub engines: BTreeSet<String>,
    /// Whether findings of the cause tolerance are: whom these are about depends on the precisions that take part, so in both runs they must be the same.
    pub tolerance: bool,
}

/// What a pair is to a count: its number and tolerance set.
type Hit<'r> = (u64, &'r str);

/// Hits of both campaigns.
type Hits<'r> = [Vec<Hit<'r>>; 2];

impl FindingComparison {
    /// Compares two campaigns. Over the same pairs every difference comes from the program, the engines or the tolerances. Otherwise a
    /// difference counts where chance does not explain it: the conditional test of [`ClassGrowth::chance`] in the direction seen, below
    /// 1 − [`CONFIDENCE`] over twice the number of sorts (Bonferroni).
    pub fn of(before: &CampaignTally, after: &CampaignTally, comparable: &Comparable) -> FindingComparison {
        let runs = [before, after];
        let groups = runs.map(CampaignTally::groups);
        let shared: BTreeSet<(&str, &str)> = groups[0].intersection(&groups[1]).copied().collect();
        let left_out = groups.map(|groups| {
            groups.difference(&shared).map(|(family, set)| format!("{family} under {set}")).collect::<Vec<_>>()
        });
        let same = |index: u64| {
            comparable.same_pairs.as_ref().is_none_or(|pairs| pairs.iter().any(|range| range.contains(&index)))
        };
        let mut classes: BTreeMap<ComparedClass, Hits> = BTreeMap::new();
        for (side, run) in runs.into_iter().enumerate() {
            for row in run.rows.iter().filter(|row| shared.contains(&row.group()) && same(row.index())) {
                let class = row.class();
                let told_alike = comparable.tolerance || class.cause != Cause::Tolerance.name();
                if told_alike && comparable.engines.contains(&class.engine) {
                    classes.entry(class).or_default()[side].push((row.index(), row.group().1));
                }
            }
        }
        let allowed = (1.0 - CONFIDENCE) / (2 * classes.len().max(1)) as f64;
        let change = |(class, hits): (ComparedClass, Hits)| {
            let of_step = Intrusion::ALL.iter().any(|intrusion| intrusion.name() == class.change);
            let examined = runs.map(|run| run.examined_of(&shared, of_step));
            match comparable.same_pairs {
                Some(_) => paired(class, &hits, examined[0].min(examined[1])),
                None => unpaired(class, &hits, examined, allowed),
            }
        };
        let mut classes: Vec<ClassChange> = classes.into_iter().map(change).collect();
        let difference = |class: &ClassChange| class.findings[0].abs_diff(class.findings[1]);
        classes.sort_by_key(|class| (class.trend, std::cmp::Reverse(difference(class)), class.class.clone()));
        let examined = runs.map(|run| run.examined_of(&shared, false));
        FindingComparison { classes, left_out, examined }
    }

    /// How many sorts fared so.
    pub fn count(&self, trend: Trend) -> usize {
        self.classes.iter().filter(|class| class.trend == trend).count()
    }
}

/// A sort in two campaigns over the same pairs.
fn paired(class: ComparedClass, hits: &Hits, examined: u64) -> ClassChange {
    let sets: [BTreeSet<Hit>; 2] = [0, 1].map(|side: usize| hits[side].iter().copied().collect());
    let only = [0, 1].map(|side: usize| sets[side].difference(&sets[1 - side]).copied().collect::<Vec<Hit>>());
    let pairs = [0, 1].map(|side: usize| sets[side].len() as u64);
    let trend = match pairs {
        [0, _] => Trend::New,
        [_, 0] => Trend::Gone,
        [before, after] if after > before => Trend::More,
        [before, after] if after < before => Trend::Fewer,
        _ if only[1].is_empty() => Trend::Same,
        _ => Trend::Other,
    };
    let pair = only[1].first().or(only[0].first()).map(|(index, _)| *index);
    let findings = [0, 1].map(|side: usize| hits[side].len() as u64);
    let only = Some([only[0].len() as u64, only[1].len() as u64]);
    ClassChange { class, trend, findings, pairs, examined: [examined; 2], only, chance: None, pair }
}

/// A sort in two campaigns over different pairs.
fn unpaired(class: ComparedClass, hits: &Hits, examined: [u64; 2], allowed: f64) -> ClassChange {
    let [was, now] = [0, 1].map(|side: usize| ClassCount::of(&hits[side]));
    let more = ClassGrowth { was, now, examined }.chance();
    let fewer = ClassGrowth { was: now, now: was, examined: [examined[1], examined[0]] }.chance();
    let trend = match (was.pairs, now.pairs) {
        (0, _) => Trend::New,
        (_, 0) if fewer < allowed => Trend::Gone,
        _ if more < allowed => Trend::More,
        _ if fewer < allowed => Trend::Fewer,
        _ => Trend::Same,
    };
    let pair = hits[1].iter().map(|(index, _)| *index).min();
    let chance = Some(more.min(fewer));
    let findings = [was.findings, now.findings];
    ClassChange { class, trend, findings, pairs: [was.pairs, now.pairs], examined, only: None, chance, pair }
}

impl TallyRow {
    /// Its sort.
    fn class(&self) -> ComparedClass {
        let [engine, cause, change, predicate] = self.sort();
        ComparedClass { engine, cause, change, predicate }
    }
}
