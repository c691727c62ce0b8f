//! A pair of blocks, and its exact vectors for when f64 cannot decide.

use crate::field::DoubleBall;
use crate::number::{Ball, Bits, Fixed, Int128, Magnitude};
use crate::own_lattice::{OwnLattice, SMALL_BITS};
use crate::prepared_block::PreparedBlock;
use crate::trace::Recordings;
use crate::view::{ExactBlock, ExactPair};
use num_bigint::BigInt;
use num_traits::Signed;
use rockproof_model::decision::Side;
use rockproof_model::lattice::Lattice;
use rockproof_model::number::power_of_two;
use rockproof_model::{Entrance, Ring, Topology, Vec3};
use std::cell::{OnceCell, RefCell};

/// 256-bit integers.
pub(crate) type Int256 = Fixed<256, 4>;
/// 512-bit integers.
pub(crate) type Int512 = Fixed<512, 8>;
/// 1,024-bit integers.
pub(crate) type Int1024 = Fixed<1024, 16>;

/// Two blocks whose contacts are asked for.
///
/// Making one costs next to nothing. The exact lattice vectors are made when a sign first needs them and then serve
/// every tolerance set.
pub struct Pair<'s> {
    pub(crate) a: &'s PreparedBlock,
    pub(crate) b: &'s PreparedBlock,
    grid: OnceCell<PairLattice>,
    double: Made<'s, DoubleBall>,
    /// Planes of entrances that were compared, as [`crate::predicate::sharp_plane`] has them.
    pub(crate) planes: RefCell<Vec<(Entrance, (Ball, Ball))>>,
    small: Made<'s, Int128>,
    int256: Made<'s, Int256>,
    int512: Made<'s, Int512>,
    int1024: Made<'s, Int1024>,
    heap: Made<'s, BigInt>,
    magnitudes: OnceCell<Box<MagnitudePairs<'s>>>,
    pub(crate) recordings: Recordings,
}

/// The pair in one number type, once it is asked for; elsewhere, so that a pair itself is small.
pub(crate) type Made<'s, T> = OnceCell<Box<ExactPair<'s, T>>>;

/// The pair for margins: in balls of two f64 and in integers of each width, with the sizes of their terms.
#[derive(Default)]
pub(crate) struct MagnitudePairs<'s> {
    pub(crate) double: Made<'s, Magnitude<DoubleBall>>,
    pub(crate) small: Made<'s, Magnitude<Int128>>,
    pub(crate) int256: Made<'s, Magnitude<Int256>>,
    pub(crate) int512: Made<'s, Magnitude<Int512>>,
    pub(crate) heap: Made<'s, Magnitude<BigInt>>,
}

/// The vertices of a pair as integers, relative to A's first vertex.
pub(crate) struct PairLattice {
    pub(crate) lattice: Lattice,
    pub(crate) bits: Bits,
    units: LatticeVertices,
}

enum LatticeVertices {
    Small([Vec<Vec3<i128>>; 2]),
    Big([Vec<Vec3<BigInt>>; 2]),
}

/// An integer type a lattice coordinate or tolerance can be turned into.
///
/// What does not fit is cut off, which leaves the value modulo a power of two: the sign of a predicate is right in the type if the
/// predicate's own value fits.
pub(crate) trait FromUnits: Ring {
    fn from_small(value: i128) -> Self;
    fn from_big(value: &BigInt) -> Self;
}

impl FromUnits for Int128 {
    fn from_small(value: i128) -> Self {
        Int128(value)
    }
    fn from_big(value: &BigInt) -> Self {
        let magnitude =
            value.iter_u64_digits().take(2).zip([0, 64]).fold(0, |sum, (digit, at)| sum | i128::from(digit) << at);
        Int128(if value.sign() == num_bigint::Sign::Minus { magnitude.wrapping_neg() } else { magnitude })
    }
}

impl<const BITS: usize, const LIMBS: usize> FromUnits for Fixed<BITS, LIMBS> {
    fn from_small(value: i128) -> Self {
        Self::from_i128(value)
    }
    fn from_big(value: &BigInt) -> Self {
        Self::from_bigint(value)
    }
}

