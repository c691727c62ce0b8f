//! What several contacts amount to: face-to-face, edge-to-face and parallel edge-to-edge (SPEC section 4, "Combinations").
//!
//! A contact *lies on* a face (an edge) of a block when its feature there is that face (edge) or bounds it. Each contact
//! has a point on either block: the vertex; on an edge, the foot of the vertex or of the common perpendicular; on a face,
//! the foot of the vertex in the face's plane. All of them exact, in integers over one denominator a point: fractions that are
//! brought to lowest terms again and again take many times longer. Points of several contacts *span* a line or a plane when
//! they do so on both blocks: where the blocks are a gap apart, the points of one block alone are what lines up.
//!
//! - **face-face** of F and G: the faces look at each other (`N_F·N_G < 0`) and the contacts on both span a plane.
//! - **edge-face** of e and G: the contacts on both span a line and do not all lie on one edge of G; no face-face joins G
//!   and a face of e.
//! - **parallel edge-edge** of e and e': the contacts on both span a line; no face-face joins a face of e and one of e',
//!   and no edge-face joins one of the edges and a face of the other.
//!
//! So a box on a floor is one face-face, not also its four edges on the floor. A contact without a point (on an edge
//! without length or a face without area, which rounding can make) is part of no combination.

mod span;

use num_bigint::BigInt;
use num_traits::Signed;
use rockproof_model::block::face_normal;
use rockproof_model::decision::Feature;
use rockproof_model::lattice::Lattice;
use rockproof_model::topology::Edge;
use rockproof_model::{Block, Contact, EdgeId, FaceId, Vec3};
use span::{HomogeneousPoint, Span, Units, span};
use std::collections::BTreeMap;
use std::fmt;

/// Which kinds of feature a combination joins; A's feature is named first. The order of the variants is the order in
/// which combinations are sorted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum CombinationKind {
    /// A face of each.
    FaceFace,
    /// An edge of A and a face of B.
    EdgeFace,
    /// A face of A and an edge of B.
    FaceEdge,
    /// Parallel edges of both.
    EdgeEdge,
}

impl CombinationKind {
    /// `face-face`, `edge-face`, `face-edge` or `edge-edge`, as written in tables and files.
    pub fn name(self) -> &'static str {
        match self {
            CombinationKind::FaceFace => "face-face",
            CombinationKind::EdgeFace => "edge-face",
            CombinationKind::FaceEdge => "face-edge",
            CombinationKind::EdgeEdge => "edge-edge",
        }
    }
}

impl fmt::Display for CombinationKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// The two larger features that contacts join, A's first. They compare by kind, then feature of A, then of B.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum JoinedFeatures {
    /// See [`CombinationKind::FaceFace`].
    FaceFace(FaceId, FaceId),
    /// See [`CombinationKind::EdgeFace`].
    EdgeFace(EdgeId, FaceId),
    /// See [`CombinationKind::FaceEdge`].
    FaceEdge(FaceId, EdgeId),
    /// See [`CombinationKind::EdgeEdge`].
    EdgeEdge(EdgeId, EdgeId),
}

impl JoinedFeatures {
    /// Which kinds of feature are joined.
    pub fn kind(self) -> CombinationKind {
        match self {
            JoinedFeatures::FaceFace(..) => CombinationKind::FaceFace,
            JoinedFeatures::EdgeFace(..) => CombinationKind::EdgeFace,
            JoinedFeatures::FaceEdge(..) => CombinationKind::FaceEdge,
            JoinedFeatures::EdgeEdge(..) => CombinationKind::EdgeEdge,
        }
    }

    /// The numbers of the two features, A's first, as written in tables and files.
    pub fn numbers(self) -> [u32; 2] {
        match self {
            JoinedFeatures::FaceFace(FaceId(a), FaceId(b))
            | JoinedFeatures::EdgeFace(EdgeId(a), FaceId(b))
            | JoinedFeatures::FaceEdge(FaceId(a), EdgeId(b))
            | JoinedFeatures::EdgeEdge(EdgeId(a), EdgeId(b)) => [a, b],
        }
    }
}

