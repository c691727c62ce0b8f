//! A block in exact rationals, with what SPEC section 2 derives from its coordinates and section 4 from its lengths.

use super::vector::{cross, difference, dot, multiple, opposite, squared_length, sum};
use crate::rational::Rational;
use rockproof_model::tolerance::LAMBDA_INVERSE;
use rockproof_model::topology::Edge;
use rockproof_model::{Block, Criteria, EdgeId, Vec3, VertexId};

/// The tolerances that classification uses, lengths squared.
pub(super) struct SquaredTolerances<Q> {
    /// s
    pub(super) search: Q,
    /// s²
    pub(super) search_squared: Q,
    /// r²
    pub(super) territory_squared: Q,
    /// g²
    pub(super) penetration_squared: Q,
    /// (r/10)²: how far a true exit may dip.
    pub(super) exit_squared: Q,
    /// so²
    pub(super) overlap_squared: Q,
    /// sp²
    pub(super) parallel_squared: Q,
    /// ε
    pub(super) equal: Q,
    pub(super) criteria: Criteria,
}

/// A face's plane `N·(x − c) = 0`.
pub(super) struct Face<Q> {
    /// `N = Σ v_k × v_{k+1}`, relative to the loop's first vertex.
    pub(super) normal: Vec3<Q>,
    /// Mean of the loop's vertices.
    pub(super) point: Vec3<Q>,
}

/// An edge's line and what its two faces are to it; in the pairs, L comes first.
pub(super) struct EdgeLine<Q> {
    /// `d = q − p`.
    pub(super) direction: Vec3<Q>,
    /// `|d|²`
    pub(super) length_squared: Q,
    /// `m_L = N_L × d`, `m_R = N_R × (−d)`.
    pub(super) inward: [Vec3<Q>; 2],
    /// Square of the greatest distance of a vertex of the face from the edge's line; 0 for an edge of length zero.
    pub(super) width_squared: [Q; 2],
}

/// A block in exact rationals.
pub(super) struct RationalBlock<'a, Q> {
    pub(super) block: &'a Block,
    pub(super) vertices: Vec<Vec3<Q>>,
    pub(super) faces: Vec<Face<Q>>,
    pub(super) edges: Vec<EdgeLine<Q>>,
    /// Squared territory radius of each vertex.
    pub(super) vertex_radius_squared: Vec<Q>,
    /// Squared territory radius of each edge.
    pub(super) edge_radius_squared: Vec<Q>,
}

impl<'a, Q: Rational> RationalBlock<'a, Q> {
    pub(super) fn new(block: &'a Block, limits: &SquaredTolerances<Q>) -> Self {
        let vertices: Vec<Vec3<Q>> = block.vertices().iter().map(|v| v.map(Q::from_number)).collect();
        let topology = block.topology();
        let faces: Vec<Face<Q>> = topology.faces().iter().map(|f| face(&vertices, f)).collect();
        let edges: Vec<EdgeLine<Q>> =
            topology.edges().iter().map(|e| line(&vertices, e, &faces, topology.faces())).collect();
        let vertex_radius_squared = topology
            .vertex_ids()
            .map(|v| {
                let at = topology.vertex_edges(v).iter().map(|&e| edges[e.index()].length_squared.clone());
                bounded_radius(limits, at.min())
            })
            .collect();
        let edge_radius_squared =
            edges.iter().map(|e| bounded_radius(limits, e.width_squared.iter().min().cloned())).collect();
        RationalBlock { block, vertices, faces, edges, vertex_radius_squared, edge_radius_squared }
    }

    pub(super) fn edge(&self, edge: EdgeId) -> &Edge {
        self.block.topology().edge(edge)
    }

