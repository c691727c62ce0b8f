//! A block cut into convex cells, exactly: where the depth of an overlap is looked for that neither vertices nor edges show.
//!
//! The block's box is cut by the plane of one triangle of the surface, each half by the plane of another triangle that
//! passes through it, and so on until no triangle passes through a cell (a binary space partition, H. Fuchs, Z. M. Kedem
//! and B. F. Naylor, 1980). An open cell does not meet the surface, so it is inside the block or outside as its middle is.
//! The cells inside fill the block but for planes, so that the interiors of two blocks meet exactly when those of a cell of
//! each do: their common part is open, and open sets do not fit into planes.

use crate::point_in_surface::{surface_holds_origin, triangles};
use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::Zero;
use rockproof_model::ring::ExactRing;
use rockproof_model::{Block, Number, Sign, Vec3};

type RationalPoint = Vec3<BigRational>;

/// A convex polyhedron by its polygons, in m; their sense of rotation means nothing.
#[derive(Clone, Debug)]
pub(crate) struct ConvexCell {
    polygons: Vec<Vec<RationalPoint>>,
}

/// The plane `n·x = offset`.
struct Plane {
    n: RationalPoint,
    offset: BigRational,
}

/// The convex cells that fill a block; its inside is that of its faces' triangles from the first vertex of each loop.
pub(crate) fn cells(block: &Block) -> Vec<ConvexCell> {
    let vertices: Vec<RationalPoint> = block.vertices().iter().map(|v| v.map(Number::to_rational)).collect();
    let surface: Vec<[RationalPoint; 3]> =
        triangles(block, &vertices).map(|corners| corners.map(Clone::clone)).collect();
    let bounds = block.bounds();
    let ends = [bounds.min, bounds.max].map(|end| end.map(|c| c.to_rational()));
    let mut leaves = Vec::new();
    cut(ConvexCell::of_box(&ends), surface.iter().map(|t| t.to_vec()).collect(), &mut leaves);
    leaves.retain(|cell| {
        let middle = cell.middle();
        let around: Vec<_> = surface.iter().map(|t| t.clone().map(|p| p.minus(&middle))).collect();
        surface_holds_origin(&around)
    });
    leaves
}

/// Cuts a cell until none of the polygons passes through a part of it.
fn cut(cell: ConvexCell, mut polygons: Vec<Vec<RationalPoint>>, leaves: &mut Vec<ConvexCell>) {
    while let Some(polygon) = polygons.pop() {
        let Some(plane) = Plane::of(&polygon) else { continue };
        // A polygon on the cell's own surface does not pass through it.
        let Some((below, above)) = cell.split(&plane) else { continue };
        let part = |plane: &Plane| polygons.iter().filter_map(|p| plane.part_below(p)).collect();
        cut(below, part(&plane), leaves);
        cut(above, part(&plane.reversed()), leaves);
        return;
    }
    leaves.push(cell);
}

impl Plane {
    /// The plane of a convex polygon; `None` where its points are in line.
    fn of(polygon: &[RationalPoint]) -> Option<Plane> {
        let first = &polygon[0];
        let n = polygon[1..]
            .windows(2)
            .map(|two| two[0].minus(first).cross(&two[1].minus(first)))
            .find(|n| !Zero::is_zero(&n.norm_squared()))?;
        Some(Plane { offset: n.dot(first), n })
    }

    fn reversed(&self) -> Plane {
        Plane { n: self.n.negated(), offset: -&self.offset }
    }

    fn value(&self, point: &RationalPoint) -> BigRational {
        self.n.dot(point) - &self.offset
    }

    /// The part of a convex polygon below the plane, its boundary on the plane included; `None` where no point is strictly
    /// below.
    fn part_below(&self, polygon: &[RationalPoint]) -> Option<Vec<RationalPoint>> {
        let values: Vec<BigRational> = polygon.iter().map(|p| self.value(p)).collect();
        let signs: Vec<Sign> = values.iter().map(ExactRing::sign).collect();
        if !signs.contains(&Sign::Negative) {
            return None;
        }
        let mut part = Vec::with_capacity(polygon.len() + 1);
        for i in 0..polygon.len() {
            let j = (i + 1) % polygon.len();
            if signs[i].is_at_most_zero() {
                part.push(polygon[i].clone());
            }
            if signs[i].times(signs[j]).is_negative() {
                let share = &values[i] / (&values[i] - &values[j]);
                part.push(polygon[i].plus(&polygon[j].minus(&polygon[i]).scaled(&share)));
            }
        }
        Some(part)
    }
}

impl ConvexCell {
    fn of_box([low, high]: &[RationalPoint; 2]) -> ConvexCell {
        let corner = |k: usize| {
            let pick = |bit: usize, low: &BigRational, high: &BigRational| {
                if k >> bit & 1 == 0 { low.clone() } else { high.clone() }
            };
            Vec3::new(pick(0, &low.x, &high.x), pick(1, &low.y, &high.y), pick(2, &low.z, &high.z))
        };
        let loops = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
        ConvexCell { polygons: loops.map(|l| l.map(corner).to_vec()).into() }
    }

