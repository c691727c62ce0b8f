//! The stress table: how many pairs of each cell an engine answers otherwise than the oracle, and up to where it does not.

use super::axis::{CellKey, PairAlignment, StressAxis, StressLevel, cells};
use crate::proportion::{is_above, trials_to_tell, wilson};
use crate::summary::Summary;
use rockproof_differential::compare::AnswerChange;
use rockproof_differential::finding::{Cause, FINDING_COLUMNS, FindingScope};
use rockproof_differential::row::{FindingRow, typed_rows, written};
use rockproof_model::Precision;
use std::collections::{BTreeMap, BTreeSet};
use std::io::Read;

/// One engine on the pairs of one cell under one tolerance set.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CellRow {
    /// The cell.
    pub cell: CellKey,
    /// The tolerance set.
    pub tolerances: String,
    /// The engine.
    pub engine: String,
    /// Pairs examined.
    pub pairs: u64,
    /// Pairs whose exact contacts change when the input is rounded.
    pub representation: u64,
    /// Pairs whose rounded input the engine answers wrongly.
    pub arithmetic: u64,
    /// Pairs in which rounding destroys a feature, or that the engine cannot take.
    pub lost: u64,
    /// Pairs of any of these sorts.
    pub differ: u64,
}

/// The columns of `stress.csv`. `low` and `high` are the 95 % interval (Wilson) of the share of pairs that differ.
pub const CELL_COLUMNS: [&str; 13] = [
    "axis",
    "level",
    "form",
    "tolerances",
    "engine",
    "pairs",
    "representation",
    "arithmetic",
    "lost",
    "differ",
    "share",
    "low",
    "high",
];

/// How far one engine agrees along one axis.
#[derive(Clone, Debug, PartialEq)]
pub struct AgreementLimit {
    /// The axis.
    pub axis: StressAxis,
    /// With or without ties.
    pub form: PairAlignment,
    /// The tolerance set.
    pub tolerances: String,
    /// The engine.
    pub engine: String,
    /// The most extreme level up to which no pair differs; `None` where some differ at the mildest one.
    pub clean: Option<StressLevel>,
    /// The most extreme level up to which the upper bound of the share that differs stays at 1 %.
    pub safe: Option<StressLevel>,
    /// Pairs examined up to `safe`, those that differ, and the upper bound of the share over all of them.
    pub up_to_safe: (u64, u64, f64),
    /// The first level beyond `safe` with the share that differs there; `None` where the last level is safe.
    pub beyond: Option<(StressLevel, f64)>,
    /// What the pairs of `beyond` prove; [`Proof::Safe`] where there is none.
    pub proof: Proof,
}

/// What the pairs of a cell prove, with 95 % confidence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Proof {
    /// At most [`SAFE_SHARE`] of such pairs differ.
    Safe,
    /// More than [`SAFE_SHARE`] differ.
    Unsafe,
    /// There are too few pairs to tell.
    TooFew {
        /// So many in the cell would, if the share that differs stays what it is; `None` where it is at the limit itself.
        needed: Option<u64>,
    },
}

impl Proof {
    /// What `differ` of `pairs` prove.
    pub fn of(differ: u64, pairs: u64) -> Proof {
        let [_, high] = wilson(differ, pairs);
        if high <= SAFE_SHARE {
            Proof::Safe
        } else if is_above(differ, pairs, SAFE_SHARE) {
            // Wilson's lower end is above the limit too early where few are counted: 1 of 16 has an end of 1.1 %, and is there by chance in 15 of 100 cells.
            Proof::Unsafe
        } else {
            Proof::TooFew { needed: trials_to_tell(differ, pairs, SAFE_SHARE) }
        }
    }
}

/// The columns of `limits.csv`.
pub const LIMIT_COLUMNS: [&str; 11] = [
    "axis",
    "form",
    "tolerances",
    "engine",
    "clean_to",
    "safe_to",
    "pairs_to_safe",
    "differ_to_safe",
    "high_to_safe",
    "beyond",
    "share_beyond",
];

/// The share of pairs that may differ where an engine is called safe, as an upper bound.
pub const SAFE_SHARE: f64 = 0.01;

