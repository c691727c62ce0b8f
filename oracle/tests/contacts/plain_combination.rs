//! Which contacts make a face lie on a face, an edge on a face, or parallel edges meet.

use crate::support::shapes::{Prism, WEDGE, cuboid, point, revised, slab, spike, step};
use num_rational::BigRational;
use rockproof_model::{
    Block, Contact, ContactKey, ContactKind, EdgeId, Entrance, FaceId, Sign, ToleranceSet, VertexId,
};
use rockproof_oracle::combination::{Combination, JoinedFeatures, combinations};
use rockproof_oracle::plain;

/// The contacts that classification finds, by kind and features, and what they combine to.
fn combined(a: &Block, b: &Block, tolerances: &ToleranceSet) -> (Vec<Contact>, Vec<Combination>) {
    let contacts: Vec<Contact> =
        plain::classify::<BigRational>(a, b, tolerances).into_iter().map(|f| f.contact).collect();
    let found = combinations(a, b, &contacts);
    let swapped: Vec<Contact> = contacts.iter().map(|c| c.swapped()).collect();
    let mut back: Vec<Combination> = combinations(b, a, &swapped).into_iter().map(exchanged).collect();
    back.sort();
    assert_eq!(back, found, "combinations do not depend on which block is named first");
    (contacts, found)
}

fn exchanged(combination: Combination) -> Combination {
    let joins = match combination.joins {
        JoinedFeatures::FaceFace(f, g) => JoinedFeatures::FaceFace(g, f),
        JoinedFeatures::EdgeFace(e, f) => JoinedFeatures::FaceEdge(f, e),
        JoinedFeatures::FaceEdge(f, e) => JoinedFeatures::EdgeFace(e, f),
        JoinedFeatures::EdgeEdge(e, f) => JoinedFeatures::EdgeEdge(f, e),
    };
    Combination { joins, contacts: combination.contacts }
}

fn face_face(a: u32, b: u32) -> JoinedFeatures {
    JoinedFeatures::FaceFace(FaceId(a), FaceId(b))
}

fn combination(joins: JoinedFeatures, contacts: &[usize]) -> Combination {
    Combination { joins, contacts: contacts.to_vec() }
}

#[test]
fn a_box_on_a_larger_one_is_one_face_on_a_face() {
    let (contacts, found) = combined(
        &cuboid(["1", "1", "1/100"], ["2", "2", "2"]),
        &cuboid(["0", "0", "-2"], ["3", "3", "0"]),
        &revised(&[]),
    );
    assert_eq!(contacts.len(), 4);
    assert_eq!(found, [combination(face_face(0, 1), &[0, 1, 2, 3])]);
}

#[test]
fn equal_boxes_corner_to_corner_are_one_face_on_a_face() {
    // Their edges coincide as well, within the faces that meet.
    let (contacts, found) = combined(
        &cuboid(["0", "0", "1/100"], ["2", "2", "2"]),
        &cuboid(["0", "0", "-2"], ["2", "2", "0"]),
        &revised(&[]),
    );
    assert!(contacts.iter().all(|c| c.kind() == ContactKind::VertexVertex));
    assert_eq!(found, [combination(face_face(0, 1), &[0, 1, 2, 3])]);
}

#[test]
fn crossed_bars_meet_in_a_face() {
    // Four e-e contacts, each on both faces.
    let (_, found) = combined(
        &cuboid(["0", "1", "1/100"], ["4", "2", "2"]),
        &cuboid(["1", "0", "-2"], ["2", "4", "0"]),
        &revised(&[]),
    );
    assert_eq!(found, [combination(face_face(0, 1), &[0, 1, 2, 3])]);
}

