// Longer than 400 lines: the rows of one table, how each is measured, and how they are written and drawn.
//! Run time against error: what an answer costs and how wrong it is, for every engine on the same subjects.

use super::closed_forms::{SCENES, SETS, TIME_STEPS};
use crate::plot::{Legend, Marks, Plot, PlotAxis, PlotError, Series};
use num_rational::BigRational;
use rockproof_campaign::source::{SourceError, set_source};
use rockproof_differential::row::written;
use rockproof_differential::{builtin, engine};
use rockproof_model::{Block, Contact, Precision, SceneError, SpecError, ToleranceSet};
use rockproof_oracle::{self, Pair, plain};
use rockproof_pairs::batch::{self, PairConfig};
use rockproof_pairs::families::{self, Family};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

rockproof_model::named_enum! {
    /// Who answers, from the cheapest.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
    pub enum MeasuredEngine {
        /// The stepper in f32.
        F32 = "stepper-f32",
        /// The stepper in f64.
        F64 = "stepper-f64",
        /// The oracle: its fast path, or its exact step.
        Certified = "certified",
        /// The oracle in plain rationals.
        Exact = "exact",
    }
}

/// What an error is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorQuantity {
    /// A displacement, relative.
    Displacement,
    /// An overlap, relative.
    Overlap,
    /// A volume, relative.
    Volume,
    /// The share of pairs whose contacts are not the exact ones.
    Contacts,
}

impl ErrorQuantity {
    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self {
            ErrorQuantity::Displacement => "displacement",
            ErrorQuantity::Overlap => "overlap",
            ErrorQuantity::Volume => "volume",
            ErrorQuantity::Contacts => "contacts",
        }
    }
}

/// One row of `bench.csv` (docs/bench.md).
#[derive(Clone, Debug, PartialEq)]
pub struct AccuracyRow {
    /// `scene` or `family`.
    pub kind: &'static str,
    /// The scene or family.
    pub subject: &'static str,
    /// Who answered.
    pub engine: MeasuredEngine,
    /// The tolerance set.
    pub tolerances: &'static str,
    /// Δt (s); none for families.
    pub time_step: Option<f64>,
    /// Steps or pairs.
    pub units: u64,
    /// µs for each.
    pub micros: f64,
    /// The error.
    pub error: f64,
    /// What it is of.
    pub of: ErrorQuantity,
    /// Whether nothing else of the subject is both cheaper and at least as right.
    pub front: bool,
    /// Why there is no figure; else empty.
    pub note: String,
}

impl AccuracyRow {
    /// A row without figures.
    pub(super) fn of_scene(
        subject: &'static str,
        engine: MeasuredEngine,
        tolerances: &'static str,
        time_step: f64,
        of: ErrorQuantity,
    ) -> AccuracyRow {
        let (time_step, kind) = (Some(time_step), "scene");
        let (units, micros, error, front, note) = (0, f64::NAN, f64::NAN, false, String::new());
        AccuracyRow { kind, subject, engine, tolerances, time_step, units, micros, error, of, front, note }
    }

    fn has_figures(&self) -> bool {
        self.micros.is_finite() && self.error.is_finite()
    }
}

/// The columns of `bench.csv`.
pub const ERROR_COLUMNS: [&str; 11] = [
    "kind",
    "subject",
    "engine",
    "tolerances",
    "time_step_s",
    "units",
    "us_per_unit",
    "error",
    "error_of",
    "front",
    "note",
];

