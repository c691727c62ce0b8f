//! Every comparison and every role of SPEC section 4, one small method each.
//!
//! The classification asks these methods and compares nothing else, except for culling that cannot change an answer and the winding of a face's edges
//! around a point (`vertex_face.rs`).
//! [`SpecRules`] takes all of them as they stand here. The trait exists so that a test can plant one deliberate mistake at a
//! time, by overriding one method, and show that a campaign finds it. Everything is resolved at compile time: with
//! `SpecRules` the methods are the bare comparisons.
//!
//! Distances, gaps and radii are in metres; `u`, `n` and `m` are unit vectors; sines have no unit.

use crate::contact::classify::{ClassificationRequest, ComputedContact};
use crate::contact::compiled::{TracedContacts, contacts, traced};
use crate::contact::tolerances::Tolerances;
use crate::real::Real;
use crate::vector::Vector;
use rockproof_model::{ContactKey, EdgeId, EntranceKind, Sign};

/// The rules of SPEC section 4 as the classification asks them. The defaults are SPEC's.
pub trait ContactRules: 'static {
    /// Rough phase: the boxes are at most s apart along an axis. **A tie says yes.**
    #[inline(always)]
    fn neighbours<R: Real>(apart: R, search: R) -> bool {
        apart <= search
    }

    /// Whether test 2 runs with vertices of B and edges of A too.
    #[inline(always)]
    fn edge_vertex_role() -> bool {
        true
    }

    /// Whether test 3 runs with vertices of B and faces of A too.
    #[inline(always)]
    fn face_vertex_role() -> bool {
        true
    }

    /// Whether a vertex may be in a v-v or v-e contact or in a territory: it must be convex.
    #[inline(always)]
    fn vertex_takes_part(convex: bool) -> bool {
        convex
    }

    /// Whether an edge may be in a v-e or e-e contact or have a territory: it must be convex.
    #[inline(always)]
    fn edge_takes_part(convex: bool) -> bool {
        convex
    }

    /// λ: the share of a feature that its territory may cover.
    #[inline(always)]
    fn lambda<R: Real>() -> R {
        R::from_f64(0.25)
    }

    /// `r_b`: s under classic, min(r, λ·shortest edge at the vertex) under revised.
    #[inline(always)]
    fn vertex_radius<R: Real>(t: &Tolerances<R>, shortest: R) -> R {
        if t.revised { t.territory.smaller(Self::lambda::<R>() * shortest) } else { t.search }
    }

    /// `r_e`: s under classic, min(r, λ·w_e) under revised, w_e the smaller of the widths of the edge's two faces.
    #[inline(always)]
    fn edge_radius<R: Real>(t: &Tolerances<R>, width_left: R, width_right: R) -> R {
        if t.revised { t.territory.smaller(Self::lambda::<R>() * width_left.smaller(width_right)) } else { t.search }
    }

    /// The radius within which two vertices are in one another's territory: the smaller one.
    #[inline(always)]
    fn shared_radius<R: Real>(a: R, b: R) -> R {
        a.smaller(b)
    }

    /// v-v: the distance is at most s. **A tie says yes.**
    #[inline(always)]
    fn vertex_vertex_near<R: Real>(distance: R, search: R) -> bool {
        distance <= search
    }

    /// A vertex is in the territory of a vertex. **A tie says yes.**
    #[inline(always)]
    fn vertex_territory<R: Real>(distance: R, radius: R) -> bool {
        distance <= radius
    }

    /// A vertex is in the region of a vertex with respect to one edge there, `(a − b)·u ≤ 0`. **A tie says yes.**
    #[inline(always)]
    fn vertex_region<R: Real>(along: R) -> bool {
        along <= R::ZERO
    }

    /// Whether each of two vertices must lie in the other's region, not only A's in that of B's.
    #[inline(always)]
    fn both_regions() -> bool {
        true
    }

    /// The foot of a vertex lies strictly inside an edge from p to q: `(a − p)·u > 0` and `(a − q)·u < 0`.
    /// **A tie says no.**
    #[inline(always)]
    fn foot_inside<R: Real>(from_p: R, from_q: R) -> bool {
        from_p > R::ZERO && from_q < R::ZERO
    }

    /// v-e: the distance to the line is at most s. **A tie says yes.**
    #[inline(always)]
    fn vertex_edge_near<R: Real>(distance: R, search: R) -> bool {
        distance <= search
    }

    /// A vertex whose foot is inside an edge is in the edge's territory. **A tie says yes.**
    #[inline(always)]
    fn edge_territory<R: Real>(distance: R, radius: R) -> bool {
        distance <= radius
    }

    /// A vertex is in the region of an edge with respect to one of its faces, `(a − p)·m ≤ 0`. **A tie says yes.**
    #[inline(always)]
    fn edge_region<R: Real>(inward: R) -> bool {
        inward <= R::ZERO
    }

    /// A foot is in the region of a vertex with respect to one edge there, `(f − a)·u ≤ 0`. **A tie says yes.**
    #[inline(always)]
    fn foot_region<R: Real>(along: R) -> bool {
        along <= R::ZERO
    }

    /// Test 2 leaves alone what is in the territory of an end of the edge.
    #[inline(always)]
    fn ends_before_edge() -> bool {
        true
    }

    /// v-f: the gap is at most s. **A tie says yes.**
    #[inline(always)]
    fn vertex_face_near<R: Real>(gap: R, search: R) -> bool {
        gap <= search
    }

    /// Whether a contact is kept: one of those that the step before left closed has its kind and features. Depth alone does
    /// not end it.
    #[inline(always)]
    fn is_kept(kept: &[ContactKey], contact: ContactKey) -> bool {
        kept.contains(&contact)
    }

    /// v-f: the gap is at least −g. **A tie says yes.**
    #[inline(always)]
    fn vertex_face_depth<R: Real>(gap: R, penetration: R) -> bool {
        gap >= -penetration
    }

    /// A projection is strictly on the inner side of an edge of the face, `(a − p)·m > 0`. **A tie says no.**
    #[inline(always)]
    fn inside_face<R: Real>(inward: R) -> bool {
        inward > R::ZERO
    }

    /// Tests 3 and 4 leave alone what is in the territory of a vertex of the face, or of an end of the other edge.
    #[inline(always)]
    fn vertices_before_faces_and_edges() -> bool {
        true
    }

    /// Tests 3 and 4 leave alone what is in the territory of an edge.
    #[inline(always)]
    fn edges_before_faces_and_edges() -> bool {
        true
    }

    /// The edges at a vertex that "cone passes plane" looks at: all.
    #[inline(always)]
    fn cone(edges: &[EdgeId]) -> &[EdgeId] {
        edges
    }

    /// The edges at a vertex that bound its region: all.
    #[inline(always)]
    fn region(edges: &[EdgeId]) -> &[EdgeId] {
        edges
    }

    /// One edge at a vertex passes a face plane: its unit direction rises, `u·n ≥ 0`, or dips within the tolerance. **A tie
    /// says yes.**
    #[inline(always)]
    fn cone_passes<R: Real>(rise: R, length: R, t: &Tolerances<R>) -> bool {
        rise >= R::ZERO || Self::dip_is_within(rise.abs(), length, t)
    }

    /// The tolerance of the no-overlap checks: something of this length dips by at most the angle so and, under revised, its
    /// end by at most g as well. **Ties say yes.**
    #[inline(always)]
    fn dip_is_within<R: Real>(sine: R, length: R, t: &Tolerances<R>) -> bool {
        sine <= t.overlap_sine && (!t.revised || Self::dip_is_short(sine, length, t))
    }

    /// Revised criteria: something of this length, dipping at this sine, dips by at most g. **A tie says yes.**
    #[inline(always)]
    fn dip_is_short<R: Real>(sine: R, length: R, t: &Tolerances<R>) -> bool {
        sine * length <= t.penetration
    }

    /// Two edges are nearly parallel: the sine between them is at most sp and, under revised, the shorter one strays from the
    /// longer one's direction by at most r as well. **Ties say yes.**
    #[inline(always)]
    fn nearly_parallel<R: Real>(sine: R, length_a: R, length_b: R, t: &Tolerances<R>) -> bool {
        sine <= t.parallel_sine && (!t.revised || Self::strays_little(sine, length_a, length_b, t))
    }

    /// Revised criteria: of two edges with this sine between them, the shorter one strays by at most r. **A tie says yes.**
    #[inline(always)]
    fn strays_little<R: Real>(sine: R, length_a: R, length_b: R, t: &Tolerances<R>) -> bool {
        sine * length_a.smaller(length_b) <= t.territory
    }

    /// The foot of the common perpendicular, `along` the edge from its start, lies strictly inside it. **A tie says no.**
    #[inline(always)]
    fn feet_inside<R: Real>(along: R, length: R) -> bool {
        along > R::ZERO && along < length
    }

    /// e-e: the gap is at most s. **A tie says yes.**
    #[inline(always)]
    fn edge_edge_near<R: Real>(gap: R, search: R) -> bool {
        gap <= search
    }

    /// e-e: the gap is at least −g. **A tie says yes.**
    #[inline(always)]
    fn edge_edge_depth<R: Real>(gap: R, penetration: R) -> bool {
        gap >= -penetration
    }

    /// σ is + when A's faces lean more to `d₁ × d₂` than B's. **A tie says +.**
    #[inline(always)]
    fn sigma_is_positive<R: Real>(lean: R) -> bool {
        lean >= R::ZERO
    }

    /// One of A's two faces at an edge rises from the plane, `n·m ≥ 0`, or dips within the tolerance. **A tie says yes.**
    #[inline(always)]
    fn wedge_of_a_passes<R: Real>(rise: R, width: R, t: &Tolerances<R>) -> bool {
        rise >= R::ZERO || Self::dip_is_within(rise.abs(), width, t)
    }

    /// One of B's two faces at an edge falls from the plane, `n·m ≤ 0`, or rises within the tolerance. **A tie says yes.**
    #[inline(always)]
    fn wedge_of_b_passes<R: Real>(rise: R, width: R, t: &Tolerances<R>) -> bool {
        rise <= R::ZERO || Self::dip_is_within(rise.abs(), width, t)
    }

    /// True exit, cone: one edge at a vertex rises from a face plane, `u·n ≥ 0`, or its far end dips by at most r/10; under
    /// classic whatever passes. **A tie says yes.**
    #[inline(always)]
    fn true_exit_of_cone<R: Real>(rise: R, length: R, t: &Tolerances<R>) -> bool {
        !t.revised || rise >= R::ZERO || Self::true_exit_dip(rise.abs(), length, t)
    }

    /// True exit, wedges: one of A's two faces at an edge rises from the plane, `n·m ≥ 0`, or dips by at most r/10; under
    /// classic whatever passes. **A tie says yes.**
    #[inline(always)]
    fn true_exit_of_wedge_a<R: Real>(rise: R, width: R, t: &Tolerances<R>) -> bool {
        !t.revised || rise >= R::ZERO || Self::true_exit_dip(rise.abs(), width, t)
    }

    /// True exit, wedges: one of B's two faces at an edge falls from the plane, `n·m ≤ 0`, or rises by at most r/10; under
    /// classic whatever passes. **A tie says yes.**
    #[inline(always)]
    fn true_exit_of_wedge_b<R: Real>(rise: R, width: R, t: &Tolerances<R>) -> bool {
        !t.revised || rise <= R::ZERO || Self::true_exit_dip(rise.abs(), width, t)
    }

    /// Something of this length, dipping at this sine, dips by at most r/10. A product, because a tenth would round.
    /// **A tie says yes.**
    #[inline(always)]
    fn true_exit_dip<R: Real>(sine: R, length: R, t: &Tolerances<R>) -> bool {
        R::from_f64(10.0) * (sine * length) <= t.territory
    }

    /// Whether v-v and v-e take their entrance among true exits, where there is one.
    #[inline(always)]
    fn true_exits_before_others() -> bool {
        true
    }

    /// Whether test 5 takes its one exit among true exits, where there is one.
    #[inline(always)]
    fn one_exit_is_true() -> bool {
        true
    }

    /// The normal from B to A of a face of A: its outward normal reversed.
    #[inline(always)]
    fn normal_of_a<R: Real>(outward: Vector<R>) -> Vector<R> {
        -outward
    }

    /// Whether entrances of v-v and v-e may be spanned by edges as well as by faces.
    #[inline(always)]
    fn edge_entrances() -> bool {
        true
    }

    /// The place of a kind of entrance in the order that breaks ties: v-f, f-v, e-e.
    #[inline(always)]
    fn entrance_order(kind: EntranceKind) -> EntranceKind {
        kind
    }

    /// A gap is a better entrance or exit than the best so far: the largest one wins. **A tie keeps the first.**
    #[inline(always)]
    fn better<R: Real>(gap: R, best: R) -> bool {
        best.below(gap)
    }

    /// Eq. (1): a gap counts as equal to the largest, `h ≥ best − ε·|best|`. **A tie says yes.**
    #[inline(always)]
    fn equals_best<R: Real>(gap: R, best: R, equal: R) -> bool {
        gap >= best - equal * best.abs()
    }

    /// v-v, v-e: the chosen entrance has a gap of at least −g. **A tie says yes.**
    #[inline(always)]
    fn entrance_depth<R: Real>(gap: R, penetration: R) -> bool {
        gap >= -penetration
    }

    /// The sign of a gap.
    #[inline(always)]
    fn gap_sign<R: Real>(gap: R) -> Sign {
        match gap.partial_cmp(&R::ZERO) {
            Some(ordering) => Sign::of_ordering(ordering),
            None => Sign::Zero,
        }
    }

    /// A gap is an overlap, h < 0. **A tie says no.**
    #[inline(always)]
    fn overlaps<R: Real>(gap: R) -> bool {
        gap < R::ZERO
    }

    /// Whether test 3's shortest exit applies: unless both blocks are convex.
    #[inline(always)]
    fn shortest_exit_applies(both_convex: bool) -> bool {
        !both_convex
    }

    /// Whether two faces that a vertex overlaps share one exit through their common edge: when it is convex.
    #[inline(always)]
    fn joins_exits(edge_is_convex: bool) -> bool {
        edge_is_convex
    }

    /// Whether test 5 applies: to two convex blocks.
    #[inline(always)]
    fn one_exit_applies(both_convex: bool) -> bool {
        both_convex
    }

    /// A normal is within the overlap angle of the chosen one: the same way round, and the sine between them is at most
    /// so. **A tie of the sine says yes, a right angle no.**
    #[inline(always)]
    fn same_exit<R: Real>(cosine: R, sine: R, overlap_sine: R) -> bool {
        cosine > R::ZERO && sine <= overlap_sine
    }

    /// The contacts by these rules. [`SpecRules`] takes the code compiled in this crate.
    #[doc(hidden)]
    fn contacts<R: Real>(request: ClassificationRequest<'_, R>) -> Vec<ComputedContact<R>>
    where
        Self: Sized,
    {
        contacts::<R, Self>(request)
    }

    /// The same with every decision made on the way.
    #[doc(hidden)]
    fn traced<R: Real>(request: ClassificationRequest<'_, R>) -> TracedContacts<R>
    where
        Self: Sized,
    {
        traced::<R, Self>(request)
    }
}

/// The rules as SPEC section 4 states them.
#[derive(Clone, Copy, Debug, Default)]
pub struct SpecRules;

impl ContactRules for SpecRules {
    fn contacts<R: Real>(request: ClassificationRequest<'_, R>) -> Vec<ComputedContact<R>> {
        R::contacts(request)
    }

    fn traced<R: Real>(request: ClassificationRequest<'_, R>) -> TracedContacts<R> {
        R::traced(request)
    }
}
