//! Preparation, boxes, traces and errors of the stepper.

use crate::bent::{bent, short_reach, tips};
use crate::golden_contacts;
use crate::hand_worked::base;
use crate::pairs::{self, block, cuboid, n, spike, tetrahedron, tolerances};
use rockproof_model::decision::{Decision, Feature, Predicate, Side};
use rockproof_model::{Block, BlockOptions, EdgeId, FaceId, ToleranceSet, Vec3, VertexId};
use rockproof_stepper::contact::prepared_block::{CollapsedPart, FaceOfEdge};
use rockproof_stepper::contact::{SpecRules, ToleranceOverflow};
use rockproof_stepper::{
    Classifier, Collapsed, EngineError, PreparedBlock, Real, Stepper, Tolerances, Vector, Wide, classify,
    classify_traced,
};

fn measures<R: Real>() {
    let prepared = PreparedBlock::<R>::new(&cuboid([1.0, 2.0, 3.0], [3.0, 5.0, 7.0])).unwrap();
    let list = |v: Vector<R>| v.components().map(R::to_f64);
    let face = prepared.face(FaceId(3));
    assert_eq!((list(face.normal), list(face.point)), ([1.0, 0.0, 0.0], [3.0, 3.5, 5.0]));
    assert!((0..6).all(|f| prepared.turns_left(FaceId(f))));
    // Edge 0 runs 0-1 along x between the bottom (reached by +y) and the front (reached by +z).
    let edge = prepared.edge(EdgeId(0));
    assert_eq!((list(edge.direction), edge.length.to_f64()), ([1.0, 0.0, 0.0], 2.0));
    let [left, right] = FaceOfEdge::BOTH;
    let into = if edge.edge.left == FaceId(0) { [left, right] } else { [right, left] }
        .map(|face| prepared.into_face(EdgeId(0), face));
    assert_eq!(into.map(list), [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    let widths = prepared.widths(EdgeId(0)).map(R::to_f64);
    assert_eq!(widths.iter().sum::<f64>(), 7.0);
    // m_L + m_R = N × d: twice the areas 2·3 and 2·4 times the length 2.
    assert_eq!(list(prepared.lean(EdgeId(0))), [0.0, 24.0, 32.0]);
    assert_eq!(prepared.vertex(VertexId(6)).shortest.to_f64(), 2.0);
    let away: Vec<_> =
        prepared.edges_at(VertexId(6)).iter().map(|&e| list(prepared.edge_at_vertex(VertexId(6), e).away)).collect();
    assert_eq!(away, [[0.0, 0.0, -1.0], [0.0, -1.0, 0.0], [-1.0, 0.0, 0.0]]);
    assert_eq!((list(prepared.bounds().low), list(prepared.bounds().high)), ([1.0, 2.0, 3.0], [3.0, 5.0, 7.0]));
}

#[test]
fn a_cuboid_has_the_measures_of_a_cuboid() {
    measures::<f32>();
    measures::<f64>();
    measures::<Wide>();
}

/// Of a quadrilateral all corners are as far from the plane, of a pentagon they are not.
fn bulges<R: Real>() {
    // 2·2 − 2·2 + 32/8 = 4 over √(2² + 2² + 32²).
    let bulge = PreparedBlock::<R>::new(&bent()).unwrap().bulge().to_f64();
    assert!((bulge - 4.0 / 1032f64.sqrt()).abs() < 1e-6, "{bulge}");
    // Over a pentagon with its last corner half a metre low: N = (−3, 1, 40), c = (2, 2.8, −0.1), and N·(v − c) is 7.2, −4.8, −0.8,
    // 7.2 and −8.8.
    let outline = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 6.0], [0.0, 4.0]];
    let corner = |k: usize| {
        let z = [-4.0, 0.0][k / 5] - if k == 9 { 0.5 } else { 0.0 };
        Vec3::new(n(outline[k % 5][0]), n(outline[k % 5][1]), n(z))
    };
    let sides = (0..5).map(|k| vec![k, (k + 1) % 5, 5 + (k + 1) % 5, 5 + k]);
    let faces = [vec![4, 3, 2, 1, 0], vec![5, 6, 7, 8, 9]].into_iter().chain(sides).collect();
    let block = Block::new((0..10).map(corner).collect(), faces, &BlockOptions { planarity: n(0.25) }).unwrap();
    let bulge = PreparedBlock::<R>::new(&block).unwrap().bulge().to_f64();
    assert!((bulge - 8.8 / 1610f64.sqrt()).abs() < 1e-6, "{bulge}");
    let planar = PreparedBlock::<R>::new(&base()).unwrap().bulge();
    assert_eq!(planar.to_f64(), 0.0);
}

#[test]
fn the_bulge_is_the_greatest_distance_of_a_corner_from_its_face() {
    bulges::<f32>();
    bulges::<f64>();
    bulges::<Wide>();
}

/// Edges of bent faces are not in the planes of those.
fn directions_are_of_unit_length<R: Real>() {
    let prepared = PreparedBlock::<R>::new(&bent()).unwrap();
    for e in prepared.block().topology().edge_ids() {
        for side in FaceOfEdge::BOTH {
            let length = prepared.into_face(e, side).length().to_f64();
            assert!((length - 1.0).abs() < 1e-15, "edge {e}: {length}");
        }
    }
}

