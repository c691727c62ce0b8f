//! Every neighbouring pair of a model as it stands, through the chain of causes that campaigns use (SPEC section 6).

use crate::progress::WorkProgress;
use rayon::prelude::*;
use rockproof_differential::agreement::ChainSpan;
use rockproof_differential::attribution::{EnginePanel, examine_pair};
use rockproof_differential::builtin::{self, ENGINES};
use rockproof_differential::compare::AnswerChange;
use rockproof_differential::finding::{Cause, FAR_FROM_TIE, Finding, FindingScope};
use rockproof_differential::subject::{NamedSet, Subject};
use rockproof_model::{Block, Precision};
use rockproof_report::tally::CHOICES;
use std::sync::atomic::{AtomicBool, Ordering};

/// The precisions of the built-in engines, in the order of [`ENGINES`].
pub(crate) const PRECISIONS: [Precision; 2] = [Precision::F32, Precision::F64];

/// What was found of one pair.
#[derive(Clone, Debug)]
pub struct ExaminedPair {
    /// The blocks, the lower number first.
    pub blocks: [usize; 2],
    /// Whether there are exact contacts, under the tolerances of either precision.
    pub touches: bool,
    /// Contacts that the tolerances add, remove or change, everything exact.
    pub tolerance: u64,
    /// What differs in f32, and in f64.
    pub engines: [EngineDifferences; 2],
}

/// How the contacts of a pair in one precision differ from the exact ones.
#[derive(Clone, Debug, Default)]
pub struct EngineDifferences {
    /// Contacts that change because the input is rounded.
    pub representation: u64,
    /// Contacts that change because the engine calculates in its precision.
    pub arithmetic: u64,
    /// Contacts that are wrong in several hundred bits as well.
    pub defects: u64,
    /// Of all these, what is more than a tie that rounding decides the other way: a mistake in code, no answer, a feature that rounding
    /// destroyed, or a decision further from a tie than rounding explains.
    pub broken: u64,
    /// Of all these the gravest: what is broken first, then what is furthest from a tie.
    pub worst: Option<Finding>,
}

impl ExaminedPair {
    /// What differs in a precision.
    pub fn in_precision(&self, precision: Precision) -> &EngineDifferences {
        &self.engines[usize::from(precision == Precision::F64)]
    }
}

impl EngineDifferences {
    /// All that differs.
    pub fn total(&self) -> u64 {
        self.representation + self.arithmetic + self.defects
    }

    fn add(&mut self, finding: Finding) {
        match finding.cause {
            Cause::Representation => self.representation += 1,
            Cause::Defect => self.defects += 1,
            _ => self.arithmetic += 1,
        }
        self.broken += u64::from(is_broken(&finding));
        let gravity = |finding: &Finding| (is_broken(finding), finding.margin_ulps().map_or(0.0, f64::abs));
        let is_worse = |known: &Finding| gravity(&finding) > gravity(known);
        if self.worst.as_ref().is_none_or(is_worse) {
            self.worst = Some(finding);
        }
    }
}

/// Whether a difference is more than a tie that rounding decides the other way: a mistake in code, no answer, a feature that rounding destroyed, or a
/// decision further from a tie than rounding explains.
pub(crate) fn is_broken(finding: &Finding) -> bool {
    let no_answer = matches!(finding.difference.change, AnswerChange::Collapsed | AnswerChange::Failure);
    let is_choice = finding.predicate().is_some_and(|predicate| CHOICES.contains(&predicate));
    let is_far = !is_choice && finding.margin_ulps().is_some_and(|ulps| ulps.abs() > FAR_FROM_TIE);
    no_answer || finding.cause == Cause::Defect || is_far
}

/// The engines that pairs are examined with.
pub(crate) fn panel() -> EnginePanel {
    let engines = ENGINES.iter().filter_map(|name| builtin::engine(name)).collect();
    EnginePanel { oracle: Box::new(builtin::BuiltinOracle), engines, metamorphic_every: 0 }
}

/// A pair of a model for the chain of causes.
pub(crate) fn subject(blocks: &[&Block], number: usize, [a, b]: [usize; 2], set: &NamedSet) -> Subject {
    Subject {
        index: number as u64,
        family: format!("blocks {a} and {b}").into(),
        form: "as they stand".into(),
        a: blocks[a].clone(),
        b: blocks[b].clone(),
        sets: vec![set.clone()],
    }
}

/// Examines pairs, in their order; `None` where it was stopped meanwhile.
pub(crate) fn examine_all(
    blocks: &[&Block],
    pairs: &[[usize; 2]],
    set: &NamedSet,
    (seen, stop): (&WorkProgress, &AtomicBool),
) -> Option<Vec<ExaminedPair>> {
    let panel = panel();
    let one = |(number, &pair): (usize, &[usize; 2])| {
        if stop.load(Ordering::SeqCst) {
            return None;
        }
        let examined = examine_pair(&subject(blocks, number, pair, set), &panel);
        let touches = examined.agreement.contacts_before(ChainSpan::Representation) > 0;
        let mut found = ExaminedPair { blocks: pair, touches, tolerance: 0, engines: Default::default() };
        for finding in examined.findings {
            let is_f64 = match &finding.scope {
                FindingScope::Any => false,
                FindingScope::Rounded(precision) => *precision == Precision::F64,
                FindingScope::Engine(name) => **name == *ENGINES[1],
            };
            match finding.cause {
                Cause::Tolerance => found.tolerance += 1,
                _ => found.engines[usize::from(is_f64)].add(finding),
            }
        }
        seen.advance();
        Some(found)
    };
    pairs.par_iter().enumerate().map(one).collect()
}
