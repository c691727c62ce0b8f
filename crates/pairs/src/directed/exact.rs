//! The features aimed at, on an integer lattice, and margins as affine functions of where B is.

use super::f64_view::F64Vector;
use num_bigint::BigInt;
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};
use rockproof_model::decision::Side;
use rockproof_model::lattice::Lattice;
use rockproof_model::number::exact_log2;
use rockproof_model::topology::Edge;
use rockproof_model::{Block, EdgeId, FaceId, Number, ToleranceSet, Vec3, VertexId};
use std::cell::OnceCell;

/// An integer vector.
pub(crate) type IntVector = Vec3<BigInt>;

/// A pair of blocks on the lattice of a few of its features, B moved by a first offset.
#[derive(Debug)]
pub(crate) struct ExactPlacement<'p> {
    a: &'p Block,
    b: &'p Block,
    lattice: Lattice,
    start: [Number; 3],
    shift: IntVector,
    pub(crate) search: BigInt,
    pub(crate) territory: BigInt,
    pub(crate) penetration: BigInt,
    /// The vertices of both blocks, and the normals of their faces, as far as asked.
    vertices: [Vec<OnceCell<IntVector>>; 2],
    normals: [Vec<OnceCell<IntVector>>; 2],
}

/// A margin: `constant + gradient · (offset of B beyond its start)`, in lattice units to some power.
#[derive(Clone, Debug)]
pub(crate) struct AffineMargin {
    pub(crate) constant: BigInt,
    pub(crate) gradient: IntVector,
    /// Whether no square root was rounded.
    pub(crate) exact: bool,
}

impl AffineMargin {
    pub(crate) fn plus(&self, constant: &BigInt) -> AffineMargin {
        AffineMargin { constant: &self.constant + constant, ..self.clone() }
    }

    pub(crate) fn minus(&self, other: &AffineMargin) -> AffineMargin {
        AffineMargin {
            constant: &self.constant - &other.constant,
            gradient: self.gradient.minus(&other.gradient),
            exact: self.exact && other.exact,
        }
    }

    pub(crate) fn negated(&self) -> AffineMargin {
        self.times(&BigInt::from(-1))
    }

    pub(crate) fn times(&self, factor: &BigInt) -> AffineMargin {
        AffineMargin { constant: &self.constant * factor, gradient: self.gradient.scaled(factor), exact: self.exact }
    }
}

/// A square root on the integers: `root / 2^shift`, rounded down.
#[derive(Clone, Debug)]
pub(crate) struct IntegerRoot {
    pub(crate) root: BigInt,
    pub(crate) shift: usize,
}

impl IntegerRoot {
    /// Bits behind the point where the root is irrational.
    const BITS: usize = 96;

    pub(crate) fn of(square: &BigInt) -> IntegerRoot {
        let root = square.sqrt();
        if &root * &root == *square {
            IntegerRoot { root, shift: 0 }
        } else {
            IntegerRoot { root: (square << (2 * Self::BITS)).sqrt(), shift: Self::BITS }
        }
    }

    pub(crate) fn is_exact(&self) -> bool {
        self.shift == 0
    }
}

/// The fraction in lowest terms, without a greatest common divisor of long numbers where twos or 128 bits suffice.
pub(crate) fn fraction(numerator: BigInt, denominator: BigInt) -> BigRational {
    let (numerator, denominator) =
        if denominator.is_negative() { (-numerator, -denominator) } else { (numerator, denominator) };
    let Some(twos) = numerator.trailing_zeros() else { return BigRational::zero() };
    let twos = twos.min(denominator.trailing_zeros().unwrap_or(0));
    let (numerator, denominator) = (numerator >> twos, denominator >> twos);
    if exact_log2(&denominator).is_some() {
        return BigRational::new_raw(numerator, denominator);
    }
    match (numerator.magnitude().to_u128(), denominator.to_u128()) {
        (Some(n), Some(d)) => {
            let common = n.gcd(&d);
            BigRational::new_raw(numerator / common, BigInt::from(d / common))
        }
        _ => BigRational::new(numerator, denominator),
    }
}

