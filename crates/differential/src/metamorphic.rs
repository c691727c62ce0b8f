//! Checks that need no right answer to compare with: an engine's answer may not change when A and B are exchanged, when
//! vertices and faces are numbered otherwise, when both blocks are moved by an exactly representable amount, when all
//! lengths are multiplied by a power of two; and a block far away touches nothing.
//!
//! Where SPEC breaks ties by the order of features, an exchange or another numbering may change an entrance. The oracle
//! goes through the same check, and what changes in its answer is allowed to change in the same way in the engine's.

use super::attribution::{WantedFindings, answers_differ, engine_trace, expected};
use super::collision;
use super::compare::{AnswerChange, Difference, Features, differences};
use super::engine::{Engine, EngineFailure, Oracle, Prepared, catch_panic};
use super::explain::{ChainLink, explain, nearest_decisions};
use super::external::protocol::completed;
use super::finding::{Cause, DecidingDecision};
use super::indexed_trace::IndexedTrace;
use super::transform::{ExactBlocks, Transform, Transformed};
use rockproof_model::{Block, Contact, Number, Point, Precision, ToleranceSet};
use std::cell::OnceCell;
use std::rc::Rc;

/// The answers a check starts from: one engine, one pair rounded to its precision, one tolerance set.
pub struct MetamorphicBase<'x> {
    /// The pair, exact.
    pub pair: &'x ExactBlocks<'x>,
    /// The engine.
    pub engine: &'x dyn Engine,
    /// The exact side.
    pub oracle: &'x dyn Oracle,
    /// The rounded blocks.
    pub blocks: &'x [Block; 2],
    /// The rounded tolerances.
    pub tolerances: &'x ToleranceSet,
    /// The oracle's answer for the rounded pair.
    pub exact: &'x [Contact],
    /// The engine's answer for the rounded pair.
    pub contacts: &'x [Contact],
    /// The rounded pair in the engine.
    pub prepared: &'x dyn Prepared,
    /// Which violations are looked for; all without.
    pub wanted: Option<WantedFindings<'x>>,
}

impl MetamorphicBase<'_> {
    fn wants(&self, change: AnswerChange, difference: &Difference) -> bool {
        self.wanted.is_none_or(|wanted| wanted.includes(change, difference))
    }
}

/// What the checks of one engine on one pair brought.
#[derive(Debug, Default)]
pub struct MetamorphicResult {
    /// Checks made; one that cannot be made exactly is not counted.
    pub made: u64,
    /// The violations, with cause arithmetic or defect.
    pub violations: Vec<(Cause, Difference, Option<DecidingDecision>)>,
    /// The changed pairs that the engine gave no usable answer to.
    pub unanswered: Vec<UnansweredCheck>,
}

/// An engine that answers about a pair gave no usable answer about the same pair changed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnansweredCheck {
    /// The check.
    pub check: AnswerChange,
    /// What a finding about such a failure is called.
    pub change: AnswerChange,
    /// How the pair was changed, and what the engine said.
    pub note: String,
}

impl UnansweredCheck {
    /// Of a failure; `None` where the engine says that it cannot do the changed pair, or rounding destroyed that.
    pub(super) fn of(check: AnswerChange, words: &str, failure: &EngineFailure) -> Option<UnansweredCheck> {
        let change = failure.change();
        change.is_unusable().then(|| UnansweredCheck { check, change, note: format!("with {words}: {failure}") })
    }
}

/// Makes all checks on a pair.
pub fn check(base: &MetamorphicBase<'_>) -> MetamorphicResult {
    let mut checks = MetamorphicResult::default();
    for transform in Transform::ALL {
        if base.wanted.is_some_and(|wanted| !wanted.is_of_check(transform.change())) {
            continue;
        }
        if let Some(other) = transform.apply(base.pair, base.blocks, base.tolerances, base.engine.precision()) {
            checks.made += 1;
            compare(base, transform, &other, &mut checks);
        }
    }
    if let Some(far) = far_away(base.blocks, base.tolerances, base.engine.precision()) {
        checks.made += 1;
        for (a, b) in [(&base.blocks[0], &far), (&far, &base.blocks[0])] {
            let answer = match catch_panic(|| base.engine.prepare(a, b)?.classify(base.tolerances)) {
                Ok(answer) => answer,
                Err(failure) => {
                    let words = far_words(&base.blocks[1], &far);
                    checks.unanswered.extend(UnansweredCheck::of(AnswerChange::FarBlock, &words, &failure));
                    // The other way round it is the same finding.
                    break;
                }
            };
            let invented = answer.into_iter().map(|contact| {
                let difference = Difference { change: AnswerChange::FarBlock, before: None, after: Some(contact) };
                (base.engine.cause(), difference, None)
            });
            checks.violations.extend(invented);
        }
    }
    checks
}

