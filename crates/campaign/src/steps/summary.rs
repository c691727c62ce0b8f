//! How many steps differ, and how: the counts behind `step_summary.csv` and the table at the end of a campaign.

// Longer than 400 lines: every count beside its column, its sum and its row.

use super::engine::ComparedPairStep;
use super::finding::{StepChange, StepFinding};
use rockproof_differential::finding::Cause;
use rockproof_differential::lockstep::answer::StepAnswerChange;
use rockproof_differential::lockstep::intrusion::Intrusions;
use rockproof_differential::lockstep::table::CAUSES;
use rockproof_differential::lockstep::{Intrusion, StepCause};
use rockproof_differential::row::{exponential, finite, named, written};
use rockproof_differential::subject::{NamedSet, Subject};
use rockproof_pairs::tolerance_sets;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Of which pairs and by which engine steps were made.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct StepGroup {
    /// The family.
    pub family: String,
    /// The form.
    pub form: String,
    /// The tolerance set.
    pub tolerances: String,
    /// The engine.
    pub engine: String,
}

impl StepGroup {
    pub(super) fn new(subject: &Subject, set: &NamedSet, engine: &str) -> StepGroup {
        let [family, form, tolerances] = [&subject.family, &subject.form, &set.name].map(ToString::to_string);
        StepGroup { family, form, tolerances, engine: engine.to_owned() }
    }
}

/// Half the longest side of a pair's boxes (m): what depths are measured by, so that pairs of any size can be compared.
pub(super) fn half_side(subject: &Subject) -> f64 {
    tolerance_sets::size(&subject.a).1.max(tolerance_sets::size(&subject.b).1) / 2.0
}

/// Exact penetrations after steps of one side.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PenetrationSums {
    /// The deepest (m).
    pub deepest: f64,
    /// The deepest over half the longest side of its pair.
    pub relative: f64,
    /// Sum of the depths over half the longest sides of their pairs.
    pub sum: Sum,
}

/// A sum of numbers from 0 up that does not depend on their order: each counts as the nearest multiple of 2⁻⁹⁰. So parts of a campaign
/// add up to what one machine finds. It ends at 2³⁸, which 10¹¹ steps of blocks deep in one another do not reach.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Sum(u128);

impl Sum {
    /// 2⁹⁰.
    const UNITS: f64 = (1_u128 << 90) as f64;

    /// The sum, to the nearest f64.
    pub fn value(self) -> f64 {
        self.0 as f64 / Self::UNITS
    }

    fn add(&mut self, other: Sum) {
        self.0 = self.0.saturating_add(other.0);
    }
}

impl From<f64> for Sum {
    fn from(value: f64) -> Sum {
        // Multiplying by a power of two is exact; `as` makes 0 of what is below 0 or no number.
        Sum((value * Sum::UNITS).round() as u128)
    }
}

impl PenetrationSums {
    fn add(&mut self, other: &PenetrationSums) {
        self.deepest = self.deepest.max(other.deepest);
        self.relative = self.relative.max(other.relative);
        self.sum.add(other.sum);
    }
}

