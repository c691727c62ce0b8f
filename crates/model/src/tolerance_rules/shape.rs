//! Blocks in f64, as estimates of what presses on what look at them.

use super::column::{box_along, dot, point};
use crate::block::Block;
use crate::topology::VertexId;

/// A block in f64.
pub(super) struct Shape<'b> {
    pub(super) points: Vec<[f64; 3]>,
    /// The faces with area.
    pub(super) faces: Vec<Face<'b>>,
    pub(super) is_convex: bool,
    /// The middle of its box, and how far a vertex is from it at most.
    pub(super) centre: [f64; 3],
    pub(super) radius: f64,
}

/// A face: its outward unit normal, its area (m²) and its loop.
pub(super) struct Face<'b> {
    pub(super) normal: [f64; 3],
    area: f64,
    corners: &'b [VertexId],
}

impl Shape<'_> {
    pub(super) fn of(block: &Block) -> Shape<'_> {
        let points: Vec<[f64; 3]> = block.vertices().iter().map(point).collect();
        let face = |corners: &'_ [VertexId]| {
            let arm = |vertex: VertexId| minus(points[vertex.index()], points[corners[0].index()]);
            let sum = corners[1..].windows(2).fold([0.0; 3], |sum: [f64; 3], pair| {
                let ([a, b, c], [x, y, z]) = (arm(pair[0]), arm(pair[1]));
                [sum[0] + b * z - c * y, sum[1] + c * x - a * z, sum[2] + a * y - b * x]
            });
            let twice = dot(sum, sum).sqrt();
            (twice > 0.0).then(|| (sum.map(|part| part / twice), twice / 2.0))
        };
        let faces = block.topology().faces().iter();
        let faces = faces
            .filter_map(|corners| {
                face(corners).map(|(normal, area)| Face { normal, area, corners: corners.as_slice() })
            })
            .collect();
        let [low, high] = box_along(points.iter().copied(), [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        let centre = std::array::from_fn(|k| f64::midpoint(low[k], high[k]));
        let radius = points.iter().map(|at| minus(*at, centre)).map(|arm| dot(arm, arm).sqrt()).fold(0.0, f64::max);
        Shape { points, faces, is_convex: block.is_convex(), centre, radius }
    }

    /// Half of what the areas of its faces are seen along a direction: the area of its plan, where it is convex, else no less (m²).
    pub(super) fn plan(&self, direction: [f64; 3]) -> f64 {
        self.faces.iter().map(|face| face.area * dot(face.normal, direction).abs()).sum::<f64>() / 2.0
    }

    /// The box of a face along three directions.
    pub(super) fn face_box(&self, face: usize, axes: [[f64; 3]; 3]) -> [[f64; 3]; 2] {
        box_along(self.faces[face].corners.iter().map(|vertex| self.points[vertex.index()]), axes)
    }
}

/// How far in front of a face the other block's nearest point is (m), where the other is in front of the face and overlaps it seen along the normal. The third direction of both boxes
/// is against the normal. In front means by no more than `within` behind the plane; with a block that is not convex whatever is ahead of the face counts.
pub(super) fn gap_ahead(face: [[f64; 3]; 2], other: [[f64; 3]; 2], are_convex: bool, within: f64) -> Option<f64> {
    let ([face_low, face_high], [low, high]) = (face, other);
    let is_in_front = if are_convex { high[2] <= face_high[2] + within } else { low[2] < face_low[2] - within };
    // What touches along an edge alone does not overlap, but for rounding.
    let overlap = |axis: usize| face_high[axis].min(high[axis]) - face_low[axis].max(low[axis]);
    let overlaps = (0..2).all(|axis| overlap(axis) > 1e-6 * (face_high[axis] - face_low[axis]));
    (is_in_front && overlaps).then(|| face_high[2] - high[2])
}

/// A box with its third direction turned round.
pub(super) fn turned([low, high]: [[f64; 3]; 2]) -> [[f64; 3]; 2] {
    [[low[0], low[1], -high[2]], [high[0], high[1], -low[2]]]
}

pub(super) fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

/// How long a vector is, also where the square of that is beyond f64.
pub(super) fn length(of: [f64; 3]) -> f64 {
    let largest = of.iter().fold(0.0_f64, |largest, part| largest.max(part.abs()));
    let of_largest = of.map(|part| part / largest);
    if largest > 0.0 && largest.is_finite() { largest * dot(of_largest, of_largest).sqrt() } else { largest }
}

/// The one whose number is the largest, of equal ones the first. A number that f64 could not work out (NaN) is beyond it, as infinity is.
pub(super) fn largest<T>(all: impl Iterator<Item = (T, f64)>) -> Option<(T, f64)> {
    let known = all.map(|(of, value)| (of, if value.is_nan() { f64::INFINITY } else { value }));
    known.reduce(|most, next| if next.1.total_cmp(&most.1).is_gt() { next } else { most })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Number, Vec3};

    #[test]
    fn plans_of_slanting_directions_are_no_boxes() {
        let at = |c: [i32; 3]| Vec3::new(c[0], c[1], c[2]).map(|&c| Number::from_integer(c));
        let block = Block::cuboid(&at([0, 0, 0]), &at([1, 2, 3])).unwrap();
        let shape = Shape::of(&block);
        assert_eq!(shape.plan([0.0, 0.0, -1.0]), 2.0);
        // A hexagon: of each pair of faces the one that is seen, (6 + 3 + 2)/√3.
        let slanting = [1.0, -1.0, 1.0].map(|part: f64| part / 3.0_f64.sqrt());
        assert!((shape.plan(slanting) - 11.0 / 3.0_f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn what_f64_does_not_hold_is_the_largest() {
        let of = |all: &[f64]| largest(all.iter().copied().enumerate());
        assert_eq!(of(&[1.0, 3.0, 3.0, 2.0]), Some((1, 3.0)));
        assert_eq!(of(&[1.0, f64::NAN, 9.0]), Some((1, f64::INFINITY)));
        assert_eq!(of(&[-f64::NAN, 9.0]), Some((0, f64::INFINITY)));
        assert_eq!(of(&[]), None);
    }
}