#[test]
fn directions_into_bent_faces_are_of_unit_length() {
    directions_are_of_unit_length::<f64>();
    directions_are_of_unit_length::<Wide>();
}

#[test]
fn an_end_of_a_long_edge_does_not_count_as_the_width_of_a_face() {
    // The far end (608, 784, 0) of edge 0-1 is on its line; but its direction rounds, which in f32 makes that 6e-5. Vertex 2 is 1e-5 from
    // it, across (0.6128, 0.7902, 0), and vertex 3 is 1 from it.
    let thin = tetrahedron([[0.0; 3], [608.0, 784.0, 0.0], [-7.902e-6, 6.128e-6, 0.0], [0.0, 0.0, 1.0]]);
    let prepared = PreparedBlock::<f32>::new(&thin).unwrap();
    let [one, two] = prepared.widths(EdgeId(0));
    let (narrow, wide) = (one.min(two), one.max(two));
    assert!((narrow / 1e-5 - 1.0).abs() < 0.01 && wide == 1.0, "{narrow:e} {wide:e}");
}

#[test]
fn far_and_small_features_collapse_with_a_name() {
    let what = |block: &Block| PreparedBlock::<f32>::new(block).unwrap_err().what;
    let thin = cuboid([1000.0, 0.0, 0.0], [1000.0 + 1e-6, 1.0, 1.0]);
    assert_eq!(what(&thin), CollapsedPart::Face(FaceId(0)));
    assert!(PreparedBlock::<f64>::new(&thin).is_ok());
    // The quadrilateral keeps an area when its short side collapses.
    let short = block(
        &[[1000.0, 0.0, 0.0], [1000.0 + 1e-6, 0.0, 0.0], [1001.0, 1.0, 0.0], [999.0, 1.0, 0.0], [1000.0, 0.5, 1.0]],
        &[&[0, 3, 2, 1], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]],
    );
    assert_eq!(what(&short), CollapsedPart::Face(FaceId(1)));
    let prism = block(
        &[
            [1000.0, 0.0, 0.0],
            [1000.0 + 1e-6, 0.0, 0.0],
            [1001.0, 1.0, 0.0],
            [999.0, 1.0, 0.0],
            [1000.0, 0.0, 1.0],
            [1000.0 + 1e-6, 0.0, 1.0],
            [1001.0, 1.0, 1.0],
            [999.0, 1.0, 1.0],
        ],
        &[&[0, 3, 2, 1], &[4, 5, 6, 7], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7], &[0, 1, 5, 4]],
    );
    assert_eq!(what(&prism), CollapsedPart::Face(FaceId(5)));
    assert_eq!(what(&cuboid([0.0; 3], [1e39, 1.0, 1.0])), CollapsedPart::Vertex(VertexId(1)));
    assert_eq!(what(&cuboid([0.0; 3], [1e30, 1e30, 1.0])), CollapsedPart::LargeFace(FaceId(0)));
    let collapsed = EngineError::Collapsed(Collapsed { what: CollapsedPart::Face(FaceId(0)) });
    assert_eq!(Stepper::<SpecRules>::new().f32(&thin, &base(), &tolerances()), Err(collapsed));
    assert_eq!(collapsed.to_string(), "face 0 has no area in the stepper's precision");
}

#[test]
fn a_tolerance_that_overflows_is_an_error() {
    let t = ToleranceSet { search: n(1e300), ..tolerances() };
    assert_eq!(Tolerances::<f32>::new(&t).unwrap_err(), ToleranceOverflow { name: "search" });
    assert!(Stepper::<SpecRules>::new().f32(&base(), &base(), &t).is_err());
    assert!(Tolerances::<f64>::new(&t).is_ok());
}

#[test]
fn numbers_at_the_end_of_the_range_do_not_panic() {
    // Squares overflow or vanish: errors or answers, but no panic.
    let stepper = Stepper::<SpecRules>::new();
    for size in [1e-300, 1e-160, 1e-30, 1e-15, 1e15, 1e30, 1e100, 1e150, 1e300] {
        let one = cuboid([0.0; 3], [size; 3]);
        let two = cuboid([0.5 * size, 0.5 * size, size], [1.5 * size; 3]);
        for t in [tolerances(), ToleranceSet { search: n(size), penetration: n(size), ..tolerances() }] {
            let _ = stepper.f32(&one, &two, &t);
            let _ = stepper.f64(&one, &two, &t);
            assert!(stepper.wide(&one, &two, &t).is_ok());
        }
    }
}

