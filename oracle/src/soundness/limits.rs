//! The cascade at the limits of its levels: values that f64 cannot hold, and values as wide as an integer.

use crate::pair::Pair;
use crate::predicate::{BeyondVertex, BoxesMeet};
use crate::prepared_block::PreparedBlock;
use crate::sign_cascade::SignCascade;
use crate::soundness::without_tolerances;
use num_bigint::BigInt;
use num_rational::BigRational;
use rockproof_model::decision::Side;
use rockproof_model::{Block, BlockOptions, EdgeId, Number, Point, Sign, Vec3, VertexId};

/// A dot product whose first term overflows while the exact sum has the other sign: where every bound is infinite, an infinite
/// value proves nothing.
#[test]
fn infinite_values_prove_no_sign() {
    let float = |x: f64| Number::from_f64(x * 2f64.powi(512)).unwrap();
    let at = |c: [f64; 3]| Vec3::new(float(c[0]), float(c[1]), float(c[2]));
    let faces = vec![vec![0, 2, 1], vec![0, 1, 3], vec![1, 2, 3], vec![2, 0, 3]];
    let tetrahedron = |corners: [[f64; 3]; 4]| {
        let made = Block::new(corners.map(at).to_vec(), faces.clone(), &BlockOptions { planarity: Number::ZERO });
        PreparedBlock::new(&made.unwrap())
    };
    let p = [1.2, -0.9, -0.9];
    let moved = |by: [f64; 3]| std::array::from_fn(|k| p[k] + by[k]);
    let a = tetrahedron([p, moved([1.0, 0.0, 0.0]), moved([0.0, 1.0, 0.0]), moved([0.0, 0.0, 1.0])]);
    // Edge 0 is along ±(1.1, 0.99, 0.99): 1.32 − 0.891 − 0.891 = −0.462, times 2¹⁰²⁴.
    let one = tetrahedron([[0.0; 3], [1.1, 0.99, 0.99], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    let other = tetrahedron([[0.0; 3], [-1.1, -0.99, -0.99], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]]);
    let t = without_tolerances();
    for (b, expected) in [(one, Sign::Negative), (other, Sign::Positive)] {
        let pair = Pair::new(&a, &b);
        let mut run = SignCascade::new(&pair, &t);
        let asked = BeyondVertex { point: (Side::A, VertexId(0)), at: (Side::B, VertexId(0)), edge: EdgeId(0) };
        for time in 1..=2 {
            assert_eq!(run.sign(&asked), expected, "time {time}");
        }
    }
}

/// `s + 2ᵐ − 1` for s = 2^(w − 1) − 1: for m close to w it needs w bits beside its sign, one more than an integer of w bits has.
#[test]
fn values_as_wide_as_an_integer_go_to_a_wider_one() {
    let number = |value: BigInt| Number::from_rational(BigRational::from_integer(value));
    let cube = |x: BigInt| {
        let at = |x: BigInt, y: i32, z: i32| -> Point {
            Vec3::new(number(x), Number::from_integer(y), Number::from_integer(z))
        };
        PreparedBlock::new(&Block::cuboid(&at(BigInt::ZERO, 0, 0), &at(x, 1, 1)).unwrap())
    };
    let power = |exponent: u32| BigInt::from(1) << exponent;
    let a = cube(BigInt::from(1));
    for width in [128, 256, 512, 1024] {
        for m in width - 8..width {
            let b = cube(power(m) - 1);
            let high = b.extremes[0].1;
            let mut t = without_tolerances();
            t.search = number(power(width - 1) - 1);
            let pair = Pair::new(&a, &b);
            let mut run = SignCascade::new(&pair, &t);
            let low = a.extremes[0].0;
            let asked = BoxesMeet { low: (Side::A, low), high: (Side::B, high), axis: 0 };
            assert!(run.exact_sign(&asked).is_positive(), "{width} bits, 2^{m}");
        }
    }
}
