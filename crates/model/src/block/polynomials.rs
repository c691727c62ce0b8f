//! The questions about one block of which every check of SPEC section 2 is made.

use crate::block::certain_sign::{BlockPolynomial, CoordinateView, PointPolynomial};
use crate::ring::Ring;
use crate::topology::{FaceId, VertexId};
use crate::vector::Vec3;

fn point<'a, T>(view: &CoordinateView<'a, T>, vertex: VertexId) -> &'a Vec3<T> {
    &view.points[vertex.index()]
}

/// `|N|²` of a face: zero when it has no area.
pub(super) struct Area {
    pub(super) face: usize,
}

impl BlockPolynomial for Area {
    fn value<T: Ring>(&self, view: &CoordinateView<'_, T>) -> T {
        view.normals[self.face].norm_squared()
    }
}

/// κ of SPEC section 2: positive convex, negative reflex, zero flat or folded. The edge runs p → q in `left`.
pub(super) struct EdgeConvexity {
    pub(super) p: VertexId,
    pub(super) q: VertexId,
    pub(super) left: FaceId,
    pub(super) right: FaceId,
}

impl BlockPolynomial for EdgeConvexity {
    fn value<T: Ring>(&self, view: &CoordinateView<'_, T>) -> T {
        let d = point(view, self.q).minus(point(view, self.p));
        view.normals[self.left.index()].cross(&view.normals[self.right.index()]).dot(&d)
    }
}

/// `N_L · N_R`: positive when two faces look to the same side.
pub(super) struct SameSide {
    pub(super) left: FaceId,
    pub(super) right: FaceId,
}

impl BlockPolynomial for SameSide {
    fn value<T: Ring>(&self, view: &CoordinateView<'_, T>) -> T {
        view.normals[self.left.index()].dot(&view.normals[self.right.index()])
    }
}

/// Distance of any vertex from the plane through `through` along the normal of `face`, times `|N|`.
pub(super) struct Height {
    pub(super) face: usize,
    pub(super) through: VertexId,
    pub(super) vertex: VertexId,
}

impl BlockPolynomial for Height {
    fn value<T: Ring>(&self, view: &CoordinateView<'_, T>) -> T {
        view.normals[self.face].dot(&point(view, self.vertex).minus(point(view, self.through)))
    }
}

/// Seen against the face's normal: positive when c is to the left of the line from a to b.
pub(super) struct Orientation {
    pub(super) face: usize,
    pub(super) a: VertexId,
    pub(super) b: VertexId,
    pub(super) c: VertexId,
}

impl BlockPolynomial for Orientation {
    fn value<T: Ring>(&self, view: &CoordinateView<'_, T>) -> T {
        let a = point(view, self.a);
        let along = point(view, self.b).minus(a);
        along.cross(&point(view, self.c).minus(a)).dot(&view.normals[self.face])
    }
}

/// `(a − c)·(b − c)` of the projections along the face's normal: negative or zero when c, on the line through a and b,
/// is between them.
pub(super) struct Between {
    pub(super) face: usize,
    pub(super) a: VertexId,
    pub(super) b: VertexId,
    pub(super) c: VertexId,
}

impl BlockPolynomial for Between {
    fn value<T: Ring>(&self, view: &CoordinateView<'_, T>) -> T {
        let (c, normal) = (point(view, self.c), &view.normals[self.face]);
        let to_a = point(view, self.a).minus(c).cross(normal);
        to_a.dot(&point(view, self.b).minus(c).cross(normal))
    }
}

/// `|(v − a) × (b − a)|²`: zero when v is on the line through a and b.
pub(super) struct OffLine {
    pub(super) a: VertexId,
    pub(super) v: VertexId,
    pub(super) b: VertexId,
}

impl BlockPolynomial for OffLine {
    fn value<T: Ring>(&self, view: &CoordinateView<'_, T>) -> T {
        let a = point(view, self.a);
        point(view, self.v).minus(a).cross(&point(view, self.b).minus(a)).norm_squared()
    }
}

/// `(v − a)·(b − v)`: positive when v is between a and b.
pub(super) struct BeyondAlongLine {
    pub(super) a: VertexId,
    pub(super) v: VertexId,
    pub(super) b: VertexId,
}

impl BlockPolynomial for BeyondAlongLine {
    fn value<T: Ring>(&self, view: &CoordinateView<'_, T>) -> T {
        let v = point(view, self.v);
        v.minus(point(view, self.a)).dot(&point(view, self.b).minus(v))
    }
}

/// `|b − a|²`.
pub(super) struct SquaredLength {
    pub(super) a: VertexId,
    pub(super) b: VertexId,
}

impl BlockPolynomial for SquaredLength {
    fn value<T: Ring>(&self, view: &CoordinateView<'_, T>) -> T {
        point(view, self.b).minus(point(view, self.a)).norm_squared()
    }
}

/// What one face adds to six times the volume: `N · v`, v the first vertex of its loop.
pub(super) struct VolumeShare {
    pub(super) face: usize,
}

impl BlockPolynomial for VolumeShare {
    fn value<T: Ring>(&self, view: &CoordinateView<'_, T>) -> T {
        view.normals[self.face].dot(point(view, view.faces[self.face][0]))
    }
}

/// Six times the volume.
pub(super) struct Volume;

impl BlockPolynomial for Volume {
    fn value<T: Ring>(&self, view: &CoordinateView<'_, T>) -> T {
        (0..view.faces.len()).fold(T::from_i32(0), |sum, face| sum.plus(&VolumeShare { face }.value(view)))
    }
}

/// `((b − a) × (c − a))·(v − a)` of the plane through a, b, c: positive when v is on the side from which a, b, c run
/// counter-clockwise, zero when it is on the plane.
pub(super) struct SideOfPlane {
    pub(super) plane: [VertexId; 3],
    pub(super) vertex: VertexId,
}

impl PointPolynomial for SideOfPlane {
    fn value<T: Ring>(&self, points: &[Vec3<T>]) -> T {
        let [a, b, c] = self.plane.map(|v| &points[v.index()]);
        b.minus(a).cross(&c.minus(a)).dot(&points[self.vertex.index()].minus(a))
    }
}

/// Of points in the plane of a triangle, seen from where its vertices run counter-clockwise: positive when c is to the
/// left of the line from a to b.
pub(super) struct OrientationInPlane {
    pub(super) triangle: [VertexId; 3],
    pub(super) a: VertexId,
    pub(super) b: VertexId,
    pub(super) c: VertexId,
}

impl PointPolynomial for OrientationInPlane {
    fn value<T: Ring>(&self, points: &[Vec3<T>]) -> T {
        let area = |[a, b, c]: [VertexId; 3]| {
            let a = &points[a.index()];
            points[b.index()].minus(a).cross(&points[c.index()].minus(a))
        };
        area(self.triangle).dot(&area([self.a, self.b, self.c]))
    }
}
