//! Round convex shapes: many vertices, with five, six or seven triangles at most of them.

use super::catalogue::{SIDE, solid_of};
use super::lattice_solid::{LatticeSolid, Units};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use std::collections::BTreeSet;

/// The sphere's radius in lattice units.
const RADIUS: i128 = 512;

/// Places tried for each point of a sphere before another sphere is begun.
const PLACES: usize = 2000;

/// A triangulated sphere of `count` vertices in the cube [0, 8]³, the same each time; `None` where no place is left for
/// that many.
pub(super) fn solid(count: usize) -> Option<LatticeSolid> {
    let mut rng = ChaCha8Rng::seed_from_u64(count as u64);
    (0..64).find_map(|_| {
        let points = scattered(&mut rng, count)?;
        let block = solid_of(points.clone(), wrapped(&points)?, 2 * RADIUS / SIDE).ok()?;
        block.shape().is_convex().then_some(block)
    })
}

/// Points of a sphere that keep a distance from each other.
fn scattered(rng: &mut ChaCha8Rng, count: usize) -> Option<Vec<Units>> {
    // Of the 4πR²/count that is each point's share, a circle of half the area stays free of others.
    let apart = 2 * RADIUS * RADIUS / count as i128 * 3;
    let mut points: Vec<Units> = Vec::new();
    for _ in 0..count {
        let free = |point: &Units| points.iter().all(|p| squared(&minus(p, point)) > apart);
        let place = (0..PLACES).find_map(|_| on_sphere(rng).filter(free))?;
        points.push(place);
    }
    Some(points)
}

/// A random point of the sphere around (R, R, R), rounded to the lattice.
fn on_sphere(rng: &mut ChaCha8Rng) -> Option<Units> {
    let draw = [(); 3].map(|()| i128::from(rng.next_u32() >> 12) - (1 << 19));
    let length = squared(&draw).isqrt();
    // Only what lies in the ball inside the cube of draws is spread evenly.
    (length > 1 << 10 && length < 1 << 19).then(|| draw.map(|c| RADIUS + (c * RADIUS).div_euclid(length)))
}

/// The triangles of the convex hull, counter-clockwise seen from outside, by gift wrapping (Chand and Kapur 1970) of
/// points in general position.
fn wrapped(points: &[Units]) -> Option<Vec<Vec<u32>>> {
    let count = points.len();
    let lowest = (0..count).min_by_key(|&i| points[i])?;
    // A hull edge at the lowest point: one with everything else on one side of a plane through it.
    let first = (0..count).find_map(|i| {
        (0..count).filter(|&j| i != lowest && j != lowest && i != j).find_map(|j| {
            let outside = |k: usize| k != lowest && k != i && k != j && height(points, [lowest, i, j], k) >= 0;
            (!(0..count).any(outside)).then_some([lowest, i, j])
        })
    })?;
    let mut faces = vec![first];
    let mut done: BTreeSet<(usize, usize)> = [(0, 1), (1, 2), (2, 0)].map(|(p, q)| (first[p], first[q])).into();
    let mut next = 0;
    while next < faces.len() {
        let face = faces[next];
        next += 1;
        for (p, q) in [(face[1], face[0]), (face[2], face[1]), (face[0], face[2])] {
            if done.contains(&(p, q)) {
                continue;
            }
            let others = (0..count).filter(|&k| k != p && k != q);
            let apex = others.reduce(|best, k| if height(points, [p, q, best], k) > 0 { k } else { best })?;
            let triangle = [p, q, apex];
            for (from, to) in [(p, q), (q, apex), (apex, p)] {
                // An edge met twice one way is none of a closed surface: points are not in general position.
                done.insert((from, to)).then_some(())?;
            }
            faces.push(triangle);
        }
    }
    Some(faces.into_iter().map(|face| face.map(|v| v as u32).to_vec()).collect())
}

/// Six times the volume of the triangle and a point: positive where the point is outside.
fn height(points: &[Units], [p, q, r]: [usize; 3], k: usize) -> i128 {
    let (a, b, c) = (minus(&points[q], &points[p]), minus(&points[r], &points[p]), minus(&points[k], &points[p]));
    (a[1] * b[2] - a[2] * b[1]) * c[0] + (a[2] * b[0] - a[0] * b[2]) * c[1] + (a[0] * b[1] - a[1] * b[0]) * c[2]
}

fn minus(a: &Units, b: &Units) -> Units {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn squared(a: &Units) -> i128 {
    a[0] * a[0] + a[1] * a[1] + a[2] * a[2]
}
