//! The formulas of presets (docs/spec.md, section 3) in fractions, for models of boxes, whose lengths are known beforehand; and the stiffness of
//! joints that name none.

use num_rational::BigRational;
use num_traits::{Signed, Zero};
use proptest::prelude::*;
use rockproof_model::simulation::derive_stiffness;
use rockproof_model::{
    Block, Body, Criteria, Motion, Number, Precision, Preset, Simulation, ToleranceSet, Vec3, preset,
};

fn fraction(numerator: i64, denominator: i64) -> BigRational {
    BigRational::new(numerator.into(), denominator.into())
}

/// A box: where it begins and how long its sides are, in sixteenths of a metre.
#[derive(Clone, Copy, Debug)]
struct Cuboid {
    begin: [i64; 3],
    sides: [i64; 3],
}

impl Cuboid {
    fn block(self) -> Block {
        let point = |units: [i64; 3]| {
            let [x, y, z] = units.map(|n| Number::from_rational(fraction(n, 16)));
            Vec3::new(x, y, z)
        };
        let end = [0, 1, 2].map(|axis| self.begin[axis] + self.sides[axis]);
        Block::cuboid(&point(self.begin), &point(end)).expect("a box")
    }
}

fn cuboid() -> impl Strategy<Value = Cuboid> {
    (prop::array::uniform3(-300_i64..300), prop::array::uniform3(1_i64..200))
        .prop_map(|(begin, sides)| Cuboid { begin, sides })
}

/// Within so many steps of f64 of a fraction: the few roundings of a formula.
fn near(found: &Number, wanted: &BigRational) -> bool {
    let off = (found.to_rational() - wanted).abs();
    off <= wanted.abs() * fraction(1, 1 << 50)
}

/// The largest distance of a corner from a box's centre, squared.
fn squared_radius(all: &[Cuboid]) -> BigRational {
    let squared = |c: &Cuboid| c.sides.iter().map(|side| side * side).sum::<i64>();
    fraction(all.iter().map(squared).max().unwrap_or(0), 4 * 256)
}

/// ℓ, H and w0 of a model of boxes.
fn lengths(all: &[Cuboid]) -> [BigRational; 3] {
    let shortest = all.iter().flat_map(|c| c.sides).min().unwrap_or(0);
    let extent = |axis: usize| {
        let low = all.iter().map(|c| c.begin[axis]).min().unwrap_or(0);
        let high = all.iter().map(|c| c.begin[axis] + c.sides[axis]).max().unwrap_or(0);
        high - low
    };
    let longest = [0, 1, 2].map(extent).into_iter().max().unwrap_or(0);
    [fraction(shortest, 16), fraction(longest, 32), fraction(extent(2), 32)]
}

/// sin 3°, by its decimals.
fn sine_of_three_degrees() -> BigRational {
    "5233595624294383272211862960907841873/100000000000000000000000000000000000000".parse().expect("a fraction")
}

