//! Certified rejects, before any predicate is evaluated: f64 proves that one of the tests to come says no, whichever it is; or that boxes
//! meet.
//!
//! Which test it would have been is lost, so nothing is rejected here while decisions are recorded. The values are
//! calculated as the polynomials of [`crate::predicate`] calculate theirs, operation by operation, so that the bounds of
//! those hold for them.

use super::vertex_face::{contact_of, inward_of};
use crate::classification::{Classification, Observer};
use crate::number::Approx;
use crate::predicate::{
    AbovePlane, BoxesMeet, CommonFoot, Face, GapWithin, InwardOf, LengthTolerance, Polynomial, Vertex, edges_plane,
};
use crate::prepared_block::PreparedFace;
use rockproof_model::decision::Side;
use rockproof_model::{ContactKey, EdgeId, EntranceKind, FaceId, Ring, Vec3};
use smallvec::SmallVec;

/// A face with what the gap of a vertex is held against.
pub(crate) struct FaceReject<'p> {
    pub(crate) face: FaceId,
    prepared: &'p PreparedFace,
    first: &'p Vec3<Approx>,
    /// Heights beyond this have a sign for certain.
    sign_bound: f64,
    /// The square of a height that is certainly beyond s, and beyond g.
    limits: [f64; 2],
}

/// What a vertex is in relation to a face, as far as f64 proves it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rejected {
    /// Nothing is proved.
    No,
    /// Too far above.
    Above,
    /// Too deep below, unless the contact is kept.
    Below,
}

impl FaceReject<'_> {
    /// Whether a vertex is certainly too far from the face's plane.
    #[inline(always)]
    pub(crate) fn test(&self, vertex: &Vec3<Approx>) -> Rejected {
        let FaceReject { prepared, first, sign_bound, limits: [search, penetration], .. } = self;
        let PreparedFace { normal, centre, count, .. } = prepared;
        let height = normal.dot(&vertex.minus(first).scaled(count).minus(centre)).0;
        let square = height * height;
        if height > *sign_bound && square > *search {
            Rejected::Above
        } else if height < -*sign_bound && square > *penetration {
            Rejected::Below
        } else {
            Rejected::No
        }
    }
}

/// What f64 proves before any predicate is evaluated of where a foot or a projection lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CertainPlace {
    /// Nothing.
    Unknown,
    /// Strictly inside: both feet of edges, the projection of a vertex.
    Inside,
    /// Outside, or there is no contact for another reason.
    Outside,
}

/// What values about two edges are held against.
pub(crate) struct EdgesReject {
    /// What the places of feet are off by, on A's edge and on B's.
    feet: [f64; 2],
    /// The square of a length beyond which a gap is too large either way, and what squares of gaps are off by.
    limit: f64,
    gap: f64,
}

