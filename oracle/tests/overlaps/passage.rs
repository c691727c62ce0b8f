//! Passages within a step: worked by hand, ties included, and random motions beside depths at many times.

use crate::support::random_numbers::Random;
use crate::support::shapes::{block, cuboid, exact, notched_cube, number, point, slab, spike, step, tetrahedron};
use num_bigint::BigInt;
use num_rational::BigRational;
use rockproof_model::{Block, Number, Vec3};
use rockproof_oracle::passage::{PassageAnswer, PassageReport, StraightMotion, passage, swept_neighbours};
use rockproof_oracle::penetration::penetration;

/// A moves by a translation, B stays.
fn moved(a: &Block, by: [&str; 3], b: &Block, g: &str) -> PassageReport {
    let after = a.translated(&point(by));
    let found = passage(&StraightMotion::new(a, &after), &StraightMotion::new(b, b), &number(g));
    // The other way round, and with both moving besides, it is the same.
    let wind = point(["7/3", "-5", "1/9"]);
    let (carried, carrying) = (after.translated(&wind), b.translated(&wind));
    for other in [
        passage(&StraightMotion::new(b, b), &StraightMotion::new(a, &after), &number(g)),
        passage(&StraightMotion::new(a, &carried), &StraightMotion::new(b, &carrying), &number(g)),
    ] {
        assert_eq!(kind(&other.answer), kind(&found.answer));
    }
    found
}

fn kind(answer: &PassageAnswer) -> &'static str {
    match answer {
        PassageAnswer::NoPassage => "none",
        PassageAnswer::Passage { .. } => "passage",
        PassageAnswer::Undecided => "undecided",
        PassageAnswer::DeepAtEnd => "deep at end",
    }
}

#[test]
fn a_blade_goes_through_a_plate() {
    let plate = cuboid(["-4", "-4", "0"], ["4", "4", "1/10"]);
    let blade = cuboid(["-1/100", "-1", "1/5"], ["1/100", "1", "6/5"]);
    let found = moved(&blade, ["0", "0", "-3/2"], &plate, "1/50");
    // Half way the blade is from −11/20 to 9/20, the plate from 0 to 1/10: out by 13/20 upwards, by 9/20 downwards.
    let PassageAnswer::Passage { time, depth } = found.answer else { panic!("{found:?}") };
    assert_eq!((time, depth.gap.squared), (exact("1/2"), exact("81/400")));
    // Stopped above the plate, or beside it all the way, it does not.
    assert_eq!(moved(&blade, ["0", "0", "-1/10"], &plate, "0").answer, PassageAnswer::NoPassage);
    let beside = blade.translated(&point(["401/100", "0", "0"]));
    assert_eq!(moved(&beside, ["0", "0", "-3/2"], &plate, "0").answer, PassageAnswer::NoPassage);
    // Stopped in the plate, it is deep at the end: the audit's business.
    assert_eq!(moved(&blade, ["0", "0", "-1/2"], &plate, "1/50").answer, PassageAnswer::DeepAtEnd);
}

#[test]
fn what_is_never_deeper_than_g_is_no_passage() {
    // A pebble goes through a foil; together they are 2/100 thick, so that the least translation is 1/100 at most.
    let foil = cuboid(["-4", "-4", "0"], ["4", "4", "1/100"]);
    let pebble = cuboid(["0", "0", "1/10"], ["1/100", "1/100", "11/100"]);
    assert_eq!(moved(&pebble, ["0", "0", "-1/5"], &foil, "1/50").answer, PassageAnswer::NoPassage);
    // With a smaller g it is one.
    assert_eq!(kind(&moved(&pebble, ["0", "0", "-1/5"], &foil, "9/1000").answer), "passage");
}

#[test]
fn a_resting_block_is_certified_at_once() {
    let on_slab = cuboid(["-1", "-1", "0"], ["1", "1", "2"]).translated(&point(["0", "0", "-1/1000000"]));
    for by in [["0", "0", "0"], ["0", "0", "1/10000000"], ["1/3", "1/7", "0"], ["0", "0", "-1/100"]] {
        let found = moved(&on_slab, by, &slab(), "1/50");
        assert_eq!(found, PassageReport { answer: PassageAnswer::NoPassage, intervals: 1 });
    }
    // Exactly g at the end; a little more.
    let left = "-19999/1000000";
    assert_eq!(moved(&on_slab, ["0", "0", left], &slab(), "1/50").answer, PassageAnswer::NoPassage);
    assert_eq!(moved(&on_slab, ["0", "0", "-2/100"], &slab(), "1/50").answer, PassageAnswer::DeepAtEnd);
}

