//! "Cone passes plane": the edges at a vertex against a face.

use super::*;
use rockproof_model::Sign;

/// `e·N`, e an edge at the vertex, away from it: negative where the edge dips below the face's plane.
pub(crate) struct EdgeAbovePlane {
    pub(crate) vertex: Vertex,
    pub(crate) edge: EdgeId,
    pub(crate) face: Face,
}

impl Polynomial for EdgeAbovePlane {
    const FIRST_SLOT: usize = after::<NormalComponent>();
    const VARIANTS: usize = 2;
    const DEGREE: usize = 3;
    const WITHIN_BLOCKS: bool = true;
    #[inline(always)]
    fn variant(&self) -> usize {
        side_of(self.face.0)
    }
    #[inline(always)]
    fn value<V: View>(&self, view: &V) -> V::T {
        away(view, (self.vertex.0, self.edge), self.vertex.1).dot(&view.normal(self.face.0, self.face.1))
    }
    #[inline(always)]
    fn as_edge_along_normal(&self, pair: &Pair<'_>) -> Option<AsEdgeAlongNormal> {
        let starts_here = pair.prepared(self.vertex.0).edges[self.edge.index()].ends.0 == self.vertex.1;
        let turn = if starts_here { Sign::Positive } else { Sign::Negative };
        Some(AsEdgeAlongNormal { edge: (self.vertex.0, self.edge), face: self.face, turn, in_plane: None })
    }
}

/// `so²|e|²|N|² − (e·N)²`
pub(crate) struct EdgeDipAngle {
    pub(crate) edge: Edge,
    pub(crate) face: Face,
}

impl Polynomial for EdgeDipAngle {
    const FIRST_SLOT: usize = after::<EdgeAbovePlane>();
    const VARIANTS: usize = 2;
    const DEGREE: usize = 6;
    const WITHIN_BLOCKS: bool = true;
    const DENOMINATOR: Denominator = Denominator::OneSquared;
    fn variant(&self) -> usize {
        side_of(self.face.0)
    }
    fn value<V: View>(&self, view: &V) -> V::T {
        let (e, n) = (view.direction(self.edge.0, self.edge.1), view.normal(self.face.0, self.face.1));
        let scales = view.scales();
        let allowed = scales.overlap.squared().times(&e.norm_squared()).times(&n.norm_squared());
        allowed.minus(&scales.one.squared().times(&e.dot(&n).squared()))
    }
}

/// `limit²|N|² − (e·N)²`
pub(crate) struct EdgeDipDepth {
    pub(crate) edge: Edge,
    pub(crate) face: Face,
    pub(crate) limit: DipLimit,
}

impl Polynomial for EdgeDipDepth {
    const FIRST_SLOT: usize = after::<EdgeDipAngle>();
    const VARIANTS: usize = 4;
    const DEGREE: usize = 6;
    const WITHIN_BLOCKS: bool = true;
    const DENOMINATOR: Denominator = Denominator::UnitSquared;
    fn variant(&self) -> usize {
        side_of(self.face.0) * 2 + self.limit as usize
    }
    fn value<V: View>(&self, view: &V) -> V::T {
        let (e, n) = (view.direction(self.edge.0, self.edge.1), view.normal(self.face.0, self.face.1));
        let (limit, unit) = self.limit.squared(view.scales());
        limit.times(&n.norm_squared()).minus(&unit.times(&e.dot(&n).squared()))
    }
}

/// A sign is that of [`EdgeAlongNormal`] of `edge` and `face` times `turn`, provided that `in_plane` lies in the plane of `face`; in any case it is that of
/// `|d|²(e·N) − (d·N)(d·e)` times `turn`, e the direction of `edge` and d that of `in_plane`.
pub(crate) struct AsEdgeAlongNormal {
    pub(crate) edge: Edge,
    pub(crate) face: Face,
    pub(crate) turn: Sign,
    /// An edge of `face` that must be no point and lie in its plane; `None` where the sign is that in any case.
    pub(crate) in_plane: Option<Edge>,
}

/// `d·N` of any edge and any face: zero where the edge is parallel to the face's plane.
pub(crate) struct EdgeAlongNormal {
    pub(crate) edge: Edge,
    pub(crate) face: Face,
}

impl Polynomial for EdgeAlongNormal {
    const FIRST_SLOT: usize = after::<NormalsWithin>();
    const VARIANTS: usize = 4;
    const DEGREE: usize = 3;
    const WITHIN_BLOCKS: bool = true;
    fn variant(&self) -> usize {
        side_of(self.edge.0) * 2 + side_of(self.face.0)
    }
    fn value<V: View>(&self, view: &V) -> V::T {
        view.direction(self.edge.0, self.edge.1).dot(&view.normal(self.face.0, self.face.1))
    }
}