/// The table of presets: s, r, g, so and sp, ε, εo, εc, u.
fn table(preset: Preset, all: &[Cuboid], precision: Precision) -> [BigRational; 8] {
    let [shortest, half_side, half_height] = lengths(all);
    let eps = match precision {
        Precision::F32 => fraction(1, 1 << 23),
        Precision::F64 => fraction(1, 1 << 52),
    };
    let zero = BigRational::zero;
    let u = (&shortest / fraction(16, 1)).min(&half_side / fraction(100, 1));
    let s = &u * fraction(5, 2);
    let opening = fraction(1024, 1) * &eps * &half_side;
    match preset {
        Preset::Auto => {
            let r = (&shortest / fraction(8, 1)).min(&s / fraction(4, 1));
            let sine = sine_of_three_degrees();
            [s, r, u.clone(), sine, fraction(1024, 1) * eps, opening.clone(), opening, u]
        }
        Preset::Zero => [s, zero(), u.clone(), zero(), zero(), opening.clone(), opening, u],
        Preset::Shi => {
            let u = &half_height / fraction(100, 1);
            let s = &u * fraction(5, 2);
            let g = (&s * fraction(3, 10)).max(&half_height * fraction(12, 10_000));
            let sine = sine_of_three_degrees();
            let (open, close) = (&half_height * fraction(2, 10_000_000), &half_height * fraction(2, 10_000));
            [s.clone(), s, g, sine, zero(), open, close, u]
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(if cfg!(debug_assertions) { 60 } else { 500 }))]

    #[test]
    fn presets_are_those_of_the_table(boxes in prop::collection::vec(cuboid(), 1..4), single: bool) {
        let blocks: Vec<Block> = boxes.iter().map(|c| c.block()).collect();
        let shapes: Vec<&Block> = blocks.iter().collect();
        let precision = if single { Precision::F32 } else { Precision::F64 };
        for preset in [Preset::Auto, Preset::Shi, Preset::Zero] {
            let set = preset::derive(preset, &shapes, precision).expect("a set");
            let ToleranceSet { search, territory, penetration, overlap_sine, parallel_sine, equal, open, close, .. } = &set;
            let [s, r, g, sine, epsilon, eo, ec, u] = table(preset, &boxes, precision);
            let values = [
                ("search", search, &s),
                ("territory", territory, &r),
                ("penetration", penetration, &g),
                ("overlap_sine", overlap_sine, &sine),
                ("parallel_sine", parallel_sine, &sine),
                ("equal", equal, &epsilon),
                ("open", open, &eo),
                ("close", close, &ec),
                ("max_displacement", &set.max_displacement, &u),
            ];
            for (name, found, wanted) in values {
                prop_assert!(near(found, wanted), "{preset} {name} is {found}, not {wanted}");
            }
            let classic = preset == Preset::Shi;
            prop_assert_eq!(set.criteria, if classic { Criteria::Classic } else { Criteria::Revised });
            // ω = √(2g/R), rounded down, and by no more than a part in 100,000; of `shi` too (D10). Squared twice, so that no root is taken.
            let rotation = set.max_rotation.to_rational();
            let fourth = rotation.clone() * &rotation * &rotation * &rotation * squared_radius(&boxes);
            let limit = set.penetration.to_rational() * set.penetration.to_rational() * fraction(4, 1);
            prop_assert!(fourth <= limit && fourth * fraction(100_004, 100_000) >= limit, "{preset} ω is {rotation}");
        }
    }

    /// Young's modulus of the stiffest material times the cube root of the mean volume of what moves, or twice a block's weight over what its smallest
    /// face's corners may overlap by, whichever is more. Compared by third powers, so that no root is taken.
    #[test]
    fn stiffness_is_youngs_modulus_times_a_length_or_twice_what_weight_asks(
        boxes in prop::collection::vec(cuboid(), 1..4), young in prop::sample::select(vec![1_i64, 1000, 10_000_000_000]), fixed: bool,
    ) {
        let blocks: Vec<Block> = boxes.iter().map(|c| c.block()).collect();
        let shapes: Vec<&Block> = blocks.iter().collect();
        let set = preset::derive(Preset::Auto, &shapes, Precision::F64).expect("a set");
        let mut simulation = Simulation::default();
        simulation.materials[0].young = Number::from_rational(fraction(young, 1));
        simulation.materials[0].density = Number::from_integer(2000);
        simulation.gravity = Vec3::new(Number::from_integer(3), Number::ZERO, Number::from_integer(-4));
        let bodies: Vec<Body> = (0..blocks.len())
            .map(|k| Body { motion: if fixed && k > 0 { Motion::Fixed } else { Motion::Rigid }, ..Body::default() })
            .collect();
        let pairs: Vec<(&Block, &Body)> = blocks.iter().zip(&bodies).collect();
        derive_stiffness(&mut simulation, &pairs, &set);
        let found = simulation.joints.other.normal_stiffness.expect("a stiffness").to_rational();
        let moving = if fixed { &boxes[..1] } else { &boxes[..] };
        let volume = |c: &Cuboid| fraction(c.sides.iter().product(), 4096);
        let mean = moving.iter().map(volume).sum::<BigRational>() / fraction(moving.len() as i64, 1);
        // 2000 kg/m³ and 5 m/s², on the four corners of a box's face.
        let weight = |c: &Cuboid| fraction(2 * 2000 * 5, 4) * volume(c) / set.penetration.to_rational();
        let heaviest = moving.iter().map(weight).max().expect("a block that moves");
        let cubed = |x: &BigRational| x.clone() * x * x;
        let wanted = (cubed(&fraction(young, 1)) * mean).max(cubed(&heaviest));
        let off = (cubed(&found) - &wanted).abs();
        prop_assert!(off <= wanted * fraction(1, 1 << 45), "{found}");
    }
}
