//! Blocks that are not convex and whose surfaces coincide but for rounding: what vertices and edges show of such an overlap is rounding, however deep
//! it is.

use crate::support::random_numbers::Random;
use crate::support::shapes::{block, exact, notched_cube, plus_sign, step};
use num_rational::BigRational;
use num_traits::ToPrimitive;
use rockproof_model::{Block, Number, Sign, Vec3};
use rockproof_oracle::penetration::penetration;

type Place = [f64; 3];

fn places(block: &Block) -> Vec<Place> {
    block.vertices().iter().map(|v| v.components().map(|c| c.approximate())).collect()
}

fn placed(block: &Block, places: &[Place]) -> Block {
    let number = |c: f64| Number::from_f64(c).unwrap();
    block.with_vertices(places.iter().map(|p| Vec3::new(number(p[0]), number(p[1]), number(p[2]))).collect())
}

/// Turned by 0.7 about z and by 0.4 about x, and rounded to f64, which bends the faces.
fn tilted([x, y, z]: Place) -> Place {
    let (c, s) = (0.7f64.cos(), 0.7f64.sin());
    let (x, y) = (c * x - s * y, s * x + c * y);
    let (c, s) = (0.4f64.cos(), 0.4f64.sin());
    [x, c * y - s * z, s * y + c * z]
}

/// A block moved by a way, tilted, and each coordinate changed by up to so much.
fn rounded(block: &Block, way: Place, noise: f64, random: &mut Random) -> Block {
    let moved = |p: &Place| tilted(std::array::from_fn(|k| p[k] + way[k]));
    let all: Vec<Place> = places(block).iter().map(moved).collect();
    let shaken = |p: Place| p.map(|c| c + noise * (random.below(2001) - 1000) as f64 / 1000.0);
    placed(block, &all.into_iter().map(shaken).collect::<Vec<_>>())
}

fn depth_m(a: &Block, b: &Block) -> f64 {
    let [found, other] = [(a, b), (b, a)].map(|(a, b)| penetration(a, b).unwrap());
    assert_eq!(found.gap, other.gap, "the other way round");
    found.depth_m().unwrap()
}

/// How deep the deepest of the points of a grid is in the step and in the step moved by a way, untilted, by f64 alone.
fn deepest_of_grid(way: Place) -> f64 {
    let axis = |low: i32, high: i32| (8 * low..=8 * high).map(|k| f64::from(k) / 8.0);
    let at = |p: Place| depth_in(&STEP, p).min(depth_in(&STEP, std::array::from_fn(|k| p[k] - way[k])));
    let points = axis(0, 4).flat_map(|x| axis(-4, 4).flat_map(move |y| axis(0, 4).map(move |z| [x, y, z])));
    points.map(at).fold(0.0, f64::max)
}

/// The distance of a point inside from the surface of a union of boxes, from below; 0 outside.
fn depth_in(boxes: &[[Place; 2]], p: Place) -> f64 {
    let inside = |[low, high]: &[Place; 2]| {
        (0..3).map(|k| (p[k] - low[k]).min(high[k] - p[k])).fold(f64::INFINITY, f64::min).max(0.0)
    };
    boxes.iter().map(inside).fold(0.0, f64::max)
}

/// Two boxes that make up the step.
const STEP: [[Place; 2]; 2] = [[[0.0, -4.0, 0.0], [4.0, 4.0, 2.0]], [[0.0, -4.0, 0.0], [2.0, 4.0, 4.0]]];

#[test]
fn a_block_given_twice_with_other_roundings_is_deep_in_itself() {
    let mut random = Random(5);
    for noise in [0.0, 1e-16, 1e-13, 1e-9, 1e-5, 1e-3] {
        for (block, least) in [(step(), 0.9), (notched_cube(), 0.4), (plus_sign(), 0.4)] {
            let (one, two) =
                (rounded(&block, [0.0; 3], 0.0, &mut random), rounded(&block, [0.0; 3], noise, &mut random));
            let found = depth_m(&one, &two);
            assert!(found > least && found < 2.0, "{noise}: {found}");
        }
    }
}

#[test]
fn blocks_that_overlap_along_coinciding_faces_are_found_nearly_as_deep_as_they_are() {
    let mut random = Random(6);
    for way in [[0.0, 1.0, 0.0], [0.0, 7.0, 0.0], [0.0, 7.75, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 2.0], [1.0, 3.0, 0.0]] {
        let deepest = deepest_of_grid(way);
        for noise in [0.0, 1e-15, 1e-10, 1e-6] {
            let (one, two) = (rounded(&step(), [0.0; 3], 0.0, &mut random), rounded(&step(), way, noise, &mut random));
            let found = depth_m(&one, &two);
            // Middles of cells need not be the best place, and the grid's depths are from below: a third to twice of them.
            assert!(found >= deepest / 3.0 && found <= 2.0 * deepest + 1e-5, "{way:?}, {noise}: {found} of {deepest}");
        }
    }
}