/// Why a table cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum TableError {
    /// The header lacks a column, or cannot be read.
    #[error("findings.csv: {source}")]
    Header {
        /// What is wrong.
        source: csv::Error,
    },
    /// A row that is none of a stress campaign, or cannot be read.
    #[error("findings.csv: row {row} is not of a stress campaign: {source}")]
    Row {
        /// Its number, from 1.
        row: usize,
        /// What is wrong.
        source: csv::Error,
    },
}

/// What is known of one cell, set and engine while rows are read.
#[derive(Default)]
struct Count {
    representation: BTreeSet<u64>,
    arithmetic: BTreeSet<u64>,
    lost: BTreeSet<u64>,
}

/// The rows of all cells, sets and engines, from what a campaign counted and found.
///
/// # Errors
/// When the findings are not those of a stress campaign.
pub fn rows(
    summary: &Summary,
    findings: impl Read,
    engines: &[(String, Precision)],
) -> Result<Vec<CellRow>, TableError> {
    let mut counts: BTreeMap<(String, String, String, String), Count> = BTreeMap::new();
    let records = typed_rows(findings, &FINDING_COLUMNS).map_err(|source| TableError::Header { source })?;
    for (row, record) in records.enumerate() {
        let row: FindingRow = record.map_err(|source| TableError::Row { row: row + 1, source })?;
        if row.cause == Cause::Tolerance {
            continue;
        }
        let is_of = |name: &str, precision: Precision| match &row.engine {
            FindingScope::Any => false,
            // What rounding does concerns every engine of the precision.
            FindingScope::Rounded(rounded) => *rounded == precision,
            FindingScope::Engine(engine) => **engine == *name,
        };
        for (engine, _) in engines.iter().filter(|(name, precision)| is_of(name, *precision)) {
            let key = (row.family.clone(), row.form.clone(), row.tolerances.clone(), engine.clone());
            let count = counts.entry(key).or_default();
            match (row.cause, row.change) {
                (_, AnswerChange::Collapsed | AnswerChange::Failure | AnswerChange::Unsupported) => {
                    count.lost.insert(row.index)
                }
                (Cause::Representation, _) => count.representation.insert(row.index),
                _ => count.arithmetic.insert(row.index),
            };
        }
    }
    let mut rows = Vec::new();
    for cell in cells() {
        let family = cell.family();
        let sets = summary.examined().filter(|(origin, _)| origin.family == family && origin.form == cell.form.name());
        for (origin, pairs) in sets {
            for (engine, _) in engines {
                let key = (family.clone(), origin.form.clone(), origin.tolerances.clone(), engine.clone());
                let none = Count::default();
                let count = counts.get(&key).unwrap_or(&none);
                let all: BTreeSet<&u64> =
                    count.representation.iter().chain(&count.arithmetic).chain(&count.lost).collect();
                rows.push(CellRow {
                    cell,
                    tolerances: origin.tolerances.clone(),
                    engine: engine.clone(),
                    pairs,
                    representation: count.representation.len() as u64,
                    arithmetic: count.arithmetic.len() as u64,
                    lost: count.lost.len() as u64,
                    differ: all.len() as u64,
                });
            }
        }
    }
    Ok(rows)
}

