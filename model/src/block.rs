//! A block: a closed polyhedron with exact vertices and the convexity of its features, decided once (SPEC section 2).

use crate::lattice::Lattice;
use crate::number::{Number, Precision};
use crate::ring::{ExactRing, Ring};
use crate::sign::Sign;
use crate::topology::{Topology, TopologyError};
use crate::vector::Vec3;
use num_bigint::BigInt;
use std::sync::Arc;

/// A point with exact coordinates in metres.
pub type Point = Vec3<Number>;

/// A canonical block of SPEC section 2.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Block {
    shape: Arc<Shape>,
    vertices: Vec<Point>,
}

/// What does not change when a block is moved or its coordinates are rounded.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Shape {
    topology: Topology,
    edge_convex: Vec<bool>,
    vertex_convex: Vec<bool>,
    face_convex: Vec<bool>,
    convex: bool,
}

/// How strictly a block is read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BlockOptions {
    /// How far a face may be from planar, as a share of the block's size (its longest box side).
    pub planarity: Number,
}

/// Why vertices and faces are not a canonical block.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BlockError {
    /// The faces do not fit together.
    #[error(transparent)]
    Topology(#[from] TopologyError),
    /// A face without area.
    #[error("face {face} has no area")]
    DegenerateFace {
        /// The face.
        face: usize,
    },
    /// An edge whose two faces lie in one plane.
    #[error("edge {p}-{q} between faces {left} and {right} is flat")]
    FlatEdge {
        /// First vertex.
        p: u32,
        /// Second vertex.
        q: u32,
        /// One face.
        left: u32,
        /// The other face.
        right: u32,
    },
}

impl Block {
    /// The block with these vertices and face loops.
    ///
    /// # Errors
    /// When they are not a canonical block of SPEC section 2.
    pub fn new(vertices: Vec<Point>, faces: Vec<Vec<u32>>, _options: &BlockOptions) -> Result<Block, BlockError> {
        let topology = Topology::new(vertices.len(), faces)?;
        let shape = with_exact_coordinates(&vertices, &topology)?;
        Ok(Block { shape: Arc::new(shape), vertices })
    }

    /// The same block with other coordinates: moved, or rounded. Convexity flags are kept, as SPEC section 2 asks.
    ///
    /// # Panics
    /// When the number of vertices differs.
    #[must_use]
    pub fn with_vertices(&self, vertices: Vec<Point>) -> Block {
        assert_eq!(vertices.len(), self.vertices.len(), "a moved block keeps its vertices");
        Block { shape: Arc::clone(&self.shape), vertices }
    }

    /// The block moved by `offset`, exactly.
    #[must_use]
    pub fn translated(&self, offset: &Point) -> Block {
        self.with_vertices(
            self.vertices
                .iter()
                .map(|v| Vec3::new(v.x.plus(&offset.x), v.y.plus(&offset.y), v.z.plus(&offset.z)))
                .collect(),
        )
    }

    /// The block as an engine of the given precision sees it, or `None` where a coordinate overflows.
    pub fn rounded(&self, precision: Precision) -> Option<Block> {
        let near = |n: &Number| n.rounded(precision).and_then(|v| Number::from_f64(v).ok());
        let vertices = self
            .vertices
            .iter()
            .map(|v| Some(Vec3::new(near(&v.x)?, near(&v.y)?, near(&v.z)?)))
            .collect::<Option<Vec<_>>>()?;
        Some(self.with_vertices(vertices))
    }

    /// Whether the precision represents every coordinate exactly.
    pub fn is_exact_in(&self, precision: Precision) -> bool {
        self.coordinates().all(|c| c.is_exact_in(precision))
    }

    /// Vertices, edges and faces.
    #[inline]
    pub fn topology(&self) -> &Topology {
        &self.shape.topology
    }

    /// Vertex coordinates in metres.
    #[inline]
    pub fn vertices(&self) -> &[Point] {
        &self.vertices
    }

    /// All coordinates of all vertices.
    pub fn coordinates(&self) -> impl Iterator<Item = &Number> {
        self.vertices.iter().flat_map(|v| v.components())
    }

