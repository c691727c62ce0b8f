//! Depths worked by hand, ties included, and what turning, scaling and moving the blocks may not change.

mod support;

use num_rational::BigRational;
use rockproof_model::{Block, Sign, Vec3};
use rockproof_oracle::penetration::{deepest, penetration};
use support::shapes::{cuboid, exact, number, point, step, tetrahedron};

fn squared(a: &Block, b: &Block) -> (Sign, BigRational) {
    let found = penetration(a, b).unwrap();
    (found.gap.sign, found.gap.squared)
}

/// Turned about z by the angle of cosine 3/5, about x by that of cosine 5/13, and scaled.
fn moved(block: &Block, scale: &str) -> Block {
    let n = |t: &str| number(t);
    let turn = |a: &rockproof_model::Number, b: &rockproof_model::Number, c: &str, s: &str| {
        (a.times(&n(c)).plus(&b.times(&n(s)).negated()), a.times(&n(s)).plus(&b.times(&n(c))))
    };
    let vertices = block.vertices().iter().map(|v| {
        let (x, y) = turn(&v.x, &v.y, "3/5", "4/5");
        let (y, z) = turn(&y, &v.z, "5/13", "12/13");
        Vec3::new(x.times(&n(scale)).plus(&n("1/7")), y.times(&n(scale)), z.times(&n(scale)))
    });
    block.with_vertices(vertices.collect())
}

/// Pairs with the sign and the square of their gap.
fn cases() -> Vec<(Block, Block, Sign, BigRational)> {
    let unit = || cuboid(["0", "0", "0"], ["1", "1", "1"]);
    // The tip of a tetrahedron with right angles, (0, 0, 0), pushed into a corner cut along x + y + z = s.
    let corner = |at: &str| {
        tetrahedron([["0", "0", "0"], ["3", "0", "0"], ["0", "3", "0"], ["0", "0", "3"]]).translated(&point([at; 3]))
    };
    // Two wedges' ridges crossing at right angles, 1/4 deep.
    let ridge = |z: &str| tetrahedron([["-2", "0", z], ["2", "0", z], ["0", "-2", "-4"], ["0", "2", "-4"]]);
    let hanging = tetrahedron([["0", "-2", "0"], ["0", "2", "0"], ["-2", "0", "4"], ["2", "0", "4"]]);
    vec![
        // Overlap 1/4 × 1/2 × 1: the least is 1/4.
        (unit(), cuboid(["3/4", "1/2", "0"], ["2", "2", "1"]), Sign::Negative, exact("1/16")),
        // A tie of three directions.
        (unit(), cuboid(["1/2", "1/2", "1/2"], ["2", "2", "2"]), Sign::Negative, exact("1/4")),
        // One inside the other: out through the nearest side, whole width included.
        (
            cuboid(["0", "0", "0"], ["8", "8", "8"]),
            cuboid(["1", "3", "3"], ["2", "5", "5"]),
            Sign::Negative,
            exact("4"),
        ),
        // Touching.
        (unit(), cuboid(["1", "0", "0"], ["2", "1", "1"]), Sign::Zero, exact("0")),
        (unit(), cuboid(["1", "1", "1"], ["2", "2", "2"]), Sign::Zero, exact("0")),
        // Apart by 1/3.
        (unit(), cuboid(["4/3", "0", "0"], ["2", "1", "1"]), Sign::Positive, exact("1/9")),
        // The corner (1,1,1) of the cube through the slanted face x + y + z = 3 of a tetrahedron moved by −1/2: the plane
        // is x + y + z = 3/2 then, and the cube's corner at 0 lies 3/2 below: (3/2)²/3.
        (corner("-1/2"), unit(), Sign::Negative, exact("3/4")),
        // Edge to edge: the ridge at 1/4 against the one at 0, normal z.
        (hanging, ridge("1/4"), Sign::Negative, exact("1/16")),
    ]
}

#[test]
fn hand_worked_depths_come_out_moved_turned_and_scaled() {
    for (k, (a, b, sign, square)) in cases().into_iter().enumerate() {
        assert_eq!(squared(&a, &b), (sign, square.clone()), "case {k}");
        assert_eq!(squared(&b, &a), (sign, square.clone()), "case {k} exchanged");
        let (c, d) = (moved(&a, "3/2"), moved(&b, "3/2"));
        assert_eq!(squared(&c, &d), (sign, square * exact("9/4")), "case {k} moved");
    }
}

#[test]
fn the_translation_it_names_parts_the_blocks_and_less_does_not() {
    for (k, (a, b, sign, square)) in cases().into_iter().enumerate() {
        if sign != Sign::Negative {
            continue;
        }
        let found = penetration(&a, &b).unwrap();
        let length = found.direction.norm_squared();
        // Where depth over length is a fraction, the translation itself is one.
        let share: BigRational = square / length;
        let root = BigRational::new(share.numer().sqrt(), share.denom().sqrt());
        if &root * &root != share {
            continue;
        }
        for (factor, expected) in [("1", Sign::Zero), ("999/1000", Sign::Negative), ("1001/1000", Sign::Positive)] {
            let by = found.direction.map(|c| rockproof_model::Number::from_rational(c * &root * exact(factor)));
            assert_eq!(squared(&a.translated(&by), &b).0, expected, "case {k}, {factor}");
        }
    }
}

#[test]
fn a_depth_is_rounded_to_the_nearest_float() {
    let slanted = tetrahedron([["0", "0", "0"], ["3", "0", "0"], ["0", "3", "0"], ["0", "0", "3"]]);
    let found = penetration(&slanted, &cuboid(["9/10", "9/10", "9/10"], ["4", "4", "4"])).unwrap();
    assert_eq!(found.gap.squared, exact("3/100"));
    assert_eq!(found.depth_m(), Some(0.173_205_080_756_887_73));
}

#[test]
fn a_scene_names_its_deepest_pair_and_what_it_left_out() {
    let blocks = [
        cuboid(["0", "0", "0"], ["1", "1", "1"]),
        cuboid(["7/8", "0", "0"], ["2", "1", "1"]),
        cuboid(["0", "3/4", "0"], ["1/2", "2", "1"]),
        cuboid(["5", "5", "5"], ["6", "6", "6"]),
        step().translated(&point(["5", "5", "5"])),
    ];
    let (found, left_out) = deepest(&blocks.iter().collect::<Vec<_>>());
    let found = found.unwrap();
    assert_eq!((found.blocks, found.penetration.depth_m()), ([0, 2], Some(0.25)));
    assert_eq!(left_out, 1);
    assert_eq!(deepest(&[&blocks[0], &blocks[3]]), (None, 0));
}
