//! Steppers with one deliberate mistake each: what a campaign must be able to find.

use rockproof::model::{EntranceKind, Sign};
use rockproof::stepper::contact::solid::Spoke;
use rockproof::stepper::contact::{Rules, Tolerances};
pub(crate) use rockproof::stepper::{Classifier as MistakenEngine, Stepper};
use rockproof::stepper::{Real, Vector};

macro_rules! mistakes {
    ($($name:ident $slug:literal { $($body:tt)* })*) => {
        $(
            struct $name;
            impl Rules for $name { $($body)* }
        )*

        /// Every mistake by name, as a stepper that makes it.
        pub(crate) fn all() -> Vec<(&'static str, Box<dyn MistakenEngine>)> {
            vec![$(($slug, Box::new(Stepper::<$name>::new()))),*]
        }
    };
}

mistakes! {
    NeighboursStrict "neighbours: touching boxes do not meet" {
        fn neighbours<R: Real>(apart: R, search: R) -> bool { apart < search }
    }
    NeighboursUngrown "neighbours: box not grown by s" {
        fn neighbours<R: Real>(apart: R, _: R) -> bool { apart <= R::ZERO }
    }
    NoEdgeVertex "no e-v test" {
        fn edge_vertex_role() -> bool { false }
    }
    NoFaceVertex "no f-v test" {
        fn face_vertex_role() -> bool { false }
    }
    AllVerticesConvex "convexity of vertices ignored" {
        fn vertex_takes_part(_: bool) -> bool { true }
    }
    AllEdgesConvex "convexity of edges ignored" {
        fn edge_takes_part(_: bool) -> bool { true }
    }
    LambdaHalf "lambda is 1/2" {
        fn lambda<R: Real>() -> R { R::from_f64(0.5) }
    }
    ClassicTerritory "classic territories have radius r" {
        fn vertex_radius<R: Real>(t: &Tolerances<R>, shortest: R) -> R {
            if t.revised { t.territory.smaller(Self::lambda::<R>() * shortest) } else { t.territory }
        }
    }
    VertexRadiusUnbounded "a vertex's territory ignores its shortest edge" {
        fn vertex_radius<R: Real>(t: &Tolerances<R>, _: R) -> R {
            if t.revised { t.territory } else { t.search }
        }
    }
    EdgeRadiusOfWiderFace "an edge's territory by its wider face" {
        fn edge_radius<R: Real>(t: &Tolerances<R>, width_left: R, width_right: R) -> R {
            if t.revised { t.territory.smaller(Self::lambda::<R>() * width_left.larger(width_right)) } else { t.search }
        }
    }
    EdgeRadiusOfLeftFace "an edge's territory by its left face alone" {
        fn edge_radius<R: Real>(t: &Tolerances<R>, width_left: R, _: R) -> R {
            if t.revised { t.territory.smaller(Self::lambda::<R>() * width_left) } else { t.search }
        }
    }
    LargerRadius "two vertices: the larger territory" {
        fn shared_radius<R: Real>(a: R, b: R) -> R { a.larger(b) }
    }
    VertexVertexNearStrict "v-v: distance < s" {
        fn vertex_vertex_near<R: Real>(distance: R, search: R) -> bool { distance < search }
    }
    VertexVertexByTerritory "v-v: distance compared with s/2" {
        fn vertex_vertex_near<R: Real>(distance: R, search: R) -> bool { distance <= search * R::from_f64(0.5) }
    }
    VertexTerritoryStrict "vertex territory: distance < radius" {
        fn vertex_territory<R: Real>(distance: R, radius: R) -> bool { distance < radius }
    }
    VertexRegionFlipped "vertex region: sign flipped" {
        fn vertex_region<R: Real>(along: R) -> bool { along >= R::ZERO }
    }
    VertexRegionStrict "vertex region: strict" {
        fn vertex_region<R: Real>(along: R) -> bool { along < R::ZERO }
    }
    OneRegion "v-v: only A's vertex in B's region" {
        fn both_regions() -> bool { false }
    }
    RegionForgetsAnEdge "region of a vertex forgets its last edge" {
        fn region<R: Real>(spokes: &[Spoke<R>]) -> &[Spoke<R>] { &spokes[..spokes.len() - 1] }
    }
    FootInsideClosed "foot inside: ends count" {
        fn foot_inside<R: Real>(from_p: R, from_q: R) -> bool { from_p >= R::ZERO && from_q <= R::ZERO }
    }
    FootInsideHalf "foot inside: only the first end is checked" {
        fn foot_inside<R: Real>(from_p: R, _: R) -> bool { from_p > R::ZERO }
    }
    VertexEdgeNearStrict "v-e: distance < s" {
        fn vertex_edge_near<R: Real>(distance: R, search: R) -> bool { distance < search }
    }
    EdgeTerritoryStrict "edge territory: distance < radius" {
        fn edge_territory<R: Real>(distance: R, radius: R) -> bool { distance < radius }
    }
    EdgeRegionFlipped "edge region: sign flipped" {
        fn edge_region<R: Real>(inward: R) -> bool { inward >= R::ZERO }
    }
    EdgeRegionStrict "edge region: strict" {
        fn edge_region<R: Real>(inward: R) -> bool { inward < R::ZERO }
    }
    FootRegionFlipped "foot region: sign flipped" {
        fn foot_region<R: Real>(along: R) -> bool { along >= R::ZERO }
    }
    FootRegionStrict "foot region: strict" {
        fn foot_region<R: Real>(along: R) -> bool { along < R::ZERO }
    }
    EdgesBeforeEnds "v-e: territory of the edge's ends ignored" {
        fn ends_before_edge() -> bool { false }
    }
    VertexFaceNearStrict "v-f: gap < s" {
        fn vertex_face_near<R: Real>(gap: R, search: R) -> bool { gap < search }
    }
    VertexFaceDepthStrict "v-f: gap > -g" {
        fn vertex_face_depth<R: Real>(gap: R, penetration: R) -> bool { gap > -penetration }
    }
    VertexFaceNoDepth "v-f: no gap >= -g" {
        fn vertex_face_depth<R: Real>(_: R, _: R) -> bool { true }
    }
    InsideFaceClosed "v-f: the rim counts as inside" {
        fn inside_face<R: Real>(inward: R) -> bool { inward >= R::ZERO }
    }
    FacesBeforeVertices "v-f, e-e: territory of vertices ignored" {
        fn vertices_before_faces_and_edges() -> bool { false }
    }
    FacesBeforeEdges "v-f, e-e: territory of edges ignored" {
        fn edges_before_faces_and_edges() -> bool { false }
    }
    ConeForgetsAnEdge "cone: the last edge at a vertex forgotten" {
        fn cone<R: Real>(spokes: &[Spoke<R>]) -> &[Spoke<R>] { &spokes[..spokes.len() - 1] }
    }
    ConeFlipped "cone: sign flipped" {
        fn cone_passes<R: Real>(rise: R, length: R, t: &Tolerances<R>) -> bool {
            rise <= R::ZERO || rise.abs() <= t.overlap_sine || (t.revised && Self::dip_is_short(rise.abs(), length, t))
        }
    }
    ConeWithoutAngle "cone: overlap angle ignored" {
        fn cone_passes<R: Real>(rise: R, length: R, t: &Tolerances<R>) -> bool {
            rise >= R::ZERO || (t.revised && Self::dip_is_short(rise.abs(), length, t))
        }
    }
    ConeStrict "cone: a tie of the overlap angle fails" {
        fn cone_passes<R: Real>(rise: R, length: R, t: &Tolerances<R>) -> bool {
            rise > R::ZERO || rise.abs() < t.overlap_sine || (t.revised && Self::dip_is_short(rise.abs(), length, t))
        }
    }
    NoShortDip "revised no-overlap check forgets the length g" {
        fn dip_is_short<R: Real>(_: R, _: R, _: &Tolerances<R>) -> bool { false }
    }
    ShortDipBySearch "revised no-overlap check compares with s" {
        fn dip_is_short<R: Real>(sine: R, length: R, t: &Tolerances<R>) -> bool { sine * length <= t.search }
    }
    ParallelStrict "nearly parallel: strict" {
        fn nearly_parallel<R: Real>(sine: R, length_a: R, length_b: R, t: &Tolerances<R>) -> bool {
            sine < t.parallel_sine || (t.revised && sine * length_a.smaller(length_b) < t.territory)
        }
    }
    ParallelByAngleAlone "nearly parallel: revised length r forgotten" {
        fn nearly_parallel<R: Real>(sine: R, _: R, _: R, t: &Tolerances<R>) -> bool { sine <= t.parallel_sine }
    }
    ParallelByLongerEdge "nearly parallel: the longer edge" {
        fn nearly_parallel<R: Real>(sine: R, length_a: R, length_b: R, t: &Tolerances<R>) -> bool {
            sine <= t.parallel_sine || (t.revised && sine * length_a.larger(length_b) <= t.territory)
        }
    }
    FeetInsideClosed "e-e: feet at the ends count" {
        fn feet_inside<R: Real>(along: R, length: R) -> bool { along >= R::ZERO && along <= length }
    }
    EdgeEdgeNearStrict "e-e: gap < s" {
        fn edge_edge_near<R: Real>(gap: R, search: R) -> bool { gap < search }
    }
    EdgeEdgeDepthStrict "e-e: gap > -g" {
        fn edge_edge_depth<R: Real>(gap: R, penetration: R) -> bool { gap > -penetration }
    }
    EdgeEdgeNoDepth "e-e: no gap >= -g" {
        fn edge_edge_depth<R: Real>(_: R, _: R) -> bool { true }
    }
    SigmaTieNegative "sigma: a tie gives minus" {
        fn sigma_is_positive<R: Real>(lean: R) -> bool { lean > R::ZERO }
    }
    SigmaFlipped "sigma: sign flipped" {
        fn sigma_is_positive<R: Real>(lean: R) -> bool { lean <= R::ZERO }
    }
    WedgeForgetsA "wedges: A's faces forgotten" {
        fn wedge_of_a_passes<R: Real>(_: R, _: R, _: &Tolerances<R>) -> bool { true }
    }
    WedgeForgetsB "wedges: B's faces forgotten" {
        fn wedge_of_b_passes<R: Real>(_: R, _: R, _: &Tolerances<R>) -> bool { true }
    }
    WedgeWithoutTolerance "wedges: no tolerance for A" {
        fn wedge_of_a_passes<R: Real>(rise: R, _: R, _: &Tolerances<R>) -> bool { rise >= R::ZERO }
    }
    NormalNotNegated "f-v: normal not negated" {
        fn normal_of_a<R: Real>(outward: Vector<R>) -> Vector<R> { outward }
    }
    NoEdgeEntrances "v-v, v-e: no e-e entrances" {
        fn edge_entrances() -> bool { false }
    }
    EdgeEntranceFirst "ties: e-e entrances first" {
        fn entrance_order(kind: EntranceKind) -> EntranceKind {
            match kind {
                EntranceKind::VertexFace => EntranceKind::FaceVertex,
                EntranceKind::FaceVertex => EntranceKind::EdgeEdge,
                EntranceKind::EdgeEdge => EntranceKind::VertexFace,
            }
        }
    }
    FaceVertexFirst "ties: f-v entrances before v-f" {
        fn entrance_order(kind: EntranceKind) -> EntranceKind {
            match kind {
                EntranceKind::VertexFace => EntranceKind::FaceVertex,
                EntranceKind::FaceVertex => EntranceKind::VertexFace,
                EntranceKind::EdgeEdge => EntranceKind::EdgeEdge,
            }
        }
    }
    SmallestGap "entrances and exits: the smallest gap wins" {
        fn better<R: Real>(gap: R, best: R) -> bool { gap.below(best) }
        fn equals_best<R: Real>(gap: R, best: R, equal: R) -> bool { gap <= best + equal * best.abs() }
    }
    EqualOnWrongSide "Eq. (1): above the largest gap" {
        fn equals_best<R: Real>(gap: R, best: R, equal: R) -> bool { gap >= best + equal * best.abs() }
    }
    EqualBySign "Eq. (1): without the absolute value" {
        fn equals_best<R: Real>(gap: R, best: R, equal: R) -> bool { gap >= best - equal * best }
    }
    EqualAbsolute "Eq. (1): absolute" {
        fn equals_best<R: Real>(gap: R, best: R, equal: R) -> bool { gap >= best - equal }
    }
    EqualStrict "Eq. (1): strict" {
        fn equals_best<R: Real>(gap: R, best: R, equal: R) -> bool { gap > best - equal * best.abs() }
    }
    EntranceNoDepth "v-v, v-e: no gap >= -g" {
        fn entrance_depth<R: Real>(_: R, _: R) -> bool { true }
    }
    EntranceDepthStrict "v-v, v-e: gap > -g" {
        fn entrance_depth<R: Real>(gap: R, penetration: R) -> bool { gap > -penetration }
    }
    GapSignFlipped "the sign of gaps flipped" {
        fn gap_sign<R: Real>(gap: R) -> Sign {
            gap.partial_cmp(&R::ZERO).map_or(Sign::Zero, |ordering| Sign::of_ordering(ordering.reverse()))
        }
    }
    GapSignWithoutTie "a zero gap counts as apart" {
        fn gap_sign<R: Real>(gap: R) -> Sign { if gap >= R::ZERO { Sign::Positive } else { Sign::Negative } }
    }
    TouchingOverlaps "exits: a zero gap counts as overlap" {
        fn overlaps<R: Real>(gap: R) -> bool { gap <= R::ZERO }
    }
    NoShortestExit "no shortest exit" {
        fn shortest_exit_applies(_: bool) -> bool { false }
    }
    ShortestExitAlways "shortest exit for two convex blocks" {
        fn shortest_exit_applies(_: bool) -> bool { true }
    }
    ExitsNotJoined "shortest exit: faces never joined" {
        fn joins_exits(_: bool) -> bool { false }
    }
    NoOneExit "no one exit" {
        fn one_exit_applies(_: bool) -> bool { false }
    }
    OneExitForConcave "one exit for concave blocks" {
        fn one_exit_applies(_: bool) -> bool { true }
    }
    OneExitEitherWay "one exit: either way round" {
        fn same_exit<R: Real>(_: R, sine: R, overlap_sine: R) -> bool { sine <= overlap_sine }
    }
    OneExitWithoutAngle "one exit: the angle forgotten" {
        fn same_exit<R: Real>(cosine: R, _: R, _: R) -> bool { cosine > R::ZERO }
    }
}
