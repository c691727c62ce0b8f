//! The lengths of a model that rules are about: calculated exactly of those blocks alone whose lengths f64 cannot tell from the extreme one.

use super::LengthLocation;
use super::largest::{factor, may_be_largest, may_be_least};
use crate::block::Block;
use crate::number::Number;
use crate::topology::{Edge, VertexId};
use crate::vector::Vec3;
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive};

/// The lengths of a model that rules are about, exactly; lengths squared, in m².
pub(super) struct Extremes {
    pub(super) shortest_squared: BigRational,
    pub(super) shortest: LengthLocation,
    pub(super) longest_squared: BigRational,
    pub(super) longest: LengthLocation,
    pub(super) radius_squared: BigRational,
    pub(super) widest: LengthLocation,
    pub(super) largest_coordinate: BigRational,
    pub(super) furthest: LengthLocation,
}

/// A length squared (m²) and where it is.
type Place = (BigRational, LengthLocation);

impl Extremes {
    /// `None` without blocks. **Of equal lengths the first**, so that the place named does not depend on chance.
    pub(super) fn of(blocks: &[&Block]) -> Option<Extremes> {
        let near: Vec<[f64; 2]> = blocks.iter().map(|block| near_edges(block)).collect();
        let [shortest_near, longest_near] = [0, 1].map(|end| near.iter().map(|ends| ends[end]).collect::<Vec<_>>());
        let radii_near: Vec<f64> = blocks.iter().map(|block| SquaredRadius::of(block).near()).collect();
        let shortest = may_be_least(&shortest_near).filter_map(|block| shortest_edge(blocks[block], block));
        let longest = may_be_largest(&longest_near).filter_map(|block| longest_edge(blocks[block], block));
        let radii = may_be_largest(&radii_near)
            .map(|block| (SquaredRadius::of(blocks[block]).exact(), LengthLocation { block, edge: None }));
        let (shortest_squared, shortest) =
            shortest.reduce(|least, next| if next.0 < least.0 { next } else { least })?;
        let larger = |most: Place, next: Place| if next.0 > most.0 { next } else { most };
        let (longest_squared, longest) = longest.reduce(larger)?;
        let (radius_squared, widest) = radii.reduce(larger)?;
        let (largest_coordinate, furthest) = largest_coordinate(blocks)?;
        Some(Extremes {
            shortest_squared,
            shortest,
            longest_squared,
            longest,
            radius_squared,
            widest,
            largest_coordinate,
            furthest,
        })
    }
}

/// The squares of a block's shortest and longest edge (m²) within eight roundoffs of themselves; NaN where coordinates are not known so well.
fn near_edges(block: &Block) -> [f64; 2] {
    let known = |number: &Number| number.as_f64().unwrap_or(f64::NAN);
    let points: Vec<[f64; 3]> = block.vertices().iter().map(|v| v.components().map(known)).collect();
    let squared = |edge: &Edge| {
        let [p, q] = [edge.p, edge.q].map(|end| points[end.index()]);
        factor([0, 1, 2].map(|axis| (q[axis] - p[axis]) * (q[axis] - p[axis])).iter().sum())
    };
    // `f64::min` would drop what is not known.
    block.topology().edges().iter().map(squared).fold([f64::INFINITY, 0.0], |[least, most], squared| {
        if squared.is_nan() || least.is_nan() { [f64::NAN; 2] } else { [least.min(squared), most.max(squared)] }
    })
}

/// The square of an edge on its block's lattice, and its ends.
type UnitEdge = (BigInt, (VertexId, VertexId));

/// A block's edges, and a squared unit of its lattice in m².
fn edges(block: &Block) -> (Vec<UnitEdge>, BigRational) {
    // A lattice of its own for every block: one for all could need the product of all denominators.
    let (lattice, points) = block.lattice_points();
    let (numerator, denominator) = lattice.units_per_metre();
    let metres = BigRational::new(denominator, numerator);
    let squared = |edge: &Edge| points[edge.q.index()].minus(&points[edge.p.index()]).norm_squared();
    let all = block.topology().edges().iter().map(|edge| (squared(edge), (edge.p, edge.q))).collect();
    (all, &metres * &metres)
}

fn shortest_edge(shape: &Block, block: usize) -> Option<Place> {
    let (edges, unit) = edges(shape);
    let (squared, ends) = edges.into_iter().min()?;
    Some((BigRational::from_integer(squared) * unit, LengthLocation { block, edge: Some(ends) }))
}

fn longest_edge(shape: &Block, block: usize) -> Option<Place> {
    let (edges, unit) = edges(shape);
    let (squared, ends) = edges.into_iter().max_by(|a, b| a.0.cmp(&b.0).then(b.1.cmp(&a.1)))?;
    Some((BigRational::from_integer(squared) * unit, LengthLocation { block, edge: Some(ends) }))
}

/// The coordinate of largest magnitude (m), and whose it is.
fn largest_coordinate(blocks: &[&Block]) -> Option<Place> {
    let magnitude = |c: &Number| if c.is_negative() { c.negated() } else { c.clone() };
    let of_block = |(block, shape): (usize, &&Block)| Some((shape.coordinates().map(magnitude).max()?, block));
    let all = blocks.iter().enumerate().filter_map(of_block);
    let (largest, block) = all.reduce(|most, next| if next.0 > most.0 { next } else { most })?;
    Some((largest.to_rational(), LengthLocation { block, edge: None }))
}

/// The square of the largest distance of a vertex from the centroid, as parts of one fraction.
struct SquaredRadius {
    /// In units of the lattice, times the square of `weight`.
    furthest: BigInt,
    /// Above zero.
    weight: BigInt,
    /// A metre is so many units over `denominator`.
    numerator: BigInt,
    denominator: BigInt,
}

impl SquaredRadius {
    fn of(block: &Block) -> SquaredRadius {
        let (lattice, points) = block.lattice_points();
        let (numerator, denominator) = lattice.units_per_metre();
        let moments = block.moments();
        let weight = &moments.six_volumes * BigInt::from(4);
        let distance = |p: &Vec3<BigInt>| p.minus(&points[0]).scaled(&weight).minus(&moments.sum).norm_squared();
        let furthest = points.iter().map(distance).max().unwrap_or_default();
        let weight = if weight.is_positive() { weight } else { BigInt::from(1) };
        SquaredRadius { furthest, weight, numerator, denominator }
    }

    /// In m², within fourteen roundoffs of itself; NaN where f64 does not know it so well.
    fn near(&self) -> f64 {
        let known = |value: f64| if (1e-150..1e150).contains(&value) { value } else { f64::NAN };
        let [furthest, weight, numerator, denominator] =
            [&self.furthest, &self.weight, &self.numerator, &self.denominator]
                .map(|part| part.to_f64().unwrap_or(f64::NAN));
        let [weight, metres] = [known(weight), known(known(denominator) / known(numerator))];
        let units_squared = known(furthest / (weight * weight));
        factor(units_squared * (metres * metres))
    }

    /// In m².
    fn exact(&self) -> BigRational {
        let unit = BigRational::new(self.denominator.clone(), self.numerator.clone());
        BigRational::new(self.furthest.clone(), &self.weight * &self.weight) * &unit * &unit
    }
}
