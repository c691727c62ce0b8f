//! What classification needs of one block, computed once (SPEC section 2).

mod collapsed;
mod preparation;

pub use collapsed::{Collapsed, CollapsedPart};

use crate::contact::boxes::Bounds;
use crate::real::Real;
use crate::vector::Vector;
use rockproof_model::topology::Edge;
use rockproof_model::{Block, EdgeId, FaceId, VertexId};
use std::mem::ManuallyDrop;
use std::sync::OnceLock;

/// A block prepared for classification in one precision. What only some features of a pair are asked for (directions into faces, widths of
/// faces) is worked out when first asked, by the same operations whoever asks first.
#[derive(Clone, Debug)]
pub struct PreparedBlock<R> {
    block: Block,
    bounds: Bounds<R>,
    vertices: Vec<Vertex<R>>,
    edges: Vec<PreparedEdge<R>>,
    faces: Vec<Face<R>>,
    /// Greatest distance of a vertex from the plane of a face of it.
    bulge: OnceLock<R>,
}

/// What is worked out when first asked. Numbers need no drop; `ManuallyDrop` spares the walk through the whole block that would find this out.
type WhenAsked<T> = ManuallyDrop<OnceLock<T>>;

const fn not_asked<T>() -> WhenAsked<T> {
    ManuallyDrop::new(OnceLock::new())
}

/// A vertex of a prepared block.
#[derive(Clone, Copy, Debug)]
pub struct Vertex<R> {
    /// Where it is.
    pub at: Vector<R>,
    /// Length of the shortest edge here.
    pub shortest: R,
    /// Whether all its edges are convex.
    pub convex: bool,
}

/// An edge seen from one of its vertices.
#[derive(Clone, Copy, Debug)]
pub struct EdgeAtVertex<R> {
    /// Unit direction away from the vertex.
    pub away: Vector<R>,
    /// The edge's length.
    pub length: R,
}

/// An edge of a prepared block, from p to q, p < q.
#[derive(Clone, Debug)]
pub struct PreparedEdge<R> {
    /// Its vertices and faces.
    pub edge: Edge,
    /// Whether κ > 0, decided exactly when the block was loaded.
    pub convex: bool,
    /// Where p is.
    pub p: Vector<R>,
    /// Where q is.
    pub q: Vector<R>,
    /// Unit direction from p to q.
    pub direction: Vector<R>,
    /// Length.
    pub length: R,
    /// Unit directions into the left and the right face.
    into: [WhenAsked<Vector<R>>; 2],
    /// Greatest distance of a vertex of each face from the edge's line.
    widths: WhenAsked<[R; 2]>,
}

impl<R: Real> PreparedEdge<R> {
    /// The box around the edge.
    #[inline]
    pub fn bounds(&self) -> Bounds<R> {
        Bounds::of_point(self.p).joined(&Bounds::of_point(self.q))
    }
}

/// A face of a prepared block.
#[derive(Clone, Debug)]
pub struct Face<R> {
    /// Unit outward normal.
    pub normal: Vector<R>,
    /// `N_f`: the normal with twice the area for length.
    area: Vector<R>,
    /// `c_f`, the mean of the vertices.
    pub point: Vector<R>,
    /// Whether no corner turns right.
    turns_left: WhenAsked<bool>,
}

impl<R: Real> Face<R> {
    /// The direction into the face from an edge of this unit direction, not of unit length: the planes of faces that rounding made non-planar
    /// do not quite hold their edges.
    fn across(&self, direction: Vector<R>, side: FaceOfEdge) -> Vector<R> {
        self.normal.cross(match side {
            FaceOfEdge::Left => direction,
            FaceOfEdge::Right => -direction,
        })
    }
}

/// One of the two faces at an edge, as seen from outside along the edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaceOfEdge {
    /// The left one.
    Left,
    /// The right one.
    Right,
}

impl FaceOfEdge {
    /// Both faces.
    pub const BOTH: [FaceOfEdge; 2] = [FaceOfEdge::Left, FaceOfEdge::Right];

    /// Its number.
    #[inline]
    fn of(self, edge: &Edge) -> FaceId {
        match self {
            FaceOfEdge::Left => edge.left,
            FaceOfEdge::Right => edge.right,
        }
    }
}

impl<R: Real> PreparedBlock<R> {
    /// Prepares a block. Coordinates are rounded to nearest; convexity flags stay those of the exact block.
    ///
    /// # Errors
    /// When rounding collapsed the block, naming the feature.
    pub fn new(block: &Block) -> Result<PreparedBlock<R>, Collapsed> {
        R::prepare(block)
    }

    /// The block this was prepared from, with its own exact coordinates.
    #[inline]
    pub fn block(&self) -> &Block {
        &self.block
    }

    /// The axis-aligned box of the vertices.
    #[inline]
    pub fn bounds(&self) -> &Bounds<R> {
        &self.bounds
    }

    /// All vertices.
    #[inline]
    pub fn vertices(&self) -> &[Vertex<R>] {
        &self.vertices
    }

    /// All edges, numbered as in the topology.
    #[inline]
    pub fn edges(&self) -> &[PreparedEdge<R>] {
        &self.edges
    }

    /// All faces.
    #[inline]
    pub fn faces(&self) -> &[Face<R>] {
        &self.faces
    }

    /// One vertex.
    #[inline]
    pub fn vertex(&self, vertex: VertexId) -> &Vertex<R> {
        &self.vertices[vertex.index()]
    }

