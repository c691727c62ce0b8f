//! Makes a case smaller while it still shows the same finding: engine, cause, change, kind of
//! contact and deciding predicate.
//!
//! Greedy and deterministic: each step proposes a simpler case, and it is kept if it still shows the finding. Steps are
//! repeated until none helps or the allowed number of examinations is used up.

mod blocks;

use blocks::{Attempt, bits, on_grid};
pub(crate) use blocks::{BlockQuestion, BlockShrinker, Refusals};
use rockproof_differential::attribution::EnginePanel;
use rockproof_differential::case_file::Case;
use rockproof_differential::finding::{FAR_FROM_TIE, Finding};
use rockproof_model::{Criteria, Number};
use std::sync::atomic::{AtomicU64, Ordering};

/// Makes cases smaller.
pub struct Shrinker<'p> {
    panel: &'p EnginePanel,
    left: u64,
    examined: Option<&'p AtomicU64>,
    /// The margin in roundoffs that the finding must keep, so that one far from any tie stays one.
    least: f64,
    refusals: Refusals,
    /// The finding of the case as it is, as it was seen last.
    seen: Option<Finding>,
}

impl<'p> Shrinker<'p> {
    /// A shrinker that may examine `evaluations` pairs. The panel should hold no engine the case is not about, and ask
    /// for metamorphic checks only where the case is about one.
    pub fn new(panel: &'p EnginePanel, evaluations: u64) -> Shrinker<'p> {
        Shrinker { panel, left: evaluations, examined: None, least: 0.0, refusals: Refusals::default(), seen: None }
    }

    /// Counts in `examined` the pairs that are examined, for whoever waits.
    #[must_use]
    pub fn counted(self, examined: &'p AtomicU64) -> Shrinker<'p> {
        Shrinker { examined: Some(examined), ..self }
    }

    /// The smallest case found. A case that does not show its finding is returned as it is.
    pub fn shrink(mut self, case: Case) -> Case {
        self.least =
            case.about.margin_ulps.map(f64::abs).filter(|ulps| *ulps > FAR_FROM_TIE).map_or(0.0, |ulps| ulps / 10.0);
        let Some(finding) = self.reproduces(&case) else { return case };
        let mut best = case;
        best.describe(&finding, self.panel);
        loop {
            let before = size(&best);
            self.shrink_blocks(&mut best);
            self.simplify_tolerances(&mut best);
            if self.left == 0 || size(&best) >= before {
                break;
            }
        }
        // An engine that answers now so, now otherwise may not show it once more. What the case says must be about its own blocks all the same.
        if let Some(finding) = self.finding_of(&best).or(self.seen) {
            best.describe(&finding, self.panel);
        }
        best
    }

    fn reproduces(&mut self, case: &Case) -> Option<Finding> {
        self.left = self.left.checked_sub(1)?;
        let finding = self.finding_of(case);
        if let Some(examined) = self.examined {
            examined.fetch_add(1, Ordering::Relaxed);
        }
        // What shows it takes the place of the case.
        if finding.is_some() {
            self.seen.clone_from(&finding);
        }
        finding
    }

    fn finding_of(&self, case: &Case) -> Option<Finding> {
        let far_enough =
            |finding: &Finding| self.least == 0.0 || finding.margin_ulps().is_some_and(|u| u.abs() >= self.least);
        case.findings(self.panel).into_iter().find(far_enough)
    }

    /// Replaces `best` by `proposal` if that is simpler and shows the finding.
    fn keep(&mut self, best: &mut Case, attempt: Attempt, proposal: Case) -> bool {
        if let Some(was_asked) = self.refusals.known(attempt) {
            self.left = self.left.saturating_sub(u64::from(was_asked));
            return false;
        }
        let is_simpler = size(&proposal) < size(best);
        let better = is_simpler && self.reproduces(&proposal).is_some();
        if better {
            *best = proposal;
            self.refusals.case_changed();
        } else {
            self.refusals.refuse(attempt, is_simpler);
        }
        better
    }

    /// Makes the blocks simpler, the tolerances being as they are.
    fn shrink_blocks(&mut self, best: &mut Case) {
        let mut blocks = [best.a.clone(), best.b.clone()];
        let case = best.clone();
        let mut refusals = std::mem::take(&mut self.refusals);
        let mut shows = |asked: BlockQuestion<'_>| {
            if self.left == 0 {
                return None;
            }
            let BlockQuestion::Now([a, b]) = asked else {
                self.left -= 1;
                return Some(false);
            };
            let proposal = Case { a: a.clone(), b: b.clone(), ..case.clone() };
            Some(self.reproduces(&proposal).is_some())
        };
        BlockShrinker { shows: &mut shows, is_spent: false, refusals: &mut refusals }.once(&mut blocks);
        self.refusals = refusals;
        [best.a, best.b] = blocks;
    }

    /// Ideal tolerances, zeros and short numbers where they do.
    fn simplify_tolerances(&mut self, best: &mut Case) {
        if best.tolerances.criteria == Criteria::Classic {
            let mut proposal = best.clone();
            proposal.tolerances.criteria = Criteria::Revised;
            self.keep(best, Attempt::Revise, proposal);
        }
        for place in 0..best.tolerances.numbers().len() {
            let number = best.tolerances.numbers()[place].1.clone();
            if number.is_zero() {
                continue;
            }
            let mut simpler = vec![Number::ZERO];
            let value = number.approximate();
            if value.is_finite() && value != 0.0 {
                let top = value.abs().log2().ceil() as i32;
                simpler.extend([1, 2, 4, 8, 16].map(|bits| on_grid(&number, top - bits)));
            }
            let simpler = simpler.into_iter().filter(|n| bits(n) < bits(&number));
            for (choice, shorter) in simpler.enumerate() {
                let mut proposal = best.clone();
                *proposal.tolerances.numbers_mut()[place].1 = shorter;
                if self.keep(best, Attempt::Tolerance { place, choice }, proposal) {
                    break;
                }
            }
        }
    }
}

/// What a case costs its reader: features first, then bits, then tolerances that matter.
fn size(case: &Case) -> (usize, u64) {
    let (features, of_blocks) = blocks::size(&[case.a.clone(), case.b.clone()]);
    let numbers = case.tolerances.numbers();
    let criteria = u64::from(case.tolerances.criteria == Criteria::Classic);
    (features, of_blocks + numbers.into_iter().map(|(_, n)| bits(n)).sum::<u64>() + criteria)
}
