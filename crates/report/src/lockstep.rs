//! Runs in which the stepper and the oracle made the same steps.

use super::error::ReportError;
use super::load::{ended, name_of, read_json};
use super::motion;
use super::rows::{CsvRow, CsvTable};
use rockproof_differential::finding::Cause;
use rockproof_model::simulation::step_in_words;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// How many steps a chart shows; of neighbours that do not fit, the one with the larger difference stays.
const POINTS: usize = 2048;

/// How many steps that differ are kept for the table of them.
const KEPT: usize = 200;

const COLUMNS: [&str; 20] = [
    "step",
    "time_s",
    "contacts_differ",
    "modes_differ",
    "iterations_stepper",
    "iterations_oracle",
    "displacement_error",
    "penetration_stepper_m",
    "penetration_oracle_m",
    "undecided",
    "tolerance",
    "representation",
    "arithmetic",
    "defect",
    "effect",
    "failure",
    "converged_stepper",
    "converged_oracle",
    "penetration_contacts_m",
    "penetration_modes_m",
];

/// What is read of `differences.csv`.
const DIFFERENCES: [&str; 4] = ["step", "cause", "change", "predicate"];

/// A step in which the stepper has other contacts, modes or iterations.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DifferingStep {
    /// Its number.
    pub step: i64,
    /// Differences of its contacts; contacts whose mode differs.
    pub contacts_modes: [u64; 2],
    /// Solves of the stepper, of the oracle.
    pub iterations: [u64; 2],
    /// What made the penetration another one.
    pub effect: String,
    /// The deepest overlap after the step (m): the stepper's, the oracle's, the stepper's with the oracle's contacts, and with its modes too.
    pub depths_m: [Option<f64>; 4],
    /// The largest relative error of a displacement.
    pub displacement_error: Option<f64>,
}

/// Differences of one sort.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DifferenceCount {
    /// How many.
    pub differences: u64,
    /// In how many steps.
    pub steps: u64,
    last: Option<i64>,
}

/// One step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepPoint {
    /// Its number.
    pub step: i64,
    /// The time after it (s).
    pub time_s: f64,
    /// The deepest overlap after the stepper's step (m), if there is one.
    pub stepper_m: Option<f64>,
    /// The deepest overlap after the oracle's step (m), if there is one.
    pub oracle_m: Option<f64>,
    /// Solves of the stepper less those of the oracle.
    pub more_iterations: i64,
}

impl StepPoint {
    fn difference(&self) -> f64 {
        (self.stepper_m.unwrap_or(0.0) - self.oracle_m.unwrap_or(0.0)).abs()
            + self.more_iterations.unsigned_abs() as f64
    }
}

/// A run in which the stepper and the oracle made the same steps, counted.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LockstepRun {
    /// Its directory, as given.
    pub dir: PathBuf,
    /// The name of the directory.
    pub name: String,
    /// The engine.
    pub engine: String,
    /// Steps made.
    pub steps: u64,
    /// Steps whose contacts differ.
    pub contacts_differ: u64,
    /// Steps with a contact whose mode differs.
    pub modes_differ: u64,
    /// Steps with other numbers of solves.
    pub iterations_differ: u64,
    /// Steps of which one side converged and the other did not.
    pub converged_differ: u64,
    /// Decisions the oracle's cap left open.
    pub undecided: u64,
    /// Differences by cause.
    pub causes: BTreeMap<Cause, u64>,
    /// Steps by what changed the penetration.
    pub effects: BTreeMap<String, u64>,
    /// The largest relative error of a displacement.
    pub displacement_error: f64,
    /// The deepest overlap after any step of the stepper, of the oracle (m).
    pub deepest_m: [f64; 2],
    /// The largest difference of the two after one step (m).
    pub penetration_difference_m: f64,
    /// Why one side could not make a step.
    pub failure: Option<String>,
    /// Differences by cause, change and the predicate behind it, if there is one.
    pub sorts: BTreeMap<(Cause, String, String), DifferenceCount>,
    /// The first steps that differ.
    pub differing: Vec<DifferingStep>,
    /// How many more there are.
    pub more_differing: u64,
    /// What charts show.
    pub points: Vec<StepPoint>,
}

#[derive(Deserialize)]
struct RunFile {
    #[serde(default)]
    engine: String,
}

