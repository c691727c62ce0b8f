//! The fast path against the hand-worked pairs: ties at every tolerance, both criteria, concave blocks; and decision by
//! decision against the plain path.

mod support;

use num_rational::BigRational;
use rockproof_oracle::{Pair, PreparedBlock, plain};
use std::collections::BTreeMap;
use support::handworked;

#[test]
fn every_hand_worked_pair_comes_out() {
    let cases = handworked::cases();
    assert!(cases.len() >= 120);
    let mut wrong = Vec::new();
    for case in &cases {
        let (a, b) = (PreparedBlock::new(&case.a), PreparedBlock::new(&case.b));
        let pair = Pair::new(&a, &b);
        let found: Vec<_> = pair
            .classify_keeping(&case.tolerances, &case.kept)
            .contacts
            .into_iter()
            .map(|contact| (contact, pair.gap(&contact.entrance).squared))
            .collect();
        if found != case.contacts() {
            wrong.push(format!("{}\n  {}\n  found {found:?}", case.name, case.derivation));
        }
    }
    assert!(wrong.is_empty(), "{} cases differ:\n{}", wrong.len(), wrong.join("\n"));
}

#[test]
fn decisions_agree_with_the_plain_path() {
    let mut compared = 0;
    for case in handworked::cases() {
        let (a, b) = (PreparedBlock::new(&case.a), PreparedBlock::new(&case.b));
        let plain: BTreeMap<_, _> = plain::trace_keeping::<BigRational>(&case.a, &case.b, &case.tolerances, &case.kept)
            .into_iter()
            .map(|(decision, outcome, _)| (decision, outcome))
            .collect();
        for entry in Pair::new(&a, &b).trace_keeping(&case.tolerances, &case.kept) {
            if let Some(&outcome) = plain.get(&entry.decision) {
                assert_eq!(entry.outcome, outcome, "{}: {}", case.name, entry.decision);
                compared += 1;
            }
        }
    }
    assert!(compared > 1_000, "{compared} decisions compared");
}

#[test]
fn margins_are_zero_exactly_at_ties() {
    let (mut ties, mut others) = (0, 0);
    for case in handworked::cases() {
        let (a, b) = (PreparedBlock::new(&case.a), PreparedBlock::new(&case.b));
        let pair = Pair::new(&a, &b);
        let trace = pair.trace_keeping(&case.tolerances, &case.kept);
        let decisions: Vec<_> = trace.iter().map(|entry| entry.decision).collect();
        for (entry, margin) in trace.iter().zip(pair.margins_keeping(&case.tolerances, &case.kept, &decisions)) {
            let Some(margin) = margin else { continue };
            assert!((0.0..=1.0).contains(&margin.relative), "{}: {}", case.name, entry.decision);
            if entry.tie {
                assert_eq!(margin.relative, 0.0, "{}: {}", case.name, entry.decision);
                ties += 1;
            } else if margin.relative > 0.0 {
                others += 1;
            }
        }
    }
    assert!(ties > 100 && others > 500, "{ties} ties, {others} others");
}
