//! How much external engines say in their answers: what they leave unsaid is not compared, and people must know of how many.

#[cfg(test)]
mod tests;

use super::case_file::CaseDescription;
use super::compare::AnswerChange;
use super::engine::Answer;
use super::external::protocol::UNNAMED;
use super::separation_state::{ReportedState, SeparationState};
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
    /// Answers that named contacts, or that there are none. Runs and baselines of earlier versions have no such count.
    #[serde(default)]
    pub contact_answers: u64,
    /// Answers that the blocks are apart, here and below of pairs whose blocks are both convex: others are not compared. Each state is counted by itself: a code may measure overlaps alone, and then gives fewer gaps where it
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

/// What an answer leaves unsaid of what a case is about, in words: then it does not differ, and nobody knows whether it would. Of contacts only those
/// matter whose entrance or sign of the gap was another than the right one when the case was made.
pub fn left_unsaid(about: &CaseDescription, answer: &Answer) -> Option<&'static str> {
    let change = AnswerChange::from_name(&about.change)?;
    match answer {
        Answer::State(_) if change.is_of_contacts() => Some("no contacts"),
        Answer::State(said) if change == AnswerChange::Gap => said.gap_m.is_none().then_some("no gap"),
        Answer::State(said) if change == AnswerChange::Normal => said.normal.is_none().then_some("no normal"),
        Answer::State(_) => None,
        Answer::Contacts(_) if change.is_of_states() => Some("no state"),
        Answer::Contacts(said) if matches!(change, AnswerChange::Entrance | AnswerChange::GapSign) => {
            let differed = about.differing_contacts();
            said.iter()
                .any(|contact| contact.entrance == UNNAMED && differed.contains(&contact.key))
                .then_some("no entrance of a contact")
        }
        Answer::Contacts(_) => None,
    }
}

/// Of which pairs two counts are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CountedPairs {
    /// Both of the same pairs.
    Same,
    /// Each of other pairs, in campaigns of any size: a share may be another by chance, so only that something is given for none is told, where chance
    /// does not explain it.
    Other,
}

/// The answers to a batch of so many pairs count as one, since they may hang together.
const BATCH: f64 = 16.0;

/// What chance explains no better than this is no chance.
const NO_CHANCE: f64 = 0.001;

/// Something that an answer may leave unsaid, for how many of those that may say it.
#[derive(Clone, Copy)]
struct Share {
    what: &'static str,
    given: u64,
    of: u64,
    /// Of what it may be said, of one and of many.
    nouns: [&'static str; 2],
    /// Whether it is about contacts, not about how blocks lie.
    is_of_contacts: bool,
    /// The state; `None` of contacts, and of all three states together.
    state: Option<SeparationState>,
}

impl Share {
    fn note(self) -> String {
        let state = self.state.map_or(String::new(), |state| format!(" \"{state}\""));
        let [one, many] = self.nouns;
        format!("{} of {} {}{state}", self.given, self.of, noun(self.of, one, many))
    }

    fn is_below(self, before: Share) -> bool {
        u128::from(self.given) * u128::from(before.of) < u128::from(before.given) * u128::from(self.of)
    }

    /// Whether it is given for none, which chance does not explain: as in the gate's test of rates, of all that is given in both each falls to the
    /// count before with its share of all.
    fn is_gone(self, before: Share) -> bool {
        let share = before.of as f64 / (before.of as f64 + self.of as f64);
        self.given == 0 && before.given > 0 && share.powf(before.given as f64 / BATCH) < NO_CHANCE
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
            contact_answers: count(self.contact_answers, other.contact_answers),
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
        Share {
            what: "entrances and signs of gaps",
            given,
            of,
            nouns: ["contact", "contacts"],
            is_of_contacts: true,
            state: None,
        }
    }

    /// Answers that named contacts, among all.
    fn of_answers(self) -> Share {
        let given = self.contact_answers;
        Share {
            what: "contacts",
            given,
            of: given.saturating_add(self.states().answers),
            nouns: ["answer", "answers"],
            is_of_contacts: true,
            state: None,
        }
    }