/// Several contacts that together join two larger features. Combinations compare by kind, then feature of A, then of B.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Combination {
    /// The features that are joined.
    pub joins: JoinedFeatures,
    /// Positions, in the list of contacts given, of those that lie on both features, ascending.
    pub contacts: Vec<usize>,
}

/// The combinations that the contacts of a pair form, sorted.
///
/// `contacts` is what a classification of the pair answers; the blocks are those that were classified. A contact that
/// names a feature its block does not have is part of no combination.
pub fn combinations(a: &Block, b: &Block, contacts: &[Contact]) -> Vec<Combination> {
    // One point spans nothing.
    if contacts.len() < 2 {
        return Vec::new();
    }
    let lattice = Lattice::covering(a.coordinates().chain(b.coordinates()));
    let (a, b) = (LatticeBlock::of(a, &lattice), LatticeBlock::of(b, &lattice));
    let touches: Vec<Touch> =
        contacts.iter().enumerate().filter_map(|(index, contact)| touch(&a, &b, index, contact)).collect();
    let mut found = face_faces(&a, &b, &touches);
    let edge_faces = edge_faces(&a, &b, &touches, &found);
    let face_edges = face_edges(&a, &b, &touches, &found);
    found.extend(edge_faces);
    found.extend(face_edges);
    let edge_edges = edge_edges(&a, &b, &touches, &found);
    found.extend(edge_edges);
    found.sort();
    found
}

/// A block with its vertices in lattice units.
struct LatticeBlock<'a> {
    block: &'a Block,
    vertices: Vec<Units>,
}

/// A contact's features and its point on either block.
struct Touch {
    index: usize,
    /// Faces and edges of A on which the contact lies.
    a: Support,
    /// Faces and edges of B on which the contact lies.
    b: Support,
    point_a: HomogeneousPoint,
    point_b: HomogeneousPoint,
}

/// What a contact's feature is or bounds.
struct Support {
    faces: Vec<FaceId>,
    edges: Vec<EdgeId>,
}

impl<'a> LatticeBlock<'a> {
    fn of(block: &'a Block, lattice: &Lattice) -> Self {
        LatticeBlock { block, vertices: block.vertices().iter().map(|v| v.map(|c| lattice.units(c))).collect() }
    }

    fn edge(&self, edge: EdgeId) -> &Edge {
        self.block.topology().edge(edge)
    }

    fn faces_at(&self, edge: EdgeId) -> [FaceId; 2] {
        [self.edge(edge).left, self.edge(edge).right]
    }

    fn support(&self, feature: Feature) -> Support {
        let topology = self.block.topology();
        match feature {
            Feature::Vertex(_, v) => {
                Support { faces: topology.vertex_faces(v).to_vec(), edges: topology.vertex_edges(v).to_vec() }
            }
            Feature::Edge(_, e) => Support { faces: self.faces_at(e).to_vec(), edges: vec![e] },
            Feature::Face(_, f) => Support { faces: vec![f], edges: Vec::new() },
        }
    }

