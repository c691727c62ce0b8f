//! A block made ready for the oracle: approximate vectors with proved error bounds, computed once.

use crate::number::{Approx, Bound, UNDERFLOW, UNIT_ROUNDOFF, larger, smaller};
use crate::own_lattice::OwnLattice;
use crate::planar::Planar;
use rockproof_model::block::face_normal;
use rockproof_model::number::split_f64;
use rockproof_model::topology::Edge;
use rockproof_model::{Block, FaceId, Ring, Vec3, VertexId};
use std::sync::OnceLock;

/// A block with the f64 vectors its predicates start from, and how far those can be from the exact ones.
///
/// The vectors are approximations on purpose: whatever is decided from them is decided only where the bounds in
/// `VectorErrors` prove the sign. Making one costs a few hundred operations; it serves every pair the block is in.
#[derive(Clone, Debug)]
pub struct PreparedBlock {
    pub(crate) block: Block,
    pub(crate) vertices: Vec<Vec3<Approx>>,
    pub(crate) edges: Vec<PreparedEdge>,
    pub(crate) faces: Vec<PreparedFace>,
    pub(crate) box_min: [f64; 3],
    pub(crate) box_max: [f64; 3],
    pub(crate) errors: VectorErrors,
    longest_loop: usize,
    /// Bounds the distance of a face's vertices from its plane.
    pub(crate) bulge: f64,
    /// For each axis the vertices with the least and the greatest coordinate, exactly.
    pub(crate) extremes: [(VertexId, VertexId); 3],
    own_lattice: OnceLock<Option<Box<OwnLattice>>>,
}

/// An edge of a prepared block.
#[derive(Clone, Debug)]
pub(crate) struct PreparedEdge {
    pub(crate) direction: Vec3<Approx>,
    /// `m_L` and `m_R`.
    pub(crate) inwards: [Vec3<Approx>; 2],
    /// The vertices it starts and ends at: the topology's, without its indirections.
    pub(crate) ends: (VertexId, VertexId),
    /// The box around it: least and greatest coordinates.
    pub(crate) bounds: [[f64; 3]; 2],
}

/// A face of a prepared block.
#[derive(Clone, Debug)]
pub(crate) struct PreparedFace {
    pub(crate) normal: Vec3<Approx>,
    /// `Σ (v_k − v_0)` over its loop.
    pub(crate) centre: Vec3<Approx>,
    /// `k²|N|²`, k the length of its loop, calculated as [`crate::predicate::GapWithin`] does.
    pub(crate) plane_size: Approx,
    /// The length of its loop.
    pub(crate) count: Approx,
    /// The first vertex of its loop.
    pub(crate) first: VertexId,
    /// Whether it is proved to be a convex polygon. The block's own flag is that of the block as loaded;
    /// rounding its coordinates may have bent a straight corner inwards since.
    pub(crate) surely_convex: bool,
    /// Whether all corners lie in its plane, exactly.
    pub(crate) planar: Planar,
}

impl PreparedEdge {
    // Made where it stays: a call would write it elsewhere and copy it.
    #[inline(always)]
    fn new(edge: &Edge, vertices: &[Vec3<Approx>], faces: &[PreparedFace]) -> PreparedEdge {
        let ends = [edge.p, edge.q].map(|v| &vertices[v.index()]);
        let direction = ends[1].minus(ends[0]);
        let normal = |face: FaceId| &faces[face.index()].normal;
        let [p, q] = ends.map(|v| [v.x.0, v.y.0, v.z.0]);
        PreparedEdge {
            inwards: [normal(edge.left).cross(&direction), normal(edge.right).cross(&direction.negated())],
            direction,
            ends: (edge.p, edge.q),
            bounds: [std::array::from_fn(|k| smaller(p[k], q[k])), std::array::from_fn(|k| larger(p[k], q[k]))],
        }
    }
}

impl PreparedFace {
    /// Not yet known to be convex.
    #[inline(always)]
    fn new(corners: &[VertexId], vertices: &[Vec3<Approx>]) -> PreparedFace {
        let (normal, count) = (face_normal(vertices, corners), Approx::from_i32(corners.len() as i32));
        PreparedFace {
            centre: centre_sum(vertices, corners),
            plane_size: count.squared().times(&normal.norm_squared()),
            normal,
            count,
            first: corners[0],
            surely_convex: false,
            planar: Planar::of_corners(corners.len()),
        }
    }
}

