//! What a certificate is made of, piece by piece: a piece that claims too much would certify a passage away.

use super::directions::{Source, TRIED_DIRECTIONS};
use super::*;
use crate::soundness::Dice;
use rockproof_model::{BlockOptions, Number};

/// An integer from −2^bits to 2^bits.
fn integer(dice: &mut Dice, bits: u32) -> BigInt {
    let digits = BigInt::from(dice.next()) << 64 | BigInt::from(dice.next());
    let span: BigInt = (BigInt::from(1) << (bits + 1)) + 1;
    digits % span - (BigInt::from(1) << bits)
}

fn random_point(dice: &mut Dice, bits: u32) -> LatticePoint {
    Vec3::new(integer(dice, bits), integer(dice, bits), integer(dice, bits))
}

fn four(dice: &mut Dice, bits: u32) -> Vec<LatticePoint> {
    (0..4).map(|_| random_point(dice, bits)).collect()
}

fn whole(x: i64, y: i64, z: i64) -> LatticePoint {
    Vec3::new(x, y, z).map(|&c| BigInt::from(c))
}

fn four_corners() -> ConvexPart {
    ConvexPart::of_points([0, 1, 2, 3].map(VertexId))
}

/// One below, the other above along an axis.
fn ends_along(points: &[LatticePoint], axis: usize) -> [BigInt; 2] {
    let along = || points.iter().map(|p| p.components()[axis].clone());
    [along().min().expect("some point"), along().max().expect("some point")]
}

/// Whether at both ends one part is above the other along one axis by more than a distance.
fn exactly_far(places: &[[Vec<LatticePoint>; 2]; 2], distance: &BigInt) -> bool {
    (0..3).any(|axis| {
        [(0, 1), (1, 0)].into_iter().any(|(above, below)| {
            (0..2).all(|end| {
                let [[low, _], [_, high]] = [above, below].map(|side| ends_along(&places[end][side], axis));
                low - high > *distance
            })
        })
    })
}

#[test]
fn parts_are_far_only_where_they_are_by_more_than_the_limit() {
    let mut dice = Dice(5);
    let part = four_corners();
    let (mut far, mut near) = (0, 0);
    for trial in 0..1_500 {
        let bits = [3, 40, 66][trial % 3];
        let limit = [BigInt::ZERO, BigInt::from(5) << (bits - 2), (BigInt::from(1) << bits) - 1][trial % 4 % 3].clone();
        let axis = dice.below(3) as usize;
        let is_above = dice.below(2) == 0;
        let mut places = [0, 1].map(|_| [four(&mut dice, bits), four(&mut dice, bits)]);
        for place in &mut places {
            // B's nearest point is as far from A as the limit, and a little more or less.
            let little = match dice.below(4) {
                0 => BigInt::ZERO,
                1 => BigInt::from(1),
                2 => BigInt::from(1) << (bits / 2),
                _ => integer(&mut dice, bits),
            };
            let [low_a, high_a] = ends_along(&place[0], axis);
            let [low_b, high_b] = ends_along(&place[1], axis);
            let by = if is_above { high_a - low_b + &limit + little } else { low_a - high_b - &limit - little };
            let mut shift = [BigInt::ZERO, BigInt::ZERO, BigInt::ZERO];
            shift[axis] = by;
            let [x, y, z] = shift;
            let shift = Vec3::new(x, y, z);
            for p in &mut place[1] {
                *p = p.plus(&shift);
            }
        }
        let clearly: BigInt = &limit + (BigInt::from(1) << bits.saturating_sub(36));
        let [is_far, is_clear] = [&limit, &clearly].map(|distance| exactly_far(&places, distance));
        let ends = Ends::new(places);
        let found = PartsAtEnds { parts: [&part, &part], ends: &ends }.are_far(float(&limit));
        assert!(!found || is_far, "{trial}: called far, and is not");
        assert!(found || !is_clear || bits == 66, "{trial}: is far");
        // With three bits a lattice unit is more than all roundings.
        assert!(bits != 3 || found == is_far, "{trial}: {found}");
        far += usize::from(found);
        near += usize::from(!is_far);
    }
    assert!(far > 100 && near > 100, "{far} far, {near} near");
}

