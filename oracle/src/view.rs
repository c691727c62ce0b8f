//! Where a predicate finds its vectors, in whichever number type it is evaluated.

// Longer than 400 lines: one view of a pair's vectors for all number types, which must not drift apart.

use crate::number::{Approx, Ball, Bits, Bound, larger, smaller};
use crate::prepared_block::{PreparedBlock, VectorErrors, centre_sum, subtracted};
use rockproof_model::block::face_normal;
use rockproof_model::decision::Side;
use rockproof_model::{Block, EdgeId, FaceId, Ring, Topology, Vec3, VertexId};
use std::cell::{OnceCell, RefCell};

/// The lengths and sines a predicate compares with. A length is `search / unit` lattice units (or metres), a sine
/// `overlap / one`, so that exact types need no fractions.
#[derive(Clone, Debug)]
pub(crate) struct Scales<T> {
    /// Common denominator of the three lengths.
    pub(crate) unit: T,
    /// s
    pub(crate) search: T,
    /// r
    pub(crate) territory: T,
    /// g
    pub(crate) penetration: T,
    /// Common denominator of the two sines.
    pub(crate) one: T,
    /// so
    pub(crate) overlap: T,
    /// sp
    pub(crate) parallel: T,
    /// Denominator of ε.
    pub(crate) whole: T,
    /// ε
    pub(crate) equal: T,
}

/// Tolerances that are made when a polynomial first asks for them.
pub(crate) struct LazyScales<'p, T> {
    pub(crate) made: &'p OnceCell<Scales<T>>,
    pub(crate) make: &'p dyn Fn() -> Scales<T>,
}

impl<T> LazyScales<'_, T> {
    fn get(&self) -> &Scales<T> {
        self.made.get_or_init(self.make)
    }
}

/// The vectors of a pair of blocks in one number type.
pub(crate) trait View {
    /// The number type.
    type T: Ring;
    /// A block's combinatorics.
    fn topology(&self, side: Side) -> &Topology;
    /// `to − from`, for vertices of either block.
    fn between(&self, from: (Side, VertexId), to: (Side, VertexId)) -> Vec3<Self::T>;
    /// `d = q − p` of an edge.
    fn direction(&self, side: Side, edge: EdgeId) -> Vec3<Self::T>;
    /// `N` of a face.
    fn normal(&self, side: Side, face: FaceId) -> Vec3<Self::T>;
    /// `Σ (v_k − v_0)` of a face.
    fn centre(&self, side: Side, face: FaceId) -> Vec3<Self::T>;
    /// `m_L` (`right` false) or `m_R` of an edge.
    fn inward(&self, side: Side, edge: EdgeId, right: bool) -> Vec3<Self::T>;
    /// The tolerances.
    fn scales(&self) -> &Scales<Self::T>;

    /// The vertices an edge starts and ends at.
    #[inline(always)]
    fn ends(&self, side: Side, edge: EdgeId) -> (VertexId, VertexId) {
        let edge = self.topology(side).edges()[edge.index()];
        (edge.p, edge.q)
    }

    /// The first vertex of a face's loop.
    #[inline(always)]
    fn first_corner(&self, side: Side, face: FaceId) -> VertexId {
        self.topology(side).faces()[face.index()][0]
    }

    /// The number of vertices of a face, as a number.
    #[inline(always)]
    fn loop_length(&self, side: Side, face: FaceId) -> Self::T {
        Self::T::from_i32(self.topology(side).faces()[face.index()].len() as i32)
    }
}

/// Plain f64: the first level.
pub(crate) struct FloatView<'p> {
    pub(crate) a: &'p PreparedBlock,
    pub(crate) b: &'p PreparedBlock,
    pub(crate) scales: &'p Scales<Approx>,
}

impl FloatView<'_> {
    #[inline(always)]
    fn prepared(&self, side: Side) -> &PreparedBlock {
        match side {
            Side::A => self.a,
            Side::B => self.b,
        }
    }
}

