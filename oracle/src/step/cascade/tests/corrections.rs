//! Corrections of a solution in long balls: what they do to its residual.

use super::*;
use crate::field::WideBall;
use crate::solve::Residual;
use crate::step::system::Corrected;
use num_bigint::BigInt;
use rockproof_model::number::dyadic;

/// A cube that slides on another on the floor, one of them deformable: a slip has a spring across it in the second solve.
fn with_sliding(look: impl FnOnce(&Attempt<'_>, Cascade<'_>)) {
    let cube = |low: i64, top: i32| cuboid([Number::ZERO, Number::ZERO, number(low, 1000)], [1, 1, top]);
    let blocks = [cuboid([-5, -5, -1].map(Number::from_integer), [20, 20, 0]), cube(-1, 1), cube(999, 2)];
    let rate = |x, y| Vec3::new(number(x, 3), number(y, 7), number(-1, 7));
    let motions = [Motion::Fixed, Motion::Deformable, Motion::Rigid];
    let bodies: Vec<Body> = motions.into_iter().zip([rate(0, 0), rate(1, 2), rate(-2, 1)]).map(body).collect();
    // Anchors apart: a stretch to begin with, whose force is none of the stiffness.
    let point = |x| Vec3::new(number(x, 1000), number(x + 1, 700), Number::ZERO);
    let memory = |started: &StartingContact| {
        let StartingContact { blocks, contact, .. } = *started;
        Some(ContactMemory { blocks, contact, mode: Mode::Locked, anchors: [point(301), point(300)] })
    };
    with_memory(|joint| joint.friction = number(1, 10), &blocks, &bodies, memory, look);
}

/// The residual of the last solve, after a change of its solution by so many times 2 to an exponent: by itself, and from that before the change.
fn residuals(values: &AttemptValues<'_, WideBall>, modes: &[Mode], exponent: i64) -> [Vec<WideBall>; 2] {
    let solve = values.solves.last().expect("a solve");
    let system = System::of(values, modes, |k| values.slip_force(solve, k), None).expect("a system");
    let corrected = Corrected::new(&system);
    let x: Vec<WideBall> = solve.solution().map(WideBall::without_radius).collect();
    let change = |k: usize| WideBall::exactly(BigInt::from(3 * k as i64 - 17), exponent, values.bits);
    let to: Vec<WideBall> = x.iter().enumerate().map(|(k, x)| x.plus(&change(k)).without_radius()).collect();
    let residual = corrected.residual(&x);
    assert!(corrected.after_change(&residual, [&x, &x]).is_none(), "of no change");
    let close = corrected.after_change(&residual, [&x, &to]).expect("numbers of f64");
    [corrected.residual(&to), close]
}

#[test]
fn a_residual_after_a_change_is_the_one_before_less_the_stiffness_times_it() {
    with_sliding(|attempt, mut cascade| {
        let first = attempt.first_modes();
        let sliding: Vec<Mode> = first.iter().map(|_| Mode::Sliding).collect();
        let locked = first.len() / 3;
        let mixed: Vec<Mode> =
            (0..first.len()).map(|k| if k < locked { Mode::Locked } else { Mode::Sliding }).collect();
        assert!(attempt.started.iter().all(|started| started.anchors.is_some()));
        cascade.solve(sliding);
        cascade.solve(mixed.clone());
        for bits in [128, 256] {
            let values = cascade.with_bits(bits).expect("solves");
            let solve = values.solves.last().expect("a solve");
            let springs = (0..first.len()).filter_map(|k| values.slip_force(solve, k)??.spring.certain_sign());
            assert!(springs.filter(|sign| sign.is_positive()).count() > 2, "no springs across slips");
            for exponent in [-20, -60, 28 - i64::from(bits)] {
                let [whole, close] = residuals(&values, &mixed, exponent);
                let changes =
                    close.iter().filter(|value| !value.certain_sign().is_some_and(|sign| sign.is_zero())).count();
                assert!(changes > 12, "{changes} changes");
                for (whole, close) in whole.iter().zip(&close) {
                    let radii = [whole, close].map(|ball| ball.radius().expect("a radius").to_rational());
                    let apart = (whole.middle() - close.middle()).abs();
                    assert!(apart <= &radii[0] + &radii[1], "{bits} 2^{exponent}: {whole:?} {close:?}");
                    // Forces of 10⁹ N/m times the change, in some 100 bits.
                    let doubt = dyadic(1.into(), exponent + 40 - 95);
                    assert!(
                        radii[1] <= &radii[0] * BigInt::from(2) + doubt,
                        "{bits} 2^{exponent}: {whole:?} {close:?}"
                    );
                }
            }
        }
    });
}
