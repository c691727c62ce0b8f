//! What can be wrong with a block (SPEC section 2).

use crate::topology::TopologyError;

/// The largest coordinate (m) of a block that is weighed: the square of the weight of a block so large is still an f64.
pub const LARGEST_COORDINATE: f64 = 1e45;

/// Why vertices and faces are not a canonical block. Vertices and faces are numbered as in the input, from 0; a face
/// that coplanar neighbours were merged into goes by the lowest number among them.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BlockError {
    /// The faces do not fit together.
    #[error(transparent)]
    Topology(#[from] TopologyError),
    /// A coordinate larger than any f64.
    #[error("vertex {vertex} has a coordinate beyond ±1.8e308, the largest f64")]
    Overflow {
        /// The vertex.
        vertex: usize,
    },
    /// A coordinate so large that it is the cause of whatever else is wrong. Readers of files say so of a block that is none; a sound block may
    /// have such coordinates.
    #[error(
        "vertex {vertex} has a coordinate of {coordinate:e} m; beyond {LARGEST_COORDINATE:e} m weights and energies overflow f64"
    )]
    TooLarge {
        /// The vertex.
        vertex: usize,
        /// The coordinate (m).
        coordinate: f64,
    },
    /// Fractions with so many different denominators that exact arithmetic would take forever.
    #[error("the coordinates have no common denominator below 2^{limit}; fewer or shorter fractions are needed")]
    TooFine {
        /// Most bits allowed.
        limit: u64,
    },
    /// Two vertices at one point.
    #[error(
        "vertices {first} and {second} are the same point ({x}, {y}, {z}); every vertex must be a point of its own"
    )]
    RepeatedVertex {
        /// The vertex with the lower number.
        first: usize,
        /// The vertex with the higher number.
        second: usize,
        /// Where they are, near enough to find them.
        x: f64,
        /// See `x`.
        y: f64,
        /// See `x`.
        z: f64,
    },
    /// A face without area.
    #[error("face {face} has no area: its loop of {length} vertices encloses nothing; {}", remedy_for_no_area(*length))]
    DegenerateFace {
        /// The face.
        face: usize,
        /// Vertices in its loop.
        length: usize,
    },
    /// A face further from planar than allowed.
    #[error("face {face} is not planar: {}; allowed is a planarity of {allowed:e}", furthest(vertices, *corners, *deviation))]
    NotPlanar {
        /// The face.
        face: usize,
        /// How many corners it has.
        corners: usize,
        /// Those of its vertices furthest from the plane: of a quadrilateral all four.
        vertices: Vec<usize>,
        /// Distance from the plane over the longest side of the block's box.
        deviation: f64,
        /// The planarity allowed.
        allowed: f64,
    },
    /// A face loop that crosses or touches itself.
    #[error(
        "face {face} crosses or touches itself: edges {}-{} and {}-{}; a face is a simple polygon",
        first.0, first.1, second.0, second.1
    )]
    SelfIntersecting {
        /// The face.
        face: usize,
        /// One edge, by its vertices.
        first: (usize, usize),
        /// The other edge.
        second: (usize, usize),
    },
    /// A surface turned inside out, or one that encloses nothing.
    #[error(
        "the volume is {volume:.6e} m³; it must be above zero, with every face counter-clockwise seen from outside"
    )]
    NotPositiveVolume {
        /// The signed volume in m³.
        volume: f64,
    },
    /// All edges are convex and yet the surface is not that of a convex body, so it runs through itself.
    #[error(
        "the surface runs through itself: all {edges} edges are convex but vertices − edges + faces is {euler}; a convex block has 2"
    )]
    RunsThroughItself {
        /// Edges of the block.
        edges: usize,
        /// The Euler characteristic.
        euler: i64,
    },
    /// Two faces with a common point that is on no vertex and no edge of both.
    #[error(
        "faces {first} and {second} meet outside their common vertices and edges: {what} {p}-{q} of face {first} crosses or touches face {second}; faces may meet in vertices and edges of both only, so move vertices until the surface neither runs through nor touches itself, or split the solid into several blocks",
        what = if *diagonal { "the diagonal" } else { "edge" }
    )]
    FacesMeet {
        /// The face whose edge or diagonal meets the other.
        first: usize,
        /// The other face.
        second: usize,
        /// One end of that edge or diagonal.
        p: usize,
        /// The other end.
        q: usize,
        /// Whether it is a diagonal of `first`: only a face that is not exactly planar can meet another there alone.
        diagonal: bool,
    },
    /// Two faces that fold back onto one another.
    #[error(
        "faces {left} and {right} fold back onto one another at edge {p}-{q}: the angle between them is 0° or 360°"
    )]
    FoldedEdge {
        /// First vertex.
        p: usize,
        /// Second vertex.
        q: usize,
        /// One face.
        left: usize,
        /// The other face.
        right: usize,
    },
    /// An edge whose two faces lie in one plane and could not be merged.
    #[error("edge {p}-{q} between faces {left} and {right} is flat and merging does not remove it")]
    FlatEdge {
        /// First vertex.
        p: usize,
        /// Second vertex.
        q: usize,
        /// One face.
        left: usize,
        /// The other face.
        right: usize,
    },
    /// A vertex with only two edges, which are not in line.
    #[error(
        "vertex {vertex} joins only the edges to {before} and {after}, which are not in line; a vertex needs 3 edges or more"
    )]
    TwoEdgeVertex {
        /// The vertex.
        vertex: usize,
        /// Other end of one edge.
        before: usize,
        /// Other end of the other edge.
        after: usize,
    },
    /// Coplanar faces whose union is a ring.
    #[error(
        "merging the {count} coplanar faces around face {face} gives a face with a hole, which one loop cannot describe; split the solid into several blocks, so that no face runs all round a hole or a pocket"
    )]
    FaceWithHole {
        /// Lowest number of the merged faces.
        face: usize,
        /// How many there are.
        count: usize,
    },
    /// Coplanar faces whose union touches itself at a vertex.
    #[error(
        "merging the {count} coplanar faces around face {face} gives a face that touches itself at vertex {vertex}; a face is a simple polygon, so split the solid into several blocks there"
    )]
    PinchedFace {
        /// Lowest number of the merged faces.
        face: usize,
        /// How many there are.
        count: usize,
        /// The vertex.
        vertex: usize,
    },
    /// What is left after merging is no block.
    #[error("after merging {faces} coplanar faces and dropping {vertices} vertices no block is left: {error}")]
    NothingLeft {
        /// Faces that disappeared.
        faces: usize,
        /// Vertices that disappeared.
        vertices: usize,
        /// What is wrong then, in numbers of the merged block.
        error: TopologyError,
    },
}

