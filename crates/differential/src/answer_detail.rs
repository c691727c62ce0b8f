//! How much external engines say in their answers: what they leave unsaid is not compared, and people must know of how many.

#[cfg(test)]
mod tests;

use super::compare::AnswerChange;
use super::engine::Answer;
use super::external::protocol::UNNAMED;
use super::separation_state::{ReportedState, SeparationState};
use rockproof_model::Contact;
use rockproof_model::text::noun;
use serde::{Deserialize, Serialize};

/// How much an engine from outside said in its answers, of contacts and of how blocks lie.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AnswerDetail {
    /// Contacts that it named.
    pub contacts: u64,
    /// Those with an entrance, and so with the sign of the gap: neither is read without the other.
    pub entrances: u64,
    /// Those with `gap_m`, of which the sign alone is compared.
    pub gap_m: u64,
    /// Answers that the blocks are apart. Each state is counted by itself: a code may measure overlaps alone, and then gives fewer gaps where it
    /// mends what it called overlapping. Runs and baselines of earlier versions have none of these.
    #[serde(default)]
    pub apart: StateDetail,
    /// Answers that they touch.
    #[serde(default)]
    pub touching: StateDetail,
    /// Answers that they overlap.
    #[serde(default)]
    pub overlapping: StateDetail,
}

/// How much was said of pairs whose blocks lie to one another in one way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StateDetail {
    /// Answers that they lie so.
    pub answers: u64,
    /// Those with `gap_m`.
    pub gaps: u64,
    /// Those with `normal`.
    pub normals: u64,
}

impl StateDetail {
    fn of_each(self, other: StateDetail, count: impl Fn(u64, u64) -> u64) -> StateDetail {
        StateDetail {
            answers: count(self.answers, other.answers),
            gaps: count(self.gaps, other.gaps),
            normals: count(self.normals, other.normals),
        }
    }
}

/// Something that an answer may leave unsaid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unsaid {
    /// The entrance of a contact, and with it the sign of the gap.
    Entrances,
    /// The gap of a state.
    Gaps,
    /// The normal of a state.
    Normals,
}

/// What an answer leaves unsaid of what a finding with this change of such contacts is about, in words: then it does not differ, and nobody knows whether
/// it would. `kinds` are those of the contact before and after the change, in one text; empty where they are not known.
pub fn left_unsaid(change: AnswerChange, kinds: &str, answer: &Answer) -> Option<&'static str> {
    let is_meant = |contact: &&Contact| kinds.is_empty() || kinds.contains(contact.kind().name());
    match answer {
        Answer::State(_) if change.is_of_contacts() => Some("no contacts"),
        Answer::State(said) if change == AnswerChange::Gap => said.gap_m.is_none().then_some("no gap"),
        Answer::State(said) if change == AnswerChange::Normal => said.normal.is_none().then_some("no normal"),
        Answer::State(_) => None,
        Answer::Contacts(_) if change.is_of_states() => Some("no state"),
        Answer::Contacts(said) if matches!(change, AnswerChange::Entrance | AnswerChange::GapSign) => said
            .iter()
            .filter(is_meant)
            .any(|contact| contact.entrance == UNNAMED)
            .then_some("not each contact an entrance"),
        Answer::Contacts(_) => None,
    }
}

/// Of which pairs two counts are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CountedPairs {
    /// Both of the same pairs.
    Same,
    /// Each of other pairs.
    Other,
    /// Each of other pairs, in campaigns of any size, and the same engine is counted of the same pairs as well: then nothing is told that chance may
    /// explain.
    Rotating,
}

impl CountedPairs {
    /// How likely it is by chance that nothing is given of `of`, where `before` is given of `of_before`: as in the gate's test of rates, of all that
    /// is given in both each falls to the count before with its share of all. Of pairs that rotate the answers to a batch of sixteen count as one.
    fn chance_of_none(self, of: u64, before: u64, of_before: u64) -> f64 {
        let together = match self {
            CountedPairs::Same => return 0.0,
            CountedPairs::Other => 1.0,
            CountedPairs::Rotating => 16.0,
        };
        (of_before as f64 / (of_before as f64 + of as f64)).powf(before as f64 / together)
    }
}

/// What chance explains no better than this is no chance.
const NO_CHANCE: f64 = 0.001;

/// Something that an answer may leave unsaid, for how many of those that may say it.
#[derive(Clone, Copy)]
struct Share {
    what: &'static str,
    given: u64,
    of: u64,
    /// Whether it may be said of contacts, not of states.
    is_of_contacts: bool,
    /// The state; `None` of contacts, and of all three states together.
    state: Option<SeparationState>,
}

