//! How two convex blocks lie to one another, exactly: apart, touching or overlapping, and by how much.
//!
//! The blocks meant are the convex hulls of the given vertices, as a collision code that is handed points sees them: a
//! face that rounding made slightly non-planar is then part of the hull's surface.
//!
//! The separating axis theorem gives the sign: of all normals of faces and all cross products of two edges, the largest
//! separation is positive for blocks that are apart, **zero for blocks that touch**, negative for those that overlap. When
//! they overlap, the least of these overlaps is the shortest translation that separates them (Cameron and Culley 1986:
//! the facets of the Minkowski difference have these normals). When they are apart, the distance is the widest slab
//! between them, and the directions of the widest slab are those above or those between a vertex and the nearest point
//! of a vertex or an edge.

use super::hull_pair::{Hull, HullPair};
use super::slab::{Direction, Slab};
use crate::separation_state::SeparationState;
use num_rational::BigRational;
use num_traits::Zero;
use rockproof_model::lattice::Lattice;
use rockproof_model::ring::ExactRing;
use rockproof_model::{Block, Sign, Vec3};
use rockproof_oracle::rational::Rational;

/// How two convex blocks lie to one another.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Separation {
    /// Apart, touching or overlapping.
    pub state: SeparationState,
    /// The square of the distance, or of the depth: the length of the shortest translation that separates them (m²).
    pub squared: BigRational,
}

impl Separation {
    /// The distance, or minus the depth: the nearest f64 (m).
    pub fn gap_m(&self) -> f64 {
        let size = self.squared.sqrt_rounded().unwrap_or(f64::MAX);
        if self.state == SeparationState::Overlapping { -size } else { size }
    }

    /// The separation of two blocks, or `None` where one is not convex or has too many vertices, or where its points have
    /// no volume left.
    pub fn of(a: &Block, b: &Block) -> Option<Separation> {
        if !(a.is_convex() && b.is_convex()) {
            return None;
        }
        let lattice = Lattice::covering(a.coordinates().chain(b.coordinates()));
        let pair = HullPair::new(Hull::of(a, &lattice)?, Hull::of(b, &lattice)?);
        let widest = pair.widest(Direction::across_features(&pair))?;
        let widest = if ExactRing::sign(&widest.width).is_positive() {
            // Apart: a slab between two vertices, or a vertex and an edge, may be wider still.
            pair.widest(Direction::across_points(&pair)).into_iter().fold(widest, Slab::wider)
        } else {
            widest
        };
        let state = match ExactRing::sign(&widest.width) {
            Sign::Positive => SeparationState::Apart,
            Sign::Zero => SeparationState::Touching,
            Sign::Negative => SeparationState::Overlapping,
        };
        let (units, metres) = lattice.units_per_metre();
        let numerator = &widest.width * &widest.width * &metres * &metres;
        Some(Separation { state, squared: BigRational::new(numerator, widest.length2 * &units * &units) })
    }
}

/// Whether moving along `normal` does what a collision normal promises: apart, the blocks leave a slab across it that is
/// no narrower than the distance, by more than `slack_m`; else moving A along it by the depth and `slack_m` separates them. The blocks
/// are taken as they are given, the normal from B to A, of any length but zero.
pub fn normal_separates(a: &Block, b: &Block, normal: [f64; 3], gap_m: f64, slack_m: f64) -> bool {
    let Some(normal) = rational_vector(normal) else { return false };
    let along = |block: &Block| -> Vec<BigRational> {
        block.vertices().iter().map(|v| v.map(|c| c.to_rational()).dot(&normal)).collect()
    };
    let (Some(low), Some(high)) = (along(a).into_iter().min(), along(b).into_iter().max()) else { return false };
    let Some(bound) = BigRational::from_float(gap_m - slack_m) else { return false };
    // width ≥ bound·|normal|, by the squares with their signs.
    let width = low - high;
    let length2 = normal.dot(&normal);
    !length2.is_zero() && width.signed_square() >= bound.signed_square() * length2
}