    /// One edge.
    #[inline]
    pub fn edge(&self, edge: EdgeId) -> &PreparedEdge<R> {
        &self.edges[edge.index()]
    }

    /// One face.
    #[inline]
    pub fn face(&self, face: FaceId) -> &Face<R> {
        &self.faces[face.index()]
    }

    /// The edges at a vertex, ascending.
    #[inline]
    pub fn edges_at(&self, vertex: VertexId) -> &[EdgeId] {
        self.block.topology().vertex_edges(vertex)
    }

    /// Unit direction from an edge into one of its faces, in the face's plane and across the edge.
    #[inline]
    pub fn into_face(&self, edge: EdgeId, side: FaceOfEdge) -> Vector<R> {
        let ridge = self.edge(edge);
        *ridge.into[side as usize].get_or_init(|| {
            let across = self.faces[side.of(&ridge.edge).index()].across(ridge.direction, side);
            across / across.length()
        })
    }

    /// `m_L + m_R = N_L × d − N_R × d` of an edge, with the lengths that SPEC gives them; decides σ.
    pub fn lean(&self, edge: EdgeId) -> Vector<R> {
        let ridge = self.edge(edge);
        let [left, right] = [ridge.edge.left, ridge.edge.right].map(|face| self.faces[face.index()].area);
        (left - right).cross(ridge.q - ridge.p)
    }

    /// Whether no corner of a face turns right, as computed here: then all edges seen from the inner side means inside.
    #[inline]
    pub fn turns_left(&self, f: FaceId) -> bool {
        let face = self.face(f);
        *face.turns_left.get_or_init(|| {
            let corners = self.block.topology().face(f);
            let n = corners.len();
            let at = |i: usize| self.vertex(corners[if i < n { i } else { i - n }]).at;
            let left = |k: usize| {
                let (before, here, after) = (at(k), at(k + 1), at(k + 2));
                !(here - before).cross(after - here).dot(face.normal).below(R::ZERO)
            };
            n == 3 || (0..n).all(left)
        })
    }

    /// Greatest distance of a vertex from the plane of one of its faces, within some roundoffs: of planar faces nothing more.
    #[inline]
    pub fn bulge(&self) -> R {
        *self.bulge.get_or_init(|| {
            let corners = self.block.topology().faces();
            corners.iter().zip(&self.faces).map(|(corners, face)| self.bulge_of(corners, face)).fold(R::ZERO, R::larger)
        })
    }

    fn bulge_of(&self, corners: &[VertexId], face: &Face<R>) -> R {
        let asked = match corners.len() {
            3 => 0,
            // The normal is across both diagonals, so all four are as far from the plane, by turns above and below.
            4 => 1,
            n => n,
        };
        let distance = |&v: &VertexId| face.normal.dot(self.vertex(v).at - face.point).abs();
        corners[..asked].iter().map(distance).fold(R::ZERO, R::larger)
    }

    /// The longest side of its box, nearly (m).
    pub(crate) fn extent(&self) -> f64 {
        let sides = (self.bounds.high - self.bounds.low).components();
        sides.into_iter().map(R::to_f64).fold(0.0, f64::max)
    }

    /// Whether all lengths of edges, all areas of faces and the volume are above a share of what a length makes of them, and no edge is inclined to the
    /// plane of a face of it by more than a quarter. All of that as f64 has it.
    pub(crate) fn has_extent_beyond(&self, length: f64, share: f64) -> bool {
        let float = |v: Vector<R>| {
            let [x, y, z] = v.components().map(R::to_f64);
            Vector::new(x, y, z)
        };
        let origin = float(self.vertices[0].at);
        let areas: Vec<Vector<f64>> = self.faces.iter().map(|face| float(face.area)).collect();
        let heights = self.faces.iter().map(|face| float(face.point) - origin);
        let six_volumes: f64 = areas.iter().zip(heights).map(|(area, height)| area.dot(height)).sum();
        let is_long = |edge: &PreparedEdge<R>| {
            let direction = float(edge.direction);
            let inclined = |face: FaceId| float(self.face(face).normal).dot(direction).abs();
            edge.length.to_f64() > share * length
                && [edge.edge.left, edge.edge.right].map(inclined).iter().all(|&i| i < 0.25)
        };
        six_volumes > share * length * length * length
            && areas.iter().all(|area| area.length() > share * length * length)
            && self.edges.iter().all(is_long)
    }

    /// Greatest distance of a vertex of the left and of the right face from an edge's line.
    #[inline]
    pub fn widths(&self, edge: EdgeId) -> [R; 2] {
        let ridge = self.edge(edge);
        *ridge.widths.get_or_init(|| [ridge.edge.left, ridge.edge.right].map(|face| self.width(ridge, face)))
    }

    fn width(&self, ridge: &PreparedEdge<R>, face: FaceId) -> R {
        let squares = self
            .block
            .topology()
            .face(face)
            .iter()
            .filter(|&&v| v != ridge.edge.p && v != ridge.edge.q)
            .map(|&v| (self.vertex(v).at - ridge.p).cross(ridge.direction))
            .map(|across| across.dot(across));
        squares.fold(R::ZERO, R::larger).sqrt()
    }

    /// An edge seen from one of its vertices.
    #[inline]
    pub fn edge_at_vertex(&self, vertex: VertexId, edge: EdgeId) -> EdgeAtVertex<R> {
        let ridge = self.edge(edge);
        let away = if ridge.edge.p == vertex { ridge.direction } else { -ridge.direction };
        EdgeAtVertex { away, length: ridge.length }
    }
}
