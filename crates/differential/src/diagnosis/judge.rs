//! Which hypotheses explain the answers of an engine.

#[cfg(test)]
mod tests;

use super::contradictions::{OtherQuestions, contradictions};
use super::hypothesis::{Hypothesis, all, fits};
use super::lag::{self, Lag};
use super::question::{PreparedBlocks, PreparedQuestion, Question, Reply};
use super::ranges::as_ranges;
use super::row::{ALL_NEAR_TIES, DiagnosisRow, DiagnosisVerdict};
use super::states::have_one_mistake;
use super::tolerances::probes;
use crate::answer_detail::AnswerDetail;
use crate::finding::FAR_FROM_TIE;
use rayon::prelude::*;
use rockproof_model::{Block, Contact, ToleranceSet};
use std::collections::BTreeSet;

/// Answers of one engine.
#[derive(Clone, Debug, Default)]
pub struct Sample {
    /// Questions that it answered otherwise than exactly in the campaign, asked again. Those without an answer now count for nothing.
    pub differing: Vec<Question>,
    /// Questions that it answers exactly.
    pub agreeing: Vec<Question>,
    /// How many differing answers there are in the campaign.
    pub all_differing: u64,
}

/// Asks the engine.
pub type Asking<'a> = &'a (dyn Fn(&[Block; 2], &ToleranceSet) -> Reply + Sync);

/// Fewer answers than this show nothing.
pub(super) const MIN_ANSWERS: usize = 3;

/// One answer in so many may be more accurate by chance than a hypothesis allows: of engines in f32 fewer than one in a hundred were, of one in f64 that
/// prints seven digits one in four.
const BY_CHANCE: usize = 16;

/// Explanations looked for, one after the other: each of what those before it leave over.
const EXPLANATIONS: usize = 3;

/// Hypotheses named that right answers speak against.
const CONTRADICTED: usize = 5;

/// Questions asked anew, at most, to tell two hypotheses apart, and answers that they are made of.
const PROBES: usize = 64;
const PROBED: usize = 6;

/// One question and what each hypothesis makes of it.
struct Judged {
    /// Whether the engine is right now; `None` where nobody knows.
    right: Option<bool>,
    /// Whether each hypothesis gives the engine's answer.
    fits: Vec<Option<bool>>,
    /// The hypotheses that the answer refutes.
    refuted: BTreeSet<usize>,
    /// The hypotheses that it is too accurate for.
    too_accurate: BTreeSet<usize>,
    /// [`PreparedQuestion::roundoffs_from_tie`].
    roundoffs: f64,
    /// The gap of a state as said and as it is.
    gap: Option<[f64; 2]>,
}

/// What right answers say against a hypothesis.
#[derive(Clone, Copy, Default)]
struct Against {
    /// Right answers that it would have changed.
    all: usize,
    /// Those of them that are not next to a tie.
    far: usize,
    /// Answers, right or wrong, that are too accurate for it.
    too_accurate: usize,
}

impl Against {
    /// Adds right answers that are not next to a tie.
    fn add(&mut self, far: usize) {
        self.all += far;
        self.far += far;
    }

    /// Whether the hypothesis stands, which explains so many of all answers.
    fn spares(self, explained: usize, answers: usize) -> bool {
        self.far == 0 && self.all * 10 <= explained && self.too_accurate * BY_CHANCE <= answers
    }
}

