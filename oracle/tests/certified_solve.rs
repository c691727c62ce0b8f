//! The certified solver against plain rational elimination: whatever it encloses holds the exact solution, and its exact
//! solution is the exact solution. Random systems of 6 to 24 unknowns, conditions from 1 to some 1e14; 10,000 of them at
//! full size.

#[path = "support/random_numbers.rs"]
mod random_numbers;

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, Zero};
use random_numbers::Random;
use rockproof_oracle::rational::Rational;
use rockproof_oracle::solve::{Enclosed, SolveError, SpdSystem};

const SYSTEMS: u64 = 300;

impl Random {
    fn small(&mut self) -> i64 {
        self.below(15) - 7
    }
}

struct Case {
    matrix: Vec<Vec<BigRational>>,
    right: Vec<BigRational>,
    /// Decimal digits between the largest and the smallest weight.
    spread: u32,
}

fn fraction(numerator: i64, denominator: i64) -> BigRational {
    BigRational::new(numerator.into(), denominator.into())
}

/// `Σ w·u·uᵀ`, as contact springs make it: n weights in full ranks from 1 down to 10^−spread, and a few more.
fn case(index: u64) -> Case {
    let mut random = Random(index.wrapping_mul(0x1234_5678_9abc_def1));
    let n = match random.below(10) {
        0 => 24,
        1 => 12 + random.below(12) as usize,
        _ => 6 + random.below(7) as usize,
    };
    let spread = random.below(15) as u32;
    let mut matrix = vec![vec![fraction(0, 1); n]; n];
    let more = random.below(4) as usize;
    for k in 0..n + more {
        // The k-th vector has a leading entry of its own, so that the first n of them span everything.
        let lead = k % n;
        let filled = random.below(6) as usize;
        let mut u = vec![0i64; n];
        u[lead] = 1 + random.below(3);
        for _ in 0..filled {
            let place = random.below(lead as u64 + 1) as usize;
            if place != lead {
                u[place] = random.small();
            }
        }
        let decades = if n > 1 { (spread as usize * lead / (n - 1)) as u32 } else { 0 };
        let thirds = [1, 3, 7][random.below(3) as usize];
        let weight =
            BigRational::new(BigInt::from(1 + random.below(9)), BigInt::from(thirds) * BigInt::from(10).pow(decades));
        for i in 0..n {
            for j in 0..n {
                if u[i] != 0 && u[j] != 0 {
                    matrix[i][j] += &weight * BigInt::from(u[i] * u[j]);
                }
            }
        }
    }
    let right = (0..n).map(|_| fraction(random.small(), 1 + random.below(5))).collect();
    Case { matrix, right, spread }
}

/// Gauss–Jordan in fractions, row by row, with no thought of speed.
fn plainly<Q: Rational>(case: &Case) -> Option<Vec<BigRational>> {
    let exact = |v: &BigRational| Q::from_fraction(v.numer(), v.denom());
    let n = case.right.len();
    let mut rows: Vec<Vec<Q>> = Vec::new();
    for (row, right) in case.matrix.iter().zip(&case.right) {
        rows.push(row.iter().chain([right]).map(exact).collect::<Option<_>>()?);
    }
    for pivot in 0..n {
        let found = (pivot..n).find(|&r| !rows[r][pivot].sign().is_zero())?;
        rows.swap(pivot, found);
        let top: Vec<Q> = rows[pivot].iter().map(|v| v.over(&rows[pivot][pivot])).collect::<Option<_>>()?;
        for (r, row) in rows.iter_mut().enumerate() {
            if r != pivot && !row[pivot].sign().is_zero() {
                let factor = row[pivot].clone();
                for c in pivot..=n {
                    row[c] = row[c].minus(&factor.times(&top[c]));
                }
            }
        }
        rows[pivot] = top;
    }
    Some(rows.iter().map(|row| row[n].to_big_rational()).collect())
}

#[test]
fn every_enclosure_holds_the_exact_solution() {
    hold_exact_solutions(SYSTEMS);
}

#[test]
#[ignore = "3,000 systems: a minute on busy cores; .ci/run runs it"]
fn every_enclosure_holds_the_exact_solution_at_full_size() {
    hold_exact_solutions(3_000);
}

/// What was found of some systems.
#[derive(Default)]
struct Tally {
    /// Proved definite by f64.
    by_float: u64,
    /// With weights over 13 decades.
    hard: u64,
    hard_by_float: u64,
    /// The widest enclosure of each by f64, over the largest unknown, as an exponent of two.
    widths: Vec<i64>,
}

