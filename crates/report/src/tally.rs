//! Counts the findings of a campaign while reading them, in memory that does not grow with their number.

use super::load::setting;
use super::own::{self, Owns};
use rockproof_differential::compare::AnswerChange;
use rockproof_differential::finding::Cause;
use rockproof_differential::row::FindingRow;
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// How many of the worst findings of each cause are kept.
const WORST: usize = 8;

/// The causes in the order in which they worry.
pub const WORRYING: [Cause; 5] =
    [Cause::Defect, Cause::Engine, Cause::Arithmetic, Cause::Representation, Cause::Tolerance];

/// Whom a finding is about and why.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct FindingGroup {
    /// The tolerance set, without the rungs of ladders.
    pub setting: String,
    /// An engine, `f32` or `f64`, or `any`.
    pub engine: String,
    /// Why the answer changed.
    pub cause: Cause,
    /// What changed.
    pub change: AnswerChange,
}

/// A finding with a case file.
#[derive(Clone, Debug, PartialEq)]
pub struct WorstFinding {
    /// The pair's number.
    pub index: u64,
    /// The pair's family.
    pub family: String,
    /// The tolerance set.
    pub tolerances: String,
    /// Whom it is about.
    pub engine: String,
    /// Why the answer changed.
    pub cause: Cause,
    /// What changed.
    pub change: AnswerChange,
    /// The kind before and after; empty where there is none.
    pub kinds: [String; 2],
    /// What decided it.
    pub predicate: String,
    /// The features it was asked of.
    pub features: String,
    /// Its exact margin.
    pub margin: Option<f64>,
    /// The margin in roundoffs.
    pub margin_ulps: Option<f64>,
    /// The case file, in the directory of the run.
    pub case: String,
}

impl WorstFinding {
    /// How far from a tie it was, whichever way: in roundoffs where there are any, else relative; infinite without a margin.
    pub fn magnitude(&self) -> f64 {
        self.margin_ulps.or(self.margin).map_or(f64::INFINITY, f64::abs)
    }

    /// What no rounding excuses first: no margin at all, then the largest.
    fn rank(&self, other: &WorstFinding) -> Ordering {
        // Sets that a ladder put on an edge differ by design; a plain setting that differs is worse.
        let laddered = |w: &WorstFinding| w.tolerances.contains(':');
        other
            .magnitude()
            .total_cmp(&self.magnitude())
            .then_with(|| laddered(self).cmp(&laddered(other)))
            .then_with(|| self.index.cmp(&other.index))
            .then_with(|| self.case.cmp(&other.case))
    }
}

/// A decade of margins: `None` for ties, else the exponent n of 10ⁿ ≤ margin < 10ⁿ⁺¹.
pub type Decade = Option<i32>;

/// The findings of a campaign, counted.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FindingTally {
    /// All of them.
    pub total: u64,
    /// By whom and why.
    pub sorts: BTreeMap<FindingGroup, u64>,
    /// By engine, cause and decade of the margin: in roundoffs where the finding tells, else relative.
    pub margins: BTreeMap<(String, Cause), BTreeMap<Decade, u64>>,
    /// Findings without a margin, by engine and cause.
    pub unmeasured: BTreeMap<(String, Cause), u64>,
    /// By predicate, cause and engine.
    pub predicates: BTreeMap<String, BTreeMap<(Cause, String), u64>>,
    /// The worst with a case file, by cause, worst first.
    pub worst: BTreeMap<Cause, Vec<WorstFinding>>,
    /// The largest margin in roundoffs, whichever way, by engine and cause.
    pub furthest: BTreeMap<(String, Cause), f64>,
    /// What external engines get wrong.
    pub own: Owns,
}

impl FindingTally {
    /// Adds a row of `findings.csv`.
    pub(super) fn add(&mut self, row: FindingRow) {
        own::count(&mut self.own, &row);
        let FindingRow { cause, change, margin, margin_ulps, .. } = row;
        let engine = row.engine.to_string();
        self.total += 1;
        let sort = FindingGroup { setting: setting(&row.tolerances), engine: engine.clone(), cause, change };
        *self.sorts.entry(sort).or_default() += 1;
        let who = (engine.clone(), cause);
        if let Some(ulps) = margin_ulps.map(f64::abs) {
            let furthest = self.furthest.entry(who.clone()).or_default();
            *furthest = furthest.max(ulps);
        }
        match margin_ulps.or(margin) {
            Some(margin) => *self.margins.entry(who).or_default().entry(decade(margin)).or_default() += 1,
            None => *self.unmeasured.entry(who).or_default() += 1,
        }
        if !row.predicate.is_empty() {
            let counts = self.predicates.entry(row.predicate.clone()).or_default();
            *counts.entry((cause, engine.clone())).or_default() += 1;
        }
        if !row.case.is_empty() {
            let worst = WorstFinding {
                index: row.index,
                family: row.family,
                tolerances: row.tolerances,
                engine,
                cause,
                change,
                kinds: [row.kind_before, row.kind_after],
                predicate: row.predicate,
                features: row.features,
                margin,
                margin_ulps,
                case: row.case,
            };
            let list = self.worst.entry(cause).or_default();
            let place = list.partition_point(|known| known.rank(&worst) != Ordering::Greater);
            list.insert(place, worst);
            list.truncate(WORST);
        }
    }

    /// The finding with a case to look at first: of the cause that worries most, the furthest from a tie.
    pub fn worst_of_all(&self) -> Option<&WorstFinding> {
        WORRYING.iter().find_map(|cause| self.worst.get(cause)?.first())
    }

    /// Findings by cause.
    pub fn by_cause(&self) -> BTreeMap<Cause, u64> {
        let mut causes = BTreeMap::new();
        for (sort, count) in &self.sorts {
            *causes.entry(sort.cause).or_default() += count;
        }
        causes
    }
}

fn decade(margin: f64) -> Decade {
    (margin != 0.0).then(|| margin.abs().log10().floor() as i32)
}