#[test]
fn overhanging_corner_is_one_face_on_a_face() {
    // A's corner 0 over B's top, B's corner 6 under A's bottom, and two crossings: the corners of the common rectangle.
    let (contacts, found) = combined(
        &cuboid(["1", "1", "1/100"], ["4", "4", "3"]),
        &cuboid(["0", "0", "-2"], ["2", "2", "0"]),
        &revised(&[]),
    );
    let kinds: Vec<ContactKind> = contacts.iter().map(|c| c.kind()).collect();
    use ContactKind::{EdgeEdge, FaceVertex, VertexFace};
    assert_eq!(kinds, [VertexFace, FaceVertex, EdgeEdge, EdgeEdge]);
    assert_eq!(found, [combination(face_face(0, 1), &[0, 1, 2, 3])]);
}

#[test]
fn ridge_on_a_slab_is_an_edge_on_a_face() {
    let (contacts, found) = combined(&WEDGE.along_x().translated(&point(["0", "0", "1/100"])), &slab(), &revised(&[]));
    assert_eq!(contacts.len(), 2);
    assert_eq!(found, [combination(JoinedFeatures::EdgeFace(EdgeId(0), FaceId(1)), &[0, 1])]);
}

#[test]
fn ridge_longer_than_a_slab_is_an_edge_on_a_face() {
    // Longer than the slab, whose top edges it crosses: e-e at x = ±4, whose feet on B span 8 and on A lie on the ridge.
    let long = Prism { half: "6", ..WEDGE };
    let (contacts, found) = combined(&long.along_x().translated(&point(["0", "0", "1/100"])), &slab(), &revised(&[]));
    assert!(contacts.iter().all(|c| c.kind() == ContactKind::EdgeEdge) && contacts.len() == 2, "{contacts:?}");
    assert_eq!(found, [combination(JoinedFeatures::EdgeFace(EdgeId(0), FaceId(1)), &[0, 1])]);
}

#[test]
fn parallel_ridges_meet_edge_to_edge() {
    // One overhangs the other at either end: v-e and e-v.
    let (contacts, found) =
        combined(&WEDGE.along_x().translated(&point(["-1", "0", "1/20"])), &WEDGE.upside_down_along_x(), &revised(&[]));
    let kinds: Vec<ContactKind> = contacts.iter().map(|c| c.kind()).collect();
    assert_eq!(kinds, [ContactKind::VertexEdge, ContactKind::EdgeVertex]);
    assert_eq!(found, [combination(JoinedFeatures::EdgeEdge(EdgeId(0), EdgeId(0)), &[0, 1])]);
}

#[test]
fn ridge_along_a_slab_edge_meets_edge_to_edge() {
    // Over edge 11 (y = 4), which bounds the top and a side: all contacts lie on that edge, so it is no edge on a face.
    let (contacts, found) = combined(&WEDGE.along_x().translated(&point(["0", "4", "1/100"])), &slab(), &revised(&[]));
    assert!(contacts.iter().all(|c| matches!(c.key, ContactKey::VertexEdge(_, EdgeId(11)))) && contacts.len() == 2);
    assert_eq!(found, [combination(JoinedFeatures::EdgeEdge(EdgeId(0), EdgeId(11)), &[0, 1])]);
}

#[test]
fn step_on_its_lower_side_combines_with_each_face_it_meets() {
    // A box in the notch touches floor and wall: two faces on faces, sharing the contacts of its lower left edge.
    let (_, found) = combined(&cuboid(["201/100", "-1", "201/100"], ["3", "1", "3"]), &step(), &revised(&[]));
    let kinds: Vec<_> = found.iter().map(|c| (c.joins, c.contacts.len())).collect();
    assert_eq!(kinds, [(face_face(0, 4), 4), (face_face(5, 5), 4)]);
}

#[test]
fn contacts_of_other_blocks_are_left_out() {
    let (a, b) = (WEDGE.along_x().translated(&point(["0", "0", "1/100"])), slab());
    let (contacts, found) = combined(&a, &b, &revised(&[]));
    let [_, of_b] = contacts[0].key.numbers();
    let foreign = Contact { key: ContactKey::of_kind(contacts[0].kind(), [99, of_b]), ..contacts[0] };
    assert_eq!(combinations(&a, &b, &[contacts[0], contacts[1], foreign]), found);
}

