//! Gaps of entrance planes, their limits and their order.

use super::*;
use crate::field::DoubleBall;
use crate::number::{Ball, Bound};

/// The gap of a plane, unnormalised: `P = h·√Q`.
///
/// v-f: `P = N·(k a − Σ v_k)`, `Q = k²|N|²`, k the loop's length; f-v with the roles exchanged. e-e: `P = n·(p_A − p_B)`
/// and `Q = |n|²` with `n = d₁ × d₂`; its sign still wants σ.
pub(crate) fn plane<V: View>(view: &V, entrance: &Entrance) -> (V::T, V::T) {
    match *entrance {
        Entrance::VertexFace(vertex, face) => face_plane(view, (Side::A, vertex), (Side::B, face)),
        Entrance::FaceVertex(face, vertex) => face_plane(view, (Side::B, vertex), (Side::A, face)),
        Entrance::EdgeEdge(edge_a, edge_b) => edges_plane(view, edge_a, edge_b),
    }
}

/// `P` and `Q` of the plane of two edges.
#[inline(always)]
pub(crate) fn edges_plane<V: View>(view: &V, edge_a: EdgeId, edge_b: EdgeId) -> (V::T, V::T) {
    let n = across(view, edge_a, edge_b);
    let (a, b) = (start(view, (Side::A, edge_a)), start(view, (Side::B, edge_b)));
    (n.dot(&view.between(b, a)), n.norm_squared())
}

#[inline(always)]
fn face_plane<V: View>(view: &V, vertex: Vertex, face: Face) -> (V::T, V::T) {
    (plane_value(view, vertex, face), face_plane_size(view, face))
}

#[inline(always)]
fn face_plane_size<V: View>(view: &V, face: Face) -> V::T {
    view.loop_length(face.0, face.1).squared().times(&view.normal(face.0, face.1).norm_squared())
}

/// `P` of the plane of a face.
#[inline(always)]
pub(crate) fn plane_value<V: View>(view: &V, vertex: Vertex, face: Face) -> V::T {
    let n = view.normal(face.0, face.1);
    let count = view.loop_length(face.0, face.1);
    let first = (face.0, view.first_corner(face.0, face.1));
    n.dot(&view.between(first, vertex).scaled(&count).minus(&view.centre(face.0, face.1)))
}

/// `N·(k v − Σ v_k)`: positive outside the face's plane.
pub(crate) struct AbovePlane {
    pub(crate) vertex: Vertex,
    pub(crate) face: Face,
}

impl AbovePlane {
    /// The variant of all faces of the block on `side`.
    #[inline(always)]
    pub(crate) fn variant_of(side: Side) -> usize {
        side_of(side)
    }
}

impl Polynomial for AbovePlane {
    const FIRST_SLOT: usize = after::<FootBeyondVertex>();
    const VARIANTS: usize = 2;
    const DEGREE: usize = 3;
    #[inline(always)]
    fn variant(&self) -> usize {
        AbovePlane::variant_of(self.face.0)
    }
    #[inline(always)]
    fn value<V: View>(&self, view: &V) -> V::T {
        plane_value(view, self.vertex, self.face)
    }
}

/// `limit²·Q − P²`: at least zero where the gap's size is within the limit.
pub(crate) struct GapWithin {
    pub(crate) entrance: Entrance,
    pub(crate) limit: LengthTolerance,
}

impl GapWithin {
    /// The variant of all gaps of this kind of entrance.
    #[inline(always)]
    pub(crate) fn variant_of(kind: EntranceKind, limit: LengthTolerance) -> usize {
        kind as usize * 3 + limit as usize
    }
}

impl Polynomial for GapWithin {
    const FIRST_SLOT: usize = after::<AbovePlane>();
    const VARIANTS: usize = 9;
    const DEGREE: usize = 6;
    // Limits are chosen to be the gaps that there are, rounded.
    const IN_DOUBLE: bool = true;
    const DENOMINATOR: Denominator = Denominator::UnitSquared;
    #[inline(always)]
    fn variant(&self) -> usize {
        GapWithin::variant_of(self.entrance.kind(), self.limit)
    }
    #[inline(always)]
    fn value<V: View>(&self, view: &V) -> V::T {
        let (p, q) = plane(view, &self.entrance);
        let limit = self.limit.of(view).squared().times(&q);
        limit.minus(&view.scales().unit.squared().times(&p.squared()))
    }
}

