//! On which side of a feature a vertex lies: vertex and edge regions, and the inside of a polygon.

use super::*;

/// `(point − at)·e`, e an edge at `at`, away from it: at most zero inside the vertex region.
pub(crate) struct BeyondVertex {
    pub(crate) point: Vertex,
    pub(crate) at: Vertex,
    pub(crate) edge: EdgeId,
}

impl Polynomial for BeyondVertex {
    const FIRST_SLOT: usize = after::<NearForEdge>();
    const VARIANTS: usize = 2;
    const DEGREE: usize = 2;
    #[inline(always)]
    fn variant(&self) -> usize {
        side_of(self.at.0)
    }
    #[inline(always)]
    fn value<V: View>(&self, view: &V) -> V::T {
        view.between(self.at, self.point).dot(&away(view, (self.at.0, self.edge), self.at.1))
    }
}

/// `(v − p)·m`: positive on the face's side of the edge, at most zero in the edge's region; also says on which side of
/// a polygon's edge the projection of v lies.
pub(crate) struct InwardOf {
    pub(crate) vertex: Vertex,
    pub(crate) edge: Edge,
    pub(crate) right: bool,
}

impl Polynomial for InwardOf {
    const FIRST_SLOT: usize = after::<NearLineForHeight>();
    const VARIANTS: usize = 2;
    const DEGREE: usize = 4;
    #[inline(always)]
    fn variant(&self) -> usize {
        side_of(self.edge.0)
    }
    #[inline(always)]
    fn value<V: View>(&self, view: &V) -> V::T {
        let m = view.inward(self.edge.0, self.edge.1, self.right);
        view.between(start(view, self.edge), self.vertex).dot(&m)
    }
}

/// `(f − v)·e |d|²`, f the foot of v on the edge and e an edge at v, away from it.
pub(crate) struct FootBeyondVertex {
    pub(crate) vertex: Vertex,
    pub(crate) edge: Edge,
    pub(crate) at_vertex: EdgeId,
}

impl Polynomial for FootBeyondVertex {
    const FIRST_SLOT: usize = after::<InwardOf>();
    const VARIANTS: usize = 2;
    const DEGREE: usize = 4;
    #[inline(always)]
    fn variant(&self) -> usize {
        side_of(self.edge.0)
    }
    #[inline(always)]
    fn value<V: View>(&self, view: &V) -> V::T {
        let d = view.direction(self.edge.0, self.edge.1);
        let from_p = view.between(start(view, self.edge), self.vertex);
        let foot = d.scaled(&from_p.dot(&d)).minus(&from_p.scaled(&d.norm_squared()));
        foot.dot(&away(view, (self.vertex.0, self.at_vertex), self.vertex.1))
    }
}

/// `(w − v)·(N × u)`, u a coordinate axis: the height of a polygon's vertex w over v in a direction of the plane.
pub(crate) struct PolygonHeight {
    pub(crate) vertex: Vertex,
    pub(crate) corner: VertexId,
    pub(crate) face: Face,
    pub(crate) axis: usize,
}

impl Polynomial for PolygonHeight {
    const FIRST_SLOT: usize = after::<GapWithin>();
    const VARIANTS: usize = 2;
    const DEGREE: usize = 3;
    fn variant(&self) -> usize {
        side_of(self.face.0)
    }
    fn value<V: View>(&self, view: &V) -> V::T {
        let n = view.normal(self.face.0, self.face.1);
        let w = view.between(self.vertex, (self.face.0, self.corner));
        let k = self.axis;
        let (n, w) = (n.components(), w.components());
        // N × u has the components N_{k+2} along k + 1 and −N_{k+1} along k + 2.
        w[(k + 1) % 3].times(n[(k + 2) % 3]).minus(&w[(k + 2) % 3].times(n[(k + 1) % 3]))
    }
}

/// One component of a face's normal.
pub(crate) struct NormalComponent {
    pub(crate) face: Face,
    pub(crate) axis: usize,
}

impl Polynomial for NormalComponent {
    const FIRST_SLOT: usize = after::<PolygonHeight>();
    const VARIANTS: usize = 2;
    const DEGREE: usize = 2;
    const WITHIN_BLOCKS: bool = true;
    fn variant(&self) -> usize {
        side_of(self.face.0)
    }
    fn value<V: View>(&self, view: &V) -> V::T {
        view.normal(self.face.0, self.face.1).components()[self.axis].clone()
    }
}