#[test]
fn directions_come_with_their_gaps_the_largest_first() {
    let mut dice = Dice(9);
    let part = four_corners();
    for trial in 0..60 {
        let far = whole(if trial % 2 == 0 { 40 } else { 9 }, 5, -7);
        let shifted = |points: Vec<LatticePoint>| points.iter().map(|p| p.plus(&far)).collect();
        let places = [0, 1].map(|_| [four(&mut dice, 3), shifted(four(&mut dice, 3))]);
        let ends = Ends::new(places);
        let both = PartsAtEnds { parts: [&part, &part], ends: &ends };
        let found = both.best_directions([0, 1].map(|side| NearPart::new(both.parts[side], side, &ends)).each_ref());
        assert_eq!(found.len(), TRIED_DIRECTIONS);
        let exact_gap = |n: &LatticePoint| float(&both.gap(n)) / float(&n.norm_squared()).sqrt();
        for candidate in &found {
            let gap = exact_gap(candidate.n());
            assert!((candidate.gap - gap).abs() <= 1e-9, "{trial}: {} for {gap}", candidate.gap);
        }
        assert!(found.windows(2).all(|two| two[0].gap >= two[1].gap), "{trial}");
        let all = both.sources().flat_map(|source| [false, true].map(|is_reversed| Source { is_reversed, ..source }));
        let normals = all.map(|source| source.exactly(&both)).filter(|n| !Zero::is_zero(&n.norm_squared()));
        let largest = normals.map(|n| exact_gap(&n)).fold(f64::NEG_INFINITY, f64::max);
        assert!((found[0].gap - largest).abs() <= 1e-9, "{trial}: {} of {largest}", found[0].gap);
    }
}

#[test]
fn parts_as_far_apart_as_the_limit_are_not_far_however_they_are_rounded() {
    // A's part is at x = h and B's at x = l; both are rounded as seen from A's first vertex, which is between them.
    let (h, l) = (-2_158_642_289_454_014_431, 2_158_642_289_454_014_119);
    let at = |x: i64| (0..4).map(|k| whole(x, k, k * k)).collect::<Vec<_>>();
    let of_a: Vec<LatticePoint> = std::iter::once(whole(0, 0, 0)).chain(at(h)).collect();
    let parts = [ConvexPart::of_points([1, 2, 3, 4].map(VertexId)), four_corners()];
    let ends = Ends::new([0, 1].map(|_| [of_a.clone(), at(l)]));
    let both = PartsAtEnds { parts: [&parts[0], &parts[1]], ends: &ends };
    assert!(!both.are_far(float(&(BigInt::from(l) - h))));
    assert!(both.are_far(float(&((BigInt::from(l) - h) - (1i64 << 20)))));
}

#[test]
fn parts_are_not_far_where_floats_are_infinite() {
    // A is at x ≤ 0, B at x ≥ 2¹¹⁰⁰, and the limit is twice as much.
    let of_a: Vec<LatticePoint> = (0..4).map(|k| whole(-k, k * k, k)).collect();
    let far = Vec3::new(BigInt::from(1) << 1100, BigInt::ZERO, BigInt::ZERO);
    let of_b = || (0..4).map(|k| whole(k, k, k * k).plus(&far)).collect();
    let ends = Ends::new([0, 1].map(|_| [of_a.clone(), of_b()]));
    let part = four_corners();
    let both = PartsAtEnds { parts: [&part, &part], ends: &ends };
    assert!(!both.are_far(float(&(BigInt::from(1) << 1101))));
}

