//! Parts of values: that they are as near to the exact ones as their bounds say, and that the bounds made of them decide more.

use super::in_integers::value_of;
use super::{Dice, INPUTS, Seen, block, tolerances};
use crate::pair::Pair;
use crate::predicate::{
    CornerHeight, EdgeSize, InwardAcross, LargerGap, PlaneSize, Polynomial, WedgeDipAngle, WedgeDipDepth, WedgeSize,
};
use crate::prepared_block::PreparedBlock;
use crate::sign_cascade::{Parts, SignCascade};
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive};
use rockproof_model::decision::Side;
use rockproof_model::{EdgeId, Entrance, FaceId, VertexId};
use std::collections::BTreeMap;

fn slots<P: Polynomial>() -> impl Iterator<Item = usize> {
    P::FIRST_SLOT..P::FIRST_SLOT + P::VARIANTS
}

/// Polynomials of all that have parts are decided by these more often than by bounds known beforehand, and no others are.
pub(super) fn check_use(seen: &BTreeMap<usize, Seen>) {
    let with_parts: Vec<usize> =
        slots::<LargerGap>().chain(slots::<WedgeDipAngle>()).chain(slots::<WedgeDipDepth>()).collect();
    let (mut by_parts, mut by_bound) = (0, 0);
    for (slot, seen) in seen {
        assert_eq!(seen.by_parts > 0, with_parts.contains(slot), "slot {slot}: {}", seen.by_parts);
        if with_parts.contains(slot) {
            by_parts += seen.by_parts;
            by_bound += seen.by_unit_bound;
        }
    }
    assert!(by_parts * 10 > by_bound * 11, "{by_parts} by parts, {by_bound} by bounds known beforehand");
}

/// Holds that a value in f64 is as near to the exact one as the sizes of its parts say.
pub(super) fn check_error<P: Polynomial>(run: &SignCascade<'_, '_>, p: &P, exact: &BigRational, about: &str) {
    let value = p.value(&run.float_view()).0;
    let error = p.error_by_parts(&Parts::new(run)).and_then(BigRational::from_float);
    if let (Some(error), Some(value)) = (error, BigRational::from_float(value)) {
        let (off, slot) = ((value - exact).abs(), P::FIRST_SLOT + p.variant());
        assert!(off <= error, "slot {slot} is off by {off} beyond {error}, {about}");
    }
}

/// How much of its bound the error of a part takes, at most.
fn check_part<P: Polynomial>(run: &SignCascade<'_, '_>, part: &P, about: &str) -> f64 {
    let rational = |x: f64| BigRational::from_float(x);
    let bound = Parts::new(run).of(part);
    let (Some(error), Some(magnitude), Some(value)) =
        (rational(bound.error), rational(bound.magnitude), rational(part.value(&run.float_view()).0))
    else {
        return 0.0;
    };
    let (units, metres) = run.pair.grid().lattice.units_per_metre();
    let metres_a_unit = BigRational::new(metres, units);
    let exact =
        BigRational::from_integer(value_of(run.pair, run.tolerances, part)) * metres_a_unit.pow(P::DEGREE as i32);
    let off = (&value - &exact).abs();
    let slot = P::FIRST_SLOT + part.variant();
    assert!(off <= error, "slot {slot} is off by {off} beyond {bound:?}, {about}");
    assert!(value.abs() <= magnitude && exact.abs() <= magnitude, "slot {slot} is beyond {bound:?}, {about}");
    (off / error).to_f64().unwrap_or(0.0)
}

#[test]
fn parts_are_as_near_as_their_bounds_say() {
    let mut dice = Dice(41);
    let mut most = [0f64; 4];
    for round in 0..300 {
        let input = INPUTS[round % (INPUTS.len() - 1)];
        let (Some(a), Some(b)) = (block(&mut dice, input, 0), block(&mut dice, input, 1)) else { continue };
        let t = tolerances(&mut dice, 1.0);
        let (a, b) = (PreparedBlock::new(&a), PreparedBlock::new(&b));
        let pair = Pair::new(&a, &b);
        let run = SignCascade::new(&pair, &t);
        let about = format!("round {round}, {input:?}");
        let any = |dice: &mut Dice, n: usize| dice.below(n as u64) as u32;
        let [edge_a, edge_b] = [&a, &b].map(|one| EdgeId(any(&mut dice, one.edges.len())));
        let [face_a, face_b] = [&a, &b].map(|one| FaceId(any(&mut dice, one.faces.len())));
        let vertex = VertexId(0);
        for entrance in [
            Entrance::VertexFace(vertex, face_b),
            Entrance::FaceVertex(face_a, vertex),
            Entrance::EdgeEdge(edge_a, edge_b),
        ] {
            most[0] = most[0].max(check_part(&run, &PlaneSize { entrance }, &about));
        }
        for edge in [(Side::A, edge_a), (Side::B, edge_b)] {
            let inward = InwardAcross { edge_a, edge_b, side: edge.0, right: dice.below(2) == 0 };
            let corner = VertexId(any(&mut dice, pair.topology(edge.0).vertex_count()));
            most[1] = most[1].max(check_part(&run, &WedgeSize(inward), &about));
            most[2] = most[2].max(check_part(&run, &EdgeSize { edge }, &about));
            most[3] = most[3].max(check_part(&run, &CornerHeight { edge, corner }, &about));
        }
    }
    // A bound that nothing comes near would not show that too small a one is noticed.
    assert!(most.into_iter().all(|share| share > 1e-5), "{most:?}");
}
