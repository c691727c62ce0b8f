//! How far vertices are from boxes, vertices and edges: the near tests and the territories.

use super::*;

/// `s − (low − high)` along an axis, for extreme vertices of two blocks: at least zero where boxes grown by s meet.
pub(crate) struct BoxesMeet {
    pub(crate) low: Vertex,
    pub(crate) high: Vertex,
    pub(crate) axis: usize,
}

impl Polynomial for BoxesMeet {
    const FIRST_SLOT: usize = 0;
    const VARIANTS: usize = 1;
    const DEGREE: usize = 1;
    const DENOMINATOR: Denominator = Denominator::Unit;
    fn variant(&self) -> usize {
        0
    }
    #[inline(always)]
    fn value<V: View>(&self, view: &V) -> V::T {
        let apart = view.between(self.high, self.low);
        view.scales().search.minus(&view.scales().unit.times(apart.components()[self.axis]))
    }
}

/// `limit² − |a − b|²`
pub(crate) struct Near {
    pub(crate) a: VertexId,
    pub(crate) b: VertexId,
    pub(crate) limit: LengthTolerance,
}

impl Polynomial for Near {
    const FIRST_SLOT: usize = after::<BoxesMeet>();
    const VARIANTS: usize = 3;
    const DEGREE: usize = 2;
    const DENOMINATOR: Denominator = Denominator::UnitSquared;
    #[inline(always)]
    fn variant(&self) -> usize {
        self.limit as usize
    }
    #[inline(always)]
    fn value<V: View>(&self, view: &V) -> V::T {
        let apart = view.between((Side::A, self.a), (Side::B, self.b)).norm_squared();
        self.limit.of(view).squared().minus(&view.scales().unit.squared().times(&apart))
    }
}

/// `λ²|d|² − |a − b|²` for an edge at one of the vertices: bounds the territory under the revised criteria.
pub(crate) struct NearForEdge {
    pub(crate) a: VertexId,
    pub(crate) b: VertexId,
    pub(crate) edge: Edge,
}

impl Polynomial for NearForEdge {
    const FIRST_SLOT: usize = after::<Near>();
    const VARIANTS: usize = 2;
    const DEGREE: usize = 2;
    #[inline(always)]
    fn variant(&self) -> usize {
        side_of(self.edge.0)
    }
    #[inline(always)]
    fn value<V: View>(&self, view: &V) -> V::T {
        let apart = view.between((Side::A, self.a), (Side::B, self.b)).norm_squared();
        let d = view.direction(self.edge.0, self.edge.1);
        d.norm_squared().minus(&lambda_squared_inverse::<V>().times(&apart))
    }
}

/// `(v − p)·d`, or `(q − v)·d` with `from_end`: positive on the inner side of that end.
pub(crate) struct FootAlong {
    pub(crate) vertex: Vertex,
    pub(crate) edge: Edge,
    pub(crate) from_end: bool,
}

impl Polynomial for FootAlong {
    const FIRST_SLOT: usize = after::<BeyondVertex>();
    const VARIANTS: usize = 2;
    const DEGREE: usize = 2;
    #[inline(always)]
    fn variant(&self) -> usize {
        side_of(self.edge.0)
    }
    #[inline(always)]
    fn value<V: View>(&self, view: &V) -> V::T {
        let d = view.direction(self.edge.0, self.edge.1);
        if self.from_end {
            view.between(self.vertex, end(view, self.edge)).dot(&d)
        } else {
            view.between(start(view, self.edge), self.vertex).dot(&d)
        }
    }
}

/// `limit²|d|² − |(v − p) × d|²`: at least zero where v is within the limit of the edge's line.
pub(crate) struct NearLine {
    pub(crate) vertex: Vertex,
    pub(crate) edge: Edge,
    pub(crate) limit: LengthTolerance,
}

impl Polynomial for NearLine {
    const FIRST_SLOT: usize = after::<FootAlong>();
    const VARIANTS: usize = 6;
    const DEGREE: usize = 4;
    const DENOMINATOR: Denominator = Denominator::UnitSquared;
    #[inline(always)]
    fn variant(&self) -> usize {
        side_of(self.edge.0) * 3 + self.limit as usize
    }
    #[inline(always)]
    fn value<V: View>(&self, view: &V) -> V::T {
        let d = view.direction(self.edge.0, self.edge.1);
        let moment = view.between(start(view, self.edge), self.vertex).cross(&d).norm_squared();
        let limit = self.limit.of(view).squared().times(&d.norm_squared());
        limit.minus(&view.scales().unit.squared().times(&moment))
    }
}

/// `λ²|(w − p) × d|² − |(v − p) × d|²` for a vertex w of a face at the edge: bounds the edge's territory.
pub(crate) struct NearLineForHeight {
    pub(crate) vertex: Vertex,
    pub(crate) edge: Edge,
    pub(crate) height_at: VertexId,
}

impl Polynomial for NearLineForHeight {
    const FIRST_SLOT: usize = after::<NearLine>();
    const VARIANTS: usize = 2;
    const DEGREE: usize = 4;
    #[inline(always)]
    fn variant(&self) -> usize {
        side_of(self.edge.0)
    }
    #[inline(always)]
    fn value<V: View>(&self, view: &V) -> V::T {
        let d = view.direction(self.edge.0, self.edge.1);
        let p = start(view, self.edge);
        let moment = view.between(p, self.vertex).cross(&d).norm_squared();
        let height = view.between(p, (self.edge.0, self.height_at)).cross(&d).norm_squared();
        height.minus(&lambda_squared_inverse::<V>().times(&moment))
    }
}