#[test]
fn a_face_that_begins_at_a_reflex_corner_has_the_normal_of_its_whole() {
    // An L whose front begins beside its reflex corner, and a box 1 before the front.
    let l = extruded(&[[4, 2], [2, 2], [2, 4], [0, 4], [0, 0], [4, 0]], [-4, 4]);
    let b = extruded(&[[0, 0], [1, 0], [1, 1], [0, 1]], [-7, -5]);
    let parts = [&l, &b].map(ConvexPart::whole);
    let ends = Ends::new([0, 1].map(|_| [places_of(&l), places_of(&b)]));
    let both = PartsAtEnds { parts: [&parts[0], &parts[1]], ends: &ends };
    for candidate in both.best_directions([0, 1].map(|side| NearPart::new(both.parts[side], side, &ends)).each_ref()) {
        // Not farther than 1 along any direction, and so far along y alone, of which there are more than are tried.
        let gap = float(&both.gap(candidate.n())) / float(&candidate.n().norm_squared()).sqrt();
        assert!((gap - 1.0).abs() <= 1e-9 && (candidate.gap - gap).abs() <= 1e-9, "{:?}: {gap}", candidate.n());
    }
}

#[test]
fn a_direction_of_long_numbers_keeps_within_floats() {
    let [x, y, z] = direction([&(BigInt::from(1) << 400), &BigInt::ZERO, &(BigInt::from(3) << 398)]);
    assert!((x * x).is_finite() && x > 0.0);
    assert_eq!((y, 3.0 * x), (0.0, 4.0 * z));
    assert_eq!(direction([&BigInt::from(-3), &BigInt::from(4), &BigInt::ZERO]), [-3.0, 4.0, 0.0]);
}

#[test]
fn the_axes_are_all_six() {
    let mut found: Vec<[i64; 3]> =
        axes().map(|n| n.map(|c| c.to_i64().expect("small"))).map(|n| [n.x, n.y, n.z]).into();
    found.sort_unstable();
    assert_eq!(found, [[-1, 0, 0], [0, -1, 0], [0, 0, -1], [0, 0, 1], [0, 1, 0], [1, 0, 0]]);
}

#[test]
fn a_shift_is_no_longer_than_the_limit_and_nearly_as_long() {
    let mut dice = Dice(2);
    for bits in [1, 2, 5, 30, 66] {
        for _ in 0..50 {
            let n = random_point(&mut dice, bits);
            if Zero::is_zero(&n.norm_squared()) {
                continue;
            }
            let limit = (integer(&mut dice, 50).abs() + 1i32) << (dice.below(3) * 20) as usize;
            let shift = at_most_as_long(&n, &limit);
            assert!(shift.norm_squared() <= &limit * &limit, "{n:?} to {limit}");
            let (length, wanted) = (float(&shift.norm_squared()).sqrt(), float(&limit));
            let size = float(&n.norm_squared()).sqrt();
            assert!(length + 2.0 >= wanted * (size / (size + 1.0)) * (1.0 - 1e-9), "{n:?} to {limit}: {length}");
            assert!(!n.dot(&shift).is_negative());
        }
    }
}

#[test]
fn a_middle_leans_to_no_direction() {
    let unit = 2f64.powi(40);
    let near = |found: Option<LatticePoint>, expected: [f64; 3]| {
        let found = found.expect("a direction");
        for (c, expected) in found.components().into_iter().zip(expected) {
            assert!((float(c) / unit - expected).abs() < 1e-9, "{found:?} for {expected:?}");
        }
    };
    let (long, short) = (whole(30_000, 40_000, 0), whole(3, -4, 0));
    near(middle_of([&long].into_iter()), [0.6, 0.8, 0.0]);
    near(middle_of([&long, &short].into_iter()), [1.2, 0.0, 0.0]);
    near(
        middle_of([&whole(0, 0, -7), &short, &whole(2, 3, 6)].into_iter()),
        [0.6 + 2.0 / 7.0, -0.8 + 3.0 / 7.0, -1.0 + 6.0 / 7.0],
    );
    assert!(middle_of(std::iter::empty()).is_none());
}

#[test]
fn ways_are_shares_of_the_size_of_all() {
    let places = [0, 1].map(|end| {
        let at = |k: i64| whole(k * 3, k * k, -k * (end + 1));
        [(0..4).map(at).collect(), (4..8).map(at).collect()]
    });
    let ends = Ends::new(places);
    // The farthest from the first is (21, 49, −7) or (21, 49, −14).
    assert_eq!(ends.size, 49.0);
    let way = ends.near_way(1, 1, [VertexId(1), VertexId(3)]);
    assert_eq!(way, [6.0 / 49.0, 24.0 / 49.0, -4.0 / 49.0]);
}

