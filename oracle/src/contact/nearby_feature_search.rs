//! Finds the pairs of features of two blocks that can be in a contact while their vertices stay within a margin ([`super::nearby_features`]).
//!
//! Every coordinate is a ball with the margin for its radius, so the ball of a polynomial encloses its value wherever the vertices are. A pair of features is
//! left out if one of the tests of SPEC section 4 is certain to refuse it; what is not certain stays.

use super::entrance::Planes;
use super::nearby_features::NearbyPair;
use super::vertex_face::inward_of;
use crate::classification::{Classification, Observer};
use crate::number::{Ball, INFLATION, UNDERFLOW, UNIT_ROUNDOFF};
use crate::pair::Pair;
use crate::predicate::{
    AbovePlane, BeyondVertex, CommonFoot, DipLimit, Edge, EdgeAbovePlane, EdgeDipAngle, EdgeDipDepth, EdgesApart, Face,
    FootAlong, FootBeyondVertex, GapWithin, InwardAcross, InwardOf, LengthTolerance, Near, NearForEdge, NearLine,
    NearLineForHeight, Orientation, ParallelAngle, ParallelReach, Polynomial, Vertex, WedgeDipAngle, WedgeDipDepth,
};
use crate::view::{ExactBlock, ExactPair, ExactView, LazyScales, Scales, View};
use rockproof_model::decision::Side;
use rockproof_model::{ContactKey, EdgeId, Entrance, FaceId, Ring, Sign, VertexId};
use std::cell::OnceCell;

impl<O: Observer> Classification<'_, '_, O> {
    /// The pairs of features that can be in a contact while every coordinate is within `margin` of where it is now, and what is rounded besides.
    pub(super) fn find_nearby_features(&mut self, margin: f64) -> Vec<NearbyPair> {
        let (a, b) = (self.pair.a, self.pair.b);
        let off = 2.0 * (a.errors.coordinate + b.errors.coordinate);
        let radius = (margin + off) * (1.0 + 1e-9);
        // The boxes of features as they are now: both sides may move.
        let distance = self.culling_distances().contact + 4.0 * radius;
        let search = Search::new(self.pair, radius, balls(self), self.classic);
        let mut found = Vec::new();
        let pair = self.pair;
        let vertices = |side: Side| pair.topology(side).vertex_ids();
        let edges = |side: Side| pair.topology(side).edge_ids();
        for v in vertices(Side::A) {
            for w in vertices(Side::B) {
                if !self.vertices_out_of_reach(v, w, distance)
                    && let Some(planes) = search.vertices_may_meet(v, w)
                {
                    found.push(NearbyPair { key: ContactKey::VertexVertex(v, w), planes });
                }
            }
        }
        for side in [Side::A, Side::B] {
            for v in vertices(side) {
                for e in edges(side.other()) {
                    if !self.vertex_out_of_reach_of_edge((side, v), e, distance)
                        && let Some(planes) = search.vertex_may_meet_edge((side, v), (side.other(), e))
                    {
                        let key = match side {
                            Side::A => ContactKey::VertexEdge(v, e),
                            Side::B => ContactKey::EdgeVertex(e, v),
                        };
                        found.push(NearbyPair { key, planes });
                    }
                }
            }
            for v in vertices(side) {
                for f in pair.topology(side.other()).face_ids() {
                    if search.vertex_may_meet_face((side, v), (side.other(), f)) {
                        let key = match side {
                            Side::A => ContactKey::VertexFace(v, f),
                            Side::B => ContactKey::FaceVertex(f, v),
                        };
                        found.push(NearbyPair { key, planes: Planes::ALL });
                    }
                }
            }
        }
        for e in edges(Side::A) {
            for f in edges(Side::B) {
                if !self.edges_out_of_reach(e, f, distance) && search.edges_may_meet(e, f) {
                    found.push(NearbyPair { key: ContactKey::EdgeEdge(e, f), planes: Planes::ALL });
                }
            }
        }
        found
    }
}

