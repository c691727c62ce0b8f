//! What must hold of any pair: the backends agree decision by decision, exchanging, moving and scaling the blocks changes
//! nothing but names and lengths, and blocks that rounding has made degenerate still have an answer.

use crate::support::random::{blocks, kept_choice, tolerances};
use crate::support::shapes::{
    classic, exact, flat_corner, flat_corner_upside_down, number, point, revised, slab, spike,
};
use num_rational::BigRational;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use rockproof_model::decision::{Decision, Feature, Predicate, Side};
use rockproof_model::{
    Block, ContactKey, ContactKind, Criteria, EdgeId, Entrance, EntranceKind, FaceId, Number, Precision, ToleranceSet,
    Vec3, VertexId,
};
use rockproof_oracle::plain::{self, ExactContact};

fn classified(a: &Block, b: &Block, t: &ToleranceSet) -> Vec<ExactContact<BigRational>> {
    plain::classify(a, b, t)
}

fn with_kept(a: &Block, b: &Block, t: &ToleranceSet, kept: &[ContactKey]) -> Vec<ExactContact<BigRational>> {
    plain::classify_with_kept(a, b, t, kept)
}

/// Whether a choice between planes or contacts hung on an exact tie, which the order of features then decides.
fn chose_by_order(a: &Block, b: &Block, t: &ToleranceSet, kept: &[ContactKey]) -> bool {
    const ORDERED: [Predicate; 3] = [Predicate::EntranceChoice, Predicate::ShortestExit, Predicate::OneExit];
    plain::trace_with_kept::<BigRational>(a, b, t, kept)
        .iter()
        .any(|(d, _, tie)| *tie && ORDERED.contains(&d.predicate))
}

fn scaled(block: &Block, factor: &Number) -> Block {
    block.with_vertices(block.vertices().iter().map(|v| v.map(|c| c.times(factor))).collect())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn exchanging_the_blocks_exchanges_the_contacts((a, b) in blocks(), t in tolerances(), choice in kept_choice()) {
        let kept = choice.of(&a, &b, &t);
        prop_assume!(!chose_by_order(&a, &b, &t, &kept));
        let mut expected: Vec<_> =
            with_kept(&a, &b, &t, &kept).into_iter().map(|f| (f.contact.swapped(), f.gap_squared)).collect();
        expected.sort_by_key(|(contact, _)| *contact);
        let kept: Vec<_> = kept.into_iter().map(ContactKey::swapped).collect();
        let found: Vec<_> = with_kept(&b, &a, &t, &kept).into_iter().map(|f| (f.contact, f.gap_squared)).collect();
        prop_assert_eq!(found, expected);
    }

    #[test]
    fn moving_and_scaling_change_lengths_only((a, b) in blocks(), t in tolerances(), choice in kept_choice()) {
        let kept = choice.of(&a, &b, &t);
        let expected = with_kept(&a, &b, &t, &kept);
        let offset = point(["1/3", "-12345/7", "1/1000000007"]);
        prop_assert_eq!(&with_kept(&a.translated(&offset), &b.translated(&offset), &t, &kept), &expected);
        let factor = number("7/3");
        let mut longer = t.clone();
        longer.search = t.search.times(&factor);
        longer.territory = t.territory.times(&factor);
        longer.penetration = t.penetration.times(&factor);
        let found = with_kept(&scaled(&a, &factor), &scaled(&b, &factor), &longer, &kept);
        let area = exact("49/9");
        let expected: Vec<_> =
            expected.into_iter().map(|f| ExactContact { gap_squared: f.gap_squared * &area, ..f }).collect();
        prop_assert_eq!(found, expected);
    }

    #[test]
    fn contacts_are_sorted_and_within_reach((a, b) in blocks(), t in tolerances(), choice in kept_choice()) {
        let kept = choice.of(&a, &b, &t);
        let found = with_kept(&a, &b, &t, &kept);
        prop_assert!(found.is_sorted_by(|f, g| f.contact < g.contact));
        let (s, g) = (t.search.to_rational(), t.penetration.to_rational());
        for f in found {
            let overlaps = f.contact.gap.is_negative();
            let reach = if overlaps { &g } else { &s };
            prop_assert!(f.gap_squared <= reach * reach || (overlaps && kept.contains(&f.contact.key)));
        }
    }

    #[test]
    fn rounded_blocks_have_an_answer((a, b) in blocks(), t in tolerances()) {
        let rounded = |block: &Block| block.translated(&point(["1/3", "1048576", "0"]))
            .rounded(Precision::F32).unwrap();
        let t = t.rounded(Precision::F32).unwrap();
        let found = classified(&rounded(&a), &rounded(&b), &t);
        prop_assert!(found.is_sorted_by(|f, g| f.contact < g.contact));
    }
}

#[cfg(feature = "gmp")]
use rockproof_oracle::rational::Rational;

#[cfg(feature = "gmp")]
proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_backends_agree_decision_by_decision((a, b) in blocks(), t in tolerances()) {
        prop_assert_eq!(plain::trace::<BigRational>(&a, &b, &t), plain::trace::<rug::Rational>(&a, &b, &t));
        let of_gmp: Vec<_> = plain::classify::<rug::Rational>(&a, &b, &t)
            .into_iter()
            .map(|f| ExactContact { contact: f.contact, gap_squared: f.gap_squared.to_big_rational() })
            .collect();
        prop_assert_eq!(classified(&a, &b, &t), of_gmp);
    }
}

