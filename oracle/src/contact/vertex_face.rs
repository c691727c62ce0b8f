//! Test 3: v-f, and f-v with the roles exchanged.

use super::certified_reject::CertainPlace;
use super::entrance::Candidate;
use crate::classification::{Classification, Observer};
use crate::predicate::{Face, InwardOf, LengthTolerance, NormalComponent, PolygonHeight, Vertex};
use crate::sign_cascade::Margins;
use rockproof_model::decision::{Decision, Feature, Predicate, Side};
use rockproof_model::{ContactKey, EdgeId, Sign, Topology};

/// The v-f or f-v contact of a vertex and a face.
pub(super) fn contact_of(vertex: Vertex, face: Face) -> ContactKey {
    match vertex.0 {
        Side::A => ContactKey::VertexFace(vertex.1, face.1),
        Side::B => ContactKey::FaceVertex(face.1, vertex.1),
    }
}

impl<O: Observer> Classification<'_, '_, O> {
    /// Whether a vertex, convex or not, touches a face of the other block.
    ///
    /// `h ≤ s`, not too deep, the projection strictly inside the polygon, the vertex in no territory of the face's vertices and
    /// edges, and its cone passes the plane.
    pub(crate) fn vertex_face(&mut self, vertex: Vertex, face: Face) -> Option<Candidate> {
        // Most vertices are beside the face.
        let place = self.place_in_face(vertex, face);
        if place == CertainPlace::Outside {
            return None;
        }
        let candidate = self.face_candidate(vertex, face.1);
        let features = [Feature::Vertex(vertex.0, vertex.1), Feature::Face(face.0, face.1)];
        let near = self.decide(
            || Decision::about(Predicate::VertexFaceNear, &features),
            |run| run.gap_at_most(&candidate, LengthTolerance::Search),
        ) && self.not_too_deep(contact_of(vertex, face), &candidate, || {
            Decision::about(Predicate::VertexFaceDepth, &features)
        });
        if !near || !(place == CertainPlace::Inside || self.inside_face(vertex, face)) {
            return None;
        }
        // What is cheaper to ask goes first, but where decisions are recorded in the order of SPEC.
        if O::is_active() && self.belongs_to_rim(vertex, face) {
            return None;
        }
        let candidate = candidate.passing(self.cone_passes(vertex, face))?;
        (O::is_active() || !self.belongs_to_rim(vertex, face)).then_some(candidate)
    }

    /// Whether a vertex is in the territory of a vertex or an edge of a face.
    fn belongs_to_rim(&mut self, vertex: Vertex, face: Face) -> bool {
        let topology = self.pair.topology(face.0);
        topology.face(face.1).iter().any(|&v| self.vertices_share_territory(vertex, v))
            || topology.face_edges(face.1).iter().any(|&e| self.in_edge_territory(vertex, (face.0, e)))
    }

    /// Whether the projection of a vertex along N lies strictly inside a face; **a tie says no**.
    ///
    /// Recorded is one sign, of where the projection lies: positive inside, zero on the boundary. Those it is made of may be
    /// zero far from the boundary: the height of the vertex over a corner, or its side of an edge that ends before it.
    fn inside_face(&mut self, vertex: Vertex, face: Face) -> bool {
        let features = [Feature::Vertex(vertex.0, vertex.1), Feature::Face(face.0, face.1)];
        self.decide(
            || Decision::about(Predicate::InsideFace, &features),
            |run| {
                let side = if !run.pair.prepared(face.0).faces[face.1.index()].surely_convex {
                    run.side_of_boundary(vertex, face)
                } else if run.inside_all_edges(vertex, face) {
                    Sign::Positive
                } else if O::is_active() && run.side_of_boundary(vertex, face).is_zero() {
                    Sign::Zero
                } else {
                    Sign::Negative
                };
                if !O::is_active() {
                    return side.is_positive();
                }
                let topology = run.pair.topology(face.0);
                run.observed(side, |margins| boundary_margin(vertex, face, topology, margins)).is_positive()
            },
        )
    }

