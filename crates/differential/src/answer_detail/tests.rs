use super::{AnswerDetail, CountedPairs, StateDetail, Unsaid};

fn state(answers: u64, gaps: u64, normals: u64) -> StateDetail {
    StateDetail { answers, gaps, normals }
}

fn less(now: AnswerDetail, was: AnswerDetail, pairs: CountedPairs) -> bool {
    now.shifts(was, pairs).iter().any(|shift| shift.less)
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
    assert!(!less(measured(), AnswerDetail::default(), CountedPairs::Same), "it says nothing of states");
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
    use CountedPairs::{Other, Same};
    let with = |overlapping| AnswerDetail { overlapping, ..measured() };
    for now in [state(192, 0, 192), state(192, 192, 0), state(192, 191, 192), state(192, 0, 0)] {
        assert!(less(with(now), measured(), Same), "{now:?}");
        let is_none = now.gaps == 0 || now.normals == 0;
        assert_eq!(less(with(now), measured(), Other), is_none, "{now:?}");
        assert!(!less(measured(), with(now), Same), "{now:?}");
    }
    // What was called overlapping is apart now: a mended mistake.
    let mended = AnswerDetail { apart: state(363, 0, 0), ..with(state(189, 189, 189)) };
    assert!(!less(mended, measured(), Same) && !less(measured(), mended, Same));
    // Some gaps are there, as where a code measures nearby blocks alone.
    let near = |answers, gaps| AnswerDetail { apart: state(answers, gaps, 0), ..AnswerDetail::default() };
    assert!(less(near(360, 80), near(360, 100), Same) && !less(near(360, 80), near(360, 100), Other));
    assert!(!less(near(359, 99), near(360, 100), Same));
    // Of few other pairs there may be none by chance, the more so where the answers to a batch hang together.
    assert!(!less(near(360, 0), near(360, 100), Other) && less(near(900, 0), near(360, 100), Other));
    assert!(!less(near(660, 650), near(31, 31), Other), "by chance all");
    assert!(less(near(9, 0), near(360, 100), Same));
    // No state at all is less of what had gaps or normals.
    let contacts = AnswerDetail { contacts: 9, entrances: 9, contact_answers: 3, ..AnswerDetail::default() };
    assert!(less(contacts, measured(), Same) && !less(contacts, near(360, 0), Same));
    assert!(less(measured(), contacts, Same), "contacts are gone");
    assert!(!less(AnswerDetail::default(), contacts, Other), "few pairs may have none");
}

#[test]
fn contacts_named_anew_are_no_entrances_lost() {
    use CountedPairs::{Other, Same};
    let of = |entrances, contacts| AnswerDetail { contacts, entrances, ..AnswerDetail::default() };
    // Contacts that were missing are named, without entrances; contacts with one that were too many are gone.
    for now in [of(73, 300), of(90, 263), of(71, 261)] {
        assert!(!less(now, of(73, 263), Same), "{now:?}");
    }
    for now in [of(72, 263), of(72, 300), of(70, 262), of(0, 263), of(0, 300), of(0, 0)] {
        assert!(less(now, of(73, 263), Same), "{now:?}");
    }
    assert!(less(of(263, 264), of(263, 263), Same), "each had one");
    for (pairs, wanted) in [(Same, true), (Other, false)] {
        assert_eq!(less(of(0, 12), of(73, 263), pairs), wanted, "{pairs:?}");
    }
}

