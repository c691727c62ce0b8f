//! What a classification answers: contacts and their entrances (SPEC section 4, "Result").

use crate::decision::{Feature, Side};
use crate::sign::Sign;
use crate::topology::{EdgeId, FaceId, VertexId};
use std::fmt;

crate::named_enum! {
    /// Which feature of block A touches which feature of block B; A's feature is named first.
    /// The order of the variants is the order in which contacts are sorted.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
    pub enum ContactKind: from_name, Display {
        /// v-v
        VertexVertex = "v-v",
        /// v-e
        VertexEdge = "v-e",
        /// e-v
        EdgeVertex = "e-v",
        /// v-f
        VertexFace = "v-f",
        /// f-v
        FaceVertex = "f-v",
        /// crossing e-e
        EdgeEdge = "e-e",
    }
}

impl ContactKind {
    /// The same contact seen with A and B exchanged.
    #[must_use]
    pub fn swapped(self) -> ContactKind {
        match self {
            ContactKind::VertexEdge => ContactKind::EdgeVertex,
            ContactKind::EdgeVertex => ContactKind::VertexEdge,
            ContactKind::VertexFace => ContactKind::FaceVertex,
            ContactKind::FaceVertex => ContactKind::VertexFace,
            same => same,
        }
    }
}

crate::named_enum! {
    /// Which two features span the plane through which the blocks enter one another.
    /// The order of the variants is the order in which ties are broken.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
    pub enum EntranceKind: from_name, Display {
        /// A vertex of A and a face of B; the normal is the face's `N`.
        VertexFace = "v-f",
        /// A face of A and a vertex of B; the normal is `−N` of the face.
        FaceVertex = "f-v",
        /// An edge of each; the normal is `σ·(d₁ × d₂)`.
        EdgeEdge = "e-e",
    }
}

/// The plane of a contact, by the two features that span it, A's first. Its normal points from B to A. Entrances compare in the order in which
/// ties are broken: kind, feature of A, feature of B.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Entrance {
    /// See [`EntranceKind::VertexFace`].
    VertexFace(VertexId, FaceId),
    /// See [`EntranceKind::FaceVertex`].
    FaceVertex(FaceId, VertexId),
    /// See [`EntranceKind::EdgeEdge`].
    EdgeEdge(EdgeId, EdgeId),
}

impl Entrance {
    /// The entrance of this kind between the features of these numbers, as read from a file; A's is named first.
    pub fn of_kind(kind: EntranceKind, [a, b]: [u32; 2]) -> Entrance {
        match kind {
            EntranceKind::VertexFace => Entrance::VertexFace(VertexId(a), FaceId(b)),
            EntranceKind::FaceVertex => Entrance::FaceVertex(FaceId(a), VertexId(b)),
            EntranceKind::EdgeEdge => Entrance::EdgeEdge(EdgeId(a), EdgeId(b)),
        }
    }

    /// Which kinds of feature span the plane.
    #[inline]
    pub fn kind(self) -> EntranceKind {
        match self {
            Entrance::VertexFace(..) => EntranceKind::VertexFace,
            Entrance::FaceVertex(..) => EntranceKind::FaceVertex,
            Entrance::EdgeEdge(..) => EntranceKind::EdgeEdge,
        }
    }

    /// The two features, A's first.
    #[inline]
    pub fn features(self) -> [Feature; 2] {
        match self {
            Entrance::VertexFace(a, b) => [Feature::Vertex(Side::A, a), Feature::Face(Side::B, b)],
            Entrance::FaceVertex(a, b) => [Feature::Face(Side::A, a), Feature::Vertex(Side::B, b)],
            Entrance::EdgeEdge(a, b) => [Feature::Edge(Side::A, a), Feature::Edge(Side::B, b)],
        }
    }

    /// The numbers of the two features, A's first, as written in tables and files.
    #[inline]
    pub fn numbers(self) -> [u32; 2] {
        self.features().map(Feature::number)
    }

    /// The same plane seen with A and B exchanged.
    #[must_use]
    pub fn swapped(self) -> Entrance {
        match self {
            Entrance::VertexFace(a, b) => Entrance::FaceVertex(b, a),
            Entrance::FaceVertex(a, b) => Entrance::VertexFace(b, a),
            Entrance::EdgeEdge(a, b) => Entrance::EdgeEdge(b, a),
        }
    }
}

/// Kind and numbers, A's first: `v-f 3/7`.
impl fmt::Display for Entrance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [a, b] = self.numbers();
        write!(f, "{} {a}/{b}", self.kind())
    }
}

/// What names a contact of a pair from one step to the next: the two features that touch, A's first. Keys compare in the order of SPEC: kind,
/// feature of A, feature of B.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ContactKey {
    /// v-v
    VertexVertex(VertexId, VertexId),
    /// v-e
    VertexEdge(VertexId, EdgeId),
    /// e-v
    EdgeVertex(EdgeId, VertexId),
    /// v-f
    VertexFace(VertexId, FaceId),
    /// f-v
    FaceVertex(FaceId, VertexId),
    /// crossing e-e
    EdgeEdge(EdgeId, EdgeId),
}

