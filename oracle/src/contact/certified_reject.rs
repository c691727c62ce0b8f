//! Certified rejects, before any predicate is evaluated: f64 proves that one of the tests to come says no, whichever it is; or that boxes
//! meet.
//!
//! Which test it would have been is lost, so nothing is rejected here while decisions are recorded. The values are
//! calculated as the polynomials of [`crate::predicate`] calculate theirs, operation by operation, so that the bounds of
//! those hold for them.

use super::vertex_face;
use crate::classification::{Classification, Observer};
use crate::number::Approx;
use crate::predicate::{
    AbovePlane, BoxesMeet, CommonFoot, GapWithin, LengthTolerance, Polynomial, edges_plane, plane_value,
};
use crate::view::View;
use rockproof_model::decision::Side;
use rockproof_model::{ContactKey, EdgeId, EntranceKind, FaceId, Ring, VertexId};

impl<O: Observer> Classification<'_, '_, O> {
    /// Whether a vertex is certainly too far above a face's plane, or too deep below (where the contact is not kept).
    #[inline(always)]
    pub(crate) fn vertex_face_certainly_fails(&mut self, vertex: (Side, VertexId), face: (Side, FaceId)) -> bool {
        if O::is_active() {
            return false;
        }
        let kind = match vertex.0 {
            Side::A => EntranceKind::VertexFace,
            Side::B => EntranceKind::FaceVertex,
        };
        let height = plane_value(&self.float_view(), vertex, face);
        let size = self.pair.solid(face.0).faces[face.1.index()].plane_size;
        let sign_bound = self.bound_of::<AbovePlane>(AbovePlane::variant_of(face.0));
        let limit = if height.0 > sign_bound {
            LengthTolerance::Search
        } else if height.0 < -sign_bound {
            LengthTolerance::Penetration
        } else {
            return false;
        };
        let fails = self.surely_beyond(kind, limit, height, size)
            && !(limit == LengthTolerance::Penetration && self.is_kept(vertex_face::contact_of(vertex, face)));
        self.ladder.levels.float += 2 * u64::from(fails);
        fails
    }

    /// Whether the feet of two edges' common perpendicular are certainly not inside, or the edges certainly too far apart
    /// either way (where the contact is not kept).
    #[inline(always)]
    pub(crate) fn edges_certainly_fail(&mut self, edge_a: EdgeId, edge_b: EdgeId) -> bool {
        if O::is_active() {
            return false;
        }
        let outside = |on, from_end| self.surely_negative(&CommonFoot { edge_a, edge_b, on, from_end });
        let fails =
            outside(Side::A, false) || outside(Side::A, true) || outside(Side::B, false) || outside(Side::B, true) || {
                let (apart, size) = edges_plane(&self.float_view(), edge_a, edge_b);
                let beyond = |limit| self.surely_beyond(EntranceKind::EdgeEdge, limit, apart, size);
                beyond(LengthTolerance::Search)
                    && beyond(LengthTolerance::Penetration)
                    && !self.is_kept(ContactKey::EdgeEdge(edge_a, edge_b))
            };
        self.ladder.levels.float += u64::from(fails);
        fails
    }

    /// Whether the boxes, A's grown by s, certainly meet.
    #[inline(always)]
    pub(crate) fn surely_neighbours(&mut self) -> bool {
        if O::is_active() {
            return false;
        }
        let (a, b, search) = (self.pair.a, self.pair.b, self.float_view().scales().search.0);
        let bound = self.bound_of::<BoxesMeet>(0);
        let meet = (0..3)
            .all(|k| search - (b.box_min[k] - a.box_max[k]) > bound && search - (a.box_min[k] - b.box_max[k]) > bound);
        self.ladder.levels.float += 6 * u64::from(meet);
        meet
    }

    /// Whether f64 proves that a polynomial is negative.
    #[inline(always)]
    fn surely_negative<P: Polynomial>(&self, polynomial: &P) -> bool {
        polynomial.value(&self.float_view()).0 < -self.bound_of::<P>(polynomial.variant())
    }

    /// Whether f64 proves that a gap, as [`crate::predicate::plane`] gives it, is larger than a limit, whatever its sign.
    #[inline(always)]
    fn surely_beyond(&self, kind: EntranceKind, limit: LengthTolerance, height: Approx, size: Approx) -> bool {
        let view = self.float_view();
        let allowed = limit.of(&view).squared().times(&size);
        let value = allowed.minus(&view.scales().unit.squared().times(&height.squared()));
        value.0 < -self.bound_of::<GapWithin>(GapWithin::variant_of(kind, limit))
    }
}
