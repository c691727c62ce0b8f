//! Mass moments of a polyhedron by simplex integration, and the block matrices they make (SPEC section 5).

use crate::dynamics::displacement::BlockVector;
use crate::real::Real;
use crate::vector::Vector;
use rockproof_model::Topology;

/// A symmetric or general matrix of a block.
pub type BlockMatrix<R> = [BlockVector<R>; 12];

/// Volume, centroid and second moments of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moments<R> {
    /// In m³; positive for a block that is not inside out.
    pub volume: R,
    /// In m.
    pub centroid: Vector<R>,
    /// `∫XXᵀ dV` about the centroid in m⁵: xx, yy, zz, yz, zx, xy.
    pub second: [R; 6],
}

impl<R: Real> Moments<R> {
    /// The moments of the tetrahedra that the faces' fans span with the first vertex. Exact formulas: for a tetrahedron with
    /// a corner at the origin and edges a, b, c, `V = a·(b×c)/6`, `∫X = V(a+b+c)/4`,
    /// `∫XXᵀ = V(aaᵀ + bbᵀ + ccᵀ + ssᵀ)/20` with s = a + b + c.
    pub fn of(topology: &Topology, points: &[Vector<R>]) -> Moments<R> {
        let number = R::from_f64;
        let origin = points[0];
        let mut six_volumes = R::ZERO;
        let mut first = Vector::ZERO;
        let mut second = [R::ZERO; 6];
        for face in topology.faces() {
            let a = points[face[0].index()] - origin;
            for k in 1..face.len() - 1 {
                let (b, c) = (points[face[k].index()] - origin, points[face[k + 1].index()] - origin);
                let weight = a.dot(b.cross(c));
                let sum = a + b + c;
                six_volumes = six_volumes + weight;
                first = first + sum * weight;
                let products = [a, b, c, sum].map(products);
                for (m, total) in second.iter_mut().enumerate() {
                    let all = products.iter().fold(R::ZERO, |all, p| all + p[m]);
                    *total = *total + all * weight;
                }
            }
        }
        let volume = six_volumes / number(6.0);
        let arm = first / (six_volumes * number(4.0));
        let shift = products(arm);
        for (m, total) in second.iter_mut().enumerate() {
            *total = *total / number(120.0) - shift[m] * volume;
        }
        Moments { volume, centroid: origin + arm, second }
    }

    /// `∫TᵀT dV`, the mass matrix over the density.
    pub fn inertia(&self) -> BlockMatrix<R> {
        let [xx, yy, zz, yz, zx, xy] = self.second;
        let s = [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]];
        let mut matrix = [[R::ZERO; 12]; 12];
        for (k, row) in matrix.iter_mut().enumerate().take(3) {
            row[k] = self.volume;
        }
        for c in 3..12 {
            for d in 3..=c {
                let mut sum = R::ZERO;
                for &(row, a, factor) in GRADIENTS[c - 3] {
                    for &(other, b, also) in GRADIENTS[d - 3] {
                        if row == other {
                            sum = sum + s[a][b] * R::from_f64(factor * also);
                        }
                    }
                }
                matrix[c][d] = sum;
                matrix[d][c] = sum;
            }
        }
        matrix
    }
}

fn products<R: Real>(v: Vector<R>) -> [R; 6] {
    [v.x * v.x, v.y * v.y, v.z * v.z, v.y * v.z, v.z * v.x, v.x * v.y]
}

/// The columns of T after the first three, which are linear in X: (row, component of X, factor).
const GRADIENTS: [&[(usize, usize, f64)]; 9] = [
    &[(1, 2, -1.0), (2, 1, 1.0)],
    &[(0, 2, 1.0), (2, 0, -1.0)],
    &[(0, 1, -1.0), (1, 0, 1.0)],
    &[(0, 0, 1.0)],
    &[(1, 1, 1.0)],
    &[(2, 2, 1.0)],
    &[(1, 2, 0.5), (2, 1, 0.5)],
    &[(0, 2, 0.5), (2, 0, 0.5)],
    &[(0, 1, 0.5), (1, 0, 0.5)],
];
