//! Where points are looked for that lie deep in two blocks at once, in f64: what the blocks share is cut into convex cells, and the middles of
//! those in both are proposed.
//!
//! The box that the blocks' boxes share is cut by the plane of one triangle of a surface, each half by that of another one that passes through it, and so
//! on, as [`crate::convex_cells`] cuts one block exactly. A triangle that reaches into a cell by less than [`NARROW`] of the largest coordinate does not cut it: surfaces that
//! differ by rounding make no cells of their own. **Nothing is decided here**: whether a proposed point is inside, and how deep, is asked exactly.

use crate::f64_vector::{cross, dot};
use crate::point_in_surface::triangle_corners;
use rockproof_model::Block;
use std::cmp::Ordering;

type Point = [f64; 3];
type Polygon = Vec<Point>;

/// Over the largest coordinate: what reaches into a cell by less does not cut it, and what blocks share is not cut where it is no more than twice as wide.
const NARROW: f64 = 1.0 / (1u64 << 42) as f64;

/// A plane `n·x = offset` with n of length 1.
#[derive(Clone)]
struct Plane {
    n: Point,
    offset: f64,
}

/// A convex polyhedron by its polygons.
struct Cell(Vec<Polygon>);

/// The middles of the convex cells into which both surfaces cut what the boxes of two blocks share (m). Empty where that is narrow. The same whichever
/// block comes first.
pub(super) fn middles(blocks: [&Block; 2]) -> Vec<Point> {
    let mut seen = blocks.map(|block| {
        let points = block.vertices().iter().map(|v| v.components().map(|c| c.approximate()));
        (points.collect::<Vec<Point>>(), triangle_corners(block).collect::<Vec<_>>())
    });
    seen.sort_by(|one, two| one.partial_cmp(two).unwrap_or(Ordering::Equal));
    let points = seen.each_ref().map(|(points, _)| points);
    // From the middle of the shared box, so that little is lost to its distance from the origin.
    let [low, high] = shared_box(points);
    let origin: Point = std::array::from_fn(|k| (low[k] + high[k]) / 2.0);
    let largest = points.into_iter().flatten().flatten().fold(0.0f64, |most, c| most.max(c.abs()));
    let narrow = largest * NARROW;
    if (0..3).any(|k| high[k] - low[k] <= 2.0 * narrow) {
        return Vec::new();
    }
    let from_origin = |p: Point| std::array::from_fn(|k| p[k] - origin[k]);
    let whole = Cell::of_box(from_origin(low), from_origin(high));
    let sides: Vec<Plane> = whole.0.iter().filter_map(|side| Plane::of(side, narrow)).collect();
    let mut surfaces = Vec::new();
    for (points, triangles) in &seen {
        for corners in triangles {
            let triangle = corners.map(|v| from_origin(points[v.index()])).to_vec();
            // Each side's plane with the box below it.
            let inside = |side: &Plane| if side.offset < 0.0 { side.reversed() } else { side.clone() };
            let within = sides.iter().map(inside).try_fold(triangle, |rest, side| side.part_below(&rest, narrow));
            surfaces.extend(within);
        }
    }
    let leaves = leaves(whole, surfaces, narrow);
    leaves.iter().map(Cell::middle).map(|p| std::array::from_fn(|k| p[k] + origin[k])).collect()
}

/// The ends of the box that both blocks' boxes share; turned round where they share none.
fn shared_box([a, b]: [&Vec<Point>; 2]) -> [Point; 2] {
    let end =
        |all: &[Point], k: usize, best: fn(f64, f64) -> f64, start: f64| all.iter().map(|p| p[k]).fold(start, best);
    let low = |all: &[Point], k| end(all, k, f64::min, f64::INFINITY);
    let high = |all: &[Point], k| end(all, k, f64::max, f64::NEG_INFINITY);
    [std::array::from_fn(|k| low(a, k).max(low(b, k))), std::array::from_fn(|k| high(a, k).min(high(b, k)))]
}

/// The cells that none of the polygons passes through.
fn leaves(whole: Cell, polygons: Vec<Polygon>, narrow: f64) -> Vec<Cell> {
    let (mut open, mut leaves) = (vec![(whole, polygons)], Vec::new());
    while let Some((cell, mut polygons)) = open.pop() {
        let mut halves = None;
        while halves.is_none() && !polygons.is_empty() {
            // From the middle: the polygons of a surface follow one another, so that about as many are on either side.
            let polygon = polygons.swap_remove(polygons.len() / 2);
            halves = Plane::of(&polygon, narrow).and_then(|plane| Some((cell.split(&plane, narrow)?, plane)));
        }
        let Some(([below, above], plane)) = halves else {
            leaves.push(cell);
            continue;
        };
        let part = |plane: &Plane| polygons.iter().filter_map(|p| plane.part_below(p, narrow)).collect();
        open.push((below, part(&plane)));
        open.push((above, part(&plane.reversed())));
    }
    leaves
}