/// `n·(p_A − p_B)` with `n = d₁ × d₂`: the gap of two edges before σ.
pub(crate) struct EdgesApart {
    pub(crate) edge_a: EdgeId,
    pub(crate) edge_b: EdgeId,
}

impl Polynomial for EdgesApart {
    const FIRST_SLOT: usize = after::<WedgeDipDepth>();
    const VARIANTS: usize = 1;
    const DEGREE: usize = 3;
    #[inline(always)]
    fn variant(&self) -> usize {
        0
    }
    #[inline(always)]
    fn value<V: View>(&self, view: &V) -> V::T {
        let (a, b) = (start(view, (Side::A, self.edge_a)), start(view, (Side::B, self.edge_b)));
        across(view, self.edge_a, self.edge_b).dot(&view.between(b, a))
    }
}

/// What the second gap of a comparison is multiplied by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Factor {
    One,
    OneMinusEqual,
    OnePlusEqual,
}

impl Factor {
    fn of<T: Ring>(self, scales: &Scales<T>) -> T {
        match self {
            Factor::One => scales.whole.clone(),
            Factor::OneMinusEqual => scales.whole.minus(&scales.equal),
            Factor::OnePlusEqual => scales.whole.plus(&scales.equal),
        }
    }
}

/// `P₁²Q₂ − f²P₂²Q₁`: compares the sizes of two gaps, the second multiplied by f.
pub(crate) struct LargerGap {
    pub(crate) first: Entrance,
    pub(crate) second: Entrance,
    pub(crate) factor: Factor,
}

impl Polynomial for LargerGap {
    const FIRST_SLOT: usize = after::<EdgesApart>();
    const VARIANTS: usize = 27;
    const DEGREE: usize = 10;
    const DENOMINATOR: Denominator = Denominator::WholeSquared;
    // Planes of neighbouring features have gaps that are nearly the same.
    const IN_PLANES: bool = true;
    const IN_DOUBLE: bool = true;
    fn variant(&self) -> usize {
        (kind_of(&self.first) * 3 + kind_of(&self.second)) * 3 + self.factor as usize
    }
    fn value<V: View>(&self, view: &V) -> V::T {
        self.of_planes(plane(view, &self.first), plane(view, &self.second), view.scales())
    }
    fn ties_with(&self, tolerances: &ToleranceSet) -> Option<EqualGaps> {
        let factor_is_one = self.factor == Factor::One || tolerances.equal.is_zero();
        factor_is_one.then_some(EqualGaps { first: self.first, second: self.second })
    }
    fn value_of_planes<T: Ring>(&self, plane: impl Fn(&Entrance) -> (T, T), scales: &Scales<T>) -> Option<T> {
        Some(self.of_planes(plane(&self.first), plane(&self.second), scales))
    }
    fn error_by_parts(&self, parts: &Parts<'_, '_, '_>) -> Option<f64> {
        Some(
            self.of_planes(bounds_of_plane(parts, &self.first), bounds_of_plane(parts, &self.second), &parts.scales())
                .error,
        )
    }
}

impl LargerGap {
    #[inline(always)]
    fn of_planes<T: Ring>(&self, (p1, q1): (T, T), (p2, q2): (T, T), scales: &Scales<T>) -> T {
        let whole = scales.whole.squared();
        let factor = self.factor.of(scales).squared();
        whole.times(&p1.squared().times(&q2)).minus(&factor.times(&p2.squared().times(&q1)))
    }
}

/// `P` and `Q` of a plane as balls of f64, of an n in balls of two: P is a small difference of large products, and f64 has few of its digits.
pub(crate) fn sharp_plane<V: View<T = DoubleBall>>(view: &V, entrance: &Entrance) -> (Ball, Ball) {
    let (n, w, count) = terms(view, entrance);
    let size = n.map(DoubleBall::as_ball).norm_squared();
    (n.dot(&w).as_ball(), count.as_ball().squared().times(&size))
}