/// Bounds on the components of the approximate vectors of one block.
#[derive(Clone, Copy, Debug)]
pub(crate) struct VectorErrors {
    /// Distance of an approximate coordinate from the exact one: zero where every coordinate is an f64.
    pub(crate) coordinate: f64,
    /// A difference of two vertices of the block.
    pub(crate) difference: Bound,
    /// An edge direction.
    pub(crate) direction: Bound,
    /// A face normal.
    pub(crate) normal: Bound,
    /// `Σ (v_k − v_0)` over a face's loop.
    pub(crate) centre: Bound,
    /// An inward in-plane direction.
    pub(crate) inward: Bound,
}

impl PreparedBlock {
    /// Makes `block` ready.
    pub fn new(block: &Block) -> PreparedBlock {
        let topology = block.topology();
        let vertices: Vec<Vec3<Approx>> =
            block.vertices().iter().map(|v| v.map(|c| Approx(c.as_f64().unwrap_or_else(|| c.approximate())))).collect();
        let (box_min, box_max) = approximate_box(&vertices);
        let faces: Vec<PreparedFace> = topology.faces().iter().map(|f| PreparedFace::new(f, &vertices)).collect();
        let edges: Vec<PreparedEdge> =
            topology.edges().iter().map(|edge| PreparedEdge::new(edge, &vertices, &faces)).collect();
        let exact = block.coordinates().all(|c| c.as_f64().is_some());
        let place = exact.then(|| least_place(&vertices));
        let longest_loop = topology.faces().iter().map(Vec::len).max().unwrap_or(3);
        let mut prepared = PreparedBlock {
            block: block.clone(),
            errors: VectorErrors::of(place, longest_loop, [&box_min, &box_max], &edges, &faces),
            longest_loop,
            extremes: if exact {
                extremes_at(&vertices, &box_min, &box_max)
            } else {
                std::array::from_fn(|axis| exact_extremes(block, axis))
            },
            vertices,
            edges,
            faces,
            box_min,
            box_max,
            bulge: 0.0,
            own_lattice: OnceLock::new(),
        };
        let VectorErrors { inward, direction, .. } = prepared.errors;
        let bound = Vec3::new(inward, inward, inward).dot(&Vec3::new(direction, direction, direction)).error;
        for face in 0..prepared.faces.len() {
            prepared.faces[face].surely_convex = prepared.turns_left_only(FaceId::at(face), bound);
        }
        prepared.bulge = prepared.largest_bulge();
        prepared
    }

    /// The block itself.
    pub fn block(&self) -> &Block {
        &self.block
    }

    /// The block as integers; `None` where they have too many digits.
    #[inline]
    pub(crate) fn own_lattice(&self) -> Option<&OwnLattice> {
        self.own_lattice.get_or_init(|| OwnLattice::of(&self.block).map(Box::new)).as_deref()
    }

    /// Whether every corner of a face certainly turns left: `m_k · d_{k+1} > 0` beyond its error.
    fn turns_left_only(&self, face: FaceId, bound: f64) -> bool {
        let topology = self.block.topology();
        let edges = topology.face_edges(face);
        if edges.len() == 3 {
            return true;
        }
        let mut here = edges[edges.len() - 1].index();
        let mut here_is_right = topology.edges()[here].right == face;
        edges.iter().all(|next| {
            let next = next.index();
            let next_is_right = topology.edges()[next].right == face;
            let along = self.edges[here].inwards[usize::from(here_is_right)].dot(&self.edges[next].direction).0;
            let turn = if next_is_right { -along } else { along };
            (here, here_is_right) = (next, next_is_right);
            turn > bound
        })
    }

    /// Vertices of the face that has most.
    pub(crate) fn longest_loop(&self) -> usize {
        self.longest_loop
    }