impl Share {
    fn note(self) -> String {
        let state = self.state.map_or(String::new(), |state| format!(" \"{state}\""));
        let [one, many] = if self.is_of_contacts { ["contact", "contacts"] } else { ["state", "states"] };
        format!("{} of {} {}{state}", self.given, self.of, noun(self.of, one, many))
    }

    fn is_below(self, before: Share) -> bool {
        u128::from(self.given) * u128::from(before.of) < u128::from(before.given) * u128::from(self.of)
    }

    /// Whether that it is below is no chance of other pairs: it was all and is not, or is none and was not, which few pairs may show by chance.
    fn is_all_or_none(self, before: Share, pairs: CountedPairs) -> bool {
        let is_none = || self.given == 0 && pairs.chance_of_none(self.of, before.given, before.of) < NO_CHANCE;
        before.given == before.of || is_none()
    }
}

/// What an engine says of another share of its answers than before.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DetailShift {
    /// What it says, in words.
    pub what: String,
    /// Of how many, before.
    pub before: String,
    /// The same after.
    pub after: String,
    /// Whether it says less.
    pub less: bool,
    /// Whether it is about contacts, not about how blocks lie.
    pub is_of_contacts: bool,
}

impl AnswerDetail {
    /// What one answer says of how blocks lie.
    pub fn of_state(said: &ReportedState) -> AnswerDetail {
        let mut detail = AnswerDetail::default();
        let one = match said.state {
            SeparationState::Apart => &mut detail.apart,
            SeparationState::Touching => &mut detail.touching,
            SeparationState::Overlapping => &mut detail.overlapping,
        };
        *one = StateDetail {
            answers: 1,
            gaps: u64::from(said.gap_m.is_some()),
            normals: u64::from(said.normal.is_some()),
        };
        detail
    }

    /// What came on top of `before`.
    #[must_use]
    pub fn since(self, before: AnswerDetail) -> AnswerDetail {
        self.of_each(before, u64::saturating_sub)
    }

    /// The sums of both.
    #[must_use]
    pub fn plus(self, other: AnswerDetail) -> AnswerDetail {
        self.of_each(other, u64::saturating_add)
    }

    fn of_each(self, other: AnswerDetail, count: impl Fn(u64, u64) -> u64) -> AnswerDetail {
        AnswerDetail {
            contacts: count(self.contacts, other.contacts),
            entrances: count(self.entrances, other.entrances),
            gap_m: count(self.gap_m, other.gap_m),
            apart: self.apart.of_each(other.apart, &count),
            touching: self.touching.of_each(other.touching, &count),
            overlapping: self.overlapping.of_each(other.overlapping, &count),
        }
    }

    /// All answers that say how blocks lie, in whichever way.
    pub fn states(self) -> StateDetail {
        let sum = |one: StateDetail, other: StateDetail| one.of_each(other, u64::saturating_add);
        sum(sum(self.apart, self.touching), self.overlapping)
    }

    /// The same by the way in which they lie.
    pub fn by_state(self) -> [(SeparationState, StateDetail); 3] {
        [
            (SeparationState::Apart, self.apart),
            (SeparationState::Touching, self.touching),
            (SeparationState::Overlapping, self.overlapping),
        ]
    }

    fn of_contacts(self) -> Share {
        let (given, of) = (self.entrances, self.contacts);
        Share { what: "entrances and signs of gaps", given, of, is_of_contacts: true, state: None }
    }

    /// For how many contacts or states what was given, where that is not all.
    pub fn incomplete_note(self) -> Option<String> {
        let [gaps, normals] = of_state(None, self.states());
        let incomplete = [self.of_contacts(), gaps, normals].into_iter().filter(|share| share.given < share.of);
        let mut notes: Vec<(String, String)> = Vec::new();
        for share in incomplete {
            match notes.last_mut().filter(|(_, note)| *note == share.note()) {
                Some((what, _)) => *what += &format!(" and {}", share.what),
                None => notes.push((share.what.to_owned(), share.note())),
            }
        }
        let notes: Vec<String> = notes.into_iter().map(|(what, note)| format!("{what} given for {note}")).collect();
        (!notes.is_empty()).then(|| notes.join(", "))
    }

    /// What is given for another share of the contacts or states than before, beyond what chance or other answers may do to shares.
    pub fn shifts(self, before: AnswerDetail, pairs: CountedPairs) -> Vec<DetailShift> {
        let less = self.losses(before, pairs);
        let more = before.losses(self, pairs);
        let mut shifts: Vec<DetailShift> = Vec::new();
        for (less, more) in less.into_iter().zip(more) {
            let Some((now, was, less)) =
                less.map(|[now, was]| (now, was, true)).or(more.map(|[was, now]| (now, was, false)))
            else {
                continue;
            };
            let (before, after) = (was.note(), now.note());
            let alike = |last: &&mut DetailShift| (&last.before, &last.after, last.less) == (&before, &after, less);
            match shifts.last_mut().filter(alike) {
                Some(last) => last.what += &format!(" and {}", now.what),
                None => {
                    let (what, is_of_contacts) = (now.what.to_owned(), now.is_of_contacts);
                    shifts.push(DetailShift { what, before, after, less, is_of_contacts });
                }
            }
        }
        shifts
    }

