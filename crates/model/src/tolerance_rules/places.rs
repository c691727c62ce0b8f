//! Blocks by where they are, so that those near one are found without a look at all.

use super::shape::Shape;
use std::collections::BTreeMap;

/// The blocks by the cells of a grid that their centres are in.
pub(super) struct Places {
    /// The side of a cell (m).
    side: f64,
    /// No block in a cell has a larger radius (m).
    pub(super) radius: f64,
    cells: BTreeMap<[i64; 3], Vec<usize>>,
    /// Blocks that are much larger than most.
    large: Vec<usize>,
}

impl Places {
    pub(super) fn of(shapes: &[Shape<'_>]) -> Places {
        let mut radii: Vec<f64> = shapes.iter().map(|shape| shape.radius).collect();
        radii.sort_by(f64::total_cmp);
        let radius = 2.0 * radii.get(radii.len() / 2).copied().unwrap_or(0.0);
        let mut places = Places { side: 4.0 * radius, radius, cells: BTreeMap::new(), large: Vec::new() };
        for (block, shape) in shapes.iter().enumerate() {
            // Beyond f64 nothing has a cell.
            let is_small = shape.radius <= radius && places.side.is_finite() && places.side > 0.0;
            if is_small && shape.centre.iter().all(|part| part.is_finite()) {
                places.cells.entry(places.cell(shape.centre)).or_default().push(block);
            } else {
                places.large.push(block);
            }
        }
        places
    }

    fn cell(&self, at: [f64; 3]) -> [i64; 3] {
        at.map(|part| (part / self.side).floor() as i64)
    }

    /// All large blocks, and those others whose centre may be within a distance of a point.
    pub(super) fn near(&self, at: [f64; 3], distance: f64) -> impl Iterator<Item = usize> + '_ {
        // Roundings of these are a few parts in 2⁵³.
        let slack = at.map(|part| distance + 1e-12 * (distance + part.abs()));
        let low = self.cell(std::array::from_fn(|k| at[k] - slack[k]));
        let high = self.cell(std::array::from_fn(|k| at[k] + slack[k]));
        let is_between = move |cell: &[i64; 3]| (0..3).all(|k| (low[k]..=high[k]).contains(&cell[k]));
        let count = (0..3)
            .fold(1_i64, |count, k| count.saturating_mul(high[k].saturating_sub(low[k]).saturating_add(1).max(0)));
        let listed: Box<dyn Iterator<Item = &Vec<usize>>> =
            if usize::try_from(count).is_ok_and(|count| count < self.cells.len()) {
                let rows = (low[0]..=high[0]).flat_map(move |x| (low[1]..=high[1]).map(move |y| [x, y]));
                Box::new(
                    rows.flat_map(move |[x, y]| self.cells.range([x, y, low[2]]..=[x, y, high[2]]))
                        .map(|(_, blocks)| blocks),
                )
            } else {
                Box::new(self.cells.iter().filter(move |(cell, _)| is_between(cell)).map(|(_, blocks)| blocks))
            };
        listed.flatten().chain(&self.large).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape(centre: [f64; 3], radius: f64) -> Shape<'static> {
        Shape { points: Vec::new(), faces: Vec::new(), is_convex: true, centre, radius }
    }

    #[test]
    fn those_near_a_point_are_few_and_none_is_missing() {
        // A cube of 8,000 places 2 m apart, off the origin, and one large block far from all.
        let number = |k: i32| [k % 20, k / 20 % 20, k / 400].map(|c| 2.0 * f64::from(c) - 7.0);
        let mut shapes: Vec<Shape<'_>> = (0..8000).map(|k| shape(number(k), 1.0)).collect();
        shapes.push(shape([1e6; 3], 500.0));
        let places = Places::of(&shapes);
        for (at, distance) in [([0.0; 3], 5.0), ([-7.0, 31.0, 4.5], 6.0), ([10.0; 3], 100.0), ([-80.0; 3], 3.0)] {
            let near: Vec<usize> = places.near(at, distance).collect();
            let is_within = |block: &usize| {
                let square: f64 = (0..3).map(|k| (shapes[*block].centre[k] - at[k]).powi(2)).sum();
                square <= distance * distance
            };
            assert!((0..8000).filter(is_within).all(|block| near.contains(&block)), "{at:?}");
            assert!(near.contains(&8000));
            assert!(near.len() < 3000 || distance > 50.0, "{at:?}: {}", near.len());
        }
    }

    #[test]
    fn what_f64_does_not_hold_is_always_near() {
        let places = Places::of(&[shape([f64::INFINITY; 3], f64::NAN), shape([0.0; 3], 0.0)]);
        assert_eq!(places.near([0.0; 3], 1.0).collect::<Vec<_>>(), [0, 1]);
    }
}
