//! What follows from edges that are parallel to faces, and from features that lie in planes of faces, before any number is calculated.

use super::{SignCascade, sign_beyond};
use crate::number::Ball;
use crate::own_lattice::ProductAlongNormal;
use crate::predicate::{Edge, EdgeAlongNormal, Face, Polynomial, Vertex};
use rockproof_model::decision::Side;
use rockproof_model::{EdgeId, Entrance, Sign};

impl SignCascade<'_, '_> {
    /// The sign of `d·N` of an edge and a face: beyond f64 on the lattices of their blocks, where their integers are short enough.
    pub(super) fn edge_along_normal(&mut self, edge: Edge, face: Face) -> Sign {
        let asked = EdgeAlongNormal { edge, face };
        let (value, bound) = (asked.value(&self.float_view()).0, self.known_bound(&asked));
        if let Some(sign) = sign_beyond(value, bound) {
            self.levels.float += 1;
            return sign;
        }
        let known = self.on_own_lattices(edge, face, None, Ball { middle: value, radius: bound });
        known.unwrap_or_else(|| self.careful_sign(&asked, value))
    }

    /// The sign of a [`ProductAlongNormal`], `own` an edge of the block of the face, on the lattices of the blocks, where their integers are short enough;
    /// `value` encloses the product in metres.
    pub(super) fn on_own_lattices(&mut self, edge: Edge, face: Face, own: Option<Edge>, value: Ball) -> Option<Sign> {
        let [of_edge, of_face] = [edge.0, face.0].map(|side| self.pair.prepared(side));
        let product = ProductAlongNormal {
            edge: (of_edge.own_lattice()?, of_edge.edges[edge.1.index()].ends),
            face: (of_face.own_lattice()?, face.1, self.pair.topology(face.0).face(face.1)),
            own: own.map(|own| of_face.edges[own.1.index()].ends),
        };
        let (sign, width) = product.sign(value.size())?;
        *(if width == 128 { &mut self.levels.i128 } else { &mut self.levels.fixed[0] }) += 1;
        Some(sign)
    }

    /// Whether an edge of A is known to be parallel to one of B, or one of them to be a point.
    pub(crate) fn edges_are_parallel(&self, edge_a: EdgeId, edge_b: EdgeId) -> bool {
        let (a, b) = (self.pair.a, self.pair.b);
        let (Some(own_a), Some(own_b)) = (a.own_lattice(), b.own_lattice()) else { return false };
        own_a.are_parallel(a.edges[edge_a.index()].ends, own_b, b.edges[edge_b.index()].ends)
    }

    /// Whether an edge is not a point and lies in the plane of a face at it, so far as that is known of all edges of the face.
    pub(super) fn lies_in_plane(&mut self, edge: Edge, face: Face) -> bool {
        let prepared = self.pair.prepared(edge.0);
        let (p, q) = prepared.edges[edge.1.index()].ends;
        // Points that f64 tells apart are two.
        prepared.vertices[p.index()] != prepared.vertices[q.index()] && self.is_planar(face)
    }

    /// Whether all corners of a face lie in its plane: its edges are at right angles to its normal, so its corners are as high as their mean.
    pub(crate) fn is_planar(&mut self, face: Face) -> bool {
        let prepared = self.pair.prepared(face.0);
        let known = &prepared.faces[face.1.index()].planar;
        if let Some(planar) = known.get() {
            return planar;
        }
        // What is found out on the way to a sign is not counted as one. Which level decides what comes later must not depend on whether somebody else has
        // found it out before.
        let (levels, in_integers) = (self.levels, self.in_integers);
        // The first one closes the loop.
        let edges = &prepared.block.topology().face_edges(face.1)[1..];
        let planar = edges.iter().all(|&edge| self.edge_along_normal((face.0, edge), face).is_zero());
        (self.levels, self.in_integers) = (levels, in_integers);
        known.set(planar);
        planar
    }

    /// Whether the gaps of two entrances, unnormalised as [`crate::predicate::plane`] has them, are the same in size once normalised, as the features of one lie
    /// in the plane of the other or are parallel to it. Says no where that does not tell.
    pub(crate) fn share_plane(&mut self, first: &Entrance, second: &Entrance) -> bool {
        use Entrance::{EdgeEdge, FaceVertex, VertexFace};
        let levels = self.levels;
        let share = match (*first, *second) {
            (VertexFace(v, f), EdgeEdge(a, b)) | (EdgeEdge(a, b), VertexFace(v, f)) => {
                self.crosses_in_plane((Side::A, v), (Side::B, f), (Side::A, a), (Side::B, b))
            }
            (FaceVertex(f, v), EdgeEdge(a, b)) | (EdgeEdge(a, b), FaceVertex(f, v)) => {
                self.crosses_in_plane((Side::B, v), (Side::A, f), (Side::B, b), (Side::A, a))
            }
            (VertexFace(a, of_b), FaceVertex(of_a, b)) | (FaceVertex(of_a, b), VertexFace(a, of_b)) => {
                self.are_parallel((Side::A, a), (Side::A, of_a), (Side::B, b), (Side::B, of_b))
            }
            _ => false,
        };
        self.levels = levels;
        share
    }

    /// The plane of a vertex and a face, and that of `own`, an edge at the vertex, and `other`, an edge of the face.
    ///
    /// Where the face is planar and `own` parallel to it, both edges are at right angles to N, so their n is a multiple of N, or zero; then n has the same
    /// product with all points of the face and with all of `own`: with any of the differences of which the gaps are made.
    fn crosses_in_plane(&mut self, vertex: Vertex, face: Face, own: Edge, other: Edge) -> bool {
        let (p, q) = self.pair.prepared(own.0).edges[own.1.index()].ends;
        let ends = self.pair.topology(other.0).edge(other.1);
        (p == vertex.1 || q == vertex.1)
            && (ends.left == face.1 || ends.right == face.1)
            && self.edge_along_normal(own, face).is_zero()
            && self.is_planar(face)
    }

    /// The plane of `vertex` and of the face `of_other`, and that of `other` and of the face `own`, each face with the vertex of its block among its corners.
    ///
    /// Where both faces are planar and two edges of `own` that are not parallel are parallel to `of_other`, the normals are multiples of one another, and each
    /// vertex may stand for its face.
    fn are_parallel(&mut self, vertex: Vertex, own: Face, other: Vertex, of_other: Face) -> bool {
        let prepared = self.pair.prepared(own.0);
        let (topology, other_topology) = (prepared.block.topology(), self.pair.topology(other.0));
        // Two edges that meet at a corner of a polygon certainly convex are not parallel.
        if !prepared.faces[own.1.index()].surely_convex || !other_topology.face(of_other.1).contains(&other.1) {
            return false;
        }
        let mut at_corner = 0;
        topology.vertex_edges(vertex.1).iter().all(|&edge| {
            let ends = topology.edge(edge);
            if ends.left != own.1 && ends.right != own.1 {
                return true;
            }
            at_corner += 1;
            self.edge_along_normal((own.0, edge), of_other).is_zero()
        }) && at_corner == 2
            && self.is_planar(own)
            && self.is_planar(of_other)
    }
}