impl Plane {
    /// The plane of a convex polygon, by its largest triangle from the first corner; `None` where that is narrow.
    fn of(polygon: &[Point], narrow: f64) -> Option<Plane> {
        let first = *polygon.first()?;
        let way = |p: &Point| -> Point { std::array::from_fn(|k| p[k] - first[k]) };
        let normals = polygon.get(1..)?.windows(2).map(|two| cross(way(&two[0]), way(&two[1])));
        let n = normals.max_by(|one, two| dot(*one, *one).total_cmp(&dot(*two, *two)))?;
        let length = dot(n, n).sqrt();
        let n = n.map(|c| c / length);
        // Twice the area over the longest way is the height of the triangle.
        let longest = polygon.iter().map(way).map(|w| dot(w, w)).fold(0.0, f64::max).sqrt();
        (length > narrow * longest).then(|| Plane { offset: dot(n, first), n })
    }

    fn reversed(&self) -> Plane {
        Plane { n: self.n.map(|c| -c), offset: -self.offset }
    }

    fn value(&self, point: &Point) -> f64 {
        dot(self.n, *point) - self.offset
    }

    /// The part of a convex polygon below the plane; `None` where no point is below by more than `narrow`.
    fn part_below(&self, polygon: &[Point], narrow: f64) -> Option<Polygon> {
        let values: Vec<f64> = polygon.iter().map(|p| self.value(p)).collect();
        if values.iter().all(|&value| value >= -narrow) {
            return None;
        }
        let mut part = Vec::with_capacity(polygon.len() + 1);
        for i in 0..polygon.len() {
            let j = (i + 1) % polygon.len();
            if values[i] <= narrow {
                part.push(polygon[i]);
            }
            let [least, most] = [values[i].min(values[j]), values[i].max(values[j])];
            if least < -narrow && most > narrow {
                let share = values[i] / (values[i] - values[j]);
                part.push(std::array::from_fn(|k| polygon[i][k] + share * (polygon[j][k] - polygon[i][k])));
            }
        }
        (part.len() >= 3).then_some(part)
    }
}

impl Plane {
    /// The polygon in which the plane passes through a convex cell, from the corners that its parts have on the plane; `None` where these are too few.
    fn cap(&self, polygons: &[Polygon], narrow: f64) -> Option<Polygon> {
        let mut corners: Polygon = Vec::new();
        for point in polygons.iter().flatten().filter(|p| self.value(p).abs() <= narrow) {
            let is_known = |known: &Point| (0..3).all(|k| (known[k] - point[k]).abs() <= narrow);
            if !corners.iter().any(is_known) {
                corners.push(*point);
            }
        }
        if corners.len() < 3 {
            return None;
        }
        // Round the middle, in a frame across n.
        let middle: Point = std::array::from_fn(|k| corners.iter().map(|p| p[k]).sum::<f64>() / corners.len() as f64);
        let axis = (0..3).min_by(|&j, &k| self.n[j].abs().total_cmp(&self.n[k].abs())).unwrap_or(0);
        let u = cross(self.n, std::array::from_fn(|k| f64::from(u8::from(k == axis))));
        let v = cross(self.n, u);
        // Grows with the angle from u, and unlike an arc tangent is the same number on every machine.
        let angle = |p: &Point| {
            let way: Point = std::array::from_fn(|k| p[k] - middle[k]);
            let (along, across) = (dot(u, way), dot(v, way));
            (1.0 - along / (along.abs() + across.abs())).copysign(across)
        };
        corners.sort_by(|p, q| angle(p).total_cmp(&angle(q)));
        Some(corners)
    }
}

impl Cell {
    fn of_box(low: Point, high: Point) -> Cell {
        let corner =
            |k: usize| -> Point { std::array::from_fn(|bit| if k >> bit & 1 == 0 { low[bit] } else { high[bit] }) };
        let loops = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
        Cell(loops.map(|corners| corners.map(corner).to_vec()).into())
    }

    /// The mean of the corners of all polygons: inside.
    fn middle(&self) -> Point {
        let count = self.0.iter().map(Vec::len).sum::<usize>() as f64;
        std::array::from_fn(|k| self.0.iter().flatten().map(|p| p[k]).sum::<f64>() / count)
    }

    /// The parts below and above a plane; `None` where it does not pass through the cell by more than `narrow` on either side.
    fn split(&self, plane: &Plane, narrow: f64) -> Option<[Cell; 2]> {
        let values = || self.0.iter().flatten().map(|p| plane.value(p));
        if !values().any(|value| value < -narrow) || !values().any(|value| value > narrow) {
            return None;
        }
        let half = |plane: &Plane| {
            let mut polygons: Vec<Polygon> = self.0.iter().filter_map(|p| plane.part_below(p, narrow)).collect();
            polygons.extend(plane.cap(&polygons, narrow));
            Cell(polygons)
        };
        Some([half(plane), half(&plane.reversed())])
    }
}
