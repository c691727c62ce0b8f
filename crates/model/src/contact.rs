//! What a classification answers: contacts and their entrances (SPEC section 4, "Result").

use crate::sign::Sign;
use std::fmt;

/// Which feature of block A touches which feature of block B; A's feature is named first.
/// The order of the variants is the order in which contacts are sorted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ContactKind {
    /// v-v
    VertexVertex,
    /// v-e
    VertexEdge,
    /// e-v
    EdgeVertex,
    /// v-f
    VertexFace,
    /// f-v
    FaceVertex,
    /// crossing e-e
    EdgeEdge,
}

impl ContactKind {
    /// All kinds in sorted order.
    pub const ALL: [ContactKind; 6] = [
        ContactKind::VertexVertex,
        ContactKind::VertexEdge,
        ContactKind::EdgeVertex,
        ContactKind::VertexFace,
        ContactKind::FaceVertex,
        ContactKind::EdgeEdge,
    ];

    /// `v-v`, `v-e`, `e-v`, `v-f`, `f-v` or `e-e`, as written in tables and files.
    pub fn name(self) -> &'static str {
        match self {
            ContactKind::VertexVertex => "v-v",
            ContactKind::VertexEdge => "v-e",
            ContactKind::EdgeVertex => "e-v",
            ContactKind::VertexFace => "v-f",
            ContactKind::FaceVertex => "f-v",
            ContactKind::EdgeEdge => "e-e",
        }
    }

    /// The kind written `name`, if there is one.
    pub fn from_name(name: &str) -> Option<ContactKind> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

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

impl fmt::Display for ContactKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// Which two features span the plane through which the blocks enter one another.
/// The order of the variants is the order in which ties are broken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum EntranceKind {
    /// A vertex of A and a face of B; the normal is the face's `N`.
    VertexFace,
    /// A face of A and a vertex of B; the normal is `−N` of the face.
    FaceVertex,
    /// An edge of each; the normal is `σ·(d₁ × d₂)`.
    EdgeEdge,
}

impl EntranceKind {
    /// `v-f`, `f-v` or `e-e`.
    pub fn name(self) -> &'static str {
        match self {
            EntranceKind::VertexFace => "v-f",
            EntranceKind::FaceVertex => "f-v",
            EntranceKind::EdgeEdge => "e-e",
        }
    }

    /// The kind written `name`, if there is one.
    pub fn from_name(name: &str) -> Option<EntranceKind> {
        [EntranceKind::VertexFace, EntranceKind::FaceVertex, EntranceKind::EdgeEdge]
            .into_iter()
            .find(|k| k.name() == name)
    }
}

impl fmt::Display for EntranceKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// The plane of a contact. Its normal points from B to A.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Entrance {
    /// Which features span the plane.
    pub kind: EntranceKind,
    /// Index of A's feature: vertex, face or edge, by `kind`.
    pub a: u32,
    /// Index of B's feature: face, vertex or edge, by `kind`.
    pub b: u32,
}

impl Entrance {
    /// The same plane seen with A and B exchanged.
    #[must_use]
    pub fn swapped(self) -> Entrance {
        let kind = match self.kind {
            EntranceKind::VertexFace => EntranceKind::FaceVertex,
            EntranceKind::FaceVertex => EntranceKind::VertexFace,
            EntranceKind::EdgeEdge => EntranceKind::EdgeEdge,
        };
        Entrance { kind, a: self.b, b: self.a }
    }
}

/// One contact of a pair of blocks. Contacts compare in the order of SPEC: kind, feature of A, feature of B.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Contact {
    /// Which kinds of feature touch.
    pub kind: ContactKind,
    /// Index of A's feature.
    pub a: u32,
    /// Index of B's feature.
    pub b: u32,
    /// The plane through which the blocks enter one another.
    pub entrance: Entrance,
    /// Positive apart, zero touching, negative overlapping.
    pub gap: Sign,
}

/// What names a contact of a pair from one step to the next: its kind and features, without its entrance and gap.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ContactKey {
    /// Which kinds of feature touch.
    pub kind: ContactKind,
    /// Index of A's feature.
    pub a: u32,
    /// Index of B's feature.
    pub b: u32,
}

impl Contact {
    /// Its kind and features.
    pub fn key(self) -> ContactKey {
        ContactKey { kind: self.kind, a: self.a, b: self.b }
    }

    /// The same contact seen with A and B exchanged.
    #[must_use]
    pub fn swapped(self) -> Contact {
        Contact { kind: self.kind.swapped(), a: self.b, b: self.a, entrance: self.entrance.swapped(), gap: self.gap }
    }
}
