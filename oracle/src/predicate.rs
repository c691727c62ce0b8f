//! The polynomials whose signs decide everything in SPEC section 4, each written once.
//!
//! `value` is evaluated in f64, in error bounds, in balls and in integers; the integer value has the sign of the exact
//! one because every polynomial is homogeneous in length. A vertex is `(side, number)`; an edge or face lies on the
//! side its field says.

use crate::view::View;
use rockproof_model::decision::Side;
use rockproof_model::tolerance::LAMBDA_INVERSE;
use rockproof_model::{Entrance, EntranceKind, Ring, Vec3};

/// A vertex of one of the blocks.
pub(crate) type Vertex = (Side, u32);
/// An edge of one of the blocks.
pub(crate) type Edge = (Side, u32);
/// A face of one of the blocks.
pub(crate) type Face = (Side, u32);

/// A polynomial in the coordinates and tolerances.
pub(crate) trait Polynomial {
    /// Where its static bounds are kept: one slot for each variant, all polynomials in a row.
    const FIRST_SLOT: usize;
    /// How many sets of magnitudes it can draw on: sides, limits, kinds of entrance.
    const VARIANTS: usize;
    /// Which of the sets this one draws on, below `VARIANTS`.
    fn variant(&self) -> usize;
    /// The value; only its sign means anything.
    fn value<V: View>(&self, view: &V) -> V::T;
}

/// Number of slots for static bounds.
pub(crate) const SLOTS: usize = after::<NormalsWithin>();

const fn after<P: Polynomial>() -> usize {
    P::FIRST_SLOT + P::VARIANTS
}

/// A length tolerance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Limit {
    Search,
    Territory,
    Penetration,
}

impl Limit {
    #[inline(always)]
    fn of<V: View>(self, view: &V) -> V::T {
        match self {
            Limit::Search => view.scales().search.clone(),
            Limit::Territory => view.scales().territory.clone(),
            Limit::Penetration => view.scales().penetration.clone(),
        }
    }
}

#[inline(always)]
fn side_of(side: Side) -> usize {
    match side {
        Side::A => 0,
        Side::B => 1,
    }
}

#[inline(always)]
fn start<V: View>(view: &V, edge: Edge) -> Vertex {
    (edge.0, view.topology(edge.0).edges()[edge.1 as usize].p)
}

#[inline(always)]
fn end<V: View>(view: &V, edge: Edge) -> Vertex {
    (edge.0, view.topology(edge.0).edges()[edge.1 as usize].q)
}

/// The direction of an edge away from one of its ends.
#[inline(always)]
fn away<V: View>(view: &V, edge: Edge, from: u32) -> Vec3<V::T> {
    let d = view.direction(edge.0, edge.1);
    if view.topology(edge.0).edges()[edge.1 as usize].p == from { d } else { d.negated() }
}

#[inline(always)]
fn lambda_squared_inverse<V: View>() -> V::T {
    V::T::from_i32(LAMBDA_INVERSE * LAMBDA_INVERSE)
}

/// `s − (low − high)` along an axis, for extreme vertices of two blocks: at least zero where boxes grown by s meet.
pub(crate) struct BoxesMeet {
    pub(crate) low: Vertex,
    pub(crate) high: Vertex,
    pub(crate) axis: usize,
}

impl Polynomial for BoxesMeet {
    const FIRST_SLOT: usize = 0;
    const VARIANTS: usize = 1;
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
    pub(crate) a: u32,
    pub(crate) b: u32,
    pub(crate) limit: Limit,
}

impl Polynomial for Near {
    const FIRST_SLOT: usize = after::<BoxesMeet>();
    const VARIANTS: usize = 3;
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
    pub(crate) a: u32,
    pub(crate) b: u32,
    pub(crate) edge: Edge,
}