/// The pairs that a check asks about, for whoever shows its finding.
pub struct ChangedPairs {
    /// What was changed.
    pub words: String,
    /// The changed pair; a block far away is put second, then first.
    pub pairs: Vec<Transformed>,
}

impl ChangedPairs {
    /// The pairs of the check whose findings have this change, `says_state` for an engine that says only how blocks lie; `None` where there is no such check,
    /// or it cannot be made of the pair.
    pub fn of(
        change: &str,
        exact: &ExactBlocks<'_>,
        blocks: &[Block; 2],
        tolerances: &ToleranceSet,
        precision: Precision,
        says_state: bool,
    ) -> Option<ChangedPairs> {
        if change == AnswerChange::FarBlock.name() {
            let [a, b] = blocks;
            let far = match says_state {
                true => collision::far_away(blocks, precision),
                false => far_away(blocks, tolerances, precision),
            }?;
            let words = far_words(b, &far);
            let pair = Transformed::unchanged([a.clone(), far]);
            let pairs = if says_state { vec![pair] } else { vec![pair.clone(), pair.exchanged()] };
            return Some(ChangedPairs { words, pairs });
        }
        let transform = Transform::ALL.into_iter().find(|transform| transform.change().name() == change)?;
        let pair = transform.apply(exact, blocks, tolerances, precision)?;
        let words = words(transform, blocks, &pair.blocks);
        Some(ChangedPairs { words, pairs: vec![pair] })
    }
}

/// How a pair was changed.
pub(super) fn words(transform: Transform, before: &[Block; 2], after: &[Block; 2]) -> String {
    match transform {
        Transform::Swap => "A and B exchanged".to_owned(),
        Transform::Renumber => "vertices and faces numbered backwards".to_owned(),
        Transform::Translate => {
            format!("both blocks moved by {:?} m along each axis", moved_m(&before[0], &after[0]))
        }
        Transform::Scale => "all lengths, those of the tolerances too, divided by 128".to_owned(),
    }
}

/// The same of a block far away.
pub(super) fn far_words(b: &Block, far: &Block) -> String {
    format!("B moved by {:?} m along x", moved_m(b, far))
}

fn moved_m(before: &Block, after: &Block) -> f64 {
    let [before, after] = [before, after].map(|block| block.vertices()[0].x.approximate());
    after - before
}

