//! Overlaps that are bounded instead of measured, beside the same pairs measured: blocks that touch, that rounding makes overlap, that
//! overlap deeply, whose faces rounding made uneven, and that are not convex.

use crate::support::shapes::{cuboid, extruded, number, plus_sign, revised, step, tetrahedron};
use num_rational::BigRational;
use rockproof_model::{Block, Number, Precision, Vec3};
use rockproof_oracle::PreparedBlock;
use rockproof_oracle::audit::{Auditor, BoundedOverlap, OverlapSeverity, PairAudit, rounding_depth};

/// Numbers below a limit, always the same ones.
struct Choices(u64);

impl Choices {
    fn below(&mut self, limit: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) % limit as u64) as usize
    }

    /// From 0 to 1 in eighths of a thousand.
    fn share(&mut self) -> f64 {
        self.below(8000) as f64 / 8000.0
    }
}

/// A block whose top is at z = 0.
fn lower(choices: &mut Choices) -> Block {
    let down = |block: Block, by: &str| block.translated(&Vec3::new(Number::ZERO, Number::ZERO, number(by)));
    match choices.below(6) {
        0 => down(plus_sign(), "-1"),
        1 => down(step(), "-4"),
        2 => extruded(&[["-3", "-2"], ["1", "-3"], ["2", "0"], ["-2", "0"]], "-2", "2"),
        _ => cuboid(["-2", "-1", "-3"], ["2", "3", "0"]),
    }
}

/// A block whose bottom is at z = 0.
fn upper(choices: &mut Choices) -> Block {
    match choices.below(6) {
        0 => plus_sign(),
        1 => tetrahedron([["-1", "0", "0"], ["1", "0", "1"], ["0", "1", "1"], ["0", "-1", "1"]]),
        2 => tetrahedron([["-1", "0", "0"], ["1", "0", "0"], ["0", "1", "1"], ["0", "-1", "1"]]),
        3 => extruded(&[["-1", "0"], ["2", "0"], ["1", "2"], ["-2", "1"]], "-1", "1"),
        _ => cuboid(["-1", "-1", "0"], ["1", "2", "1"]),
    }
}

/// Both turned by the same angles and moved as far, rounded to a precision: what touched now touches, misses or overlaps.
fn placed(blocks: [Block; 2], choices: &mut Choices) -> [Block; 2] {
    let angles = match choices.below(3) {
        0 => [0.0; 2],
        _ => [choices.share() * 6.0, choices.share() * 6.0],
    };
    let far = [0.0, 7.0, 1e3, 1e6][choices.below(4)];
    let by = [(); 3].map(|()| far * choices.share());
    let precision = if choices.below(8) == 0 { Precision::F32 } else { Precision::F64 };
    let turn = |angle: f64, p: f64, q: f64| (p * angle.cos() - q * angle.sin(), p * angle.sin() + q * angle.cos());
    blocks.map(|block| {
        let vertices = block.vertices().iter().map(|v| {
            let [x, y, z] = v.components().map(|c| c.approximate());
            let (x, y) = turn(angles[0], x, y);
            let (y, z) = turn(angles[1], y, z);
            Vec3::new(x + by[0], y + by[1], z + by[2]).map(|&c| Number::from_f64(c).unwrap())
        });
        block.with_vertices(vertices.collect()).rounded(precision).unwrap()
    })
}

fn pairs(count: usize) -> Vec<[Block; 2]> {
    let mut choices = Choices(7);
    let pair = |_| {
        let (lower, upper) = (lower(&mut choices), upper(&mut choices));
        let sunk = ["0", "0", "1/1000000000000000", "1/10000000000000", "1/100000000", "1/4"][choices.below(6)];
        let aside = |choices: &mut Choices| {
            let by = [0.0, 0.25, 1.0 / 3.0, 1.0][choices.below(4)];
            Number::from_f64(by).unwrap()
        };
        let by = Vec3::new(aside(&mut choices), aside(&mut choices), number(sunk).negated());
        placed([lower, upper.translated(&by)], &mut choices)
    };
    (0..count).map(pair).collect()
}