/// Whether a quotient of integers, the lower positive, is at most the square of a number; **a tie says yes**.
pub(crate) fn at_most((numerator, denominator): &(BigInt, BigInt), root: &Number) -> bool {
    let limit = root.to_rational().pow(2);
    numerator * limit.denom() <= limit.numer() * denominator
}

impl<'p> ExactPlacement<'p> {
    /// The lattice of the vertices named, of the lengths of `set`, and of the offset at which B starts.
    pub(crate) fn new(
        (a, b): (&'p Block, &'p Block),
        vertices: &[(Side, VertexId)],
        start: F64Vector,
        set: &ToleranceSet,
    ) -> ExactPlacement<'p> {
        let start = start.map(|c| Number::from_f64(c).unwrap_or(Number::ZERO));
        let coordinates = vertices.iter().flat_map(|&(side, v)| {
            let block = if side == Side::A { a } else { b };
            block.vertices()[v.index()].components()
        });
        let lengths = [&set.search, &set.territory, &set.penetration];
        let lattice = Lattice::covering(coordinates.chain(lengths).chain(&start));
        let units = |n: &Number| lattice.units(n);
        let places = |count: usize| std::iter::repeat_with(OnceCell::new).take(count).collect();
        ExactPlacement {
            vertices: [a, b].map(|block| places(block.vertices().len())),
            normals: [a, b].map(|block| places(block.topology().faces().len())),
            shift: Vec3::new(units(&start[0]), units(&start[1]), units(&start[2])),
            search: units(&set.search),
            territory: units(&set.territory),
            penetration: units(&set.penetration),
            lattice,
            start,
            a,
            b,
        }
    }

    pub(crate) fn block(&self, side: Side) -> &'p Block {
        match side {
            Side::A => self.a,
            Side::B => self.b,
        }
    }

    /// A vertex, B's moved by the start.
    pub(crate) fn vertex(&self, side: Side, vertex: VertexId) -> &IntVector {
        self.vertices[side as usize][vertex.index()].get_or_init(|| {
            let units = self.block(side).vertices()[vertex.index()].map(|c| self.lattice.units(c));
            if side == Side::B { units.plus(&self.shift) } else { units }
        })
    }

    pub(crate) fn edge(&self, side: Side, edge: EdgeId) -> Edge {
        *self.block(side).topology().edge(edge)
    }

    /// `q − p`.
    pub(crate) fn direction(&self, side: Side, edge: EdgeId) -> IntVector {
        let e = self.edge(side, edge);
        self.vertex(side, e.q).minus(self.vertex(side, e.p))
    }

    /// `N_f`.
    pub(crate) fn normal(&self, side: Side, face: FaceId) -> &IntVector {
        self.normals[side as usize][face.index()].get_or_init(|| {
            let corners = self.block(side).topology().face(face);
            let origin = self.vertex(side, corners[0]);
            let arms: Vec<IntVector> = corners[1..].iter().map(|&v| self.vertex(side, v).minus(origin)).collect();
            arms.windows(2).fold(Vec3::zero(), |n, pair| n.plus(&pair[0].cross(&pair[1])))
        })
    }

    /// `m_L` or `m_R`: the inward direction of `face` at the edge.
    pub(crate) fn inward(&self, side: Side, edge: EdgeId, face: FaceId) -> IntVector {
        let d = self.direction(side, edge);
        let d = if self.edge(side, edge).left == face { d } else { d.negated() };
        self.normal(side, face).cross(&d)
    }

    /// `n = σ·(d₁ × d₂)` of an edge of A and one of B.
    pub(crate) fn perpendicular(&self, ea: EdgeId, eb: EdgeId) -> IntVector {
        let n = self.direction(Side::A, ea).cross(&self.direction(Side::B, eb));
        let inward = |side: Side, edge: EdgeId| {
            let e = self.edge(side, edge);
            n.dot(&self.inward(side, edge, e.left).plus(&self.inward(side, edge, e.right)))
        };
        if inward(Side::A, ea) >= inward(Side::B, eb) { n } else { n.negated() }
    }

    /// `(x − y)·w` for vertices of the two blocks, as a function of where B is.
    pub(crate) fn along(&self, (x_side, x): (Side, VertexId), y: VertexId, w: &IntVector) -> AffineMargin {
        let from = self.vertex(x_side.other(), y);
        let constant = self.vertex(x_side, x).minus(from).dot(w);
        AffineMargin { constant, gradient: if x_side == Side::B { w.clone() } else { w.negated() }, exact: true }
    }

    /// `k·N·(x − c)` for a vertex and a face of the other block with `k` corners, and `|N|²`. Its quotient by `k·|N|` is
    /// the gap.
    pub(crate) fn gap(&self, side: Side, vertex: VertexId, face: FaceId) -> (AffineMargin, BigInt, BigInt) {
        let other = side.other();
        let corners = self.block(other).topology().face(face);
        let k = BigInt::from(corners.len());
        let n = self.normal(other, face);
        let sum = corners.iter().fold(IntVector::zero(), |s, &v| s.plus(self.vertex(other, v)));
        let constant = self.vertex(side, vertex).scaled(&k).minus(&sum).dot(n);
        let gradient = n.scaled(&k);
        let gradient = if side == Side::B { gradient } else { gradient.negated() };
        let square = n.norm_squared();
        (AffineMargin { constant, gradient, exact: true }, square, k)
    }

    /// The gap times `2^shift·|N|` (all times `k`), plus `length·|N|·2^shift`: zero where the gap is −`length`.
    pub(crate) fn gap_above(&self, (gap, square, k): &(AffineMargin, BigInt, BigInt), length: &BigInt) -> AffineMargin {
        let norm = IntegerRoot::of(square);
        let mut margin = gap.times(&(BigInt::from(1) << norm.shift)).plus(&(length * k * &norm.root));
        margin.exact = norm.is_exact() || length.is_zero();
        margin
    }

    /// The offset (m) of B from where the block is, when it is `metres` beyond its start along `axis`.
    pub(crate) fn offset(&self, axis: usize, metres: BigRational) -> [BigRational; 3] {
        let mut offset = self.start.each_ref().map(Number::to_rational);
        offset[axis] += metres;
        offset
    }

    /// `numerator / denominator` lattice units in metres.
    pub(crate) fn metres(&self, numerator: &BigInt, denominator: &BigInt) -> BigRational {
        let (per_metre, over) = self.lattice.units_per_metre();
        fraction(numerator * over, denominator * per_metre)
    }

    /// Square units of `numerator / denominator` to m².
    pub(crate) fn square_metres(&self, numerator: &BigInt, denominator: &BigInt) -> BigRational {
        let (numerator, denominator) = self.in_square_metres(numerator.clone(), denominator.clone());
        fraction(numerator, denominator)
    }

    /// The same, not in lowest terms.
    pub(crate) fn in_square_metres(&self, numerator: BigInt, denominator: BigInt) -> (BigInt, BigInt) {
        let (per_metre, over) = self.lattice.units_per_metre();
        (numerator * &over * over, denominator * &per_metre * per_metre)
    }

    /// The offset of B from where the block is, when it is `vector / over` lattice units from its start.
    pub(crate) fn offset_by(&self, vector: &IntVector, over: &BigInt) -> [BigRational; 3] {
        let [x, y, z] = vector.components().map(|c| self.metres(c, over));
        let [sx, sy, sz] = self.start.each_ref().map(Number::to_rational);
        [x + sx, y + sy, z + sz]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotients_are_compared_with_squares_as_fractions_are() {
        for (n, d) in [(0, 5), (1, 16), (8, 100), (2, 18), (4, 36), (5, 36), (100, 1)] {
            for root in [0.0, 0.25, 0.5, 10.0] {
                let root = Number::from_f64(root).expect("a finite number");
                let is = BigRational::new(n.into(), d.into()) <= root.to_rational().pow(2);
                assert_eq!(at_most(&(n.into(), d.into()), &root), is);
            }
        }
    }

    #[test]
    fn fractions_are_in_lowest_terms() {
        let long = BigInt::from(3).pow(90);
        for n in [BigInt::from(0), BigInt::from(-12), BigInt::from(90), long.clone() * 4, -long.clone()] {
            for d in [BigInt::from(1), BigInt::from(-8), BigInt::from(36), long.clone() * 10, BigInt::from(1) << 200] {
                assert_eq!(fraction(n.clone(), d.clone()), BigRational::new(n.clone(), d));
            }
        }
    }
}
