use super::*;
use crate::double::Double;
use crate::dynamics::solve::dense;
use crate::wide::{Wide, in_bits};
use num_rational::BigRational;
use rockproof_cholesky::{Graph, Renumbered, elimination_order};

/// Numbers between -1 and 1.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 33) as f64 / f64::from(1u32 << 30) - 1.0
    }
}

/// A system of blocks of 6 and 12 unknowns in a ring, some of which meet across it: weights, and springs so many times as stiff.
struct Blocks {
    pattern: Pattern,
    values: Vec<f64>,
    right: Vec<f64>,
}

fn blocks(seed: u64, stiffer: f64) -> Blocks {
    let sizes: Vec<u8> = (0..15).map(|block| if block % 3 == 1 { 6 } else { 12 }).collect();
    let count = sizes.len() as u32;
    let mut pairs: Vec<[u32; 2]> = (0..count).map(|i| [i, (i + 1) % count]).collect();
    pairs.extend((0..count / 3).map(|i| [i, i + 7]));
    let pairs: Vec<[u32; 2]> = pairs.into_iter().map(|[a, b]| [a.min(b), a.max(b)]).collect();
    let graph = Graph { unknowns: &sizes, pairs: &pairs };
    let at: Vec<[f64; 3]> = (0..15).map(|k| [f64::from(k), f64::from(k * k % 7), 0.0]).collect();
    let order = elimination_order(graph, &at).expect("an order");
    let renumbered = Renumbered::new(graph, &order);
    let pattern = Pattern::new(renumbered.graph());
    let mut numbers = Numbers(seed);
    let n = pattern.size();
    let mut square = vec![0.0; n * n];
    for i in 0..n {
        square[i * n + i] = 1e3 * (1.5 + numbers.next());
    }
    for [a, b] in pairs {
        let places = [a, b].map(|block| pattern.unknowns(renumbered.places[block as usize] as usize));
        for _ in 0..4 {
            let arm: Vec<(usize, f64)> = places.iter().cloned().flatten().map(|i| (i, numbers.next())).collect();
            for &(i, one) in &arm {
                for &(j, two) in &arm {
                    square[i * n + j] += 1e3 * stiffer * one * two;
                }
            }
        }
    }
    let mut values = vec![0.0; pattern.values()];
    for PatternEntry { row, column, place } in pattern.entries() {
        values[place] = square[row * n + column];
    }
    let right = (0..n).map(|_| 1e4 * numbers.next()).collect();
    Blocks { pattern, values, right }
}

fn exactly(value: f64) -> BigRational {
    BigRational::from_float(value).expect("a number")
}

/// The middle and the radius.
fn ball<R: Enclosing>(value: R) -> [BigRational; 2] {
    [value.to_number().expect("a number").to_rational(), exactly(value.radius_bound())]
}

/// What elimination in 512 bits finds.
fn eliminated(pattern: &Pattern, values: &[Wide], mut right: Vec<Wide>) -> Vec<Wide> {
    dense(pattern, values, &mut right).expect("a solution");
    right
}

/// How wide the enclosure of a system's solution is, as a share of its largest unknown: after it was held against elimination.
fn enclosed<R: Enclosing>(system: &Blocks, expected: &[Wide]) -> f64 {
    let Blocks { pattern, values, right } = system;
    let own = |all: &[f64]| -> Vec<R> { all.iter().map(|&value| R::from_f64(value)).collect() };
    let mut found = own(right);
    solve_enclosed(pattern, &own(values), &mut found).expect("a solution");
    for (found, expected) in found.iter().zip(expected) {
        let ([middle, radius], [known, doubt]) = (ball(*found), ball(*expected));
        let apart = if middle > known { middle - known } else { known - middle };
        assert!(apart <= radius + doubt);
    }
    let most = |of: &dyn Fn(&R) -> f64| found.iter().map(of).fold(0.0, f64::max);
    most(&|x: &R| x.radius_bound()) / most(&|x: &R| x.to_f64().abs())
}