macro_rules! counts {
    ($($name:ident $what:literal,)*) => {
        /// Counts of steps.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
        pub struct StepCounts {
            $(#[doc = $what] pub $name: u64,)*
            /// Penetrations after the stepper's steps and after the oracle's, of steps that both made.
            pub depths: [PenetrationSums; 2],
        }

        impl StepCounts {
            /// Adds the counts of `other`.
            pub fn add(&mut self, other: &StepCounts) {
                $(self.$name += other.$name;)*
                self.depths.iter_mut().zip(&other.depths).for_each(|(sum, depths)| sum.add(depths));
            }
        }

        /// A row of `step_summary.csv`; the fields are its columns.
        #[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
        pub struct StepSummaryRow {
            /// The family.
            #[serde(deserialize_with = "named")]
            pub family: String,
            /// The form.
            #[serde(deserialize_with = "named")]
            pub form: String,
            /// The tolerance set.
            #[serde(deserialize_with = "named")]
            pub tolerances: String,
            /// The engine.
            #[serde(deserialize_with = "named")]
            pub engine: String,
            $(#[doc = $what] pub $name: u64,)*
            /// The deepest overlap after steps of the stepper (m).
            #[serde(serialize_with = "exponential", deserialize_with = "finite")]
            pub deepest_stepper_m: Option<f64>,
            /// The deepest overlap after steps of the oracle (m).
            #[serde(serialize_with = "exponential", deserialize_with = "finite")]
            pub deepest_oracle_m: Option<f64>,
            /// The deepest over half the longest side of its pair, after steps of the stepper.
            #[serde(serialize_with = "exponential", deserialize_with = "finite")]
            pub relative_stepper: Option<f64>,
            /// The same after steps of the oracle.
            #[serde(serialize_with = "exponential", deserialize_with = "finite")]
            pub relative_oracle: Option<f64>,
            /// Sum of the depths over half the longest sides, after steps of the stepper.
            #[serde(serialize_with = "exponential", deserialize_with = "finite")]
            pub sum_stepper: Option<f64>,
            /// The same after steps of the oracle.
            #[serde(serialize_with = "exponential", deserialize_with = "finite")]
            pub sum_oracle: Option<f64>,
        }

        /// The columns of `step_summary.csv`.
        pub const STEP_SUMMARY_COLUMNS: &[&str] = &[
            "family",
            "form",
            "tolerances",
            "engine",
            $(stringify!($name),)*
            "deepest_stepper_m",
            "deepest_oracle_m",
            "relative_stepper",
            "relative_oracle",
            "sum_stepper",
            "sum_oracle",
        ];

        impl StepSummaryRow {
            fn new(group: &StepGroup, counts: &StepCounts) -> StepSummaryRow {
                let StepGroup { family, form, tolerances, engine } = group.clone();
                let [stepper, oracle] = counts.depths;
                StepSummaryRow {
                    family,
                    form,
                    tolerances,
                    engine,
                    $($name: counts.$name,)*
                    deepest_stepper_m: Some(stepper.deepest),
                    deepest_oracle_m: Some(oracle.deepest),
                    relative_stepper: Some(stepper.relative),
                    relative_oracle: Some(oracle.relative),
                    sum_stepper: Some(stepper.sum.value()),
                    sum_oracle: Some(oracle.sum.value()),
                }
            }

            /// Of which pairs and by which engine the steps were made, and the counts.
            pub fn counts(&self) -> (StepGroup, StepCounts) {
                let of = |deepest: Option<f64>, relative: Option<f64>, sum: Option<f64>| PenetrationSums {
                    deepest: deepest.unwrap_or(0.0),
                    relative: relative.unwrap_or(0.0),
                    sum: sum.unwrap_or(0.0).into(),
                };
                let [family, form, tolerances, engine] =
                    [&self.family, &self.form, &self.tolerances, &self.engine].map(String::clone);
                let depths = [
                    of(self.deepest_stepper_m, self.relative_stepper, self.sum_stepper),
                    of(self.deepest_oracle_m, self.relative_oracle, self.sum_oracle),
                ];
                (StepGroup { family, form, tolerances, engine }, StepCounts { $($name: self.$name,)* depths })
            }
        }
    };
}

counts! {
    pairs "Pairs set in motion.",
    steps "Steps, made or not.",
    silent "Pairs without a step, for they do not survive rounding.",
    compared "Steps that both sides made.",
    stopped "Steps that one side or both cannot make.",
    open "Contacts that the oracle has open after its last solve.",
    sliding "Contacts that it has sliding.",
    locked "Contacts that it has locked.",
    turning "Contacts that chatter: closed after one solve and open after another.",
    iterated "Steps for which it needs more than one solve.",
    retried "Steps for which it gives up an attempt.",
    contacts_differ "Steps with other contacts than the oracle's.",
    modes_differ "Steps with a contact of another mode.",
    iterations_differ "Steps with another number of solves.",
    converged_differ "Steps of which one side converges and the other does not.",
    retries_differ "Steps with other attempts given up.",
    state_differs "Steps with the same decisions and another state, in 512 bits too.",
    deeper "Steps after which blocks overlap deeper than after the oracle's.",
    shallower "Steps after which they overlap less deep.",
    watched "Steps looked through for passages and unseen overlaps.",
    passages_stepper "Steps of the stepper within which blocks pass through one another.",
    passages_oracle "Steps of the oracle within which they do.",
    passages_undecided "Steps of either within which that stayed undecided.",
    unseen_stepper "Steps of the stepper after which blocks overlap where no contact sees it, and did not before.",
    unseen_oracle "Steps of the oracle after which they do.",
    undecided "Decisions that the oracle's cap left open.",
    tolerance "Differences by cause.",
    representation "Differences by cause.",
    arithmetic "Differences by cause.",
    defect "Differences by cause.",
    step_length "Passages and unseen overlaps by cause: shorter steps have none.",
    not_held "Passages and unseen overlaps by cause: shorter steps have them too.",
}

/// What was found in steps.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct StepFindingClass {
    /// Whom it is about.
    pub engine: String,
    /// The cause.
    pub cause: String,
    /// The change.
    pub change: String,
}

/// Counts of steps and of findings about them. Rows come in the order of their keys.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(from = "StepSummaryRows", into = "StepSummaryRows")]
pub struct StepSummary {
    places: BTreeMap<StepGroup, StepCounts>,
    sorts: BTreeMap<StepFindingClass, u64>,
}

/// A summary as lists, for JSON.
#[derive(Serialize, Deserialize)]
struct StepSummaryRows {
    places: Vec<(StepGroup, StepCounts)>,
    sorts: Vec<(StepFindingClass, u64)>,
}

impl From<StepSummaryRows> for StepSummary {
    fn from(rows: StepSummaryRows) -> StepSummary {
        StepSummary { places: rows.places.into_iter().collect(), sorts: rows.sorts.into_iter().collect() }
    }
}

impl From<StepSummary> for StepSummaryRows {
    fn from(summary: StepSummary) -> StepSummaryRows {
        StepSummaryRows { places: summary.places.into_iter().collect(), sorts: summary.sorts.into_iter().collect() }
    }
}

impl StepSummary {
    /// Counts a step of a pair whose longest side is twice `half` (m).
    pub(super) fn add_step(
        &mut self,
        place: &StepGroup,
        made: &ComparedPairStep,
        deepened: Option<StepChange>,
        half: f64,
    ) {
        let step = &made.compared;
        let own = || step.differences.iter().filter(|c| matches!(c.cause, Cause::Arithmetic | Cause::Defect));
        let any = |of: &dyn Fn(&StepAnswerChange) -> bool| u64::from(own().any(|c| of(&c.difference.change)));
        let [open, sliding, locked] = made.modes;
        let oracle = step.oracle.as_ref();
        let made_by_both = step.stepper.is_some() && oracle.is_some();
        let watched = step.watched.clone().unwrap_or_default();
        let intruding = |cause: StepCause| watched.attributed.iter().filter(|one| one.cause == cause).count() as u64;
        let [tolerance, representation, arithmetic, defect] =
            CAUSES.map(|cause| step.count(cause) as u64 + intruding(cause.into()));
        let any_of = |side: &Intrusions, kind| u64::from(side.count(kind) > 0);
        let sides = [&watched.stepper, &watched.oracle];
        let [passages_stepper, passages_oracle] = sides.map(|side| any_of(side, Intrusion::Passage));
        let [unseen_stepper, unseen_oracle] = sides.map(|side| any_of(side, Intrusion::Unseen));
        let mut counts = StepCounts {
            steps: 1,
            compared: u64::from(made_by_both),
            stopped: u64::from(!made_by_both),
            open,
            sliding,
            locked,
            turning: made.chattering,
            iterated: u64::from(oracle.is_some_and(|oracle| oracle.iterations() > 1)),
            retried: u64::from(oracle.is_some_and(|oracle| !oracle.retries.is_empty())),
            contacts_differ: any(&|change| matches!(change, StepAnswerChange::Contact(_))),
            modes_differ: any(&|change| *change == StepAnswerChange::Mode),
            iterations_differ: any(&|change| *change == StepAnswerChange::Iterations),
            converged_differ: any(&|change| *change == StepAnswerChange::Converged),
            retries_differ: any(&|change| matches!(change, StepAnswerChange::Retries | StepAnswerChange::TimeStep)),
            state_differs: u64::from(made.drift.is_some()),
            deeper: u64::from(deepened == Some(StepChange::Deeper)),
            shallower: u64::from(deepened == Some(StepChange::Shallower)),
            watched: u64::from(step.watched.is_some()),
            passages_stepper,
            passages_oracle,
            passages_undecided: u64::from(sides.iter().any(|side| !side.undecided.is_empty())),
            unseen_stepper,
            unseen_oracle,
            undecided: step.undecided,
            tolerance,
            representation,
            arithmetic,
            defect: defect + u64::from(made.drift.is_some()),
            step_length: intruding(StepCause::StepLength),
            not_held: intruding(StepCause::NotHeld),
            ..StepCounts::default()
        };
        if let [Some(_), Some(_)] = step.penetration {
            for (depths, depth) in counts.depths.iter_mut().zip(step.penetration.into_iter().flatten()) {
                let relative = if half > 0.0 { depth / half } else { 0.0 };
                *depths = PenetrationSums { deepest: depth, relative, sum: relative.into() };
            }
        }
        self.places.entry(place.clone()).or_default().add(&counts);
    }

    /// Counts a pair that moves.
    pub(super) fn add_pair(&mut self, place: &StepGroup) {
        self.places.entry(place.clone()).or_default().pairs += 1;
    }

    /// Counts a pair that cannot be stepped.
    pub(super) fn add_silent(&mut self, place: &StepGroup) {
        self.places.entry(place.clone()).or_default().silent += 1;
    }

    /// Counts a finding.
    pub(super) fn add_finding(&mut self, finding: &StepFinding) {
        let engine = finding.scope.to_string();
        let (cause, change) = (finding.cause.to_string(), finding.change.name().to_owned());
        *self.sorts.entry(StepFindingClass { engine, cause, change }).or_default() += 1;
    }

    /// Adds the counts of `other`.
    pub fn add(&mut self, other: StepSummary) {
        for (place, counts) in other.places {
            self.places.entry(place).or_default().add(&counts);
        }
        for (class, count) in other.sorts {
            *self.sorts.entry(class).or_default() += count;
        }
    }

    /// Whether no pair was set in motion.
    pub fn is_empty(&self) -> bool {
        self.places.is_empty()
    }

    /// The counts by place.
    pub fn places(&self) -> impl Iterator<Item = (&StepGroup, &StepCounts)> {
        self.places.iter()
    }

    /// The counts by engine, over all families and sets.
    pub fn by_engine(&self) -> BTreeMap<&str, StepCounts> {
        let mut engines: BTreeMap<&str, StepCounts> = BTreeMap::new();
        for (place, counts) in &self.places {
            engines.entry(&place.engine).or_default().add(counts);
        }
        engines
    }

    /// Findings by whom, cause and change.
    pub fn classes(&self) -> &BTreeMap<StepFindingClass, u64> {
        &self.sorts
    }

    /// All findings.
    pub fn total(&self) -> u64 {
        self.sorts.values().sum()
    }

    /// Findings whose cause or change is `kind`.
    pub fn count_of(&self, kind: &str) -> u64 {
        self.sorts.iter().filter(|(class, _)| class.cause == kind || class.change == kind).map(|(_, count)| count).sum()
    }

    /// `step_summary.csv`.
    ///
    /// # Errors
    /// Those of the CSV writer.
    pub fn to_csv(&self) -> Result<Vec<u8>, csv::Error> {
        written(STEP_SUMMARY_COLUMNS, self.places.iter().map(|(group, counts)| StepSummaryRow::new(group, counts)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_under_the_columns() {
        let group = StepGroup { family: "a".into(), form: "b".into(), tolerances: "c".into(), engine: "d".into() };
        let depths =
            [0.1, 1.0 / 3.0].map(|depth| PenetrationSums { deepest: depth, relative: depth / 2.0, sum: 0.75.into() });
        let counts = StepCounts { pairs: 3, steps: 7, not_held: 2, depths, ..StepCounts::default() };
        let summary = StepSummary { places: [(group.clone(), counts)].into(), sorts: BTreeMap::new() };
        let text = summary.to_csv().expect("a table");
        let mut reader = csv::Reader::from_reader(&*text);
        let rows: Vec<StepSummaryRow> = reader.deserialize().collect::<Result<_, _>>().expect("rows");
        assert_eq!(rows.iter().map(StepSummaryRow::counts).collect::<Vec<_>>(), [(group, counts)]);
        // The header is that of the fields, in their order.
        let mut named = csv::Writer::from_writer(Vec::new());
        named.serialize(&rows[0]).expect("a row");
        assert_eq!(named.into_inner().expect("a table"), text);
    }

    #[test]
    fn a_sum_does_not_depend_on_the_order_and_is_kept_in_full() {
        let values = [0.1, 3e-17, 1.0 / 3.0, 2.0, 1e-9, 0.7];
        let sum = |values: &[f64]| {
            values.iter().fold(Sum::default(), |mut sum, value| {
                sum.add((*value).into());
                sum
            })
        };
        let mut both = sum(&values[..2]);
        both.add(sum(&values[2..]));
        let mut backwards = values;
        backwards.reverse();
        assert_eq!([both, sum(&backwards)], [sum(&values); 2]);
        assert_ne!(values.iter().sum::<f64>(), backwards.iter().sum::<f64>(), "floats do depend on it");
        assert!((sum(&values).value() - values.iter().sum::<f64>()).abs() < 1e-15);
        let text = serde_json::to_string(&sum(&values)).expect("JSON");
        assert_eq!(serde_json::from_str::<Sum>(&text).expect("a sum"), sum(&values), "{text}");
        assert_eq!(Sum::from(0.25).value(), 0.25);
        assert_eq!([Sum::from(-1.0), Sum::from(f64::NAN)], [Sum::default(); 2]);
    }
}