#[test]
fn states_in_place_of_contacts_are_less() {
    use CountedPairs::{Other, Same};
    let of = |contacts, contact_answers, apart| AnswerDetail {
        contacts,
        entrances: contacts,
        contact_answers,
        apart: state(apart, 0, 0),
        ..AnswerDetail::default()
    };
    assert!(less(of(437, 54, 46), of(618, 100, 0), Same) && !less(of(437, 54, 46), of(618, 100, 0), Other));
    assert!(less(of(600, 50, 50), of(618, 54, 46), Same) && !less(of(600, 50, 50), of(618, 54, 46), Other));
    // More contacts, in fewer answers.
    assert!(less(of(620, 50, 50), of(618, 54, 46), Same));
    // Fewer answers of any sort, as where some fail, are none that say less.
    assert!(!less(of(618, 50, 46), of(620, 54, 46), Same) && !less(of(618, 54, 46), of(620, 54, 46), Same));
    // Of other pairs only that there is none.
    assert!(less(of(0, 0, 300), of(618, 100, 0), Other) && !less(of(0, 0, 30), of(618, 30, 70), Other));
    // A version that did not count these tells nothing of them.
    assert!(!of(81, 0, 0).counts_answers() && of(81, 9, 0).counts_answers() && of(0, 0, 9).counts_answers());
    for pairs in [Same, Other] {
        assert_eq!(of(81, 20, 10).shifts(of(81, 0, 0), pairs), [], "{pairs:?}");
    }
    let shifts = of(62, 59, 5).shifts(of(60, 64, 0), Same);
    assert_eq!(shifts[0].what, "contacts");
    assert_eq!([&*shifts[0].before, &shifts[0].after], ["64 of 64 answers", "59 of 64 answers"]);
}

#[test]
fn gaps_of_blocks_that_touch_say_nothing() {
    let of = |touching, apart| AnswerDetail { touching, apart, ..AnswerDetail::default() };
    assert!(!of(state(9, 9, 9), state(0, 0, 0)).is_given_enough(Unsaid::Gaps));
    assert!(of(state(9, 9, 9), state(0, 0, 0)).is_given_enough(Unsaid::Normals));
    assert!(!of(state(9, 9, 0), state(9, 4, 0)).is_given_enough(Unsaid::Gaps));
    assert!(of(state(9, 0, 0), state(9, 5, 0)).is_given_enough(Unsaid::Gaps));
}

#[test]
fn a_limit_needs_half_of_what_may_be_given() {
    let enough = |detail: AnswerDetail| {
        [Unsaid::Entrances, Unsaid::Gaps, Unsaid::Normals].map(|what| detail.is_given_enough(what))
    };
    assert_eq!(enough(AnswerDetail { contacts: 9, entrances: 5, ..measured() }), [true, true, true]);
    assert_eq!(enough(AnswerDetail { contacts: 9, entrances: 4, ..AnswerDetail::default() }), [false; 3]);
    // Every tenth gap, those of blocks that touch, and that of the one pair that is apart.
    for detail in [
        AnswerDetail { overlapping: state(279, 29, 0), ..measured() },
        AnswerDetail { overlapping: state(279, 0, 0), touching: state(7, 7, 7), ..measured() },
        AnswerDetail { overlapping: state(400, 0, 0), apart: state(1, 1, 1), ..AnswerDetail::default() },
    ] {
        assert_eq!(enough(detail), [false; 3], "{detail:?}");
        assert!(detail.note_of(Unsaid::Gaps).is_some_and(|note| note.starts_with("gaps given for ")), "{detail:?}");
    }
    assert_eq!(enough(AnswerDetail { touching: state(9, 9, 0), ..AnswerDetail::default() }), [false; 3]);
    assert_eq!(measured().counts_of(Unsaid::Normals), [192, 552]);
    assert_eq!(AnswerDetail { overlapping: state(2, 2, 1), ..AnswerDetail::default() }.note_of(Unsaid::Gaps), None);
}

#[test]
fn shares_that_are_alike_are_told_in_one() {
    let now = AnswerDetail { overlapping: state(192, 0, 0), ..measured() };
    let shifts = now.shifts(measured(), CountedPairs::Same);
    let [shift] = &shifts[..] else { panic!("{shifts:?}") };
    assert!(shift.less && !shift.is_of_contacts && shift.what == "gaps and normals", "{shift:?}");
    assert_eq!(shift.before, "192 of 192 states \"overlapping\"");
    assert_eq!(shift.after, "0 of 192 states \"overlapping\"");
    assert!(measured().shifts(now, CountedPairs::Same).iter().all(|shift| !shift.less));
    assert_eq!(measured().shifts(measured(), CountedPairs::Same), []);
}
