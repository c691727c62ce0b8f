//! Two edges: nearly parallel, crossing, and whether their faces pass one another.

use super::*;
use rockproof_model::Sign;

/// `sp²|d₁|²|d₂|² − |d₁ × d₂|²`: at least zero for nearly parallel edges.
pub(crate) struct ParallelAngle {
    pub(crate) edge_a: EdgeId,
    pub(crate) edge_b: EdgeId,
}

impl Polynomial for ParallelAngle {
    const FIRST_SLOT: usize = after::<EdgeDipDepth>();
    const VARIANTS: usize = 1;
    const DEGREE: usize = 4;
    const WITHIN_BLOCKS: bool = true;
    const DENOMINATOR: Denominator = Denominator::OneSquared;
    #[inline(always)]
    fn variant(&self) -> usize {
        0
    }
    #[inline(always)]
    fn value<V: View>(&self, view: &V) -> V::T {
        let (a, b) = (view.direction(Side::A, self.edge_a), view.direction(Side::B, self.edge_b));
        let scales = view.scales();
        let allowed = scales.parallel.squared().times(&a.norm_squared()).times(&b.norm_squared());
        allowed.minus(&scales.one.squared().times(&a.cross(&b).norm_squared()))
    }
    fn zero_where_parallel(&self, tolerances: &ToleranceSet) -> Option<(EdgeId, EdgeId)> {
        tolerances.parallel_sine.is_zero().then_some((self.edge_a, self.edge_b))
    }
}

/// `r²|d|² − |d₁ × d₂|²`, d the direction on `longer`: the gap between the edges varies by less than the territory.
pub(crate) struct ParallelReach {
    pub(crate) edge_a: EdgeId,
    pub(crate) edge_b: EdgeId,
    pub(crate) longer: Side,
}

impl Polynomial for ParallelReach {
    const FIRST_SLOT: usize = after::<ParallelAngle>();
    const VARIANTS: usize = 2;
    const DEGREE: usize = 4;
    const WITHIN_BLOCKS: bool = true;
    const DENOMINATOR: Denominator = Denominator::UnitSquared;
    #[inline(always)]
    fn variant(&self) -> usize {
        side_of(self.longer)
    }
    #[inline(always)]
    fn value<V: View>(&self, view: &V) -> V::T {
        let (a, b) = (view.direction(Side::A, self.edge_a), view.direction(Side::B, self.edge_b));
        let longer = match self.longer {
            Side::A => a.norm_squared(),
            Side::B => b.norm_squared(),
        };
        let allowed = view.scales().territory.squared().times(&longer);
        allowed.minus(&view.scales().unit.squared().times(&a.cross(&b).norm_squared()))
    }
    fn zero_where_parallel(&self, tolerances: &ToleranceSet) -> Option<(EdgeId, EdgeId)> {
        tolerances.territory.is_zero().then_some((self.edge_a, self.edge_b))
    }
}

/// How far along `on` the foot of the common perpendicular lies: `t|n|²` from the start, `(1 − t)|n|²` from the end.
pub(crate) struct CommonFoot {
    pub(crate) edge_a: EdgeId,
    pub(crate) edge_b: EdgeId,
    pub(crate) on: Side,
    pub(crate) from_end: bool,
}

impl CommonFoot {
    /// The variant of all feet on edges of the block on `side`.
    #[inline(always)]
    pub(crate) fn variant_of(side: Side) -> usize {
        side_of(side)
    }
}

impl Polynomial for CommonFoot {
    const FIRST_SLOT: usize = after::<ParallelReach>();
    const VARIANTS: usize = 2;
    const DEGREE: usize = 4;
    #[inline(always)]
    fn variant(&self) -> usize {
        CommonFoot::variant_of(self.on)
    }
    #[inline(always)]
    fn value<V: View>(&self, view: &V) -> V::T {
        let n = across(view, self.edge_a, self.edge_b);
        let (on, other) = match self.on {
            Side::A => ((Side::A, self.edge_a), (Side::B, self.edge_b)),
            Side::B => ((Side::B, self.edge_b), (Side::A, self.edge_a)),
        };
        let other_direction = view.direction(other.0, other.1);
        let from = if self.from_end { end(view, on) } else { start(view, on) };
        // With r = p₂ − p₁: (r × d₂)·n = t₁|n|² and (r × d₁)·n = t₂|n|². Seen from B, r is reversed; seen from an
        // end, one whole |n|² less remains.
        let t = view.between(from, start(view, other)).cross(&other_direction).dot(&n);
        let forward = (self.on == Side::A) != self.from_end;
        if forward { t } else { t.negated() }
    }
}

