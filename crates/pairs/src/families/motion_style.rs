//! How the pairs of a family are mostly set in motion.

/// What the motions of a family are mostly like.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MotionStyle {
    /// Anything: towards each other, apart, along, turning.
    #[default]
    Any,
    /// Along the surface.
    Sliding,
    /// Towards each other.
    Pressing,
    /// Turning about a corner or an edge.
    Turning,
}