#[test]
fn what_is_bounded_is_rounding_and_no_deeper_and_what_is_measured_is_the_same() {
    bound_and_measure(900);
}

#[test]
#[ignore = "ten seconds; .ci/run runs it"]
fn what_is_bounded_is_rounding_and_what_is_measured_is_the_same_at_full_size() {
    bound_and_measure(3000);
}

fn bound_and_measure(count: usize) {
    let [mut apart, mut bounded, mut uneven, mut close, mut rounding, mut concave, mut deep] = [0; 7];
    let set = revised(&[]);
    for blocks in pairs(count) {
        let prepared = blocks.each_ref().map(PreparedBlock::new);
        let auditor = Auditor::new(&prepared, &set);
        let limit = rounding_depth(&blocks.each_ref(), Precision::F64);
        let PairAudit { decider, overlap, bounded: found } = auditor.pair_beyond_rounding([0, 1], &limit);
        let exactly = auditor.pair([0, 1]);
        assert_eq!(decider, exactly.decider);
        assert_eq!(exactly.bounded, None);
        let Some(BoundedOverlap { blocks: numbers, most_m }) = found else {
            assert_eq!(overlap, exactly.overlap);
            let is_convex = blocks.iter().all(Block::is_convex);
            match overlap.map(|overlap| overlap.severity(&limit)) {
                None => apart += 1,
                Some(OverlapSeverity::Rounding) if is_convex => rounding += 1,
                Some(OverlapSeverity::Rounding) => concave += 1,
                Some(_) => deep += 1,
            }
            continue;
        };
        assert!(overlap.is_none() && numbers == [0, 1]);
        let overlap = exactly.overlap.expect("what is bounded overlaps");
        assert_eq!(overlap.severity(&limit), OverlapSeverity::Rounding, "{overlap:?}");
        let most = BigRational::from_float(most_m).unwrap();
        assert!(overlap.depth_squared() <= &most * &most, "{most_m} {overlap:?}");
        bounded += 1;
        uneven += usize::from(most_m > limit.approximate());
        close += usize::from(overlap.penetration.depth_m().unwrap() >= most_m * (1.0 - 1e-12));
    }
    let counts = format!("{apart} {bounded} {uneven} {close} {rounding} {concave} {deep}");
    let sixth = count / 6;
    assert!(
        apart > sixth && bounded > sixth && uneven > count / 150 && concave > count / 60 && deep > sixth,
        "{counts}"
    );
    // Nearly all that is rounding is bounded, and most by its own depth.
    assert!(rounding * 20 < bounded && close * 5 > bounded * 3, "{counts}");
}

/// Deeper than g is lost, whatever rounding makes: nothing is bounded there.
#[test]
fn nothing_deeper_than_penetration_is_bounded() {
    let blocks = [cuboid(["0", "0", "0"], ["1", "1", "1"]), cuboid(["0", "0", "999/1000"], ["1", "1", "2"])];
    let prepared = blocks.each_ref().map(PreparedBlock::new);
    let within = |penetration: &str, rounding: &str| {
        let set = revised(&[("penetration", penetration)]);
        let found = Auditor::new(&prepared, &set).pair_beyond_rounding([0, 1], &number(rounding));
        assert!(found.bounded.is_none() != found.overlap.is_none());
        found.bounded
    };
    let most_m = within("1/500", "1/500").expect("less than both").most_m;
    assert!((1e-3..1e-3 * (1.0 + 1e-12)).contains(&most_m), "{most_m}");
    // As deep as either exactly: only measuring tells.
    assert_eq!(within("1/1000", "1/500"), None);
    assert_eq!(within("1/500", "1/1000"), None);
    assert_eq!(within("1/2000", "1/500"), None);
    assert_eq!(within("1/500", "1/2000"), None);
}