fn rational_vector([x, y, z]: [f64; 3]) -> Option<Vec3<BigRational>> {
    let number = BigRational::from_float;
    Some(Vec3::new(number(x)?, number(y)?, number(z)?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hull::convex_hull;
    use rockproof_model::{BlockOptions, Number, Point};

    fn number(value: f64) -> Number {
        Number::from_f64(value).expect("finite")
    }

    fn block(points: &[[f64; 3]]) -> Block {
        let points: Vec<Point> = points.iter().map(|p| Point::new(number(p[0]), number(p[1]), number(p[2]))).collect();
        convex_hull(&points).expect("a block")
    }

    fn cuboid(min: [f64; 3], max: [f64; 3]) -> Block {
        let corner = |n: usize| [0, 1, 2].map(|axis| if n >> axis & 1 == 0 { min[axis] } else { max[axis] });
        block(&(0..8).map(corner).collect::<Vec<_>>())
    }

    fn gap(a: &Block, b: &Block) -> (SeparationState, f64) {
        let there = Separation::of(a, b).expect("convex");
        let back = Separation::of(b, a).expect("convex");
        assert_eq!(there, back, "exchanging the blocks changes nothing");
        (there.state, there.gap_m())
    }

    #[test]
    fn cubes_are_as_far_as_they_are() {
        let unit = cuboid([0.0; 3], [1.0; 3]);
        let at = |x: f64, y: f64, z: f64| cuboid([x, y, z], [x + 1.0, y + 1.0, z + 1.0]);
        assert_eq!(gap(&unit, &at(0.25, 0.5, 2.0)), (SeparationState::Apart, 1.0), "face to face");
        assert_eq!(gap(&unit, &at(0.25, 4.0, 5.0)), (SeparationState::Apart, 5.0), "edge to edge: 3, 4, 5");
        assert_eq!(gap(&unit, &at(3.0, 3.0, 2.0)), (SeparationState::Apart, 3.0), "corner to corner: 2, 2, 1, 3");
        assert_eq!(gap(&unit, &at(0.25, 0.5, 1.0)), (SeparationState::Touching, 0.0));
        assert_eq!(gap(&unit, &at(1.0, 1.0, 1.0)), (SeparationState::Touching, 0.0), "corner on corner");
        assert_eq!(gap(&unit, &at(0.5, 0.5, 0.75)), (SeparationState::Overlapping, -0.25));
        let tiny = f64::MIN_POSITIVE;
        assert_eq!(gap(&unit, &cuboid([0.0, 0.0, -1.0], [1.0, 1.0, -tiny])), (SeparationState::Apart, tiny));
    }

    #[test]
    fn crossing_edges_overlap_by_their_common_perpendicular() {
        // Two prisms, ridge on ridge at right angles: A's ridge along x at z = 0, B's along y at z = depth.
        let a = block(&[
            [-4.0, -1.0, 1.0],
            [4.0, -1.0, 1.0],
            [-4.0, 1.0, 1.0],
            [4.0, 1.0, 1.0],
            [-4.0, 0.0, 0.0],
            [4.0, 0.0, 0.0],
        ]);
        let below = |depth: f64| {
            let z = depth - 1.0;
            block(&[
                [-1.0, -4.0, z],
                [-1.0, 4.0, z],
                [1.0, -4.0, z],
                [1.0, 4.0, z],
                [0.0, -4.0, depth],
                [0.0, 4.0, depth],
            ])
        };
        assert_eq!(gap(&a, &below(0.125)), (SeparationState::Overlapping, -0.125));
        assert_eq!(gap(&a, &below(0.0)), (SeparationState::Touching, 0.0));
        assert_eq!(gap(&a, &below(-0.5)), (SeparationState::Apart, 0.5));
    }

    #[test]
    fn a_vertex_may_be_nearest_to_an_edge() {
        let wedge = block(&[
            [0.0, -1.0, 0.0],
            [0.0, 1.0, 0.0],
            [-2.0, -1.0, 1.0],
            [-2.0, 1.0, 1.0],
            [-2.0, -1.0, -1.0],
            [-2.0, 1.0, -1.0],
        ]);
        let spike = block(&[[3.0, 0.0, 4.0], [9.0, 1.0, 5.0], [9.0, -1.0, 5.0], [9.0, 0.0, 4.5]]);
        assert_eq!(gap(&wedge, &spike), (SeparationState::Apart, 5.0));
    }

    #[test]
    fn normals_are_judged_by_what_they_do() {
        let (low, high) = (cuboid([0.0; 3], [1.0; 3]), cuboid([0.0, 0.0, 1.5], [1.0, 1.0, 2.0]));
        let serves = |normal, gap, slack| normal_separates(&high, &low, normal, gap, slack);
        assert!(serves([0.0, 0.0, 1.0], 0.5, 0.0) && serves([0.0, 0.0, 3.0], 0.5, 0.0));
        assert!(!serves([0.0, 0.0, -1.0], 0.5, 0.0), "from A to B");
        assert!(!serves([0.0, 0.0, 0.0], 0.5, 9.0), "no direction at all");
        assert!(!serves([0.0, 0.1, 1.0], 0.5, 1e-3) && serves([0.0, 0.1, 1.0], 0.5, 0.2), "askew");
        let deep = cuboid([0.0, 0.0, 0.75], [1.0, 1.0, 2.0]);
        assert!(normal_separates(&deep, &low, [0.0, 0.0, 1.0], -0.25, 0.0));
        assert!(!normal_separates(&deep, &low, [1.0, 0.0, 0.0], -0.25, 0.5), "sideways takes a metre");
    }

    #[test]
    fn faces_bent_by_rounding_are_hulls() {
        // A cube whose top has one corner a step too high: the hull's top is two triangles, and the corner is the highest point.
        let up = 1.0f64.next_up();
        let points = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [1.0, 1.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
            [1.0, 0.0, 1.0],
            [1.0, 1.0, up],
            [0.0, 1.0, 1.0],
        ];
        let faces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
        let points = points.map(|p| Point::new(number(p[0]), number(p[1]), number(p[2]))).to_vec();
        let options = BlockOptions { planarity: number(1e-9) };
        let bent = Block::new(points, faces.map(|f| f.to_vec()).to_vec(), &options).expect("planar enough");
        let above = cuboid([0.5, 0.5, up], [2.0, 2.0, 3.0]);
        assert_eq!(gap(&bent, &above), (SeparationState::Touching, 0.0), "the corner touches");
        let beside = cuboid([-1.0, -1.0, up], [0.5, 0.5, 3.0]);
        assert_eq!(gap(&bent, &beside).0, SeparationState::Apart, "elsewhere the top is lower");
    }
}
