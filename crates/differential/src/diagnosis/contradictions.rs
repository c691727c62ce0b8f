//! Looks in the campaign for right answers that speak against hypotheses, where these would have changed them.

use super::hypothesis::{Hypothesis, fits};
use super::judge::{Asking, is_excused};
use super::question::{PreparedBlocks, PreparedQuestion, Question};
use rayon::prelude::*;

/// More questions of the campaign, a part of them at a time, the first being part 0; not asked yet, so without a reply. `None` after the last part.
pub type OtherQuestions<'a> = &'a (dyn Fn(u64) -> Option<Vec<Question>> + Sync);

/// Questions asked for one hypothesis, and for all together, at most.
const ASKED_FOR_ONE: usize = 64;
const ASKED: usize = 512;

/// What was found.
pub(super) struct Contradictions {
    /// Right answers, not next to a tie, that speak against each hypothesis.
    pub(super) against: Vec<usize>,
    /// What people call the questions that were answered right.
    pub(super) right: Vec<String>,
}

/// Asks the questions to which hypotheses have another answer than the exact one, until a right answer speaks against each of them, or there are no more.
/// Next to a tie the engine's rounding may be the reason, so that what is found by looking for it says nothing.
pub(super) fn contradictions(
    hypotheses: &[&dyn Hypothesis],
    others: OtherQuestions<'_>,
    asking: Asking<'_>,
) -> Contradictions {
    let mut found = Contradictions { against: vec![0; hypotheses.len()], right: Vec::new() };
    let (mut asked_for, mut asked) = (vec![0; hypotheses.len()], 0);
    for part in 0.. {
        let open: Vec<usize> =
            (0..hypotheses.len()).filter(|&at| found.against[at] == 0 && asked_for[at] < ASKED_FOR_ONE).collect();
        if open.is_empty() || asked >= ASKED {
            break;
        }
        let Some(questions) = others(part) else { break };
        let doubted: Vec<Vec<usize>> =
            questions.par_iter().map(|question| doubting(question, hypotheses, &open)).collect();
        let mut chosen: Vec<(Question, Vec<usize>)> = Vec::new();
        for (question, doubted) in questions.into_iter().zip(doubted) {
            if asked < ASKED && doubted.iter().any(|&at| asked_for[at] < ASKED_FOR_ONE) {
                asked += 1;
                doubted.iter().for_each(|&at| asked_for[at] += 1);
                chosen.push((question, doubted));
            }
        }
        let answers = chosen.into_par_iter().map(|(question, doubted)| {
            let reply = asking(&question.blocks, &question.tolerances);
            let question = Question { reply, ..question };
            let prepared = PreparedBlocks::of(&question.blocks);
            let asked = PreparedQuestion::new(&question, &prepared);
            let contradicted =
                |at: &usize| fits(hypotheses[*at], &asked) == Some(false) && !is_excused(hypotheses[*at], &asked);
            let is_right = asked.is_right() == Some(true);
            is_right.then(|| (question.label.clone(), doubted.into_iter().filter(contradicted).collect::<Vec<usize>>()))
        });
        for (label, contradicted) in answers.collect::<Vec<_>>().into_iter().flatten() {
            found.right.push(label);
            contradicted.into_iter().for_each(|at| found.against[at] += 1);
        }
    }
    found
}

/// Those of some hypotheses under which the contacts of a question are not the exact ones.
fn doubting(question: &Question, hypotheses: &[&dyn Hypothesis], open: &[usize]) -> Vec<usize> {
    let prepared = PreparedBlocks::of(&question.blocks);
    let asked = PreparedQuestion::new(question, &prepared);
    let exact = asked.exact();
    let differs = |at: &usize| hypotheses[*at].contacts(&asked).is_some_and(|contacts| contacts != *exact);
    open.iter().copied().filter(differs).collect()
}
