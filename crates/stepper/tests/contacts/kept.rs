//! Kept contacts: depth alone does not end them, and everything else does. Dyadic, as in `hand_worked`.

use crate::golden_contacts;
use crate::hand_worked::{base, check, check_with_kept};
use crate::pairs::{cone, cuboid, keel, n, ridge, spike, tolerances};
use rockproof_model::decision::Predicate;
use rockproof_model::{Block, ContactKey, ContactKind, ToleranceSet};
use rockproof_stepper::contact::{ClassificationRequest, SpecRules};
use rockproof_stepper::{PreparedBlock, Real, Tolerances, Wide};

fn key(kind: ContactKind, a: u32, b: u32) -> ContactKey {
    ContactKey::of_kind(kind, [a, b])
}

#[test]
fn a_kept_contact_may_be_deeper_than_g() {
    use ContactKind::*;
    let t = tolerances();
    let deep = spike([1.0, 1.0, 0.9296875], 0.25, 0.5);
    let found = ["v-f 0 1 v-f 0 1 -1"];
    check_with_kept("v-f", [&deep, &base()], &t, &[key(VertexFace, 0, 1)], &found);
    check_with_kept("f-v", [&base(), &deep], &t, &[key(FaceVertex, 1, 0)], &["f-v 1 0 f-v 1 0 -1"]);
    let several = [key(EdgeEdge, 0, 1), key(VertexFace, 0, 1), key(VertexVertex, 3, 6)];
    check_with_kept("one of several", [&deep, &base()], &t, &several, &found);
    let others = [key(FaceVertex, 0, 1), key(VertexFace, 0, 0), key(VertexFace, 1, 1)];
    check_with_kept("others are kept", [&deep, &base()], &t, &others, &[]);
    let crossing = keel(0.921875, 0.5);
    check("e-e, nothing kept", &crossing, &ridge(1.0), &t, &[]);
    check_with_kept("e-e", [&crossing, &ridge(1.0)], &t, &[key(EdgeEdge, 0, 0)], &["e-e 0 0 e-e 0 0 -1"]);
    let at_g = spike([1.0, 1.0, 0.9375], 0.25, 0.5);
    check_with_kept("g deep, a tie: kept or not", [&at_g, &base()], &t, &[], &found);
    check_with_kept("g deep, a tie: kept or not", [&at_g, &base()], &t, &[key(VertexFace, 0, 1)], &found);
}

#[test]
fn a_kept_contact_may_have_a_deep_entrance() {
    use ContactKind::*;
    // g = 1/256; the vertex is 1/128 deep, within the territory of a corner, of an edge.
    let t = ToleranceSet { penetration: n(0.00390625), ..tolerances() };
    let corner = cuboid([1.9921875, 1.9921875, 0.9921875], [3.0; 3]);
    check("v-v, nothing kept", &corner, &base(), &t, &[]);
    check_with_kept("v-v", [&corner, &base()], &t, &[key(VertexVertex, 0, 6)], &["v-v 0 6 v-f 0 1 -1"]);
    check_with_kept("v-v, others", [&corner, &base()], &t, &[key(VertexEdge, 0, 6), key(VertexVertex, 6, 0)], &[]);
    let over_edge = spike([1.0, 1.9921875, 0.9921875], 0.25, 0.5);
    check("v-e, nothing kept", &over_edge, &base(), &t, &[]);
    check_with_kept("v-e", [&over_edge, &base()], &t, &[key(VertexEdge, 0, 11)], &["v-e 0 11 v-f 0 1 -1"]);
    check_with_kept("e-v", [&base(), &over_edge], &t, &[key(EdgeVertex, 11, 0)], &["e-v 11 0 f-v 1 0 -1"]);
}

#[test]
fn no_box_hides_a_kept_contact() {
    use ContactKind::*;
    let t = tolerances();
    // The vertex has left the slab on the other side, 0.2 below it; s and g are at most 1/8.
    let slab = cuboid([0.0; 3], [2.0, 2.0, 0.03125]);
    let through = spike([1.0, 1.0, -0.203125], 0.25, 0.5);
    check("v-f, nothing kept", &through, &slab, &t, &[]);
    check_with_kept("v-f", [&through, &slab], &t, &[key(VertexFace, 0, 1)], &["v-f 0 1 v-f 0 1 -1"]);
    check_with_kept("f-v", [&slab, &through], &t, &[key(FaceVertex, 1, 0)], &["f-v 1 0 f-v 1 0 -1"]);
    // The edges have crossed and are 1/4 apart.
    let crossed = keel(0.75, 0.5);
    check("e-e, nothing kept", &crossed, &ridge(1.0), &t, &[]);
    check_with_kept("e-e", [&crossed, &ridge(1.0)], &t, &[key(EdgeEdge, 0, 0)], &["e-e 0 0 e-e 0 0 -1"]);
}

