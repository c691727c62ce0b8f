//! Solved ties: for every slot of polynomials a tolerance or a coordinate is chosen so that the polynomial is exactly zero, then moved by
//! one last place to either side, with numbers of so many digits that each level of the cascade has to decide. Every level, and the
//! cascade as a whole, must say what fractions say: they are taken in metres, without lattice, widths or bounds.

use super::in_integers::{InIntegers, PolynomialInIntegers};
use super::{Dice, Visitor, show_all, without_tolerances};
use crate::field::Field;
use crate::levels::LevelCounts;
use crate::number::Ball;
use crate::pair::Pair;
use crate::predicate::{Polynomial, SIGN_SLOTS};
use crate::prepared_block::PreparedBlock;
use crate::sign_cascade::SignCascade;
use crate::view::{BallView, ExactBlock, ExactPair, ExactView, FloatView, LazyScales, Scales};
use num_bigint::BigInt;
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::{One, Signed};
use rockproof_model::number::dyadic;
use rockproof_model::ring::ExactRing;
use rockproof_model::{Block, BlockOptions, Number, Sign, ToleranceSet, Vec3};
use std::cell::OnceCell;

/// A number that a tie is solved for, or that is moved.
#[derive(Clone, Copy, Debug)]
enum Variable {
    /// s, r, g: 0 to 2. so, sp, ε: 3 to 5.
    Tolerance(usize),
    Coordinate {
        block: usize,
        vertex: usize,
        axis: usize,
    },
}

/// The first of the tolerances that are no lengths.
const RATIOS: usize = 3;

/// What a pair and its tolerances are made of. Lengths are integers once a tie is solved.
#[derive(Clone, Debug)]
struct Numbers {
    vertices: [Vec<[BigRational; 3]>; 2],
    tolerances: [BigRational; 6],
}

impl Numbers {
    fn place(&mut self, variable: Variable) -> &mut BigRational {
        match variable {
            Variable::Tolerance(k) => &mut self.tolerances[k],
            Variable::Coordinate { block, vertex, axis } => &mut self.vertices[block][vertex][axis],
        }
    }

    fn with(&self, variable: Variable, value: BigRational) -> Numbers {
        let mut changed = self.clone();
        *changed.place(variable) = value;
        changed
    }

    fn lengths(&mut self) -> impl Iterator<Item = &mut BigRational> {
        self.vertices.iter_mut().flatten().flatten().chain(&mut self.tolerances[..RATIOS])
    }

    fn times(&self, factor: &BigInt) -> Numbers {
        let mut scaled = self.clone();
        scaled.lengths().for_each(|length| *length *= factor);
        scaled
    }

    /// All lengths times the least number that makes them integers.
    fn in_integers(mut self) -> Numbers {
        let factor = self.lengths().fold(BigInt::one(), |all, length| all.lcm(length.denom()));
        self.times(&factor)
    }

    /// The polynomial in fractions.
    fn value<P: Polynomial>(&self, shapes: &[Block; 2], p: &P) -> BigRational {
        let [a, b] = [0, 1].map(|k: usize| {
            let vertices = self.vertices[k].iter().map(|[x, y, z]| Vec3::new(x.clone(), y.clone(), z.clone()));
            ExactBlock::new(shapes[k].topology(), vertices.collect())
        });
        let make = || {
            let [search, territory, penetration, overlap, parallel, equal] = self.tolerances.clone();
            let (unit, one, whole) = (BigRational::one(), BigRational::one(), BigRational::one());
            Scales { unit, search, territory, penetration, one, overlap, parallel, whole, equal }
        };
        p.value(&ExactView {
            geometry: &ExactPair { a, b },
            scales: LazyScales { made: &OnceCell::new(), make: &make },
        })
    }

    /// The same as the cascade is given them, lengths over `2^shift`.
    fn given(&self, shapes: &[Block; 2], shift: u32) -> ([PreparedBlock; 2], ToleranceSet) {
        // Only twos can cancel where a length is an integer.
        let length = |value: &BigRational| {
            assert!(value.is_integer());
            Number::from_rational(dyadic(value.numer().clone(), -i64::from(shift)))
        };
        let blocks = [0, 1].map(|k: usize| {
            let vertices = self.vertices[k].iter().map(|[x, y, z]| Vec3::new(length(x), length(y), length(z)));
            PreparedBlock::new(&shapes[k].with_vertices(vertices.collect()))
        });
        let [search, territory, penetration] = [0, 1, 2].map(|k: usize| length(&self.tolerances[k]));
        let [overlap_sine, parallel_sine, equal] =
            [3, 4, 5].map(|k: usize| Number::from_rational(self.tolerances[k].clone()));
        let t =
            ToleranceSet { search, territory, penetration, overlap_sine, parallel_sine, equal, ..without_tolerances() };
        (blocks, t)
    }
}