    /// Bounds the distance of a face's vertices from its plane; infinite where a face may have no area.
    fn largest_bulge(&self) -> f64 {
        let mut largest: f64 = 0.0;
        let (mut errors_for, mut error) = (0, 0.0);
        for (f, face) in self.block.topology().faces().iter().enumerate() {
            if face.len() == 3 {
                continue;
            }
            let PreparedFace { normal: n, centre, count, .. } = &self.faces[f];
            let square = n.norm_squared().0;
            // Of a normal square 2⁻⁵⁰ is more than it lost, to underflow as well; one below that or infinite says nothing of |N|.
            if !square.is_normal() {
                return f64::INFINITY;
            }
            let lower = square.sqrt() * (1.0 - 1e-12) - 2.0 * self.errors.normal.error;
            let worst = face
                .iter()
                .map(|&v| {
                    let from_first = self.vertices[v.index()].minus(&self.vertices[face[0].index()]);
                    n.dot(&from_first.scaled(count).minus(centre)).0.abs()
                })
                .fold(0.0, larger);
            if errors_for != face.len() {
                (errors_for, error) = (face.len(), self.errors.plane_value(self.errors.difference, face.len()));
            }
            let distance = (worst + error) / (count.0 * lower) * (1.0 + 1e-12);
            // Written so that NaN, too, ends as "no bound".
            if !(lower > 0.0 && distance < f64::INFINITY) {
                return f64::INFINITY;
            }
            largest = largest.max(distance);
        }
        largest
    }
}

impl VectorErrors {
    /// Of a block whose coordinates f64 holds, all multiples of `2^place`, if there is such a place.
    fn of(
        place: Option<i32>,
        longest_loop: usize,
        [box_min, box_max]: [&[f64; 3]; 2],
        edges: &[PreparedEdge],
        faces: &[PreparedFace],
    ) -> VectorErrors {
        let coordinate = if place.is_some() {
            0.0
        } else {
            largest_of(box_min.iter().chain(box_max).copied()) * UNIT_ROUNDOFF + UNDERFLOW
        };
        let extent = (0..3).map(|k| box_max[k] - box_min[k]).fold(0.0, f64::max);
        let mut worst = VectorErrors::worst(extent, coordinate, longest_loop);
        if let Some(place) = place {
            worst.leave_out_what_is_exact(digits_of(place, extent), longest_loop);
        }
        let (mut directions, mut inwards) = (Largest::default(), Largest::default());
        for edge in edges {
            directions.add(&edge.direction);
            edge.inwards.iter().for_each(|inward| inwards.add(inward));
        }
        let mut normals = Largest::default();
        faces.iter().for_each(|face| normals.add(&face.normal));
        let direction = Bound::around(directions.of_all(), worst.difference.error);
        let normal = Bound::around(normals.of_all(), worst.normal.error);
        let across = Vec3::new(normal, normal, normal).cross(&Vec3::new(direction, direction, direction));
        let inward_error = across.x.error.min(worst.inward.error);
        let inward = Bound::around(inwards.of_all(), inward_error);
        VectorErrors { direction, normal, inward, ..worst }
    }

    /// Takes the errors away from vectors that f64 holds exactly, intermediate values included: those of a block whose
    /// differences are integers of so many binary digits, times a power of two.
    fn leave_out_what_is_exact(&mut self, digits: Option<u32>, longest_loop: usize) {
        const HELD: u32 = f64::MANTISSA_DIGITS;
        let Some(difference) = digits.filter(|&d| d <= HELD) else { return };
        let corners = usize::BITS - longest_loop.leading_zeros();
        let normal = 2 * difference + 1 + corners;
        self.difference.error = 0.0;
        for (bound, digits) in [
            (&mut self.centre, difference + corners),
            (&mut self.normal, normal),
            (&mut self.inward, normal + difference + 1),
        ] {
            if digits <= HELD {
                bound.error = 0.0;
            }
        }
    }

    /// What holds for any block whose coordinates span at most `extent` along each axis, are off by at most
    /// `coordinate`, and whose faces have at most `longest_loop` vertices.
    pub(crate) fn worst(extent: f64, coordinate: f64, longest_loop: usize) -> VectorErrors {
        let difference = subtracted(extent, coordinate);
        let side = Vec3::new(difference, difference, difference);
        let triangle = side.cross(&side);
        let normal = (0..longest_loop - 2).fold(Vec3::zero(), |sum: Vec3<Bound>, _| sum.plus(&triangle));
        let centre = (0..longest_loop).fold(Bound::from_i32(0), |sum, _| sum.plus(&difference));
        let inward = normal.cross(&side).x;
        VectorErrors { coordinate, difference, direction: difference, normal: normal.x, centre, inward }
    }