impl View for FloatView<'_> {
    type T = Approx;
    #[inline(always)]
    fn topology(&self, side: Side) -> &Topology {
        self.prepared(side).block.topology()
    }
    #[inline(always)]
    fn between(&self, from: (Side, VertexId), to: (Side, VertexId)) -> Vec3<Approx> {
        self.prepared(to.0).vertices[to.1.index()].minus(&self.prepared(from.0).vertices[from.1.index()])
    }
    #[inline(always)]
    fn direction(&self, side: Side, edge: EdgeId) -> Vec3<Approx> {
        self.prepared(side).edges[edge.index()].direction
    }
    #[inline(always)]
    fn normal(&self, side: Side, face: FaceId) -> Vec3<Approx> {
        self.prepared(side).faces[face.index()].normal
    }
    #[inline(always)]
    fn centre(&self, side: Side, face: FaceId) -> Vec3<Approx> {
        self.prepared(side).faces[face.index()].centre
    }
    #[inline(always)]
    fn inward(&self, side: Side, edge: EdgeId, right: bool) -> Vec3<Approx> {
        self.prepared(side).edges[edge.index()].inwards[usize::from(right)]
    }
    #[inline(always)]
    fn scales(&self) -> &Scales<Approx> {
        self.scales
    }
    #[inline(always)]
    fn ends(&self, side: Side, edge: EdgeId) -> (VertexId, VertexId) {
        self.prepared(side).edges[edge.index()].ends
    }
    #[inline(always)]
    fn first_corner(&self, side: Side, face: FaceId) -> VertexId {
        self.prepared(side).faces[face.index()].first
    }
    #[inline(always)]
    fn loop_length(&self, side: Side, face: FaceId) -> Approx {
        self.prepared(side).faces[face.index()].count
    }
}

/// What is known of every vector before one is picked: gives the static bounds of [`FloatView`].
pub(crate) struct BoundView<'p> {
    a: &'p Topology,
    b: &'p Topology,
    errors: [VectorErrors; 2],
    longest_loops: [usize; 2],
    scales: Scales<Bound>,
    across: Bound,
}

impl<'p> BoundView<'p> {
    /// From the vectors the two blocks have.
    pub(crate) fn of(a: &'p PreparedBlock, b: &'p PreparedBlock, scales: Scales<Bound>) -> BoundView<'p> {
        let extent = joint_extent(a, b);
        let longest_loops = [a, b].map(|s| s.longest_loop());
        BoundView {
            a: a.block.topology(),
            b: b.block.topology(),
            errors: [a.errors, b.errors],
            longest_loops,
            scales,
            across: subtracted(extent, a.errors.coordinate.max(b.errors.coordinate)),
        }
    }

    /// For all pairs that span at most 1 along each axis, with coordinates off by at most `coordinate`, faces of at
    /// most `longest_loop` vertices, and tolerances of at most 1.
    pub(crate) fn of_unit_size(
        a: &'p PreparedBlock,
        b: &'p PreparedBlock,
        longest_loop: usize,
        coordinate: f64,
    ) -> BoundView<'p> {
        let errors = VectorErrors::worst(1.0, coordinate, longest_loop);
        BoundView {
            a: a.block.topology(),
            b: b.block.topology(),
            errors: [errors; 2],
            longest_loops: [longest_loop; 2],
            scales: Scales::at_most_one(),
            across: errors.difference,
        }
    }

    fn errors(&self, side: Side) -> &VectorErrors {
        &self.errors[usize::from(side == Side::B)]
    }
}

/// The longest side of the box around both blocks.
pub(crate) fn joint_extent(a: &PreparedBlock, b: &PreparedBlock) -> f64 {
    (0..3).map(|k| larger(a.box_max[k], b.box_max[k]) - smaller(a.box_min[k], b.box_min[k])).fold(0.0, larger)
}

fn same_in_all<T: Copy>(component: T) -> Vec3<T> {
    Vec3::new(component, component, component)
}

impl View for BoundView<'_> {
    type T = Bound;
    fn topology(&self, side: Side) -> &Topology {
        match side {
            Side::A => self.a,
            Side::B => self.b,
        }
    }
    fn between(&self, from: (Side, VertexId), to: (Side, VertexId)) -> Vec3<Bound> {
        same_in_all(if from.0 == to.0 { self.errors(to.0).difference } else { self.across })
    }
    fn direction(&self, side: Side, _edge: EdgeId) -> Vec3<Bound> {
        same_in_all(self.errors(side).direction)
    }
    fn normal(&self, side: Side, _face: FaceId) -> Vec3<Bound> {
        same_in_all(self.errors(side).normal)
    }
    fn centre(&self, side: Side, _face: FaceId) -> Vec3<Bound> {
        same_in_all(self.errors(side).centre)
    }
    fn inward(&self, side: Side, _edge: EdgeId, _right: bool) -> Vec3<Bound> {
        same_in_all(self.errors(side).inward)
    }
    fn scales(&self) -> &Scales<Bound> {
        &self.scales
    }
    fn loop_length(&self, side: Side, _face: FaceId) -> Bound {
        Bound::from_i32(self.longest_loops[usize::from(side == Side::B)] as i32)
    }
}