/// A value of this variable, not zero and of few digits, at which the polynomial is zero though it is not zero everywhere, where it is of
/// degree 1 or 2 in it and has such a root.
fn root<P: Polynomial>(numbers: &Numbers, shapes: &[Block; 2], p: &P, variable: Variable) -> Option<BigRational> {
    let at = |x: i32| numbers.with(variable, BigRational::from_integer(x.into())).value(shapes, p);
    let [f0, f1, f2] = [0, 1, 2].map(at);
    let two = BigInt::from(2);
    let square = (&f2 - &f1 * &two + &f0) / &two;
    let slope = &f1 - &f0 - &square;
    let roots = if square.is_zero() {
        if slope.is_zero() {
            return None;
        }
        vec![-f0 / slope]
    } else {
        let discriminant = &slope * &slope - &square * &f0 * BigInt::from(4);
        if discriminant.is_negative() {
            return None;
        }
        let root = Field::root(&discriminant)?;
        [root.clone(), -root].map(|root| (root - &slope) / (&square * &two)).to_vec()
    };
    let fits = |x: &BigRational| {
        let positive = match variable {
            Variable::Tolerance(k) => x.is_positive() && (k < RATIOS || x <= &BigRational::one()),
            Variable::Coordinate { .. } => !x.is_zero(),
        };
        positive && x.numer().bits() <= 8 && x.denom().bits() <= 3
    };
    let found = roots.into_iter().find(fits)?;
    numbers.with(variable, found.clone()).value(shapes, p).is_zero().then_some(found)
}

/// Which of i128, 256, 512, 1,024 bits, and integers on the heap values of so many bits want.
fn level_of(bits: u32) -> usize {
    [128, 256, 512, 1024].into_iter().filter(|&width| bits >= width).count()
}

const LEVELS: usize = 5;

fn by_level(levels: &LevelCounts) -> [u64; LEVELS] {
    let [narrow, middle, wide] = levels.fixed;
    [levels.i128, narrow, middle, wide, levels.heap]
}

/// What was seen of one slot.
#[derive(Clone, Debug, Default)]
struct Seen {
    /// Ties decided in integers of each width, and what is one last place beside them: negative and positive.
    ties: [u64; LEVELS],
    beside: [[u64; 2]; LEVELS],
    /// Ties that balls of f64 decided.
    by_ball: u64,
    /// Beside ties by the last bit of an f64.
    by_last_bit: u64,
}

impl Seen {
    /// Whether integers of this width have decided a tie, and what is beside one on either side.
    fn has_level(&self, level: usize) -> bool {
        self.ties[level] > 0 && self.beside[level].iter().all(|&count| count > 0)
    }

    fn is_complete(&self) -> bool {
        self.by_ball > 0 && self.by_last_bit > 0 && (0..LEVELS).all(|level| self.has_level(level))
    }
}

/// Solves ties of the polynomials that it is shown, and asks all levels about them.
struct Solver<'s> {
    shapes: &'s [Block; 2],
    numbers: &'s Numbers,
    dice: Dice,
    seen: &'s mut [Seen],
}

