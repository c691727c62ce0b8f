//! Whether an engine lags: whether each answer is that to the question before. Nothing in one question and its answer can show that, so the engine is
//! asked one question after the other, each twice: an engine that lags is right the second time.

use super::judge::{Asking, MIN_ANSWERS, Sample};
use super::question::{Question, Reply};
use std::collections::{BTreeMap, BTreeSet};

/// The name in tables of what is wrong then.
pub(super) const NAME: &str = "one-answer-late";

/// What goes on "answers are exact …".
pub(super) const SENTENCE: &str = "for the question asked before: the engine is one answer late";

/// Wrong answers that are not late, before it is given up where there are no more late ones.
const PATIENCE: usize = 3;

/// An engine that lags.
pub(super) struct Lag {
    /// What it answers now, asked in turn.
    pub(super) sample: Sample,
    /// The differing answers of the sample that are those to the question before, by place.
    pub(super) late: BTreeSet<usize>,
}

impl Lag {
    /// Asks the questions of a sample in turn, differing and agreeing ones in alternation, and each again at once; `None` as soon as the engine does not lag.
    /// It does where wrong answers are right for the question before and become right when asked again, no fewer than others, and no right answer is
    /// wrong for the question before.
    pub(super) fn find(sample: &Sample, asking: Asking<'_>) -> Option<Lag> {
        let mut found =
            Lag { sample: Sample { all_differing: sample.all_differing, ..Sample::default() }, late: BTreeSet::new() };
        let (mut late, mut others) = (0, 0);
        for turns in in_turn(sample) {
            let Some((mut before, _)) = turns.last().copied() else { continue };
            // Whatever was asked before that.
            asking(&before.blocks, &before.tolerances);
            for (question, differs) in turns {
                let reply = asking(&question.blocks, &question.tolerances);
                let is_late = Question { reply: reply.clone(), ..before.clone() }.is_right() == Some(true);
                let now = Question { reply, ..question.clone() };
                before = question;
                let again = asking(&question.blocks, &question.tolerances);
                let is_late = is_late && Question { reply: again, ..question.clone() }.is_right() == Some(true);
                match (now.is_right(), is_late) {
                    (Some(true), false) => return None,
                    (Some(false), true) => late += 1,
                    (Some(false), false) => others += 1,
                    (Some(true), true) | (None, _) => {}
                }
                if others > late && others >= PATIENCE {
                    return None;
                }
                if differs && !matches!(now.reply, Reply::Nothing(_)) {
                    if is_late {
                        found.late.insert(found.sample.differing.len());
                    }
                    found.sample.differing.push(now);
                } else if !differs && now.is_right() == Some(true) {
                    found.sample.agreeing.push(now);
                }
            }
        }
        (late >= MIN_ANSWERS && late >= others).then_some(found)
    }
}

/// The questions of a sample in the order in which they are asked, and whether each is one that was answered otherwise than exactly. Only blocks with as
/// many features as one another's are asked one after the other: of others an answer that is late names features that are not there, and an engine is
/// started anew after it.
fn in_turn(sample: &Sample) -> Vec<Vec<(&Question, bool)>> {
    let size = |question: &Question| -> [[usize; 3]; 2] {
        question.blocks.each_ref().map(|block| {
            let topology = block.topology();
            [block.vertices().len(), topology.edges().len(), topology.faces().len()]
        })
    };
    let mut of_size: BTreeMap<[[usize; 3]; 2], [Vec<&Question>; 2]> = BTreeMap::new();
    for question in sample.differing.iter().filter(|question| !matches!(question.reply, Reply::Nothing(_))) {
        of_size.entry(size(question)).or_default()[0].push(question);
    }
    for question in &sample.agreeing {
        if let Some([_, agreeing]) = of_size.get_mut(&size(question)) {
            agreeing.push(question);
        }
    }
    let mut groups: Vec<[Vec<&Question>; 2]> = of_size.into_values().collect();
    groups.sort_by_key(|[differing, _]| std::cmp::Reverse(differing.len()));
    groups.into_iter().map(alternating).collect()
}

/// Differing and agreeing questions by turns, until there are no more differing ones.
fn alternating([differing, agreeing]: [Vec<&Question>; 2]) -> Vec<(&Question, bool)> {
    let mut agreeing = agreeing.into_iter();
    let with_next = |question| [Some((question, true)), agreeing.next().map(|other| (other, false))];
    differing.into_iter().flat_map(with_next).flatten().collect()
}
