//! A block: a closed polyhedron with exact vertices and the convexity of its features, decided once (SPEC section 2).

mod build;
mod certain_sign;
mod error;
mod face_intersection;
mod measure;
mod merge;
mod planarity;
mod polynomials;
mod shapes;
mod simple;
mod triangles;

#[cfg(test)]
mod tests;

pub use error::{BlockError, LARGEST_COORDINATE};
pub use measure::Bounds;
use measure::LazyMoments;
pub(crate) use measure::cuboid_mesh;
pub use shapes::Shapes;

use crate::number::{Number, Precision};
use crate::ring::Ring;
use crate::topology::{EdgeId, FaceId, Topology, VertexId};
use crate::vector::Vec3;
use std::sync::Arc;

/// A point with exact coordinates in metres.
pub type Point = Vec3<Number>;

/// A canonical block of SPEC section 2.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Block {
    shape: Arc<BlockShape>,
    vertices: Arc<[Point]>,
    moments: LazyMoments,
}

/// What does not change when a block is moved or its coordinates are rounded.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct BlockShape {
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

impl Default for BlockOptions {
    /// A planarity of 1e-9, as SPEC section 2 has it.
    fn default() -> BlockOptions {
        BlockOptions { planarity: Number::from_f64(1e-9).unwrap_or(Number::ZERO) }
    }
}

/// Which neighbouring faces become one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Merging {
    /// Those whose common edge is exactly flat.
    Exact,
    /// Also those that one plane holds within the planarity allowed: for triangulated meshes with rounded coordinates.
    WithinPlanarity,
}

/// What bringing a block into its canonical form took away.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Merged {
    /// Faces that went into a coplanar neighbour.
    pub faces: usize,
    /// Vertices inside merged faces, or in line between two edges.
    pub vertices: usize,
}

/// A point moved by `offset`, exactly.
pub(crate) fn translated(point: &Point, offset: &Point) -> Point {
    Vec3::new(point.x.plus(&offset.x), point.y.plus(&offset.y), point.z.plus(&offset.z))
}

impl Block {
    /// The block with these vertices and face loops, in canonical form: coplanar neighbours are merged, vertices in
    /// line between two edges dropped. The rest keeps its order.
    ///
    /// # Errors
    /// When they are not a block of SPEC section 2.
    pub fn new(
        vertices: Vec<Point>,
        faces: Vec<Vec<impl Into<VertexId>>>,
        options: &BlockOptions,
    ) -> Result<Block, BlockError> {
        Block::merged(vertices, faces, options, Merging::Exact).map(|(block, _)| block)
    }

    /// As [`Block::new`], with a choice of what to merge, and saying how much was.
    ///
    /// # Errors
    /// When they are not a block of SPEC section 2.
    pub fn merged(
        vertices: Vec<Point>,
        faces: Vec<Vec<impl Into<VertexId>>>,
        options: &BlockOptions,
        merging: Merging,
    ) -> Result<(Block, Merged), BlockError> {
        build::build(vertices, faces, options, merging)
    }

    /// The same block with other coordinates: moved, or rounded. Convexity flags are kept, as SPEC section 2 asks.
    ///
    /// # Panics
    /// When the number of vertices differs.
    #[must_use]
    pub fn with_vertices(&self, vertices: Vec<Point>) -> Block {
        assert_eq!(vertices.len(), self.vertices.len(), "a moved block keeps its vertices");
        Block { shape: Arc::clone(&self.shape), vertices: vertices.into(), moments: LazyMoments::default() }
    }

    /// Whether another block is this one with other coordinates, or the same: its faces, edges and vertices have the same numbers and flags.
    pub fn has_shape_of(&self, other: &Block) -> bool {
        Arc::ptr_eq(&self.shape, &other.shape) || self.shape == other.shape
    }

    /// The block moved by `offset`, exactly.
    #[must_use]
    pub fn translated(&self, offset: &Point) -> Block {
        self.with_vertices(self.vertices.iter().map(|vertex| translated(vertex, offset)).collect())
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

    /// The faces as triangles between the block's own vertices, face after face, counter-clockwise seen from outside. `planarity` is that
    /// with which the block was made ([`BlockOptions`]).
    pub fn triangles(&self, planarity: &Number) -> Vec<[VertexId; 3]> {
        build::triangles(self, &BlockOptions { planarity: planarity.clone() })
    }

    /// Whether a planarity may let neighbouring faces become one ([`Merging::WithinPlanarity`]): where this is false, no face is within it of the plane of a neighbour.
    pub fn may_merge_within(&self, planarity: &Number) -> bool {
        merge::may_merge_within(self, &BlockOptions { planarity: planarity.clone() })
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
    pub fn coordinates(&self) -> impl Iterator<Item = &Number> + Clone {
        self.vertices.iter().flat_map(|v| v.components())
    }

    /// Whether κ > 0 at the edge. An edge that is not convex is reflex.
    #[inline]
    pub fn edge_is_convex(&self, edge: EdgeId) -> bool {
        self.shape.edge_convex[edge.index()]
    }

    /// Whether all edges at the vertex are convex.
    #[inline]
    pub fn vertex_is_convex(&self, vertex: VertexId) -> bool {
        self.shape.vertex_convex[vertex.index()]
    }

    /// Whether the face is a convex polygon.
    #[inline]
    pub fn face_is_convex(&self, face: FaceId) -> bool {
        self.shape.face_convex[face.index()]
    }

    /// Whether all edges are convex.
    #[inline]
    pub fn is_convex(&self) -> bool {
        self.shape.convex
    }
}

/// `N_f = Σ v_k × v_{k+1}` relative to the loop's first vertex: twice the area vector (SPEC section 2).
pub fn face_normal<T: Ring>(points: &[Vec3<T>], face: &[VertexId]) -> Vec3<T> {
    let origin = &points[face[0].index()];
    let mut normal = Vec3::zero();
    for k in 1..face.len() - 1 {
        let u = points[face[k].index()].minus(origin);
        let v = points[face[k + 1].index()].minus(origin);
        normal = normal.plus(&u.cross(&v));
    }
    normal
}