    /// What is given for a smaller share than before, now and before; always as many, in the same order.
    ///
    /// Contacts: entrances for a smaller share of them, and for more contacts no longer than there are fewer; or no contacts are named any more. States:
    /// gaps or normals for a smaller share of those that say the same, and not only because some answers say another state now or fail; or no answer says
    /// a state any more. Of other pairs a share may be another by chance: there it is less where it was all and is not, or is none and was not.
    fn losses(self, before: AnswerDetail, pairs: CountedPairs) -> Vec<Option<[Share; 2]>> {
        let [now, was] = [self, before].map(AnswerDetail::of_contacts);
        // Of few pairs it may be by chance that there is none at all.
        let may_be_gone = pairs != CountedPairs::Rotating;
        // Contacts that are named anew, as where a mistake is mended, take no entrance away from others.
        let is_unexplained = was.given.saturating_sub(now.given) > was.of.saturating_sub(now.of);
        let is_certain = now.is_all_or_none(was, pairs) || (pairs == CountedPairs::Same && is_unexplained);
        let is_gone = (may_be_gone && was.of > 0 && now.of == 0) || self.names_fewer_contacts(before, pairs);
        let mut losses = vec![(is_gone || (now.is_below(was) && is_certain)).then_some([now, was])];
        let is_gone = may_be_gone && self.states().answers == 0;
        for ((state, now), (_, was)) in self.by_state().into_iter().zip(before.by_state()) {
            for (now, was) in of_state(Some(state), now).into_iter().zip(of_state(Some(state), was)) {
                let is_unexplained = was.given.saturating_sub(now.given) > was.of.abs_diff(now.of);
                let is_certain = now.is_all_or_none(was, pairs) || (pairs == CountedPairs::Same && is_unexplained);
                let is_less = now.is_below(was) && is_certain;
                losses.push(((was.given > 0 && is_gone) || is_less).then_some([now, was]));
            }
        }
        losses
    }

    /// Whether some answers that named contacts say only how blocks lie now.
    fn names_fewer_contacts(self, before: AnswerDetail, pairs: CountedPairs) -> bool {
        let [now, was] = [self, before].map(|detail| detail.states().answers);
        let is_new = was == 0 && now > 0 && before.contacts > 0;
        is_new || (pairs == CountedPairs::Same && now > was && self.contacts < before.contacts)
    }

    /// For how many contacts or states something was given, where not for all.
    pub fn note_of(self, what: Unsaid) -> Option<String> {
        let share = self.share_of(what, None);
        (share.given < share.of).then(|| format!("{} given for {}", share.what, share.note()))
    }

    /// How often something was given, and how often it may have been.
    pub fn counts_of(self, what: Unsaid) -> [u64; 2] {
        let share = self.share_of(what, None);
        [share.given, share.of]
    }

    /// Whether something was given often enough for a limit on it to say anything: for half of what may have it. A code may measure distances or overlaps
    /// alone, so half of the states apart, or of those overlapping, is enough where it is a tenth of all states. That blocks which touch have the gap 0
    /// says nothing more than the state.
    pub fn is_given_enough(self, what: Unsaid) -> bool {
        let all = self.share_of(what, None);
        let [(_, apart), _, (_, overlapping)] =
            self.by_state().map(|(state, _)| (state, self.share_of(what, Some(state))));
        let is_half = |share: &Share| share.given > 0 && share.given >= share.of - share.given;
        is_half(&all) || [apart, overlapping].iter().any(|share| is_half(share) && share.given >= all.of.div_ceil(10))
    }

    /// The share of something among all contacts or states, or among the states that say one thing.
    fn share_of(self, what: Unsaid, state: Option<SeparationState>) -> Share {
        let is_meant = |one: &(SeparationState, StateDetail)| Some(one.0) == state;
        let detail = self.by_state().into_iter().find(is_meant).map_or(self.states(), |(_, detail)| detail);
        let [gaps, normals] = of_state(state, detail);
        match what {
            Unsaid::Entrances => self.of_contacts(),
            Unsaid::Gaps => gaps,
            Unsaid::Normals => normals,
        }
    }
}

/// Gaps and normals of the answers that blocks lie so.
fn of_state(state: Option<SeparationState>, detail: StateDetail) -> [Share; 2] {
    let share = |what, given| Share { what, given, of: detail.answers, is_of_contacts: false, state };
    [share("gaps", detail.gaps), share("normals", detail.normals)]
}
