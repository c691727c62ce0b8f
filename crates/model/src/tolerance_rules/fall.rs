//! Whether a block that falls is stopped before it is deeper than `penetration`: a warning, not a rule of SPEC section 3.

use super::largest::{factor, may_be_extreme, may_be_largest, signed_factor};
use super::stiffness::{blocks_by_joint, nearby_softest, softest};
use super::{six_digits, thin};
use crate::block::Point;
use crate::number::Number;
use crate::scene::Scene;
use crate::simulation::{MovingBlock, derive_stiffness_of, moving_blocks};
use crate::tolerance::ToleranceSet;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, Zero};

/// A fall from the height of the model that does not end within `penetration`. All numbers are within some ulps of the exact ones.
#[derive(Clone, Debug, PartialEq)]
pub struct Fall {
    /// The block that sinks deepest, of those that are as heavy for their stiffness (to 1e-9) the one that lies highest, of several the first.
    pub block: usize,
    /// Its weight (N).
    pub weight: f64,
    /// The height of the model along gravity (m).
    pub height: f64,
    /// The softest normal stiffness that the block can meet (N/m).
    pub stiffness: f64,
    /// The stiffness that would stop it within `penetration` (N/m); infinite where `penetration` is 0.
    pub needed: f64,
    /// How deep one contact becomes (m).
    pub depth: f64,
    /// `penetration` (m).
    pub allowed: f64,
    /// What would make the fall end within `penetration`: a stiffness, a larger `penetration` that is at most half of the thickness of each block, or
    /// either.
    pub remedy: String,
}