#[test]
fn an_enclosure_holds_what_elimination_finds_and_is_narrow() {
    for (seed, stiffer) in [(1, 1.0), (2, 1e3), (3, 1e6)] {
        let system = blocks(seed, stiffer);
        assert!(system.pattern.size() > crate::dynamics::solve::DENSE);
        let wide = |all: &[f64]| -> Vec<Wide> { all.iter().map(|&value| Wide::of_f64(value)).collect() };
        let expected = eliminated(&system.pattern, &wide(&system.values), wide(&system.right));
        let [double, wide] = [enclosed::<Double>(&system, &expected), enclosed::<Wide>(&system, &expected)];
        assert!((0.0..1e-20).contains(&(double / stiffer)) && double > 0.0, "{double:e} of two f64, {stiffer:e}");
        assert!((0.0..1e-140).contains(&(wide / stiffer)) && wide > 0.0, "{wide:e} of 512 bits, {stiffer:e}");
        let fewer = in_bits(128, || enclosed::<Wide>(&system, &expected));
        assert!(fewer / stiffer < 1e-30 && fewer > wide, "{fewer:e} of 128 bits, {stiffer:e}");
    }
}

/// The solutions of systems whose every entry and every force is off by a share, alternately up and down.
fn off_by(share: f64) -> Vec<Vec<Wide>> {
    let Blocks { pattern, values, right } = blocks(4, 1e2);
    let solved = |turn: usize| {
        let off = |all: &[f64]| -> Vec<Wide> {
            let up = |k: usize| if (k >> turn).is_multiple_of(2) { share } else { -share };
            all.iter().enumerate().map(|(k, &value)| Wide::of_f64(value) + Wide::of_f64(value * up(k))).collect()
        };
        eliminated(&pattern, &off(&values), off(&right))
    };
    (0..4).map(solved).collect()
}

/// Every entry and every force may be off; the solutions of systems that are off so far are held too.
fn holds_all_that_are_meant<R: Enclosing>(share: f64, solutions: &[Vec<Wide>]) {
    let Blocks { pattern, values, right } = blocks(4, 1e2);
    let loose = |all: &[f64]| -> Vec<R> {
        all.iter().map(|&value| R::from_f64(value).with_radius(value.abs() * share)).collect()
    };
    let mut found = loose(&right);
    solve_enclosed(&pattern, &loose(&values), &mut found).expect("a solution");
    let mut moved = 0;
    for (turn, expected) in solutions.iter().enumerate() {
        for (found, expected) in found.iter().zip(expected) {
            let ([middle, radius], [known, doubt]) = (ball(*found), ball(*expected));
            let apart = if middle > known { middle - known } else { known - middle };
            assert!(apart <= &radius + doubt, "turn {turn}, {share:e}");
            moved += usize::from(apart * BigRational::from_integer(1_000_000.into()) > radius);
        }
    }
    assert!(moved > 0, "no solution is elsewhere than the middle");
}

#[test]
fn an_enclosure_holds_the_solutions_of_all_systems_that_are_meant() {
    let (much, little) = (2f64.powi(-40), 2f64.powi(-300));
    let solutions = off_by(much);
    holds_all_that_are_meant::<Double>(much, &solutions);
    holds_all_that_are_meant::<Wide>(much, &solutions);
    holds_all_that_are_meant::<Wide>(little, &off_by(little));
}

/// A chain of n springs of 1 between points, both ends held: eigenvalues 2 − 2·cos(kπ/(n + 1)).
fn chain(n: u32) -> Blocks {
    let sizes = vec![1; n as usize];
    let pairs: Vec<[u32; 2]> = (1..n).map(|i| [i - 1, i]).collect();
    let pattern = Pattern::new(Graph { unknowns: &sizes, pairs: &pairs });
    let mut values = vec![0.0; pattern.values()];
    for PatternEntry { row, column, place } in pattern.entries() {
        values[place] = match row - column {
            0 => 2.0,
            1 => -1.0,
            _ => 0.0,
        };
    }
    Blocks { pattern, values, right: vec![1.0; n as usize] }
}

#[test]
fn the_bound_of_the_smallest_eigenvalue_is_below_it_and_near() {
    for n in [97u32, 300] {
        let Blocks { pattern, values, .. } = chain(n);
        let values: Vec<Double> = values.iter().map(|&value| Double::from_f64(value)).collect();
        let system = FloatSystem::new(&pattern, &values).expect("a bound");
        let smallest = 2.0 - 2.0 * (std::f64::consts::PI / f64::from(n + 1)).cos();
        assert!(system.least < smallest && system.least > smallest / 4.0, "{} for {smallest}", system.least);
    }
}