/// Says which hypotheses explain the differing answers of an engine. The same rows for the same sample, as long as the engine says the same. Before one
/// is told, right answers that it would have changed are looked for among the `others`.
pub fn diagnose(engine: &str, sample: &Sample, asking: Asking<'_>, others: OtherQuestions<'_>) -> Vec<DiagnosisRow> {
    let hypotheses = all();
    let lag = Lag::find(sample, asking);
    let sample = lag.as_ref().map_or(sample, |lag| &lag.sample);
    let late = lag.as_ref().map(|lag| &lag.late);
    let is_late = |at: usize| late.is_some_and(|late| late.contains(&at));
    // A crash, a late answer or one that cannot be read says nothing about contacts, so no hypothesis about contacts can explain it.
    let answered: Vec<&Question> =
        sample.differing.iter().filter(|question| !matches!(question.reply, Reply::Nothing(_))).collect();
    let judged: Vec<Judged> = answered.par_iter().map(|question| judge(question, &hypotheses)).collect();
    let differing = answered.len() as u64;
    // Right answers found beside the sample, each once however often it was asked for.
    let mut beside: BTreeSet<String> = BTreeSet::new();
    let row = |verdict, answers: usize| DiagnosisRow {
        engine: engine.to_owned(),
        verdict,
        hypothesis: String::new(),
        sentence: String::new(),
        answers: answers as u64,
        differing,
        all_differing: sample.all_differing,
        contradicted: 0,
        agreeing: 0,
        example: String::new(),
    };
    let about = |verdict, number: usize, answers: usize, against: Against| DiagnosisRow {
        hypothesis: hypotheses[number].name(),
        sentence: hypotheses[number].sentence(),
        contradicted: against.all as u64,
        ..row(verdict, answers)
    };
    let explained = |number: usize, of: &[usize]| -> Vec<usize> {
        of.iter().copied().filter(|&at| judged[at].fits[number] == Some(true)).collect()
    };
    let everything: Vec<usize> = (0..judged.len()).collect();
    let mut left: Vec<usize> =
        everything.iter().copied().filter(|&at| judged[at].right != Some(true) && !is_late(at)).collect();
    let is_refuted = |number: usize| judged.iter().any(|one| one.refuted.contains(&number));
    let alive: Vec<usize> =
        (0..hypotheses.len()).filter(|&number| !explained(number, &left).is_empty() && !is_refuted(number)).collect();
    let mut against = against(&sample.agreeing, &hypotheses, &alive);
    for &number in judged.iter().flat_map(|one| &one.too_accurate) {
        against[number].too_accurate += 1;
    }
    let answers = judged.len() + sample.agreeing.len();
    let is_simpler = |number: usize| {
        let gaps: Vec<[f64; 2]> = explained(number, &left).into_iter().filter_map(|at| judged[at].gap).collect();
        hypotheses[number].allows_for_more() && have_one_mistake(&gaps)
    };
    let stands =
        |&number: &usize| against[number].spares(explained(number, &left).len(), answers) && !is_simpler(number);
    let mut standing: Vec<usize> = alive.iter().copied().filter(stands).collect();
    let mut rows = Vec::new();
    if let Some(late) = late {
        let late: Vec<usize> = late.iter().copied().collect();
        let example = worst(&late, &judged, &answered);
        let questions: Vec<&Question> = late.iter().map(|&at| answered[at]).collect();
        let (hypothesis, sentence) = (lag::NAME.to_owned(), lag::SENTENCE.to_owned() + &unsaid(&questions));
        rows.push(DiagnosisRow { hypothesis, sentence, example, ..row(DiagnosisVerdict::Explains, late.len()) });
    }
    // Next to a tie for the engine of a chosen hypothesis, which calculates in less than it is declared to.
    let mut near_for_chosen: Vec<usize> = Vec::new();
    let mut chosen = Vec::new();
    let mut searched = vec![false; hypotheses.len()];
    while chosen.len() < EXPLANATIONS {
        let is_far = |at: &&usize| judged[**at].roundoffs > FAR_FROM_TIE;
        let far_left = left.iter().filter(is_far).count();
        let weight = |number: usize| {
            let all = explained(number, &left);
            (all.iter().filter(is_far).count(), all.len())
        };
        // Of equally good ones the first.
        let Some(best) = standing.iter().copied().rev().max_by_key(|&number| weight(number)) else { break };
        let (far, count) = weight(best);
        let tells = hypotheses[best].is_rounding()
            || far >= MIN_ANSWERS && far * 10 >= far_left
            || count > 2 * MIN_ANSWERS && count * 2 >= left.len()
            || count == left.len();
        if count < MIN_ANSWERS || !tells {
            break;
        }
        let of_best = explained(best, &left);
        let alike: Vec<usize> =
            standing.iter().copied().filter(|&number| explained(number, &left) == of_best).collect();
        let leaves_open = |number: &usize| hypotheses[*number].leaves_open();
        let whole: Vec<usize> = alike.iter().copied().filter(|number| !leaves_open(number)).collect();
        let alike = if whole.is_empty() { alike } else { whole };
        let questions: Vec<&Question> = of_best.iter().map(|&at| answered[at]).collect();
        let alike = distinct(alike, &hypotheses, &questions);
        let new: Vec<usize> = alike.iter().copied().filter(|&number| !searched[number]).collect();
        let suspects: Vec<&dyn Hypothesis> = new.iter().map(|&number| &*hypotheses[number]).collect();
        let found = contradictions(&suspects, others, asking);
        beside.extend(found.right);
        for (&number, speaking) in new.iter().zip(found.against) {
            searched[number] = true;
            against[number].add(speaking);
        }
        let before = standing.len();
        standing.retain(|&number| against[number].far == 0);
        if standing.len() < before {
            continue;
        }
        let alike = told_apart(alike, &hypotheses, &questions, asking);
        for (place, (number, range)) in as_ranges(&alike, &hypotheses).into_iter().enumerate() {
            let verdict = if place == 0 { DiagnosisVerdict::Explains } else { DiagnosisVerdict::AsWell };
            let example = worst(&of_best, &judged, &answered);
            let mut row = DiagnosisRow { example, ..about(verdict, number, count, against[number]) };
            if let Some(range) = range {
                (row.hypothesis, row.sentence) = (range.name, range.sentence);
            }
            if verdict == DiagnosisVerdict::Explains {
                row.sentence += &unsaid(&questions);
            }
            rows.push(row);
        }
        chosen.extend(alike.first().copied());
        left.retain(|at| !of_best.contains(at));
        near_for_chosen.extend(left.extract_if(.., |at| is_excused_state(answered[*at], &*hypotheses[best])));
    }
    let (mut near, unexplained): (Vec<usize>, Vec<usize>) =
        left.iter().copied().partition(|&at| is_near(answered[at], &judged[at], &chosen, &hypotheses));
    near.extend(near_for_chosen);
    near.sort_unstable();
    let others = [
        (DiagnosisVerdict::Rounding, near),
        (DiagnosisVerdict::Unexplained, unexplained),
        (
            DiagnosisVerdict::NotRepeated,
            everything.into_iter().filter(|&at| judged[at].right == Some(true) && !is_late(at)).collect(),
        ),
    ];
    for (verdict, answers) in others {
        if !answers.is_empty() {
            let near = verdict == DiagnosisVerdict::Unexplained
                && answers.iter().all(|&at| judged[at].roundoffs <= FAR_FROM_TIE);
            let sentence = if near { ALL_NEAR_TIES.to_owned() } else { String::new() };
            let example = worst(&answers, &judged, &answered);
            rows.push(DiagnosisRow { example, sentence, ..row(verdict, answers.len()) });
        }
    }
    let mut fallen: Vec<(usize, usize)> = alive
        .iter()
        .filter(|number| !standing.contains(number) && against[**number].all > 0)
        .map(|&number| (judged.iter().filter(|one| one.fits[number] == Some(true)).count(), number))
        .collect();
    fallen.sort_by_key(|&(count, number)| (std::cmp::Reverse(count), number));
    rows.extend(
        fallen
            .into_iter()
            .take(CONTRADICTED)
            .map(|(count, number)| about(DiagnosisVerdict::Contradicted, number, count, against[number])),
    );
    beside.retain(|label| sample.agreeing.iter().all(|question| question.label != *label));
    let agreeing = (sample.agreeing.len() + beside.len()) as u64;
    rows.iter_mut().for_each(|row| row.agreeing = agreeing);
    rows
}