/// A cube whose lower left edge goes past the upper right edge of [`slab`]-like block [−4, 0]² from (−1 − d, 1 − d) by
/// (2, −2) times `factor`: between (−a, a) − (d, d) and (a, −a) − (d, d), so that at the middle it is d deep.
fn corner_past_corner(d: &str, factor: &str, g: &str) -> PassageReport {
    let corner = cuboid(["-4", "-2", "-4"], ["0", "2", "0"]);
    let d = exact(d);
    let at = |c: &str| Number::from_rational(exact(c) - &d);
    let start = Vec3::new(at("-1"), number("0"), at("1"));
    let way = exact(factor) * exact("2");
    let by = [way.to_string(), "0".into(), (-way).to_string()];
    let cube = cuboid(["0", "-1", "0"], ["1", "1", "1"]).translated(&start);
    moved(&cube, [&by[0], &by[1], &by[2]], &corner, g)
}

#[test]
fn corners_past_corners_miss_touch_or_hit() {
    assert_eq!(corner_past_corner("-1/1000000", "1", "0").answer, PassageAnswer::NoPassage);
    // Touching in one instant, t = 1/2, is no overlap, and as deep as g is not deeper.
    assert_eq!(corner_past_corner("0", "1", "0").answer, PassageAnswer::NoPassage);
    assert_eq!(corner_past_corner("1/50", "1", "1/50").answer, PassageAnswer::NoPassage);
    let hit = corner_past_corner("20001/1000000", "1", "1/50");
    let PassageAnswer::Passage { time, depth } = hit.answer else { panic!("{hit:?}") };
    assert_eq!((time, depth.gap.squared), (exact("1/2"), exact("20001/1000000") * exact("20001/1000000")));
    // With the instant at t = 1/3, halving never gets to it: a little less than g is certified, a little more found, and
    // g itself stays undecided, as on every interval around 1/3 one direction would have to do for both flanks.
    assert_eq!(corner_past_corner("19999/1000000", "3/2", "1/50").answer, PassageAnswer::NoPassage);
    assert_eq!(kind(&corner_past_corner("20001/1000000", "3/2", "1/50").answer), "passage");
    assert_eq!(corner_past_corner("1/50", "3/2", "1/50").answer, PassageAnswer::Undecided);
}

#[test]
fn blocks_move_in_notches_and_through_walls() {
    // In the notch of a step: along its floor, touching or overlapping by a little; into the corner of floor and wall.
    let cube = cuboid(["2", "-1", "2"], ["3", "1", "3"]);
    let little = |x: &str, z: &str| cube.translated(&point([x, "0", z]));
    for (start, by) in [
        (little("1/2", "0"), ["1/2", "0", "0"]),
        (little("0", "0"), ["1", "1", "0"]),
        (little("1/2", "-1/1000000"), ["1/2", "0", "0"]),
        (little("-1/1000000", "-1/1000000"), ["0", "1", "0"]),
        (little("1", "1"), ["-1", "0", "-1"]),
    ] {
        assert_eq!(moved(&start, by, &step(), "1/50").answer, PassageAnswer::NoPassage, "{by:?}");
    }
    // Through the arm beside the notch and out behind, with both ends free.
    let found = moved(&little("1/10", "1/10"), ["-16/5", "0", "0"], &step(), "1/50");
    assert_eq!(kind(&found.answer), "passage");
    // Two steps back to back, one moving along the other's back.
    let back = step().with_vertices(
        step().vertices().iter().map(|v| Vec3::new(v.x.negated(), v.y.negated(), v.z.clone())).collect(),
    );
    assert_eq!(moved(&back, ["0", "3", "0"], &step(), "0").answer, PassageAnswer::NoPassage);
    assert_eq!(
        kind(&moved(&back.translated(&point(["-1", "0", "0"])), ["10", "0", "0"], &step(), "1/50").answer),
        "passage"
    );
}

