//! The fast path against the plain one on random pairs near ties, contact for contact, gap for gap and decision by
//! decision, with contacts kept from the step before and with g below and above s.
//!
//! Kept contacts lie beyond every bound on depth that the fast path culls with: what they need is held here.

use crate::support::random::{blocks, kept_choice, tolerances};
use num_rational::BigRational;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::{TestCaseError, TestRunner};
use rockproof_model::decision::Predicate;
use rockproof_model::{Block, Contact, ContactKey, ContactKind, ToleranceSet};
use rockproof_oracle::{Pair, PreparedBlock, plain};
use std::collections::{BTreeMap, BTreeSet};

fn plainly(a: &Block, b: &Block, t: &ToleranceSet, kept: &[ContactKey]) -> Vec<(Contact, BigRational)> {
    plain::classify_with_kept(a, b, t, kept).into_iter().map(|f| (f.contact, f.gap_squared)).collect()
}

fn fast(a: &Block, b: &Block, t: &ToleranceSet, kept: &[ContactKey]) -> Vec<(Contact, BigRational)> {
    let (a, b) = (PreparedBlock::new(a), PreparedBlock::new(b));
    let pair = Pair::new(&a, &b);
    let contacts = pair.classify_with_kept(t, kept).contacts;
    contacts.into_iter().map(|contact| (contact, pair.gap(&contact.entrance).squared)).collect()
}

#[test]
fn contacts_are_those_of_the_plain_path() {
    compare_contacts(80);
}

#[test]
fn the_recording_path_finds_the_same_contacts() {
    compare_traces(80);
}

#[test]
#[ignore = "five seconds; .ci/run runs it"]
fn contacts_are_those_of_the_plain_path_at_full_size() {
    compare_contacts(256);
}

#[test]
#[ignore = "four seconds; .ci/run runs it"]
fn the_recording_path_finds_the_same_contacts_at_full_size() {
    compare_traces(256);
}

/// Holds a property of so many random pairs with their tolerances and kept contacts.
fn hold(cases: u32, property: impl Fn(&[Block; 2], &ToleranceSet, &[ContactKey]) -> Result<(), TestCaseError>) {
    let config = ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() };
    let outcome = TestRunner::new(config).run(&(blocks(), tolerances(), kept_choice()), |((a, b), t, choice)| {
        let kept = choice.of(&a, &b, &t);
        property(&[a, b], &t, &kept)
    });
    outcome.unwrap_or_else(|failure| panic!("{failure}"));
}

fn compare_contacts(cases: u32) {
    hold(cases, |[a, b], t, kept| {
        prop_assert_eq!(fast(a, b, t, kept), plainly(a, b, t, kept));
        prop_assert_eq!(fast(a, b, t, &[]), plainly(a, b, t, &[]));
        Ok(())
    });
}

fn compare_traces(cases: u32) {
    hold(cases, |[a, b], t, kept| {
        let plain: BTreeMap<_, _> = plain::trace_with_kept::<BigRational>(a, b, t, kept)
            .into_iter()
            .map(|(decision, outcome, tie)| (decision, (outcome, tie)))
            .collect();
        let (a, b) = (PreparedBlock::new(a), PreparedBlock::new(b));
        let trace = Pair::new(&a, &b).trace_with_kept(t, kept);
        for entry in &trace {
            if let Some(&(outcome, tie)) = plain.get(&entry.decision) {
                prop_assert_eq!(entry.outcome, outcome, "{}", entry.decision);
                prop_assert!(
                    entry.decision.predicate != Predicate::InsideFace || entry.tie == tie,
                    "{}",
                    entry.decision
                );
            }
        }
        // Both ask of the same planes whether they are true exits, and of the same contacts whether they may stay.
        let of_trace: BTreeSet<_> = trace.iter().map(|entry| entry.decision).collect();
        for predicate in [Predicate::TrueExit, Predicate::EntranceChoice, Predicate::EntranceDepth] {
            let fast: Vec<_> = of_trace.iter().filter(|d| d.predicate == predicate).collect();
            let plain: Vec<_> = plain.keys().filter(|d| d.predicate == predicate).collect();
            prop_assert_eq!(fast, plain);
        }
        Ok(())
    });
}

/// Kept contacts of each kind deeper than g occur, and true exits decide: the properties above are about something.
#[test]
fn the_random_pairs_reach_what_they_are_for() {
    let mut runner = TestRunner::deterministic();
    let mut deep = BTreeSet::new();
    let mut exits = BTreeSet::new();
    for _ in 0..600 {
        let ((a, b), t, choice) = (blocks(), tolerances(), kept_choice()).new_tree(&mut runner).unwrap().current();
        let g = t.penetration.to_rational();
        for (contact, squared) in fast(&a, &b, &t, &choice.of(&a, &b, &t)) {
            if contact.gap.is_negative() && squared > &g * &g {
                deep.insert(contact.kind());
            }
        }
        let (a, b) = (PreparedBlock::new(&a), PreparedBlock::new(&b));
        let trace = Pair::new(&a, &b).trace(&t);
        exits.extend(trace.iter().filter(|e| e.decision.predicate == Predicate::TrueExit).map(|e| e.outcome));
        if deep.len() == ContactKind::ALL.len() && exits.len() == 2 {
            break;
        }
    }
    for kind in ContactKind::ALL {
        assert!(deep.contains(&kind), "{kind}");
    }
    assert_eq!(exits, BTreeSet::from([0, 1]));
}
