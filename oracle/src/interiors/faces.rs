//! The triangles that stand for a face.
//!
//! Inside is what the triangles from the first vertex of each loop enclose. Those of a face that is not convex reach out of it
//! and lie on one another, many of them over the whole face. Where all vertices of a face are exactly in one plane, its
//! triangles may be any in this plane that together have the same boundary: two such sets of triangles differ by one without a
//! boundary, and in a plane that covers every point an even number of times, but for points on its edges. So a ray that meets
//! no edge crosses an odd number of the ones where it does of the others. To cut off one vertex after another, whichever, is
//! such a set, since the triangle of a vertex and its neighbours and what is left of the loop have the loop as boundary
//! together. Which vertex is next may therefore be asked in f64: it decides how small the triangles are, and no answer.

use super::surfaces::{Surfaces, Triangle};
use rockproof_model::VertexId;

/// The triangles of a face of a block.
pub(super) fn face_triangles(surfaces: &Surfaces, block: usize, face: &[VertexId]) -> Vec<Triangle> {
    let triangle = |corners: [VertexId; 3]| surfaces.triangle(block, corners);
    let fan: Vec<Triangle> = face[1..].windows(2).filter_map(|two| triangle([face[0], two[0], two[1]])).collect();
    let Some(first) = fan.first() else { return fan };
    let is_along = |other: &Triangle| first.normal().dot(other.normal()).middle > 0.0;
    let reaches_out = fan.len() > 1 && !fan.iter().all(is_along);
    if !reaches_out || face.iter().any(|&v| !surfaces.side(first, block, v).is_zero()) {
        return fan;
    }
    let normal = first.normal().components().map(|c| c.middle);
    let axis = (0..3).max_by(|&i, &j| normal[i].abs().total_cmp(&normal[j].abs())).unwrap_or(0);
    let flat = |v: &VertexId| {
        let place = surfaces.near_vertex(block, *v).components();
        [place[(axis + 1) % 3].middle, place[(axis + 2) % 3].middle]
    };
    let flat: Vec<[f64; 2]> = face.iter().map(flat).collect();
    cut_ears(&flat).into_iter().filter_map(|corners| triangle(corners.map(|k| face[k]))).collect()
}

/// Twice the area of a triangle, above zero where it goes round counter-clockwise.
fn area([a, b, c]: [[f64; 2]; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Triangles of a polygon's corners that together have its boundary: corners are cut off one after another. If one can be cut
/// off so that the triangle is within the polygon, as f64 sees it, such a one is next, and after it not its neighbour, so that
/// triangles stay small; else any.
fn cut_ears(points: &[[f64; 2]]) -> Vec<[usize; 3]> {
    let around: f64 = (1..points.len() - 1).map(|k| area([points[0], points[k], points[k + 1]])).sum();
    let turn = |corners: [usize; 3]| around.signum() * area(corners.map(|k| points[k]));
    let mut left: Vec<usize> = (0..points.len()).collect();
    let mut triangles = Vec::with_capacity(points.len() - 2);
    while left.len() > 3 {
        let count = left.len();
        let at = |place: usize| [left[(place + count - 1) % count], left[place], left[(place + 1) % count]];
        let reflex: Vec<usize> = (0..count).map(at).filter(|&corners| turn(corners) < 0.0).map(|[_, v, _]| v).collect();
        let is_ear = |corners: [usize; 3]| {
            let [a, b, c] = corners;
            let holds = |&v: &usize| {
                !corners.contains(&v) && [[a, b, v], [b, c, v], [c, a, v]].into_iter().all(|edge| turn(edge) >= 0.0)
            };
            // A corner in line with its neighbours has no triangle to it.
            turn(corners) == 0.0 || turn(corners) > 0.0 && !reflex.iter().any(holds)
        };
        let mut kept = Vec::with_capacity(count);
        let (mut place, mut most) = (0, count - 3);
        while place < count {
            // Its neighbours stay in this round, but for the first corner, which the last has as a neighbour.
            let is_free = place + 1 < count || kept.first() == Some(&left[0]);
            if most > 0 && is_free && is_ear(at(place)) {
                triangles.push(at(place));
                most -= 1;
                kept.extend(left.get(place + 1));
                place += 2;
            } else {
                kept.push(left[place]);
                place += 1;
            }
        }
        if kept.len() == count {
            triangles.push(at(0));
            kept.remove(0);
        }
        left = kept;
    }
    if let [a, b, c] = left[..] {
        triangles.push([a, b, c]);
    }
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// The edges that an odd number of loops have.
    fn boundary<const N: usize>(loops: &[[usize; N]]) -> BTreeSet<[usize; 2]> {
        let mut odd = BTreeSet::new();
        for corners in loops {
            for k in 0..N {
                let (p, q) = (corners[k], corners[(k + 1) % N]);
                let edge = [p.min(q), p.max(q)];
                if !odd.remove(&edge) {
                    odd.insert(edge);
                }
            }
        }
        odd
    }

    /// Whatever the polygon, if it passes through itself as well.
    #[test]
    fn what_is_cut_off_has_the_boundary_of_the_polygon() {
        let mut state = 1u64;
        let mut below = |end: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((state >> 33) % end) as f64
        };
        for _ in 0..300 {
            let points: [[f64; 2]; 9] = std::array::from_fn(|_| [below(5), below(5)]);
            let all: [usize; 9] = std::array::from_fn(|k| k);
            let triangles = cut_ears(&points);
            assert_eq!(triangles.len(), 7);
            assert_eq!(boundary(&triangles), boundary(&[all]), "{points:?}");
        }
    }

    #[test]
    fn triangles_of_a_staircase_are_within_it_and_none_but_a_few_are_long() {
        let steps = 64;
        let stairs = (0..steps).rev().flat_map(|k| [[k + 1, k + 1], [k, k + 1]]);
        let corners = [[0, 0], [steps, 0]].into_iter().chain(stairs);
        for turn in [1.0, -1.0] {
            let points: Vec<[f64; 2]> = corners.clone().map(|[x, y]| [f64::from(x), turn * f64::from(y)]).collect();
            let areas = cut_ears(&points).into_iter().map(|corners| area(corners.map(|k| points[k])) * turn);
            let areas: Vec<f64> = areas.collect();
            assert!(areas.iter().all(|&area| area >= 0.0), "{areas:?}");
            assert_eq!(areas.iter().sum::<f64>(), f64::from(steps * (steps + 1)));
            assert!(areas.iter().filter(|&&area| area > 2.0).count() < 10, "{areas:?}");
        }
    }
}