fn hold_exact_solutions(systems: u64) {
    let halves = std::thread::scope(|scope| {
        let halves = [0..systems / 2, systems / 2..systems].map(|half| scope.spawn(|| examined(half)));
        halves.map(|half| half.join().expect("every enclosure holds"))
    });
    let add = |mut sum: Tally, half: Tally| {
        sum.by_float += half.by_float;
        sum.hard += half.hard;
        sum.hard_by_float += half.hard_by_float;
        sum.widths.extend(half.widths);
        sum
    };
    let Tally { by_float, hard, hard_by_float, mut widths } = halves.into_iter().fold(Tally::default(), add);
    widths.sort_unstable();
    println!(
        "{systems} systems, {by_float} proved definite by f64; {hard_by_float} of {hard} with weights over 13 decades; \
         f64 widths 2^{} median, 2^{} worst",
        widths[widths.len() / 2],
        widths[widths.len() - 1]
    );
    assert!(by_float * 2 > systems, "f64 proves too few: {by_float}");
    assert!(hard > systems / 20, "only {hard} hard systems");
}

fn examined(systems: std::ops::Range<u64>) -> Tally {
    let (mut by_float, mut hard, mut hard_by_float, mut widths) = (0, 0, 0, Vec::new());
    for index in systems {
        let case = case(index);
        let exact = plainly::<BigRational>(&case).unwrap();
        #[cfg(feature = "gmp")]
        assert_eq!(plainly::<rug::Rational>(&case).unwrap(), exact, "system {index}: the backends differ");
        let system = SpdSystem::new(case.matrix.clone(), case.right.clone()).unwrap();
        assert_eq!(system.exact().unwrap(), exact, "system {index}");
        let largest = exact.iter().map(|x| x.abs()).max().unwrap();
        hard += u64::from(case.spread >= 13);
        if let Some(enclosure) = system.float_enclosure() {
            by_float += 1;
            hard_by_float += u64::from(case.spread >= 13);
            for (x, exact) in enclosure.iter().zip(&exact) {
                assert!(x.holds(exact), "system {index}: f64 lost the solution");
            }
            let widest = enclosure.iter().map(|x| x.radius.clone()).max().unwrap();
            if !largest.is_zero() {
                widths.push(log2(&(widest / &largest)));
            }
        }
        for bits in [40, 150, 400] {
            let enclosure = system.enclosure(bits).unwrap();
            for (x, exact) in enclosure.iter().zip(&exact) {
                assert!(x.holds(exact), "system {index}: {bits} bits lost the solution");
                assert!(
                    &x.radius * (BigInt::from(1) << (bits - 1)) <= largest,
                    "system {index}: wider than {bits} bits"
                );
            }
        }
    }
    Tally { by_float, hard, hard_by_float, widths }
}

#[test]
fn an_enclosure_holds_its_ends_and_nothing_beyond() {
    let enclosed = Enclosed { middle: fraction(1, 1), radius: fraction(1, 4) };
    let little = fraction(1, 1 << 62);
    assert!([fraction(5, 4), fraction(3, 4), fraction(1, 1)].iter().all(|value| enclosed.holds(value)));
    assert!(!enclosed.holds(&(fraction(5, 4) + &little)) && !enclosed.holds(&(fraction(3, 4) - &little)));
    assert!(!enclosed.holds(&fraction(-1, 1)));
}

#[test]
fn f64_proves_a_matrix_definite_whose_least_eigenvalue_is_far_from_one() {
    // [[1, 1], [1, 1 + 2⁻²⁵]]: some 1.5e-8; and twice the unit matrix.
    let nearly = BigRational::new(1.into(), BigInt::from(1) << 25) + fraction(1, 1);
    let one = || fraction(1, 1);
    for matrix in [
        vec![vec![one(), one()], vec![one(), nearly]],
        vec![vec![fraction(2, 1), fraction(0, 1)], vec![fraction(0, 1), fraction(2, 1)]],
    ] {
        let system = SpdSystem::new(matrix, vec![fraction(1, 3), fraction(1, 7)]).unwrap();
        let exact = system.exact().unwrap();
        let enclosure = system.float_enclosure().expect("f64 proves it definite");
        assert!(enclosure.iter().zip(&exact).all(|(x, exact)| x.holds(exact)));
        assert!(enclosure.iter().all(|x| x.radius < fraction(1, 1)));
    }
}