#[test]
fn all_other_conditions_count() {
    use ContactKind::*;
    let t = tolerances();
    let kept = [key(VertexFace, 0, 1)];
    let beyond = spike([2.0, 1.0, 0.8125], 0.25, 0.5);
    check_with_kept("on the rim", [&beyond, &base()], &t, &kept, &[]);
    let apart = spike([1.0, 1.0, 1.1328125], 0.25, 0.5);
    check_with_kept("more than s", [&apart, &base()], &t, &kept, &[]);
    let far = spike([9.0, 1.0, 0.875], 0.25, 0.5);
    check_with_kept("not neighbours", [&far, &base()], &t, &kept, &[]);
    let fallen = cone([1.0, 1.0, 0.875], [[0.5, 0.0, 0.5], [-0.25, 0.5, 0.5], [-0.25, -0.5, -0.25]]);
    check_with_kept("its cone does not pass", [&fallen, &base()], &t, &kept, &[]);
    // 1/64 behind the side and 5/64 below the top, both true exits: the side is the one exit.
    let leaning = cone([1.984375, 1.0, 0.921875], [[0.5, 0.0, 0.125], [0.125, 0.25, 0.5], [0.125, -0.25, 0.5]]);
    check_with_kept("another exit", [&leaning, &base()], &t, &kept, &["v-f 0 3 v-f 0 3 -1"]);
}

#[test]
fn the_trace_says_that_a_kept_contact_is_not_too_deep() {
    let (a, b) = (spike([1.0, 1.0, 0.9296875], 0.25, 0.5), base());
    let (a, b) = (PreparedBlock::<f64>::new(&a).unwrap(), PreparedBlock::<f64>::new(&b).unwrap());
    let t = Tolerances::new(&tolerances()).unwrap();
    let depth = |kept: &[ContactKey]| {
        let (found, decisions) =
            ClassificationRequest { a: &a, b: &b, tolerances: &t, kept, among: None }.traced::<SpecRules>();
        let depths = decisions.iter().filter(|(decision, _)| decision.predicate == Predicate::VertexFaceDepth);
        let text = "vertex-face-depth(A.v0, B.f1)";
        let of_top: Vec<i8> = depths.filter(|(d, _)| d.to_string() == text).map(|(_, outcome)| *outcome).collect();
        (found.len(), of_top)
    };
    assert_eq!(depth(&[]), (0, vec![0]));
    assert_eq!(depth(&[key(ContactKind::VertexFace, 0, 1)]), (1, vec![1]));
}

/// With g a sixteenth and the contacts of sixteen times g kept, culling leaves what all pairs of features leave.
fn culling_is_silent<R: Real>(a: &Block, b: &Block, t: &ToleranceSet) -> usize {
    let (a, b) = (PreparedBlock::<R>::new(a).unwrap(), PreparedBlock::<R>::new(b).unwrap());
    let t = Tolerances::<R>::new(t).unwrap();
    let times = |factor: f64| {
        let penetration = t.penetration * R::from_f64(factor);
        Tolerances { penetration, reach: t.search.larger(penetration) * R::from_f64(1.0625), ..t }
    };
    let contacts = |tolerances: &Tolerances<R>, kept: &[ContactKey]| {
        let found = ClassificationRequest { a: &a, b: &b, tolerances, kept, among: None }.traced::<SpecRules>().0;
        found.into_iter().map(|f| f.contact).collect::<Vec<_>>()
    };
    let (shallow, deep) = (times(0.0625), times(16.0));
    let kept: Vec<_> = contacts(&deep, &[]).into_iter().map(|contact| contact.key).collect();
    let found = contacts(&shallow, &kept);
    assert_eq!(found, contacts(&Tolerances { reach: R::from_f64(1e30), ..shallow }, &kept));
    found.len() - contacts(&shallow, &[]).len().min(found.len())
}

#[test]
fn culling_never_loses_a_kept_contact() {
    let mut more = [0; 3];
    for pair in golden_contacts::pairs() {
        more[0] += culling_is_silent::<f32>(&pair.a, &pair.b, &pair.tolerances);
        more[1] += culling_is_silent::<f64>(&pair.a, &pair.b, &pair.tolerances);
        more[2] += culling_is_silent::<Wide>(&pair.a, &pair.b, &pair.tolerances);
    }
    assert!(more.into_iter().all(|count| count > 0), "{more:?}");
}
