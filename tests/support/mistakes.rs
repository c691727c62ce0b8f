//! Steppers with one deliberate mistake each: what a campaign must be able to find.
//!
//! One implementation of the rules looks up at run time which mistake is planted, so that the stepper is compiled once and not
//! once for each mistake.

use Mistake::*;
use rockproof_model::{Block, Contact, EntranceKind, Sign, ToleranceSet};
use rockproof_stepper::contact::{Rules, Spec, Tolerances};
use rockproof_stepper::{Classifier, EngineError, Real, Stepper, Vector};
use std::cell::Cell;

macro_rules! mistakes {
    ($($name:ident $slug:literal,)*) => {
        /// What can be wrong.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        enum Mistake { $($name),* }

        /// Every mistake by name, as a stepper that makes it.
        pub(crate) fn all() -> Vec<(&'static str, Mistaken)> {
            vec![$(($slug, Mistaken($name))),*]
        }
    };
}

mistakes! {
    NeighboursStrict "neighbours: touching boxes do not meet",
    NeighboursUngrown "neighbours: box not grown by s",
    NoEdgeVertex "no e-v test",
    NoFaceVertex "no f-v test",
    AllVerticesConvex "convexity of vertices ignored",
    AllEdgesConvex "convexity of edges ignored",
    LambdaHalf "lambda is 1/2",
    ClassicTerritory "classic territories have radius r",
    VertexRadiusUnbounded "a vertex's territory ignores its shortest edge",
    EdgeRadiusOfWiderFace "an edge's territory by its wider face",
    EdgeRadiusOfLeftFace "an edge's territory by its left face alone",
    LargerRadius "two vertices: the larger territory",
    VertexVertexNearStrict "v-v: distance < s",
    VertexVertexByTerritory "v-v: distance compared with s/2",
    VertexTerritoryStrict "vertex territory: distance < radius",
    VertexRegionFlipped "vertex region: sign flipped",
    VertexRegionStrict "vertex region: strict",
    OneRegion "v-v: only A's vertex in B's region",
    RegionForgetsAnEdge "region of a vertex forgets its last edge",
    FootInsideClosed "foot inside: ends count",
    FootInsideHalf "foot inside: only the first end is checked",
    VertexEdgeNearStrict "v-e: distance < s",
    EdgeTerritoryStrict "edge territory: distance < radius",
    EdgeRegionFlipped "edge region: sign flipped",
    EdgeRegionStrict "edge region: strict",
    FootRegionFlipped "foot region: sign flipped",
    FootRegionStrict "foot region: strict",
    EdgesBeforeEnds "v-e: territory of the edge's ends ignored",
    VertexFaceNearStrict "v-f: gap < s",
    VertexFaceDepthStrict "v-f: gap > -g",
    VertexFaceNoDepth "v-f: no gap >= -g",
    InsideFaceClosed "v-f: the rim counts as inside",
    FacesBeforeVertices "v-f, e-e: territory of vertices ignored",
    FacesBeforeEdges "v-f, e-e: territory of edges ignored",
    ConeForgetsAnEdge "cone: the last edge at a vertex forgotten",
    ConeFlipped "cone: sign flipped",
    ConeWithoutAngle "cone: overlap angle ignored",
    ConeStrict "cone: a tie of the overlap angle fails",
    NoShortDip "revised no-overlap check forgets the length g",
    ShortDipBySearch "revised no-overlap check compares with s",
    ParallelStrict "nearly parallel: strict",
    ParallelByAngleAlone "nearly parallel: revised length r forgotten",
    ParallelByLongerEdge "nearly parallel: the longer edge",
    FeetInsideClosed "e-e: feet at the ends count",
    EdgeEdgeNearStrict "e-e: gap < s",
    EdgeEdgeDepthStrict "e-e: gap > -g",
    EdgeEdgeNoDepth "e-e: no gap >= -g",
    SigmaTieNegative "sigma: a tie gives minus",
    SigmaFlipped "sigma: sign flipped",
    WedgeForgetsA "wedges: A's faces forgotten",
    WedgeForgetsB "wedges: B's faces forgotten",
    WedgeWithoutTolerance "wedges: no tolerance for A",
    NormalNotNegated "f-v: normal not negated",
    NoEdgeEntrances "v-v, v-e: no e-e entrances",
    EdgeEntranceFirst "ties: e-e entrances first",
    FaceVertexFirst "ties: f-v entrances before v-f",
    SmallestGap "entrances and exits: the smallest gap wins",
    EqualOnWrongSide "Eq. (1): above the largest gap",
    EqualBySign "Eq. (1): without the absolute value",
    EqualAbsolute "Eq. (1): absolute",
    EqualStrict "Eq. (1): strict",
    EntranceNoDepth "v-v, v-e: no gap >= -g",
    EntranceDepthStrict "v-v, v-e: gap > -g",
    GapSignFlipped "the sign of gaps flipped",
    GapSignWithoutTie "a zero gap counts as apart",
    TouchingOverlaps "exits: a zero gap counts as overlap",
    NoShortestExit "no shortest exit",
    ShortestExitAlways "shortest exit for two convex blocks",
    ExitsNotJoined "shortest exit: faces never joined",
    NoOneExit "no one exit",
    OneExitForConcave "one exit for concave blocks",
    OneExitEitherWay "one exit: either way round",
    OneExitWithoutAngle "one exit: the angle forgotten",
}