/// A seesaw whose top, z = h·x, goes through the origin, as h goes from 1/2 to −1/2.
fn seesaw() -> [Block; 2] {
    [["-1/2", "1/2"], ["1/2", "-1/2"]].map(|[left, right]| {
        let bottom = [["-1", "-1", "-4"], ["1", "-1", "-4"], ["1", "1", "-4"], ["-1", "1", "-4"]].map(point);
        let top = [["-1", "-1", left], ["1", "-1", right], ["1", "1", right], ["-1", "1", left]].map(point);
        let faces: [&[u32]; 6] =
            [&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]];
        block([bottom, top].concat(), &faces)
    })
}

#[test]
fn how_long_is_looked_before_a_pair_is_left_undecided() {
    // What stands on the middle of a seesaw touches it at all times, and only the top's normal parts them, which is another
    // at each time: no interval is certified, and each is halved.
    let [before, after] = seesaw();
    let tilting = StraightMotion::new(&before, &after);
    let undecided = |intervals| PassageReport { answer: PassageAnswer::Undecided, intervals };
    let both_ways = |a: &Block| {
        let resting = StraightMotion::new(a, a);
        [passage(&resting, &tilting, &number("0")), passage(&tilting, &resting, &number("0"))]
    };
    // Convex: the first odd number above 2000, as one is followed by two for each that is halved.
    assert_eq!(both_ways(&spike(["0", "0", "0"])), [undecided(2001), undecided(2001)]);
    // A step on its edge, which is not convex: 1 + 2 + 4 + 8 + 16 + 32, the first length with more than 16.
    let turned = |v: &Vec3<Number>| Vec3::new(v.x.plus(&v.z.negated()), v.y.clone(), v.x.plus(&v.z));
    let on_edge = step().with_vertices(step().vertices().iter().map(turned).collect());
    assert_eq!(both_ways(&on_edge), [undecided(63), undecided(63)]);
    // Where the corners touch in the middle of the step, each half has a face's normal; the whole has none.
    let two_halves = PassageReport { answer: PassageAnswer::NoPassage, intervals: 3 };
    assert_eq!(corner_past_corner("0", "1", "0"), two_halves);
    // The same past the upper edge of a step, where one half needs its cover.
    let cube = cuboid(["0", "-1", "0"], ["1", "1", "1"]).translated(&point(["9/7", "0", "5"]));
    assert_eq!(moved(&cube, ["10/7", "0", "-2"], &step(), "0"), two_halves);
}

#[test]
fn parts_that_only_seem_to_touch_may_be_moved_apart_too() {
    let certified = PassageReport { answer: PassageAnswer::NoPassage, intervals: 1 };
    // On the floor of a step, deeper by less than f64 sees.
    let cube = cuboid(["5/2", "-1", "2"], ["3", "1", "3"]);
    for depth in ["0", "1/1000000000000000000000000000000", "1/10000000000000000000", "1/1000000"] {
        let down = number(depth).negated();
        let on_floor = cube.translated(&Vec3::new(Number::ZERO, Number::ZERO, down));
        assert_eq!(moved(&on_floor, ["1/2", "0", "0"], &step(), "1/50"), certified, "{depth}");
    }
    // In the notch of a cube, 3/250 into two of its walls and touching the third: √2·3/250 is less than g.
    for into in ["-1/100", "-3/250"] {
        let in_notch = cuboid(["2", "2", "2"], ["3", "3", "3"]).translated(&point([into, "0", into]));
        assert_eq!(moved(&in_notch, ["0", "0", "0"], &notched_cube(), "1/50"), certified, "{into}");
    }
}

#[test]
fn coordinates_of_many_bits_have_directions_too() {
    // f = 2 + 3⁻¹²⁰: x + y + z is 4 at most in the first and 2·f at least in the second, along a face of both alone.
    let f = number("2").plus(&Number::from_rational(exact("3").pow(-120)));
    let place = |place: [i32; 3]| {
        let [x, y, z] = place.map(|k| if k == 0 { Number::ZERO } else { f.clone() });
        Vec3::new(x, y, z)
    };
    let corner = tetrahedron([["0", "0", "0"], ["4", "0", "0"], ["0", "4", "0"], ["0", "0", "4"]]);
    let other = tetrahedron([["2", "2", "2"], ["2", "0", "2"], ["0", "2", "2"], ["2", "2", "0"]]);
    let other = other.with_vertices([[1, 1, 1], [1, 0, 1], [0, 1, 1], [1, 1, 0]].map(place).to_vec());
    let certified = PassageReport { answer: PassageAnswer::NoPassage, intervals: 1 };
    assert_eq!(moved(&corner, ["0", "0", "0"], &other, "1/1000000"), certified);
}