#[test]
fn blocks_that_only_touch_but_for_rounding_are_no_deeper_than_rounding() {
    let mut random = Random(7);
    // On the step's tread, before its riser, beside it, on top of it.
    for way in [[2.0, 0.0, 2.0], [4.0, 0.0, 0.0], [0.0, 8.0, 0.0], [0.0, 0.0, 4.0], [2.0, 3.0, 2.0]] {
        for noise in [0.0, 1e-15] {
            let (one, two) = (rounded(&step(), [0.0; 3], 0.0, &mut random), rounded(&step(), way, noise, &mut random));
            let found = depth_m(&one, &two);
            assert!(found < 1e-14, "{way:?}, {noise}: {found}");
        }
    }
}

/// A staircase of `count` steps from x = 0 to `count`, 2 wide, and what lies on it up to y = count + 1: both with ends of many corners.
fn staircases(count: i32) -> [Block; 2] {
    let lower = (1..=count).rev().flat_map(|k| [[k, k], [k - 1, k]]);
    let upper = (1..=count).flat_map(|k| [[k - 1, k], [k, k]]);
    let lower: Vec<[i32; 2]> = [[0, 0], [count, 0]].into_iter().chain(lower).collect();
    let upper: Vec<[i32; 2]> = upper.chain([[count, count + 1], [0, count + 1]]).collect();
    [lower, upper].map(|polygon| {
        let count = polygon.len() as u32;
        let level = |z: i32| polygon.iter().map(move |[x, y]| Vec3::new(*x, *y, z).map(|&c| Number::from_integer(c)));
        let sides = (0..count).map(|k| [k, (k + 1) % count]).map(|[k, next]| vec![k, next, count + next, count + k]);
        let mut faces = vec![(0..count).rev().collect::<Vec<u32>>(), (count..2 * count).collect()];
        faces.extend(sides);
        let faces: Vec<&[u32]> = faces.iter().map(Vec::as_slice).collect();
        block(level(0).chain(level(2)).collect(), &faces)
    })
}

#[test]
fn triangles_that_reach_out_of_a_bent_face_enclose_nothing() {
    let mut random = Random(8);
    for count in [3, 5, 8] {
        let [lower, upper] = staircases(count);
        for noise in [0.0, 1e-16, 1e-15] {
            let one = rounded(&lower, [0.0; 3], 0.0, &mut random);
            let found = depth_m(&one, &rounded(&upper, [0.0; 3], noise, &mut random));
            assert!(found < 1e-14, "{count}, {noise}: {found}");
            // A quarter lower, it is 1/8 deep in every step at most.
            let found = depth_m(&one, &rounded(&upper, [0.0, -0.25, 0.0], noise, &mut random));
            assert!(found > 0.08 && found < 0.26, "{count}, {noise}: {found}");
        }
    }
}

/// The end faces of an L are cut into triangles from the end of one arm, so a diagonal passes through the notch, where a cube lies half a metre away.
#[test]
fn a_diagonal_that_leaves_its_face_is_no_part_of_the_block() {
    let profile = [[4, 2], [2, 2], [2, 4], [0, 4], [0, 0], [4, 0]];
    let level = |y: i32| profile.iter().map(move |[x, z]| Vec3::new(*x, y, *z).map(|&c| Number::from_integer(c)));
    let sides: Vec<[u32; 4]> = (0..6).map(|k| [k, k + 6, (k + 1) % 6 + 6, (k + 1) % 6]).collect();
    let mut faces: Vec<&[u32]> = vec![&[0, 1, 2, 3, 4, 5], &[11, 10, 9, 8, 7, 6]];
    faces.extend(sides.iter().map(<[u32; 4]>::as_slice));
    let l_shape = block(level(0).chain(level(3)).collect(), &faces);
    let corner = |c: i32, y: i32| Vec3::new(number_of(c, 2), number_of(y, 2), number_of(c, 2));
    let cube = Block::cuboid(&corner(5, -1), &corner(7, 1)).unwrap();
    let mut random = Random(21);
    for _ in 0..60 {
        let one = rounded(&l_shape, [0.0; 3], 1e-15, &mut random);
        let found = depth_m(&one, &rounded(&cube, [0.0; 3], 0.0, &mut random));
        assert!(found < 1e-14, "{found}");
    }
}

#[test]
fn a_shallow_vertex_hides_no_deep_overlap() {
    // Equal steps, one 1 mm to the side of the other, as they lie: vertices are 1 mm inside at the most, what they share is 2 wide.
    let side = Number::from_f64(1.0 / 1024.0).unwrap();
    let moved = |by: &Number| step().translated(&Vec3::new(by.clone(), by.clone(), by.clone()));
    let found = penetration(&step(), &moved(&side)).unwrap();
    assert_eq!(found.gap.sign, Sign::Negative);
    assert!(found.gap.squared > exact("1/2"), "{}", found.gap.squared.to_f64().unwrap());
    // A centimetre and more, above `penetration`, is no more telling.
    for part in [64, 32, 20] {
        let found = penetration(&step(), &moved(&number_of(1, part))).unwrap();
        assert!(found.gap.squared > exact("1/2"), "1/{part}: {}", found.gap.squared.to_f64().unwrap());
    }
}

fn number_of(numerator: i32, denominator: i32) -> Number {
    Number::from_rational(BigRational::new(numerator.into(), denominator.into()))
}