thread_local! {
    static PLANTED: Cell<Option<Mistake>> = const { Cell::new(None) };
}

/// The stepper with a mistake in it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mistaken(Mistake);

impl Mistaken {
    fn planted<T>(self, work: impl FnOnce(&Stepper<MistakenRules>) -> T) -> T {
        let before = PLANTED.replace(Some(self.0));
        let result = work(&Stepper::new());
        PLANTED.set(before);
        result
    }
}

impl Classifier for Mistaken {
    fn f32(&self, a: &Block, b: &Block, t: &ToleranceSet) -> Result<Vec<Contact>, EngineError> {
        self.planted(|stepper| stepper.f32(a, b, t))
    }

    fn f64(&self, a: &Block, b: &Block, t: &ToleranceSet) -> Result<Vec<Contact>, EngineError> {
        self.planted(|stepper| stepper.f64(a, b, t))
    }

    fn wide(&self, a: &Block, b: &Block, t: &ToleranceSet) -> Result<(Vec<Contact>, u64), EngineError> {
        self.planted(|stepper| stepper.wide(a, b, t))
    }
}

/// Methods of [`Rules`] by the mistakes they are wrong under; otherwise they are those of `$right`.
macro_rules! wrong_under {
    ($right:ident: $(fn $rule:ident $(<$real:ident>)? ($($arg:ident: $type:ty),*) -> $answer:ty {
        $($mistake:ident => $wrong:expr)*
    })*) => {
        $(
            fn $rule $(<$real: Real>)? ($($arg: $type),*) -> $answer {
                match PLANTED.get() {
                    $(Some($mistake) => $wrong,)*
                    _ => $right::$rule $(::<$real>)? ($($arg),*),
                }
            }
        )*
    };
}

/// The rules that other rules are made of.
struct MistakenParts;

impl Rules for MistakenParts {
    wrong_under! {
        Spec:
        fn lambda<R>() -> R {
            LambdaHalf => R::from_f64(0.5)
        }
        fn dip_is_short<R>(sine: R, length: R, t: &Tolerances<R>) -> bool {
            NoShortDip => false
            ShortDipBySearch => sine * length <= t.search
        }
    }
}

/// The rules with the mistake that is planted on this thread.
struct MistakenRules;

impl Rules for MistakenRules {
    fn lambda<R: Real>() -> R {
        MistakenParts::lambda()
    }

    fn dip_is_short<R: Real>(sine: R, length: R, t: &Tolerances<R>) -> bool {
        MistakenParts::dip_is_short(sine, length, t)
    }