impl Random {
    /// The block moved by a vector, and by its opposite, from a place at random; each vertex by a little of its
    /// own too.
    fn motion(&mut self, block: &Block) -> [Block; 2] {
        let mut by = |end: u64, d: i64| BigRational::new((self.below(2 * end + 1) - end as i64).into(), d.into());
        let all = Vec3::new(by(5, 2), by(5, 2), by(3, 2));
        let aside = Vec3::new(by(4, 2), by(4, 2), by(4, 2));
        [aside.plus(&all), aside.minus(&all)].map(|all| {
            let vertices = block.vertices().iter().map(|v| {
                let own = Vec3::new(by(4, 32), by(4, 32), by(4, 32));
                let place = |c: &Number, all: &BigRational, own: &BigRational| {
                    Number::from_rational(c.to_rational() + all + own)
                };
                Vec3::new(place(&v.x, &all.x, &own.x), place(&v.y, &all.y, &own.y), place(&v.z, &all.z, &own.z))
            });
            block.with_vertices(vertices.collect())
        })
    }
}

#[test]
fn neighbours_are_those_whose_boxes_meet_over_the_step() {
    let cube = |x: &str| cuboid(["0", "0", "0"], ["1", "1", "1"]).translated(&point([x, "0", "0"]));
    let starts = [cube("0"), cube("3"), cube("-1"), cube("10"), cube("12")];
    let ends = [cube("1"), cube("2"), cube("-1"), cube("10"), cube("11")];
    let motions: Vec<StraightMotion<'_>> = starts.iter().zip(&ends).map(|(a, b)| StraightMotion::new(a, b)).collect();
    // 0 sweeps [0, 2] and 1 [2, 4]; 2 ends where 0 begins; 3 ends where the sweep of 4 begins.
    assert_eq!(swept_neighbours(&motions), [[0, 1], [0, 2], [3, 4]]);
}

#[test]
fn random_motions_agree_with_the_depths_at_many_times() {
    let mut random = Random(3);
    let g = "1/8";
    let limit = exact(g) * exact(g);
    let mut seen = std::collections::BTreeMap::new();
    for k in 0..150 {
        let a = tetrahedron([["0", "0", "0"], ["2", "0", "0"], ["0", "2", "0"], ["0", "0", "2"]]);
        let b = if k % 5 == 0 { step() } else { cuboid(["0", "0", "0"], ["1", "2", "1"]) };
        // The tetrahedron alone turns and bends; the faces of the other have to stay planar.
        let [before, after] = random.motion(&a);
        let end = b.translated(&point(["1/2", "-1/3", "1/4"]));
        let (one, two) = (StraightMotion::new(&before, &after), StraightMotion::new(&b, &end));
        let depth = |time: &BigRational| {
            let found = penetration(&one.block_at(time), &two.block_at(time)).unwrap();
            if found.gap.sign.is_negative() { found.gap.squared } else { BigRational::default() }
        };
        let deep: Vec<bool> = (0..=16).map(|n| depth(&BigRational::new(n.into(), BigInt::from(16))) > limit).collect();
        let found = passage(&one, &two, &number(g));
        *seen.entry(kind(&found.answer)).or_insert(0) += 1;
        match &found.answer {
            PassageAnswer::NoPassage => assert!(!deep.contains(&true), "{k} {deep:?}"),
            PassageAnswer::DeepAtEnd => assert!(deep[0] || deep[16], "{k}"),
            PassageAnswer::Passage { time, depth: said } => {
                assert!(!deep[0] && !deep[16] && said.gap.squared > limit, "{k}");
                assert_eq!(depth(time), said.gap.squared);
            }
            PassageAnswer::Undecided => assert!(!deep[0] && !deep[16], "{k}"),
        }
        let apart = swept_neighbours(&[one, two]).is_empty();
        assert!(!apart || found.answer == PassageAnswer::NoPassage);
    }
    let count = |name: &str| seen.get(name).copied().unwrap_or(0);
    assert!(count("none") > 20 && count("passage") > 10 && count("deep at end") > 3, "{seen:?}");
    assert!(count("undecided") < 4, "{seen:?}");
}
