//! How much external engines say in their answers: what they leave unsaid is not compared, and people must know of how many.

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

    /// Whether that it is below is no chance of other pairs: it was all and is not, or is none and was not.
    fn is_all_or_none(self, before: Share) -> bool {
        before.given == before.of || self.given == 0
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
    pub fn shifts(self, before: AnswerDetail, same_pairs: bool) -> Vec<DetailShift> {
        let less = self.losses(before, same_pairs);
        let more = before.losses(self, same_pairs);
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

    /// Whether less is said than before: [`AnswerDetail::shifts`] tells of what.
    pub fn says_less_than(self, before: AnswerDetail, same_pairs: bool) -> bool {
        self.losses(before, same_pairs).iter().any(Option::is_some)
    }

    /// What is given for a smaller share than before, now and before; always as many, in the same order.
    ///
    /// Contacts: entrances for a smaller share of them, or no contacts are named any more. States: gaps or normals for a smaller share of those that
    /// say the same, and not only because some answers say another state now or fail; or no answer says a state any more. Of other pairs a share may be
    /// another by chance: there it is less where it was all and is not, or is none and was not.
    fn losses(self, before: AnswerDetail, same_pairs: bool) -> Vec<Option<[Share; 2]>> {
        let [now, was] = [self, before].map(AnswerDetail::of_contacts);
        let is_less = now.is_below(was) && (same_pairs || now.is_all_or_none(was));
        let mut losses = vec![((was.of > 0 && now.of == 0) || is_less).then_some([now, was])];
        let is_gone = self.states().answers == 0;
        for ((state, now), (_, was)) in self.by_state().into_iter().zip(before.by_state()) {
            for (now, was) in of_state(Some(state), now).into_iter().zip(of_state(Some(state), was)) {
                let is_unexplained = was.given.saturating_sub(now.given) > was.of.abs_diff(now.of);
                let is_certain = now.is_all_or_none(was) || (same_pairs && is_unexplained);
                let is_less = now.is_below(was) && is_certain;
                losses.push(((was.given > 0 && is_gone) || is_less).then_some([now, was]));
            }
        }
        losses
    }
}

/// Gaps and normals of the answers that blocks lie so.
fn of_state(state: Option<SeparationState>, detail: StateDetail) -> [Share; 2] {
    let share = |what, given| Share { what, given, of: detail.answers, is_of_contacts: false, state };
    [share("gaps", detail.gaps), share("normals", detail.normals)]
}

#[cfg(test)]
mod tests {
    use super::{AnswerDetail, StateDetail};

    fn state(answers: u64, gaps: u64, normals: u64) -> StateDetail {
        StateDetail { answers, gaps, normals }
    }

    /// A code that measures what touches or overlaps alone.
    fn measured() -> AnswerDetail {
        AnswerDetail { apart: state(360, 0, 0), overlapping: state(192, 192, 192), ..AnswerDetail::default() }
    }

    #[test]
    fn what_was_kept_before_states_were_counted_is_read() {
        let text = r#"{"contacts":9,"entrances":7,"gap_m":1}"#;
        let detail: AnswerDetail = serde_json::from_str(text).expect("JSON of an earlier version");
        assert_eq!(detail, AnswerDetail { contacts: 9, entrances: 7, gap_m: 1, ..AnswerDetail::default() });
        assert!(!measured().says_less_than(AnswerDetail::default(), true), "it says nothing of states");
    }

    #[test]
    fn sums_and_differences_have_the_states() {
        let (one, sum) = (measured(), measured().plus(measured()));
        assert_eq!((sum.overlapping, sum.states()), (state(384, 384, 384), state(1104, 384, 384)));
        assert_eq!(sum.since(one), one);
    }

    #[test]
    fn what_is_not_given_is_told_once() {
        let of = |detail: AnswerDetail| detail.incomplete_note().unwrap_or_default();
        assert_eq!(of(measured()), "gaps and normals given for 192 of 552 states");
        let no_gaps = AnswerDetail { apart: state(0, 0, 0), overlapping: state(1, 0, 1), ..measured() };
        assert_eq!(of(no_gaps), "gaps given for 0 of 1 state");
        let mixed = AnswerDetail { contacts: 4, entrances: 1, overlapping: state(2, 1, 0), ..AnswerDetail::default() };
        let told = "entrances and signs of gaps given for 1 of 4 contacts, gaps given for 1 of 2 states, normals given for 0 of 2 states";
        assert_eq!(of(mixed), told);
        assert_eq!(of(AnswerDetail { overlapping: state(2, 2, 2), ..AnswerDetail::default() }), "");
    }

    #[test]
    fn fewer_gaps_are_less_unless_other_states_explain_it() {
        let less = |now: AnswerDetail, was: AnswerDetail, same| now.says_less_than(was, same);
        let with = |overlapping| AnswerDetail { overlapping, ..measured() };
        for now in [state(192, 0, 192), state(192, 192, 0), state(192, 191, 192), state(192, 0, 0)] {
            assert!(less(with(now), measured(), true) && less(with(now), measured(), false), "{now:?}");
            assert!(!less(measured(), with(now), true), "{now:?}");
        }
        // What was called overlapping is apart now: a mended mistake.
        let mended = AnswerDetail { apart: state(363, 0, 0), ..with(state(189, 189, 189)) };
        assert!(!less(mended, measured(), true) && !less(measured(), mended, true));
        // Some gaps are there, as where a code measures nearby blocks alone.
        let near = |answers, gaps| AnswerDetail { apart: state(answers, gaps, 0), ..AnswerDetail::default() };
        assert!(less(near(360, 80), near(360, 100), true) && !less(near(360, 80), near(360, 100), false));
        assert!(!less(near(359, 99), near(360, 100), true) && less(near(360, 0), near(360, 100), false));
        // No state at all is less of what had gaps or normals.
        let contacts = AnswerDetail { contacts: 9, entrances: 9, ..AnswerDetail::default() };
        assert!(less(contacts, measured(), true) && !less(contacts, near(360, 0), true));
        assert!(less(measured(), contacts, true), "contacts are gone");
    }

    #[test]
    fn shares_that_are_alike_are_told_in_one() {
        let now = AnswerDetail { overlapping: state(192, 0, 0), ..measured() };
        let shifts = now.shifts(measured(), true);
        let [shift] = &shifts[..] else { panic!("{shifts:?}") };
        assert!(shift.less && !shift.is_of_contacts && shift.what == "gaps and normals", "{shift:?}");
        assert_eq!(shift.before, "192 of 192 states \"overlapping\"");
        assert_eq!(shift.after, "0 of 192 states \"overlapping\"");
        assert!(measured().shifts(now, true).iter().all(|shift| !shift.less));
        assert_eq!(measured().shifts(measured(), true), []);
    }
}
