//! Engines that do not classify contacts but say how two blocks lie to one another, as collision codes do: apart, touching
//! or overlapping, by how much, and which way out. Compared with the exact answer for convex pairs.

mod hull_pair;
pub mod separation;
mod slab;

use super::compare::AnswerChange;
use super::engine::{Answer, Engine, catch_panic};
use super::metamorphic::{UnansweredCheck, far_words, words};
use super::separation_state::{ReportedState, SeparationState, StateComparison};
use super::transform::{ExactBlocks, Transform};
use rockproof_model::{Block, Number, Point, Precision, ToleranceSet};
use separation::{Separation, normal_separates};

/// The pair an engine answered about.
#[derive(Clone, Copy)]
pub struct CollisionQuery<'x> {
    /// The blocks as the engine saw them.
    pub blocks: &'x [Block; 2],
    /// The engine's precision.
    pub precision: Precision,
    /// How far its gap and normal may be off: so many times eps times the largest coordinate.
    pub accuracy: u64,
}

impl CollisionQuery<'_> {
    /// What is wrong with an answer, and the comparison; `None` where the exact side has no answer: a block is concave.
    pub fn compare(&self, reported: ReportedState) -> Option<(Option<AnswerChange>, StateComparison)> {
        let [a, b] = self.blocks;
        Some(self.compare_with(&Separation::of(a, b)?, reported))
    }

    /// The same where the separation of the blocks is known.
    pub(super) fn compare_with(
        &self,
        exact: &Separation,
        reported: ReportedState,
    ) -> (Option<AnswerChange>, StateComparison) {
        let [a, b] = self.blocks;
        let (reach, epsilon) = (largest_coordinate(self.blocks), self.precision.epsilon());
        let gap = exact.gap_m();
        let margin = if reach > 0.0 { gap / reach } else { 0.0 };
        let slack = self.accuracy as f64 * epsilon * reach;
        let comparison = StateComparison {
            exact: exact.state,
            exact_gap_m: gap,
            reported,
            margin,
            margin_ulps: margin / (epsilon / 2.0),
        };
        let wrong = if reported.state != exact.state {
            Some(AnswerChange::State)
        } else if reported.gap_m.is_some_and(|found| (found - gap).abs() > slack) {
            Some(AnswerChange::Gap)
        } else if reported.normal.is_some_and(|normal| !normal_separates(a, b, normal, gap, slack)) {
            Some(AnswerChange::Normal)
        } else {
            None
        };
        (wrong, comparison)
    }
}

/// An engine's answer about a pair, to be judged.
pub struct CollisionCheck<'x> {
    /// The engine.
    pub engine: &'x dyn Engine,
    /// The pair, exact.
    pub exact: &'x ExactBlocks<'x>,
    /// The pair as the engine sees it.
    pub blocks: &'x [Block; 2],
    /// The tolerances as the engine sees them.
    pub tolerances: &'x ToleranceSet,
    /// Whether to make the metamorphic checks too.
    pub metamorphic: bool,
}

/// What is wrong with an answer.
#[derive(Debug, Default)]
pub struct CollisionCheckResult {
    /// What the engine said about the pair itself and what is so; `None` where the exact side has no answer.
    pub comparison: Option<StateComparison>,
    /// What is wrong, and how it is.
    pub wrong: Vec<(AnswerChange, StateComparison)>,
    /// Metamorphic checks made.
    pub made: u64,
    /// The changed pairs that the engine gave no usable answer to.
    pub unanswered: Vec<UnansweredCheck>,
}

impl CollisionCheck<'_> {
    /// Compares an answer with the exact one and, where asked for, with the engine's own for the same pair exchanged, numbered
    /// otherwise, moved, scaled, and for a block far away: the state may not change, and what is far is apart.
    pub fn judge(&self, reported: ReportedState) -> CollisionCheckResult {
        let asked = CollisionQuery {
            blocks: self.blocks,
            precision: self.engine.precision(),
            accuracy: self.engine.accuracy(),
        };
        let mut judgement = CollisionCheckResult::default();
        let Some((wrong, comparison)) = asked.compare(reported) else {
            self.engine.not_compared();
            return judgement;
        };
        judgement.comparison = Some(comparison);
        judgement.wrong.extend(wrong.map(|change| (change, comparison)));
        if !self.metamorphic {
            return judgement;
        }
        for transform in Transform::ALL {
            if let Some(other) = transform.apply(self.exact, self.blocks, self.tolerances, asked.precision) {
                judgement.made += 1;
                let check = transform.change();
                let words = || words(transform, self.blocks, &other.blocks);
                let tolerances = other.tolerances(self.tolerances);
                let again = self.ask(&other.blocks, &tolerances, check, &words, &mut judgement.unanswered);
                if let Some(again) = again.filter(|again| again.state != reported.state) {
                    judgement.wrong.push((check, StateComparison { reported: again, ..comparison }));
                }
            }
        }
        if let Some(far) = far_away(self.blocks, asked.precision) {
            judgement.made += 1;
            let [a, b] = self.blocks;
            let words = far_words(b, &far);
            let (pair, check) = ([a.clone(), far], AnswerChange::FarBlock);
            let again = self.ask(&pair, self.tolerances, check, &|| words.clone(), &mut judgement.unanswered);
            if let Some(again) = again.filter(|again| again.state != SeparationState::Apart) {
                judgement.wrong.push((
                    AnswerChange::FarBlock,
                    StateComparison { exact: SeparationState::Apart, reported: again, ..comparison },
                ));
            }
        }
        judgement
    }

    /// The engine's answer about the changed pair of a check; `None` where it says nothing of how the blocks lie.
    fn ask(
        &self,
        [a, b]: &[Block; 2],
        tolerances: &ToleranceSet,
        check: AnswerChange,
        words: &dyn Fn() -> String,
        unanswered: &mut Vec<UnansweredCheck>,
    ) -> Option<ReportedState> {
        match catch_panic(|| self.engine.prepare(a, b)?.answer(tolerances)) {
            Ok(Answer::State(reported)) => Some(reported),
            Ok(Answer::Contacts(_)) => None,
            Err(failure) => {
                unanswered.extend(UnansweredCheck::of(check, &words(), &failure));
                None
            }
        }
    }
}

/// The largest coordinate of a pair (m).
fn largest_coordinate(blocks: &[Block; 2]) -> f64 {
    blocks.iter().flat_map(Block::coordinates).map(|c| c.approximate().abs()).fold(0.0, f64::max)
}

/// B moved along x by eight times the largest coordinate or more, where that keeps its features.
pub(super) fn far_away(blocks: &[Block; 2], precision: Precision) -> Option<Block> {
    let exponent = (8.0 * largest_coordinate(blocks)).log2().ceil();
    if !exponent.is_finite() {
        return None;
    }
    let step = Number::from_f64(exponent.exp2()).ok()?;
    let moved = blocks[1].translated(&Point::new(step, Number::ZERO, Number::ZERO)).rounded(precision)?;
    super::collapse::collapsed_feature(&moved).is_none().then_some(moved)
}
