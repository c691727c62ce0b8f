//! Conjugate gradients by a factor in f32: how much work they do, and where they begin.

use super::two_level_tests::{direct, with_system_of};
use crate::dynamics::conjugate_gradients::{ConjugateGradients, FactorInF32, Measured, Patience, Preconditioner};
use crate::dynamics::products::Products;
use crate::dynamics::solve::Solve;
use crate::dynamics::system::System;
use rockproof_model::Motion;
use rockproof_model::simulation::Solver;
use std::cell::Cell;

/// Calls with the system of bricks of which some slide, and with its factor in f32.
fn with_factor(check: impl Fn(&System<'_, f64>, &FactorInF32<'_>)) {
    with_system_of([6, 7, 8], Motion::Deformable, (Solver::Factor, 0.01), |system, _| {
        let pattern = &system.layout.pattern;
        let all = vec![true; pattern.panel_count()];
        let bearing = system.bearing(&all);
        let fill = |panel: usize, own: &mut [f32]| {
            let mut whole = vec![0.0; own.len()];
            system.fill(panel, &bearing, &mut whole);
            own.iter_mut().zip(whole).for_each(|(own, whole)| *own = whole as f32);
        };
        let mut values = vec![0.0; pattern.values()];
        f32::factorize(pattern, &mut values, &all, &fill).expect("a factor");
        check(system, &FactorInF32 { pattern, values: &values });
    });
}

/// A factor that counts how often residuals are measured and directions asked for.
struct Counting<'c> {
    factor: &'c FactorInF32<'c>,
    measures: Cell<u32>,
    directions: &'c Cell<u32>,
}

impl Preconditioner<f64> for Counting<'_> {
    fn measure(&self, residual: &[f64]) -> Option<Measured<'_, f64>> {
        self.measures.set(self.measures.get() + 1);
        let Measured { square, direction } = self.factor.measure(residual)?;
        let counted = Box::new(|| {
            self.directions.set(self.directions.get() + 1);
            direction()
        });
        Some(Measured { square, direction: counted })
    }
}

/// The solution, and how often residuals were measured and directions asked for.
fn solved(
    (system, factor): (&System<'_, f64>, &FactorInF32<'_>),
    before: Option<&[f64]>,
    patience: Patience,
) -> (Option<Vec<f64>>, [u32; 2]) {
    let (products, directions) = (Products::new(system), Cell::new(0));
    let counting = Counting { factor, measures: Cell::new(0), directions: &directions };
    let gradients = ConjugateGradients { products: &products, preconditioner: &counting };
    let found = gradients.solve(&system.force(), before, patience);
    (found, [counting.measures.get(), directions.get()])
}

/// All numbers of a solution times a factor.
fn times(solution: &[f64], factor: f64) -> Vec<f64> {
    solution.iter().map(|x| x * factor).collect()
}

#[test]
fn a_measure_is_that_of_the_whole_inverse() {
    with_factor(|system, factor| {
        let force = system.force();
        let measured = factor.measure(&force).expect("finite");
        let square = measured.square;
        let mut single: Vec<f32> = force.iter().map(|&x| x as f32).collect();
        f32::substitute(factor.pattern, factor.values, &mut single).expect("a solution");
        let whole: Vec<f64> = single.into_iter().map(f64::from).collect();
        assert_eq!((measured.direction)(), whole);
        let expected: f64 = force.iter().zip(&whole).map(|(f, x)| f * x).sum();
        assert!((square / expected - 1.0).abs() < 1e-4, "{square} for {expected}");
    });
}

/// The last residual is only measured, which takes half of a substitution.
#[test]
fn a_product_needs_one_direction_and_the_last_residual_none() {
    with_factor(|system, factor| {
        let (found, [measures, directions]) = solved((system, factor), None, Patience::NEW_FACTOR);
        assert!(found.is_some() && directions > 1, "{directions}");
        assert_eq!(measures, directions + 1);
    });
}

/// Eight products by a factor of before take a measure down by some ten decades: from far off they are not begun.
#[test]
fn a_factor_of_before_is_not_tried_from_far_off() {
    with_factor(|system, factor| {
        let expected = direct(system);
        let largest = expected.iter().fold(0.0f64, |most, x| most.max(x.abs()));
        for (off, is_tried) in [(1e-3, false), (1e-7, false), (1e-9, true)] {
            let before = times(&expected, 1.0 + off);
            let (found, [measures, directions]) = solved((system, factor), Some(&before), Patience::old_factor(5));
            assert_eq!((found.is_some(), directions > 0), (is_tried, is_tried), "{off}");
            // The right side and the first residual.
            assert!(is_tried || measures == 2, "{off}: {measures}");
            for (x, y) in found.iter().flatten().zip(&expected) {
                assert!((x - y).abs() < 1e-11 * largest, "{off}");
            }
            // Where few springs have changed it is.
            let (found, _) = solved((system, factor), Some(&before), Patience::old_factor(4));
            for (x, y) in found.expect("a solution").iter().zip(&expected) {
                assert!((x - y).abs() < 1e-11 * largest, "{off}");
            }
        }
        // But not from farther off than the right side, whose roundoffs would stay.
        let (found, _) = solved((system, factor), Some(&times(&expected, 1e9)), Patience::old_factor(4));
        assert!(found.is_none());
    });
}

/// What begins far off would leave the roundoffs of its size in the residual.
#[test]
fn a_new_factor_begins_with_the_solution_before_where_it_is_nearer_than_zero() {
    with_factor(|system, factor| {
        let expected = direct(system);
        let (from_zero, [_, most]) = solved((system, factor), None, Patience::NEW_FACTOR);
        let (near, [_, fewer]) = solved((system, factor), Some(&times(&expected, 1.0 + 1e-6)), Patience::NEW_FACTOR);
        assert!(fewer < most, "{fewer} and {most}");
        let largest = expected.iter().fold(0.0f64, |most, x| most.max(x.abs()));
        for (x, y) in near.expect("a solution").iter().zip(&expected) {
            assert!((x - y).abs() < 1e-11 * largest);
        }
        for far in [2.5, -1.0, 1e9, f64::NAN] {
            let (found, _) = solved((system, factor), Some(&times(&expected, far)), Patience::NEW_FACTOR);
            assert!(found.is_some() && found == from_zero, "{far}");
        }
    });
}
