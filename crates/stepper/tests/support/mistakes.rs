//! Steppers with one deliberate mistake each: what a campaign must be able to find.
//!
//! One implementation of the rules looks up at run time which mistake is planted, so that the stepper is compiled once and not
//! once for each mistake.

#![allow(dead_code)] // each test program uses its own part

mod mistaken_rules;

use Mistake::*;
use mistaken_rules::MistakenRules;
use rockproof_model::{Block, Contact, ContactKey, ExpectedContact, ToleranceSet};
use rockproof_stepper::engine::{contacts_with_kept, settled_contacts, settled_departures};
use rockproof_stepper::{Classifier, EngineError, Real, Stepper};
use std::cell::Cell;

macro_rules! mistakes {
    ($($name:ident $slug:literal),*; $($kept:ident $kept_slug:literal,)*) => {
        /// What can be wrong.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        enum Mistake { $($name,)* $($kept),* }

        /// Every mistake by name that shows without kept contacts, as a stepper that makes it.
        pub(crate) fn all() -> Vec<(&'static str, Mistaken)> {
            vec![$(($slug, Mistaken($name))),*]
        }

        /// Every mistake by name that shows only in a step, with kept contacts.
        pub(crate) fn in_steps() -> Vec<(&'static str, Mistaken)> {
            vec![$(($kept_slug, Mistaken($kept))),*]
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
    RegionForgetsOneOfMany "region of a vertex: the last edge of five or more forgotten",
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
    ConeForgetsOneOfMany "cone: the last edge of five or more forgotten",
    ConeFlipped "cone: sign flipped",
    ConeWithoutAngle "cone: overlap angle ignored",
    ConeStrict "cone: strict",
    ConeEitherMeasure "cone: either measure instead of both",
    DipByAngleAlone "revised no-overlap check forgets the length g",
    DipBySearch "revised no-overlap check compares with s",
    DipStrict "revised no-overlap check: a tie of the length g fails",
    ConeClassicByBoth "cone: classic measures the length too",
    ParallelStrict "nearly parallel: strict",
    ParallelByAngleAlone "nearly parallel: revised length r forgotten",
    ParallelByLengthAlone "nearly parallel: revised angle forgotten",
    ParallelEitherMeasure "nearly parallel: either measure instead of both",
    ClassicParallelByBoth "nearly parallel: classic measures the length too",
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
    WedgeAEitherMeasure "wedges: either measure instead of both for A",
    WedgeBEitherMeasure "wedges: either measure instead of both for B",
    EntranceOfAll "entrance: true exits ignored",
    OneExitOfAll "one exit: true exits ignored",
    TrueExitFlipped "true exit of a cone: sign flipped",
    TrueExitForgetsCone "true exit: every cone",
    TrueExitForgetsA "true exit: A's faces forgotten",
    TrueExitForgetsB "true exit: B's faces forgotten",
    TrueExitWithoutTolerance "true exit: no tolerance",
    TrueExitByTerritory "true exit: tolerance r instead of r/10",
    TrueExitStrict "true exit: a tie of the length fails",
    TrueExitByAngle "true exit: the overlap angle, not the length",
    ClassicTrueExits "true exit: classic treated like revised",
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
    OneExitWithoutAngle "one exit: the angle forgotten";
    KeptIgnored "kept contacts ignored",
    KeptAll "every contact of a pair with kept ones counts as kept",
    KeptByFeatures "kept contacts: the kind forgotten",
    KeptByKind "kept contacts: the features forgotten",
    KeptByFeatureOfA "kept contacts: B's feature forgotten",
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

    /// The contacts in the scalar `R` in a step that keeps these.
    pub(crate) fn contacts_with_kept<R: Real>(
        self,
        a: &Block,
        b: &Block,
        t: &ToleranceSet,
        kept: &[ContactKey],
    ) -> Result<Vec<Contact>, EngineError> {
        self.planted(|_| contacts_with_kept::<R, MistakenRules>(a, b, t, kept))
    }
}

impl Mistaken {
    /// The contacts where every comparison is settled.
    pub(crate) fn settled(self, a: &Block, b: &Block, t: &ToleranceSet) -> Result<Option<Vec<Contact>>, EngineError> {
        self.planted(|_| settled_contacts::<MistakenRules>(a, b, t))
    }

    /// Those that are otherwise than expected, likewise.
    pub(crate) fn departures(
        self,
        a: &Block,
        b: &Block,
        t: &ToleranceSet,
        expected: &[ExpectedContact],
    ) -> Result<Vec<ContactKey>, EngineError> {
        self.planted(|_| settled_departures::<MistakenRules>(a, b, t, expected))
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