impl Solver<'_> {
    fn any_coordinate(&mut self) -> Variable {
        let block = self.dice.below(2) as usize;
        let vertex = self.dice.below(self.numbers.vertices[block].len() as u64) as usize;
        Variable::Coordinate { block, vertex, axis: self.dice.below(3) as usize }
    }

    /// Holds that each level that can say it, and the cascade, say what fractions say; the level that integers took, and whether balls
    /// know the sign.
    fn check<P: Polynomial>(&self, p: &P, numbers: &Numbers, shift: u32) -> (Sign, usize, bool) {
        let value = numbers.value(self.shapes, p);
        let exact = ExactRing::sign(&value);
        let ([a, b], t) = numbers.given(self.shapes, shift);
        let pair = Pair::new(&a, &b);
        let slot = P::FIRST_SLOT + p.variant();
        let about = format!("{exact:?} for {numbers:?} over 2^{shift}");
        let integers = InIntegers::new(&pair, &t);
        let in_integers = PolynomialInIntegers::new(&integers, p);
        let bits = in_integers.bits;
        assert_eq!(in_integers.exact(), exact, "integers on the heap, slot {slot}, {about}");
        in_integers.check_widths(exact, &about);
        let mut run = SignCascade::new(&pair, &t);
        assert_eq!(run.exact_sign(p), exact, "the width of integers chosen, slot {slot}, {about}");
        let mut expected = [0; LEVELS];
        expected[level_of(bits.0)] = 1;
        assert_eq!(by_level(&run.levels), expected, "the level for {bits:?}, slot {slot}");
        // Twice: the second time the bound for all pairs of the size is known.
        for time in 1..=2 {
            assert_eq!(run.sign(p), exact, "the cascade, slot {slot}, time {time}, {about}");
        }
        super::parts::check_error(&run, p, &(value / (BigInt::one() << (shift * P::DEGREE as u32))), &about);
        let floats = Scales::approximate(&t);
        let balls = p.value(&BallView {
            floats: FloatView { a: &a, b: &b, scales: &floats },
            scales: LazyScales { made: &OnceCell::<Scales<Ball>>::new(), make: &|| Scales::balls(&t) },
        });
        let known = balls.certain_sign();
        assert!(known.is_none_or(|sign| sign == exact), "balls, slot {slot}, {about}");
        (exact, level_of(bits.0), known.is_some())
    }

    /// Moves one length by `step` to either side so that the polynomial is not zero at one of them at least: `variable` or a coordinate.
    fn look_beside<P: Polynomial>(
        &mut self,
        p: &P,
        tie: &Numbers,
        variable: Variable,
        shift: u32,
        step: impl Fn(&BigRational) -> BigInt,
    ) -> Vec<(Sign, usize)> {
        let own = [variable].into_iter().filter(|v| !matches!(v, Variable::Tolerance(RATIOS..)));
        let others: Vec<Variable> = (0..12).map(|_| self.any_coordinate()).collect();
        for moved in own.chain(others) {
            let value = tie.clone().place(moved).clone();
            let by = BigRational::from_integer(step(&value));
            let sides = [&value - &by, &value + &by].map(|value| tie.with(moved, value));
            if sides.iter().all(|side| side.value(self.shapes, p).is_zero()) {
                continue;
            }
            let checked = sides.iter().map(|side| self.check(p, side, shift));
            return checked.filter(|(sign, ..)| !sign.is_zero()).map(|(sign, level, _)| (sign, level)).collect();
        }
        Vec::new()
    }

    fn look_at<P: Polynomial>(&mut self, p: &P, tie: &Numbers, variable: Variable) {
        let slot = P::FIRST_SLOT + p.variant();
        let (sign, _, by_ball) = self.check(p, tie, 0);
        assert!(sign.is_zero());
        self.seen[slot].by_ball += u64::from(by_ball);
        if self.seen[slot].by_last_bit == 0 {
            // The last bit of an f64: 52 places after the first.
            let last_bit = |value: &BigRational| BigInt::one() << (value.numer().bits().max(53) - 53);
            let beside = self.look_beside(p, &tie.times(&(BigInt::one() << 60)), variable, 60, last_bit);
            self.seen[slot].by_last_bit += u64::from(!beside.is_empty());
        }
        let bits = {
            let ([a, b], t) = tie.given(self.shapes, 0);
            InIntegers::new(&Pair::new(&a, &b), &t).bits(p).0
        };
        for level in 0..LEVELS {
            if self.seen[slot].has_level(level) {
                continue;
            }
            // As wide as the level holds; on the heap a little wider than it must be.
            let most = [127u32, 255, 511, 1023, 1060][level];
            let Some(digits) = most.checked_sub(bits).map(|more| more / P::DEGREE as u32) else { continue };
            // Odd, as a lattice leaves twos out: 1010…1.
            let factor = |digits: u32| ((BigInt::one() << (digits + 1)) / 3) | BigInt::one();
            let scaled = (0..digits.min(4)).find_map(|less| {
                let digits = digits - less;
                let scaled = tie.times(&factor(digits));
                let ([a, b], t) = scaled.given(self.shapes, digits);
                (level_of(InIntegers::new(&Pair::new(&a, &b), &t).bits(p).0) == level).then_some((scaled, digits))
            });
            let Some((scaled, digits)) = scaled else { continue };
            let (sign, found, _) = self.check(p, &scaled, digits);
            assert!(sign.is_zero() && found == level);
            self.seen[slot].ties[level] += 1;
            for (sign, level) in self.look_beside(p, &scaled, variable, digits, |_| BigInt::one()) {
                self.seen[slot].beside[level][usize::from(sign.is_positive())] += 1;
            }
        }
    }
}