/// The f64 vectors with the radii that hold for them: the second level.
pub(crate) struct BallView<'p> {
    pub(crate) floats: FloatView<'p>,
    pub(crate) scales: LazyScales<'p, Ball>,
}

fn balls(vector: Vec3<Approx>, radius: f64) -> Vec3<Ball> {
    vector.map(|c| Ball { middle: c.0, radius })
}

impl View for BallView<'_> {
    type T = Ball;
    fn topology(&self, side: Side) -> &Topology {
        self.floats.topology(side)
    }
    fn between(&self, from: (Side, VertexId), to: (Side, VertexId)) -> Vec3<Ball> {
        let at = |(side, v): (Side, VertexId)| {
            let prepared = self.floats.prepared(side);
            balls(prepared.vertices[v.index()], prepared.errors.coordinate)
        };
        at(to).minus(&at(from))
    }
    fn direction(&self, side: Side, edge: EdgeId) -> Vec3<Ball> {
        let (p, q) = self.floats.ends(side, edge);
        self.between((side, p), (side, q))
    }
    fn normal(&self, side: Side, face: FaceId) -> Vec3<Ball> {
        balls(self.floats.normal(side, face), self.floats.prepared(side).errors.normal.error)
    }
    fn centre(&self, side: Side, face: FaceId) -> Vec3<Ball> {
        balls(self.floats.centre(side, face), self.floats.prepared(side).errors.centre.error)
    }
    fn inward(&self, side: Side, edge: EdgeId, right: bool) -> Vec3<Ball> {
        balls(self.floats.inward(side, edge, right), self.floats.prepared(side).errors.inward.error)
    }
    fn scales(&self) -> &Scales<Ball> {
        self.scales.get()
    }
}

/// How many bits every vector of a pair can have on its lattice.
pub(crate) struct BitsView<'p> {
    pub(crate) a: &'p Block,
    pub(crate) b: &'p Block,
    /// Bits of a local coordinate.
    pub(crate) coordinate: Bits,
    pub(crate) scales: LazyScales<'p, Bits>,
}

impl BitsView<'_> {
    fn block(&self, side: Side) -> &Block {
        match side {
            Side::A => self.a,
            Side::B => self.b,
        }
    }

    fn longest_loop(&self, side: Side) -> usize {
        self.block(side).topology().faces().iter().map(Vec::len).max().unwrap_or(3)
    }
}

impl View for BitsView<'_> {
    type T = Bits;
    fn topology(&self, side: Side) -> &Topology {
        self.block(side).topology()
    }
    fn between(&self, _from: (Side, VertexId), _to: (Side, VertexId)) -> Vec3<Bits> {
        same_in_all(self.coordinate.minus(&self.coordinate))
    }
    fn direction(&self, side: Side, _edge: EdgeId) -> Vec3<Bits> {
        self.between((side, VertexId(0)), (side, VertexId(0)))
    }
    fn normal(&self, side: Side, _face: FaceId) -> Vec3<Bits> {
        let edge = self.direction(side, EdgeId(0));
        let triangle = edge.cross(&edge);
        (0..self.longest_loop(side) - 2).fold(Vec3::zero(), |sum: Vec3<Bits>, _| sum.plus(&triangle))
    }
    fn centre(&self, side: Side, _face: FaceId) -> Vec3<Bits> {
        let edge = self.direction(side, EdgeId(0));
        (0..self.longest_loop(side)).fold(Vec3::zero(), |sum: Vec3<Bits>, _| sum.plus(&edge))
    }
    fn inward(&self, side: Side, edge: EdgeId, _right: bool) -> Vec3<Bits> {
        self.normal(side, FaceId(0)).cross(&self.direction(side, edge))
    }
    fn scales(&self) -> &Scales<Bits> {
        self.scales.get()
    }
    fn loop_length(&self, side: Side, _face: FaceId) -> Bits {
        Bits::from_i32(self.longest_loop(side) as i32)
    }
}

/// The vectors of both blocks as integers on their common lattice.
pub(crate) struct ExactPair<'s, T> {
    pub(crate) a: ExactBlock<'s, T>,
    pub(crate) b: ExactBlock<'s, T>,
}

