//! One tolerance at a time around `auto`, under both criteria, on the same pairs.

use std::collections::BTreeSet;

use rayon::prelude::*;
use rockproof_differential::attribution::{EnginePanel, examine_pair};
use rockproof_differential::builtin;
use rockproof_differential::finding::{Cause, FindingScope};
use rockproof_differential::subject::Subject;
use rockproof_model::Precision;
use rockproof_oracle::penetration::penetration;
use rockproof_pairs::batch::{self, PairConfig};
use rockproof_pairs::tolerance_sets::SetSource;

/// Pairs for every set.
pub(crate) const PAIRS: u64 = 1024;

/// The seed of the pairs.
const SEED: u64 = 1;

/// A tolerance and the values that it takes, as changes of `auto`; the last of each is what a plot shows on its axis.
pub(crate) struct ToleranceSeries {
    /// The tolerance.
    pub(crate) name: &'static str,
    /// What the axis shows.
    pub(crate) label: &'static str,
    /// Changes, and places on the axis.
    pub(crate) values: Vec<(String, f64)>,
}

/// The tolerances that are changed.
pub(crate) fn tolerance_series() -> Vec<ToleranceSeries> {
    let times = |name: &'static str, label, factors: &[(&str, f64)]| ToleranceSeries {
        name,
        label,
        values: factors.iter().map(|(text, value)| (format!("{name}*{text}"), *value)).collect(),
    };
    let angles = |name: &'static str, label| ToleranceSeries {
        name,
        label,
        values: [0.0, 0.25, 0.5, 1.0, 2.0, 3.0, 5.0, 8.0]
            .iter()
            .map(|degrees| (format!("{name}={degrees}"), *degrees))
            .collect(),
    };
    let factors = [("0", 0.0), ("1/8", 0.125), ("1/4", 0.25), ("1/2", 0.5), ("1", 1.0), ("2", 2.0), ("4", 4.0)];
    vec![
        times("territory", "territory over that of auto (s/4 or less)", &factors),
        angles("overlap_angle", "overlap angle (degrees)"),
        angles("parallel_angle", "parallel angle (degrees)"),
        times("search", "search over that of auto (2.5 u)", &factors[2..]),
        times("penetration", "penetration over that of auto (u)", &factors[1..]),
    ]
}

/// What one set did on all pairs.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    /// The tolerance that is changed.
    pub(crate) tolerance: &'static str,
    /// Its place on the axis.
    pub(crate) value: f64,
    /// `revised` or `classic`.
    pub(crate) criteria: &'static str,
    /// Pairs.
    pub(crate) pairs: u64,
    /// Pairs whose exact contacts are not those of nearest features alone.
    pub(crate) changed: u64,
    /// Exact contacts.
    pub(crate) contacts: u64,
    /// Pairs that the engine answers otherwise than the oracle does for the exact input: f32, f64.
    pub(crate) differ: [u64; 2],
    /// Pairs of blocks that overlap, by no more than `penetration`, and have no contact.
    pub(crate) missed: u64,
    /// The deepest of them (m).
    pub(crate) deepest: f64,
    /// The families that they are of.
    pub(crate) missed_in: BTreeSet<String>,
}

/// Measures every value of every series.
pub(crate) fn measure(count: u64) -> Result<Vec<Row>, Box<dyn std::error::Error>> {
    let names = [Precision::F32, Precision::F64].map(|p| builtin::ENGINES[usize::from(p == Precision::F64)].to_owned());
    let panel: EnginePanel = builtin::panel(&names, 0)?;
    // Ordinary pairs: as generated, or moved at random; perturbed off their ties as often as in a campaign.
    let config = PairConfig { directed_percent: 0, ladder_percent: 0, ..PairConfig::default() };
    let cases: Vec<batch::PairCase> = (0..count.div_ceil(batch::BATCH))
        .into_par_iter()
        .flat_map_iter(|batch| batch::batch(SEED, batch, &config))
        .collect();
    let depths: Vec<Option<f64>> =
        cases.par_iter().map(|case| penetration(&case.a, &case.b).and_then(|found| found.depth_m())).collect();
    let mut rows = Vec::new();
    for series in tolerance_series() {
        for (change, value) in &series.values {
            for criteria in ["revised", "classic"] {
                let name = format!("auto@{change}@criteria={criteria}");
                let source = SetSource::named(&name).ok_or_else(|| format!("no set {name}"))?;
                let none = Row {
                    tolerance: series.name,
                    value: *value,
                    criteria,
                    pairs: 0,
                    changed: 0,
                    contacts: 0,
                    differ: [0; 2],
                    missed: 0,
                    deepest: 0.0,
                    missed_in: BTreeSet::new(),
                };
                let row = cases
                    .par_iter()
                    .zip(&depths)
                    .map(|(case, depth)| count_differences(case, *depth, &source, &panel, none.clone()))
                    .reduce(|| none.clone(), Row::add);
                rows.push(row);
            }
        }
    }
    Ok(rows)
}

impl Row {
    fn add(mut self, other: Row) -> Row {
        self.pairs += other.pairs;
        self.changed += other.changed;
        self.contacts += other.contacts;
        self.missed += other.missed;
        self.differ = [0, 1].map(|k| self.differ[k] + other.differ[k]);
        self.deepest = self.deepest.max(other.deepest);
        self.missed_in.extend(other.missed_in);
        self
    }
}

/// One pair under one set.
fn count_differences(
    case: &batch::PairCase,
    depth: Option<f64>,
    source: &SetSource,
    panel: &EnginePanel,
    none: Row,
) -> Row {
    let Some(set) = source.derive(&case.a, &case.b) else { return none };
    let prepared = [rockproof_oracle::PreparedBlock::new(&case.a), rockproof_oracle::PreparedBlock::new(&case.b)];
    let contacts = rockproof_oracle::Pair::new(&prepared[0], &prepared[1]).classify(&set.f64).contacts.len() as u64;
    let allowed = set.f64.penetration.approximate();
    let subject = Subject::from(batch::PairCase { sets: vec![set], ..case.clone() });
    let findings = examine_pair(&subject, panel).findings;
    let differs = |engine: &str, precision: Precision| {
        findings.iter().any(|finding| match &finding.scope {
            FindingScope::Any => false,
            FindingScope::Rounded(p) => *p == precision && finding.cause != Cause::Tolerance,
            FindingScope::Engine(name) => **name == *engine,
        })
    };
    let changed =
        findings.iter().any(|f| f.cause == Cause::Tolerance && f.scope != FindingScope::Rounded(Precision::F32));
    let missed = depth.filter(|depth| *depth > 0.0 && *depth <= allowed && contacts == 0);
    Row {
        pairs: 1,
        changed: u64::from(changed),
        contacts,
        differ: [differs(builtin::ENGINES[0], Precision::F32), differs(builtin::ENGINES[1], Precision::F64)]
            .map(u64::from),
        missed: u64::from(missed.is_some()),
        deepest: missed.unwrap_or(0.0),
        missed_in: missed.map(|_| case.family.to_string()).into_iter().collect(),
        ..none
    }
}
