//! Whether `penetration` is more than half of the thickness of a block: a warning, not a rule of SPEC section 3.

use super::six_digits;
use crate::block::{Block, face_normal};
use crate::number::Number;
use crate::tolerance::ToleranceSet;
use crate::topology::VertexId;
use crate::vector::Vec3;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, Zero};

/// A block that is less than twice as thick as `penetration`. All numbers are within some ulps of the exact ones.
#[derive(Clone, Debug, PartialEq)]
pub struct Thin {
    /// The thinnest block, of several the first.
    pub block: usize,
    /// Its least extent along the normal of one of its faces (m).
    pub thickness: f64,
    /// `penetration` (m).
    pub penetration: f64,
    /// What would be little enough.
    pub remedy: String,
}

/// The thinnest block, if `penetration` is more than half of its thickness; **exactly half is not more**.
///
/// The thickness is the least extent of a block's vertices along the normal of one of its faces. The block lies between two parallel planes so far
/// apart, so none of its points is further than half of that from its surface: where `penetration` is more, no point inside it is ever deeper
/// than `penetration`, and the nearest way out may be through the face behind. Other directions may be thinner still, so not every thin block is
/// found, but none is without cause. Compared exactly, by squares.
pub fn thin(set: &ToleranceSet, blocks: &[&Block]) -> Option<Thin> {
    let penetration = set.penetration.to_rational();
    if !penetration.is_positive() {
        return None;
    }
    let twice = &penetration * BigRational::from_integer(BigInt::from(2));
    let squares =
        blocks.iter().enumerate().filter_map(|(number, block)| Some((thickness_squared(block, &twice)?, number)));
    // Of equal ones the first.
    let (squared, block) = squares.min()?;
    if &twice * &twice <= squared {
        return None;
    }
    let near = |value: &BigRational| Number::from_rational(value.clone()).approximate();
    let thickness = near(&squared).sqrt();
    // As the text is read, half of the thickness may be met exactly.
    let is_met = |text: &String| {
        let bound = Number::parse(text).map(|bound| bound.to_rational() * BigRational::from_integer(BigInt::from(2)));
        bound.is_ok_and(|twice| &twice * &twice <= squared)
    };
    let half = Some(six_digits(thickness / 2.0, false, true)).filter(is_met);
    let half = half.unwrap_or_else(|| six_digits(thickness / 2.0, false, false));
    let remedy = format!("penetration ≤ {half}");
    Some(Thin { block, thickness, penetration: near(&penetration), remedy })
}

/// The square of a block's thickness; `None` where that is certainly no less than `limit`.
///
/// Between two planes that are t apart each section is no wider than the diagonal D of the block's box, so its area is less than D², and the volume no
/// more than t·D².
fn thickness_squared(block: &Block, limit: &BigRational) -> Option<BigRational> {
    let (lattice, points) = block.lattice_points();
    let (numerator, denominator) = lattice.units_per_metre();
    let six_volumes = &block.moments().six_volumes;
    let axes: [fn(&Vec3<BigInt>) -> BigInt; 3] = [|p| p.x.clone(), |p| p.y.clone(), |p| p.z.clone()];
    let diagonal_squared: BigInt = axes.iter().map(|along| extent(&points, along).pow(2)).sum();
    if six_volumes * limit.denom() * &denominator >= BigInt::from(6) * diagonal_squared * limit.numer() * &numerator {
        return None;
    }
    let along = |face: &Vec<VertexId>| {
        let normal = face_normal(&points, face);
        let squared = normal.norm_squared();
        (!squared.is_zero()).then(|| BigRational::new(extent(&points, |p| normal.dot(p)).pow(2), squared))
    };
    let least = block.topology().faces().iter().filter_map(along).min()?;
    let metres = BigRational::new(denominator, numerator);
    Some(least * &metres * metres)
}

