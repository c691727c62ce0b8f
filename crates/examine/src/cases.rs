//! The worst differences of a model as cases to replay.

use crate::assess::Examination;
use crate::pairs::{ExaminedPair, PRECISIONS, is_broken, panel, subject};
use rockproof_differential::builtin::panel_for;
use rockproof_differential::case_file::Case;
use rockproof_differential::finding::Finding;
use rockproof_differential::subject::NamedSet;
use rockproof_model::Precision;
use std::cmp::Reverse;

/// Cases in each precision.
const KEPT: usize = 3;

/// A difference as a file.
#[derive(Clone, Debug)]
pub struct KeptCase {
    /// Its name in the directory.
    pub file: String,
    /// The blocks of the model.
    pub blocks: [usize; 2],
    /// Whether it is more than a tie that rounding decides, in the precision that the model is to be safe in.
    pub is_broken: bool,
    /// The difference.
    pub finding: Finding,
    /// The content.
    pub case: Case,
}

/// The worst difference of the worst pairs in each precision, the one that the model is to be safe in first.
pub fn worst_cases(found: &Examination) -> Vec<KeptCase> {
    let asked = found.model.precision;
    let mut precisions = PRECISIONS;
    precisions.sort_by_key(|precision| *precision != asked);
    precisions.into_iter().flat_map(|precision| worst_in(found, precision)).collect()
}

fn worst_in(found: &Examination, precision: Precision) -> Vec<KeptCase> {
    let shapes = found.model.scene.shapes();
    let set =
        |precision: Precision| found.model.spec.derive(&shapes, precision).unwrap_or_else(|_| found.given.set.clone());
    let sets = NamedSet { name: found.name.as_str().into(), f32: set(Precision::F32), f64: set(Precision::F64) };
    let worst_of = |pair: &ExaminedPair| pair.in_precision(precision).worst.clone();
    let mut worst: Vec<(usize, [usize; 2], Finding)> = (found.given.pairs.iter().enumerate())
        .filter_map(|(number, pair)| Some((number, pair.blocks, worst_of(pair)?)))
        .collect();
    // A stable sort: of equally bad ones the first pair first.
    worst.sort_by_cached_key(|(_, _, finding)| {
        let ulps = finding.margin_ulps().map_or(0.0, f64::abs);
        // Positive numbers are in the order of their bits.
        Reverse((is_broken(finding), ulps.to_bits()))
    });
    let kept = worst.into_iter().take(KEPT).filter_map(|(number, blocks, finding)| {
        let subject = subject(&shapes, number, blocks, &sets);
        let names: Vec<String> = panel().engines.iter().map(|engine| engine.name().to_owned()).collect();
        let case = Case::of(&finding, &subject, 0, &panel_for(&names, &finding))?;
        let stem = finding.fingerprint().file_stem(&finding.set, finding.index);
        let is_broken = precision == found.model.precision && is_broken(&finding);
        Some(KeptCase { file: format!("cases/{stem}.toml"), blocks, is_broken, finding, case })
    });
    kept.collect()
}