impl FromUnits for BigInt {
    fn from_small(value: i128) -> Self {
        BigInt::from(value)
    }
    fn from_big(value: &BigInt) -> Self {
        value.clone()
    }
}

impl<T: FromUnits> FromUnits for Magnitude<T> {
    fn from_small(value: i128) -> Self {
        Magnitude { value: T::from_small(value), terms: T::from_small(value.abs()) }
    }
    fn from_big(value: &BigInt) -> Self {
        Magnitude { value: T::from_big(value), terms: T::from_big(&value.abs()) }
    }
}

impl PairLattice {
    fn new(a: &PreparedBlock, b: &PreparedBlock) -> PairLattice {
        PairLattice::of_own(a, b).unwrap_or_else(|| PairLattice::of_numbers(a, b))
    }

    /// From the lattice of each block, where 120 bits hold their vertices on the common one.
    fn of_own(a: &PreparedBlock, b: &PreparedBlock) -> Option<PairLattice> {
        let [a, b] = [a.own_lattice()?, b.own_lattice()?];
        let (lattice, factors) = Lattice::common([&a.lattice, &b.lattice], SMALL_BITS)?;
        let [(first_a, step_a), (first_b, step_b)] = [a.scaled(factors[0])?, b.scaled(factors[1])?];
        let mut bits = 0;
        let mut of_block = |own: &OwnLattice, step: i128, first: Vec3<i128>| -> Vec<Vec3<i128>> {
            let from_origin = |v: &Vec3<i128>| {
                let at = Vec3::new(first.x + v.x * step, first.y + v.y * step, first.z + v.z * step);
                // The highest digit of all.
                bits |= at.x.unsigned_abs() | at.y.unsigned_abs() | at.z.unsigned_abs();
                at
            };
            own.vertices.iter().map(from_origin).collect()
        };
        let apart = Vec3::new(first_b.x - first_a.x, first_b.y - first_a.y, first_b.z - first_a.z);
        let units = [of_block(a, step_a, Vec3::new(0, 0, 0)), of_block(b, step_b, apart)];
        Some(PairLattice {
            lattice,
            bits: Bits(u128::BITS - bits.leading_zeros()),
            units: LatticeVertices::Small(units),
        })
    }

    fn of_numbers(a: &PreparedBlock, b: &PreparedBlock) -> PairLattice {
        let lattice = Lattice::covering(a.block.coordinates().chain(b.block.coordinates()));
        let prepared = [a, b];
        let all = prepared
            .map(|s| s.block.vertices().iter().map(|v| v.map(|c| lattice.units(c))).collect::<Vec<Vec3<BigInt>>>());
        let origin = all[0][0].clone();
        let units = all.map(|vertices| vertices.iter().map(|v| v.minus(&origin)).collect::<Vec<_>>());
        let widest = units.iter().flatten().flat_map(|v| [v.x.bits(), v.y.bits(), v.z.bits()]).max();
        PairLattice { lattice, bits: Bits(widest.unwrap_or(0) as u32), units: LatticeVertices::Big(units) }
    }

    fn vertices<T: FromUnits>(&self, side: Side) -> Vec<Vec3<T>> {
        let k = usize::from(side == Side::B);
        match &self.units {
            LatticeVertices::Small(units) => units[k].iter().map(|v| v.map(|&c| T::from_small(c))).collect(),
            LatticeVertices::Big(units) => units[k].iter().map(|v| v.map(T::from_big)).collect(),
        }
    }
}