/// The greatest difference of a value of points.
fn extent(points: &[Vec3<BigInt>], of: impl Fn(&Vec3<BigInt>) -> BigInt) -> BigInt {
    let values: Vec<BigInt> = points.iter().map(of).collect();
    match (values.iter().min(), values.iter().max()) {
        (Some(least), Some(greatest)) => greatest - least,
        _ => BigInt::zero(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preset::{Preset, derive};
    use crate::{BlockOptions, Precision};

    fn number(text: &str) -> Number {
        Number::from_rational(text.parse().unwrap())
    }

    fn cuboid(low: [&str; 3], high: [&str; 3]) -> Block {
        let corner = |[x, y, z]: [&str; 3]| Vec3::new(number(x), number(y), number(z));
        Block::cuboid(&corner(low), &corner(high)).unwrap()
    }

    fn found(blocks: &[&Block], penetration: &str) -> Option<Thin> {
        let mut set = derive(Preset::Auto, blocks, Precision::F64).unwrap();
        assert_eq!(thin(&set, blocks), None, "auto");
        set.penetration = number(penetration);
        thin(&set, blocks)
    }

    #[test]
    fn a_plate_is_warned_of_beyond_exactly_half_its_thickness() {
        let slab = cuboid(["-2", "-2", "-1"], ["3", "3", "0"]);
        let plate = cuboid(["1000", "0", "0"], ["1001", "1", "1/50"]);
        assert_eq!(found(&[&slab, &plate], "1/100"), None);
        let thin = found(&[&slab, &plate], "10000000000000001/1000000000000000000").expect("a warning");
        assert_eq!((thin.block, thin.thickness, thin.remedy.as_str()), (1, 0.02, "penetration ≤ 0.01"));
        // Of equal ones the first.
        assert_eq!(found(&[&slab, &plate, &plate], "1/2").expect("a warning").block, 1);
        assert_eq!(found(&[&slab], "1/2"), None);
    }

    #[test]
    fn thickness_does_not_depend_on_how_a_block_is_turned() {
        // 1 m wide and 1/50 m thick along (1, 2, 2)/3.
        let turned = |x: i32, y: i32, z: i32| {
            let third = |n: i32| BigRational::new(n.into(), 150.into());
            Vec3::new(-2 * x + 2 * y + z, -x - 2 * y + 2 * z, 2 * x + y + 2 * z)
                .map(|&n| Number::from_rational(third(n)))
        };
        let corners = [(0, 0), (50, 0), (50, 50), (0, 50)];
        let vertices = [0, 1].iter().flat_map(|&z| corners.iter().map(move |&(x, y)| turned(x, y, z))).collect();
        let sides = (0..4).map(|k| vec![k, (k + 1) % 4, (k + 1) % 4 + 4, k + 4]);
        let faces: Vec<Vec<u32>> = [vec![3, 2, 1, 0], vec![4, 5, 6, 7]].into_iter().chain(sides).collect();
        let plate = Block::new(vertices, faces, &BlockOptions::default()).expect("a plate");
        assert_eq!(found(&[&plate], "1/100"), None);
        let thickness = found(&[&plate], "100000001/10000000000").expect("a warning").thickness;
        assert!((thickness - 0.02).abs() < 1e-15, "{thickness}");
    }

    #[test]
    fn a_concave_block_is_as_thick_as_the_planes_around_it() {
        // The legs of an L are 1 thick, the block between planes of 3: no point of it is 3/2 deep.
        let corners = [(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)];
        let at = |n: i32| Number::from_integer(n);
        let vertices =
            [0, 4].iter().flat_map(|&z| corners.iter().map(move |&(x, y)| Vec3::new(at(x), at(y), at(z)))).collect();
        let sides = (0..6).map(|k| vec![k, (k + 1) % 6, (k + 1) % 6 + 6, k + 6]);
        let faces: Vec<Vec<u32>> =
            [vec![5, 4, 3, 2, 1, 0], vec![6, 7, 8, 9, 10, 11]].into_iter().chain(sides).collect();
        let corner = Block::new(vertices, faces, &BlockOptions::default()).expect("an L");
        assert_eq!(found(&[&corner], "3/2"), None);
        assert_eq!(found(&[&corner], "1501/1000").expect("a warning").thickness, 3.0);
    }
}
