//! The stress set: the tables of `campaign --stress` (docs/stress.md).

use super::error::ReportError;
use super::load::name_of;
use super::rows::{CsvRow, CsvTable};
use rockproof_campaign::stress::steps::STEP_COLUMNS;
use rockproof_campaign::stress::table::{CELL_COLUMNS, LIMIT_COLUMNS, Proof};
use rockproof_campaign::stress::{PairAlignment, StressAxis};
use std::path::{Path, PathBuf};

/// The table that makes a directory one of a stress set.
pub(super) const FILE: &str = "stress.csv";
const LIMITS: &str = "limits.csv";
const STEPS: &str = "steps.csv";

/// One engine on the pairs of one level.
#[derive(Clone, Debug, PartialEq)]
pub struct StressCell {
    /// The curve it is a point of.
    pub curve: Curve,
    /// The level, as in the table: `0` or a power of ten.
    pub level: String,
    /// Pairs examined.
    pub pairs: u64,
    /// Those whose contacts are not the exact ones.
    pub differ: u64,
    /// Of these: rounding the input changed them; the engine calculated them wrongly; rounding destroyed a feature.
    pub sorts: [u64; 3],
    /// The 95 % interval of the share that differs.
    pub interval: [f64; 2],
}

/// What is made more extreme, for which pairs, and who answers.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Curve {
    /// In which way pairs are extreme.
    pub axis: StressAxis,
    /// With or without ties.
    pub form: PairAlignment,
    /// The tolerance set.
    pub setting: String,
    /// The engine.
    pub engine: String,
}

/// How far an engine agrees along an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct StressLimit {
    /// Along which axis, for which pairs, and who.
    pub curve: Curve,
    /// The last level before the first at which any pair differs.
    pub clean_to: Option<String>,
    /// The last level up to which the upper end of the interval is at most 1 %.
    pub safe_to: Option<String>,
    /// Pairs up to there.
    pub pairs: u64,
    /// The first level beyond, and the share that differs there; none where the last level is safe.
    pub beyond: Option<(String, f64)>,
    /// What the pairs of that level prove, as `stress.csv` counts them; [`Proof::Safe`] where there is none.
    pub proof: Proof,
}

/// A step against its closed form.
#[derive(Clone, Debug, PartialEq)]
pub struct StressStep {
    /// `rest` or `contrast`.
    pub case: String,
    /// `rigid` or `deformable`.
    pub motion: String,
    /// The engine.
    pub engine: String,
    /// Steps made, or the ratio of stiffnesses.
    pub level: f64,
    /// The overlap's relative error; none where the run stopped.
    pub error: Option<f64>,
    /// Why it stopped.
    pub stopped: String,
}

/// The stress set of one directory.
#[derive(Clone, Debug, PartialEq)]
pub struct StressRun {
    /// Its directory, as given.
    pub dir: PathBuf,
    /// The name of the directory.
    pub name: String,
    /// In the order of `stress.csv`: axis by axis, level by level.
    pub cells: Vec<StressCell>,
    /// In the order of `limits.csv`.
    pub limits: Vec<StressLimit>,
    /// In the order of `steps.csv`.
    pub steps: Vec<StressStep>,
}

fn curve(row: &CsvRow<'_>, [axis, form, setting, engine]: [usize; 4]) -> Result<Curve, ReportError> {
    let axes = StressAxis::ALL.map(StressAxis::name).join(", ");
    Ok(Curve {
        axis: row.of(axis, &axes, |text| StressAxis::ALL.into_iter().find(|axis| axis.name() == text))?,
        form: row
            .of(form, "aligned or generic", |text| PairAlignment::ALL.into_iter().find(|form| form.name() == text))?,
        setting: row.name(setting)?.to_owned(),
        engine: row.name(engine)?.to_owned(),
    })
}

fn share(row: &CsvRow<'_>, column: usize) -> Result<f64, ReportError> {
    row.of(column, "a share from 0 to 1", |text| text.parse().ok().filter(|share| (0.0..=1.0).contains(share)))
}

/// A level that may be missing.
fn level(row: &CsvRow<'_>, column: usize) -> Result<Option<String>, ReportError> {
    if row.text(column).is_empty() {
        return Ok(None);
    }
    row.of(column, "a level", |text| text.parse::<f64>().ok().filter(|l| l.is_finite()).map(|_| text.to_owned()))
        .map(Some)
}

impl StressRun {
    pub(super) fn read(dir: &Path) -> Result<StressRun, ReportError> {
        let cells = cells(&dir.join(FILE))?;
        let (limits, steps) = (limits(&dir.join(LIMITS), &cells)?, steps(&dir.join(STEPS))?);
        Ok(StressRun { dir: dir.to_owned(), name: name_of(dir), cells, limits, steps })
    }
}

fn cells(file: &Path) -> Result<Vec<StressCell>, ReportError> {
    let mut rows = CsvTable::open(file.to_owned(), &CELL_COLUMNS)?;
    let mut found = Vec::new();
    while let Some(row) = rows.next(&CELL_COLUMNS)? {
        let (pairs, differ) = (row.count(5)?, row.count(9)?);
        if differ > pairs {
            return Err(
                row.invalid_row(&format!("{differ} pairs differ"), &format!("at most {pairs}, as there are pairs"))
            );
        }
        found.push(StressCell {
            curve: curve(&row, [0, 2, 3, 4])?,
            level: level(&row, 1)?.ok_or_else(|| row.invalid_row("no level", "a level"))?,
            pairs,
            differ,
            sorts: [row.count(6)?, row.count(7)?, row.count(8)?],
            interval: [share(&row, 11)?, share(&row, 12)?],
        });
    }
    Ok(found)
}

fn limits(file: &Path, cells: &[StressCell]) -> Result<Vec<StressLimit>, ReportError> {
    let mut rows = CsvTable::open(file.to_owned(), &LIMIT_COLUMNS)?;
    let mut found = Vec::new();
    while let Some(row) = rows.next(&LIMIT_COLUMNS)? {
        let beyond = match level(&row, 9)? {
            Some(level) => Some((level, share(&row, 10)?)),
            None => None,
        };
        let curve = curve(&row, [0, 1, 2, 3])?;
        let proof = match &beyond {
            None => Proof::Safe,
            Some((level, _)) => match cells.iter().find(|cell| cell.curve == curve && cell.level == *level) {
                Some(cell) => Proof::of(cell.differ, cell.pairs),
                None => {
                    return Err(row.invalid_row(&format!("beyond is {level}"), "a level that stress.csv has a row for"));
                }
            },
        };
        found.push(StressLimit {
            curve,
            clean_to: level(&row, 4)?,
            safe_to: level(&row, 5)?,
            pairs: row.count(6)?,
            beyond,
            proof,
        });
    }
    Ok(found)
}

fn steps(file: &Path) -> Result<Vec<StressStep>, ReportError> {
    let mut rows = CsvTable::open(file.to_owned(), &STEP_COLUMNS)?;
    let mut found = Vec::new();
    while let Some(row) = rows.next(&STEP_COLUMNS)? {
        found.push(StressStep {
            case: row.name(0)?.to_owned(),
            motion: row.name(1)?.to_owned(),
            engine: row.name(2)?.to_owned(),
            level: row.number(3)?.ok_or_else(|| row.invalid_row("no level", "a number"))?,
            error: row.number(6)?,
            stopped: row.text(9).to_owned(),
        });
    }
    Ok(found)
}
