//! The fast path against the hand-worked pairs: ties at every tolerance, both criteria, concave blocks; and decision by
//! decision against the plain path.

use crate::support::hand_worked;
use crate::support::shapes::{Prism, WEDGE, revised, slab, spike};
use num_rational::BigRational;
use rockproof_model::decision::{Decision, Feature, Predicate, Side};
use rockproof_model::{Block, EdgeId, ToleranceSet, VertexId};
use rockproof_oracle::{Pair, PreparedBlock, plain};
use std::collections::BTreeMap;

#[test]
fn every_hand_worked_pair_comes_out() {
    let cases = hand_worked::cases();
    assert!(cases.len() >= 120);
    let mut wrong = Vec::new();
    for case in &cases {
        let (a, b) = (PreparedBlock::new(&case.a), PreparedBlock::new(&case.b));
        let pair = Pair::new(&a, &b);
        let found: Vec<_> = pair
            .classify_with_kept(&case.tolerances, &case.kept)
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
    let (mut compared, mut inside) = (0, [0; 2]);
    for case in hand_worked::cases() {
        let (a, b) = (PreparedBlock::new(&case.a), PreparedBlock::new(&case.b));
        let plain: BTreeMap<_, _> =
            plain::trace_with_kept::<BigRational>(&case.a, &case.b, &case.tolerances, &case.kept)
                .into_iter()
                .map(|(decision, outcome, tie)| (decision, (outcome, tie)))
                .collect();
        for entry in Pair::new(&a, &b).trace_with_kept(&case.tolerances, &case.kept) {
            if let Some(&(outcome, tie)) = plain.get(&entry.decision) {
                assert_eq!(entry.outcome, outcome, "{}: {}", case.name, entry.decision);
                // Both call it a tie where the projection is on the boundary, and nowhere else.
                if entry.decision.predicate == Predicate::InsideFace {
                    assert_eq!(entry.tie, tie, "{}: {}", case.name, entry.decision);
                    inside[usize::from(tie)] += 1;
                }
                compared += 1;
            }
        }
    }
    assert!(compared > 1_000, "{compared} decisions compared");
    assert!(inside.iter().all(|&count| count > 20), "{inside:?} inside faces, without ties and with them");
}

#[test]
fn margins_are_zero_exactly_at_ties() {
    let (mut ties, mut others) = (0, 0);
    for case in hand_worked::cases() {
        let (a, b) = (PreparedBlock::new(&case.a), PreparedBlock::new(&case.b));
        let pair = Pair::new(&a, &b);
        let trace = pair.trace_with_kept(&case.tolerances, &case.kept);
        let decisions: Vec<_> = trace.iter().map(|entry| entry.decision).collect();
        for (entry, margin) in trace.iter().zip(pair.margins_with_kept(&case.tolerances, &case.kept, &decisions)) {
            let Some(margin) = margin else { continue };
            assert!((0.0..=1.0).contains(&margin.relative), "{}: {}", case.name, entry.decision);
            if entry.decision.predicate == Predicate::InsideFace {
                let (zero, inside) = (margin.relative == 0.0, margin.sign.is_positive());
                assert_eq!((zero, inside), (entry.tie, entry.outcome == 1), "{}: {}", case.name, entry.decision);
            }
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

/// The outcome of a decision, and whether it is a tie.
fn decided(a: &Block, b: &Block, tolerances: &ToleranceSet, decision: Decision) -> (i8, bool) {
    let (a, b) = (PreparedBlock::new(a), PreparedBlock::new(b));
    let trace = Pair::new(&a, &b).trace(tolerances);
    let entry = trace.iter().find(|entry| entry.decision == decision).expect("it is asked");
    (entry.outcome, entry.tie)
}

/// The distance of a corner from the line of its own edge is exactly zero; a face's width is that of its other corners.
#[test]
fn ends_of_an_edge_make_no_tie_of_the_width_of_its_faces() {
    // A ridge whose face to p falls by 3 in 5, over a ridge across: with g = 0 its corner at p is too deep, without a tie.
    let falling = Prism { p: ["1/15", "-1/20"], q: ["0", "5"], offset: ["0", "0", "7/100"], ..WEDGE };
    let edges = [Feature::Edge(Side::A, EdgeId(0)), Feature::Edge(Side::B, EdgeId(0))];
    let tolerances = revised(&[("overlap_sine", "7/10"), ("penetration", "0")]);
    let asked = Decision::about(Predicate::WedgesPass, &edges);
    assert_eq!(decided(&falling.along_x(), &WEDGE.upside_down_along_y(), &tolerances, asked), (0, false));
    // A tip on the middle of edge 8: at distance 0 of λ·4.
    let tip = [Feature::Vertex(Side::A, VertexId(0)), Feature::Edge(Side::B, EdgeId(8))];
    let asked = Decision::about(Predicate::EdgeTerritory, &tip);
    assert_eq!(decided(&spike(["0", "-4", "0"]), &slab(), &revised(&[]), asked), (1, false));
}