    /// Error of `N·(k(a − v_0) − C)` for a face of `loop_length` vertices and a vertex at most `reach` away.
    fn plane_value(&self, reach: Bound, loop_length: usize) -> f64 {
        let normal = Vec3::new(self.normal, self.normal, self.normal);
        let reach = Vec3::new(reach, reach, reach).scaled(&Bound::from_i32(loop_length as i32));
        normal.dot(&reach.minus(&Vec3::new(self.centre, self.centre, self.centre))).error
    }
}

/// The largest k such that all coordinates are multiples of `2^k`.
fn least_place(vertices: &[Vec3<Approx>]) -> i32 {
    let place = |c: Approx| if c.0 == 0.0 { i32::MAX } else { split_f64(c.0).1 };
    vertices.iter().fold(i32::MAX, |unit, v| unit.min(place(v.x)).min(place(v.y)).min(place(v.z)))
}

/// Binary digits of the extent of a block whose coordinates are multiples of `2^unit`, counted in that. `None` where products of three of these might
/// leave the range of f64.
fn digits_of(unit: i32, extent: f64) -> Option<u32> {
    let (significand, exponent) = split_f64(extent);
    let top = exponent + 64 - significand.leading_zeros() as i32;
    // One more, as the extent may have been rounded down.
    (significand > 0 && unit > -300 && top < 300).then(|| (top - unit).max(0) as u32 + 1)
}

/// The bound on a difference of two coordinates that are `extent` apart, each off by at most `coordinate`.
pub(crate) fn subtracted(extent: f64, coordinate: f64) -> Bound {
    let input = Bound { magnitude: extent / 2.0 + coordinate, error: coordinate };
    input.minus(&input)
}

/// `Σ (v_k − v_0)` over a loop: the face point relative to the loop's first vertex, times the loop's length.
pub(crate) fn centre_sum<T: Ring>(points: &[Vec3<T>], face: &[VertexId]) -> Vec3<T> {
    let first = &points[face[0].index()];
    face.iter().skip(1).fold(Vec3::zero(), |sum, &v| sum.plus(&points[v.index()].minus(first)))
}

fn approximate_box(vertices: &[Vec3<Approx>]) -> ([f64; 3], [f64; 3]) {
    let (mut min, mut max) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for v in vertices {
        for (k, c) in v.components().into_iter().enumerate() {
            min[k] = smaller(min[k], c.0);
            max[k] = larger(max[k], c.0);
        }
    }
    (min, max)
}

/// For each axis the first vertex with the least coordinate and the first with the greatest, of vertices that f64 holds and their box.
fn extremes_at(vertices: &[Vec3<Approx>], box_min: &[f64; 3], box_max: &[f64; 3]) -> [(VertexId, VertexId); 3] {
    let mut found = [(VertexId(0), VertexId(0)); 3];
    for (v, at) in vertices.iter().enumerate().rev() {
        for (axis, c) in at.components().into_iter().enumerate() {
            let (low, high) = &mut found[axis];
            // Chosen without jumps: which vertex it is cannot be guessed.
            *low = if c.0 == box_min[axis] { VertexId::at(v) } else { *low };
            *high = if c.0 == box_max[axis] { VertexId::at(v) } else { *high };
        }
    }
    found
}

/// The same along one axis, of the coordinates themselves.
fn exact_extremes(block: &Block, axis: usize) -> (VertexId, VertexId) {
    let value = |v: VertexId| block.vertices()[v.index()].components()[axis];
    let (mut low, mut high) = (VertexId(0), VertexId(0));
    for v in block.topology().vertex_ids() {
        if value(v) < value(low) {
            low = v;
        }
        if value(v) > value(high) {
            high = v;
        }
    }
    (low, high)
}

fn largest_of(values: impl Iterator<Item = f64>) -> f64 {
    values.map(f64::abs).fold(0.0, larger)
}

/// The largest size of a component, kept for each axis by itself: that is three short chains of comparisons instead of one long one.
#[derive(Default)]
struct Largest([f64; 3]);

impl Largest {
    #[inline(always)]
    fn add(&mut self, vector: &Vec3<Approx>) {
        for (largest, c) in self.0.iter_mut().zip(vector.components()) {
            *largest = larger(*largest, c.0.abs());
        }
    }

    fn of_all(self) -> f64 {
        let Largest([x, y, z]) = self;
        larger(larger(x, y), z)
    }
}

#[cfg(test)]
pub(crate) mod tests;