/// What is said of answers that leave entrances, gaps or normals unsaid: they are exact in what they say, which is all that is compared.
fn unsaid(questions: &[&Question]) -> String {
    let detail = questions.iter().fold(AnswerDetail::default(), |sum, question| sum.plus(question.detail()));
    detail.incomplete_note().map_or(String::new(), |note| format!(", as far as they go ({note})"))
}

fn judge(question: &Question, hypotheses: &[Box<dyn Hypothesis>]) -> Judged {
    let prepared = PreparedBlocks::of(&question.blocks);
    let asked = PreparedQuestion::new(question, &prepared);
    Judged {
        right: asked.is_right(),
        fits: hypotheses.iter().map(|hypothesis| fits(&**hypothesis, &asked)).collect(),
        refuted: (0..hypotheses.len()).filter(|&number| hypotheses[number].is_refuted(&asked)).collect(),
        too_accurate: (0..hypotheses.len()).filter(|&number| hypotheses[number].is_too_accurate(&asked)).collect(),
        roundoffs: asked.roundoffs_from_tie(),
        gap: asked.gap(),
    }
}

/// What right answers say against each hypothesis; 0 of those that are not `alive`, which nobody asks about.
fn against(agreeing: &[Question], hypotheses: &[Box<dyn Hypothesis>], alive: &[usize]) -> Vec<Against> {
    let one = |question: &Question| -> Vec<(usize, Against)> {
        let prepared = PreparedBlocks::of(&question.blocks);
        let asked = PreparedQuestion::new(question, &prepared);
        let of = |&number: &usize| {
            let hypothesis = &*hypotheses[number];
            let is_contradicted = fits(hypothesis, &asked) == Some(false);
            let against = Against {
                all: usize::from(is_contradicted),
                far: usize::from(is_contradicted && !is_excused(hypothesis, &asked)),
                too_accurate: usize::from(hypothesis.is_too_accurate(&asked)),
            };
            (number, against)
        };
        alive.iter().map(of).collect()
    };
    let mut sums = vec![Against::default(); hypotheses.len()];
    for (number, Against { all, far, too_accurate }) in agreeing.par_iter().flat_map_iter(one).collect::<Vec<_>>() {
        sums[number].all += all;
        sums[number].far += far;
        sums[number].too_accurate += too_accurate;
    }
    sums
}