/// Which vertices of a face are furthest from its plane, and how far.
fn furthest(vertices: &[usize], corners: usize, deviation: f64) -> String {
    match vertices {
        [vertex] => format!("vertex {vertex} is {deviation:.3e} of the block's size off the face's plane"),
        // The plane is that of the mean of the corners along N, and both diagonals are at right angles to N.
        [_, _, _, _] if corners == 4 => {
            format!("its four corners are equally far from their common plane, {deviation:.3e} of the block's size")
        }
        several => {
            let several: Vec<String> = several.iter().map(usize::to_string).collect();
            format!("vertices {} are {deviation:.3e} of the block's size off the face's plane", several.join(", "))
        }
    }
}

/// What to do about a face without area: corners of a triangle lie in line, those of a longer loop may be in a wrong order.
fn remedy_for_no_area(length: usize) -> &'static str {
    if length == 3 {
        "leave it out, and give the faces beside it the same vertices along their common edge"
    } else {
        "its vertices must follow one another round the face, and not all lie in line"
    }
}

impl BlockError {
    /// The face and the vertices that the message is about, by their numbers in the input; of several faces the first.
    pub(crate) fn features(&self) -> (Option<usize>, Vec<usize>) {
        match self {
            BlockError::Topology(error) => features_of_topology(error),
            BlockError::Overflow { vertex } | BlockError::TooLarge { vertex, .. } => (None, vec![*vertex]),
            BlockError::RepeatedVertex { second, .. } => (None, vec![*second]),
            BlockError::DegenerateFace { face, .. } | BlockError::FaceWithHole { face, .. } => {
                (Some(*face), Vec::new())
            }
            BlockError::NotPlanar { face, vertices, .. } => (Some(*face), vertices.clone()),
            BlockError::SelfIntersecting { face, first, second } => {
                (Some(*face), vec![first.0, first.1, second.0, second.1])
            }
            BlockError::FacesMeet { first, p, q, .. } => (Some(*first), vec![*p, *q]),
            BlockError::FoldedEdge { p, q, left, .. } | BlockError::FlatEdge { p, q, left, .. } => {
                (Some(*left), vec![*p, *q])
            }
            BlockError::TwoEdgeVertex { vertex, .. } => (None, vec![*vertex]),
            BlockError::PinchedFace { face, vertex, .. } => (Some(*face), vec![*vertex]),
            BlockError::TooFine { .. }
            | BlockError::NotPositiveVolume { .. }
            | BlockError::RunsThroughItself { .. }
            | BlockError::NothingLeft { .. } => (None, Vec::new()),
        }
    }
}

fn features_of_topology(error: &TopologyError) -> (Option<usize>, Vec<usize>) {
    let numbers = |vertices: &[u32]| vertices.iter().map(|&vertex| vertex as usize).collect();
    match error {
        TopologyError::TooFew { .. } => (None, Vec::new()),
        TopologyError::ShortFace { face, .. }
        | TopologyError::NoSuchVertex { face, .. }
        | TopologyError::Disconnected { face } => (Some(*face), Vec::new()),
        TopologyError::VertexTwice { face, vertex } => (Some(*face), numbers(&[*vertex])),
        TopologyError::Open { p, q, face } => (Some(*face), numbers(&[*p, *q])),
        TopologyError::SameDirection { p, q, first, .. } => (Some(*first), numbers(&[*p, *q])),
        TopologyError::UnusedVertex { vertex } | TopologyError::NonManifoldVertex { vertex } => (None, vec![*vertex]),
    }
}
