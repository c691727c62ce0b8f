//! `check`: do the tolerances keep the rules, and which blocks overlap?

use crate::InputError;
use crate::arguments::precision;
use crate::model::Model;
use crate::number::exact_root;
use crate::separation::triple;
use crate::signals::interruptible;
use crate::tolerances::{Tolerances, set_for, spec_of};
use num_rational::BigRational;
use pyo3::prelude::*;
use rayon::prelude::*;
use rockproof_model::text::noun;
use rockproof_model::{Precision, Scene, ToleranceSet, Violation as BrokenRule, tolerance_rules};
use rockproof_oracle::PreparedBlock;
use rockproof_oracle::audit::{Audit, Auditor, Overlap as FoundOverlap, OverlapSeverity, rounding_depth};
use std::sync::atomic::{AtomicBool, Ordering};

/// A rule that the tolerances break.
#[pyclass(frozen, module = "rockproof")]
#[derive(Clone)]
pub(crate) struct Violation {
    /// The rule, as a formula.
    #[pyo3(get)]
    rule: &'static str,
    /// Why there is such a rule.
    #[pyo3(get)]
    reason: &'static str,
    /// The left side of the formula.
    #[pyo3(get)]
    found: f64,
    /// The right side of the formula.
    #[pyo3(get)]
    allowed: f64,
    /// The block of the deciding length, or None.
    #[pyo3(get)]
    block: Option<usize>,
    /// The ends of the deciding edge, or None.
    #[pyo3(get)]
    edge: Option<(u32, u32)>,
    /// What would satisfy the rule.
    #[pyo3(get)]
    remedy: String,
    text: String,
}

#[pymethods]
impl Violation {
    fn __str__(&self) -> String {
        self.text.clone()
    }

    fn __repr__(&self) -> String {
        format!("<Violation: {}>", self.text)
    }
}

impl From<&BrokenRule> for Violation {
    fn from(broken: &BrokenRule) -> Violation {
        Violation {
            rule: broken.rule.formula(),
            reason: broken.rule.reason(),
            found: broken.found,
            allowed: broken.allowed,
            block: broken.place.map(|place| place.block),
            edge: broken.place.and_then(|place| place.edge).map(|(p, q)| (p.0, q.0)),
            remedy: broken.remedy.clone(),
            text: broken.to_string(),
        }
    }
}

/// Two blocks that overlap.
#[pyclass(frozen, module = "rockproof", get_all)]
#[derive(Clone)]
pub(crate) struct Overlap {
    /// The blocks, the lower number first.
    blocks: (usize, usize),
    /// "lost" (deeper than `penetration`, or unseen by contacts: the blocks will pass through one another), "held" (a contact pushes them apart) or
    /// "rounding" (no more than rounded coordinates make).
    meaning: &'static str,
    /// Whether the contacts tell of it: "seen", "shallow" (they tell less than half of it) or "unseen".
    sight: &'static str,
    /// Whether it is deeper than the tolerance `penetration`.
    is_deeper_than_penetration: bool,
    /// The depth in metres to the nearest float.
    depth_m: f64,
    /// The square of the depth in m², exactly.
    depth_squared: BigRational,
    /// The direction in which the first block moves to get free, not of unit length.
    direction: (BigRational, BigRational, BigRational),
}

impl Overlap {
    pub(crate) fn new(found: &FoundOverlap, severity: OverlapSeverity) -> Overlap {
        Overlap {
            blocks: (found.blocks[0], found.blocks[1]),
            meaning: severity.name(),
            sight: found.sight.name(),
            is_deeper_than_penetration: found.is_deeper_than_g,
            depth_m: found.penetration.depth_m().unwrap_or(f64::INFINITY),
            depth_squared: found.depth_squared(),
            direction: triple(&found.penetration.direction),
        }
    }
}

#[pymethods]
impl Overlap {
    /// The depth in metres as a Fraction; None where it is irrational.
    #[getter]
    fn depth(&self) -> Option<BigRational> {
        exact_root(&self.depth_squared)
    }

    fn __repr__(&self) -> String {
        let (a, b) = self.blocks;
        format!("<Overlap {a}–{b}: {:?} m, {}, {}>", self.depth_m, self.sight, self.meaning)
    }
}

/// A fall that would not be stopped within the tolerance `penetration`. No violation: whether anything falls so far, rules do not know.
#[pyclass(frozen, module = "rockproof", get_all)]
#[derive(Clone)]
pub(crate) struct Fall {
    /// The block.
    block: usize,
    /// Its weight in N.
    weight: f64,
    /// The height in m from which it falls: that of the model.
    height: f64,
    /// The normal stiffness of its contacts in N/m.
    stiffness: f64,
    /// The stiffness that would stop it, in N/m.
    needed: f64,
    /// How deep it would go in m.
    depth: f64,
    /// The tolerance `penetration` in m.
    allowed: f64,
    /// What would help.
    remedy: String,
}

