//! The stiffness of a solve in f64, near which its solution is sought. Nothing is proved of it.

use super::StepNumber;
use crate::field::Field;
use crate::step::approximate::{Layout, Square, Stiffness};
use crate::step::attempt_values::{AttemptValues, JointIn};
use crate::step::frame;
use crate::step::friction::SlipForce;
use crate::step::state::Mode;

/// How well a spring across a slip must be known, as a share of the normal stiffness and of its own direction: a factor of a stiffness
/// that is wrong by more corrects too slowly.
const SPRING_ACCURACY: f64 = 1.0 / 1_048_576.0;

/// The spring across a slip in f64: the stiffness and the vector on which it acts; `None` where the type knows too little of it.
fn float_spring<S: Field>(slip: &SlipForce<S>, normal: f64) -> Option<(f64, [f64; 3])> {
    if slip.spring.is_zero() {
        return Some((0.0, [0.0; 3]));
    }
    let (spring, b) = (slip.spring.nearby(), slip.across.components().map(Field::nearby));
    let square: f64 = b.iter().map(|(middle, _)| middle * middle).sum();
    let turned = b.iter().map(|(_, radius)| radius).fold(0.0, |most: f64, radius| most.max(*radius));
    let known = spring.1 * square <= SPRING_ACCURACY * normal && turned <= SPRING_ACCURACY * square.sqrt();
    known.then_some((spring.0, b.map(|(middle, _)| middle)))
}

/// The f64 stiffness of contacts in these modes, in the next solve of an attempt; `None` where it knows too little of the springs across
/// the slips.
pub(crate) fn stiffness<'l, S: StepNumber>(
    values: &AttemptValues<'_, S>,
    modes: &[Mode],
    layout: &'l Layout,
) -> Option<Stiffness<'l>> {
    let friction = values.friction(modes)?;
    let near = |value: &S| value.nearby().0;
    // First what this type may know too little of.
    let spring = |(slip, joint): (&Option<SlipForce<S>>, &JointIn<S>)| match slip {
        Some(slip) => float_spring(slip, near(&joint.normal)),
        None => Some((0.0, [0.0; 3])),
    };
    let springs = friction.iter().zip(&values.joints).map(spring).collect::<Option<Vec<_>>>()?;
    let diagonal = values.attempt.moving().map(|(block, _)| {
        let mut square: Square = [[0.0; 12]; 12];
        for (line, row) in square.iter_mut().zip(&values.base(block)?.matrix) {
            for (place, entry) in line.iter_mut().zip(row) {
                *place = near(entry);
            }
        }
        Some(square)
    });
    let mut stiffness = Stiffness::new(layout, diagonal.collect::<Option<_>>()?);
    for (k, &mode) in modes.iter().enumerate().filter(|(_, mode)| **mode != Mode::Open) {
        let (contact, joint) = (values.contact(k)?, &values.joints[k]);
        let rows = values.attempt.started[k].blocks.map(|block| values.attempt.rows[block]);
        let n = contact.normal.map(near);
        let n = [n.x, n.y, n.z].map(|c| c / near(&contact.square).sqrt());
        let (normal, shear) = (near(&joint.normal), if mode == Mode::Locked { near(&joint.shear) } else { 0.0 });
        // The force of a displacement of A against B: shear across n, what is more along it, and the spring across the slip.
        let (spring, b) = springs[k];
        let bent: [[f64; 3]; 3] = std::array::from_fn(|r| {
            std::array::from_fn(|c| {
                (normal - shear) * n[r] * n[c] + if r == c { shear } else { 0.0 } + spring * b[r] * b[c]
            })
        });
        let lines = [0, 1].map(|side: usize| frame::float_rows(&contact.points[side].map(near)));
        for one in 0..2 {
            let Some(row) = rows[one] else { continue };
            let forced: [[f64; 12]; 3] = std::array::from_fn(|r| {
                std::array::from_fn(|c| (0..3).fold(0.0, |sum, axis| sum + bent[r][axis] * lines[one][axis][c]))
            });
            add(&mut stiffness.diagonal[row], &lines[one], &forced, 1.0);
            let Some(other) = rows[1 - one] else { continue };
            // The later block's rows and this one's columns.
            if other > row
                && let Some(square) = stiffness.coupling(row, other)
            {
                add(square, &lines[1 - one], &forced, -1.0);
            }
        }
    }
    Some(stiffness)
}

/// Adds `sign · rowsᵀ·columns`.
fn add(square: &mut Square, rows: &[[f64; 12]; 3], columns: &[[f64; 12]; 3], sign: f64) {
    for axis in 0..3 {
        for (line, &factor) in square.iter_mut().zip(&rows[axis]) {
            if factor != 0.0 {
                for (place, &value) in line.iter_mut().zip(&columns[axis]) {
                    *place += sign * factor * value;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::Ball;
    use rockproof_model::Vec3;

    /// |b|² = 25·2⁻²⁰.
    const ACROSS: [f64; 3] = [3.0 / 1024.0, 4.0 / 1024.0, 0.0];

    /// A spring of k/|b|² for k = 10⁹ N/m, both with a radius that is so large a share of them.
    fn spring(of_spring: f64, of_across: f64) -> SlipForce<Ball> {
        let size = 1e9 / (25.0 * 2f64.powi(-20));
        let across = ACROSS.map(|middle| Ball { middle, radius: of_across * 5.0 / 1024.0 });
        let [x, y, z] = across;
        SlipForce {
            last: Vec3::zero(),
            secant: Ball { middle: 1.0, radius: 0.0 },
            across: Vec3::new(x, y, z),
            spring: Ball { middle: size, radius: of_spring * size },
        }
    }

    #[test]
    fn a_spring_across_a_slip_is_used_where_it_is_known_to_a_millionth() {
        let (well, badly) = (2f64.powi(-21), 2f64.powi(-19));
        for (of_spring, of_across, known) in [
            (0.0, 0.0, true),
            (well, 0.0, true),
            (badly, 0.0, false),
            (0.0, well, true),
            (0.0, badly, false),
            (well, well, true),
            (badly, badly, false),
        ] {
            let slip = spring(of_spring, of_across);
            let expected = known.then_some((slip.spring.middle, ACROSS));
            assert_eq!(float_spring(&slip, 1e9), expected, "{of_spring} {of_across}");
        }
        let none = SlipForce { spring: Ball { middle: 0.0, radius: 0.0 }, ..spring(0.0, badly) };
        assert_eq!(float_spring(&none, 1e9), Some((0.0, [0.0; 3])));
    }
}