/// `n·(m_L + m_R)_A − n·(m_L + m_R)_B` with `n = d₁ × d₂`: its sign is σ, zero counting as +.
pub(crate) struct Orientation {
    pub(crate) edge_a: EdgeId,
    pub(crate) edge_b: EdgeId,
}

impl Polynomial for Orientation {
    const FIRST_SLOT: usize = after::<CommonFoot>();
    const VARIANTS: usize = 1;
    const DEGREE: usize = 5;
    const WITHIN_BLOCKS: bool = true;
    #[inline(always)]
    fn variant(&self) -> usize {
        0
    }
    #[inline(always)]
    fn value<V: View>(&self, view: &V) -> V::T {
        let inwards = |side, edge| view.inward(side, edge, false).plus(&view.inward(side, edge, true));
        let n = across(view, self.edge_a, self.edge_b);
        n.dot(&inwards(Side::A, self.edge_a)).minus(&n.dot(&inwards(Side::B, self.edge_b)))
    }
}

/// `n·m` with `n = d₁ × d₂`, m an inward direction at one of the two edges.
#[derive(Clone, Copy)]
pub(crate) struct InwardAcross {
    pub(crate) edge_a: EdgeId,
    pub(crate) edge_b: EdgeId,
    pub(crate) side: Side,
    pub(crate) right: bool,
}

impl InwardAcross {
    #[inline(always)]
    fn edge(&self) -> Edge {
        match self.side {
            Side::A => (Side::A, self.edge_a),
            Side::B => (Side::B, self.edge_b),
        }
    }

    /// The value for `n = d₁ × d₂`.
    #[inline(always)]
    pub(crate) fn value_along<V: View>(&self, view: &V, n: &Vec3<V::T>) -> V::T {
        let edge = self.edge();
        n.dot(&view.inward(edge.0, edge.1, self.right))
    }
}

impl Polynomial for InwardAcross {
    const FIRST_SLOT: usize = after::<Orientation>();
    const VARIANTS: usize = 2;
    const DEGREE: usize = 5;
    // Where planar faces leave zero, rounded ones leave a rounding.
    const IN_BALLS: bool = false;
    const IN_DOUBLE: bool = true;
    const WITHIN_BLOCKS: bool = true;
    #[inline(always)]
    fn variant(&self) -> usize {
        side_of(self.side)
    }
    #[inline(always)]
    fn value<V: View>(&self, view: &V) -> V::T {
        self.value_along(view, &across(view, self.edge_a, self.edge_b))
    }
    #[inline(always)]
    fn as_edge_along_normal(&self, pair: &Pair<'_>) -> Option<AsEdgeAlongNormal> {
        // By Lagrange: (d_A × d_B)·(N × d_A) = (d_A·N)(d_A·d_B) − |d_A|²(d_B·N), and (d_A × d_B)·(N × d_B) = |d_B|²(d_A·N) − (d_B·N)(d_A·d_B). In the plane
        // the edge's own product with N is zero. The right face's direction is the opposite one. Edges of planar faces lie there; of others rounding leaves
        // something of the product.
        let (own, other) = match self.side {
            Side::A => ((Side::A, self.edge_a), (Side::B, self.edge_b)),
            Side::B => ((Side::B, self.edge_b), (Side::A, self.edge_a)),
        };
        let ends = pair.topology(own.0).edge(own.1);
        let face = (own.0, if self.right { ends.right } else { ends.left });
        let turn = if (self.side == Side::A) == self.right { Sign::Positive } else { Sign::Negative };
        Some(AsEdgeAlongNormal { edge: other, face, turn, in_plane: Some(own) })
    }
}

/// `so²|n|²|m|² − (n·m)²`
pub(crate) struct WedgeDipAngle(pub(crate) InwardAcross);

impl Polynomial for WedgeDipAngle {
    const FIRST_SLOT: usize = after::<InwardAcross>();
    const VARIANTS: usize = 2;
    const DEGREE: usize = 10;
    const WITHIN_BLOCKS: bool = true;
    const DENOMINATOR: Denominator = Denominator::OneSquared;
    fn variant(&self) -> usize {
        self.0.variant()
    }
    fn value<V: View>(&self, view: &V) -> V::T {
        self.of_parts(WedgeSize(self.0).value(view), self.0.value(view), view.scales())
    }
    fn error_by_parts(&self, parts: &Parts<'_, '_, '_>) -> Option<f64> {
        Some(self.of_parts(parts.of(&WedgeSize(self.0)), parts.of(&self.0), &parts.scales()).error)
    }
}

