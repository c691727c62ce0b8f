//! What traces and margins say, on pairs small enough to know every sign by hand: which decisions are made, which of them are ties,
//! and which signs count for which decision.

use crate::support::shapes::{classic, cuboid, revised, slab, spike, tetrahedron};
use num_rational::BigRational;
use rockproof_model::decision::Feature::{Edge, Face, Vertex};
use rockproof_model::decision::{Decision, Feature, Predicate, Side};
use rockproof_model::{Block, Contact, ContactKey, EdgeId, Entrance, FaceId, Sign, ToleranceSet, VertexId};
use rockproof_oracle::{Pair, PreparedBlock, TraceEntry, plain};

const A: Side = Side::A;
const B: Side = Side::B;

fn vertex(side: Side, number: u32) -> Feature {
    Vertex(side, VertexId(number))
}

fn edge(side: Side, number: u32) -> Feature {
    Edge(side, EdgeId(number))
}

fn face(side: Side, number: u32) -> Feature {
    Face(side, FaceId(number))
}

fn contacts(a: &Block, b: &Block, tolerances: &ToleranceSet) -> Vec<Contact> {
    Pair::new(&PreparedBlock::new(a), &PreparedBlock::new(b)).classify(tolerances).contacts
}

/// The entries of the trace about this predicate.
fn traced(a: &Block, b: &Block, tolerances: &ToleranceSet, predicate: Predicate) -> Vec<TraceEntry> {
    let (a, b) = (PreparedBlock::new(a), PreparedBlock::new(b));
    let trace = Pair::new(&a, &b).trace(tolerances);
    trace.into_iter().filter(|entry| entry.decision.predicate == predicate).collect()
}

/// Its decisions with their outcomes in the fast path and in the plain one, sorted.
fn outcomes(a: &Block, b: &Block, tolerances: &ToleranceSet, predicate: Predicate) -> [Vec<(Decision, i8)>; 2] {
    let fast = traced(a, b, tolerances, predicate).into_iter().map(|entry| (entry.decision, entry.outcome)).collect();
    let plain = plain::trace::<BigRational>(a, b, tolerances)
        .into_iter()
        .filter(|(decision, ..)| decision.predicate == predicate)
        .map(|(decision, outcome, _)| (decision, outcome))
        .collect();
    [fast, plain].map(|mut decisions: Vec<_>| {
        decisions.sort_unstable();
        decisions
    })
}

/// The sign that the margin of a decision names, zero at a tie; `None` where it has no margin.
fn nearest_sign(a: &Block, b: &Block, tolerances: &ToleranceSet, decision: Decision) -> Option<Sign> {
    let (a, b) = (PreparedBlock::new(a), PreparedBlock::new(b));
    let [margin] = Pair::new(&a, &b).margins(tolerances, &[decision])[..] else {
        panic!("one margin for each decision")
    };
    margin.map(|margin| margin.sign)
}