impl Visitor for Solver<'_> {
    fn visit<P: Polynomial>(&mut self, p: &P) {
        let slot = P::FIRST_SLOT + p.variant();
        if self.seen[slot].is_complete() {
            return;
        }
        let coordinates: Vec<Variable> = (0..3).map(|_| self.any_coordinate()).collect();
        for variable in (0..6).map(Variable::Tolerance).chain(coordinates) {
            if let Some(value) = root(self.numbers, self.shapes, p, variable) {
                let tie = self.numbers.with(variable, value).in_integers();
                self.look_at(p, &tie, variable);
                if self.seen[slot].is_complete() {
                    return;
                }
            }
        }
    }
}

/// A tetrahedron or a cuboid, which random numbers may make any other hexahedron, with the corners of its box.
fn shape(tetrahedron: bool) -> (Block, Vec<[i32; 3]>) {
    let number = |corner: &[i32; 3]| Vec3::new(corner[0], corner[1], corner[2]).map(|&c| Number::from_integer(c));
    let (corners, faces) = if tetrahedron {
        let corners = vec![[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]];
        (corners, vec![vec![0, 2, 1], vec![0, 1, 3], vec![1, 2, 3], vec![2, 0, 3]])
    } else {
        let corners = vec![[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
        let sides = vec![vec![0, 1, 5, 4], vec![1, 2, 6, 5], vec![2, 3, 7, 6], vec![3, 0, 4, 7]];
        (corners, [vec![0, 3, 2, 1], vec![4, 5, 6, 7]].into_iter().chain(sides).collect())
    };
    let vertices = corners.iter().map(number).collect();
    (Block::new(vertices, faces, &BlockOptions { planarity: Number::ZERO }).expect("a block"), corners)
}

fn draw(dice: &mut Dice) -> ([Block; 2], Numbers) {
    let whole = |value: i64| BigRational::from_integer(value.into());
    let bent = dice.below(2) == 0;
    let drawn = [0, 1].map(|_| {
        let (block, corners) = shape(dice.below(2) == 0);
        let sizes = [0; 3].map(|_: i32| dice.pick(&[1i64, 2, 4]));
        let origin = [0; 3].map(|_: i32| dice.below(5) as i64 - 2);
        let vertices: Vec<[BigRational; 3]> = corners
            .iter()
            .map(|corner| {
                std::array::from_fn(|k| {
                    let off = if bent && dice.below(3) == 0 { dice.below(3) as i64 - 1 } else { 0 };
                    whole(i64::from(corner[k]) * sizes[k] + origin[k] + off)
                })
            })
            .collect();
        (block, vertices)
    });
    let [(a, of_a), (b, of_b)] = drawn;
    let half = |dice: &mut Dice| BigRational::new(dice.below(3).into(), 2.into());
    let tolerances = std::array::from_fn(|k| if k < RATIOS { whole(dice.below(4) as i64) } else { half(dice) });
    ([a, b], Numbers { vertices: [of_a, of_b], tolerances })
}

#[test]
fn every_level_decides_solved_ties_and_what_is_a_last_place_beside_them() {
    let mut dice = Dice(3);
    let mut seen = vec![Seen::default(); SIGN_SLOTS];
    for _ in 0..400 {
        let (shapes, numbers) = draw(&mut dice);
        let ([a, b], _) = numbers.given(&shapes, 0);
        let own = Dice(dice.next());
        let mut solver = Solver { shapes: &shapes, numbers: &numbers, dice: own, seen: &mut seen };
        show_all(&Pair::new(&a, &b), &mut dice, &mut solver);
        if seen.iter().all(Seen::is_complete) {
            break;
        }
    }
    let missing: Vec<_> = seen.iter().enumerate().filter(|(_, seen)| !seen.is_complete()).collect();
    assert!(missing.is_empty(), "{missing:#?}");
}