/// What `check` found.
#[pyclass(frozen, module = "rockproof", get_all)]
pub(crate) struct CheckReport {
    /// Whether no rule is broken and no overlap is lost.
    is_sound: bool,
    /// The rules that the tolerances break.
    violations: Vec<Violation>,
    /// The blocks that overlap, by their numbers.
    overlaps: Vec<Overlap>,
    /// A fall that would not be stopped, or None.
    fall: Option<Fall>,
    /// The complete tolerances, as derived from the blocks.
    tolerances: Tolerances,
    /// Neighbouring pairs examined for overlaps.
    neighbours: u64,
}

#[pymethods]
impl CheckReport {
    fn __repr__(&self) -> String {
        let sound = if self.is_sound { "sound" } else { "not sound" };
        let (rules, overlaps) = (self.violations.len(), self.overlaps.len());
        let [rules, overlaps, pairs] = [
            (rules as u64, "rule", "rules"),
            (overlaps as u64, "overlap", "overlaps"),
            (self.neighbours, "pair", "pairs"),
        ]
        .map(|(count, one, many)| format!("{count} {}", noun(count, one, many)));
        format!("<CheckReport: {sound}, {rules} violated, {overlaps} in {pairs}>")
    }
}

/// Checks a model as `rockproof check` does: do the tolerances keep the rules that make them safe for these blocks, and which blocks overlap?
///
/// `tolerances` are those of the file, or "auto", if they are not given; `precision` is what rules and presets are for, "f64" or "f32".
///
/// Raises InputError where a coordinate or a tolerance overflows in that precision.
#[pyfunction]
#[pyo3(signature = (model, tolerances=None, *, precision="f64"))]
pub(crate) fn check(
    py: Python<'_>,
    model: &Model,
    tolerances: Option<&Bound<'_, PyAny>>,
    precision: &str,
) -> PyResult<CheckReport> {
    let precision = self::precision(precision)?;
    let spec = spec_of(tolerances, model.scene.tolerances.as_ref())?;
    interruptible(py, |stop| {
        let shapes = model.scene.shapes();
        let set = set_for(&spec, &shapes, precision).map_err(|error| model.at(error))?;
        for (number, block) in model.scene.blocks.iter().enumerate() {
            if block.block.rounded(precision).is_none() {
                let (place, name) = (model.place(), &block.name);
                return Err(InputError::new_err(format!(
                    "{place}block {number} \"{name}\": a coordinate overflows when rounded to {precision}"
                )));
            }
        }
        let violations: Vec<Violation> =
            tolerance_rules::check_scene(&set, &model.scene, precision).iter().map(Violation::from).collect();
        let (overlaps, neighbours) = overlaps(&model.scene, &set, stop);
        let is_sound =
            violations.is_empty() && overlaps.iter().all(|overlap| overlap.meaning != OverlapSeverity::Lost.name());
        let fall = tolerance_rules::fall(&set, &model.scene).map(|fall| {
            let tolerance_rules::Fall { block, weight, height, stiffness, needed, depth, allowed, remedy } = fall;
            Fall { block, weight, height, stiffness, needed, depth, allowed, remedy }
        });
        Ok(CheckReport { is_sound, violations, overlaps, fall, tolerances: Tolerances(set.into()), neighbours })
    })?
}

/// The overlaps of all neighbouring pairs, and how many pairs these are.
fn overlaps(scene: &Scene, set: &ToleranceSet, stop: &AtomicBool) -> (Vec<Overlap>, u64) {
    let (blocks, fixed) = (scene.shapes(), scene.fixed());
    let prepared: Vec<PreparedBlock> = blocks.par_iter().map(|block| PreparedBlock::new(block)).collect();
    let auditor = Auditor::new(&prepared, set);
    // Two fixed blocks never move, so they overlap as they are meant to.
    let audited = auditor.neighbours().into_par_iter().filter(|&[i, j]| !(fixed[i] && fixed[j]));
    let audited: Option<Vec<_>> =
        audited.map(|pair| (!stop.load(Ordering::Relaxed)).then(|| auditor.pair(pair))).collect();
    // Where it was stopped the signal is raised instead.
    let audit = Audit::of(audited.unwrap_or_default());
    let rounding = rounding_depth(&blocks, Precision::F64);
    let told = |found: &FoundOverlap| Overlap::new(found, found.severity(&rounding));
    (audit.overlaps.iter().map(told).collect(), audit.counts.neighbours())
}