    wrong_under! {
        MistakenParts:
        fn neighbours<R>(apart: R, search: R) -> bool {
            NeighboursStrict => apart < search
            NeighboursUngrown => apart <= R::ZERO
        }
        fn edge_vertex_role() -> bool {
            NoEdgeVertex => false
        }
        fn face_vertex_role() -> bool {
            NoFaceVertex => false
        }
        fn vertex_takes_part(convex: bool) -> bool {
            AllVerticesConvex => true
        }
        fn edge_takes_part(convex: bool) -> bool {
            AllEdgesConvex => true
        }
        fn vertex_radius<R>(t: &Tolerances<R>, shortest: R) -> R {
            ClassicTerritory => {
                if t.revised { t.territory.smaller(Self::lambda::<R>() * shortest) } else { t.territory }
            }
            VertexRadiusUnbounded => {
                if t.revised { t.territory } else { t.search }
            }
        }
        fn edge_radius<R>(t: &Tolerances<R>, width_left: R, width_right: R) -> R {
            EdgeRadiusOfWiderFace => {
                if t.revised { t.territory.smaller(Self::lambda::<R>() * width_left.larger(width_right)) } else { t.search }
            }
            EdgeRadiusOfLeftFace => {
                if t.revised { t.territory.smaller(Self::lambda::<R>() * width_left) } else { t.search }
            }
        }
        fn shared_radius<R>(a: R, b: R) -> R {
            LargerRadius => a.larger(b)
        }
        fn vertex_vertex_near<R>(distance: R, search: R) -> bool {
            VertexVertexNearStrict => distance < search
            VertexVertexByTerritory => distance <= search * R::from_f64(0.5)
        }
        fn vertex_territory<R>(distance: R, radius: R) -> bool {
            VertexTerritoryStrict => distance < radius
        }
        fn vertex_region<R>(along: R) -> bool {
            VertexRegionFlipped => along >= R::ZERO
            VertexRegionStrict => along < R::ZERO
        }
        fn both_regions() -> bool {
            OneRegion => false
        }
        fn foot_inside<R>(from_p: R, from_q: R) -> bool {
            FootInsideClosed => from_p >= R::ZERO && from_q <= R::ZERO
            FootInsideHalf => from_p > R::ZERO
        }
        fn vertex_edge_near<R>(distance: R, search: R) -> bool {
            VertexEdgeNearStrict => distance < search
        }
        fn edge_territory<R>(distance: R, radius: R) -> bool {
            EdgeTerritoryStrict => distance < radius
        }
        fn edge_region<R>(inward: R) -> bool {
            EdgeRegionFlipped => inward >= R::ZERO
            EdgeRegionStrict => inward < R::ZERO
        }
        fn foot_region<R>(along: R) -> bool {
            FootRegionFlipped => along >= R::ZERO
            FootRegionStrict => along < R::ZERO
        }
        fn ends_before_edge() -> bool {
            EdgesBeforeEnds => false
        }
        fn vertex_face_near<R>(gap: R, search: R) -> bool {
            VertexFaceNearStrict => gap < search
        }
        fn vertex_face_depth<R>(gap: R, penetration: R) -> bool {
            VertexFaceDepthStrict => gap > -penetration
            VertexFaceNoDepth => true
        }
        fn inside_face<R>(inward: R) -> bool {
            InsideFaceClosed => inward >= R::ZERO
        }
        fn vertices_before_faces_and_edges() -> bool {
            FacesBeforeVertices => false
        }
        fn edges_before_faces_and_edges() -> bool {
            FacesBeforeEdges => false
        }
        fn cone(edges: &[u32]) -> &[u32] {
            ConeForgetsAnEdge => &edges[..edges.len() - 1]
        }
        fn region(edges: &[u32]) -> &[u32] {
            RegionForgetsAnEdge => &edges[..edges.len() - 1]
        }
        fn cone_passes<R>(rise: R, length: R, t: &Tolerances<R>) -> bool {
            ConeFlipped => {
                rise <= R::ZERO || rise.abs() <= t.overlap_sine || (t.revised && Self::dip_is_short(rise.abs(), length, t))
            }
            ConeWithoutAngle => rise >= R::ZERO || (t.revised && Self::dip_is_short(rise.abs(), length, t))
            ConeStrict => {
                rise > R::ZERO || rise.abs() < t.overlap_sine || (t.revised && Self::dip_is_short(rise.abs(), length, t))
            }
        }
        fn nearly_parallel<R>(sine: R, length_a: R, length_b: R, t: &Tolerances<R>) -> bool {
            ParallelStrict => sine < t.parallel_sine || (t.revised && sine * length_a.smaller(length_b) < t.territory)
            ParallelByAngleAlone => sine <= t.parallel_sine
            ParallelByLongerEdge => {
                sine <= t.parallel_sine || (t.revised && sine * length_a.larger(length_b) <= t.territory)
            }
        }
        fn feet_inside<R>(along: R, length: R) -> bool {
            FeetInsideClosed => along >= R::ZERO && along <= length
        }
        fn edge_edge_near<R>(gap: R, search: R) -> bool {
            EdgeEdgeNearStrict => gap < search
        }
        fn edge_edge_depth<R>(gap: R, penetration: R) -> bool {
            EdgeEdgeDepthStrict => gap > -penetration
            EdgeEdgeNoDepth => true
        }
        fn sigma_is_positive<R>(lean: R) -> bool {
            SigmaTieNegative => lean > R::ZERO
            SigmaFlipped => lean <= R::ZERO
        }
        fn wedge_of_a_passes<R>(rise: R, width: R, t: &Tolerances<R>) -> bool {
            WedgeForgetsA => true
            WedgeWithoutTolerance => rise >= R::ZERO
        }
        fn wedge_of_b_passes<R>(rise: R, width: R, t: &Tolerances<R>) -> bool {
            WedgeForgetsB => true
        }
        fn normal_of_a<R>(outward: Vector<R>) -> Vector<R> {
            NormalNotNegated => outward
        }
        fn edge_entrances() -> bool {
            NoEdgeEntrances => false
        }
        fn entrance_order(kind: EntranceKind) -> EntranceKind {
            EdgeEntranceFirst => { match kind {
                    EntranceKind::VertexFace => EntranceKind::FaceVertex,
                    EntranceKind::FaceVertex => EntranceKind::EdgeEdge,
                    EntranceKind::EdgeEdge => EntranceKind::VertexFace,
                } }
            FaceVertexFirst => { match kind {
                    EntranceKind::VertexFace => EntranceKind::FaceVertex,
                    EntranceKind::FaceVertex => EntranceKind::VertexFace,
                    EntranceKind::EdgeEdge => EntranceKind::EdgeEdge,
                } }
        }
        fn better<R>(gap: R, best: R) -> bool {
            SmallestGap => gap.below(best)
        }
        fn equals_best<R>(gap: R, best: R, equal: R) -> bool {
            SmallestGap => gap <= best + equal * best.abs()
            EqualOnWrongSide => gap >= best + equal * best.abs()
            EqualBySign => gap >= best - equal * best
            EqualAbsolute => gap >= best - equal
            EqualStrict => gap > best - equal * best.abs()
        }
        fn entrance_depth<R>(gap: R, penetration: R) -> bool {
            EntranceNoDepth => true
            EntranceDepthStrict => gap > -penetration
        }
        fn gap_sign<R>(gap: R) -> Sign {
            GapSignFlipped => {
                gap.partial_cmp(&R::ZERO).map_or(Sign::Zero, |ordering| Sign::of_ordering(ordering.reverse()))
            }
            GapSignWithoutTie => {
                if gap >= R::ZERO { Sign::Positive } else { Sign::Negative }
            }
        }
        fn overlaps<R>(gap: R) -> bool {
            TouchingOverlaps => gap <= R::ZERO
        }
        fn shortest_exit_applies(both_convex: bool) -> bool {
            NoShortestExit => false
            ShortestExitAlways => true
        }
        fn joins_exits(edge_is_convex: bool) -> bool {
            ExitsNotJoined => false
        }
        fn one_exit_applies(both_convex: bool) -> bool {
            NoOneExit => false
            OneExitForConcave => true
        }
        fn same_exit<R>(cosine: R, sine: R, overlap_sine: R) -> bool {
            OneExitEitherWay => sine <= overlap_sine
            OneExitWithoutAngle => cosine > R::ZERO
        }
    }
}
