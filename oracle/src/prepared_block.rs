//! A block made ready for the oracle: approximate vectors with proved error bounds, computed once.

use crate::number::{Approx, Bound, UNDERFLOW, UNIT_ROUNDOFF};
use rockproof_model::block::face_normal;
use rockproof_model::number::split_f64;
use rockproof_model::topology::Edge;
use rockproof_model::{Block, Ring, Vec3};

/// A block with the f64 vectors its predicates start from, and how far those can be from the exact ones.
///
/// The vectors are approximations on purpose: whatever is decided from them is decided only where the bounds in
/// `VectorErrors` prove the sign. Making one costs a few hundred operations; it serves every pair the block is in.
#[derive(Clone, Debug)]
pub struct PreparedBlock {
    pub(crate) block: Block,
    pub(crate) vertices: Vec<Vec3<Approx>>,
    pub(crate) directions: Vec<Vec3<Approx>>,
    pub(crate) normals: Vec<Vec3<Approx>>,
    pub(crate) centres: Vec<Vec3<Approx>>,
    pub(crate) inwards: Vec<[Vec3<Approx>; 2]>,
    /// The ends of each edge: the topology's, without its indirections.
    pub(crate) ends: Vec<(u32, u32)>,
    /// The box around each edge: least and greatest coordinates.
    pub(crate) edge_boxes: Vec<[[f64; 3]; 2]>,
    /// `k²|N|²` of each face, k the length of its loop, calculated as [`crate::predicate::GapWithin`] does.
    pub(crate) plane_sizes: Vec<Approx>,
    /// The first vertex and the length of each face's loop, likewise.
    pub(crate) loops: Vec<(u32, Approx)>,
    pub(crate) box_min: [f64; 3],
    pub(crate) box_max: [f64; 3],
    pub(crate) errors: VectorErrors,
    longest_loop: usize,
    /// For each face whether it is proved to be a convex polygon. The block's own flag is that of the block as loaded;
    /// rounding its coordinates may have bent a straight corner inwards since.
    pub(crate) surely_convex: Vec<bool>,
    /// Bounds the distance of a face's vertices from its plane.
    pub(crate) bulge: f64,
    /// For each axis the vertices with the least and the greatest coordinate, exactly.
    pub(crate) extremes: [(u32, u32); 3],
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
        let vertices: Vec<Vec3<Approx>> = block.vertices().iter().map(|v| v.map(|c| Approx(c.approximate()))).collect();
        let (box_min, box_max) = approximate_box(&vertices);
        let directions: Vec<_> =
            topology.edges().iter().map(|e| vertices[e.q as usize].minus(&vertices[e.p as usize])).collect();
        let normals: Vec<_> = topology.faces().iter().map(|f| face_normal(&vertices, f)).collect();
        let centres: Vec<_> = topology.faces().iter().map(|f| centre_sum(&vertices, f)).collect();
        let inwards: Vec<[_; 2]> = topology
            .edges()
            .iter()
            .zip(&directions)
            .map(|(e, d)| [normals[e.left as usize].cross(d), normals[e.right as usize].cross(&d.negated())])
            .collect();
        let loops: Vec<(u32, Approx)> =
            topology.faces().iter().map(|f| (f[0], Approx::from_i32(f.len() as i32))).collect();
        let edge_box = |e: &Edge| {
            let ends = [e.p, e.q].map(|v| &vertices[v as usize]);
            let [p, q] = ends.map(|v| [v.x.0, v.y.0, v.z.0]);
            [std::array::from_fn(|k| p[k].min(q[k])), std::array::from_fn(|k| p[k].max(q[k]))]
        };
        let mut solid = PreparedBlock {
            block: block.clone(),
            errors: VectorErrors::of(block, &box_min, &box_max, &directions, &normals, &inwards),
            longest_loop: topology.faces().iter().map(Vec::len).max().unwrap_or(3),
            ends: topology.edges().iter().map(|e| (e.p, e.q)).collect(),
            edge_boxes: topology.edges().iter().map(edge_box).collect(),
            plane_sizes: loops.iter().zip(&normals).map(|((_, k), n)| k.squared().times(&n.norm_squared())).collect(),
            loops,
            vertices,
            directions,
            normals,
            centres,
            inwards,
            box_min,
            box_max,
            surely_convex: Vec::new(),
            bulge: 0.0,
            extremes: std::array::from_fn(|axis| extremes(block, axis)),
        };
        solid.surely_convex = (0..topology.faces().len() as u32).map(|f| solid.turns_left_only(f)).collect();
        solid.bulge = solid.largest_bulge();
        solid
    }

    /// The block itself.
    pub fn block(&self) -> &Block {
        &self.block
    }

    /// Whether every corner of a face certainly turns left: `m_k · d_{k+1} > 0` beyond its error.
    fn turns_left_only(&self, face: u32) -> bool {
        let topology = self.block.topology();
        let edges = topology.face_edges(face);
        if edges.len() == 3 {
            return true;
        }
        let VectorErrors { inward, direction, .. } = self.errors;
        let bound = Vec3::new(inward, inward, inward).dot(&Vec3::new(direction, direction, direction)).error;
        (0..edges.len()).all(|k| {
            let [here, next] = [edges[k], edges[(k + 1) % edges.len()]].map(|e| e as usize);
            let m = &self.inwards[here][usize::from(topology.edges()[here].right == face)];
            let along = m.dot(&self.directions[next]).0;
            let turn = if topology.edges()[next].right == face { -along } else { along };
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
        for (f, face) in self.block.topology().faces().iter().enumerate() {
            if face.len() == 3 {
                continue;
            }
            let n = &self.normals[f];
            let square = n.norm_squared().0;
            // Of a normal square 2⁻⁵⁰ is more than it lost, to underflow as well; one below that or infinite says nothing of |N|.
            if !square.is_normal() {
                return f64::INFINITY;
            }
            let lower = square.sqrt() * (1.0 - 1e-12) - 2.0 * self.errors.normal.error;
            let count = Approx::from_i32(face.len() as i32);
            let worst = face
                .iter()
                .map(|&v| {
                    let from_first = self.vertices[v as usize].minus(&self.vertices[face[0] as usize]);
                    n.dot(&from_first.scaled(&count).minus(&self.centres[f])).0.abs()
                })
                .fold(0.0, f64::max);
            let error = self.errors.plane_value(self.errors.difference, face.len());
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
    fn of(
        block: &Block,
        box_min: &[f64; 3],
        box_max: &[f64; 3],
        directions: &[Vec3<Approx>],
        normals: &[Vec3<Approx>],
        inwards: &[[Vec3<Approx>; 2]],
    ) -> VectorErrors {
        let exact = block.coordinates().all(|c| c.as_f64().is_some());
        let coordinate =
            if exact { 0.0 } else { largest_of(box_min.iter().chain(box_max).copied()) * UNIT_ROUNDOFF + UNDERFLOW };
        let extent = (0..3).map(|k| box_max[k] - box_min[k]).fold(0.0, f64::max);
        let longest_loop = block.topology().faces().iter().map(Vec::len).max().unwrap_or(3);
        let mut worst = VectorErrors::worst(extent, coordinate, longest_loop);
        if exact {
            worst.leave_out_what_is_exact(digits_of(block, extent), longest_loop);
        }
        let direction = Bound::around(largest_component(directions), worst.difference.error);
        let normal = Bound::around(largest_component(normals), worst.normal.error);
        let across = Vec3::new(normal, normal, normal).cross(&Vec3::new(direction, direction, direction));
        let inward_error = across.x.error.min(worst.inward.error);
        let inward = Bound::around(largest_component(inwards.iter().flatten()), inward_error);
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

/// Binary digits of the block's extent, counted in the largest power of two that divides every coordinate. `None` where
/// products of three of these might leave the range of f64.
fn digits_of(block: &Block, extent: f64) -> Option<u32> {
    let mut unit = i32::MAX;
    for c in block.coordinates() {
        let (significand, exponent) = split_f64(c.as_f64()?);
        if significand != 0 {
            unit = unit.min(exponent);
        }
    }
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
pub(crate) fn centre_sum<T: Ring>(points: &[Vec3<T>], face: &[u32]) -> Vec3<T> {
    let first = &points[face[0] as usize];
    face.iter().skip(1).fold(Vec3::zero(), |sum, &v| sum.plus(&points[v as usize].minus(first)))
}

fn approximate_box(vertices: &[Vec3<Approx>]) -> ([f64; 3], [f64; 3]) {
    let (mut min, mut max) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for v in vertices {
        for (k, c) in v.components().into_iter().enumerate() {
            min[k] = min[k].min(c.0);
            max[k] = max[k].max(c.0);
        }
    }
    (min, max)
}

/// The vertices with the least and the greatest coordinate along an axis.
fn extremes(block: &Block, axis: usize) -> (u32, u32) {
    let along = |v: u32| block.vertices()[v as usize].components()[axis];
    let (mut low, mut high) = (0, 0);
    for v in 1..block.vertices().len() as u32 {
        if along(v) < along(low) {
            low = v;
        }
        if along(v) > along(high) {
            high = v;
        }
    }
    (low, high)
}

fn largest_of(values: impl Iterator<Item = f64>) -> f64 {
    values.map(f64::abs).fold(0.0, f64::max)
}

fn largest_component<'a>(vectors: impl IntoIterator<Item = &'a Vec3<Approx>>) -> f64 {
    largest_of(vectors.into_iter().flat_map(|v| [v.x.0, v.y.0, v.z.0]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rockproof_model::{BlockOptions, Number};

    /// A box whose top has one corner raised, all of it `2^exponent` in size.
    fn bent_box(exponent: i32) -> Block {
        let corners = [[0, 0, 0], [3, 0, 0], [3, 3, 0], [0, 3, 0], [0, 0, 3], [3, 0, 3], [3, 3, 4], [0, 3, 3]];
        let unit = 2f64.powi(exponent / 2) * 2f64.powi(exponent - exponent / 2);
        let at = |c: i32| Number::from_f64(f64::from(c) * unit).unwrap();
        let vertices = corners.map(|[x, y, z]| Vec3::new(at(x), at(y), at(z))).to_vec();
        let faces =
            [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]].map(|f| f.to_vec());
        Block::new(vertices, faces.to_vec(), &BlockOptions { planarity: Number::from_integer(1) }).unwrap()
    }

    #[test]
    fn the_bulge_of_a_bent_face_is_bounded_whatever_the_size() {
        // N is (−3, −3, 18) and a corner is 18/4 above the mean: 4.5/√342.
        let bulge = 4.5 / 342f64.sqrt();
        let (mut known, mut unknown) = (0, 0);
        for exponent in -300..300 {
            let bound = PreparedBlock::new(&bent_box(exponent)).bulge;
            let least = bulge * (1.0 - 1e-9) * 2f64.powi(exponent);
            assert!(bound >= least, "2^{exponent}: {bound:e} for {least:e}");
            if bound.is_finite() {
                known += 1;
                assert!(bound <= bulge * (1.0 + 1e-9) * 2f64.powi(exponent), "2^{exponent}: {bound:e}");
            } else {
                unknown += 1;
            }
        }
        assert!(known > 450 && unknown > 20, "{known} known, {unknown} unknown");
    }
}
