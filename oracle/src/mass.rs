//! Exact mass moments of a polyhedron by simplex integration, and isotropic elasticity (SPEC section 5).

use crate::field::Field;
use rockproof_model::simulation::Material;
use rockproof_model::{Block, Number, Ring, Topology, Vec3};

/// Volume, centroid and second moments of a block; each face as the triangles from the first vertex of its loop.
#[derive(Clone, Debug)]
pub(crate) struct Moments<S> {
    /// In m³.
    pub(crate) volume: S,
    /// The centroid relative to vertex 0, in m.
    pub(crate) centroid: Vec3<S>,
    /// `∫ X_a X_b dV` about the centroid, in m⁵.
    pub(crate) second: [[S; 3]; 3],
    /// The vertices relative to vertex 0, in m.
    pub(crate) points: Vec<Vec3<S>>,
}

/// Sums over the tetrahedra of the origin and each triangle of a surface, which is a face's from its first vertex.
pub(crate) struct Integrals<S> {
    /// Six times the volume.
    pub(crate) six_volumes: S,
    /// 24 times the first moments.
    pub(crate) first: Vec3<S>,
    /// 120 times the second moments: the upper triangle.
    pub(crate) second: [[S; 3]; 3],
}

impl<S: Ring> Integrals<S> {
    /// The sums over the surface of a block, whose vertices are at these points.
    #[expect(clippy::needless_range_loop, reason = "p and q are directions of space, as in the formula")]
    pub(crate) fn of(points: &[Vec3<S>], topology: &Topology) -> Integrals<S> {
        let zero = || S::from_i32(0);
        let (mut six_volumes, mut first) = (zero(), Vec3::<S>::zero());
        let mut second: [[S; 3]; 3] = std::array::from_fn(|_| std::array::from_fn(|_| zero()));
        for face in topology.faces() {
            let a = &points[face[0].index()];
            for pair in face[1..].windows(2) {
                let [b, c] = [pair[0], pair[1]].map(|v| &points[v.index()]);
                // The tetrahedron (0, a, b, c): ∫ 1 = w/6, ∫ x = w·s/24, ∫ x_p x_q = w·(s_p s_q + Σ v_p v_q)/120.
                let w = a.dot(&b.cross(c));
                let s = a.plus(b).plus(c);
                six_volumes = six_volumes.plus(&w);
                first = first.plus(&s.scaled(&w));
                for p in 0..3 {
                    for q in p..3 {
                        let product = |v: &Vec3<S>| v.components()[p].times(v.components()[q]);
                        let sum = product(&s).plus(&product(a)).plus(&product(b)).plus(&product(c));
                        second[p][q] = second[p][q].plus(&w.times(&sum));
                    }
                }
            }
        }
        Integrals { six_volumes, first, second }
    }
}

impl<S: Field> Moments<S> {
    /// The moments of a block; `None` where its volume may be zero.
    #[expect(clippy::needless_range_loop, reason = "p and q are directions of space, as in the formula")]
    pub(crate) fn of(block: &Block, bits: u32) -> Option<Moments<S>> {
        let origin = &block.vertices()[0];
        let points: Vec<Vec3<S>> = block.vertices().iter().map(|v| difference(v, origin, bits)).collect();
        let Integrals { six_volumes, first, mut second } = S::integrals(&points, block.topology());
        let volume = six_volumes.over(&S::from_i32(6))?;
        let weight = six_volumes.times(&S::from_i32(4));
        let centroid = over(&first, &weight)?;
        for p in 0..3 {
            for q in p..3 {
                let shift = volume.times(centroid.components()[p]).times(centroid.components()[q]);
                second[p][q] = second[p][q].over(&S::from_i32(120))?.minus(&shift);
                second[q][p] = second[p][q].clone();
            }
        }
        Some(Moments { volume, centroid, second, points })
    }

    /// `∫ TᵀT dV`: 12 × 12, to be multiplied by the density.
    #[expect(clippy::needless_range_loop, reason = "k and l number unknowns")]
    pub(crate) fn matrix(&self) -> Vec<Vec<S>> {
        let mut matrix = vec![vec![S::from_i32(0); 12]; 12];
        for k in 0..3 {
            // First moments about the centroid vanish.
            matrix[k][k] = self.volume.clone();
        }
        for k in 3..12 {
            for l in k..12 {
                let mut entry = S::from_i32(0);
                for &(r1, a, f1) in TURNS_AND_STRAINS[k - 3] {
                    for &(_, b, f2) in TURNS_AND_STRAINS[l - 3].iter().filter(|term| term.0 == r1) {
                        // f1·f2/4 is ±1, ±1/2 or 1/4.
                        let value = match (f1 * f2).abs() {
                            4 => self.second[a][b].clone(),
                            2 => self.second[a][b].half(),
                            _ => self.second[a][b].half().half(),
                        };
                        entry = if f1 * f2 < 0 { entry.minus(&value) } else { entry.plus(&value) };
                    }
                }
                matrix[l][k] = entry.clone();
                matrix[k][l] = entry;
            }
        }
        matrix
    }
}