/// A chain whose last end is loose, but for a spring of so much, loses positive definiteness with it.
#[test]
fn what_f64_does_not_prove_to_be_definite_is_left_to_elimination() {
    let solved = |last: f64| {
        let Blocks { pattern, mut values, right } = chain(100);
        for PatternEntry { row, column, place } in pattern.entries() {
            if row == column && (row == 0 || row == 99) {
                values[place] = if row == 0 { 1.0 } else { 1.0 + last };
            }
        }
        let own = |all: &[f64]| -> Vec<Wide> { all.iter().map(|&value| Wide::of_f64(value)).collect() };
        let mut found = own(&right);
        let solved = solve_enclosed(&pattern, &own(&values), &mut found);
        assert!(solved.is_some() || found.iter().all(|x| x.to_f64() == 1.0), "the right side is as it was");
        solved.is_some()
    };
    assert!(solved(1.0) && solved(1e-3));
    assert!(!solved(1e-12) && !solved(0.0) && !solved(-1e-3));
    // No number is no proof.
    let Blocks { pattern, values, right } = chain(100);
    for place in 0..values.len() {
        let mut values: Vec<Double> = values.iter().map(|&value| Double::from_f64(value)).collect();
        values[place] = Double::from_f64(f64::NAN);
        let mut found: Vec<Double> = right.iter().map(|&value| Double::from_f64(value)).collect();
        let matters = pattern.entries().any(|entry| entry.place == place);
        let held = solve_enclosed(&pattern, &values, &mut found).is_some();
        assert!(!(matters && held), "{place}");
    }
}

#[test]
fn no_force_moves_nothing_exactly() {
    let Blocks { pattern, values, .. } = blocks(5, 10.0);
    let values: Vec<Wide> = values.iter().map(|&value| Wide::of_f64(value)).collect();
    let mut found = vec![Wide::EXACT_ZERO; pattern.size()];
    solve_enclosed(&pattern, &values, &mut found).expect("a solution");
    assert!(found.iter().all(|x| x.is_exact_zero()));
}

/// Every third unknown of each block is tied to such ones alone, and no force acts on them.
#[test]
fn a_part_on_which_no_force_acts_does_not_move_exactly() {
    let Blocks { pattern, mut values, mut right } = blocks(6, 10.0);
    let is_apart = |unknown: usize| unknown.is_multiple_of(3);
    for PatternEntry { row, column, place } in pattern.entries() {
        if is_apart(row) != is_apart(column) {
            values[place] = 0.0;
        }
    }
    (0..right.len()).filter(|&unknown| is_apart(unknown)).for_each(|unknown| right[unknown] = 0.0);
    let own = |all: &[f64]| -> Vec<Double> { all.iter().map(|&value| Double::from_f64(value)).collect() };
    let mut found = own(&right);
    solve_enclosed(&pattern, &own(&values), &mut found).expect("a solution");
    for (unknown, x) in found.into_iter().enumerate() {
        assert_eq!(x.is_exact_zero(), is_apart(unknown), "{unknown}");
    }
    let wide = |all: &[f64]| -> Vec<Wide> { all.iter().map(|&value| Wide::of_f64(value)).collect() };
    let mut found = wide(&right);
    right[3] = 1.0;
    solve_enclosed(&pattern, &wide(&values), &mut found).expect("a solution");
    let most = |of: &[Wide]| of.iter().map(|x| x.radius_bound()).fold(0.0, f64::max);
    let before = most(&found);
    // A large force on one part widens the other's radii by nothing.
    right[3] = 1e100;
    let mut found = wide(&right);
    solve_enclosed(&pattern, &wide(&values), &mut found).expect("a solution");
    let other: Vec<Wide> = found.into_iter().enumerate().filter(|(k, _)| !is_apart(*k)).map(|(_, x)| x).collect();
    assert!(most(&other) < 1e50 * before, "{:e} for {before:e}", most(&other));
}

/// A force that is nothing in f64 moves what is next to nothing as well.
#[test]
fn a_force_below_all_f64_is_not_lost() {
    let Blocks { pattern, mut values, .. } = chain(100);
    for PatternEntry { row, column, place } in pattern.entries() {
        values[place] = if row == column { 2f64.powi(-780) } else { 0.0 };
    }
    let values: Vec<Wide> = values.into_iter().map(Wide::of_f64).collect();
    let force = Wide::of_f64(2f64.powi(-550)) * Wide::of_f64(2f64.powi(-550));
    let mut found = vec![force; 100];
    solve_enclosed(&pattern, &values, &mut found).expect("a solution");
    for x in found {
        let [middle, radius] = ball(x);
        let apart = exactly(2f64.powi(-320)) - middle;
        assert!(apart <= radius && -apart <= radius);
    }
}