#[test]
fn single_contacts_combine_to_nothing() {
    let ridges = (WEDGE.along_x(), WEDGE.upside_down_along_y());
    assert_eq!(combined(&ridges.0, &ridges.1, &revised(&[])).1, []);
    for tip in [["0", "0", "0"], ["4", "0", "0"], ["4", "4", "0"]] {
        let (contacts, found) = combined(&spike(tip), &slab(), &revised(&[]));
        assert_eq!((contacts.len(), found), (1, Vec::new()));
    }
}

/// What contacts written by hand combine to, whichever block is named first. Neither entrance nor gap matters.
fn of_contacts(a: &Block, b: &Block, contacts: &[(ContactKind, u32, u32)]) -> Vec<Combination> {
    let contacts: Vec<Contact> = contacts
        .iter()
        .map(|&(kind, of_a, of_b)| Contact {
            key: ContactKey::of_kind(kind, [of_a, of_b]),
            entrance: Entrance::VertexFace(VertexId(0), FaceId(1)),
            gap: Sign::Zero,
        })
        .collect();
    let found = combinations(a, b, &contacts);
    let swapped: Vec<Contact> = contacts.iter().map(|c| c.swapped()).collect();
    let mut back: Vec<Combination> = combinations(b, a, &swapped).into_iter().map(exchanged).collect();
    back.sort();
    assert_eq!(back, found, "combinations do not depend on which block is named first");
    found
}

use ContactKind::{EdgeEdge, VertexEdge, VertexFace};

#[test]
fn contacts_with_one_foot_in_common_span_no_line() {
    // The ends of a vertical edge have the same foot on the slab's top.
    let post = cuboid(["0", "0", "1"], ["1", "1", "3"]);
    assert_eq!(of_contacts(&post, &slab(), &[(VertexFace, 0, 1), (VertexFace, 4, 1)]), []);
    // One corner beside two edges of the top: on the post it is a single point.
    assert_eq!(of_contacts(&post, &slab(), &[(VertexEdge, 0, 8), (VertexEdge, 0, 9)]), []);
}

#[test]
fn an_edge_on_a_face_holds_the_edge_beside_which_two_of_its_contacts_lie() {
    // Two corners of an edge along y = 4, a third inside of it on the top: edge 11 bounds the top, and its contacts are among those.
    let post = cuboid(["-1", "4", "0"], ["1", "6", "1"]);
    let found = of_contacts(&post, &slab(), &[(VertexEdge, 0, 11), (VertexEdge, 1, 11), (VertexFace, 1, 1)]);
    assert_eq!(found, [combination(JoinedFeatures::EdgeFace(EdgeId(0), FaceId(1)), &[0, 1, 2])]);
}

#[test]
fn an_edge_on_another_face_is_none_of_a_face_on_a_face() {
    let post = cuboid(["-1", "4", "0"], ["1", "6", "1"]);
    let contacts = [0, 1, 2].map(|v| (VertexFace, v, 1)).into_iter().chain([4, 7].map(|v| (VertexFace, v, 3)));
    let found = of_contacts(&post, &slab(), &contacts.collect::<Vec<_>>());
    let on_the_side = combination(JoinedFeatures::EdgeFace(EdgeId(9), FaceId(3)), &[3, 4]);
    assert_eq!(found, [combination(face_face(0, 1), &[0, 1, 2]), on_the_side]);
}

#[test]
fn three_contacts_in_line_make_no_face_on_a_face() {
    // The bottom's corners 0 and 1, and a crossing of edge 0 with the top's edge 9, all on edge 0's line.
    let bar = cuboid(["-5", "0", "0"], ["1", "2", "1"]);
    let found = of_contacts(&bar, &slab(), &[(VertexFace, 0, 1), (VertexFace, 1, 1), (EdgeEdge, 0, 9)]);
    assert_eq!(found, [combination(JoinedFeatures::EdgeFace(EdgeId(0), FaceId(1)), &[0, 1, 2])]);
}