    /// Whether all of these lie on one and the same edge of a face.
    fn lie_on_one_edge<'s>(&self, face: FaceId, supports: impl Iterator<Item = &'s Support> + Clone) -> bool {
        let edges = self.block.topology().face_edges(face);
        edges.iter().any(|edge| supports.clone().all(|support| support.edges.contains(edge)))
    }

    fn normal(&self, face: FaceId) -> Units {
        face_normal(&self.vertices, self.block.topology().face(face))
    }

    /// The edge's first point and its direction.
    fn line(&self, edge: EdgeId) -> (&Units, Units) {
        let ends = self.edge(edge);
        let start = &self.vertices[ends.p.index()];
        (start, self.vertices[ends.q.index()].minus(start))
    }

    /// The foot of `x` on the line of an edge.
    fn foot_on_edge(&self, edge: EdgeId, x: &Units) -> Option<HomogeneousPoint> {
        let (start, direction) = self.line(edge);
        HomogeneousPoint::along(start, &direction, &x.minus(start).dot(&direction), direction.norm_squared())
    }

    /// The foot of `x` in the plane of a face: through the mean of its vertices, as SPEC section 2 has it.
    fn foot_on_face(&self, face: FaceId, x: &Units) -> Option<HomogeneousPoint> {
        let normal = self.normal(face);
        let boundary = self.block.topology().face(face);
        let count = BigInt::from(boundary.len());
        let total = boundary.iter().fold(Vec3::zero(), |t: Units, &v| t.plus(&self.vertices[v.index()]));
        // −N·(x − c)/|N|² with c = total/count, over one denominator.
        let depth = normal.dot(&total.minus(&x.scaled(&count)));
        HomogeneousPoint::along(x, &normal, &depth, normal.norm_squared() * count)
    }
}

fn touch(a: &LatticeBlock<'_>, b: &LatticeBlock<'_>, index: usize, contact: &Contact) -> Option<Touch> {
    let [feature_a, feature_b] = contact.key.features();
    if !feature_a.is_in(a.block.topology()) || !feature_b.is_in(b.block.topology()) {
        return None;
    }
    let (point_a, point_b) = match (feature_a, feature_b) {
        (Feature::Vertex(_, v), Feature::Vertex(_, w)) => {
            (HomogeneousPoint::whole(&a.vertices[v.index()]), HomogeneousPoint::whole(&b.vertices[w.index()]))
        }
        (Feature::Vertex(_, v), other) => {
            let vertex = &a.vertices[v.index()];
            (HomogeneousPoint::whole(vertex), foot(b, other, vertex)?)
        }
        (other, Feature::Vertex(_, v)) => {
            let vertex = &b.vertices[v.index()];
            (foot(a, other, vertex)?, HomogeneousPoint::whole(vertex))
        }
        (Feature::Edge(_, e), Feature::Edge(_, f)) => feet_of_edges(a.line(e), b.line(f))?,
        _ => return None,
    };
    Some(Touch { index, a: a.support(feature_a), b: b.support(feature_b), point_a, point_b })
}

fn foot(block: &LatticeBlock<'_>, feature: Feature, x: &Units) -> Option<HomogeneousPoint> {
    match feature {
        Feature::Vertex(_, v) => Some(HomogeneousPoint::whole(&block.vertices[v.index()])),
        Feature::Edge(_, e) => block.foot_on_edge(e, x),
        Feature::Face(_, f) => block.foot_on_face(f, x),
    }
}

/// The feet of the common perpendicular of two lines; `None` when they are parallel.
fn feet_of_edges((p1, d1): (&Units, Units), (p2, d2): (&Units, Units)) -> Option<(HomogeneousPoint, HomogeneousPoint)> {
    let across = d1.cross(&d2);
    let whole = across.norm_squared();
    let between = p2.minus(p1);
    let along_1 = between.cross(&d2).dot(&across);
    let along_2 = between.cross(&d1).dot(&across);
    Some((
        HomogeneousPoint::along(p1, &d1, &along_1, whole.clone())?,
        HomogeneousPoint::along(p2, &d2, &along_2, whole)?,
    ))
}

/// The contacts on each pair of a feature of A and a feature of B.
fn grouped<A: Ord + Copy, B: Ord + Copy>(
    touches: &[Touch],
    of_a: impl Fn(&Touch) -> &[A],
    of_b: impl Fn(&Touch) -> &[B],
) -> BTreeMap<(A, B), Vec<&Touch>> {
    let mut groups: BTreeMap<(A, B), Vec<&Touch>> = BTreeMap::new();
    for touch in touches {
        for &a in of_a(touch) {
            for &b in of_b(touch) {
                groups.entry((a, b)).or_default().push(touch);
            }
        }
    }
    groups
}