    /// The edges at a vertex, each with its direction pointing away from the vertex.
    pub(super) fn edges_away(&self, vertex: VertexId) -> Vec<(EdgeId, Vec3<Q>)> {
        let here = &self.vertices[vertex.index()];
        let topology = self.block.topology();
        topology
            .vertex_edges(vertex)
            .iter()
            .map(|&e| (e, difference(&self.vertices[self.edge(e).other(vertex).index()], here)))
            .collect()
    }

    /// `(x − p)·d`, `|d|²` and the squared distance of `x` from the line times `|d|²`, all polynomials.
    pub(super) fn against_line(&self, x: &Vec3<Q>, edge: EdgeId) -> AgainstLine<Q> {
        let line = &self.edges[edge.index()];
        let from_p = difference(x, &self.vertices[self.edge(edge).p.index()]);
        AgainstLine {
            along: dot(&from_p, &line.direction),
            beside_squared: squared_length(&cross(&from_p, &line.direction)),
            from_p,
        }
    }

    /// The smallest and the largest coordinate along an axis.
    pub(super) fn extent(&self, axis: usize) -> (Q, Q) {
        let along = || self.vertices.iter().map(|v| v.components()[axis].clone());
        (along().min().unwrap_or_else(Q::zero), along().max().unwrap_or_else(Q::zero))
    }
}

/// Where a point is with respect to an edge's line.
pub(super) struct AgainstLine<Q> {
    /// `x − p`
    pub(super) from_p: Vec3<Q>,
    /// `(x − p)·d`: between 0 and `|d|²` when the foot lies inside the edge.
    pub(super) along: Q,
    /// `|(x − p) × d|²`: the squared distance from the line, times `|d|²`.
    pub(super) beside_squared: Q,
}

/// r_x² of SPEC section 4: s² under `classic`; under `revised` the smaller of r² and λ² times the squared size.
fn bounded_radius<Q: Rational>(limits: &SquaredTolerances<Q>, size_squared: Option<Q>) -> Q {
    match (limits.criteria, size_squared) {
        (Criteria::Classic, _) | (_, None) => limits.search_squared.clone(),
        (Criteria::Revised, Some(size_squared)) => {
            let inverse = Q::from_integer(LAMBDA_INVERSE * LAMBDA_INVERSE);
            let share = size_squared.over(&inverse).unwrap_or_else(Q::zero);
            share.min(limits.territory_squared.clone())
        }
    }
}

fn face<Q: Rational>(vertices: &[Vec3<Q>], boundary: &[VertexId]) -> Face<Q> {
    let at = |k: usize| &vertices[boundary[k % boundary.len()].index()];
    let zero = || Vec3::new(Q::zero(), Q::zero(), Q::zero());
    let normal = (0..boundary.len())
        .map(|k| cross(&difference(at(k), at(0)), &difference(at(k + 1), at(0))))
        .fold(zero(), |total, term| sum(&total, &term));
    let total = (0..boundary.len()).fold(zero(), |total, k| sum(&total, at(k)));
    let count = Q::from_integer(boundary.len() as i32);
    let share = Q::from_integer(1).over(&count).unwrap_or_else(Q::zero);
    Face { normal, point: multiple(&share, &total) }
}

fn line<Q: Rational>(vertices: &[Vec3<Q>], edge: &Edge, faces: &[Face<Q>], loops: &[Vec<VertexId>]) -> EdgeLine<Q> {
    let p = &vertices[edge.p.index()];
    let direction = difference(&vertices[edge.q.index()], p);
    let length_squared = squared_length(&direction);
    let width_squared = [edge.left, edge.right].map(|f| {
        let beside = loops[f.index()]
            .iter()
            .map(|&v| squared_length(&cross(&difference(&vertices[v.index()], p), &direction)))
            .max();
        beside.and_then(|b| b.over(&length_squared)).unwrap_or_else(Q::zero)
    });
    let inward = [
        cross(&faces[edge.left.index()].normal, &direction),
        cross(&faces[edge.right.index()].normal, &opposite(&direction)),
    ];
    EdgeLine { direction, length_squared, inward, width_squared }
}