/// How far each engine agrees along each axis, under each set.
pub fn limits(rows: &[CellRow]) -> Vec<AgreementLimit> {
    let mut groups: BTreeMap<(StressAxis, PairAlignment, &str, &str), Vec<&CellRow>> = BTreeMap::new();
    for row in rows {
        groups.entry((row.cell.axis, row.cell.form, &row.tolerances, &row.engine)).or_default().push(row);
    }
    let limit = |((axis, form, tolerances, engine), rows): (_, Vec<&CellRow>)| {
        let until = |fine: &dyn Fn(&CellRow) -> bool| rows.iter().take_while(|row| fine(row)).count();
        let clean = until(&|row| row.differ == 0);
        let safe = until(&|row| Proof::of(row.differ, row.pairs) == Proof::Safe);
        let (pairs, differ) = rows[..safe].iter().fold((0, 0), |(n, d), row| (n + row.pairs, d + row.differ));
        let level = |count: usize| count.checked_sub(1).map(|last: usize| rows[last].cell.level);
        let share = |row: &CellRow| row.differ as f64 / row.pairs.max(1) as f64;
        let (tolerances, engine): (&str, &str) = (tolerances, engine);
        AgreementLimit {
            axis,
            form,
            tolerances: tolerances.to_owned(),
            engine: engine.to_owned(),
            clean: level(clean),
            safe: level(safe),
            up_to_safe: (pairs, differ, wilson(differ, pairs)[1]),
            beyond: rows.get(safe).map(|row| (row.cell.level, share(row))),
            proof: rows.get(safe).map_or(Proof::Safe, |row| Proof::of(row.differ, row.pairs)),
        }
    };
    groups.into_iter().map(limit).collect()
}

impl AgreementLimit {
    /// What it says, in one sentence for an engineer.
    pub fn sentence(&self) -> String {
        let (engine, form, what) = (&self.engine, self.form.name(), self.axis.description());
        let set = &self.tolerances;
        let beyond = match (self.beyond, self.proof) {
            (Some((level, _)), Proof::TooFew { .. }) => format!("; at {level}, too few pairs to tell"),
            (Some((level, share)), _) => format!("; at {level}, {:.1} % of pairs differ", 100.0 * share),
            (None, _) => "; no level beyond was tried".to_owned(),
        };
        match self.safe {
            Some(safe) => format!(
                "{engine}, {form} pairs, {set}: safe to {safe} ({what}): {} of {} pairs differ, below {:.2} %{beyond}",
                self.up_to_safe.1,
                self.up_to_safe.0,
                100.0 * self.up_to_safe.2
            ),
            None if matches!(self.proof, Proof::TooFew { .. }) => {
                format!("{engine}, {form} pairs, {set}: not known ({what}){beyond}")
            }
            None => format!("{engine}, {form} pairs, {set}: safe at no level tried ({what}){beyond}"),
        }
    }
}

/// `stress.csv`.
///
/// # Errors
/// Those of the CSV writer.
pub fn cells_csv(rows: &[CellRow]) -> Result<Vec<u8>, csv::Error> {
    written(
        &CELL_COLUMNS,
        rows.iter().map(|row| {
            let [low, high] = wilson(row.differ, row.pairs);
            let counts = [row.pairs, row.representation, row.arithmetic, row.lost, row.differ].map(|c| c.to_string());
            let shares = [row.differ as f64 / row.pairs.max(1) as f64, low, high].map(|share| format!("{share:.6}"));
            let (level, form) = (row.cell.level.to_string(), row.cell.form.name().to_owned());
            let start = [row.cell.axis.name().to_owned(), level, form, row.tolerances.clone(), row.engine.clone()];
            [&start[..], &counts, &shares].concat()
        }),
    )
}

