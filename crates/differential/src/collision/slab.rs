//! Slabs between two hulls, and the directions across which the widest may lie.

use super::hull_pair::{Hull, HullPair, is_zero};
use num_bigint::BigInt;
use rockproof_model::Vec3;
use rockproof_model::ring::{ExactRing, Ring};

/// The slab between two blocks across one direction.
pub(super) struct Slab {
    /// Its width times the direction's length, negative for an overlap.
    pub(super) width: BigInt,
    /// The square of the direction's length.
    pub(super) length2: BigInt,
}

impl Slab {
    /// Across a direction from B to A; `None` for none.
    pub(super) fn across(a: &Hull<BigInt>, b: &Hull<BigInt>, direction: &Vec3<BigInt>) -> Option<Slab> {
        if is_zero(direction) {
            return None;
        }
        let low = a.points.iter().map(|p| p.dot(direction)).min()?;
        let high = b.points.iter().map(|p| p.dot(direction)).max()?;
        Some(Slab { width: low - high, length2: direction.dot(direction) })
    }

    /// The wider of two; the first of equal ones.
    pub(super) fn wider(self, other: Slab) -> Slab {
        let (one, two) = (ExactRing::sign(&self.width), ExactRing::sign(&other.width));
        let wider = if one != two {
            two > one
        } else {
            // With equal signs the squares decide, the other way round for overlaps.
            let mine = &self.width * &self.width * &other.length2;
            let others = &other.width * &other.width * &self.length2;
            if one.is_negative() { others < mine } else { others > mine }
        };
        if wider { other } else { self }
    }
}

/// A direction from B to A. Numbers are those of faces, edges and vertices of A and of B.
#[derive(Clone, Copy, Debug)]
pub(super) enum Direction {
    /// Against the normal of a face of A.
    FaceOfA(usize),
    /// Along the normal of a face of B.
    FaceOfB(usize),
    /// Across an edge of each, or against that.
    Edges { of_a: usize, of_b: usize, against: bool },
    /// From a vertex of B to one of A.
    Vertices { of_a: usize, of_b: usize },
    /// From the line of an edge of B straight to a vertex of A.
    VertexOfA { vertex: usize, edge: usize },
    /// From a vertex of B straight to the line of an edge of A.
    VertexOfB { vertex: usize, edge: usize },
}

impl Direction {
    /// Normals of faces and cross products of edges.
    pub(super) fn across_features(pair: &HullPair) -> Vec<Direction> {
        let [a, b] = &pair.exact;
        let edges_of_b = 0..b.edges.len();
        let crossed = (0..a.edges.len()).flat_map(|of_a| {
            let edges = edges_of_b.clone();
            edges.flat_map(move |of_b| [true, false].map(|against| Direction::Edges { of_a, of_b, against }))
        });
        let faces = (0..a.faces.len()).map(Direction::FaceOfA).chain((0..b.faces.len()).map(Direction::FaceOfB));
        faces.chain(crossed).collect()
    }

    /// Between a vertex of each, and between a vertex and the nearest point of an edge's line.
    pub(super) fn across_points(pair: &HullPair) -> Vec<Direction> {
        let [a, b] = &pair.exact;
        let all = |count: usize, other: usize| (0..count).flat_map(move |one| (0..other).map(move |two| (one, two)));
        let vertices = all(a.points.len(), b.points.len()).map(|(of_a, of_b)| Direction::Vertices { of_a, of_b });
        let of_a = all(a.points.len(), b.edges.len()).map(|(vertex, edge)| Direction::VertexOfA { vertex, edge });
        let of_b = all(b.points.len(), a.edges.len()).map(|(vertex, edge)| Direction::VertexOfB { vertex, edge });
        vertices.chain(of_a).chain(of_b).collect()
    }

    /// The vector, of any length.
    pub(super) fn of<T: Ring>(self, a: &Hull<T>, b: &Hull<T>) -> Vec3<T> {
        match self {
            Direction::FaceOfA(face) => a.normal(face).negated(),
            Direction::FaceOfB(face) => b.normal(face),
            Direction::Edges { of_a, of_b, against } => {
                let cross = a.direction(a.edges[of_a]).cross(&b.direction(b.edges[of_b]));
                if against { cross.negated() } else { cross }
            }
            Direction::Vertices { of_a, of_b } => a.points[of_a].minus(&b.points[of_b]),
            Direction::VertexOfA { vertex, edge } => from_line(b, b.edges[edge], &a.points[vertex]),
            Direction::VertexOfB { vertex, edge } => from_line(a, a.edges[edge], &b.points[vertex]).negated(),
        }
    }
}

/// The direction from the line of an edge straight to a point, times the square of the edge's length.
fn from_line<T: Ring>(hull: &Hull<T>, edge: [usize; 2], point: &Vec3<T>) -> Vec3<T> {
    let along = hull.direction(edge);
    let away = point.minus(&hull.points[edge[0]]);
    let share = away.dot(&along);
    away.scaled(&along.dot(&along)).minus(&along.scaled(&share))
}