fn compare(base: &MetamorphicBase<'_>, transform: Transform, other: &Transformed, checks: &mut MetamorphicResult) {
    let change = transform.change();
    let tolerances = other.tolerances(base.tolerances);
    let [a, b] = &other.blocks;
    let prepared = catch_panic(|| base.engine.prepare(a, b));
    let answer = prepared.and_then(|prepared| {
        let answer = catch_panic(|| prepared.classify(&tolerances))?;
        Ok((prepared, answer))
    });
    let (prepared, answer) = match answer {
        Ok(answered) => answered,
        Err(failure) => {
            let words = words(transform, base.blocks, &other.blocks);
            checks.unanswered.extend(UnansweredCheck::of(change, &words, &failure));
            return;
        }
    };
    let answer = other.to_original(&answer);
    // What either answer leaves unsaid is not compared.
    let contacts = completed(base.contacts.to_vec(), &answer);
    let answer = completed(answer, &contacts);
    if answer == contacts {
        return;
    }
    let features = Features { a: base.blocks[0].topology(), b: base.blocks[1].topology() };
    let exact_blocks = base.oracle.prepare(a, b);
    let pair = exact_blocks.pair();
    let turned = pair.classify(&tolerances).contacts;
    let exact = other.to_original(&turned);
    let allowed = differences(base.exact, &exact, features);
    let key = |d: &Difference| d.contact().map(|c| c.key);
    let changed = differences(&contacts, &answer, features);
    // A defect is what differs from the oracle, before the change or after, although nothing was close: that the two wide answers differ is no
    // defect where the order of features breaks an exact tie.
    let departing = OnceCell::new();
    let in_wide = || {
        let departs = |prepared: &dyn Prepared, tolerances: &ToleranceSet, expected: &[_]| {
            catch_panic(|| Ok(prepared.departs_in_wide(tolerances, expected))).ok().flatten()
        };
        let there = changed.iter().map(|difference| other.to_transformed(difference)).collect::<Vec<_>>();
        let here = departs(base.prepared, base.tolerances, &expected(&changed, base.exact))?;
        Some([here, departs(&*prepared, &tolerances, &expected(&there, &turned))?])
    };
    for &difference in &changed {
        if !base.wants(change, &difference) {
            continue;
        }
        if allowed.iter().any(|a| (a.change, key(a)) == (difference.change, key(&difference))) {
            continue;
        }
        let deciding =
            deciding(base, &difference, &TransformedAnswer { other, tolerances: &tolerances, prepared: &*prepared });
        if base.wanted.is_some_and(|wanted| !wanted.includes_decided_by(deciding.as_ref())) {
            continue;
        }
        let remains = departing.get_or_init(in_wide).as_ref().is_some_and(|[here, there]| {
            difference.keys().any(|key| here.contains(&key))
                || other.to_transformed(&difference).keys().any(|key| there.contains(&key))
        });
        let cause = if remains { Cause::Defect } else { base.engine.cause() };
        checks.violations.push((cause, Difference { change, ..difference }, deciding));
    }
}

/// The changed pair inside the engine.
struct TransformedAnswer<'x> {
    other: &'x Transformed,
    tolerances: &'x ToleranceSet,
    prepared: &'x dyn Prepared,
}

/// What decided a violation: the oracle's answer did not change, so the engine differs from it before the change or
/// after; where it does, their traces part. Features of a decision after the change are those of the changed pair. Of an engine that tells no
/// decisions, the oracle's nearest to a tie around it, in the pair itself: the change keeps how near that is.
fn deciding(
    base: &MetamorphicBase<'_>,
    difference: &Difference,
    turned: &TransformedAnswer<'_>,
) -> Option<DecidingDecision> {
    let is_outside = base.engine.cause() == Cause::Engine;
    let wrong_before = is_outside || answers_differ(base.exact, base.contacts, difference);
    let (blocks, tolerances, prepared) = if wrong_before {
        (base.blocks, base.tolerances, base.prepared)
    } else {
        (&turned.other.blocks, turned.tolerances, turned.prepared)
    };
    let local = if wrong_before { *difference } else { turned.other.to_transformed(difference) };
    let exact_blocks = base.oracle.prepare(&blocks[0], &blocks[1]);
    let pair = exact_blocks.pair();
    let link = ChainLink {
        before: &|| Some(Rc::new(pair.indexed_trace(tolerances))),
        after: &|| engine_trace(prepared, tolerances).map(IndexedTrace::of).map(Rc::new),
        margins: &|decisions| pair.margins(tolerances, decisions),
        roundoff: Some(base.engine.precision().epsilon() / 2.0),
    };
    let features = Features { a: blocks[0].topology(), b: blocks[1].topology() };
    let told = if is_outside { nearest_decisions } else { explain };
    told(&[local], &link, features).pop().flatten()
}

/// B moved along x until it is further from A than anything can reach, if that can be done exactly.
fn far_away(blocks: &[Block; 2], tolerances: &ToleranceSet, precision: Precision) -> Option<Block> {
    let reach = blocks
        .iter()
        .flat_map(Block::coordinates)
        .chain([&tolerances.search])
        .map(|c| c.approximate().abs())
        .fold(0.0, f64::max);
    let exponent = (8.0 * reach).log2().ceil();
    if !exponent.is_finite() {
        return None;
    }
    // Twice the distance needed, should moving lose bits of B: B need not keep its shape to be far away, but it must keep
    // its features.
    let step = Number::from_f64(exponent.exp2()).ok()?;
    let moved = blocks[1].translated(&Point::new(step, Number::ZERO, Number::ZERO)).rounded(precision)?;
    super::collapse::collapsed_feature(&moved).is_none().then_some(moved)
}
