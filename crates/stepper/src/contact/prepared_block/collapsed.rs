//! Which part of a block has no extent in one precision.

use rockproof_model::{EdgeId, FaceId, VertexId};

/// A feature that rounding left without extent, or that overflowed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{what} in the stepper's precision")]
pub struct Collapsed {
    /// What collapsed.
    pub what: CollapsedPart,
}

/// The part of a block that collapsed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CollapsedPart {
    /// A vertex with a coordinate out of range.
    Vertex(VertexId),
    /// An edge without length, or whose length overflows.
    Edge(EdgeId),
    /// A face without area.
    Face(FaceId),
    /// A face so large that its area overflows.
    LargeFace(FaceId),
    /// A face whose plane holds no direction across one of its edges.
    EdgeOfFace(EdgeId, FaceId),
}

impl std::fmt::Display for CollapsedPart {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            CollapsedPart::Vertex(v) => write!(f, "vertex {v} overflows"),
            CollapsedPart::Edge(e) => write!(f, "edge {e} has no length"),
            CollapsedPart::Face(face) => write!(f, "face {face} has no area"),
            CollapsedPart::LargeFace(face) => write!(f, "the area of face {face} overflows"),
            CollapsedPart::EdgeOfFace(e, face) => write!(f, "face {face} has no direction across its edge {e}"),
        }
    }
}
