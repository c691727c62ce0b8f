use super::*;

/// The same numbers on every machine, from −1 to 1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let bits = self.0 >> 33;
        bits as f64 / f64::from(1u32 << 30) - 1.0
    }

    /// A range of any size about any middle, and an f32 in it.
    fn range(&mut self) -> (MotionInterval, f32) {
        let scale = |random: &mut Random| 2f64.powi((random.next() * 20.0) as i32);
        let middle = if self.next() < -0.8 { 0.0 } else { f64::from((self.next() * scale(self)) as f32) };
        let radius = if self.next() < -0.5 { 0.0 } else { self.next().abs() * scale(self) };
        let end = match (self.next() * 4.0) as i32 {
            -3 | 3 => 1.0,
            -2 | 2 => -1.0,
            _ => self.next(),
        };
        let member = (middle + end * radius) as f32;
        let inside = (f64::from(member) - middle).abs() <= radius;
        (MotionInterval::within(middle, radius), if inside { member } else { middle as f32 })
    }
}

fn holds(range: MotionInterval, value: f64) -> bool {
    !range.radius.is_finite() || (value - range.middle).abs() <= range.radius
}

#[test]
fn every_operation_holds_what_floats_come_to() {
    let mut random = Random(3);
    let mut known = 0;
    for _ in 0..300_000 {
        let ((one, x), (two, y)) = (random.range(), random.range());
        let (wide_x, wide_y) = (f64::from(x), f64::from(y));
        let results = [
            ("+", one + two, x + y, wide_x + wide_y),
            ("-", one - two, x - y, wide_x - wide_y),
            ("*", one * two, x * y, wide_x * wide_y),
            ("/", one / two, x / y, wide_x / wide_y),
            ("neg", -one, -x, -wide_x),
            ("abs", one.abs(), x.abs(), wide_x.abs()),
            ("smaller", one.smaller(two), x.min(y), wide_x.min(wide_y)),
            ("larger", one.larger(two), x.max(y), wide_x.max(wide_y)),
            ("root", (one * one).sqrt(), (x * x).sqrt(), (wide_x * wide_x).sqrt()),
            ("root of two", (one * one + two * two).sqrt(), (x * x + y * y).sqrt(), wide_x.hypot(wide_y)),
        ];
        for (name, range, single, double) in results {
            let ends = [f64::from(single), double];
            assert!(
                ends.iter().all(|&value| !value.is_finite() || holds(range, value)),
                "{one:?} {name} {two:?} is {range:?}, not {ends:?} of {x} and {y}"
            );
            known += usize::from(range.radius < 1e-3);
        }
    }
    assert!(known > 300_000, "{known} are narrow");
}

#[test]
fn what_is_certain_is_so_of_every_member_and_what_is_not_possible_of_none() {
    let mut random = Random(4);
    let mut certain = 0;
    for _ in 0..300_000 {
        let ((one, x), (two, y)) = (random.range(), random.range());
        let answers = [
            (one < two, certainly(|| one < two), x < y),
            (one <= two, certainly(|| one <= two), x <= y),
            (one > two, certainly(|| one > two), x > y),
            (one >= two, certainly(|| one >= two), x >= y),
        ];
        for (possible, sure, is) in answers {
            assert!(possible || !is, "{one:?} {two:?}: {x} {y} is not impossible");
            assert!(!sure || is, "{one:?} {two:?}: {x} {y} is not certain");
            assert!(possible || !sure);
            certain += usize::from(sure);
        }
        let (less, open) = is_open(|| one.below(two));
        assert!(open || less == (x < y), "{one:?} {two:?}: {x} {y}");
    }
    assert!(certain > 100_000, "{certain}");
}

#[test]
fn nothing_is_known_beyond_the_range_of_f32_and_of_quotients_by_zero() {
    let zero = MotionInterval::within(0.0, 1.0);
    for unknown in [
        MotionInterval::within(1e10, 0.0),
        MotionInterval::within(0.0, f64::NAN),
        MotionInterval::exact(1.0) / zero,
        zero / MotionInterval::ZERO,
        MotionInterval::exact(1.0) / MotionInterval::exact(1e-20),
    ] {
        for of_it in [
            unknown,
            unknown + zero,
            unknown * MotionInterval::ZERO,
            unknown / MotionInterval::exact(2.0),
            unknown.sqrt(),
            unknown.abs(),
            unknown.smaller(zero),
            unknown.larger(zero),
        ] {
            assert!(of_it < MotionInterval::ZERO && of_it > MotionInterval::ZERO, "{of_it:?}");
            assert!(!certainly(|| of_it < MotionInterval::ZERO || of_it >= MotionInterval::ZERO), "{of_it:?}");
            assert!(is_open(|| of_it.below(MotionInterval::ZERO)).1 && is_open(|| of_it.is_finite()).1, "{of_it:?}");
        }
    }
}

#[test]
fn what_is_asked_and_what_is_open_end_with_the_work() {
    let (one, two) = (MotionInterval::within(0.0, 2.0), MotionInterval::within(1.0, 2.0));
    let all = || (one < two, certainly(|| (one < two, the_other_way(|| one < two), possibly(|| one < two))), one < two);
    assert_eq!(all(), (true, (false, true, true), true));
    let ((), outer) = is_open(|| {
        assert!(is_open(leave_open).1);
        assert!(!is_open(|| ()).1);
    });
    assert!(!outer, "what was open within is settled within");
}