    pub(crate) fn vertices(&self) -> Vec<RationalPoint> {
        let mut all: Vec<RationalPoint> = Vec::new();
        for point in self.polygons.iter().flatten() {
            if !all.contains(point) {
                all.push(point.clone());
            }
        }
        all
    }

    /// The mean of the vertices: strictly inside.
    pub(crate) fn middle(&self) -> RationalPoint {
        let all = self.vertices();
        let sum = all.iter().fold(Vec3::zero(), |sum: RationalPoint, p| sum.plus(p));
        sum.map(|c| c / BigInt::from(all.len()))
    }

    /// The cell's parts below and above a plane; `None` where it does not pass through the cell. **Touching is not
    /// passing.**
    fn split(&self, plane: &Plane) -> Option<(ConvexCell, ConvexCell)> {
        let signs: Vec<Sign> = self.polygons.iter().flatten().map(|p| plane.value(p).sign()).collect();
        if !signs.contains(&Sign::Negative) || !signs.contains(&Sign::Positive) {
            return None;
        }
        let half = |plane: &Plane| {
            let mut polygons: Vec<Vec<RationalPoint>> =
                self.polygons.iter().filter_map(|p| plane.part_below(p)).collect();
            let cap = plane.cap(&polygons);
            polygons.push(cap);
            ConvexCell { polygons }
        };
        Some((half(plane), half(&plane.reversed())))
    }

    /// What two cells share; `None` where their interiors do not meet.
    pub(crate) fn common(&self, other: &ConvexCell) -> Option<ConvexCell> {
        let middle = other.middle();
        let mut common = self.clone();
        for plane in other.polygons.iter().filter_map(|p| Plane::of(p)) {
            let plane = if plane.value(&middle).sign().is_negative() { plane } else { plane.reversed() };
            match common.split(&plane) {
                Some((below, _)) => common = below,
                None if common.polygons.iter().flatten().any(|p| plane.value(p).sign().is_negative()) => {}
                None => return None,
            }
        }
        Some(common)
    }
}

impl Plane {
    /// The polygon in which the plane passes through a convex cell, from the corners that its parts have on the plane.
    fn cap(&self, polygons: &[Vec<RationalPoint>]) -> Vec<RationalPoint> {
        let mut corners: Vec<RationalPoint> = Vec::new();
        for point in polygons.iter().flatten() {
            if self.value(point).is_zero() && !corners.contains(point) {
                corners.push(point.clone());
            }
        }
        // Seen from the first corner in lexicographic order, all others lie within less than half a turn.
        corners.sort_by(|p, q| p.components().cmp(&q.components()));
        let first = corners[0].clone();
        corners[1..].sort_by(|p, q| {
            let turn = self.n.dot(&p.minus(&first).cross(&q.minus(&first)));
            BigRational::zero().cmp(&turn)
        });
        corners
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The one cell of a box between two corners given in halves.
    fn cell(low: [i32; 3], high: [i32; 3]) -> ConvexCell {
        let half = Number::from_f64(0.5).unwrap();
        let at = |[x, y, z]: [i32; 3]| Vec3::new(x, y, z).map(|&c| Number::from_integer(c).times(&half));
        let cells = cells(&Block::cuboid(&at(low), &at(high)).unwrap());
        assert_eq!(cells.len(), 1);
        cells.into_iter().next().unwrap()
    }

    #[test]
    fn cells_share_something_only_where_their_interiors_meet() {
        let unit = cell([0, 0, 0], [2, 2, 2]);
        for axis in 0..3 {
            let shifted = |by: i32| {
                let moved = |c: i32| std::array::from_fn(|k| if k == axis { c + by } else { c });
                cell(moved(0), moved(2))
            };
            for by in [-4, -3, -2, 2, 3, 4] {
                let other = shifted(by);
                let shared = unit.common(&other).is_some() || other.common(&unit).is_some();
                assert!(!shared, "touching or apart along axis {axis}, by {by} halves");
            }
            for by in [-1, 0, 1] {
                let other = shifted(by);
                let quarters = |c: i32| BigRational::new(c.into(), 4.into());
                // The middle of [max(0, by), min(2, 2 + by)] halves, in quarters.
                let middle = |k: usize| quarters(if k == axis { by.max(0) + 2.min(2 + by) } else { 2 });
                for common in [unit.common(&other), other.common(&unit)] {
                    assert_eq!(common.unwrap().middle(), Vec3::new(middle(0), middle(1), middle(2)));
                }
            }
        }
        // Apart along no single axis by more than the others: corner to corner.
        assert!(unit.common(&cell([2, 2, 2], [4, 4, 4])).is_none());
    }
}
