//! Test 4: crossing e-e, and the plane that two edges span.

use crate::contact::contact_rules::ContactRules;
use crate::contact::entrance::Candidate;
use crate::contact::nearby_features::Planes;
use crate::contact::pair::Pair;
use crate::contact::prepared_block::FaceOfEdge;
use crate::contact::trace::Observer;
use crate::real::Real;
use crate::vector::Vector;
use rockproof_model::decision::{Feature, Predicate, Side};
use rockproof_model::{ContactKey, EdgeId};

/// Two edges that cross.
#[derive(Clone, Copy, Debug)]
pub(super) struct Crossing<R> {
    /// The unit vectors' cross product `u₁ × u₂`; its length is the sine between the edges.
    product: Vector<R>,
    sine: R,
}

impl<R: Real, M: ContactRules, O: Observer> Pair<'_, R, M, O> {
    /// Records the contact of edge `e` of A and edge `f` of B, if there is one.
    #[inline(always)]
    pub(super) fn edge_edge(&mut self, e: EdgeId, f: EdgeId, planes: Planes) {
        let Some(plane) = self.edges_meet(e, f) else { return };
        if planes.meets || self.wedges_pass(e, f, plane.normal) && !self.ends_belong(e, f) {
            self.record(ContactKey::EdgeEdge(e, f), Candidate { exits: planes.exits(), ..plane });
        }
    }

    /// The plane of two edges that cross, near one another and not too deep.
    #[inline(always)]
    pub(super) fn edges_meet(&mut self, e: EdgeId, f: EdgeId) -> Option<Candidate<R>> {
        let (one, two) = (self.a.edge(e), self.b.edge(f));
        if !M::edge_takes_part(one.convex) || !M::edge_takes_part(two.convex) {
            return None;
        }
        let crossing = self.crossing(e, f)?;
        let contact = ContactKey::EdgeEdge(e, f);
        let asked = contact.features();
        // t₁ = ((p₂ − p₁) × u₂)·(u₁ × u₂) / |u₁ × u₂|², t₂ likewise: the feet of the common perpendicular.
        let offset = two.p - one.p;
        let squared = crossing.sine * crossing.sine;
        let along_one = offset.cross(two.direction).dot(crossing.product) / squared;
        let along_two = offset.cross(one.direction).dot(crossing.product) / squared;
        let inside = M::feet_inside(along_one, one.length) && M::feet_inside(along_two, two.length);
        if !self.ask(Predicate::FeetInside, &asked, inside) {
            return None;
        }
        let normal = self.normal(e, f, crossing);
        let gap = normal.dot(one.p - two.p);
        let meets = self.ask(Predicate::EdgeEdgeNear, &asked, M::edge_edge_near(gap, self.t.search))
            && self.edge_edge_depth(contact, gap);
        meets.then(|| Candidate::edge_edge(e, f, gap, normal))
    }

    /// Not too deep: the gap is at least −g, or the contact is kept.
    fn edge_edge_depth(&mut self, contact: ContactKey, gap: R) -> bool {
        let allowed = M::edge_edge_depth(gap, self.t.penetration) || self.is_kept(contact);
        self.ask(Predicate::EdgeEdgeDepth, &contact.features(), allowed)
    }

    /// The edges' cross product, unless they are nearly parallel.
    #[inline(always)]
    pub(super) fn crossing(&mut self, e: EdgeId, f: EdgeId) -> Option<Crossing<R>> {
        let (one, two) = (self.a.edge(e), self.b.edge(f));
        let product = one.direction.cross(two.direction);
        let sine = product.length();
        let parallel = M::nearly_parallel(sine, one.length, two.length, self.t);
        let asked = [Feature::Edge(Side::A, e), Feature::Edge(Side::B, f)];
        (!self.ask(Predicate::NearlyParallel, &asked, parallel)).then_some(Crossing { product, sine })
    }

    /// The unit normal of the plane two crossing edges span, from B to A: σ·(d₁ × d₂) over its length.
    pub(super) fn normal(&self, e: EdgeId, f: EdgeId, crossing: Crossing<R>) -> Vector<R> {
        let unit = crossing.product / crossing.sine;
        let lean = unit.dot(self.a.lean(e)) - unit.dot(self.b.lean(f));
        if M::sigma_is_positive(lean) { unit } else { -unit }
    }

    /// A's two faces at the edge are above the plane and B's below, within the tolerance.
    pub(super) fn wedges_pass(&mut self, e: EdgeId, f: EdgeId, normal: Vector<R>) -> bool {
        let (one, two) = (self.a, self.b);
        let passes = FaceOfEdge::BOTH
            .into_iter()
            .all(|k| M::wedge_of_a_passes(normal.dot(one.into_face(e, k)), one.widths(e)[k as usize], self.t))
            && FaceOfEdge::BOTH
                .into_iter()
                .all(|k| M::wedge_of_b_passes(normal.dot(two.into_face(f, k)), two.widths(f)[k as usize], self.t));
        self.ask(Predicate::WedgesPass, &[Feature::Edge(Side::A, e), Feature::Edge(Side::B, f)], passes)
    }

    /// The plane of two edges is a true exit: their faces pass with the tolerance r/10.
    pub(super) fn wedges_exit(&self, e: EdgeId, f: EdgeId, normal: Vector<R>) -> bool {
        let (one, two) = (self.a, self.b);
        FaceOfEdge::BOTH
            .into_iter()
            .all(|k| M::true_exit_of_wedge_a(normal.dot(one.into_face(e, k)), one.widths(e)[k as usize], self.t))
            && FaceOfEdge::BOTH
                .into_iter()
                .all(|k| M::true_exit_of_wedge_b(normal.dot(two.into_face(f, k)), two.widths(f)[k as usize], self.t))
    }

    /// One of the four ends is in the territory of the other edge or of one of its ends.
    pub(super) fn ends_belong(&mut self, e: EdgeId, f: EdgeId) -> bool {
        let (one, two) = (self.a.edge(e).edge, self.b.edge(f).edge);
        if M::vertices_before_faces_and_edges() {
            for v in [one.p, one.q] {
                for w in [two.p, two.q] {
                    if self.in_vertex_territory(Side::A, v, w) {
                        return true;
                    }
                }
            }
        }
        M::edges_before_faces_and_edges()
            && (self.in_edge_territory(Side::A, one.p, f)
                || self.in_edge_territory(Side::A, one.q, f)
                || self.in_edge_territory(Side::B, two.p, e)
                || self.in_edge_territory(Side::B, two.q, e))
    }
}