/// The tolerances, and all that f64 rounds to the same.
fn balls<O: Observer>(run: &Classification<'_, '_, O>) -> Scales<Ball> {
    let mut scales = Scales::balls(run.tolerances);
    for tolerance in [
        &mut scales.search,
        &mut scales.territory,
        &mut scales.penetration,
        &mut scales.overlap,
        &mut scales.parallel,
        &mut scales.equal,
    ] {
        tolerance.radius = tolerance.radius.max(tolerance.middle.abs() * UNIT_ROUNDOFF * INFLATION + UNDERFLOW);
    }
    scales
}

/// Two blocks, the vertices of which may be anywhere within a radius.
struct Search<'p, 's> {
    pair: &'p Pair<'s>,
    geometry: ExactPair<'s, Ball>,
    scales: OnceCell<Scales<Ball>>,
    classic: bool,
}

impl<'p, 's> Search<'p, 's> {
    fn new(pair: &'p Pair<'s>, radius: f64, scales: Scales<Ball>, classic: bool) -> Search<'p, 's> {
        let block = |side: Side| {
            let around = |middle: f64| Ball { middle, radius };
            let vertices = pair.prepared(side).vertices.iter().map(|v| v.map(|c| around(c.0)));
            ExactBlock::new(pair.topology(side), vertices.collect())
        };
        let geometry = ExactPair { a: block(Side::A), b: block(Side::B) };
        Search { pair, geometry, scales: OnceCell::from(scales), classic }
    }

    fn view(&self) -> ExactView<'_, 's, Ball> {
        // They are made already.
        ExactView { geometry: &self.geometry, scales: LazyScales { made: &self.scales, make: &Scales::none } }
    }

    /// The sign of a polynomial, if it is the same wherever the vertices are.
    fn sign(&self, polynomial: &impl Polynomial) -> Option<Sign> {
        polynomial.value(&self.view()).certain_sign()
    }

    fn negative(&self, polynomial: &impl Polynomial) -> bool {
        self.sign(polynomial).is_some_and(Sign::is_negative)
    }

    fn positive(&self, polynomial: &impl Polynomial) -> bool {
        self.sign(polynomial).is_some_and(Sign::is_positive)
    }

    fn at_most_zero(&self, polynomial: &impl Polynomial) -> bool {
        self.sign(polynomial).is_some_and(Sign::is_at_most_zero)
    }

    fn at_least_zero(&self, polynomial: &impl Polynomial) -> bool {
        self.sign(polynomial).is_some_and(Sign::is_at_least_zero)
    }

    fn vertex_is_convex(&self, vertex: Vertex) -> bool {
        self.pair.prepared(vertex.0).block.vertex_is_convex(vertex.1)
    }

    fn edge_is_convex(&self, edge: Edge) -> bool {
        self.pair.prepared(edge.0).block.edge_is_convex(edge.1)
    }

    /// Test 1, and its entrances that may pass; `None` where it certainly fails.
    fn vertices_may_meet(&self, a: VertexId, b: VertexId) -> Option<Planes> {
        let [one, other] = [(Side::A, a), (Side::B, b)];
        let outside = |point: Vertex, at: Vertex| {
            let edges = self.pair.topology(at.0).vertex_edges(at.1);
            edges.iter().any(|&edge| self.positive(&BeyondVertex { point, at, edge }))
        };
        let fails = !(self.vertex_is_convex(one) && self.vertex_is_convex(other))
            || self.negative(&Near { a, b, limit: LengthTolerance::Search })
            || (self.surely_outside_territory(a, b) && (outside(one, other) || outside(other, one)));
        if fails {
            return None;
        }
        let (at_a, at_b) = (self.pair.topology(Side::A), self.pair.topology(Side::B));
        let faces_of_b = at_b.vertex_faces(b).iter().map(|&face| self.cone_may_pass(one, (Side::B, face)));
        let faces_of_a = at_a.vertex_faces(a).iter().map(|&face| self.cone_may_pass(other, (Side::A, face)));
        let edges = at_a.vertex_edges(a).iter().flat_map(|&edge_a| {
            at_b.vertex_edges(b).iter().map(move |&edge_b| self.edges_may_be_entrance(edge_a, edge_b))
        });
        Planes::of(faces_of_b.chain(faces_of_a).chain(edges))
    }

