//! The plain path against the hand-worked cases, on each backend, and its trace: every predicate must have been seen to
//! say no, to say yes and to tie, or the cases test less than they claim.

use crate::support::hand_worked::{Case, cases};
use num_rational::BigRational;
use rockproof_model::decision::{Decision, Feature, Predicate, Side};
use rockproof_model::{Contact, ContactKey, EdgeId, FaceId, Sign, VertexId};
use rockproof_oracle::plain;
use rockproof_oracle::rational::Rational;
use std::collections::{BTreeMap, BTreeSet};

fn found<Q: Rational>(case: &Case) -> Vec<(Contact, BigRational)> {
    plain::classify_with_kept::<Q>(&case.a, &case.b, &case.tolerances, &case.kept)
        .iter()
        .map(|f| (f.contact, f.gap_squared.to_big_rational()))
        .collect()
}

fn reproduces_every_case<Q: Rational>() {
    let wrong: Vec<String> = cases()
        .iter()
        .map(|case| (case, found::<Q>(case), case.contacts()))
        .filter(|(_, found, expected)| found != expected)
        .map(|(case, found, expected)| {
            format!("{}: {}\n  found    {found:?}\n  expected {expected:?}", case.name, case.derivation)
        })
        .collect();
    assert!(wrong.is_empty(), "{} cases differ:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn the_default_backend_reproduces_every_case() {
    reproduces_every_case::<BigRational>();
}

#[cfg(feature = "gmp")]
#[test]
fn the_gmp_backend_reproduces_every_case() {
    reproduces_every_case::<rug::Rational>();
}

#[test]
fn there_are_enough_cases_under_their_own_names() {
    let names: BTreeSet<_> = cases().iter().map(|case| case.name).collect();
    assert_eq!(names.len(), cases().len());
    assert!(names.len() >= 120, "{}", names.len());
}

#[test]
fn gaps_are_rounded_with_their_sign() {
    let gap = |name: &str| {
        let case = cases().into_iter().find(|case| case.name == name).unwrap();
        plain::classify::<BigRational>(&case.a, &case.b, &case.tolerances)[0].gap_m()
    };
    assert_eq!(gap("vf_apart"), Some(0.05));
    assert_eq!(gap("vf_touching"), Some(0.0));
    assert_eq!(gap("ve_overlapping"), Some(-0.006));
}

/// Exchanging the blocks exchanges the contacts. Where a choice between planes or contacts hangs on an exact tie (or on a
/// tie by Eq. (1), which ε = 0 rules out) the order of the features decides, and that may change.
#[test]
fn swapping_swaps_the_contacts() {
    const ORDERED: [Predicate; 3] = [Predicate::EntranceChoice, Predicate::ShortestExit, Predicate::OneExit];
    let mut compared = 0;
    for case in cases().iter().filter(|case| case.tolerances.equal.is_zero()) {
        let trace = plain::trace_with_kept::<BigRational>(&case.a, &case.b, &case.tolerances, &case.kept);
        if trace.iter().any(|(decision, _, tie)| *tie && ORDERED.contains(&decision.predicate)) {
            continue;
        }
        let mut expected = case.contacts();
        expected.iter_mut().for_each(|(contact, _)| *contact = contact.swapped());
        expected.sort_by_key(|(contact, _)| *contact);
        let kept: Vec<_> = case.kept.iter().copied().map(ContactKey::swapped).collect();
        let exchanged: Vec<_> = plain::classify_with_kept::<BigRational>(&case.b, &case.a, &case.tolerances, &kept)
            .into_iter()
            .map(|f| (f.contact, f.gap_squared))
            .collect();
        assert_eq!(exchanged, expected, "{}", case.name);
        compared += 1;
    }
    assert!(compared >= 40, "{compared}");
}

/// The trace tells every contact's gap sign, and each decision once.
#[test]
fn the_trace_agrees_with_the_contacts() {
    for case in cases() {
        let trace = plain::trace_with_kept::<BigRational>(&case.a, &case.b, &case.tolerances, &case.kept);
        let decisions: BTreeMap<_, _> =
            trace.iter().map(|(decision, outcome, tie)| (*decision, (*outcome, *tie))).collect();
        assert_eq!(decisions.len(), trace.len(), "{}", case.name);
        for (contact, _) in case.contacts() {
            let gap_sign = Decision::about(Predicate::GapSign, &contact.entrance.features());
            // The one case in which the side to which n points is a tie, and with it the sign.
            let tie = contact.gap == Sign::Zero || case.name == "wedges_on_no_side";
            let expected = (contact.gap.as_i8(), tie);
            assert_eq!(decisions.get(&gap_sign), Some(&expected), "{}: {gap_sign}", case.name);
        }
    }
}

#[test]
fn every_predicate_is_seen_to_say_no_to_say_yes_and_to_tie() {
    let mut seen: BTreeMap<Predicate, BTreeSet<&str>> = BTreeMap::new();
    for case in cases() {
        for (decision, outcome, tie) in
            plain::trace_with_kept::<BigRational>(&case.a, &case.b, &case.tolerances, &case.kept)
        {
            let what = match (tie, outcome) {
                (true, _) => "tie",
                (false, 1) => "yes",
                (false, _) => "no",
            };
            seen.entry(decision.predicate).or_default().insert(what);
        }
    }
    for predicate in Predicate::ALL {
        let seen = seen.get(&predicate).cloned().unwrap_or_default();
        assert_eq!(seen.into_iter().collect::<Vec<_>>(), ["no", "tie", "yes"], "{predicate}");
    }
}

/// A decision that rests on a choice or a side that an exact tie made is a tie itself, though its own comparison is none.
#[test]
fn what_rests_on_a_tie_is_a_tie() {
    use Feature::{Edge, Face, Vertex};
    let (tip, corner) = (Vertex(Side::A, VertexId(0)), Vertex(Side::B, VertexId(6)));
    for (name, predicate, features, why) in [
        (
            "exit_perpendicular",
            Predicate::OneExit,
            vec![Vertex(Side::A, VertexId(3)), Face(Side::B, FaceId(1))],
            "the gap of v-f (0, 1), first in order, is the same",
        ),
        (
            "wedges_on_no_side",
            Predicate::EdgeEdgeNear,
            vec![Edge(Side::A, EdgeId(0)), Edge(Side::B, EdgeId(0))],
            "σ, and with it whether the edges are apart, is a tie",
        ),
        (
            "exactly_equal",
            Predicate::EntranceChoice,
            vec![tip, corner, Face(Side::A, FaceId(2)), corner],
            "the largest, first of those like it, which v-f (0, 1) equals by Eq. (1)",
        ),
    ] {
        let case = cases().into_iter().find(|case| case.name == name).unwrap();
        let asked = Decision::about(predicate, &features);
        let trace = plain::trace_with_kept::<BigRational>(&case.a, &case.b, &case.tolerances, &case.kept);
        let tie = trace.iter().find(|(decision, ..)| *decision == asked).map(|(_, _, tie)| *tie);
        assert_eq!(tie, Some(true), "{name}: {why}");
    }
}
