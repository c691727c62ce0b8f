//! True exits: which entrance v-v and v-e contacts take, and which exit a pair of convex blocks, where planes pass the
//! no-overlap check by its tolerance only. Dyadic, as in `hand_worked`.

use crate::hand_worked::{base, check};
use crate::pairs::{behind_side, beside_edge, classic, n, tolerances};
use rockproof_model::decision::{Decision, Feature, Predicate, Side};
use rockproof_model::{Block, FaceId, ToleranceSet, VertexId};
use rockproof_stepper::contact::{ClassificationRequest, SpecRules};
use rockproof_stepper::{PreparedBlock, Tolerances, classify_traced};

#[test]
fn the_entrance_is_a_true_exit_where_there_is_one() {
    let t = tolerances();
    // r/10 = 1/640. Vertex 0 is 1/128 from the side and 1/256 from the top; vertex 1, at the other end of the edge, is over
    // the top.
    let dips = |dip: f64| beside_edge(0.0078125, 0.00390625, [-dip, 0.5, 0.0]);
    let at_1 = "v-e 1 10 v-f 1 1 +1";
    check("side dips by 3/256: false", &dips(0.01171875), &base(), &t, &["v-e 0 10 v-f 0 1 +1", at_1]);
    let sides = ["v-e 0 10 v-f 0 3 +1", "v-e 1 10 v-f 1 3 +1"];
    check("side dips by 1/1024: true, and larger", &dips(0.0009765625), &base(), &t, &sides);
    check("classic: whatever passes", &dips(0.01171875), &base(), &classic(), &["v-e 0 10 v-f 0 3 +1", at_1]);
    check("roles exchanged", &base(), &dips(0.01171875), &t, &["e-v 10 0 f-v 1 0 +1", "e-v 10 1 f-v 1 1 +1"]);
}

#[test]
fn a_dip_of_a_tenth_of_r_is_a_true_exit() {
    // 128, 4095 and 4097 as in `hand_worked`: the side dips by exactly 1/128 = r/10, at a sine of 0.031. Both ends are 1/128
    // above the top; vertex 0 is 1/64 beyond the side, vertex 1 is 1/128 beyond it: a tie, which the lower face wins.
    let block = beside_edge(0.015625, 0.0078125, [-0.0078125, 4095.0 / 16384.0, 0.0]);
    let with_r = |r: f64| ToleranceSet { territory: n(r), ..tolerances() };
    let at_1 = "v-e 1 10 v-f 1 1 +1";
    check("r/10, a tie", &block, &base(), &with_r(0.078125), &["v-e 0 10 v-f 0 3 +1", at_1]);
    check("hardly more", &block, &base(), &with_r(0.078125 - f64::powi(2.0, -20)), &["v-e 0 10 v-f 0 1 +1", at_1]);
}

#[test]
fn without_a_true_exit_all_candidates_count() {
    // The edge dips by 1/128 below the top and behind the side, and ends on the side.
    let both = beside_edge(0.0078125, 0.00390625, [-0.0078125, 0.5, -0.0078125]);
    check("none is true", &both, &base(), &tolerances(), &["v-e 0 10 v-f 0 3 +1", "v-e 1 10 v-f 1 3 +0"]);
}

#[test]
fn the_one_exit_is_true_where_there_is_one() {
    let top = ["v-f 0 1 v-f 0 1 -1", "e-e 0 11 e-e 0 11 -1"];
    check("the side is less deep, but false", &behind_side(), &base(), &tolerances(), &top);
    let exchanged = ["f-v 1 0 f-v 1 0 -1", "e-e 11 0 e-e 11 0 -1"];
    check("roles exchanged", &base(), &behind_side(), &tolerances(), &exchanged);
    // Vertex 0 is within s of edge 10, vertex 6 within s of the long edge.
    check("classic: whatever passes", &behind_side(), &base(), &classic(), &["v-e 0 10 v-f 0 3 -1"]);
    // With r = 15/32 the side is true, 3/64 being r/10, and vertex 0 is in the territory of edge 10, which is 1/4 wide.
    let wide = ToleranceSet { territory: n(0.46875), ..tolerances() };
    check("within r/10, in a territory of 1/4", &behind_side(), &base(), &wide, &["v-e 0 10 v-f 0 3 -1"]);
}

fn traced(a: &Block, b: &Block, t: &ToleranceSet) -> Vec<(Decision, i8)> {
    let (a, b) = (PreparedBlock::<f64>::new(a).unwrap(), PreparedBlock::<f64>::new(b).unwrap());
    classify_traced::<f64, SpecRules>(&a, &b, &Tolerances::new(t).unwrap()).1
}

fn true_exits(decisions: &[(Decision, i8)]) -> Vec<(String, i8)> {
    let exits = decisions.iter().filter(|(decision, _)| decision.predicate == Predicate::TrueExit);
    exits.map(|(decision, outcome)| (decision.to_string(), *outcome)).collect()
}

#[test]
fn true_exits_are_asked_where_they_choose() {
    let t = tolerances();
    let decisions = traced(&beside_edge(0.0078125, 0.00390625, [-0.01171875, 0.5, 0.0]), &base(), &t);
    let asked = |v: u32, face: u32, outcome: i8| {
        let decision = Decision::about(
            Predicate::TrueExit,
            &[Feature::Vertex(Side::A, VertexId(v)), Feature::Face(Side::B, FaceId(face))],
        );
        (decision.to_string(), outcome)
    };
    assert_eq!(true_exits(&decisions), [asked(0, 1, 1), asked(0, 3, 0), asked(1, 1, 1), asked(1, 3, 1)]);
    // Four contacts overlap, found by v-f and e-e; the one exit asks each of them once.
    let decisions = traced(&behind_side(), &base(), &t);
    let exits = true_exits(&decisions);
    assert_eq!(exits.iter().map(|(_, outcome)| *outcome).collect::<Vec<_>>(), [1, 0, 1, 1], "{exits:?}");
    // One candidate, nothing overlaps: nobody asks.
    let above = crate::pairs::spike([1.0, 1.0, 1.0625], 0.25, 0.5);
    assert!(true_exits(&traced(&above, &base(), &t)).is_empty());
    let prepared = [&behind_side(), &base()].map(|block| PreparedBlock::<f64>::new(block).unwrap());
    let request = ClassificationRequest {
        a: &prepared[0],
        b: &prepared[1],
        tolerances: &Tolerances::new(&t).unwrap(),
        kept: &[],
        among: None,
    };
    assert_eq!(request.traced::<SpecRules>().1, decisions);
}