    /// Whether κ > 0 at the edge. An edge that is not convex is reflex.
    #[inline]
    pub fn edge_is_convex(&self, edge: u32) -> bool {
        self.shape.edge_convex[edge as usize]
    }

    /// Whether all edges at the vertex are convex.
    #[inline]
    pub fn vertex_is_convex(&self, vertex: u32) -> bool {
        self.shape.vertex_convex[vertex as usize]
    }

    /// Whether the face is a convex polygon.
    #[inline]
    pub fn face_is_convex(&self, face: u32) -> bool {
        self.shape.face_convex[face as usize]
    }

    /// Whether all edges are convex.
    #[inline]
    pub fn is_convex(&self) -> bool {
        self.shape.convex
    }
}

fn with_exact_coordinates(vertices: &[Point], topology: &Topology) -> Result<Shape, BlockError> {
    // κ has degree 5; i128 holds it with 18-bit coordinates and loops of up to 256 vertices with room to spare.
    const SMALL_BITS: u32 = 18;
    let lattice = Lattice::covering(vertices.iter().flat_map(|v| v.components()));
    let small: Option<Vec<Vec3<i128>>> = vertices
        .iter()
        .map(|v| {
            Some(Vec3::new(
                lattice.small_units(&v.x, SMALL_BITS)?,
                lattice.small_units(&v.y, SMALL_BITS)?,
                lattice.small_units(&v.z, SMALL_BITS)?,
            ))
        })
        .collect();
    match small {
        Some(points) if topology.faces().iter().all(|f| f.len() <= 256) => decide_shape(&points, topology),
        _ => {
            let points: Vec<Vec3<BigInt>> = vertices.iter().map(|v| v.map(|c| lattice.units(c))).collect();
            decide_shape(&points, topology)
        }
    }
}

/// `N_f = Σ v_k × v_{k+1}` relative to the loop's first vertex: twice the area vector (SPEC section 2).
pub fn face_normal<T: Ring>(points: &[Vec3<T>], face: &[u32]) -> Vec3<T> {
    let origin = &points[face[0] as usize];
    let mut normal = Vec3::zero();
    for k in 1..face.len() - 1 {
        let u = points[face[k] as usize].minus(origin);
        let v = points[face[k + 1] as usize].minus(origin);
        normal = normal.plus(&u.cross(&v));
    }
    normal
}

fn decide_shape<T: ExactRing>(points: &[Vec3<T>], topology: &Topology) -> Result<Shape, BlockError> {
    let normals: Vec<Vec3<T>> = topology.faces().iter().map(|f| face_normal(points, f)).collect();
    if let Some(face) = normals.iter().position(|n| n.norm_squared().sign().is_zero()) {
        return Err(BlockError::DegenerateFace { face });
    }
    let mut edge_convex = Vec::with_capacity(topology.edges().len());
    for edge in topology.edges() {
        let d = points[edge.q as usize].minus(&points[edge.p as usize]);
        match normals[edge.left as usize].cross(&normals[edge.right as usize]).dot(&d).sign() {
            Sign::Zero => {
                return Err(BlockError::FlatEdge { p: edge.p, q: edge.q, left: edge.left, right: edge.right });
            }
            sign => edge_convex.push(sign.is_positive()),
        }
    }
    let vertex_convex = (0..topology.vertex_count() as u32)
        .map(|v| topology.vertex_edges(v).iter().all(|&e| edge_convex[e as usize]))
        .collect();
    let face_convex = topology.faces().iter().zip(&normals).map(|(f, n)| turns_left_only(points, f, n)).collect();
    let convex = edge_convex.iter().all(|&c| c);
    Ok(Shape { topology: topology.clone(), edge_convex, vertex_convex, face_convex, convex })
}

fn turns_left_only<T: ExactRing>(points: &[Vec3<T>], face: &[u32], normal: &Vec3<T>) -> bool {
    let n = face.len();
    (0..n).all(|k| {
        let [a, b, c] = [k, k + 1, k + 2].map(|i| &points[face[i % n] as usize]);
        b.minus(a).cross(&c.minus(b)).dot(normal).sign().is_at_least_zero()
    })
}