/// Exact lattice vectors with tolerances: the last levels. Tolerances are made when a polynomial first asks for them.
pub(crate) struct ExactView<'p, 's, T> {
    pub(crate) geometry: &'p ExactPair<'s, T>,
    pub(crate) scales: LazyScales<'p, T>,
}

/// One block of an [`ExactPair`]; what is derived from the vertices is made, and room for it, when first asked for: a sign that
/// needs a wide type needs a few vectors of it.
pub(crate) struct ExactBlock<'p, T> {
    topology: &'p Topology,
    vertices: Vec<Vec3<T>>,
    /// By face.
    normals: Known<T>,
    /// By face.
    centres: Known<T>,
    /// By edge: the left one, then the right one.
    inwards: Known<T>,
}

/// The vectors of features that were asked for, and for each feature by its number the place of its vector, counted from 1, or 0.
struct Known<T> {
    /// How many features there are.
    count: usize,
    made: RefCell<(Vec<u32>, Vec<Vec3<T>>)>,
}

impl<T: Clone> Known<T> {
    fn none_of(count: usize) -> Self {
        Known { count, made: RefCell::new((Vec::new(), Vec::new())) }
    }

    fn get_or_make(&self, number: usize, make: impl FnOnce() -> Vec3<T>) -> Vec3<T> {
        let known = |(places, vectors): &(Vec<u32>, Vec<Vec3<T>>)| {
            let place = places.get(number).copied().unwrap_or(0);
            (place != 0).then(|| vectors[place as usize - 1].clone())
        };
        if let Some(known) = known(&self.made.borrow()) {
            return known;
        }
        // What is made may itself ask for others.
        let made = make();
        let (places, vectors) = &mut *self.made.borrow_mut();
        if places.is_empty() {
            places.resize(self.count, 0);
            vectors.reserve(self.count.min(8));
        }
        vectors.push(made.clone());
        places[number] = vectors.len() as u32;
        made
    }
}

impl<'p, T: Ring> ExactBlock<'p, T> {
    pub(crate) fn new(topology: &'p Topology, vertices: Vec<Vec3<T>>) -> Self {
        let [faces, edges] = [topology.faces().len(), topology.edges().len()];
        ExactBlock {
            topology,
            vertices,
            normals: Known::none_of(faces),
            centres: Known::none_of(faces),
            inwards: Known::none_of(2 * edges),
        }
    }

    fn direction(&self, edge: EdgeId) -> Vec3<T> {
        let edge = &self.topology.edge(edge);
        self.vertices[edge.q.index()].minus(&self.vertices[edge.p.index()])
    }

    fn normal(&self, face: FaceId) -> Vec3<T> {
        self.normals.get_or_make(face.index(), || face_normal(&self.vertices, &self.topology.faces()[face.index()]))
    }
}

impl<'s, T> ExactView<'_, 's, T> {
    fn exact_block(&self, side: Side) -> &ExactBlock<'s, T> {
        match side {
            Side::A => &self.geometry.a,
            Side::B => &self.geometry.b,
        }
    }
}

impl<T: Ring> View for ExactView<'_, '_, T> {
    type T = T;
    fn topology(&self, side: Side) -> &Topology {
        self.exact_block(side).topology
    }
    fn between(&self, from: (Side, VertexId), to: (Side, VertexId)) -> Vec3<T> {
        self.exact_block(to.0).vertices[to.1.index()].minus(&self.exact_block(from.0).vertices[from.1.index()])
    }
    fn direction(&self, side: Side, edge: EdgeId) -> Vec3<T> {
        self.exact_block(side).direction(edge)
    }
    fn normal(&self, side: Side, face: FaceId) -> Vec3<T> {
        self.exact_block(side).normal(face)
    }
    fn centre(&self, side: Side, face: FaceId) -> Vec3<T> {
        let block = self.exact_block(side);
        block.centres.get_or_make(face.index(), || centre_sum(&block.vertices, block.topology.face(face)))
    }
    fn inward(&self, side: Side, edge: EdgeId, right: bool) -> Vec3<T> {
        let block = self.exact_block(side);
        block.inwards.get_or_make(2 * edge.index() + usize::from(right), || {
            let ends = &block.topology.edge(edge);
            let d = block.direction(edge);
            if right { block.normal(ends.right).cross(&d.negated()) } else { block.normal(ends.left).cross(&d) }
        })
    }
    fn scales(&self) -> &Scales<T> {
        self.scales.get()
    }
}