impl<'s> Pair<'s> {
    /// The pair of two blocks; A is the first everywhere.
    #[inline]
    pub fn new(a: &'s PreparedBlock, b: &'s PreparedBlock) -> Pair<'s> {
        Pair {
            a,
            b,
            grid: OnceCell::new(),
            double: OnceCell::new(),
            planes: RefCell::default(),
            small: OnceCell::new(),
            int256: OnceCell::new(),
            int512: OnceCell::new(),
            int1024: OnceCell::new(),
            heap: OnceCell::new(),
            magnitudes: OnceCell::new(),
            recordings: Recordings::default(),
        }
    }

    #[inline(always)]
    pub(crate) fn prepared(&self, side: Side) -> &'s PreparedBlock {
        match side {
            Side::A => self.a,
            Side::B => self.b,
        }
    }

    #[inline(always)]
    pub(crate) fn topology(&self, side: Side) -> &'s Topology {
        self.prepared(side).block.topology()
    }

    pub(crate) fn grid(&self) -> &PairLattice {
        self.grid.get_or_init(|| PairLattice::new(self.a, self.b))
    }

    /// The exact vectors in any integer type, made anew.
    pub(crate) fn exact<T: FromUnits>(&self) -> ExactPair<'s, T> {
        let grid = self.grid();
        ExactPair {
            a: ExactBlock::new(self.topology(Side::A), grid.vertices(Side::A)),
            b: ExactBlock::new(self.topology(Side::B), grid.vertices(Side::B)),
        }
    }

    /// The pair in balls of two f64, from A's first vertex, in units of `2^bits` units of the lattice, the least that makes all
    /// coordinates smaller than 1.
    pub(crate) fn double(&self) -> &ExactPair<'s, DoubleBall> {
        self.double.get_or_init(|| Box::new(self.in_double(|ball| ball)))
    }

    /// Whether [`Pair::double`] is there already.
    pub(crate) fn is_in_double(&self) -> bool {
        self.double.get().is_some()
    }

    /// [`Pair::double`] with something made of each coordinate.
    pub(crate) fn in_double<T: Ring>(&self, made_of: impl Fn(DoubleBall) -> T) -> ExactPair<'s, T> {
        let PairLattice { bits, units, .. } = self.grid();
        let exponent = -i64::from(bits.0);
        let [a, b]: [Vec<Vec3<T>>; 2] = match units {
            LatticeVertices::Small(units) => {
                let unit = power_of_two(exponent as i32);
                let coordinate = |c: &i128| made_of(DoubleBall::of_units(*c, unit));
                units.each_ref().map(|vertices| vertices.iter().map(|v| v.map(coordinate)).collect())
            }
            LatticeVertices::Big(units) => {
                let coordinate = |c: &BigInt| made_of(DoubleBall::of_integer(c, exponent));
                units.each_ref().map(|vertices| vertices.iter().map(|v| v.map(coordinate)).collect())
            }
        };
        ExactPair { a: ExactBlock::new(self.topology(Side::A), a), b: ExactBlock::new(self.topology(Side::B), b) }
    }

    pub(crate) fn small(&self) -> &ExactPair<'s, Int128> {
        self.small.get_or_init(|| Box::new(self.exact()))
    }

    pub(crate) fn int256(&self) -> &ExactPair<'s, Int256> {
        self.int256.get_or_init(|| Box::new(self.exact()))
    }

    pub(crate) fn int512(&self) -> &ExactPair<'s, Int512> {
        self.int512.get_or_init(|| Box::new(self.exact()))
    }

    pub(crate) fn int1024(&self) -> &ExactPair<'s, Int1024> {
        self.int1024.get_or_init(|| Box::new(self.exact()))
    }

    pub(crate) fn heap(&self) -> &ExactPair<'s, BigInt> {
        self.heap.get_or_init(|| Box::new(self.exact()))
    }

    pub(crate) fn magnitudes(&self) -> &MagnitudePairs<'s> {
        self.magnitudes.get_or_init(Box::default)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_integers_are_the_same_in_every_type() {
        for value in [0, 1, -1, 1i128 << 70, -(1i128 << 70), (1 << 120) - 1, 1 - (1 << 120)] {
            let big = BigInt::from(value);
            assert_eq!(Int128::from_big(&big), Int128(value));
            assert_eq!(Int256::from_big(&big), Int256::from_small(value));
            assert_eq!(BigInt::from_small(value), big);
            assert_eq!(BigInt::from_big(&big), big);
        }
    }

    /// Blocks of few digits and of many, near and far, in fractions or not.
    #[test]
    fn the_lattice_of_two_blocks_is_that_of_all_their_numbers() {
        use rockproof_model::{Block, Number};
        let mut dice = crate::soundness::Dice(3);
        let (mut short, mut long) = (0, 0);
        for round in 0..400 {
            let mut cuboid = || {
                let (digits, shift) = (1 + dice.below(52), dice.below(120) as i32 - 60);
                let far = [0.0, 0.0, 1.0, 1e6][dice.below(4) as usize];
                let part = [(1, 1), (1, 1), (1, 3), (2, 15)][dice.below(4) as usize];
                let part = Number::from_rational(num_rational::BigRational::new(part.0.into(), part.1.into()));
                let mut coordinate = |least: u64| {
                    let value = ((1 << digits) * least + dice.below(1 << digits)) as f64 + far;
                    Number::from_f64(value * power_of_two(shift)).unwrap().times(&part)
                };
                let mut corner = |least| Vec3::new(coordinate(least), coordinate(least), coordinate(least));
                let (low, high) = (corner(0), corner(1));
                PreparedBlock::new(&Block::cuboid(&low, &high).unwrap())
            };
            let (a, b) = (cuboid(), cuboid());
            let plainly = PairLattice::of_numbers(&a, &b);
            let Some(found) = PairLattice::of_own(&a, &b) else {
                long += 1;
                continue;
            };
            short += 1;
            assert_eq!((&found.lattice, found.bits), (&plainly.lattice, plainly.bits), "round {round}");
            for side in [Side::A, Side::B] {
                assert_eq!(found.vertices::<BigInt>(side), plainly.vertices::<BigInt>(side), "round {round}, {side:?}");
            }
        }
        assert!(short > 100 && long > 20, "{short} held by 120 bits, {long} not");
    }

    #[test]
    fn large_integers_are_the_same_in_every_type_that_holds_them() {
        for bits in [127u32, 130, 250, 500] {
            for value in [BigInt::from(3) << bits, -(BigInt::from(1) << bits) + 1] {
                assert_eq!(BigInt::from_big(&value), value);
                let magnitude = Magnitude::<BigInt>::from_big(&value);
                assert_eq!((magnitude.value, magnitude.terms), (value.clone(), value.abs()));
            }
        }
    }

    /// Coordinates of more than 120 bits on the pair's lattice: B's bottom is 2⁻¹³⁰/3 above A's top.
    #[test]
    fn gaps_on_a_fine_lattice_are_exact() {
        use num_rational::BigRational;
        use rockproof_model::{Block, Entrance, FaceId, Number, Sign, VertexId};
        let number = |numerator: i32, denominator: i32| {
            Number::from_rational(BigRational::new(numerator.into(), denominator.into()))
        };
        let hair = BigRational::new(1.into(), BigInt::from(3) << 130u32);
        let height = Number::from_rational(BigRational::from_integer(1.into()) + &hair);
        let at = |c: [i32; 3], d: i32| Vec3::new(c[0], c[1], c[2]).map(|&c| number(c, d));
        let a = PreparedBlock::new(&Block::cuboid(&at([0, 0, 0], 1), &at([1, 1, 1], 1)).unwrap());
        let low = Vec3::new(number(1, 3), number(1, 3), height);
        let high = Vec3::new(number(4, 3), number(4, 3), number(2, 1));
        let b = PreparedBlock::new(&Block::cuboid(&low, &high).unwrap());
        let top = (0..6).map(FaceId).find(|f| a.faces[f.index()].normal.z.0 > 0.0).unwrap();
        let lowest: VertexId = b.extremes[2].0;
        let gap = Pair::new(&a, &b).gap(&Entrance::FaceVertex(top, lowest));
        assert_eq!((gap.sign, gap.squared), (Sign::Positive, &hair * &hair));
    }
}