/// The exponent of a positive fraction, within one.
fn log2(value: &BigRational) -> i64 {
    value.numer().bits() as i64 - value.denom().bits() as i64
}

#[test]
fn a_hilbert_matrix_is_solved_though_f64_cannot_prove_it_definite() {
    let n = 14;
    let matrix = (0..n).map(|i| (0..n).map(|j| fraction(1, i + j + 1)).collect()).collect();
    let mut right = vec![fraction(0, 1); n as usize];
    right[0] = fraction(1, 1);
    let system = SpdSystem::new(matrix, right).unwrap();
    assert!(system.float_enclosure().is_none());
    let exact = system.exact().unwrap();
    // The first column of the inverse is known: its first entry is n².
    assert_eq!(exact[0], fraction(n * n, 1));
    // Its condition, some 2⁶⁹, takes more than the 64 bits that are added at first: that try must be seen to be too wide.
    let largest = exact.iter().map(|x| x.abs()).max().unwrap();
    for bits in [40, 64, 300] {
        for (x, exact) in system.enclosure(bits).unwrap().iter().zip(&exact) {
            assert!(x.holds(exact), "{bits} bits");
            assert!(&x.radius * (BigInt::from(1) << (bits - 1)) <= largest, "wider than {bits} bits");
        }
    }
}

#[test]
fn what_is_not_definite_is_refused() {
    let q = |rows: [[i64; 2]; 2]| rows.map(|r| r.map(|v| fraction(v, 1)).to_vec()).to_vec();
    let right = || vec![fraction(1, 1), fraction(2, 1)];
    let indefinite = SpdSystem::new(q([[1, 2], [2, 1]]), right()).unwrap();
    assert_eq!(indefinite.enclosure(20), Err(SolveError::NotPositiveDefinite));
    let singular = SpdSystem::new(q([[1, 1], [1, 1]]), right()).unwrap();
    assert_eq!(singular.enclosure(20), Err(SolveError::NotPositiveDefinite));
    assert_eq!(singular.exact(), Err(SolveError::NotPositiveDefinite));
    assert_eq!(SpdSystem::new(q([[1, 2], [3, 9]]), right()).unwrap_err(), SolveError::NotSymmetric);
    assert_eq!(SpdSystem::new(q([[1, 0], [0, 1]]), vec![fraction(1, 1)]).unwrap_err(), SolveError::Shape);
}

/// Neighbours of the Fibonacci numbers: the determinant is 1 and −1 in turn, whatever their size; f64 holds the entries.
#[test]
fn a_matrix_indefinite_by_less_than_f64_can_see_is_not_called_definite() {
    let (mut one, mut two, mut three) = (1i64, 1i64, 2i64);
    let mut proved = 0;
    for n in 3.. {
        if three >= 1 << 53 {
            break;
        }
        let matrix = vec![vec![fraction(three, 1), fraction(two, 1)], vec![fraction(two, 1), fraction(one, 1)]];
        let system = SpdSystem::new(matrix, vec![fraction(1, 1), fraction(2, 1)]).unwrap();
        let definite = three as i128 * one as i128 > two as i128 * two as i128;
        let exact = system.exact().unwrap();
        if let Some(enclosure) = system.float_enclosure() {
            assert!(definite, "the matrix of Fibonacci number {n} is indefinite");
            assert!(enclosure.iter().zip(&exact).all(|(x, exact)| x.holds(exact)), "number {n}");
            proved += 1;
        }
        (one, two, three) = (two, three, two + three);
    }
    assert!(proved > 5, "f64 proves {proved}");
}

#[test]
fn a_singular_matrix_that_rounding_makes_definite_is_not_called_so() {
    for n in 1..400 {
        let p = fraction(n, 2 * n + 1);
        let matrix = vec![vec![fraction(1, 1), p.clone()], vec![p.clone(), &p * &p]];
        let system = SpdSystem::new(matrix, vec![fraction(1, 1), fraction(1, 1)]).unwrap();
        assert!(system.float_enclosure().is_none(), "n = {n}");
    }
}

#[test]
fn a_right_side_of_zeros_gives_zeros() {
    let system = SpdSystem::new(vec![vec![fraction(1, 3)]], vec![fraction(0, 1)]).unwrap();
    let enclosure = system.enclosure(64).unwrap();
    assert!(enclosure[0].middle.is_zero() && enclosure[0].radius.is_zero());
}