    /// Whether it was counted which answers named contacts and which said how blocks lie, as earlier versions did not.
    pub fn counts_answers(self) -> bool {
        self.contact_answers > 0 || (self.contacts == 0 && self.states().answers > 0)
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
    /// Of the same pairs: contacts named in fewer answers, where how blocks lie is said in more; entrances for a smaller share of the contacts, and for
    /// more contacts no longer than there are fewer, or no contacts any more; gaps or normals for a smaller share of those that say the same state, and
    /// not only because some answers say another state now or fail, or no state any more. What was given for all and is not, or is given for none, is less in any case. Of other
    /// pairs: what is given for none, where that is no chance. Nothing is told of what earlier versions did not count.
    fn losses(self, before: AnswerDetail, pairs: CountedPairs) -> Vec<Option<[Share; 2]>> {
        let is_same = pairs == CountedPairs::Same;
        let [now, was] = [self, before].map(AnswerDetail::of_answers);
        let has_states_instead = now.given < was.given && self.states().answers > before.states().answers;
        let is_less = if is_same { has_states_instead } else { before.counts_answers() && now.is_gone(was) };
        let mut losses = vec![is_less.then_some([now, was])];

        let [now, was] = [self, before].map(AnswerDetail::of_contacts);
        // Contacts that are named anew, as where a mistake is mended, take no entrance away from others.
        let is_unexplained = was.given.saturating_sub(now.given) > was.of.saturating_sub(now.of);
        let is_smaller = now.is_below(was) && (was.given == was.of || now.given == 0 || is_unexplained);
        let is_less = if is_same { is_smaller || (was.of > 0 && now.of == 0) } else { now.is_gone(was) };
        losses.push(is_less.then_some([now, was]));

        let has_no_state = self.states().answers == 0;
        for ((state, now), (_, was)) in self.by_state().into_iter().zip(before.by_state()) {
            for (now, was) in of_state(Some(state), now).into_iter().zip(of_state(Some(state), was)) {
                let is_unexplained = was.given.saturating_sub(now.given) > was.of.abs_diff(now.of);
                let is_smaller = now.is_below(was) && (was.given == was.of || now.given == 0 || is_unexplained);
                let is_less = if is_same { is_smaller || (was.given > 0 && has_no_state) } else { now.is_gone(was) };
                losses.push(is_less.then_some([now, was]));
            }
        }
        losses
    }

    /// For how many contacts or states something was given.
    pub fn full_note_of(self, what: Unsaid) -> String {
        let share = self.share_of(what, None);
        format!("{} given for {}", share.what, share.note())
    }

    /// The same where it was not given for all.
    pub fn note_of(self, what: Unsaid) -> Option<String> {
        let share = self.share_of(what, None);
        (share.given < share.of).then(|| self.full_note_of(what))
    }

    /// How often something was given, and how often it may have been.
    pub fn counts_of(self, what: Unsaid) -> [u64; 2] {
        let share = self.share_of(what, None);
        [share.given, share.of]
    }

    /// Whether something was given often enough for a limit on it to say anything: for half of what may have it. A code may measure distances or overlaps
    /// alone, so half of the states apart, or of those overlapping, is enough where what is given there is a tenth of all. That blocks which touch have the
    /// gap 0 says nothing more than the state, so gaps of these do not count.
    pub fn is_given_enough(self, what: Unsaid) -> bool {
        let all = self.share_of(what, None);
        let [apart, touching, overlapping] = self.by_state().map(|(state, _)| self.share_of(what, Some(state)));
        let is_half = |given: u64, of: u64| given > 0 && given >= of - given.min(of);
        let (given, of) = match what {
            Unsaid::Gaps => (all.given - touching.given, all.of - touching.of),
            Unsaid::Entrances | Unsaid::Normals => (all.given, all.of),
        };
        let is_half_of_one = |share: &Share| is_half(share.given, share.of) && share.given >= all.of.div_ceil(10);
        is_half(given, of) || (what != Unsaid::Entrances && [apart, overlapping].iter().any(is_half_of_one))
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
    let share = |what, given| Share {
        what,
        given,
        of: detail.answers,
        nouns: ["state", "states"],
        is_of_contacts: false,
        state,
    };
    [share("gaps", detail.gaps), share("normals", detail.normals)]
}