    fn inside_all_edges(&mut self, vertex: Vertex, face: Face) -> bool {
        let edges = self.pair.topology(face.0).face_edges(face.1);
        edges.iter().all(|&edge| self.side_of_edge(vertex, face, edge).is_positive())
    }

    /// Positive where the projection of the vertex is on the face's side of one of its edges.
    fn side_of_edge(&mut self, vertex: Vertex, face: Face, edge: EdgeId) -> Sign {
        self.unobserved_sign(&inward_of(vertex, face, edge, self.pair.topology(face.0)))
    }

    /// Where the projection of a vertex lies in a polygon that may be concave, by its winding number: positive inside, zero on
    /// the boundary.
    fn side_of_boundary(&mut self, vertex: Vertex, face: Face) -> Sign {
        let Some([up, along]) = self.axes_across(face) else { return Sign::Zero };
        let topology = self.pair.topology(face.0);
        let corners = topology.face(face.1);
        let height = |run: &mut Self, corner, axis| run.unobserved_sign(&PolygonHeight { vertex, corner, face, axis });
        let heights: Vec<Sign> = corners.iter().map(|&corner| height(self, corner, up)).collect();
        let mut winding = 0;
        for (k, &edge) in topology.face_edges(face.1).iter().enumerate() {
            let next = (k + 1) % corners.len();
            let (from, to) = (heights[k], heights[next]);
            if from == to && !from.is_zero() {
                continue;
            }
            let side = self.side_of_edge(vertex, face, edge);
            if from.is_zero() && to.is_zero() {
                // A level edge at the vertex's height: on it where its ends are not both to one side.
                let [p, q] = [corners[k], corners[next]].map(|corner| height(self, corner, along));
                if !p.times(q).is_positive() {
                    return Sign::Zero;
                }
            } else if side.is_zero() {
                return Sign::Zero;
            } else if !from.is_positive() && to.is_positive() && side.is_positive() {
                winding += 1;
            } else if from.is_positive() && !to.is_positive() && side.is_negative() {
                winding -= 1;
            }
        }
        if winding != 0 { Sign::Positive } else { Sign::Negative }
    }

    /// Two coordinate axes that span space together with the face's normal; `None` for a face without area.
    fn axes_across(&mut self, face: Face) -> Option<[usize; 2]> {
        let axis = (0..3).find(|&axis| !self.unobserved_sign(&NormalComponent { face, axis }).is_zero())?;
        Some([(axis + 1) % 3, (axis + 2) % 3])
    }
}

pub(super) fn inward_of(vertex: Vertex, face: Face, edge: EdgeId, topology: &Topology) -> InwardOf {
    InwardOf { vertex, edge: (face.0, edge), right: topology.edge(edge).right == face.1 }
}

/// How close the projection of a vertex is to the boundary of a face: that of the closest edge. To be on an edge it must be on
/// its line, and along no coordinate axis beyond both its ends; the largest of these four margins counts. Two axes would be
/// enough for exactness, but heights along one that nearly is the normal's are small everywhere.
fn boundary_margin(vertex: Vertex, face: Face, topology: &Topology, margins: &Margins<'_, '_>) -> f64 {
    let corners = topology.face(face.1);
    let of_edge = |(k, &edge): (usize, &EdgeId)| {
        let (_, off_line) = margins.of(&inward_of(vertex, face, edge, topology));
        let ends = [corners[k], corners[(k + 1) % corners.len()]];
        let beyond_ends = [0, 1, 2].map(|axis| {
            let [(p, from), (q, to)] = ends.map(|corner| margins.of(&PolygonHeight { vertex, corner, face, axis }));
            if p.times(q).is_positive() { from.min(to) } else { 0.0 }
        });
        beyond_ends.into_iter().fold(off_line, f64::max)
    };
    topology.face_edges(face.1).iter().enumerate().map(of_edge).fold(1.0, f64::min)
}