/// SPEC section 4, "Choosing the entrance", chooses among candidates: with a single one there is nothing to prefer, and so no
/// true exit is asked for.
#[test]
fn a_single_candidate_is_not_asked_whether_it_is_a_true_exit() {
    // Vertex 0 is 3/16 straight above edge 10 (x = 4), in its territory: v-e. Its edges are (−1, 0, −1/8) and (1, ±2, 4). With so = 1
    // the lengths alone count. Face 1 (N = z): the first dips by 1/8. Face 3 (N = x): it dips by 1. The first × 10 has
    // n = (1/8, 0, −1) up to length and turn: either the slab's side, 4 wide, dips by nearly 4, or its top, 8 wide, by 8/√65 = 0.99. The
    // others × 10 have n = (4, 0, −1): the side dips by 4/√17 = 0.97, or the top by 32/√17. All is above the slab, so no gap is
    // negative, and one exit asks nothing either.
    let a = tetrahedron([["4", "0", "3/16"], ["3", "0", "1/16"], ["5", "-2", "67/16"], ["5", "2", "67/16"]]);
    let under = |g| revised(&[("search", "1/4"), ("territory", "1/4"), ("penetration", g), ("overlap_sine", "1")]);
    let about = |of: &[Feature]| Decision::about(Predicate::EntranceChoice, of);
    let chosen = about(&[vertex(A, 0), edge(B, 10), vertex(A, 0), face(B, 1)]);

    // g = 1/4: face 1 alone passes.
    let tolerances = under("1/4");
    let found: Vec<_> = contacts(&a, &slab(), &tolerances).iter().map(|c| (c.key, c.entrance, c.gap)).collect();
    let over = |key, tip| (key, Entrance::VertexFace(VertexId(tip), FaceId(1)), Sign::Positive);
    let expected = [
        over(ContactKey::VertexEdge(VertexId(0), EdgeId(10)), 0),
        over(ContactKey::VertexFace(VertexId(1), FaceId(1)), 1),
    ];
    assert_eq!(found, expected);
    for path in outcomes(&a, &slab(), &tolerances, Predicate::EntranceChoice) {
        assert_eq!(path, [(chosen, 1)]);
    }
    for path in outcomes(&a, &slab(), &tolerances, Predicate::TrueExit) {
        assert_eq!(path, []);
    }

    // g = 3/2: face 3 passes as well, and both dip by more than r/10.
    for path in outcomes(&a, &slab(), &under("3/2"), Predicate::TrueExit) {
        for of in [1, 3] {
            let asked = Decision::about(Predicate::TrueExit, &[vertex(A, 0), face(B, of)]);
            assert!(path.contains(&(asked, 0)), "face {of}: {path:?}");
        }
    }
}

/// The choice between planes that touch is settled by the signs of their gaps, each a decision of its own.
#[test]
fn a_choice_between_planes_that_touch_is_no_tie() {
    // The tip is on edge 10. Candidates, all with gap 0: face 1, and edges 1 and 2 of A, (−3, ±3, 4), × 10 with n = (4, 0, 3)/5. Face 3
    // fails for the edges towards −x; the edges towards x pass over the slab.
    let (a, b, tolerances) = (spike(["4", "0", "0"]), slab(), revised(&[]));
    let choice =
        |of: [Feature; 2]| Decision::about(Predicate::EntranceChoice, &[vertex(A, 0), edge(B, 10), of[0], of[1]]);
    let candidates = [[vertex(A, 0), face(B, 1)], [edge(A, 1), edge(B, 10)], [edge(A, 2), edge(B, 10)]];
    let chosen = |of: [Feature; 2]| i8::from(of == candidates[0]);
    let expected = candidates.map(|of| TraceEntry { decision: choice(of), outcome: chosen(of), tie: false });
    assert_eq!(traced(&a, &b, &tolerances, Predicate::EntranceChoice), expected);
    let gaps = traced(&a, &b, &tolerances, Predicate::GapSign);
    for of in candidates {
        assert_eq!(nearest_sign(&a, &b, &tolerances, choice(of)), None, "{of:?}: no sign is asked");
        let sign_of = Decision::about(Predicate::GapSign, &of);
        assert!(gaps.contains(&TraceEntry { decision: sign_of, outcome: 0, tie: true }), "{of:?}: {gaps:?}");
    }
}

/// Two contacts through one plane leave by the same way: there is nothing to compare.
#[test]
fn a_plane_beside_itself_is_no_tie() {
    // In 1/64 m the tip is 4 from the sides x = 4 and y = 4 and 3 below the top: 5 from edges 10 and 11, in their territories (r = 11/2), and
    // √41 from vertex 6, outside its own. Its edges (0, −3, 4), (−3, 0, 4), (−3, −3, 4) rise from face 1 and dip behind the sides. With
    // edge 10 the planes of the last two have n = (4, 0, 3)/5 and are 5 deep, so face 1, 3 deep, is the entrance; with 11 likewise.
    let a = tetrahedron([
        ["63/16", "63/16", "-3/64"],
        ["63/16", "15/16", "253/64"],
        ["15/16", "63/16", "253/64"],
        ["15/16", "15/16", "253/64"],
    ]);
    let tolerances = revised(&[("search", "11/128"), ("territory", "11/128"), ("penetration", "1/16")]);
    let at = |of| Contact {
        key: ContactKey::VertexEdge(VertexId(0), EdgeId(of)),
        entrance: Entrance::VertexFace(VertexId(0), FaceId(1)),
        gap: Sign::Negative,
    };
    assert_eq!(contacts(&a, &slab(), &tolerances), [at(10), at(11)]);
    let stays = [10, 11].map(|of| Decision::about(Predicate::OneExit, &[vertex(A, 0), edge(B, of)]));
    let expected = stays.map(|decision| TraceEntry { decision, outcome: 1, tie: false });
    assert_eq!(traced(&a, &slab(), &tolerances, Predicate::OneExit), expected);
    for decision in stays {
        // N·N
        assert_eq!(nearest_sign(&a, &slab(), &tolerances, decision), Some(Sign::Positive), "{decision}");
    }
}