impl ContactKey {
    /// The contact of this kind between the features of these numbers, as read from a file; A's is named first.
    pub fn of_kind(kind: ContactKind, [a, b]: [u32; 2]) -> ContactKey {
        match kind {
            ContactKind::VertexVertex => ContactKey::VertexVertex(VertexId(a), VertexId(b)),
            ContactKind::VertexEdge => ContactKey::VertexEdge(VertexId(a), EdgeId(b)),
            ContactKind::EdgeVertex => ContactKey::EdgeVertex(EdgeId(a), VertexId(b)),
            ContactKind::VertexFace => ContactKey::VertexFace(VertexId(a), FaceId(b)),
            ContactKind::FaceVertex => ContactKey::FaceVertex(FaceId(a), VertexId(b)),
            ContactKind::EdgeEdge => ContactKey::EdgeEdge(EdgeId(a), EdgeId(b)),
        }
    }

    /// Which kinds of feature touch.
    #[inline]
    pub fn kind(self) -> ContactKind {
        match self {
            ContactKey::VertexVertex(..) => ContactKind::VertexVertex,
            ContactKey::VertexEdge(..) => ContactKind::VertexEdge,
            ContactKey::EdgeVertex(..) => ContactKind::EdgeVertex,
            ContactKey::VertexFace(..) => ContactKind::VertexFace,
            ContactKey::FaceVertex(..) => ContactKind::FaceVertex,
            ContactKey::EdgeEdge(..) => ContactKind::EdgeEdge,
        }
    }

    /// The two features, A's first.
    #[inline]
    pub fn features(self) -> [Feature; 2] {
        use Feature::{Edge, Face, Vertex};
        match self {
            ContactKey::VertexVertex(a, b) => [Vertex(Side::A, a), Vertex(Side::B, b)],
            ContactKey::VertexEdge(a, b) => [Vertex(Side::A, a), Edge(Side::B, b)],
            ContactKey::EdgeVertex(a, b) => [Edge(Side::A, a), Vertex(Side::B, b)],
            ContactKey::VertexFace(a, b) => [Vertex(Side::A, a), Face(Side::B, b)],
            ContactKey::FaceVertex(a, b) => [Face(Side::A, a), Vertex(Side::B, b)],
            ContactKey::EdgeEdge(a, b) => [Edge(Side::A, a), Edge(Side::B, b)],
        }
    }

    /// The numbers of the two features, A's first, as written in tables and files.
    #[inline]
    pub fn numbers(self) -> [u32; 2] {
        self.features().map(Feature::number)
    }

    /// The vertex and the face of a v-f or f-v contact.
    #[inline]
    pub fn vertex_and_face(self) -> Option<(VertexId, FaceId)> {
        match self {
            ContactKey::VertexFace(vertex, face) | ContactKey::FaceVertex(face, vertex) => Some((vertex, face)),
            _ => None,
        }
    }

    /// The same contact seen with A and B exchanged.
    #[must_use]
    pub fn swapped(self) -> ContactKey {
        match self {
            ContactKey::VertexVertex(a, b) => ContactKey::VertexVertex(b, a),
            ContactKey::VertexEdge(a, b) => ContactKey::EdgeVertex(b, a),
            ContactKey::EdgeVertex(a, b) => ContactKey::VertexEdge(b, a),
            ContactKey::VertexFace(a, b) => ContactKey::FaceVertex(b, a),
            ContactKey::FaceVertex(a, b) => ContactKey::VertexFace(b, a),
            ContactKey::EdgeEdge(a, b) => ContactKey::EdgeEdge(b, a),
        }
    }
}

/// Kind and numbers, A's first: `v-e 3/7`.
impl fmt::Display for ContactKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [a, b] = self.numbers();
        write!(f, "{} {a}/{b}", self.kind())
    }
}

/// One contact of a pair of blocks. Contacts compare by their key first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Contact {
    /// Which features touch.
    pub key: ContactKey,
    /// The plane through which the blocks enter one another.
    pub entrance: Entrance,
    /// Positive apart, zero touching, negative overlapping.
    pub gap: Sign,
}

/// A contact that is asked for, and what it is where it is as expected; `None` where there should be none.
pub type ExpectedContact = (ContactKey, Option<Contact>);

/// Those of the contacts asked for that an answer has otherwise than expected.
pub fn unexpected_contacts(answer: &[Contact], expected: &[ExpectedContact]) -> Vec<ContactKey> {
    let differs = |(key, contact): &&ExpectedContact| Contact::find(answer, *key) != *contact;
    expected.iter().filter(differs).map(|(key, _)| *key).collect()
}

impl Contact {
    /// The contact of these features in an answer.
    pub fn find(answer: &[Contact], key: ContactKey) -> Option<Contact> {
        answer.iter().find(|contact| contact.key == key).copied()
    }

    /// Which kinds of feature touch.
    #[inline]
    pub fn kind(self) -> ContactKind {
        self.key.kind()
    }

    /// The same contact seen with A and B exchanged.
    #[must_use]
    pub fn swapped(self) -> Contact {
        Contact { key: self.key.swapped(), entrance: self.entrance.swapped(), gap: self.gap }
    }
}