/// Whether an answer differs from that of a hypothesis next to a tie only, where the engine's rounding can be the reason.
pub(super) fn is_excused(hypothesis: &dyn Hypothesis, asked: &PreparedQuestion<'_>) -> bool {
    let roundoffs = match &asked.question.reply {
        Reply::Contacts(said) => {
            let between = |contacts: Vec<Contact>| asked.roundoffs_between(&contacts, said, &asked.question.tolerances);
            hypothesis.contacts(asked).map(between)
        }
        Reply::State(said) => hypothesis.roundoffs_from_touching(asked, *said),
        Reply::Nothing(_) => None,
    };
    !hypothesis.is_about_ties() && roundoffs.is_some_and(|roundoffs| roundoffs <= FAR_FROM_TIE)
}

/// Whether an answer says how blocks lie, and differs from what a hypothesis says only where rounding can be the reason.
fn is_excused_state(question: &Question, hypothesis: &dyn Hypothesis) -> bool {
    let Reply::State(_) = question.reply else { return false };
    let prepared = PreparedBlocks::of(&question.blocks);
    is_excused(hypothesis, &PreparedQuestion::new(question, &prepared))
}

/// Whether rounding can be the reason of an answer, by itself or beside what an accepted hypothesis says. By itself only where it is not known how
/// the engine rounds: if others of its answers are just what ordinary rounding gives, this one would be, too.
fn is_near(question: &Question, judged: &Judged, chosen: &[usize], hypotheses: &[Box<dyn Hypothesis>]) -> bool {
    let (known, mistakes): (Vec<usize>, Vec<usize>) =
        chosen.iter().partition(|number| hypotheses[**number].is_rounding());
    if known.is_empty() && judged.roundoffs <= FAR_FROM_TIE {
        return true;
    }
    let prepared = PreparedBlocks::of(&question.blocks);
    let asked = PreparedQuestion::new(question, &prepared);
    mistakes.into_iter().any(|number| is_excused(&*hypotheses[number], &asked))
}

/// One of some answers: the furthest from a tie among those with a case file, or else among all.
fn worst(answers: &[usize], judged: &[Judged], questions: &[&Question]) -> String {
    let label = |at: usize| &questions[at].label;
    let best = answers.iter().copied().rev().max_by(|&one, &other| {
        let key = |at: usize| (label(at).ends_with(".toml"), judged[at].roundoffs);
        let ((one_case, one), (other_case, other)) = (key(one), key(other));
        one_case.cmp(&other_case).then(one.total_cmp(&other))
    });
    best.map_or(String::new(), |at| label(at).clone())
}

/// Those of some hypotheses that explain the same answers which are not the same thing: not the same tolerances in all these questions, and not
/// several ways to round.
fn distinct(alike: Vec<usize>, hypotheses: &[Box<dyn Hypothesis>], questions: &[&Question]) -> Vec<usize> {
    let same = |one: usize, other: usize| {
        let (one, other) = (&hypotheses[one], &hypotheses[other]);
        let under = |question: &&Question| {
            let both = (one.tolerances(question), other.tolerances(question));
            both.0.is_some() && both.0 == both.1
        };
        one.is_rounding() && other.is_rounding() || questions.iter().all(under)
    };
    let mut distinct: Vec<usize> = Vec::new();
    for number in alike {
        if distinct.iter().all(|&other| !same(other, number)) {
            distinct.push(number);
        }
    }
    distinct
}

/// Those of some hypotheses that explain the same answers which also foretell what the engine says where they part: asked are the same blocks
/// under tolerances changed a little.
fn told_apart(
    mut alike: Vec<usize>,
    hypotheses: &[Box<dyn Hypothesis>],
    questions: &[&Question],
    asking: Asking<'_>,
) -> Vec<usize> {
    let mut left = PROBES;
    for question in questions.iter().take(PROBED) {
        let prepared = PreparedBlocks::of(&question.blocks);
        for tolerances in probes(&question.tolerances) {
            if alike.len() < 2 || left == 0 {
                return alike;
            }
            let Ok(tolerances) = tolerances.rounded(question.precision) else { continue };
            let mut probe = Question { tolerances, ..(*question).clone() };
            let asked = PreparedQuestion::new(&probe, &prepared);
            let foretold = |number: &usize| hypotheses[*number].contacts(&asked);
            let first = foretold(&alike[0]);
            if alike.iter().all(|number| foretold(number) == first) {
                continue;
            }
            probe.reply = asking(&probe.blocks, &probe.tolerances);
            left -= 1;
            let asked = PreparedQuestion::new(&probe, &prepared);
            let fit: Vec<usize> =
                alike.iter().copied().filter(|&number| fits(&*hypotheses[number], &asked) == Some(true)).collect();
            if !fit.is_empty() {
                alike = fit;
            }
        }
    }
    alike
}