#[test]
fn of_signs_equally_near_the_margin_has_the_first() {
    // The tip is on the line of edge 10, 1/16 beyond its end q: (v − p)·d > 0 and (q − v)·d < 0. From the tip, which is A's first vertex, all
    // coordinates but those along d are zero, so either is one product of a coordinate and d, and both are equally near.
    let beyond = Decision::about(Predicate::FootInside, &[vertex(A, 0), edge(B, 10)]);
    let (a, b) = (spike(["4", "65/16", "0"]), slab());
    assert_eq!(nearest_sign(&a, &b, &revised(&[]), beyond), Some(Sign::Positive));
    let expected = TraceEntry { decision: beyond, outcome: 0, tie: false };
    assert!(traced(&a, &b, &revised(&[]), Predicate::FootInside).contains(&expected));
}

/// The side to which the normal of two edges points belongs to no decision.
#[test]
fn a_tie_of_the_orientation_does_not_count_for_the_decision_before_it() {
    // A stands on B, 1/16 above it. A's edge 0 (along x) and B's edge 2 (along z) each border a face in y = 0: n = d₁ × d₂ is along −y,
    // that face's inward direction is across n, and the other one is along y, 128 m³ long at either edge. So σ is exactly a tie. Before it comes
    // sp²|d₁|²|d₂|² − |d₁ × d₂|² with sp = 0, which is −256 m⁴.
    let a = cuboid(["0", "0", "1/16"], ["4", "4", "65/16"]);
    let b = cuboid(["0", "0", "-4"], ["4", "4", "0"]);
    let before = Decision::about(Predicate::NearlyParallel, &[edge(A, 0), edge(B, 2)]);
    assert_eq!(nearest_sign(&a, &b, &revised(&[]), before), Some(Sign::Negative));
    // The faces do not pass one another along either side, so the two are asked for σ and are no candidate.
    let passes = Decision::about(Predicate::WedgesPass, &[edge(A, 0), edge(B, 2)]);
    for path in outcomes(&a, &b, &revised(&[]), Predicate::WedgesPass) {
        assert!(path.contains(&(passes, 0)), "{path:?}");
    }
}

/// The search for the largest gap belongs to no decision; each candidate is compared with the best once more when it is decided.
#[test]
fn a_tie_of_the_largest_gap_does_not_count_for_the_decision_before_it() {
    // Corner to corner, 1/32 apart along each axis: all twelve candidates have gap 1/32. The last one made is that of A's edge 2 (along z)
    // and B's edge 11 (along −x); its (d₁ × d₂)·(p_A − p_B) is −16·1/32 m³, and σ is −. Under classic no true exit is
    // asked for between this and the choice.
    let a = cuboid(["1/32"; 3], ["129/32"; 3]);
    let b = cuboid(["-4"; 3], ["0"; 3]);
    let last = [edge(A, 2), edge(B, 11)];
    let gap = Decision::about(Predicate::GapSign, &last);
    assert_eq!(nearest_sign(&a, &b, &classic(&[]), gap), Some(Sign::Negative));
    let choice = Decision::about(Predicate::EntranceChoice, &[vertex(A, 0), vertex(B, 6), last[0], last[1]]);
    assert_eq!(nearest_sign(&a, &b, &classic(&[]), choice), Some(Sign::Zero));
}
