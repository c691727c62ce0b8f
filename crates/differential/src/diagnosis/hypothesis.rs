//! What may be wrong with an engine.

use super::question::{PreparedQuestion, Question, Reply};
use super::{altered_rules, answers, constants, input, parts, states, tolerances};
use crate::separation_state::ReportedState;
use rockproof_model::{Contact, ToleranceSet};

/// One thing that may be wrong with an engine that is exact otherwise.
pub(super) trait Hypothesis: Send + Sync {
    /// Its name in tables: lower case, hyphens.
    fn name(&self) -> String;

    /// What goes on "answers are exact …".
    fn sentence(&self) -> String;

    /// The contacts that such an engine finds, sorted; `None` where it has no answer, or where the hypothesis is about something else.
    fn contacts(&self, _asked: &PreparedQuestion<'_>) -> Option<Vec<Contact>> {
        None
    }

    /// Whether such an engine says what this one said of how the blocks lie; `None` as above.
    fn says_state(&self, _asked: &PreparedQuestion<'_>, _said: ReportedState) -> Option<bool> {
        None
    }

    /// How near to touching the blocks are for such an engine, in roundoffs of what it calculates in, where that is not what it is declared to be.
    fn roundoffs_from_touching(&self, _asked: &PreparedQuestion<'_>, _said: ReportedState) -> Option<f64> {
        None
    }

    /// The tolerances that such an engine takes for those it is given, if nothing else is wrong with it.
    fn tolerances(&self, _question: &Question) -> Option<ToleranceSet> {
        None
    }

    /// The tolerance that such an engine multiplies and the factor in thousandths, where that is all that is wrong with it.
    fn factor(&self) -> Option<(&'static str, i64)> {
        None
    }

    /// Where it differs from others by a limit alone: their name, and its place among them.
    fn ladder(&self) -> Option<(String, usize)> {
        None
    }

    /// This and those of its [`Hypothesis::ladder`] up to a place, as one.
    fn range_to(&self, _last: usize) -> Option<HypothesisRange> {
        None
    }

    /// Whether it explains answers by rounding in sound formulas: no mistake.
    fn is_rounding(&self) -> bool {
        false
    }

    /// Whether it is about exact ties alone: then nearness to a tie excuses no answer that speaks against it.
    fn is_about_ties(&self) -> bool {
        false
    }

    /// Whether an answer, right or wrong, shows that it is not what is wrong with the engine.
    fn is_refuted(&self, _asked: &PreparedQuestion<'_>) -> bool {
        false
    }

    /// Whether an answer is so near to the exact one that such an engine could not give it but by chance.
    fn is_too_accurate(&self, _asked: &PreparedQuestion<'_>) -> bool {
        false
    }

    /// Whether it allows so much that gaps which are all too large by one length, or by one factor, fit as well: then it is not told of those.
    fn allows_for_more(&self) -> bool {
        false
    }

    /// Whether it leaves part of an answer open: then one that leaves nothing open and explains the same is told alone.
    fn leaves_open(&self) -> bool {
        false
    }
}

/// Several hypotheses that differ by a number and explain the same, as one.
pub(super) struct HypothesisRange {
    pub(super) name: String,
    pub(super) sentence: String,
}

/// Whether a hypothesis gives the answer that the engine gave; `None` where it has none.
pub(super) fn fits(hypothesis: &dyn Hypothesis, asked: &PreparedQuestion<'_>) -> Option<bool> {
    match &asked.question.reply {
        Reply::State(said) => hypothesis.says_state(asked, *said),
        Reply::Contacts(_) => hypothesis.contacts(asked).map(|contacts| asked.has_contacts(&contacts)),
        Reply::Nothing(_) => None,
    }
}

/// All hypotheses. Where two explain as much, the first is named first.
pub(super) fn all() -> Vec<Box<dyn Hypothesis>> {
    let mut all = vec![answers::simplest()];
    all.extend(input::all());
    all.extend(answers::all());
    all.extend(states::all());
    all.extend(tolerances::all());
    all.extend(parts::all());
    all.extend(altered_rules::all());
    all.extend(constants::all());
    all
}

#[cfg(test)]
mod tests {
    use super::all;
    use std::collections::BTreeSet;

    #[test]
    fn every_hypothesis_has_a_name_and_a_sentence_of_its_own() {
        let all = all();
        let names: BTreeSet<String> = all.iter().map(|hypothesis| hypothesis.name()).collect();
        let sentences: BTreeSet<String> = all.iter().map(|hypothesis| hypothesis.sentence()).collect();
        assert_eq!((names.len(), sentences.len()), (all.len(), all.len()));
        let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || "-_.".contains(c);
        assert!(names.iter().all(|name| name.chars().all(plain)), "{names:?}");
    }
}