impl LockstepRun {
    pub(super) fn read(dir: &Path) -> Result<LockstepRun, ReportError> {
        let RunFile { engine } = read_json(&ended(dir, motion::FILE)?)?;
        let mut run = LockstepRun { dir: dir.to_owned(), name: name_of(dir), engine, ..LockstepRun::default() };
        let mut rows = CsvTable::open_wider(dir.join("lockstep.csv"), &COLUMNS)?;
        let mut stride = 1;
        let mut seen = 0;
        while let Some(row) = rows.next(&COLUMNS)? {
            let point = run.add(&row)?;
            match run.points.last_mut() {
                Some(last) if seen % stride != 0 => {
                    if point.difference() > last.difference() {
                        *last = point;
                    }
                }
                _ => run.points.push(point),
            }
            seen += 1;
            if run.points.len() > POINTS && seen % stride == 0 {
                run.points = run.points.chunks(2).map(larger).collect();
                stride *= 2;
            }
        }
        run.read_differences(dir)?;
        Ok(run)
    }

    fn read_differences(&mut self, dir: &Path) -> Result<(), ReportError> {
        let mut rows = CsvTable::open_wider(dir.join("differences.csv"), &DIFFERENCES)?;
        while let Some(row) = rows.next(&DIFFERENCES)? {
            let step = row.of(0, "the number of a step", |text| text.parse::<i64>().ok())?;
            let cause = row.of(1, "a cause", Cause::from_name)?;
            let sort = self.sorts.entry((cause, row.name(2)?.to_owned(), row.text(3).to_owned())).or_default();
            sort.differences += 1;
            sort.steps += u64::from(sort.last != Some(step));
            sort.last = Some(step);
        }
        Ok(())
    }

    fn add(&mut self, row: &CsvRow<'_>) -> Result<StepPoint, ReportError> {
        let step = row.of(0, "the number of a step", |text| text.parse::<i64>().ok())?;
        let count = |column| if row.text(column).is_empty() { Ok(0) } else { row.count(column) };
        self.steps += 1;
        self.contacts_differ += u64::from(count(2)? > 0);
        self.modes_differ += u64::from(count(3)? > 0);
        let iterations = [count(4)?, count(5)?];
        self.iterations_differ += u64::from(iterations[0] != iterations[1]);
        self.converged_differ += u64::from(row.text(16) != row.text(17));
        self.undecided += count(9)?;
        let [tolerance, representation, arithmetic, defect] = [count(10)?, count(11)?, count(12)?, count(13)?];
        let causes = [Cause::Tolerance, Cause::Representation, Cause::Arithmetic, Cause::Defect];
        for (cause, count) in causes.into_iter().zip([tolerance, representation, arithmetic, defect]) {
            *self.causes.entry(cause).or_default() += count;
        }
        if !row.text(14).is_empty() {
            *self.effects.entry(row.text(14).to_owned()).or_default() += 1;
        }
        if !row.text(15).is_empty() {
            self.failure = Some(format!("{}: {}", step_in_words(step), row.text(15)));
        }
        self.displacement_error = self.displacement_error.max(row.number(6)?.unwrap_or(0.0));
        let (stepper_m, oracle_m) = (row.number(7)?, row.number(8)?);
        for (deepest, depth) in self.deepest_m.iter_mut().zip([stepper_m, oracle_m]) {
            *deepest = deepest.max(depth.unwrap_or(0.0));
        }
        if let (Some(stepper), Some(oracle)) = (stepper_m, oracle_m) {
            self.penetration_difference_m = self.penetration_difference_m.max((stepper - oracle).abs());
        }
        let contacts_modes = [count(2)?, count(3)?];
        if contacts_modes != [0, 0] || iterations[0] != iterations[1] || row.text(16) != row.text(17) {
            if self.differing.len() < KEPT {
                self.differing.push(DifferingStep {
                    step,
                    contacts_modes,
                    iterations,
                    effect: row.text(14).to_owned(),
                    depths_m: [stepper_m, oracle_m, row.number(18)?, row.number(19)?],
                    displacement_error: row.number(6)?,
                });
            } else {
                self.more_differing += 1;
            }
        }
        let more_iterations = iterations[0] as i64 - iterations[1] as i64;
        Ok(StepPoint { step, time_s: row.number(1)?.unwrap_or(0.0), stepper_m, oracle_m, more_iterations })
    }
}

fn larger(points: &[StepPoint]) -> StepPoint {
    let more = |a: StepPoint, b: &StepPoint| if b.difference() > a.difference() { *b } else { a };
    points.iter().fold(points.first().copied().unwrap_or_default(), more)
}