/// The polygon of the plane (x, z), counter-clockwise with x to the right and z up, between two y.
fn extruded(profile: &[[i32; 2]], [front, back]: [i32; 2]) -> Block {
    let at = |y: i32| profile.iter().map(move |[x, z]| Vec3::new(*x, y, *z).map(|&c| Number::from_integer(c)));
    let n = profile.len() as u32;
    let mut faces: Vec<Vec<u32>> = vec![(0..n).collect(), (n..2 * n).rev().collect()];
    faces.extend((0..n).map(|k| vec![k, k + n, (k + 1) % n + n, (k + 1) % n]));
    Block::new(at(front).chain(at(back)).collect(), faces, &BlockOptions::default()).expect("a block")
}

/// The vertices of a block of integers.
fn places_of(block: &Block) -> Vec<LatticePoint> {
    block.vertices().iter().map(|v| v.map(|c| BigInt::from(c.approximate() as i64))).collect()
}

#[test]
fn the_cover_of_a_block_seen_from_a_corner_fills_it() {
    // A staircase of two steps, 3 wide: seen whole from the edge at the bottom of the wall.
    let block = extruded(&[[0, 0], [4, 0], [4, 1], [2, 1], [2, 3], [0, 3]], [0, 3]);
    let places = places_of(&block);
    let volume = |part: &ConvexPart| {
        let [o, a, b, c] = [0, 1, 2, 3].map(|k| &places[part.vertices[k].index()]);
        a.minus(o).cross(&b.minus(o)).dot(&c.minus(o)).abs()
    };
    let parts = tetrahedra(&block, &places);
    assert!(parts.iter().all(|part| !Zero::is_zero(&volume(part)) || part.vertices.len() == 4));
    let sum: BigInt = parts.iter().map(volume).sum();
    // 6 times 3 wide, 4 + 4 in section.
    assert_eq!(sum, BigInt::from(6 * 3 * 8));
}

#[test]
fn f64_says_of_gaps_what_exact_numbers_say() {
    let mut dice = Dice(14);
    let part = four_corners();
    let (mut yes, mut no, mut ties) = (0, 0, 0);
    for trial in 0..900 {
        let bits = [3, 52, 70][trial % 3];
        let places = [0, 1].map(|_| [four(&mut dice, bits), four(&mut dice, bits)]);
        let ends = Ends::new(places);
        let both = PartsAtEnds { parts: [&part, &part], ends: &ends };
        // Along an axis, so that a shift and a limit can make up for the gap exactly, or but for a lattice unit; and any direction.
        let length = 1 + dice.below(1 << 20) as i64;
        for n in [whole(length, 0, 0), random_point(&mut dice, bits)] {
            let gap = both.gap(&n);
            let between_points = |[a, b]: &[Vec<LatticePoint>; 2]| {
                a.iter().flat_map(|p| b.iter().map(|q| n.dot(&p.minus(q)))).min().expect("some points")
            };
            assert_eq!(Some(&gap), ends.places.iter().map(between_points).min().as_ref(), "{trial}: {n:?}");
            for more in [-1i64, 0, 1] {
                let by: BigInt = more - &gap / length;
                let shift = Vec3::new(by.clone(), integer(&mut dice, 3), BigInt::ZERO);
                let shifted = &gap + n.dot(&shift);
                let limit = by.abs();
                let within = !gap.is_negative() || &gap * &gap <= &limit * &limit * n.norm_squared();
                assert_eq!(both.parts_shifted(&n, &shift), !shifted.is_negative(), "{trial}: {n:?} {shift:?}");
                assert_eq!(both.parts_within(&n, &limit), within, "{trial}: {n:?} {limit}");
                yes += usize::from(!shifted.is_negative());
                no += usize::from(shifted.is_negative());
                ties += usize::from(Zero::is_zero(&shifted));
            }
        }
    }
    assert!(yes > 500 && no > 500 && ties > 500, "{yes} yes, {no} no, {ties} ties");
}