/// Every kind of contact and entrance, both criteria: the properties above are about something.
#[test]
fn the_random_pairs_reach_every_kind() {
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let mut kinds = std::collections::BTreeSet::new();
    let mut entrances = std::collections::BTreeSet::new();
    for _ in 0..400 {
        let ((a, b), t) = (blocks(), tolerances()).new_tree(&mut runner).unwrap().current();
        for f in classified(&a, &b, &t) {
            kinds.insert((f.contact.kind(), t.criteria));
            entrances.insert(f.contact.entrance.kind());
        }
        if kinds.len() == 2 * ContactKind::ALL.len() && entrances.len() == 3 {
            break;
        }
    }
    for criteria in [Criteria::Classic, Criteria::Revised] {
        for kind in ContactKind::ALL {
            assert!(kinds.contains(&(kind, criteria)), "{kind} under {}", criteria.name());
        }
    }
    for kind in [EntranceKind::VertexFace, EntranceKind::FaceVertex, EntranceKind::EdgeEdge] {
        assert!(entrances.contains(&kind), "{kind}");
    }
}

/// Two flat corners, one upside down, whose tips are (1, −1, 1)/100 apart while their edges 1 (along x and along y) cross.
///
/// The tips are 0.0173 ≤ r = 1/50 from each other, so the edges' ends belong together. Neither tip is in the other edge's
/// territory: that is λ·1/25 = 1/100, and each is 0.0141 from the other's line. So only the territory of the ends keeps
/// these edges from being an e-e contact, whose feet lie inside both and whose wedges pass with h = 1/100.
#[test]
fn crossing_edges_yield_to_the_territory_of_their_ends() {
    let a = flat_corner_upside_down(["1/100", "-1/100", "1/100"]);
    let b = flat_corner();
    let edges = |contacts: &[ExactContact<BigRational>]| {
        contacts.iter().any(|f| f.contact.key == ContactKey::EdgeEdge(EdgeId(1), EdgeId(1)))
    };
    let set = |territory| revised(&[("territory", territory)]);
    let found = classified(&a, &b, &set("1/50"));
    assert_eq!(found[0].contact.key, ContactKey::VertexVertex(VertexId(0), VertexId(0)));
    assert!(!edges(&found));
    // With r a little under the distance of the tips the edges cross.
    assert!(edges(&classified(&a, &b, &set("17/1000"))));
    let trace = plain::trace::<BigRational>(&a, &b, &set("17/1000"));
    let outcome = |predicate, features: &[Feature]| {
        let asked = Decision::about(predicate, features);
        trace.iter().find(|(decision, ..)| *decision == asked).map(|(_, outcome, _)| *outcome)
    };
    let (edge_a, edge_b) = (Feature::Edge(Side::A, EdgeId(1)), Feature::Edge(Side::B, EdgeId(1)));
    assert_eq!(outcome(Predicate::FeetInside, &[edge_a, edge_b]), Some(1));
    assert_eq!(outcome(Predicate::EdgeTerritory, &[Feature::Vertex(Side::A, VertexId(0)), edge_b]), Some(0));
    assert_eq!(outcome(Predicate::EdgeTerritory, &[Feature::Vertex(Side::B, VertexId(0)), edge_a]), Some(0));
}

/// The slab with its top drawn together into the point (0, 0, 0): face 1 has no area, its edges no length.
///
/// The tip is 1/100 straight above. Nothing projects strictly inside face 1 and no foot lies strictly inside its edges, so
/// there is neither v-f nor v-e. Each of the four vertices there is within s, outside its territory (its shortest edge, and
/// so r_b, is 0), and in its region. Its entrance is a side face, all of which have slope 1: h² = 1/2·(1/100)², more than
/// the 0 of face 1, whose cone passes, and than any pair of edges; of its two side faces the lower. Edges of no length are
/// nearly parallel to all others.
#[test]
fn collapsed_face_has_gap_zero_and_no_inside() {
    let flat = slab();
    let apex = || Vec3::new(Number::ZERO, Number::ZERO, Number::ZERO);
    let vertices = flat.vertices().iter().enumerate().map(|(v, at)| if v < 4 { at.clone() } else { apex() }).collect();
    let collapsed = flat.with_vertices(vertices);
    let tip = spike(["0", "0", "1/100"]);
    let found = classified(&tip, &collapsed, &revised(&[]));
    let rows: Vec<_> = found
        .iter()
        .map(|f| match f.contact.entrance {
            Entrance::VertexFace(_, face) => (f.contact.key, face),
            other => panic!("{} by {other}", f.contact.key),
        })
        .collect();
    let expected = [(4, 2), (5, 2), (6, 3), (7, 4)]
        .map(|(vertex, face)| (ContactKey::VertexVertex(VertexId(0), VertexId(vertex)), FaceId(face)));
    assert_eq!(rows, expected);
    assert!(found.iter().all(|f| f.gap_squared == exact("1/20000")));

    let trace = plain::trace::<BigRational>(&tip, &collapsed, &revised(&[]));
    let of_the_tip = [Some(Feature::Vertex(Side::A, VertexId(0))), Some(Feature::Face(Side::B, FaceId(1)))];
    let inside: Vec<_> = trace
        .iter()
        .filter(|(d, ..)| d.predicate == Predicate::InsideFace && d.features()[..2] == of_the_tip)
        .map(|(_, outcome, tie)| (*outcome, *tie))
        .collect();
    assert_eq!(inside, [(0, true)]);
    for t in [classic(&[]), revised(&[("search", "0"), ("territory", "0"), ("penetration", "0")])] {
        assert_eq!(classified(&collapsed, &tip, &t).len(), classified(&tip, &collapsed, &t).len());
    }
}
