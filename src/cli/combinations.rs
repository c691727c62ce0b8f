//! Face-to-face, edge-to-face and parallel edge-to-edge contacts, as combinations of the four (SPEC section 4, "Result").

use crate::campaign::compare::contact_features;
use crate::model::decision::{Feature, Side};
use crate::model::ring::ExactRing;
use crate::model::{Block, Contact, Number, Topology, Vec3};
use num_rational::BigRational;
use num_traits::Zero;
use std::collections::{BTreeMap, BTreeSet};

/// What several contacts on a common pair of faces amount to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Combination {
    /// `f-f`, `e-f`, `f-e` or `e-e` (parallel).
    pub(crate) kind: &'static str,
    /// A's face or edge.
    pub(crate) a: u32,
    /// B's face or edge.
    pub(crate) b: u32,
    /// The contacts it is made of, by their place in the list.
    pub(crate) contacts: BTreeSet<usize>,
}

/// The combinations of a pair's contacts, largest first: contacts on a common pair of faces are a face-to-face contact when
/// their points span a plane, and when all lie on one edge an edge-to-face contact, or a parallel edge-to-edge contact
/// if they lie on one edge of each block. What is part of a larger combination is not reported again.
pub(crate) fn combinations(a: &Block, b: &Block, contacts: &[Contact]) -> Vec<Combination> {
    let (ta, tb) = (a.topology(), b.topology());
    let mut on_faces: BTreeMap<(u32, u32), BTreeSet<usize>> = BTreeMap::new();
    let mut edges_faces: BTreeMap<(u32, u32), BTreeSet<usize>> = BTreeMap::new();
    let mut faces_edges: BTreeMap<(u32, u32), BTreeSet<usize>> = BTreeMap::new();
    let mut edges: BTreeMap<(u32, u32), BTreeSet<usize>> = BTreeMap::new();
    for (place, contact) in contacts.iter().enumerate() {
        let [fa, fb] = contact_features(contact);
        let (faces_a, faces_b) = (faces_around(ta, fa), faces_around(tb, fb));
        let (edges_a, edges_b) = (edges_around(ta, fa), edges_around(tb, fb));
        for (map, one, other) in [
            (&mut on_faces, &faces_a, &faces_b),
            (&mut edges_faces, &edges_a, &faces_b),
            (&mut faces_edges, &faces_a, &edges_b),
            (&mut edges, &edges_a, &edges_b),
        ] {
            for pair in one.iter().flat_map(|&x| other.iter().map(move |&y| (x, y))) {
                map.entry(pair).or_default().insert(place);
            }
        }
    }
    let points: Vec<Vec3<BigRational>> = contacts.iter().map(|c| point(a, b, c)).collect();
    on_faces.retain(|_, places| span(places.iter().map(|&p| &points[p])) >= 2);
    let mut found: Vec<Combination> = Vec::new();
    for (kind, map) in [("f-f", on_faces), ("e-e", edges), ("e-f", edges_faces), ("f-e", faces_edges)] {
        let mut list: Vec<_> = map.into_iter().filter(|(_, p)| span(p.iter().map(|&p| &points[p])) >= 1).collect();
        list.sort_by_key(|(pair, places)| (usize::MAX - places.len(), *pair));
        for ((fa, fb), places) in list {
            if !found.iter().any(|larger| places.is_subset(&larger.contacts)) {
                found.push(Combination { kind, a: fa, b: fb, contacts: places });
            }
        }
    }
    found
}

/// The faces in whose closure a feature lies.
fn faces_around(topology: &Topology, feature: Feature) -> Vec<u32> {
    match feature {
        Feature::Vertex(_, v) => topology.vertex_faces(v).to_vec(),
        Feature::Edge(_, e) => topology.edges().get(e as usize).map_or(Vec::new(), |e| vec![e.left, e.right]),
        Feature::Face(_, f) => vec![f],
    }
}

/// The edges in whose closure a feature lies.
fn edges_around(topology: &Topology, feature: Feature) -> Vec<u32> {
    match feature {
        Feature::Vertex(_, v) => topology.vertex_edges(v).to_vec(),
        Feature::Edge(_, e) => vec![e],
        Feature::Face(..) => Vec::new(),
    }
}

/// A contact's point, on A's feature where that is a vertex or an edge, else at B's vertex.
fn point(a: &Block, b: &Block, contact: &Contact) -> Vec3<BigRational> {
    let exact = |block: &Block, v: u32| block.vertices()[v as usize].map(Number::to_rational);
    match contact_features(contact) {
        [Feature::Vertex(Side::A, v), _] => exact(a, v),
        [_, Feature::Vertex(_, v)] => exact(b, v),
        [Feature::Edge(_, e), Feature::Edge(_, f)] => {
            let (ea, eb) = (a.topology().edges()[e as usize], b.topology().edges()[f as usize]);
            let (p, q) = (exact(a, ea.p), exact(b, eb.p));
            let (d1, d2) = (exact(a, ea.q).minus(&p), exact(b, eb.q).minus(&q));
            // Foot of the common perpendicular on A's edge: p + t·d1.
            let n = d1.cross(&d2);
            let size = n.norm_squared();
            if size.is_zero() {
                return p;
            }
            let t = q.minus(&p).cross(&d2).dot(&n) / size;
            p.plus(&d1.scaled(&t))
        }
        // No contact has a face on both sides.
        _ => Vec3::zero(),
    }
}

/// 0 for points at one place, 1 for points on a line, 2 for points that span a plane (or more).
fn span<'p>(points: impl Iterator<Item = &'p Vec3<BigRational>>) -> u8 {
    let points: Vec<_> = points.collect();
    let Some(first) = points.first() else { return 0 };
    let directions: Vec<_> = points.iter().map(|p| p.minus(first)).filter(|d| !d.norm_squared().is_zero()).collect();
    let Some(along) = directions.first() else { return 0 };
    let off = |d: &Vec3<BigRational>| !along.cross(d).norm_squared().sign().is_zero();
    if directions.iter().any(off) { 2 } else { 1 }
}