/// `P` and `Q` of a plane as parts of a value.
#[inline]
fn bounds_of_plane(parts: &Parts<'_, '_, '_>, entrance: &Entrance) -> (Bound, Bound) {
    let size = parts.of(&PlaneSize { entrance: *entrance });
    let height = match *entrance {
        Entrance::VertexFace(vertex, face) => {
            parts.of(&AbovePlane { vertex: (Side::A, vertex), face: (Side::B, face) })
        }
        Entrance::FaceVertex(face, vertex) => {
            parts.of(&AbovePlane { vertex: (Side::B, vertex), face: (Side::A, face) })
        }
        Entrance::EdgeEdge(edge_a, edge_b) => parts.of(&EdgesApart { edge_a, edge_b }),
    };
    (height, size)
}

/// `Q` of a plane, a part of [`LargerGap`] by which none is decided.
pub(crate) struct PlaneSize {
    pub(crate) entrance: Entrance,
}

impl Polynomial for PlaneSize {
    const FIRST_SLOT: usize = after::<EdgeAlongNormal>();
    const VARIANTS: usize = 3;
    const DEGREE: usize = 4;
    const WITHIN_BLOCKS: bool = true;
    #[inline(always)]
    fn variant(&self) -> usize {
        kind_of(&self.entrance)
    }
    #[inline(always)]
    fn value<V: View>(&self, view: &V) -> V::T {
        match self.entrance {
            Entrance::VertexFace(_, face) => face_plane_size(view, (Side::B, face)),
            Entrance::FaceVertex(face, _) => face_plane_size(view, (Side::A, face)),
            Entrance::EdgeEdge(edge_a, edge_b) => across(view, edge_a, edge_b).norm_squared(),
        }
    }
}

/// A proof that two gaps are the same, in numbers of fewer digits than those of [`LargerGap`]: their planes are parallel.
pub(crate) struct EqualGaps {
    pub(crate) first: Entrance,
    pub(crate) second: Entrance,
}

impl EqualGaps {
    /// The degree of the first three values; the others have one less.
    pub(crate) const DEGREE: usize = 4;

    /// With `P = n·w`, `Q = k²|n|²` of each plane: the components of `n₁ × n₂`, and `n₁·(k₂w₁ − k₁w₂)` and `n₁·(k₂w₁ + k₁w₂)`.
    ///
    /// Where the first three are zero, one normal is zero, and so are its P and Q, or `n₂ = c·n₁`, and then
    /// `P₁²Q₂ − P₂²Q₁ = c²|n₁|²·((k₂ n₁·w₁)² − (k₁ n₁·w₂)²)` is zero with either of the last two.
    pub(crate) fn values<V: View>(&self, view: &V) -> ([V::T; 3], [V::T; 2]) {
        let ((n1, w1, k1), (n2, w2, k2)) = (terms(view, &self.first), terms(view, &self.second));
        let across = n1.cross(&n2);
        let (first, second) = (n1.dot(&w1.scaled(&k2)), n1.dot(&w2.scaled(&k1)));
        ([across.x, across.y, across.z], [first.minus(&second), first.plus(&second)])
    }
}

/// The n, w and k of a plane: `P = n·w`, `Q = k²|n|²`.
fn terms<V: View>(view: &V, entrance: &Entrance) -> (Vec3<V::T>, Vec3<V::T>, V::T) {
    let of_face = |vertex: Vertex, face: Face| {
        let count = view.loop_length(face.0, face.1);
        let first = (face.0, view.first_corner(face.0, face.1));
        let from_face = view.between(first, vertex).scaled(&count).minus(&view.centre(face.0, face.1));
        (view.normal(face.0, face.1), from_face, count)
    };
    match *entrance {
        Entrance::VertexFace(vertex, face) => of_face((Side::A, vertex), (Side::B, face)),
        Entrance::FaceVertex(face, vertex) => of_face((Side::B, vertex), (Side::A, face)),
        Entrance::EdgeEdge(edge_a, edge_b) => {
            let (a, b) = (start(view, (Side::A, edge_a)), start(view, (Side::B, edge_b)));
            (across(view, edge_a, edge_b), view.between(b, a), V::T::from_i32(1))
        }
    }
}
