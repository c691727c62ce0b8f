//! Which pairs of features can be in a contact while two blocks stay near where they are.
//!
//! Of most pairs of features the tests of SPEC section 4 refuse a contact, and would still do so if every vertex moved a little. [`NearbyFeatures::of`]
//! finds the others: it makes the tests once in [`MotionInterval`], where every coordinate stands for all within a margin, and leaves out what is refused wherever
//! the vertices are in it. As long as they are, only the others need be put through the tests, and give the same contacts bit for bit.

use crate::contact::contact_rules::ContactRules;
use crate::contact::entrance::KnownPlane;
use crate::contact::pair::Pair;
use crate::contact::trace::Observer;
use crate::real::Real;
use rockproof_model::decision::Side;
use rockproof_model::{ContactKind, EdgeId, FaceId, VertexId};

/// Pairs of features of two convex blocks, of which alone contacts are to be looked for.
#[derive(Clone, Debug)]
pub struct NearbyFeatures {
    pub(super) pairs: Box<[NearbyPair]>,
}

/// A pair of features, in 16 bytes.
#[derive(Clone, Copy, Debug)]
pub(super) struct NearbyPair {
    pub(super) planes: Planes,
    /// The number of A's feature.
    pub(super) a: u16,
    /// The number of B's feature.
    pub(super) b: u16,
    pub(super) kind: ContactKind,
}

/// What is known of a pair of features and of the planes that may be the entrance of its contact, by their numbers; of v-f and e-e there is one plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Planes {
    /// Those that may pass; the last bit stands for all others.
    pub(super) possible: u16,
    /// Those that pass for certain.
    pub(super) passing: u16,
    /// Those that are true exits for certain.
    pub(super) exits: u16,
    /// Those that are certainly no true exits.
    pub(super) dead_ends: u16,
    /// Whether the features are where they have a contact, if a plane lets them.
    pub(super) meets: bool,
}

impl Planes {
    /// All are possible, and nothing is known.
    pub(super) const ALL: Planes = Planes { possible: u16::MAX, passing: 0, exits: 0, dead_ends: 0, meets: false };
    pub(super) const NONE: Planes = Planes { possible: 0, ..Planes::ALL };
    const LAST: usize = 15;

    /// What is known of a plane that may pass.
    #[inline(always)]
    pub(super) fn known(self, number: usize) -> Option<KnownPlane> {
        let has = |of: u16| of >> number.min(Planes::LAST) & 1 == 1;
        let exits = (has(self.exits) || has(self.dead_ends)).then(|| has(self.exits));
        has(self.possible).then(|| KnownPlane { passes: has(self.passing), exits })
    }

    /// Whether the one plane is a true exit, where that is known.
    #[inline(always)]
    pub(super) fn exits(self) -> Option<bool> {
        self.known(0)?.exits
    }

    /// Makes a plane possible, of which this is known.
    pub(super) fn add(&mut self, number: usize, known: KnownPlane) {
        let bit = 1 << number.min(Planes::LAST);
        self.possible |= bit;
        // The last one is not one plane.
        if number < Planes::LAST {
            self.passing |= if known.passes { bit } else { 0 };
            self.exits |= if known.exits == Some(true) { bit } else { 0 };
            self.dead_ends |= if known.exits == Some(false) { bit } else { 0 };
        }
    }
}

impl NearbyFeatures {
    /// How many they are.
    pub fn len(&self) -> usize {
        self.pairs.len()
    }

    /// Whether there are none: then there is no contact.
    pub fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }
}

impl<R: Real, M: ContactRules, O: Observer> Pair<'_, R, M, O> {
    /// Records the contacts of these pairs of features.
    pub(super) fn look_among(&mut self, nearby: &NearbyFeatures) {
        for &NearbyPair { planes, a, b, kind } in &nearby.pairs {
            let (a, b) = (u32::from(a), u32::from(b));
            match kind {
                ContactKind::VertexVertex => self.vertex_vertex(VertexId(a), VertexId(b), planes),
                ContactKind::VertexEdge => self.vertex_edge(Side::A, VertexId(a), EdgeId(b), planes),
                ContactKind::EdgeVertex => self.vertex_edge(Side::B, VertexId(b), EdgeId(a), planes),
                ContactKind::VertexFace => self.vertex_face(Side::A, VertexId(a), FaceId(b), planes),
                ContactKind::FaceVertex => self.vertex_face(Side::B, VertexId(b), FaceId(a), planes),
                ContactKind::EdgeEdge => self.edge_edge(EdgeId(a), EdgeId(b), planes),
            }
        }
    }
}