    /// Whether two vertices, both convex, are certainly not in one another's territory.
    fn surely_outside_territory(&self, a: VertexId, b: VertexId) -> bool {
        if self.classic {
            return self.negative(&Near { a, b, limit: LengthTolerance::Search });
        }
        self.negative(&Near { a, b, limit: LengthTolerance::Territory })
            || [(Side::A, a), (Side::B, b)].into_iter().any(|(side, at)| {
                let edges = self.pair.topology(side).vertex_edges(at);
                edges.iter().any(|&edge| self.negative(&NearForEdge { a, b, edge: (side, edge) }))
            })
    }

    /// Whether they certainly are.
    fn surely_share_territory(&self, vertex: Vertex, other: VertexId) -> bool {
        let (a, b) = if vertex.0 == Side::A { (vertex.1, other) } else { (other, vertex.1) };
        if !(self.vertex_is_convex((Side::A, a)) && self.vertex_is_convex((Side::B, b))) {
            return false;
        }
        if self.classic {
            return self.at_least_zero(&Near { a, b, limit: LengthTolerance::Search });
        }
        self.at_least_zero(&Near { a, b, limit: LengthTolerance::Territory })
            && [(Side::A, a), (Side::B, b)].into_iter().all(|(side, at)| {
                let edges = self.pair.topology(side).vertex_edges(at);
                edges.iter().all(|&edge| self.at_least_zero(&NearForEdge { a, b, edge: (side, edge) }))
            })
    }

    /// Test 2, likewise.
    fn vertex_may_meet_edge(&self, vertex: Vertex, edge: Edge) -> Option<Planes> {
        let ends = *self.pair.topology(edge.0).edge(edge.1);
        let out_of_region = || {
            [false, true].into_iter().any(|right| self.positive(&InwardOf { vertex, edge, right })) || {
                let edges = self.pair.topology(vertex.0).vertex_edges(vertex.1);
                edges.iter().any(|&at_vertex| self.positive(&FootBeyondVertex { vertex, edge, at_vertex }))
            }
        };
        let fails = !(self.vertex_is_convex(vertex) && self.edge_is_convex(edge))
            || [false, true].into_iter().any(|from_end| self.at_most_zero(&FootAlong { vertex, edge, from_end }))
            || self.negative(&NearLine { vertex, edge, limit: LengthTolerance::Search })
            || self.surely_share_territory(vertex, ends.p)
            || self.surely_share_territory(vertex, ends.q)
            || (self.surely_beyond_edge_territory(vertex, edge) && out_of_region());
        if fails {
            return None;
        }
        let faces = [ends.left.min(ends.right), ends.left.max(ends.right)];
        let faces = faces.into_iter().map(|face| self.cone_may_pass(vertex, (edge.0, face)));
        let edges = self.pair.topology(vertex.0).vertex_edges(vertex.1).iter().map(|&own| match vertex.0 {
            Side::A => self.edges_may_be_entrance(own, edge.1),
            Side::B => self.edges_may_be_entrance(edge.1, own),
        });
        Planes::of(faces.chain(edges))
    }

    /// Whether a vertex is certainly farther from an edge's line than its territory reaches.
    fn surely_beyond_edge_territory(&self, vertex: Vertex, edge: Edge) -> bool {
        let limit = if self.classic { LengthTolerance::Search } else { LengthTolerance::Territory };
        self.negative(&NearLine { vertex, edge, limit })
            || !self.classic && {
                let ends = self.pair.topology(edge.0).edge(edge.1);
                [ends.left, ends.right].into_iter().any(|face| {
                    let beyond = |height_at| self.negative(&NearLineForHeight { vertex, edge, height_at });
                    self.beside(edge, face).all(beyond)
                })
            }
    }