impl Polynomial for NearForEdge {
    const FIRST_SLOT: usize = after::<Near>();
    const VARIANTS: usize = 2;
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

/// `(point − at)·e`, e an edge at `at`, away from it: at most zero inside the vertex region.
pub(crate) struct BeyondVertex {
    pub(crate) point: Vertex,
    pub(crate) at: Vertex,
    pub(crate) edge: u32,
}

impl Polynomial for BeyondVertex {
    const FIRST_SLOT: usize = after::<NearForEdge>();
    const VARIANTS: usize = 2;
    #[inline(always)]
    fn variant(&self) -> usize {
        side_of(self.at.0)
    }
    #[inline(always)]
    fn value<V: View>(&self, view: &V) -> V::T {
        view.between(self.at, self.point).dot(&away(view, (self.at.0, self.edge), self.at.1))
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
    pub(crate) limit: Limit,
}

impl Polynomial for NearLine {
    const FIRST_SLOT: usize = after::<FootAlong>();
    const VARIANTS: usize = 6;
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
    pub(crate) height_at: u32,
}

impl Polynomial for NearLineForHeight {
    const FIRST_SLOT: usize = after::<NearLine>();
    const VARIANTS: usize = 2;
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
    pub(crate) at_vertex: u32,
}

impl Polynomial for FootBeyondVertex {
    const FIRST_SLOT: usize = after::<InwardOf>();
    const VARIANTS: usize = 2;
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

/// The gap of a plane, unnormalised: `P = h·√Q`.
///
/// v-f: `P = N·(k a − Σ v_k)`, `Q = k²|N|²`, k the loop's length; f-v with the roles exchanged. e-e: `P = n·(p_A − p_B)`
/// and `Q = |n|²` with `n = d₁ × d₂`; its sign still wants σ.
pub(crate) fn plane<V: View>(view: &V, entrance: &Entrance) -> (V::T, V::T) {
    match entrance.kind {
        EntranceKind::VertexFace => face_plane(view, (Side::A, entrance.a), (Side::B, entrance.b)),
        EntranceKind::FaceVertex => face_plane(view, (Side::B, entrance.b), (Side::A, entrance.a)),
        EntranceKind::EdgeEdge => {
            let n = across(view, entrance.a, entrance.b);
            let (a, b) = (start(view, (Side::A, entrance.a)), start(view, (Side::B, entrance.b)));
            (n.dot(&view.between(b, a)), n.norm_squared())
        }
    }
}

#[inline(always)]
fn face_plane<V: View>(view: &V, vertex: Vertex, face: Face) -> (V::T, V::T) {
    let n = view.normal(face.0, face.1);
    let count = view.loop_length(face.0, face.1);
    (plane_value(view, vertex, face), count.squared().times(&n.norm_squared()))
}

#[inline(always)]
fn plane_value<V: View>(view: &V, vertex: Vertex, face: Face) -> V::T {
    let n = view.normal(face.0, face.1);
    let count = view.loop_length(face.0, face.1);
    let first = (face.0, view.topology(face.0).faces()[face.1 as usize][0]);
    n.dot(&view.between(first, vertex).scaled(&count).minus(&view.centre(face.0, face.1)))
}

/// The entrance's normal before σ, from the face outwards: B to A for v-f and (with σ) e-e, A to B for f-v.
fn entrance_normal<V: View>(view: &V, entrance: &Entrance) -> Vec3<V::T> {
    match entrance.kind {
        EntranceKind::VertexFace => view.normal(Side::B, entrance.b),
        EntranceKind::FaceVertex => view.normal(Side::A, entrance.a),
        EntranceKind::EdgeEdge => across(view, entrance.a, entrance.b),
    }
}

#[inline(always)]
fn across<V: View>(view: &V, edge_a: u32, edge_b: u32) -> Vec3<V::T> {
    view.direction(Side::A, edge_a).cross(&view.direction(Side::B, edge_b))
}

#[inline(always)]
fn kind_of(entrance: &Entrance) -> usize {
    entrance.kind as usize
}

/// `N·(k v − Σ v_k)`: positive outside the face's plane.
pub(crate) struct AbovePlane {
    pub(crate) vertex: Vertex,
    pub(crate) face: Face,
}

impl Polynomial for AbovePlane {
    const FIRST_SLOT: usize = after::<FootBeyondVertex>();
    const VARIANTS: usize = 2;
    #[inline(always)]
    fn variant(&self) -> usize {
        side_of(self.face.0)
    }
    #[inline(always)]
    fn value<V: View>(&self, view: &V) -> V::T {
        plane_value(view, self.vertex, self.face)
    }
}

/// `limit²·Q − P²`: at least zero where the gap's size is within the limit.
pub(crate) struct GapWithin {
    pub(crate) entrance: Entrance,
    pub(crate) limit: Limit,
}

impl Polynomial for GapWithin {
    const FIRST_SLOT: usize = after::<AbovePlane>();
    const VARIANTS: usize = 9;
    #[inline(always)]
    fn variant(&self) -> usize {
        kind_of(&self.entrance) * 3 + self.limit as usize
    }
    #[inline(always)]
    fn value<V: View>(&self, view: &V) -> V::T {
        let (p, q) = plane(view, &self.entrance);
        let limit = self.limit.of(view).squared().times(&q);
        limit.minus(&view.scales().unit.squared().times(&p.squared()))
    }
}

/// `(w − v)·(N × u)`, u a coordinate axis: the height of a polygon's vertex w over v in a direction of the plane.
pub(crate) struct PolygonHeight {
    pub(crate) vertex: Vertex,
    pub(crate) corner: u32,
    pub(crate) face: Face,
    pub(crate) axis: usize,
}

impl Polynomial for PolygonHeight {
    const FIRST_SLOT: usize = after::<GapWithin>();
    const VARIANTS: usize = 2;
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
    fn variant(&self) -> usize {
        side_of(self.face.0)
    }
    fn value<V: View>(&self, view: &V) -> V::T {
        view.normal(self.face.0, self.face.1).components()[self.axis].clone()
    }
}

/// `e·N`, e an edge at the vertex, away from it: negative where the edge dips below the face's plane.
pub(crate) struct EdgeAbovePlane {
    pub(crate) vertex: Vertex,
    pub(crate) edge: u32,
    pub(crate) face: Face,
}

impl Polynomial for EdgeAbovePlane {
    const FIRST_SLOT: usize = after::<NormalComponent>();
    const VARIANTS: usize = 2;
    #[inline(always)]
    fn variant(&self) -> usize {
        side_of(self.face.0)
    }
    #[inline(always)]
    fn value<V: View>(&self, view: &V) -> V::T {
        away(view, (self.vertex.0, self.edge), self.vertex.1).dot(&view.normal(self.face.0, self.face.1))
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

/// `g²|N|² − (e·N)²`
pub(crate) struct EdgeDipDepth {
    pub(crate) edge: Edge,
    pub(crate) face: Face,
}

impl Polynomial for EdgeDipDepth {
    const FIRST_SLOT: usize = after::<EdgeDipAngle>();
    const VARIANTS: usize = 2;
    fn variant(&self) -> usize {
        side_of(self.face.0)
    }
    fn value<V: View>(&self, view: &V) -> V::T {
        let (e, n) = (view.direction(self.edge.0, self.edge.1), view.normal(self.face.0, self.face.1));
        let scales = view.scales();
        let allowed = scales.penetration.squared().times(&n.norm_squared());
        allowed.minus(&scales.unit.squared().times(&e.dot(&n).squared()))
    }
}

/// `sp²|d₁|²|d₂|² − |d₁ × d₂|²`: at least zero for nearly parallel edges.
pub(crate) struct ParallelAngle {
    pub(crate) edge_a: u32,
    pub(crate) edge_b: u32,
}

impl Polynomial for ParallelAngle {
    const FIRST_SLOT: usize = after::<EdgeDipDepth>();
    const VARIANTS: usize = 1;
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
}

/// `r²|d|² − |d₁ × d₂|²`, d the direction on `longer`: the gap between the edges varies by less than the territory.
pub(crate) struct ParallelReach {
    pub(crate) edge_a: u32,
    pub(crate) edge_b: u32,
    pub(crate) longer: Side,
}

impl Polynomial for ParallelReach {
    const FIRST_SLOT: usize = after::<ParallelAngle>();
    const VARIANTS: usize = 2;
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
}

/// How far along `on` the foot of the common perpendicular lies: `t|n|²` from the start, `(1 − t)|n|²` from the end.
pub(crate) struct CommonFoot {
    pub(crate) edge_a: u32,
    pub(crate) edge_b: u32,
    pub(crate) on: Side,
    pub(crate) from_end: bool,
}

impl Polynomial for CommonFoot {
    const FIRST_SLOT: usize = after::<ParallelReach>();
    const VARIANTS: usize = 2;
    #[inline(always)]
    fn variant(&self) -> usize {
        side_of(self.on)
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
    pub(crate) edge_a: u32,
    pub(crate) edge_b: u32,
}

impl Polynomial for Orientation {
    const FIRST_SLOT: usize = after::<CommonFoot>();
    const VARIANTS: usize = 1;
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
pub(crate) struct InwardAcross {
    pub(crate) edge_a: u32,
    pub(crate) edge_b: u32,
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
}

impl Polynomial for InwardAcross {
    const FIRST_SLOT: usize = after::<Orientation>();
    const VARIANTS: usize = 2;
    #[inline(always)]
    fn variant(&self) -> usize {
        side_of(self.side)
    }
    #[inline(always)]
    fn value<V: View>(&self, view: &V) -> V::T {
        let edge = self.edge();
        across(view, self.edge_a, self.edge_b).dot(&view.inward(edge.0, edge.1, self.right))
    }
}

/// `so²|n|²|m|² − (n·m)²`
pub(crate) struct WedgeDipAngle(pub(crate) InwardAcross);

impl Polynomial for WedgeDipAngle {
    const FIRST_SLOT: usize = after::<InwardAcross>();
    const VARIANTS: usize = 2;
    fn variant(&self) -> usize {
        self.0.variant()
    }
    fn value<V: View>(&self, view: &V) -> V::T {
        let edge = self.0.edge();
        let n = across(view, self.0.edge_a, self.0.edge_b);
        let m = view.inward(edge.0, edge.1, self.0.right);
        let scales = view.scales();
        let allowed = scales.overlap.squared().times(&n.norm_squared()).times(&m.norm_squared());
        allowed.minus(&scales.one.squared().times(&n.dot(&m).squared()))
    }
}

/// `g²|n|²|m|²|d|² − (n·m)²|(w − p) × d|²` for one vertex w of the face: within depth when that holds for all of them.
pub(crate) struct WedgeDipDepth {
    pub(crate) inward: InwardAcross,
    pub(crate) corner: u32,
}

impl Polynomial for WedgeDipDepth {
    const FIRST_SLOT: usize = after::<WedgeDipAngle>();
    const VARIANTS: usize = 2;
    fn variant(&self) -> usize {
        self.inward.variant()
    }
    fn value<V: View>(&self, view: &V) -> V::T {
        let edge = self.inward.edge();
        let n = across(view, self.inward.edge_a, self.inward.edge_b);
        let m = view.inward(edge.0, edge.1, self.inward.right);
        let d = view.direction(edge.0, edge.1);
        let height = view.between(start(view, edge), (edge.0, self.corner)).cross(&d).norm_squared();
        let scales = view.scales();
        let size = n.norm_squared().times(&m.norm_squared()).times(&d.norm_squared());
        let dip = n.dot(&m).squared().times(&height);
        scales.penetration.squared().times(&size).minus(&scales.unit.squared().times(&dip))
    }
}

/// `n·(p_A − p_B)` with `n = d₁ × d₂`: the gap of two edges before σ.
pub(crate) struct EdgesApart {
    pub(crate) edge_a: u32,
    pub(crate) edge_b: u32,
}

impl Polynomial for EdgesApart {
    const FIRST_SLOT: usize = after::<WedgeDipDepth>();
    const VARIANTS: usize = 1;
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
    fn of<V: View>(self, view: &V) -> V::T {
        let scales = view.scales();
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
    fn variant(&self) -> usize {
        (kind_of(&self.first) * 3 + kind_of(&self.second)) * 3 + self.factor as usize
    }
    fn value<V: View>(&self, view: &V) -> V::T {
        let ((p1, q1), (p2, q2)) = (plane(view, &self.first), plane(view, &self.second));
        let whole = view.scales().whole.squared();
        let factor = self.factor.of(view).squared();
        whole.times(&p1.squared().times(&q2)).minus(&factor.times(&p2.squared().times(&q1)))
    }
}

/// `n₁·n₂` of two entrances, before σ and before f-v normals are turned from B to A.
pub(crate) struct NormalsAgree {
    pub(crate) first: Entrance,
    pub(crate) second: Entrance,
}

impl Polynomial for NormalsAgree {
    const FIRST_SLOT: usize = after::<LargerGap>();
    const VARIANTS: usize = 9;
    fn variant(&self) -> usize {
        kind_of(&self.first) * 3 + kind_of(&self.second)
    }
    fn value<V: View>(&self, view: &V) -> V::T {
        entrance_normal(view, &self.first).dot(&entrance_normal(view, &self.second))
    }
}

/// `so²|n₁|²|n₂|² − |n₁ × n₂|²`: at least zero where two normals are within the overlap angle.
pub(crate) struct NormalsWithin {
    pub(crate) first: Entrance,
    pub(crate) second: Entrance,
}

impl Polynomial for NormalsWithin {
    const FIRST_SLOT: usize = after::<NormalsAgree>();
    const VARIANTS: usize = 9;
    fn variant(&self) -> usize {
        kind_of(&self.first) * 3 + kind_of(&self.second)
    }
    fn value<V: View>(&self, view: &V) -> V::T {
        let (n1, n2) = (entrance_normal(view, &self.first), entrance_normal(view, &self.second));
        let scales = view.scales();
        let allowed = scales.overlap.squared().times(&n1.norm_squared()).times(&n2.norm_squared());
        allowed.minus(&scales.one.squared().times(&n1.cross(&n2).norm_squared()))
    }
}
