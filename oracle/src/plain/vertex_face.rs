//! Test 3 of SPEC section 4, without the shortest exit: v-f and f-v.

use super::pair::{ContactWithPlane, EntrancePlane, Pair, in_order};
use super::predicate_answer::PredicateAnswer;
use super::vector::{cross, difference, dot, opposite, squared_length};
use crate::rational::Rational;
use rockproof_model::decision::{Feature, Predicate, Side};
use rockproof_model::{ContactKey, Entrance, FaceId, Vec3, VertexId};

/// All contacts of a vertex of `side` and a face of the other block, before the shortest exit.
pub(super) fn contacts<Q: Rational>(pair: &Pair<'_, Q>, side: Side) -> Vec<ContactWithPlane<Q>> {
    let mut found = Vec::new();
    for vertex in pair.side(side).block.topology().vertex_ids() {
        for face in pair.side(side.other()).block.topology().face_ids() {
            found.extend(contact(pair, side, vertex, face));
        }
    }
    found
}

fn contact<Q: Rational>(pair: &Pair<'_, Q>, side: Side, vertex: VertexId, face: FaceId) -> Option<ContactWithPlane<Q>> {
    let key = match side {
        Side::A => ContactKey::VertexFace(vertex, face),
        Side::B => ContactKey::FaceVertex(face, vertex),
    };
    let contact = ContactWithPlane { key, plane: plane(pair, side, vertex, face) };
    let features = vertex_and_face(side, vertex, face);
    let passes = pair.not_too_deep(Predicate::VertexFaceDepth, &features, &contact)
        && pair.decide(Predicate::VertexFaceNear, &features, contact.plane.near(&pair.limits))
        && pair.decide(Predicate::InsideFace, &features, inside_face(pair, side, vertex, face))
        && !in_territory_of_the_boundary(pair, side, vertex, face)
        && cone_passes(pair, side, vertex, face);
    passes.then_some(contact)
}

/// The plane of a face of the other block, with its gap to a vertex of `side`: `h = N·(a − c)/|N|`, 0 for `N = 0`.
pub(super) fn plane<Q: Rational>(pair: &Pair<'_, Q>, side: Side, vertex: VertexId, face: FaceId) -> EntrancePlane<Q> {
    let plane = &pair.side(side.other()).faces[face.index()];
    let offset = dot(&plane.normal, &difference(pair.vertex(side, vertex), &plane.point));
    let gap_signed_square = offset.signed_square().over(&squared_length(&plane.normal)).unwrap_or_else(Q::zero);
    let (entrance, normal) = match side {
        Side::A => (Entrance::VertexFace(vertex, face), plane.normal.clone()),
        Side::B => (Entrance::FaceVertex(face, vertex), opposite(&plane.normal)),
    };
    EntrancePlane { entrance, normal, gap_signed_square, unsided: false }
}

/// **Cone passes plane**: every edge direction e at the vertex has `e·N ≥ 0`, or `(e·N)² ≤ so²·|e|²·|N|²` and, under
/// `revised`, `(e·N)² ≤ g²·|N|²` as well. **A tie says yes.**
pub(super) fn cone_passes<Q: Rational>(pair: &Pair<'_, Q>, side: Side, vertex: VertexId, face: FaceId) -> bool {
    let normal = &pair.side(side.other()).faces[face.index()].normal;
    let normal_squared = squared_length(normal);
    let limits = &pair.limits;
    pair.side(side).edges_away(vertex).iter().all(|(edge, away)| {
        let rise = dot(away, normal);
        let by_angle = || {
            let limit = limits.overlap_squared.times(&squared_length(away)).times(&normal_squared);
            PredicateAnswer::at_most(&rise.squared(), &limit)
        };
        let by_length =
            || PredicateAnswer::at_most(&rise.squared(), &limits.penetration_squared.times(&normal_squared));
        let within_tolerance = || if pair.is_classic() { by_angle() } else { by_angle().and(by_length) };
        let verdict = PredicateAnswer::at_least_zero(&rise).or(within_tolerance);
        let features = [Feature::Vertex(side, vertex), Feature::Face(side.other(), face), Feature::Edge(side, *edge)];
        pair.decide(Predicate::ConePasses, &features, verdict)
    })
}