/// `limits.csv`.
///
/// # Errors
/// Those of the CSV writer.
pub fn limits_csv(limits: &[AgreementLimit]) -> Result<Vec<u8>, csv::Error> {
    let level = |level: Option<StressLevel>| level.map_or(String::new(), |level| level.to_string());
    written(
        &LIMIT_COLUMNS,
        limits.iter().map(|limit| {
            let (pairs, differ, high) = limit.up_to_safe;
            [
                limit.axis.name().to_owned(),
                limit.form.name().to_owned(),
                limit.tolerances.clone(),
                limit.engine.clone(),
                level(limit.clean),
                level(limit.safe),
                pairs.to_string(),
                differ.to_string(),
                if pairs == 0 { String::new() } else { format!("{high:.6}") },
                level(limit.beyond.map(|(level, _)| level)),
                limit.beyond.map_or(String::new(), |(_, share)| format!("{share:.6}")),
            ]
        }),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(level: StressLevel, differ: u64) -> CellRow {
        let cell = CellKey { axis: StressAxis::Offset, level, form: PairAlignment::Generic };
        let (tolerances, engine) = ("auto".to_owned(), "stepper-f64".to_owned());
        CellRow { cell, tolerances, engine, pairs: 1000, representation: differ, arithmetic: 0, lost: 0, differ }
    }

    #[test]
    fn a_limit_is_the_last_level_before_the_first_bad_one() {
        let rows = [
            row(StressLevel::None, 0),
            row(StressLevel::Power(0), 2),
            row(StressLevel::Power(1), 50),
            row(StressLevel::Power(2), 0),
        ];
        let limits = limits(&rows);
        assert_eq!(limits.len(), 1);
        assert_eq!((limits[0].clean, limits[0].safe), (Some(StressLevel::None), Some(StressLevel::Power(0))));
        assert_eq!(limits[0].beyond, Some((StressLevel::Power(1), 0.05)));
        assert_eq!((limits[0].up_to_safe.0, limits[0].up_to_safe.1), (2000, 2));
        assert!(limits[0].sentence().contains("safe to 1e0"), "{}", limits[0].sentence());
    }

    #[test]
    fn nothing_is_safe_when_the_mildest_level_is_not() {
        let limits = limits(&[row(StressLevel::None, 300)]);
        assert_eq!((limits[0].clean, limits[0].safe, limits[0].beyond), (None, None, Some((StressLevel::None, 0.3))));
    }

    #[test]
    fn few_pairs_prove_nothing_either_way() {
        let few = |differ, pairs| CellRow { pairs, ..row(StressLevel::None, differ) };
        let of = |row: CellRow| limits(&[row]).remove(0);
        let limit = of(few(0, 16));
        assert_eq!((limit.safe, limit.proof), (None, Proof::TooFew { needed: Some(381) }));
        assert!(limit.sentence().contains("too few pairs") && limit.sentence().contains("not known"));
        assert_eq!(of(few(0, 381)).proof, Proof::Safe);
        assert_eq!(of(few(8, 16)).proof, Proof::Unsafe);
        // One in 16 is there by chance in 15 of 100 cells of which 1 % differ; two in 16 in 1 of 100, three in 48 too.
        assert_eq!(of(few(1, 16)).proof, Proof::TooFew { needed: Some(48) });
        assert_eq!(of(few(2, 16)).proof, Proof::Unsafe);
        // 1 of 100 is the limit itself, and no number of pairs tells.
        assert_eq!(of(few(1, 100)).proof, Proof::TooFew { needed: None });
    }

    #[test]
    fn what_rounding_does_concerns_every_engine_of_the_precision_whatever_its_name() {
        let cell = cells().into_iter().next().expect("a cell");
        let (family, form) = (cell.family(), cell.form.name());
        let mut summary = Summary::default();
        summary.add_pair(crate::summary::PairGroup {
            family: family.clone(),
            form: form.to_owned(),
            tolerances: "auto".to_owned(),
        });
        let header = rockproof_differential::finding::FINDING_COLUMNS.join(",");
        let text = format!("{header}\n3,{family},{form},auto,f32,representation,missing,v-v,,,,,,\n");
        // Two engines of one's own whose names say nothing of their precision, or the wrong one.
        let engines = [("mine", Precision::F32), ("theirs-f32", Precision::F64), ("stepper-f32", Precision::F32)];
        let engines = engines.map(|(name, precision)| (name.to_owned(), precision));
        let rows = rows(&summary, text.as_bytes(), &engines).expect("rows");
        let found: Vec<_> = rows.iter().map(|row| (row.engine.as_str(), row.representation)).collect();
        assert_eq!(found, [("mine", 1), ("theirs-f32", 0), ("stepper-f32", 1)]);
    }

    #[test]
    fn findings_of_other_campaigns_are_refused() {
        let refused = |text: &str| rows(&Summary::default(), text.as_bytes(), &[]).expect_err("no findings");
        for text in ["", "index,family\nx,y\n"] {
            assert!(matches!(refused(text), TableError::Header { .. }), "{text:?}");
        }
        let text = format!("{}\nx,y\n", FINDING_COLUMNS.join(","));
        assert!(matches!(refused(&text), TableError::Row { row: 1, .. }));
    }
}
