//! Counts the findings of a campaign while reading them, in memory that does not grow with their number.

use super::external_findings::{self, AllEngineFindings};
use super::load::{is_made_for_ties, setting};
use rockproof_differential::compare::AnswerChange;
use rockproof_differential::finding::{Cause, FAR_FROM_TIE};
use rockproof_differential::row::FindingRow;
use rockproof_model::decision::Predicate;
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// Questions whose answer is a choice among several, made elsewhere: how far they are from a tie says nothing of how near that was.
pub const CHOICES: [Predicate; 3] = [Predicate::EntranceChoice, Predicate::ShortestExit, Predicate::OneExit];

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

    /// Whether the engine said that it does not take such a pair: to know, and nothing to look at first.
    fn is_unsupported(&self) -> bool {
        self.change == AnswerChange::Unsupported
    }

    /// How much less than others rounding excuses it: nothing that rounding is no reason for, whatever its margin; that an engine contradicts itself, or that a
    /// choice among several differs, has no margin, so it comes after what is far from any tie and before what is near one.
    fn gravity(&self) -> f64 {
        if self.cause == Cause::Engine && self.change.is_never_rounding() {
            return f64::INFINITY;
        }
        let is_unmeasured = self.margin_ulps.or(self.margin).is_none();
        let contradicts = self.change.is_metamorphic() && !self.change.is_never_rounding();
        let is_choice = CHOICES.iter().any(|choice| choice.name() == self.predicate);
        if is_unmeasured && (contradicts || is_choice) { FAR_FROM_TIE } else { self.magnitude() }
    }

    /// What no rounding excuses first: no usable answer, then the largest margin; last what an engine does not take.
    fn rank(&self, other: &WorstFinding) -> Ordering {
        // Sets that were put on an edge differ by design; a plain setting that differs is worse.
        let designed = |w: &WorstFinding| is_made_for_ties(&setting(&w.tolerances));
        self.is_unsupported()
            .cmp(&other.is_unsupported())
            .then_with(|| other.gravity().total_cmp(&self.gravity()))
            .then_with(|| designed(self).cmp(&designed(other)))
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
    pub own: AllEngineFindings,
}

impl FindingTally {
    /// Adds a row of `findings.csv`.
    pub(super) fn add(&mut self, row: FindingRow) {
        external_findings::count(&mut self.own, &row);
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

    /// The finding with a case to look at first, of those that `is_shown` takes: of the cause that worries most, the furthest from a tie; one that an
    /// engine does not take where there are no others.
    pub fn worst_of_all(&self, is_shown: impl Fn(&WorstFinding) -> bool) -> Option<&WorstFinding> {
        let worst = || WORRYING.iter().filter_map(|cause| self.worst.get(cause)).flatten();
        let supported = worst().find(|worst| !worst.is_unsupported() && is_shown(worst));
        supported.or_else(|| worst().find(|worst| is_shown(worst)))
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

#[cfg(test)]
mod tests {
    use super::*;
    use rockproof_differential::finding::FINDING_COLUMNS;

    fn tally(rows: &[&str]) -> FindingTally {
        let text = format!("{}\n{}\n", FINDING_COLUMNS.join(","), rows.join("\n"));
        let mut tally = FindingTally::default();
        for row in csv::Reader::from_reader(text.as_bytes()).deserialize() {
            tally.add(row.expect("a row"));
        }
        tally
    }

    #[test]
    fn what_an_engine_does_not_take_is_never_looked_at_first() {
        let unsupported = "1,concave_notch,base,auto,mine,engine,unsupported,,,,,,,cases/a.toml";
        let wrong = "2,sliver,base,auto,mine,engine,normal,v-f,v-f,gap-sign,0,1e-3,2e15,cases/b.toml";
        let built_in = "3,sliver,base,auto,stepper-f64,arithmetic,missing,v-f,,gap-sign,0,1e-9,3,cases/c.toml";
        let first = |rows: &[&str]| tally(rows).worst_of_all(|_| true).map(|worst| worst.index);
        assert_eq!(first(&[unsupported, wrong]), Some(2));
        assert_eq!(first(&[unsupported, built_in]), Some(3));
        assert_eq!(first(&[unsupported]), Some(1));
        let found = tally(&[unsupported, wrong, built_in]);
        let but = |index| found.worst_of_all(move |worst| worst.index != index).map(|worst| worst.index);
        assert_eq!([but(2), but(3)], [Some(3), Some(2)]);
        let ranked: Vec<u64> = tally(&[unsupported, wrong]).worst[&Cause::Engine].iter().map(|w| w.index).collect();
        assert_eq!(ranked, [2, 1]);
    }

    #[test]
    fn what_is_far_from_any_tie_comes_before_an_engine_that_contradicts_itself() {
        let row = |index, change, margin| {
            format!("{index},sliver,base,auto,mine,engine,{change},v-f,v-f,gap-sign,0,{margin},cases/{index}.toml")
        };
        let rows = [row(1, "swap", ","), row(2, "extra", "1e-9,4"), row(3, "extra", "1e-3,2e12"), row(4, "crash", ",")];
        let found = tally(&rows.each_ref().map(String::as_str));
        let ranked: Vec<u64> = found.worst[&Cause::Engine].iter().map(|worst| worst.index).collect();
        assert_eq!(ranked, [4, 3, 1, 2]);
        // In another unit of length nothing is rounded otherwise.
        let scaled = tally(&[&row(5, "scale", "1e-9,4"), &rows[2]].map(String::as_str));
        let first = scaled.worst[&Cause::Engine].first().map(|worst| worst.index);
        assert_eq!(first, Some(5));
        assert_eq!(found.worst_of_all(|worst| worst.index != 4).map(|worst| worst.index), Some(3));
    }

    #[test]
    fn a_choice_without_a_margin_comes_after_what_no_rounding_excuses() {
        let row = |index, predicate, margin| {
            format!(
                "{index},sliver,base,auto,f64,representation,extra,v-f,v-f,{predicate},0,{margin},cases/{index}.toml"
            )
        };
        let rows = [row(1, "entrance-choice", ","), row(2, "gap-sign", "1e-9,4"), row(3, "gap-sign", "1e-3,2e4")];
        let found = tally(&rows.each_ref().map(String::as_str));
        let ranked: Vec<u64> = found.worst[&Cause::Representation].iter().map(|worst| worst.index).collect();
        assert_eq!(ranked, [3, 1, 2]);
    }

    #[test]
    fn of_equal_margins_a_set_that_somebody_would_take_comes_first() {
        let row = |index, set| {
            format!(
                "{index},sliver,base,{set},stepper-f64,arithmetic,missing,v-f,,gap-sign,0,1e-9,3,cases/{index}.toml"
            )
        };
        let rows = [row(1, "dyadic-deep"), row(2, "auto:territory"), row(3, "auto")];
        let worst = tally(&rows.each_ref().map(String::as_str)).worst_of_all(|_| true).map(|worst| worst.index);
        assert_eq!(worst, Some(3));
    }
}
