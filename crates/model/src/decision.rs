//! The names of the decisions that SPEC section 4 asks for, so that two implementations can be compared decision by
//! decision.

use crate::topology::{EdgeId, FaceId, Topology, VertexId};
use std::fmt;

crate::named_enum! {
    /// One kind of decision of SPEC section 4. Every decision is a yes or a no about named features of the pair.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
    pub enum Predicate: from_name, Display {
        /// Rough phase: A's box grown by s meets B's.
        Neighbours = "neighbours",
        /// A vertex is within `search` of a vertex: `|a − b| ≤ s`.
        VertexVertexNear = "vertex-vertex-near",
        /// A vertex lies in the territory of a vertex: `|a − b| ≤ min(r_a, r_b)`.
        VertexTerritory = "vertex-territory",
        /// A vertex lies in the region of a vertex with respect to one edge there: `(a − b)·e ≤ 0`.
        VertexRegion = "vertex-region",
        /// The foot of a vertex lies strictly inside an edge.
        FootInside = "foot-inside",
        /// A vertex is within `search` of an edge's line.
        VertexEdgeNear = "vertex-edge-near",
        /// A vertex lies in the territory of an edge: its distance to the line is ≤ r_e.
        EdgeTerritory = "edge-territory",
        /// A vertex lies in the region of an edge with respect to one of its faces: `(a − p)·m ≤ 0`.
        EdgeRegion = "edge-region",
        /// The foot on an edge lies in the region of a vertex with respect to one edge there: `(f − a)·e ≤ 0`.
        FootRegion = "foot-region",
        /// The gap of a vertex and a face is at most `search`.
        VertexFaceNear = "vertex-face-near",
        /// The gap of a vertex and a face is at least −`penetration`.
        VertexFaceDepth = "vertex-face-depth",
        /// The projection of a vertex lies strictly inside a face.
        InsideFace = "inside-face",
        /// An edge direction at a vertex passes a face plane (one edge of "cone passes plane").
        ConePasses = "cone-passes",
        /// Two edges are nearly parallel.
        NearlyParallel = "nearly-parallel",
        /// The feet of the common perpendicular lie strictly inside both edges.
        FeetInside = "feet-inside",
        /// The gap of two edges is at most `search`.
        EdgeEdgeNear = "edge-edge-near",
        /// The gap of two edges is at least −`penetration`.
        EdgeEdgeDepth = "edge-edge-depth",
        /// The four faces at two edges pass one another ("wedges pass").
        WedgesPass = "wedges-pass",
        /// The plane of an entrance is a true exit: its no-overlap check passes with the tolerance r/10 alone.
        ///
        /// Asked under revised criteria only, of planes that pass: of every candidate for an entrance where there are two or
        /// more, and for one exit of every contact found where at least one of them has h < 0.
        TrueExit = "true-exit",
        /// The chosen entrance has a gap of at least −`penetration`.
        EntranceDepth = "entrance-depth",
        /// An entrance candidate is preferred to another (largest gap, Eq. (1), order); asked of the true exits alone where
        /// there is one.
        EntranceChoice = "entrance-choice",
        /// The sign of the gap of a contact.
        GapSign = "gap-sign",
        /// A contact of an overlapping vertex is dropped for a face with a larger gap (test 3, shortest exit).
        ShortestExit = "shortest-exit",
        /// A contact stays under "one exit" (test 5).
        OneExit = "one-exit",
    }
}

/// Which of the two blocks a feature belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Side {
    /// The first block of the pair.
    A,
    /// The second block of the pair.
    B,
}

impl Side {
    /// The other block.
    #[must_use]
    pub fn other(self) -> Side {
        match self {
            Side::A => Side::B,
            Side::B => Side::A,
        }
    }
}

/// A vertex, edge or face of one of the two blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Feature {
    /// Vertex by number.
    Vertex(Side, VertexId),
    /// Edge by number.
    Edge(Side, EdgeId),
    /// Face by number.
    Face(Side, FaceId),
}

impl Feature {
    /// Its number among the vertices, edges or faces of its block.
    #[inline]
    pub fn number(self) -> u32 {
        match self {
            Feature::Vertex(_, VertexId(number))
            | Feature::Edge(_, EdgeId(number))
            | Feature::Face(_, FaceId(number)) => number,
        }
    }

    /// Which block it belongs to.
    #[inline]
    pub fn side(self) -> Side {
        match self {
            Feature::Vertex(side, _) | Feature::Edge(side, _) | Feature::Face(side, _) => side,
        }
    }

    /// Whether a block of this topology has such a feature, whichever of the two blocks it is.
    pub fn is_in(self, topology: &Topology) -> bool {
        match self {
            Feature::Vertex(_, vertex) => vertex.index() < topology.vertex_count(),
            Feature::Edge(_, edge) => edge.index() < topology.edges().len(),
            Feature::Face(_, face) => face.index() < topology.faces().len(),
        }
    }