#[test]
fn a_trace_names_every_decision_and_changes_nothing() {
    let (a, b) = (spike([1.0, 1.0, 1.0625], 0.25, 0.5), base());
    let (a, b) = (PreparedBlock::<f64>::new(&a).unwrap(), PreparedBlock::<f64>::new(&b).unwrap());
    let t = Tolerances::new(&tolerances()).unwrap();
    let plain = classify::<f64, SpecRules>(&a, &b, &t);
    let (traced, decisions) = classify_traced::<f64, SpecRules>(&a, &b, &t);
    let contacts =
        |found: &[rockproof_stepper::ComputedContact<f64>]| found.iter().map(|f| f.contact).collect::<Vec<_>>();
    assert_eq!(contacts(&plain), contacts(&traced));
    assert_eq!(plain[0].gap, 0.0625);
    let (vertex, face) = (Feature::Vertex(Side::A, VertexId(0)), Feature::Face(Side::B, FaceId(1)));
    let asked = |predicate, features: &[Feature]| {
        let decision = Decision::about(predicate, features);
        decisions.iter().find(|(d, _)| *d == decision).map(|(_, outcome)| *outcome)
    };
    assert_eq!(decisions[0], (Decision::about(Predicate::Neighbours, &[]), 1));
    assert_eq!(asked(Predicate::VertexFaceNear, &[vertex, face]), Some(1));
    assert_eq!(asked(Predicate::InsideFace, &[vertex, face]), Some(1));
    assert_eq!(asked(Predicate::ConePasses, &[vertex, face, Feature::Edge(Side::A, EdgeId(0))]), Some(1));
    assert_eq!(asked(Predicate::GapSign, &[vertex, face]), Some(1));
    let bottom = Feature::Face(Side::B, FaceId(0));
    assert_eq!(asked(Predicate::VertexFaceDepth, &[vertex, bottom]), Some(0));
    assert_eq!(asked(Predicate::InsideFace, &[vertex, bottom]), None, "the depth has settled it");
    assert!(decisions.iter().all(|(_, outcome)| (-1..=1).contains(outcome)));
}

#[test]
fn all_predicates_are_traced_and_answered_both_ways() {
    let mut seen = std::collections::BTreeSet::new();
    for pair in golden_contacts::pairs() {
        let (a, b) = (PreparedBlock::<f64>::new(&pair.a).unwrap(), PreparedBlock::<f64>::new(&pair.b).unwrap());
        let t = Tolerances::new(&pair.tolerances).unwrap();
        let (_, decisions) = classify_traced::<f64, SpecRules>(&a, &b, &t);
        seen.extend(decisions.iter().map(|(decision, outcome)| (decision.predicate, *outcome)));
    }
    // Not neighbours; a v-v contact (classic) deeper than g; a vertex that overlaps two faces of a concave block.
    let leaning =
        pairs::tetrahedron([[3.953125, 0.5, 0.96875], [4.5, 0.5, 1.125], [4.125, 0.75, 1.5], [4.125, 0.25, 1.5]]);
    let unit = |low: f64| cuboid([low, low, low - 1.0], [low + 1.0, low + 1.0, low]);
    for (a, b, t) in [
        (unit(9.0), base(), tolerances()),
        (unit(1.9296875), base(), pairs::classic()),
        (leaning, pairs::corner_block(), tolerances()),
    ] {
        let (a, b) = (PreparedBlock::<f64>::new(&a).unwrap(), PreparedBlock::<f64>::new(&b).unwrap());
        let (_, decisions) = classify_traced::<f64, SpecRules>(&a, &b, &Tolerances::new(&t).unwrap());
        seen.extend(decisions.iter().map(|(decision, outcome)| (decision.predicate, *outcome)));
    }
    for predicate in Predicate::ALL {
        let missing: Vec<_> = [0, 1].into_iter().filter(|&outcome| !seen.contains(&(predicate, outcome))).collect();
        assert!(missing.is_empty(), "{predicate} is never {missing:?}");
    }
    assert!(seen.contains(&(Predicate::GapSign, -1)));
}

/// Whether culling by reach, here and without limit, leaves the same contacts.
fn culling_is_silent<R: Real>(a: &Block, b: &Block, t: &ToleranceSet) {
    let (a, b) = (PreparedBlock::<R>::new(a).unwrap(), PreparedBlock::<R>::new(b).unwrap());
    let culled = Tolerances::<R>::new(t).unwrap();
    let all = Tolerances { reach: R::from_f64(1e30), ..culled };
    let contacts = |t| classify::<R, SpecRules>(&a, &b, t).into_iter().map(|f| f.contact).collect::<Vec<_>>();
    assert_eq!(contacts(&culled), contacts(&all));
}

#[test]
fn culling_never_changes_an_answer() {
    for pair in golden_contacts::pairs() {
        culling_is_silent::<f32>(&pair.a, &pair.b, &pair.tolerances);
        culling_is_silent::<f64>(&pair.a, &pair.b, &pair.tolerances);
        culling_is_silent::<Wide>(&pair.a, &pair.b, &pair.tolerances);
    }
    // As far above a bent face as s, nearly so, and as deep.
    for height in [0.015625, 0.0078125, -0.0078125] {
        let (a, b, t) = (tips(height), bent(), short_reach());
        for [a, b] in [[&a, &b], [&b, &a]] {
            culling_is_silent::<f32>(a, b, &t);
            culling_is_silent::<f64>(a, b, &t);
            culling_is_silent::<Wide>(a, b, &t);
        }
    }
}