/// The columns of T from the fourth on: (row, coordinate of X, twice the factor).
pub(crate) const TURNS_AND_STRAINS: [&[(usize, usize, i32)]; 9] = [
    &[(1, 2, -2), (2, 1, 2)],
    &[(0, 2, 2), (2, 0, -2)],
    &[(0, 1, -2), (1, 0, 2)],
    &[(0, 0, 2)],
    &[(1, 1, 2)],
    &[(2, 2, 2)],
    &[(1, 2, 1), (2, 1, 1)],
    &[(0, 2, 1), (2, 0, 1)],
    &[(0, 1, 1), (1, 0, 1)],
];

/// The elasticity matrix of the six strains (εx, εy, εz, γyz, γzx, γxy); `None` for a Poisson's ratio that leaves none.
pub(crate) fn elasticity<S: Field>(material: &Material, bits: u32) -> Option<[[S; 6]; 6]> {
    let (young, poisson) = (S::of_number(&material.young, bits), S::of_number(&material.poisson, bits));
    let one = S::from_i32(1);
    let twice_shear = young.over(&one.plus(&poisson))?;
    let lame = twice_shear.times(&poisson).over(&one.minus(&poisson.plus(&poisson)))?;
    Some(std::array::from_fn(|row| {
        std::array::from_fn(|column| match (row < 3 && column < 3, row == column) {
            (true, true) => lame.plus(&twice_shear),
            (true, false) => lame.clone(),
            (false, true) => twice_shear.half(),
            (false, false) => S::from_i32(0),
        })
    }))
}

/// Whether a material's Poisson's ratio leaves an elasticity: it is neither −1 nor 1/2.
pub(crate) fn is_elastic(material: &Material) -> bool {
    let twice = material.poisson.plus(&material.poisson);
    twice != Number::from_integer(-2) && twice != Number::from_integer(1)
}

/// `a − b`, formed before anything is rounded.
pub(crate) fn difference<S: Field>(a: &rockproof_model::Point, b: &rockproof_model::Point, bits: u32) -> Vec3<S> {
    Vec3::new(
        S::of_difference(&a.x, &b.x, bits),
        S::of_difference(&a.y, &b.y, bits),
        S::of_difference(&a.z, &b.z, bits),
    )
}

/// `v / divisor`; `None` where the divisor may be zero.
pub(crate) fn over<S: Field>(v: &Vec3<S>, divisor: &S) -> Option<Vec3<S>> {
    Some(Vec3::new(v.x.over(divisor)?, v.y.over(divisor)?, v.z.over(divisor)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_rational::BigRational;

    #[test]
    fn a_box_has_the_moments_of_the_textbook() {
        let at = |x, y, z| Vec3::new(Number::from_integer(x), Number::from_integer(y), Number::from_integer(z));
        let block = Block::cuboid(&at(1, 2, 3), &at(3, 6, 9)).unwrap();
        let moments = Moments::<BigRational>::of(&block, 0).unwrap();
        let q = |n: i64, d: i64| BigRational::new(n.into(), d.into());
        assert_eq!(moments.volume, q(48, 1));
        assert_eq!(moments.volume, block.volume());
        assert_eq!(moments.centroid, Vec3::new(q(1, 1), q(2, 1), q(3, 1)));
        for (p, side) in [2, 4, 6].into_iter().enumerate() {
            for r in 0..3 {
                assert_eq!(moments.second[p][r], if p == r { q(48 * side * side, 12) } else { q(0, 1) });
            }
        }
        let mass = moments.matrix();
        assert_eq!(mass[3][3], q(48 * (16 + 36), 12));
        assert_eq!(mass[11][11], q(48 * (4 + 16), 48));
        assert!((0..12).all(|k| (0..12).all(|l| mass[k][l] == mass[l][k])));
    }

    #[test]
    fn integrals_by_one_denominator_are_those_of_fractions() {
        let q = |n: i64, d: i64| BigRational::new(n.into(), d.into());
        let corner = |n| Vec3::new(Number::from_integer(n), Number::from_integer(n), Number::from_integer(n));
        let block = Block::cuboid(&corner(0), &corner(1)).unwrap();
        // Denominators that divide one another, that share a factor, and that have nothing in common; no face need be plane.
        let points: Vec<Vec3<BigRational>> = (0..8i64)
            .map(|k| Vec3::new(q(k * k - 3, 4), q(7 - 2 * k, 6), q(5 * k + 1, 8 << (k % 3)).recip() + q(k % 2, 1)))
            .collect();
        let (found, plain) =
            (BigRational::integrals(&points, block.topology()), Integrals::of(&points, block.topology()));
        assert_eq!(found.six_volumes, plain.six_volumes);
        assert_eq!(found.first, plain.first);
        assert_eq!(found.second, plain.second);
    }

    /// E/(1 + ν) and λ = Eν/((1 + ν)(1 − 2ν)) have no value for ν = −1 and ν = 1/2 alone.
    #[test]
    fn two_ratios_of_poisson_leave_no_elasticity() {
        let ratio = |n: i32, d: i32| Number::from_rational(BigRational::new(n.into(), d.into()));
        for (poisson, elastic) in [
            (ratio(-1, 1), false),
            (ratio(1, 2), false),
            (ratio(-2, 1), true),
            (ratio(-1, 2), true),
            (ratio(0, 1), true),
            (ratio(1, 4), true),
            (ratio(1, 1), true),
        ] {
            let material = Material { poisson, ..Material::default() };
            assert_eq!(is_elastic(&material), elastic, "{:?}", material.poisson);
            assert_eq!(elasticity::<BigRational>(&material, 0).is_some(), elastic, "{:?}", material.poisson);
        }
    }
}