/// Why nothing can be measured.
#[derive(Debug, thiserror::Error)]
pub enum AccuracyError {
    /// A scene that comes with the program cannot be read.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// There are no tolerances.
    #[error(transparent)]
    Tolerances(#[from] SpecError),
    /// A set or family does not exist.
    #[error(transparent)]
    Source(#[from] SourceError),
    /// The plot cannot be drawn.
    #[error(transparent)]
    Plot(#[from] PlotError),
    /// The table cannot be written.
    #[error("cannot write the table: {0}")]
    Csv(#[from] csv::Error),
}

/// How much is measured.
#[derive(Clone, Copy, Debug)]
pub struct AccuracyOptions {
    /// Pairs of each family.
    pub pairs: usize,
    /// Seed of the pairs.
    pub seed: u64,
    /// Whether only the Δt of each file is tried, and few families.
    pub quick: bool,
}

/// The families whose pairs are classified.
const FAMILIES: [&str; 7] =
    ["face_stack", "edge_cross", "quasi_parallel_edges", "sliver", "size_ratio", "far_origin", "real"];

/// The presets for them.
const PRESETS: [&str; 3] = ["auto", "shi", "zero"];

/// Plain rationals get one pair in this many.
const PLAIN_EVERY: usize = 8;

/// Measures everything; `watch` hears what is next.
///
/// # Errors
/// When a subject cannot be had.
pub fn measure(effort: AccuracyOptions, watch: &mut dyn FnMut(&str)) -> Result<Vec<AccuracyRow>, AccuracyError> {
    let mut rows = Vec::new();
    let patience = Duration::from_secs(if effort.quick { 1 } else { 8 });
    for closed in SCENES {
        watch(closed.name);
        for engine in [MeasuredEngine::F32, MeasuredEngine::F64, MeasuredEngine::Certified] {
            for set in SETS {
                for factor in TIME_STEPS {
                    if !effort.quick || (factor == TIME_STEPS[0] && set == SETS[0]) {
                        rows.push(closed.run(engine, (set, factor), patience)?);
                    }
                }
            }
        }
    }
    let count = if effort.quick { 2 } else { FAMILIES.len() };
    for name in &FAMILIES[..count] {
        watch(name);
        for preset in PRESETS {
            rows.extend(family(name, preset, effort)?);
        }
    }
    mark_front(&mut rows);
    Ok(rows)
}

/// Contacts, or none where the engine gives no answer; and the seconds it took.
type Timed = (Option<Vec<Contact>>, f64);

fn family(
    name: &'static str,
    preset: &'static str,
    effort: AccuracyOptions,
) -> Result<Vec<AccuracyRow>, AccuracyError> {
    let family: Arc<dyn Family> = families::named(&[name])
        .ok()
        .and_then(|found| found.into_iter().next())
        .ok_or_else(|| SourceError::Family { found: name.to_owned(), allowed: FAMILIES.join(", ") })?;
    let config = PairConfig {
        families: vec![family],
        sets: vec![set_source(preset)?],
        sets_per_batch: 1,
        ladder_percent: 0,
        ..PairConfig::default()
    };
    let cases: Vec<batch::PairCase> =
        (0..).flat_map(|batch| batch::batch(effort.seed, batch, &config)).take(effort.pairs).collect();
    let mut sums: BTreeMap<MeasuredEngine, (u64, u64, f64)> = BTreeMap::new();
    for (number, case) in cases.iter().enumerate() {
        let Some(set) = case.sets.first() else { continue };
        for engine in MeasuredEngine::ALL {
            if engine == MeasuredEngine::Exact && !number.is_multiple_of(PLAIN_EVERY) {
                continue;
            }
            let (set, blocks) = (if engine == MeasuredEngine::F32 { &set.f32 } else { &set.f64 }, (&case.a, &case.b));
            let (answer, seconds) = least_time(engine, blocks, set);
            let right = answer.is_some_and(|contacts| match engine {
                MeasuredEngine::F32 | MeasuredEngine::F64 => contacts == certified(blocks, set).0,
                // They are what the others are judged by; a test holds them against one another.
                MeasuredEngine::Certified | MeasuredEngine::Exact => true,
            });
            let sum = sums.entry(engine).or_default();
            *sum = (sum.0 + 1, sum.1 + u64::from(!right), sum.2 + seconds);
        }
    }
    let row = |(engine, (units, wrong, seconds)): (MeasuredEngine, (u64, u64, f64))| AccuracyRow {
        kind: "family",
        subject: name,
        engine,
        tolerances: preset,
        time_step: None,
        units,
        micros: 1e6 * seconds / units.max(1) as f64,
        error: wrong as f64 / units.max(1) as f64,
        of: ErrorQuantity::Contacts,
        front: false,
        note: String::new(),
    };
    Ok(sums.into_iter().map(row).collect())
}

fn certified((a, b): (&Block, &Block), set: &ToleranceSet) -> (Vec<Contact>, f64) {
    let begun = Instant::now();
    let prepared = [rockproof_oracle::PreparedBlock::new(a), rockproof_oracle::PreparedBlock::new(b)];
    let contacts = Pair::new(&prepared[0], &prepared[1]).classify(set).contacts;
    (contacts, begun.elapsed().as_secs_f64())
}

/// How often a classification is timed; the first time it fetches its code and the blocks from memory, whichever engine comes first.
const ROUNDS: usize = 4;

/// The least time of several rounds; of plain rationals, which take thousands of times as long as fetching, one.
fn least_time(engine: MeasuredEngine, blocks: (&Block, &Block), set: &ToleranceSet) -> Timed {
    let (answer, first) = timed(engine, blocks, set);
    if engine == MeasuredEngine::Exact {
        return (answer, first);
    }
    let seconds = (1..ROUNDS).map(|_| timed(engine, blocks, set).1).fold(first, f64::min);
    (answer, seconds)
}

/// Makes both blocks ready and classifies them. Rounding the input is not timed: an engine's input is in its precision.
fn timed(engine: MeasuredEngine, (a, b): (&Block, &Block), set: &ToleranceSet) -> Timed {
    let precision = match engine {
        MeasuredEngine::F32 => Precision::F32,
        MeasuredEngine::F64 => Precision::F64,
        MeasuredEngine::Certified => {
            let (contacts, seconds) = certified((a, b), set);
            return (Some(contacts), seconds);
        }
        MeasuredEngine::Exact => {
            let begun = Instant::now();
            let found = plain::classify::<BigRational>(a, b, set);
            let seconds = begun.elapsed().as_secs_f64();
            return (Some(found.into_iter().map(|found| found.contact).collect()), seconds);
        }
    };
    let (Some(a), Some(b), Ok(set)) = (a.rounded(precision), b.rounded(precision), set.rounded(precision)) else {
        return (None, 0.0);
    };
    let Some(stepper) = builtin::engine(engine.name()) else { return (None, 0.0) };
    let begun = Instant::now();
    let answer = engine::catch_panic(|| stepper.prepare(&a, &b).and_then(|pair| pair.classify(&set)));
    (answer.ok(), begun.elapsed().as_secs_f64())
}

/// Marks the rows of each subject that nothing beats in time and error at once.
fn mark_front(rows: &mut [AccuracyRow]) {
    let figures: Vec<(&'static str, f64, f64)> = rows
        .iter()
        .map(|row| {
            if row.has_figures() {
                (row.subject, row.micros, row.error)
            } else {
                (row.subject, f64::INFINITY, f64::INFINITY)
            }
        })
        .collect();
    for (number, row) in rows.iter_mut().enumerate() {
        let (subject, micros, error) = figures[number];
        let beaten = figures
            .iter()
            .any(|(other, m, e)| *other == subject && *m <= micros && *e <= error && (*m < micros || *e < error));
        row.front = row.has_figures() && !beaten;
    }
}

/// A figure as the table has it.
fn as_written(value: f64) -> String {
    format!("{value:.4e}")
}

/// `bench.csv`.
///
/// # Errors
/// Those of the CSV writer.
pub fn to_csv(rows: &[AccuracyRow]) -> Result<Vec<u8>, csv::Error> {
    let number = |value: f64| if value.is_finite() { as_written(value) } else { String::new() };
    written(
        &ERROR_COLUMNS,
        rows.iter().map(|row| {
            [
                row.kind.to_owned(),
                row.subject.to_owned(),
                row.engine.name().to_owned(),
                row.tolerances.to_owned(),
                row.time_step.map_or(String::new(), number),
                row.units.to_string(),
                number(row.micros),
                number(row.error),
                row.of.name().to_owned(),
                u8::from(row.front).to_string(),
                row.note.clone(),
            ]
        }),
    )
}

/// Time and error of the rows of one kind, by engine, with rings around those that nothing beats for their subject. An error of 0
/// lies at the lower end. Each point tells what was measured by which engine, tolerances and Δt. Points lie where the figures of `bench.csv` put them, so that the plot can be made from the table alone.
///
/// # Errors
/// When there is nothing to draw.
pub fn plot(rows: &[AccuracyRow], kind: &str) -> Result<String, PlotError> {
    let point = |r: &AccuracyRow| [r.micros, r.error].map(|value| as_written(value).parse().unwrap_or(value));
    let (unit, error) =
        if kind == "scene" { ("step", "relative error") } else { ("pair", "share of pairs with wrong contacts") };
    let title = |r: &AccuracyRow| {
        let step = r.time_step.map_or(String::new(), |step| format!(", Δt {step:.3e} s"));
        let ([micros, error], of) = (point(r), r.of.name());
        let front = if r.front { "; nothing beats it" } else { "" };
        format!(
            "{}: {}, {}{step}: {micros:.3} µs a {unit}, error of {of} {error:.2e}{front}",
            r.subject,
            r.engine.name(),
            r.tolerances
        )
    };
    let series = |name: &str, marks, wanted: &dyn Fn(&AccuracyRow) -> bool| {
        let all = || rows.iter().filter(|r| r.kind == kind && r.has_figures() && wanted(r));
        let (points, titles) = (all().map(point).collect(), all().map(title).collect());
        Series { name: name.to_owned(), points, intervals: Vec::new(), titles, marks }
    };
    let mut all: Vec<Series> = MeasuredEngine::ALL
        .into_iter()
        .map(|engine| series(engine.name(), Marks::Dots, &|r| r.engine == engine))
        .collect();
    all.push(series("nothing beats it", Marks::Rings, &|r| r.front));
    all.retain(|series| !series.points.is_empty());
    let title = format!("Run time against error, one point a {kind}, engine, tolerance set and Δt");
    Plot {
        title,
        x: PlotAxis::log(format!("µs a {unit}")),
        y: PlotAxis::log(error),
        series: all,
        legend: Legend::Beside,
    }
    .svg()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_is_what_nothing_beats() {
        let row = |micros, error| AccuracyRow {
            micros,
            error,
            ..AccuracyRow::of_scene("one", MeasuredEngine::F64, "auto", 0.1, ErrorQuantity::Overlap)
        };
        let mut rows = vec![row(1.0, 0.1), row(2.0, 0.1), row(3.0, 0.01), row(f64::NAN, 0.0)];
        rows.push(AccuracyRow { subject: "other", ..row(9.0, 0.5) });
        mark_front(&mut rows);
        assert_eq!(rows.iter().map(|r| r.front).collect::<Vec<_>>(), [true, false, true, false, true]);
    }

    #[test]
    fn plain_rationals_say_what_the_fast_path_says() {
        let config = PairConfig { sets: vec![set_source("auto").expect("auto")], ..PairConfig::default() };
        for case in batch::batch(9, 3, &config) {
            let set = &case.sets[0].f64;
            let plainly = plain::classify::<BigRational>(&case.a, &case.b, set);
            let plainly: Vec<Contact> = plainly.into_iter().map(|found| found.contact).collect();
            assert_eq!(plainly, certified((&case.a, &case.b), set).0);
        }
    }
}
