//! Overlaps that uneven faces make of blocks whose planes touch, ties included; and those that they do not, since the bent face is out of the other block's reach.

use crate::support::shapes::{cuboid, exact, number, point, revised, slab, step};
use rockproof_model::preset::{Preset, derive};
use rockproof_model::{Block, Number, Precision, ToleranceSet, Vec3};
use rockproof_oracle::PreparedBlock;
use rockproof_oracle::audit::{Auditor, Overlap, OverlapSeverity, OverlapVisibility, rounding_depth};

/// s = 10, so that all pairs here are neighbours.
fn wide() -> ToleranceSet {
    revised(&[("search", "10"), ("penetration", "1/50")])
}

/// The overlap of two blocks, both ways round. Where it is bounded instead of measured, it is rounding when measured, too.
fn overlap_of(a: &Block, b: &Block) -> Overlap {
    let set = wide();
    let [one, other] = [[a, b], [b, a]].map(|pair| {
        let prepared = pair.map(PreparedBlock::new);
        let auditor = Auditor::new(&prepared, &set);
        let limit = rounding_depth(&pair, Precision::F64);
        let found = auditor.pair([0, 1]).overlap.expect("an overlap");
        let answer = auditor.pair_beyond_rounding([0, 1], &limit);
        match answer.bounded {
            Some(_) => assert_eq!(found.severity(&limit), OverlapSeverity::Rounding),
            None => assert_eq!(answer.overlap.as_ref(), Some(&found)),
        }
        found
    });
    assert_eq!(one.is_within_unevenness, other.is_within_unevenness);
    one
}

fn unit() -> Block {
    cuboid(["0", "0", "0"], ["1", "1", "1"])
}

/// The unit cube with the corners of a face so far before and behind its plane by turns, all other faces plane: along an axis, its face on that side.
fn bent(axis: usize, is_far: bool, by: &str) -> Block {
    let (plane, by) = (Number::from_integer(i32::from(is_far)), number(by));
    let bend = |v: &Vec3<Number>| {
        let mut place = [v.x.clone(), v.y.clone(), v.z.clone()];
        if place[axis] == plane {
            let is_before = place[(axis + 1) % 3] == place[(axis + 2) % 3];
            place[axis] = plane.plus(&if is_before == is_far { by.clone() } else { by.negated() });
        }
        let [x, y, z] = place;
        Vec3::new(x, y, z)
    };
    unit().with_vertices(unit().vertices().iter().map(bend).collect())
}

fn lowered(block: &Block, by: &str) -> Block {
    block.translated(&Vec3::new(number("0"), number("0"), number(by).negated()))
}

#[test]
fn an_overlap_of_twice_the_unevenness_of_its_face_is_within_it() {
    let cases = [("1/1000", true), ("3/2000", true), ("1/500", true), ("2000001/1000000000", false), ("1/100", false)];
    // Blocks so large that their faces are uneven by 100 m as well; a slab, and the floor of a step, which is not convex.
    for (size, (depth, expected)) in ["1", "100000"].into_iter().flat_map(|size| cases.map(|case| (size, case))) {
        let large = |block: &Block| {
            let vertices = block.vertices().iter().map(|v| v.map(|c| c.times(&number(size))));
            block.with_vertices(vertices.collect())
        };
        // The lowest corner is a thousandth below the bottom's plane.
        let upper = lowered(&bent(2, false, "1/1000"), &(exact(depth) - exact("1/1000")).to_string());
        let on_floor = upper.translated(&point(["5/2", "0", "2"]));
        for (under, upper) in [(slab(), &upper), (step(), &on_floor)] {
            let found = overlap_of(&large(&under), &large(upper));
            let depth = exact(depth) * exact(size);
            assert_eq!(found.depth_squared(), &depth * &depth, "{depth}");
            assert_eq!(found.is_within_unevenness, expected, "{depth}");
        }
    }
}

#[test]
fn a_bent_face_out_of_reach_excuses_nothing() {
    // Nine millimetres in a flat slab, bent by five at the top.
    let on_floor = |block: Block| block.translated(&point(["5/2", "0", "2"]));
    let found = overlap_of(&slab(), &lowered(&bent(2, true, "1/200"), "9/1000"));
    assert_eq!(found.depth_squared(), exact("81/1000000"));
    assert!(!found.is_within_unevenness && !found.is_deeper_than_g);
    // The same where the bent face is the one that overlaps.
    let upper = lowered(&bent(2, false, "1/200"), "1/250");
    for (under, upper) in [(slab(), upper.clone()), (step(), on_floor(upper))] {
        let found = overlap_of(&under, &upper);
        assert_eq!(found.depth_squared(), exact("81/1000000"));
        assert!(found.is_within_unevenness);
    }
    // A face of a block that is not convex, bent as the one that overlaps but out of the other block's reach.
    let far = step();
    let bend = |v: &Vec3<Number>| match v.z == number("4") {
        true => Vec3::new(
            v.x.clone(),
            v.y.clone(),
            v.z.plus(&number(if v.x.is_zero() == v.y.is_negative() { "1/200" } else { "-1/200" })),
        ),
        false => v.clone(),
    };
    let far = far.with_vertices(far.vertices().iter().map(bend).collect());
    let found = overlap_of(&far, &on_floor(lowered(&unit(), "9/1000")));
    assert!(found.depth_squared() == exact("81/1000000") && !found.is_within_unevenness);
}

/// Cubes stacked face to face, turned, and rounded to millionths: what no contact sees of them is the unevenness of faces.
#[test]
fn rounded_stacks_are_excused() {
    let (mut unseen, mut deepest) = (0, 0.0f64);
    for turn in 0..6 {
        let [one, two] = [0.1 + 0.26 * f64::from(turn), 0.14 * f64::from(turn)];
        let place = |v: &Vec3<Number>| {
            let [x, y, z] = v.components().map(|c| c.approximate());
            let (x, y) = (x * one.cos() - y * one.sin(), x * one.sin() + y * one.cos());
            let (y, z) = (y * two.cos() - z * two.sin(), y * two.sin() + z * two.cos());
            Vec3::new(x, y, z).map(|c| number(&format!("{}/1000000", (c * 1e6).round())))
        };
        let cubes = (0..27).map(|k| Vec3::new(k % 3, k / 3 % 3, k / 9).map(|&c| Number::from_integer(c)));
        let blocks: Vec<Block> = std::iter::once(cuboid(["-1", "-1", "-1"], ["4", "4", "0"]))
            .chain(cubes.map(|by| unit().translated(&by)))
            .map(|block| block.with_vertices(block.vertices().iter().map(place).collect()))
            .collect();
        let set = derive(Preset::Auto, &blocks.iter().collect::<Vec<_>>(), Precision::F64).unwrap();
        let prepared: Vec<PreparedBlock> = blocks.iter().map(PreparedBlock::new).collect();
        let auditor = Auditor::new(&prepared, &set);
        for found in auditor.neighbours().into_iter().filter_map(|pair| auditor.pair(pair).overlap) {
            if found.sight == OverlapVisibility::Unseen {
                assert!(found.is_within_unevenness, "{turn} {found:?}");
                unseen += 1;
                deepest = deepest.max(found.penetration.depth_m().unwrap());
            }
        }
    }
    assert!(unseen > 100 && deepest > 1e-7, "{unseen} {deepest}");
}
