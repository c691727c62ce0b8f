//! The rules with the mistake that is planted on this thread, one place for each rule.

use super::Mistake::*;
use super::PLANTED;
use rockproof_model::{ContactKey, EdgeId, EntranceKind, Sign};
use rockproof_stepper::contact::{ContactRules, SpecRules, Tolerances};
use rockproof_stepper::{Real, Vector};

/// Methods of [`ContactRules`] by the mistakes they are wrong under; otherwise they are those of `$right`.
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

/// Version 1's reading of the revised tolerance: the angle or the length.
fn either_measure<R: Real>(dip: R, length: R, t: &Tolerances<R>) -> bool {
    dip <= R::ZERO || dip <= t.overlap_sine || (t.revised && dip * length <= t.penetration)
}

/// The edges at a vertex without the last where there are five or more, as of a list that is too short for them.
fn without_one_of_many(edges: &[EdgeId]) -> &[EdgeId] {
    if edges.len() >= 5 { &edges[..edges.len() - 1] } else { edges }
}

/// The rules that other rules are made of.
struct MistakenParts;

impl ContactRules for MistakenParts {
    wrong_under! {
        SpecRules:
        fn lambda<R>() -> R {
            LambdaHalf => R::from_f64(0.5)
        }
        fn dip_is_short<R>(sine: R, length: R, t: &Tolerances<R>) -> bool {
            DipByAngleAlone => true
            DipBySearch => sine * length <= t.search
            DipStrict => sine * length < t.penetration
        }
        fn strays_little<R>(sine: R, length_a: R, length_b: R, t: &Tolerances<R>) -> bool {
            ParallelByAngleAlone => true
            ParallelByLongerEdge => sine * length_a.larger(length_b) <= t.territory
        }
        fn true_exit_dip<R>(sine: R, length: R, t: &Tolerances<R>) -> bool {
            TrueExitWithoutTolerance => false
            TrueExitByTerritory => sine * length <= t.territory
            TrueExitStrict => R::from_f64(10.0) * (sine * length) < t.territory
            TrueExitByAngle => sine <= t.overlap_sine
        }
    }
}

/// The rules with the mistake that is planted on this thread.
pub(super) struct MistakenRules;

impl ContactRules for MistakenRules {
    fn lambda<R: Real>() -> R {
        MistakenParts::lambda()
    }

    fn dip_is_short<R: Real>(sine: R, length: R, t: &Tolerances<R>) -> bool {
        MistakenParts::dip_is_short(sine, length, t)
    }

    fn strays_little<R: Real>(sine: R, length_a: R, length_b: R, t: &Tolerances<R>) -> bool {
        MistakenParts::strays_little(sine, length_a, length_b, t)
    }

    fn true_exit_dip<R: Real>(sine: R, length: R, t: &Tolerances<R>) -> bool {
        MistakenParts::true_exit_dip(sine, length, t)
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
        fn cone(edges: &[EdgeId]) -> &[EdgeId] {
            ConeForgetsAnEdge => &edges[..edges.len() - 1]
            ConeForgetsOneOfMany => without_one_of_many(edges)
        }
        fn region(edges: &[EdgeId]) -> &[EdgeId] {
            RegionForgetsAnEdge => &edges[..edges.len() - 1]
            RegionForgetsOneOfMany => without_one_of_many(edges)
        }
        fn cone_passes<R>(rise: R, length: R, t: &Tolerances<R>) -> bool {
            ConeFlipped => rise <= R::ZERO || Self::dip_is_within(rise.abs(), length, t)
            ConeWithoutAngle => rise >= R::ZERO || (t.revised && Self::dip_is_short(rise.abs(), length, t))
            ConeStrict => rise > R::ZERO || rise.abs() < t.overlap_sine && (!t.revised || rise.abs() * length < t.penetration)
            ConeClassicByBoth => {
                rise >= R::ZERO || rise.abs() <= t.overlap_sine && Self::dip_is_short(rise.abs(), length, t)
            }
            ConeEitherMeasure => either_measure(-rise, length, t)
        }
        fn nearly_parallel<R>(sine: R, length_a: R, length_b: R, t: &Tolerances<R>) -> bool {
            ParallelStrict => {
                sine < t.parallel_sine && (!t.revised || sine * length_a.smaller(length_b) < t.territory)
            }
            ParallelByLengthAlone => t.revised && Self::strays_little(sine, length_a, length_b, t)
            ParallelEitherMeasure => {
                sine <= t.parallel_sine || (t.revised && Self::strays_little(sine, length_a, length_b, t))
            }
            ClassicParallelByBoth => sine <= t.parallel_sine && Self::strays_little(sine, length_a, length_b, t)
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
            WedgeAEitherMeasure => either_measure(-rise, width, t)
        }
        fn wedge_of_b_passes<R>(rise: R, width: R, t: &Tolerances<R>) -> bool {
            WedgeForgetsB => true
            WedgeBEitherMeasure => either_measure(rise, width, t)
        }
        fn true_exit_of_cone<R>(rise: R, length: R, t: &Tolerances<R>) -> bool {
            TrueExitFlipped => !t.revised || rise <= R::ZERO || Self::true_exit_dip(rise.abs(), length, t)
            TrueExitForgetsCone => true
            ClassicTrueExits => rise >= R::ZERO || Self::true_exit_dip(rise.abs(), length, t)
        }
        fn true_exit_of_wedge_a<R>(rise: R, width: R, t: &Tolerances<R>) -> bool {
            TrueExitForgetsA => true
        }
        fn true_exit_of_wedge_b<R>(rise: R, width: R, t: &Tolerances<R>) -> bool {
            TrueExitForgetsB => true
        }
        fn true_exits_before_others() -> bool {
            EntranceOfAll => false
        }
        fn one_exit_is_true() -> bool {
            OneExitOfAll => false
        }
        fn is_kept(kept: &[ContactKey], contact: ContactKey) -> bool {
            KeptIgnored => false
            KeptAll => !kept.is_empty()
            KeptByFeatures => kept.iter().any(|k| k.numbers() == contact.numbers())
            KeptByKind => kept.iter().any(|k| k.kind() == contact.kind())
            KeptByFeatureOfA => kept.iter().any(|k| (k.kind(), k.features()[0]) == (contact.kind(), contact.features()[0]))
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
