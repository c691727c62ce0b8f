//! Counts the findings about a campaign's steps while reading them, in memory that does not grow with their number.

use super::error::ReportError;
use super::load::{is_made_for_ties, setting};
use super::rows::CsvTable;
use rockproof_campaign::steps::{STEP_FINDING_COLUMNS, StepFindingRow};
use rockproof_differential::finding::Cause;
use rockproof_differential::lockstep::{Intrusion, StepCause};
use rockproof_model::text::{EXCERPT_LENGTH, excerpt};
use rockproof_results::is_inside;
use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::path::Path;

/// The causes in the order in which they worry: what no shorter step mends before what one does.
const WORRYING: [StepCause; 7] = [
    StepCause::Link(Cause::Defect),
    StepCause::Link(Cause::Engine),
    StepCause::Link(Cause::Arithmetic),
    StepCause::Link(Cause::Representation),
    StepCause::Link(Cause::Tolerance),
    StepCause::NotHeld,
    StepCause::StepLength,
];

/// The place of a cause among [`WORRYING`].
fn place(cause: StepCause) -> usize {
    WORRYING.iter().position(|known| *known == cause).unwrap_or(WORRYING.len())
}

/// Findings by cause, those that worry most first.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StepCauses([u64; WORRYING.len()]);

impl StepCauses {
    fn add(&mut self, cause: StepCause) {
        if let Some(count) = self.0.get_mut(place(cause)) {
            *count += 1;
        }
    }

    /// Adds the counts of `other`.
    pub(super) fn add_all(&mut self, other: &StepCauses) {
        self.0.iter_mut().zip(other.0).for_each(|(sum, count)| *sum += count);
    }

    /// All of them.
    pub fn total(&self) -> u64 {
        self.0.iter().sum()
    }

    /// How many have this cause.
    pub fn count(&self, cause: StepCause) -> u64 {
        self.0.get(place(cause)).copied().unwrap_or(0)
    }

    /// The causes that there are, with their counts.
    pub fn counts(&self) -> impl Iterator<Item = (StepCause, u64)> {
        WORRYING.into_iter().zip(self.0).filter(|(_, count)| *count > 0)
    }
}

/// A finding about a step, as the verdict names it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WorstStep {
    /// The pair's number.
    pub index: u64,
    /// The pair's family.
    pub family: String,
    /// The tolerance set.
    pub tolerances: String,
    /// Why the step is another one.
    pub cause: StepCause,
    /// What differs.
    pub change: String,
    /// The case file, in the directory of the run; empty where there is none.
    pub case: String,
}

impl WorstStep {
    /// A defect first, then what has a case to replay, then passages before unseen overlaps before all else, then by cause; of equal ones a
    /// setting that somebody would take, then the first pair.
    pub(super) fn rank(&self, other: &WorstStep) -> Ordering {
        let key = |of: &WorstStep| {
            let kind = [Intrusion::Passage, Intrusion::Unseen].iter().position(|kind| kind.name() == of.change);
            let defect = of.cause == StepCause::Link(Cause::Defect);
            (
                !defect,
                of.case.is_empty(),
                kind.unwrap_or(2),
                place(of.cause),
                is_made_for_ties(&setting(&of.tolerances)),
                of.index,
            )
        };
        key(self).cmp(&key(other)).then_with(|| self.case.cmp(&other.case))
    }

    /// Whether it is a mistake in code, a passage or an unseen overlap: to look at before what merely differs.
    pub fn is_serious(&self) -> bool {
        self.cause == StepCause::Link(Cause::Defect) || self.is_intrusion()
    }

    /// Whether it is about a passage or an unseen overlap.
    fn is_intrusion(&self) -> bool {
        is_intrusion(&self.change)
    }
}

fn is_intrusion(change: &str) -> bool {
    [Intrusion::Passage, Intrusion::Unseen].iter().any(|kind| kind.name() == change)
}

/// The findings about a campaign's steps, counted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StepTally {
    /// Passages and unseen overlaps by cause.
    pub intrusions: StepCauses,
    /// All other findings by cause.
    pub others: StepCauses,
    /// Other findings by what differs.
    pub changes: BTreeMap<String, u64>,
    /// The worst passage or unseen overlap.
    pub worst_intrusion: Option<WorstStep>,
    /// The worst other finding.
    pub worst_other: Option<WorstStep>,
}

impl StepTally {
    /// Counts the rows of a `step_findings.csv`.
    pub(super) fn read(file: &Path) -> Result<StepTally, ReportError> {
        let mut rows = CsvTable::open(file.to_owned(), &STEP_FINDING_COLUMNS)?;
        let mut tally = StepTally::default();
        while let Some(row) = rows.next(&STEP_FINDING_COLUMNS)? {
            let finding: StepFindingRow = row.parsed()?;
            if !finding.case.is_empty() && !is_inside(&finding.case) {
                return Err(row.invalid_row(
                    &format!("case is \"{}\"", excerpt(&finding.case, EXCERPT_LENGTH)),
                    "the name of a file in the directory of the run, as cases/NAME.json",
                ));
            }
            tally.add(finding);
        }
        Ok(tally)
    }

    pub(super) fn add(&mut self, row: StepFindingRow) {
        let StepFindingRow { index, family, tolerances, cause, change, case, .. } = row;
        let finding = WorstStep { index, family, tolerances, cause, change, case };
        let (causes, worst) = if finding.is_intrusion() {
            (&mut self.intrusions, &mut self.worst_intrusion)
        } else {
            *self.changes.entry(finding.change.clone()).or_default() += 1;
            (&mut self.others, &mut self.worst_other)
        };
        causes.add(cause);
        if worst.as_ref().is_none_or(|known| finding.rank(known) == Ordering::Less) {
            *worst = Some(finding);
        }
    }

    /// All of them.
    pub fn total(&self) -> u64 {
        self.intrusions.total() + self.others.total()
    }

    /// How many are mistakes in code.
    pub fn defects(&self) -> u64 {
        [&self.intrusions, &self.others].map(|causes| causes.count(StepCause::Link(Cause::Defect))).iter().sum()
    }

    /// The step to look at first that has a case: a mistake in code, else a passage or an unseen overlap, else any other.
    pub fn worst_of_all(&self) -> Option<&WorstStep> {
        let known =
            [&self.worst_intrusion, &self.worst_other].into_iter().flatten().filter(|worst| !worst.case.is_empty());
        known.min_by(|one, other| one.rank(other))
    }
}