/// The worst fall of a block from the height of the model, if it is not stopped within `penetration`; **stopped exactly there is
/// stopped**. `None` without gravity, and where nothing can move or nothing can be hit.
///
/// With W the weight of the block, H the height of the model and p the softest normal stiffness the block can meet, a fall by H onto
/// one contact that becomes d deep has W·(H + d) to give, of which the spring takes p·d²/2. All of it goes into one contact where
/// the block lands on a corner below its centroid; if several contacts share it, or some is left as motion, none becomes as deep. The
/// fall ends within g when `p·g² ≥ 2·W·(H + g)`. Compared exactly. Speeds that the scene gives, and loads, are not counted.
pub fn fall(set: &ToleranceSet, scene: &Scene) -> Option<Fall> {
    let mut simulation = scene.simulation.clone();
    let bodies: Vec<_> = scene.blocks.iter().map(|b| (&b.block, &b.body)).collect();
    let moving = moving_blocks(&bodies);
    derive_stiffness_of(&mut simulation, &moving, set);
    let gravity = simulation.gravity.map(Number::to_rational);
    let gravity_squared = gravity.norm_squared();
    if gravity_squared.is_zero() {
        return None;
    }
    let vertices: Vec<_> = scene.blocks.iter().flat_map(|b| b.block.vertices()).collect();
    let near = simulation.gravity.map(signed_factor);
    let terms = |v: &&Point| [near.x * signed_factor(&v.x), near.y * signed_factor(&v.y), near.z * signed_factor(&v.z)];
    let ends = may_be_extreme(&vertices.iter().map(terms).collect::<Vec<_>>());
    let along = ends.into_iter().map(|place| gravity.dot(&vertices[place].map(Number::to_rational)));
    let along: Vec<BigRational> = along.collect();
    // |gravity| times the height of the model.
    let drop = along.iter().max()? - along.iter().min()?;
    let joints = blocks_by_joint(&simulation, &scene.blocks);
    let softest_near = nearby_softest(&simulation, &joints);
    let near = moving.iter().map(|one| {
        let density = factor(simulation.materials[one.body.material].density.approximate());
        density * factor(one.volume) / softest_near(one.body.joint)
    });
    let near: Vec<f64> = near.collect();
    let masses = may_be_largest(&near).filter_map(|place| {
        let MovingBlock { block, body, .. } = moving[place];
        let stiffness = softest(&simulation, &joints, body)?;
        let mass = simulation.materials[body.material].density.to_rational() * block.volume();
        Some((place, mass, stiffness))
    });
    // H and g are the same for all: the block with most mass for its stiffness sinks deepest.
    let heavier = |one: &(usize, BigRational, BigRational), other: &(usize, BigRational, BigRational)| {
        &other.1 * &one.2 > &one.1 * &other.2
    };
    let (worst, mass, stiffness) = masses.reduce(|one, other| if heavier(&one, &other) { other } else { one })?;
    let allowed = set.penetration.to_rational();
    let two = BigRational::from_integer(BigInt::from(2));
    // p·g² − 2·m·drop against 2·m·g·|gravity|, by squares.
    let left = &stiffness * &allowed * &allowed - &two * &mass * &drop;
    let right_squared = (&two * &mass * &allowed).pow(2) * &gravity_squared;
    if !left.is_negative() && left.pow(2) >= right_squared {
        return None;
    }
    // The lowest point of a block, along gravity.
    let lowest = |place: usize| {
        moving[place].block.vertices().iter().map(|v| terms(&v).iter().sum()).fold(f64::NEG_INFINITY, f64::max)
    };
    let alike = (0..moving.len()).filter(|&place| near[place] >= near[worst] * (1.0 - 1e-9));
    let highest = alike.min_by(|&one, &other| lowest(one).total_cmp(&lowest(other))).unwrap_or(worst);
    let block = moving[highest].number;
    let near = |value: &BigRational| Number::from_rational(value.clone()).approximate();
    let pull = near(&gravity_squared).sqrt();
    let (weight, height, allowed) = (near(&mass) * pull, near(&drop) / pull, near(&allowed));
    let (stiffness, given) = (near(&stiffness), stiffness);
    let needed = 2.0 * weight * (height + allowed) / (allowed * allowed);
    let depth = (weight + (weight * weight + 2.0 * stiffness * weight * height).sqrt()) / stiffness;
    // A stiffness that is derived may fall with a larger `penetration`, which then mends nothing.
    let deeper = ToleranceSet { penetration: Number::from_f64(depth).unwrap_or(Number::ZERO), ..set.clone() };
    let mut derived = scene.simulation.clone();
    derive_stiffness_of(&mut derived, &moving, &deeper);
    let is_mended = softest(&derived, &joints, moving[worst].body).is_some_and(|derived| derived >= given);
    // Both are off by some roundoffs: so much more is enough.
    let enough = |value: f64| six_digits(value * (1.0 + 1e-12), true, false);
    let penetration = Some(enough(depth)).filter(|_| is_mended && depth.is_finite());
    // As the text is read. Without `penetration` no stiffness stops a fall, so there is nothing else to say.
    let fits = |text: &String| {
        let deeper = Number::parse(text).map(|penetration| ToleranceSet { penetration, ..set.clone() });
        !needed.is_finite() || deeper.is_ok_and(|deeper| thin(&deeper, &scene.shapes()).is_none())
    };
    let remedies = [
        needed.is_finite().then(|| format!("normal_stiffness ≥ {}", enough(needed))),
        penetration.filter(fits).map(|text| format!("penetration ≥ {text}")),
    ];
    let remedy = remedies.into_iter().flatten().collect::<Vec<_>>().join(" or ");
    Some(Fall { block, weight, height, stiffness, needed, depth, allowed, remedy })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preset::{Preset, derive};
    use crate::tolerance_rules::check_scene;
    use crate::{Block, Precision, SceneBlock, Vec3};

    /// A cube of 1 m³ and 2500 kg, its bottom 2 m above a fixed slab of 1 m: a model 4 m high.
    fn dropped(stiffness: &str, penetration: &str) -> (ToleranceSet, Scene) {
        let number = |text: &str| Number::from_rational(text.parse().unwrap());
        let corner = |c: [i32; 3]| Vec3::new(c[0], c[1], c[2]).map(|&c| Number::from_integer(c));
        let cuboid = |low, high| Block::cuboid(&corner(low), &corner(high)).unwrap();
        let mut scene = Scene::on_fixed("slab", cuboid([-2, -2, -1], [2, 2, 0]));
        scene.blocks.push(SceneBlock::new("cube", cuboid([0, 0, 2], [1, 1, 3])));
        scene.simulation.gravity = corner([0, 0, -10]);
        scene.simulation.materials[0].density = Number::from_integer(2500);
        for joint in scene.simulation.joints.all_mut() {
            joint.normal_stiffness = Some(number(stiffness));
        }
        let mut set = derive(Preset::Auto, &scene.shapes(), Precision::F64).unwrap();
        set.penetration = number(penetration);
        (set, scene)
    }

    #[test]
    fn a_soft_cube_rests_within_penetration_and_falls_deeper() {
        let (set, scene) = dropped("10000000", "1/10");
        assert_eq!(check_scene(&set, &scene, Precision::F64), [], "at rest 0.6 mm");
        let found = fall(&set, &scene).expect("a warning");
        assert_eq!((found.block, found.weight, found.height, found.stiffness), (1, 25_000.0, 4.0, 1e7));
        // 1e7·d²/2 = 25,000·(4 + d)
        let d = found.depth;
        assert!((5e6 * d * d / (25_000.0 * (4.0 + d)) - 1.0).abs() < 1e-12 && d > found.allowed, "{found:?}");
        assert!((found.needed / 2.05e7 - 1.0).abs() < 1e-12, "{found:?}");
        assert!(found.remedy.starts_with("normal_stiffness ≥ 2.05") && found.remedy.contains("penetration ≥ 0.14"));
    }

    #[test]
    fn stopped_exactly_at_penetration_is_stopped() {
        // 2·25,000·(4 + 1/10)/(1/10)²
        for (stiffness, is_stopped) in [("20500000", true), ("20500001", true), ("20499999999/1000", false)] {
            let (set, scene) = dropped(stiffness, "1/10");
            assert_eq!(fall(&set, &scene).is_none(), is_stopped, "{stiffness}");
        }
        // What would satisfy does.
        let (set, scene) = dropped("10000000", "1/10");
        let depth = fall(&set, &scene).unwrap().depth;
        let (mut set, scene) = dropped("10000000", "1/10");
        set.penetration = Number::from_f64(depth * 1.000_001).unwrap();
        assert_eq!(fall(&set, &scene), None);
    }

    #[test]
    fn a_penetration_beyond_half_of_a_thickness_is_not_advised() {
        let (set, scene) = dropped("10000000", "1/10");
        let remedy = fall(&set, &scene).unwrap().remedy;
        let advised = remedy.split("penetration ≥ ").nth(1).expect("a penetration").to_owned();
        let number = |text: &str| Number::from_rational(text.parse().unwrap());
        let twice = Number::parse(&advised).unwrap().times(&Number::from_integer(2));
        for (thickness, is_advised) in
            [(twice.clone(), true), (twice.plus(&number("-1/1000000000000000000000")), false)]
        {
            let (set, mut scene) = dropped("10000000", "1/10");
            let at = |n: i32| Number::from_integer(n);
            let corners = [Vec3::new(at(3), at(3), at(2)), Vec3::new(at(4), at(4), at(2).plus(&thickness))];
            scene.blocks.push(SceneBlock::new("plate", Block::cuboid(&corners[0], &corners[1]).unwrap()));
            let found = fall(&set, &scene).unwrap();
            assert_eq!(found.block, 1);
            let expected = if is_advised { remedy.clone() } else { remedy.split(" or ").next().unwrap().to_owned() };
            assert_eq!(found.remedy, expected, "{thickness}");
        }
    }

    #[test]
    fn without_gravity_nothing_falls_and_without_penetration_nothing_stops() {
        let (mut set, mut scene) = dropped("10000000", "0");
        let found = fall(&set, &scene).unwrap();
        assert!(found.needed.is_infinite() && found.remedy.starts_with("penetration ≥ "), "{found:?}");
        // A stiffness derived from the weight at rest is the softer the deeper blocks may sink.
        let mut soft = scene.clone();
        soft.simulation.materials[0].young = Number::from_integer(1);
        soft.simulation.joints.all_mut().for_each(|joint| joint.normal_stiffness = None);
        set.penetration = Number::from_f64(0.01).unwrap();
        let remedy = fall(&set, &soft).unwrap().remedy;
        assert!(remedy.starts_with("normal_stiffness ≥ ") && !remedy.contains("penetration"), "{remedy}");
        scene.simulation.gravity = Vec3::new(Number::ZERO, Number::ZERO, Number::ZERO);
        assert_eq!(fall(&set, &scene), None);
    }
}