impl WedgeDipAngle {
    #[inline(always)]
    fn of_parts<T: Ring>(&self, size: T, along: T, scales: &Scales<T>) -> T {
        scales.overlap.squared().times(&size).minus(&scales.one.squared().times(&along.squared()))
    }
}

/// `limit²|n|²|m|²|d|² − (n·m)²|(w − p) × d|²` for one vertex w of the face: within the limit when that holds for all of
/// them.
pub(crate) struct WedgeDipDepth {
    pub(crate) inward: InwardAcross,
    pub(crate) corner: VertexId,
    pub(crate) limit: DipLimit,
}

impl Polynomial for WedgeDipDepth {
    const FIRST_SLOT: usize = after::<WedgeDipAngle>();
    const VARIANTS: usize = 4;
    const DEGREE: usize = 14;
    const WITHIN_BLOCKS: bool = true;
    const DENOMINATOR: Denominator = Denominator::UnitSquared;
    fn variant(&self) -> usize {
        self.inward.variant() * 2 + self.limit as usize
    }
    fn value<V: View>(&self, view: &V) -> V::T {
        let edge = self.inward.edge();
        self.of_parts(
            WedgeSize(self.inward).value(view),
            EdgeSize { edge }.value(view),
            self.inward.value(view),
            CornerHeight { edge, corner: self.corner }.value(view),
            view.scales(),
        )
    }
    fn error_by_parts(&self, parts: &Parts<'_, '_, '_>) -> Option<f64> {
        let edge = self.inward.edge();
        let error = self.of_parts(
            parts.of(&WedgeSize(self.inward)),
            parts.of(&EdgeSize { edge }),
            parts.of(&self.inward),
            parts.of(&CornerHeight { edge, corner: self.corner }),
            &parts.scales(),
        );
        Some(error.error)
    }
}

impl WedgeDipDepth {
    #[inline(always)]
    fn of_parts<T: Ring>(&self, size: T, edge: T, along: T, height: T, scales: &Scales<T>) -> T {
        let (limit, unit) = self.limit.squared(scales);
        limit.times(&size.times(&edge)).minus(&unit.times(&along.squared().times(&height)))
    }
}

/// `|n|²|m|²`, a part of [`WedgeDipAngle`] and [`WedgeDipDepth`] by which none is decided.
pub(crate) struct WedgeSize(pub(crate) InwardAcross);

impl Polynomial for WedgeSize {
    const FIRST_SLOT: usize = after::<PlaneSize>();
    const VARIANTS: usize = 2;
    const DEGREE: usize = 10;
    const WITHIN_BLOCKS: bool = true;
    #[inline(always)]
    fn variant(&self) -> usize {
        self.0.variant()
    }
    #[inline(always)]
    fn value<V: View>(&self, view: &V) -> V::T {
        let edge = self.0.edge();
        let n = across(view, self.0.edge_a, self.0.edge_b);
        n.norm_squared().times(&view.inward(edge.0, edge.1, self.0.right).norm_squared())
    }
}

/// `|d|²`, a part of [`WedgeDipDepth`] by which none is decided.
pub(crate) struct EdgeSize {
    pub(crate) edge: Edge,
}

impl Polynomial for EdgeSize {
    const FIRST_SLOT: usize = after::<WedgeSize>();
    const VARIANTS: usize = 2;
    const DEGREE: usize = 2;
    const WITHIN_BLOCKS: bool = true;
    #[inline(always)]
    fn variant(&self) -> usize {
        side_of(self.edge.0)
    }
    #[inline(always)]
    fn value<V: View>(&self, view: &V) -> V::T {
        view.direction(self.edge.0, self.edge.1).norm_squared()
    }
}

/// `|(w − p) × d|²` for a vertex w of the edge's block, likewise.
pub(crate) struct CornerHeight {
    pub(crate) edge: Edge,
    pub(crate) corner: VertexId,
}

impl Polynomial for CornerHeight {
    const FIRST_SLOT: usize = after::<EdgeSize>();
    const VARIANTS: usize = 2;
    const DEGREE: usize = 4;
    const WITHIN_BLOCKS: bool = true;
    #[inline(always)]
    fn variant(&self) -> usize {
        side_of(self.edge.0)
    }
    #[inline(always)]
    fn value<V: View>(&self, view: &V) -> V::T {
        let direction = view.direction(self.edge.0, self.edge.1);
        view.between(start(view, self.edge), (self.edge.0, self.corner)).cross(&direction).norm_squared()
    }
}