fn face_faces(a: &LatticeBlock<'_>, b: &LatticeBlock<'_>, touches: &[Touch]) -> Vec<Combination> {
    let groups = grouped(touches, |t| &t.a.faces, |t| &t.b.faces);
    groups
        .into_iter()
        .filter(|((f, g), group)| spanned(group) == Span::Plane && a.normal(*f).dot(&b.normal(*g)).is_negative())
        .map(|((f, g), group)| combination(JoinedFeatures::FaceFace(f, g), &group))
        .collect()
}

/// Edges of A on faces of B.
fn edge_faces(
    a: &LatticeBlock<'_>,
    b: &LatticeBlock<'_>,
    touches: &[Touch],
    found: &[Combination],
) -> Vec<Combination> {
    let groups = grouped(touches, |t| &t.a.edges, |t| &t.b.faces);
    let is_new = |edge: EdgeId, face: FaceId, group: &[&Touch]| {
        spanned(group) != Span::Point
            && !b.lie_on_one_edge(face, group.iter().map(|touch| &touch.b))
            && !a.faces_at(edge).iter().any(|&own| has(found, JoinedFeatures::FaceFace(own, face)))
    };
    groups
        .into_iter()
        .filter(|((edge, face), group)| is_new(*edge, *face, group))
        .map(|((edge, face), group)| combination(JoinedFeatures::EdgeFace(edge, face), &group))
        .collect()
}

/// Faces of A under edges of B.
fn face_edges(
    a: &LatticeBlock<'_>,
    b: &LatticeBlock<'_>,
    touches: &[Touch],
    found: &[Combination],
) -> Vec<Combination> {
    let groups = grouped(touches, |t| &t.a.faces, |t| &t.b.edges);
    let is_new = |face: FaceId, edge: EdgeId, group: &[&Touch]| {
        spanned(group) != Span::Point
            && !a.lie_on_one_edge(face, group.iter().map(|touch| &touch.a))
            && !b.faces_at(edge).iter().any(|&own| has(found, JoinedFeatures::FaceFace(face, own)))
    };
    groups
        .into_iter()
        .filter(|((face, edge), group)| is_new(*face, *edge, group))
        .map(|((face, edge), group)| combination(JoinedFeatures::FaceEdge(face, edge), &group))
        .collect()
}

fn edge_edges(
    a: &LatticeBlock<'_>,
    b: &LatticeBlock<'_>,
    touches: &[Touch],
    found: &[Combination],
) -> Vec<Combination> {
    let groups = grouped(touches, |t| &t.a.edges, |t| &t.b.edges);
    groups
        .into_iter()
        .filter(|((e, f), group)| {
            let (faces_a, faces_b) = (a.faces_at(*e), b.faces_at(*f));
            let within_faces =
                faces_a.iter().any(|fa| faces_b.iter().any(|fb| has(found, JoinedFeatures::FaceFace(*fa, *fb))));
            let within_edge_face = faces_b.iter().any(|fb| has(found, JoinedFeatures::EdgeFace(*e, *fb)))
                || faces_a.iter().any(|fa| has(found, JoinedFeatures::FaceEdge(*fa, *f)));
            spanned(group) != Span::Point && !within_faces && !within_edge_face
        })
        .map(|((e, f), group)| combination(JoinedFeatures::EdgeEdge(e, f), &group))
        .collect()
}

fn has(found: &[Combination], joins: JoinedFeatures) -> bool {
    found.iter().any(|combination| combination.joins == joins)
}

fn combination(joins: JoinedFeatures, group: &[&Touch]) -> Combination {
    Combination { joins, contacts: group.iter().map(|touch| touch.index).collect() }
}

/// The less of what the contacts' points span on A and on B.
fn spanned(group: &[&Touch]) -> Span {
    let on_a = span(group.iter().map(|touch| &touch.point_a));
    let on_b = span(group.iter().map(|touch| &touch.point_b));
    on_a.min(on_b)
}