    /// Whether a vertex is certainly in the territory of an edge.
    fn surely_in_edge_territory(&self, vertex: Vertex, edge: Edge) -> bool {
        if !(self.vertex_is_convex(vertex) && self.edge_is_convex(edge)) {
            return false;
        }
        let limit = if self.classic { LengthTolerance::Search } else { LengthTolerance::Territory };
        let ends = self.pair.topology(edge.0).edge(edge.1);
        self.at_least_zero(&NearLine { vertex, edge, limit })
            && [false, true].into_iter().all(|from_end| self.positive(&FootAlong { vertex, edge, from_end }))
            && (self.classic
                || [ends.left, ends.right].into_iter().all(|face| {
                    let within = |height_at| self.at_least_zero(&NearLineForHeight { vertex, edge, height_at });
                    self.beside(edge, face).any(within)
                }))
    }

    /// The corners of a face that are not on one of its edges.
    fn beside(&self, edge: Edge, face: FaceId) -> impl Iterator<Item = VertexId> + '_ {
        let topology = self.pair.topology(edge.0);
        let ends = *topology.edge(edge.1);
        topology.face(face).iter().copied().filter(move |&corner| corner != ends.p && corner != ends.q)
    }

    /// Test 3; `false` where it certainly fails.
    fn vertex_may_meet_face(&self, vertex: Vertex, face: Face) -> bool {
        let entrance = match vertex.0 {
            Side::A => Entrance::VertexFace(vertex.1, face.1),
            Side::B => Entrance::FaceVertex(face.1, vertex.1),
        };
        let beyond = |limit| self.negative(&GapWithin { entrance, limit });
        let too_far = match self.sign(&AbovePlane { vertex, face }) {
            Some(Sign::Positive) => beyond(LengthTolerance::Search),
            Some(Sign::Negative) => beyond(LengthTolerance::Penetration),
            _ => false,
        };
        let topology = self.pair.topology(face.0);
        let fails = too_far
            || self.surely_outside_face(vertex, face)
            || !self.cone_may_pass(vertex, face)
            || topology.face(face.1).iter().any(|&v| self.surely_share_territory(vertex, v))
            || topology.face_edges(face.1).iter().any(|&e| self.surely_in_edge_territory(vertex, (face.0, e)));
        !fails
    }

    /// Whether the projection of a vertex is certainly not inside a face that is certainly convex.
    fn surely_outside_face(&self, vertex: Vertex, face: Face) -> bool {
        let topology = self.pair.topology(face.0);
        let edges = topology.face_edges(face.1);
        let outside = |&edge: &EdgeId| self.at_most_zero(&inward_of(vertex, face, edge, topology));
        let turns_left = |k: usize| {
            let [here, next] = [edges[k], edges[(k + 1) % edges.len()]];
            let right = |edge: EdgeId| topology.edge(edge).right == face.1;
            let view = self.view();
            let along = view.inward(face.0, here, right(here)).dot(&view.direction(face.0, next));
            let turn = if right(next) { along.negated() } else { along };
            turn.certain_sign().is_some_and(Sign::is_positive)
        };
        edges.iter().any(outside) && (edges.len() == 3 || (0..edges.len()).all(turns_left))
    }

    /// Test 4, likewise.
    fn edges_may_meet(&self, edge_a: EdgeId, edge_b: EdgeId) -> bool {
        let [a, b] = [(Side::A, edge_a), (Side::B, edge_b)];
        let entrance = Entrance::EdgeEdge(edge_a, edge_b);
        let beyond = |limit| self.negative(&GapWithin { entrance, limit });
        let outside = |(on, from_end)| self.at_most_zero(&CommonFoot { edge_a, edge_b, on, from_end });
        let feet = [(Side::A, false), (Side::A, true), (Side::B, false), (Side::B, true)];
        if !(self.edge_is_convex(a) && self.edge_is_convex(b))
            || feet.into_iter().any(outside)
            || (beyond(LengthTolerance::Search) && beyond(LengthTolerance::Penetration))
        {
            return false;
        }
        let sigma = self.sigma(edge_a, edge_b);
        let too_far = match sigma.and_then(|sigma| Some(self.sign(&EdgesApart { edge_a, edge_b })?.times(sigma))) {
            Some(Sign::Positive) => beyond(LengthTolerance::Search),
            Some(Sign::Negative) => beyond(LengthTolerance::Penetration),
            _ => false,
        };
        if too_far || !self.edges_may_be_entrance(edge_a, edge_b) {
            return false;
        }
        let [ends_a, ends_b] = [a, b].map(|(side, edge)| *self.pair.topology(side).edge(edge));
        let ([p, q], [r, s]) = ([ends_a.p, ends_a.q], [ends_b.p, ends_b.q]);
        let vertices = [(p, r), (p, s), (q, r), (q, s)];
        let elsewhere = vertices.into_iter().any(|(v, w)| self.surely_share_territory((Side::A, v), w))
            || [p, q].into_iter().any(|end| self.surely_in_edge_territory((Side::A, end), b))
            || [r, s].into_iter().any(|end| self.surely_in_edge_territory((Side::B, end), a));
        !elsewhere
    }

    /// σ, where it is certain.
    fn sigma(&self, edge_a: EdgeId, edge_b: EdgeId) -> Option<Sign> {
        let sign = self.sign(&Orientation { edge_a, edge_b })?;
        Some(if sign.is_negative() { Sign::Negative } else { Sign::Positive })
    }

    /// Whether a face's plane may be an entrance for a vertex.
    fn cone_may_pass(&self, vertex: Vertex, face: Face) -> bool {
        let edges = self.pair.topology(vertex.0).vertex_edges(vertex.1);
        !edges.iter().any(|&edge| {
            let own = (vertex.0, edge);
            let limit = DipLimit::Penetration;
            self.negative(&EdgeAbovePlane { vertex, edge, face })
                && (self.negative(&EdgeDipAngle { edge: own, face })
                    || !self.classic && self.negative(&EdgeDipDepth { edge: own, face, limit }))
        })
    }

    /// Whether the plane of two edges may be an entrance.
    fn edges_may_be_entrance(&self, edge_a: EdgeId, edge_b: EdgeId) -> bool {
        let longer = |longer| self.at_least_zero(&ParallelReach { edge_a, edge_b, longer });
        if self.at_least_zero(&ParallelAngle { edge_a, edge_b }) && (self.classic || longer(Side::A) || longer(Side::B))
        {
            return false;
        }
        let Some(sigma) = self.sigma(edge_a, edge_b) else { return true };
        let fails = |side: Side, right: bool| {
            let inward = InwardAcross { edge_a, edge_b, side, right };
            let dips = if side == Side::A { Sign::Negative } else { Sign::Positive };
            self.sign(&inward).is_some_and(|sign| sign.times(sigma) == dips)
                && (self.negative(&WedgeDipAngle(inward)) || !self.classic && self.dips_too_deep(inward))
        };
        ![(Side::A, false), (Side::A, true), (Side::B, false), (Side::B, true)]
            .into_iter()
            .any(|(side, right)| fails(side, right))
    }

    fn dips_too_deep(&self, inward: InwardAcross) -> bool {
        let InwardAcross { edge_a, edge_b, side, right } = inward;
        let own = if side == Side::A { edge_a } else { edge_b };
        let edge = self.pair.topology(side).edge(own);
        let face = if right { edge.right } else { edge.left };
        let limit = DipLimit::Penetration;
        self.beside((side, own), face).any(|corner| self.negative(&WedgeDipDepth { inward, corner, limit }))
    }
}