/// The plane of a vertex and a face is a **true exit** under `revised`: every edge direction e at the vertex has
/// `e·N ≥ 0` or `(e·N)² ≤ (r/10)²·|N|²`. **A tie says yes.**
pub(super) fn is_true_exit<Q: Rational>(
    pair: &Pair<'_, Q>,
    side: Side,
    vertex: VertexId,
    face: FaceId,
) -> PredicateAnswer {
    let normal = &pair.side(side.other()).faces[face.index()].normal;
    let limit = pair.limits.exit_squared.times(&squared_length(normal));
    pair.side(side).edges_away(vertex).iter().fold(PredicateAnswer { yes: true, tie: false }, |all, (_, away)| {
        let rise = dot(away, normal);
        all.and(|| PredicateAnswer::at_least_zero(&rise).or(|| PredicateAnswer::at_most(&rise.squared(), &limit)))
    })
}

fn in_territory_of_the_boundary<Q: Rational>(pair: &Pair<'_, Q>, side: Side, vertex: VertexId, face: FaceId) -> bool {
    let topology = pair.side(side.other()).block.topology();
    let of_a_vertex = topology.face(face).iter().any(|&corner| {
        let (a, b) = in_order(side, vertex, corner);
        pair.in_vertex_territory(a, b)
    });
    of_a_vertex || topology.face_edges(face).iter().any(|&edge| pair.in_edge_territory(side, vertex, edge))
}

/// The projection of the vertex lies strictly inside the polygon, both projected along N. **A tie says no.**
///
/// Two directions `u ⊥ N` and `v = N × u` span the face plane; `(x·u, x·v)` are the coordinates there of whatever
/// projects along N. A ray from the vertex along u crosses the boundary an odd number of times when it starts inside;
/// a polygon that rounding has made cross itself is inside where that count is odd.
fn inside_face<Q: Rational>(pair: &Pair<'_, Q>, side: Side, vertex: VertexId, face: FaceId) -> PredicateAnswer {
    const ON_BOUNDARY: PredicateAnswer = PredicateAnswer { yes: false, tie: true };
    let other = pair.side(side.other());
    let normal = &other.faces[face.index()].normal;
    if squared_length(normal).sign().is_zero() {
        return ON_BOUNDARY;
    }
    let u = if normal.x.sign().is_zero() && normal.y.sign().is_zero() {
        Vec3::new(Q::from_integer(1), Q::zero(), Q::zero())
    } else {
        Vec3::new(normal.y.negated(), normal.x.clone(), Q::zero())
    };
    let v = cross(normal, &u);
    let here = pair.vertex(side, vertex);
    let corners: Vec<(Q, Q)> = other
        .block
        .topology()
        .face(face)
        .iter()
        .map(|&corner| difference(&other.vertices[corner.index()], here))
        .map(|offset| (dot(&offset, &u), dot(&offset, &v)))
        .collect();
    let mut inside = false;
    for (k, (x0, y0)) in corners.iter().enumerate() {
        let (x1, y1) = &corners[(k + 1) % corners.len()];
        let turn = x0.times(y1).minus(&x1.times(y0)).sign();
        let facing = x0.times(x1).plus(&y0.times(y1)).sign();
        if turn.is_zero() && facing.is_at_most_zero() {
            return ON_BOUNDARY;
        }
        let (below, above) = (y0.sign().is_at_most_zero(), y1.sign().is_positive());
        let (falls, rises) = (!below && !above, below && above);
        // The boundary meets the line of the ray; it does so ahead of the vertex when the vertex is to the left of a
        // rising side or to the right of a falling one.
        if (rises && turn.is_positive()) || (falls && turn.is_negative()) {
            inside = !inside;
        }
    }
    PredicateAnswer { yes: inside, tie: false }
}

/// The features of a decision about a vertex of `side` and a face of the other block, the vertex first.
pub(super) fn vertex_and_face(side: Side, vertex: VertexId, face: FaceId) -> [Feature; 2] {
    [Feature::Vertex(side, vertex), Feature::Face(side.other(), face)]
}