impl<'s, O: Observer> Classification<'_, 's, O> {
    /// Adds the faces of the block on `side`.
    pub(crate) fn find_face_rejects(&self, side: Side, rejects: &mut SmallVec<[FaceReject<'s>; 8]>) {
        let prepared = self.pair.prepared(side);
        let kind = match side {
            Side::B => EntranceKind::VertexFace,
            Side::A => EntranceKind::FaceVertex,
        };
        let scales = self.float_view().scales;
        let limits = [(LengthTolerance::Search, scales.search), (LengthTolerance::Penetration, scales.penetration)]
            .map(|(limit, length)| {
                (length.squared().0, self.bound_of::<GapWithin>(GapWithin::variant_of(kind, limit)))
            });
        let sign_bound = self.bound_of::<AbovePlane>(AbovePlane::variant_of(side));
        let reject = |(face, of_block): (FaceId, &'s PreparedFace)| FaceReject {
            face,
            prepared: of_block,
            first: &prepared.vertices[of_block.first.index()],
            sign_bound,
            limits: limits.map(|(square, bound)| beyond(square * of_block.plane_size.0, bound)),
        };
        rejects.extend((0..).map(FaceId).zip(&prepared.faces).map(reject));
    }

    /// Whether a vertex is certainly too far above a face's plane, or too deep below (where the contact is not kept).
    #[inline(always)]
    pub(crate) fn certainly_fails(&mut self, reject: &FaceReject, at: &Vec3<Approx>, vertex: Vertex) -> bool {
        if O::is_active() {
            return false;
        }
        let fails = match reject.test(at) {
            Rejected::No => false,
            Rejected::Above => true,
            Rejected::Below => !self.is_kept(contact_of(vertex, (vertex.0.other(), reject.face))),
        };
        self.cascade.levels.float += 2 * u64::from(fails);
        fails
    }

    /// What edges are held against.
    pub(crate) fn edges_reject(&self) -> EdgesReject {
        let foot = |on| self.bound_of::<CommonFoot>(CommonFoot::variant_of(on));
        let gap = |limit| self.bound_of::<GapWithin>(GapWithin::variant_of(EntranceKind::EdgeEdge, limit));
        let scales = self.float_view().scales;
        EdgesReject {
            feet: [foot(Side::A), foot(Side::B)],
            limit: scales.search.squared().0.max(scales.penetration.squared().0),
            // Not `max`, which forgets what is not a number.
            gap: gap(LengthTolerance::Search) + gap(LengthTolerance::Penetration),
        }
    }

    /// Whether the feet of two edges' common perpendicular are certainly not inside, or the edges certainly too far apart
    /// either way (where the contact is not kept).
    #[inline(always)]
    pub(crate) fn edges_certainly_fail(
        &mut self,
        reject: &EdgesReject,
        edge_a: EdgeId,
        edge_b: EdgeId,
    ) -> CertainPlace {
        if O::is_active() {
            return CertainPlace::Unknown;
        }
        let feet = self.edges_fail(reject, edge_a, edge_b);
        self.cascade.levels.float += u64::from(feet == CertainPlace::Outside);
        feet
    }

    #[inline(always)]
    fn edges_fail(&self, reject: &EdgesReject, edge_a: EdgeId, edge_b: EdgeId) -> CertainPlace {
        let view = self.float_view();
        let (apart, size) = edges_plane(&view, edge_a, edge_b);
        if apart.0 * apart.0 > beyond(reject.limit * size.0, reject.gap)
            && !self.is_kept(ContactKey::EdgeEdge(edge_a, edge_b))
        {
            return CertainPlace::Outside;
        }
        let mut inside = true;
        for (on, bound) in [Side::A, Side::B].into_iter().zip(reject.feet) {
            for from_end in [false, true] {
                let along = CommonFoot { edge_a, edge_b, on, from_end }.value(&view).0;
                if along < -bound {
                    return CertainPlace::Outside;
                }
                inside &= along > bound;
            }
        }
        if inside { CertainPlace::Inside } else { CertainPlace::Unknown }
    }

    /// Where the projection of a vertex along the normal of a face lies, of faces that are certainly convex.
    #[inline(always)]
    pub(crate) fn place_in_face(&mut self, vertex: Vertex, face: Face) -> CertainPlace {
        if O::is_active() || !self.pair.prepared(face.0).faces[face.1.index()].surely_convex {
            return CertainPlace::Unknown;
        }
        let (view, topology) = (self.float_view(), self.pair.topology(face.0));
        let edges = topology.face_edges(face.1);
        let mut inside = true;
        for &edge in edges {
            let side = inward_of(vertex, face, edge, topology);
            let (value, bound) = (side.value(&view).0, self.bound_of::<InwardOf>(side.variant()));
            if value < -bound {
                self.cascade.levels.float += 1;
                return CertainPlace::Outside;
            }
            inside &= value > bound;
        }
        if !inside {
            return CertainPlace::Unknown;
        }
        self.cascade.levels.float += edges.len() as u64;
        CertainPlace::Inside
    }

    /// Whether the boxes, A's grown by s, certainly meet.
    #[inline(always)]
    pub(crate) fn surely_neighbours(&mut self) -> bool {
        if O::is_active() {
            return false;
        }
        let (a, b, search) = (self.pair.a, self.pair.b, self.float_view().scales.search.0);
        let bound = self.bound_of::<BoxesMeet>(0);
        let meet = (0..3)
            .all(|k| search - (b.box_min[k] - a.box_max[k]) > bound && search - (a.box_min[k] - b.box_max[k]) > bound);
        self.cascade.levels.float += 6 * u64::from(meet);
        meet
    }
}

/// What is larger is more than `value` by more than `bound`, but for the roundings in here.
#[inline(always)]
fn beyond(value: f64, bound: f64) -> f64 {
    (value + bound) * (1.0 + 4.0 * f64::EPSILON)
}
