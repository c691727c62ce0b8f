//! Engines whose answers come late, and others whose answers look as if they did.

use super::*;
use std::sync::Mutex;

/// Pairs of boxes by their gap (m): the same features in each, with other contacts or other signs.
const GAPS: [f64; 12] = [0.0, 1e-3, 2.0, -1e-3, 3.0, 0.0, 4.0, 2e-3, -2e-3, 5.0, 1e-3, 6.0];

/// What an engine says that may think of what it was asked before.
type Engine<'e> = &'e (dyn Fn(&[Block; 2], &ToleranceSet) -> Vec<Contact> + Sync);

/// The diagnosis of an engine from all [`GAPS`], asked in this order.
fn rows_of(engine: Engine<'_>) -> Vec<DiagnosisRow> {
    let asked = |gap: &f64| {
        let asked = question(*gap, said(*gap, |_| {}));
        Question { reply: Reply::Contacts(engine(&asked.blocks, &asked.tolerances)), ..asked }
    };
    let (agreeing, differing): (Vec<Question>, Vec<Question>) =
        GAPS.iter().map(asked).partition(|question| question.is_right() == Some(true));
    let sample = Sample { all_differing: differing.len() as u64, differing, agreeing };
    diagnose("mine", &sample, &|blocks, tolerances| Reply::Contacts(engine(blocks, tolerances)), &|_| None)
}

/// An engine that is late by so many answers, each changed by `wrong`.
fn late(by: usize, wrong: fn(&mut Contact)) -> impl Fn(&[Block; 2], &ToleranceSet) -> Vec<Contact> + Sync {
    let waiting: Mutex<Vec<Vec<Contact>>> = Mutex::new(vec![Vec::new(); by]);
    move |blocks: &[Block; 2], tolerances: &ToleranceSet| {
        let mut waiting = waiting.lock().expect("no panic");
        let mut contacts = exactly(blocks, tolerances);
        contacts.iter_mut().for_each(wrong);
        waiting.push(contacts);
        waiting.remove(0)
    }
}

fn is_told(rows: &[DiagnosisRow]) -> bool {
    rows.iter().any(|row| row.hypothesis == "one-answer-late")
}

#[test]
fn an_engine_that_is_one_answer_late_is_told_just_that() {
    let rows = rows_of(&late(1, |_| {}));
    let told: Vec<_> = rows.iter().map(|row| (row.verdict, row.hypothesis.as_str(), row.answers)).collect();
    assert_eq!(told, [(DiagnosisVerdict::Explains, "one-answer-late", rows[0].differing)], "{rows:#?}");
    assert!(rows[0].differing >= 8, "{rows:#?}");
    let words = rows[0].words().expect("words");
    assert!(words.contains("differing answers are exact for the question asked before: "), "{words}");
}

#[test]
fn other_engines_are_not_told_that_they_are_late() {
    assert_eq!(rows_of(&exactly), []);
    let wrong = |change: fn(&mut Contact)| {
        move |blocks: &[Block; 2], tolerances: &ToleranceSet| {
            let mut contacts = exactly(blocks, tolerances);
            contacts.iter_mut().for_each(change);
            contacts
        }
    };
    // Late by two, late and mistaken, constant, empty, turned: none of these is late by one and exact otherwise.
    let engines: [(&str, Engine<'_>); 6] = [
        ("two", &late(2, |_| {})),
        ("mistaken", &late(1, |contact| contact.gap = contact.gap.reversed())),
        ("positive", &wrong(|contact| contact.gap = Sign::Positive)),
        ("zero", &wrong(|contact| contact.gap = Sign::Zero)),
        ("turned", &wrong(|contact| contact.gap = contact.gap.reversed())),
        ("empty", &|_, _| Vec::new()),
    ];
    for (name, engine) in engines {
        let rows = rows_of(engine);
        assert!(!rows.is_empty() && !is_told(&rows), "{name}: {rows:#?}");
    }
}

#[test]
fn a_right_engine_is_asked_few_questions_for_it() {
    let asked = Mutex::new(0);
    let engine = |blocks: &[Block; 2], tolerances: &ToleranceSet| {
        *asked.lock().expect("no panic") += 1;
        let mut contacts = exactly(blocks, tolerances);
        contacts.iter_mut().for_each(|contact| contact.gap = contact.gap.reversed());
        contacts
    };
    let sample = |count: usize| {
        let gap = GAPS[count % 2 + 2];
        let asked = question(gap, said(gap, |_| {}));
        Question { reply: Reply::Contacts(engine(&asked.blocks, &asked.tolerances)), ..asked }
    };
    let (agreeing, differing): (Vec<Question>, Vec<Question>) =
        (0..100).map(sample).partition(|question| question.is_right() == Some(true));
    let before = *asked.lock().expect("no panic");
    let sample = Sample { all_differing: 50, differing, agreeing };
    let found = Lag::find(&sample, &|blocks, tolerances| Reply::Contacts(engine(blocks, tolerances)));
    let count = *asked.lock().expect("no panic") - before;
    assert!(found.is_none() && count <= 10, "{count}");
}