    /// Kind, side and number in one word, which order as features do; never 0. Numbers beyond [`LARGEST`] count as that.
    #[inline]
    fn word(self) -> u32 {
        let (kind, side, number) = match self {
            Feature::Vertex(side, VertexId(number)) => (1, side, number),
            Feature::Edge(side, EdgeId(number)) => (2, side, number),
            Feature::Face(side, FaceId(number)) => (3, side, number),
        };
        kind << 30 | (side as u32) << 29 | number.min(LARGEST)
    }

    /// The feature of a word; 0 is that of none.
    #[inline]
    fn of_word(word: u32) -> Option<Feature> {
        let side = if word & (LARGEST + 1) == 0 { Side::A } else { Side::B };
        let number = word & LARGEST;
        match word >> 30 {
            0 => None,
            1 => Some(Feature::Vertex(side, VertexId(number))),
            2 => Some(Feature::Edge(side, EdgeId(number))),
            _ => Some(Feature::Face(side, FaceId(number))),
        }
    }
}

/// The largest number of a feature that a decision tells from all others. No file that is read (at most 1 GiB) holds a block of so many, and in memory
/// such a block would take some hundred GB.
pub(crate) const LARGEST: u32 = (1 << 29) - 1;

impl fmt::Display for Feature {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (letter, side, number) = match self {
            Feature::Vertex(side, VertexId(number)) => ('v', side, number),
            Feature::Edge(side, EdgeId(number)) => ('e', side, number),
            Feature::Face(side, FaceId(number)) => ('f', side, number),
        };
        write!(f, "{side:?}.{letter}{number}")
    }
}

/// One decision: a predicate applied to features.
///
/// The features stand in this order, so that two implementations name the same decision alike:
///
/// | predicate | features |
/// | --- | --- |
/// | neighbours | none |
/// | vertex-vertex-near, vertex-territory | vertex of A, vertex of B |
/// | vertex-region | the vertex asked about, the vertex whose region it is, one edge there |
/// | foot-inside, vertex-edge-near, edge-territory | vertex, edge of the other block |
/// | edge-region | vertex, edge, one of the edge's two faces |
/// | foot-region | vertex whose region it is, edge that carries the foot, one edge at the vertex |
/// | vertex-face-near, vertex-face-depth, inside-face, shortest-exit | vertex, face |
/// | cone-passes | vertex, face, one edge at the vertex |
/// | nearly-parallel, feet-inside, edge-edge-near, edge-edge-depth, wedges-pass | edge of A, edge of B |
/// | entrance-depth, one-exit | A's feature of the contact, B's feature of the contact |
/// | entrance-choice | A's and B's features of the contact, A's and B's features of the candidate |
/// | true-exit, gap-sign | A's and B's features of the entrance |
///
/// The three questions of depth are not asked of a contact that is kept from the step before.
///
/// The outcome is 1 for yes and 0 for no; for gap-sign it is the sign; for entrance-choice, shortest-exit and one-exit
/// 1 says that the candidate is chosen, the contact stays.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Decision {
    /// What was asked.
    pub predicate: Predicate,
    /// The words of the features, 0 in unused places: traces hold hundreds of decisions, which are compared again and again.
    words: [u32; 4],
}

impl Decision {
    /// A decision about `features` (at most four).
    #[inline]
    pub fn about(predicate: Predicate, features: &[Feature]) -> Decision {
        let mut words = [0; 4];
        for (word, feature) in words.iter_mut().zip(features) {
            *word = feature.word();
        }
        Decision { predicate, words }
    }

    /// The features it was asked of, in the order of the table above; unused places are `None`.
    #[inline]
    pub fn features(&self) -> [Option<Feature>; 4] {
        self.words.map(Feature::of_word)
    }

    /// What the decision is looked up by, in its lower half above all.
    #[inline]
    pub(crate) fn hash_bits(&self) -> u64 {
        // Large primes spread what differs (2⁶⁴ over the golden ratio; Steele and Vigna, 2022).
        let [a, b, c, d] = self.words.map(u64::from);
        let first = (a | b << 32).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        let second = (c ^ d << 32 ^ (self.predicate as u64) << 48).wrapping_mul(0xD134_2543_DE82_EF95);
        let both = first ^ second.rotate_left(32);
        (both ^ both >> 32).wrapping_mul(0xD134_2543_DE82_EF95) >> 32
    }
}

impl fmt::Debug for Decision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (predicate, features) = (&self.predicate, self.features());
        f.debug_struct("Decision").field("predicate", predicate).field("features", &features).finish()
    }
}

impl fmt::Display for Decision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}(", self.predicate)?;
        for (i, feature) in self.features().iter().flatten().enumerate() {
            write!(f, "{}{feature}", if i == 0 { "" } else { ", " })?;
        }
        write!(f, ")")
    }
}
