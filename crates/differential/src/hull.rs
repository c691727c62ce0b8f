//! Convex hulls of a few points, exactly, with coplanar facets merged into polygons.

use rockproof_model::lattice::Lattice;
use rockproof_model::ring::ExactRing;
use rockproof_model::{Block, BlockError, BlockOptions, Number, Point, Precision, Sign, Vec3};
use std::cmp::Ordering;
use std::collections::BTreeSet;

/// Bits per lattice coordinate up to which `i128` holds every value of the hull (degree 4, with room to spare).
const SMALL_BITS: u32 = 28;

/// Why points have no convex hull that is a block.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum HullError {
    /// All points lie in one plane (or there are fewer than four).
    #[error("{points} points lie in one plane; a block needs four that do not")]
    Flat {
        /// Points given.
        points: usize,
    },
    /// The hull's surface is not a canonical block.
    #[error(transparent)]
    Block(#[from] BlockError),
}

/// A convex hull of which no block was made yet. A block is checked when it is made, which takes longer than to find the hull.
#[derive(Clone, Debug)]
pub struct Hull {
    vertices: Vec<Point>,
    faces: Vec<Vec<u32>>,
}

impl Hull {
    /// The hull of all `points`. Points inside it, inside a face or inside an edge are dropped; the others keep their order. Time grows with the
    /// fourth power of their number, all but a few steps of it in f64: meant for up to some fifty.
    ///
    /// # Errors
    /// When the points lie in one plane.
    pub fn of(points: &[Point]) -> Result<Hull, HullError> {
        let lattice = Lattice::covering(points.iter().flat_map(|p| p.components()));
        let small: Option<Vec<Vec3<i128>>> = points
            .iter()
            .map(|p| {
                let units = |c: &Number| lattice.small_units(c, SMALL_BITS);
                Some(Vec3::new(units(&p.x)?, units(&p.y)?, units(&p.z)?))
            })
            .collect();
        let filter = SideFilter::new(points);
        let faces = match small {
            Some(small) => hull_faces(&small, filter.as_ref()),
            None => {
                hull_faces(&points.iter().map(|p| p.map(|c| lattice.units(c))).collect::<Vec<_>>(), filter.as_ref())
            }
        };
        if faces.len() < 4 {
            return Err(HullError::Flat { points: points.len() });
        }
        let used: BTreeSet<u32> = faces.iter().flatten().copied().collect();
        let mut renumbered = vec![0; points.len()];
        for (new, &old) in used.iter().enumerate() {
            renumbered[old as usize] = new as u32;
        }
        let faces = faces.into_iter().map(|f| f.into_iter().map(|v| renumbered[v as usize]).collect()).collect();
        let vertices = used.iter().map(|&v| points[v as usize].clone()).collect();
        Ok(Hull { vertices, faces })
    }

    /// Its corners, which are the vertices of its block.
    pub fn vertices(&self) -> &[Point] {
        &self.vertices
    }

    /// Of how many faces its block is.
    pub fn face_count(&self) -> usize {
        self.faces.len()
    }

    /// Its block.
    ///
    /// # Errors
    /// When the hull's surface is no canonical block.
    pub fn into_block(self) -> Result<Block, HullError> {
        Ok(Block::new(self.vertices, self.faces, &BlockOptions { planarity: Number::ZERO })?)
    }
}

/// The smallest convex block that holds all `points`: that of their [`Hull`].
///
/// # Errors
/// When the points lie in one plane.
pub fn convex_hull(points: &[Point]) -> Result<Block, HullError> {
    Hull::of(points)?.into_block()
}

/// Says in f64 on which side of a plane through three points the others are, where that is certain.
struct SideFilter {
    /// Each point less the first one, rounded to f64.
    points: Vec<[f64; 3]>,
    /// A determinant beyond it has the sign of the exact one.
    bound: f64,
}

/// What [`SideFilter`] knows of a plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sides {
    /// Points lie strictly on both: no plane of the hull.
    Both,
    /// All points but the three lie strictly on this one: sign of their distance along (b − a) × (c − a).
    One(Sign),
    /// It does not know.
    Unsure,
}

/// With u = 2⁻⁵³ and M the largest component: each component is off by at most uM, so each difference of two, 2M at most, by 4uM with its own
/// rounding. The determinant has six products of three such, so these errors change it by at most 6·3·4uM·(2M)² = 288uM³ and higher powers of
/// u; its evaluation adds less than 8u for each product of at most (2M)³, 384uM³ in all. 1024uM³ is more than both.
const DETERMINANT_BOUND: f64 = 1024.0 * (f64::EPSILON / 2.0);

impl SideFilter {
    /// `None` where a component is so large or all are so small that the cube of it leaves the range in which roundoffs are relative.
    fn new(points: &[Point]) -> Option<SideFilter> {
        let origin = points.first()?.map(Number::negated);
        let relative = |p: &Point| -> Option<[f64; 3]> {
            let component = |c: &Number, o: &Number| c.plus(o).rounded(Precision::F64);
            Some([component(&p.x, &origin.x)?, component(&p.y, &origin.y)?, component(&p.z, &origin.z)?])
        };
        let points: Vec<[f64; 3]> = points.iter().map(relative).collect::<Option<_>>()?;
        let largest = points.iter().flatten().fold(0.0f64, |largest, c| largest.max(c.abs()));
        let bound = DETERMINANT_BOUND * largest.powi(3);
        (1e-90..1e90).contains(&largest).then_some(SideFilter { points, bound })
    }

    /// The sign of the distance of a point from the plane through three, along (b − a) × (c − a), where that is certain.
    fn side(&self, plane: [usize; 3]) -> impl Fn(usize) -> Option<Sign> {
        let [a, b, c] = plane.map(|number| self.points[number]);
        let minus = |p: [f64; 3], q: [f64; 3]| [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
        let (u, v) = (minus(b, a), minus(c, a));
        let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        move |number| {
            let d = minus(self.points[number], a);
            let determinant = normal[0] * d[0] + normal[1] * d[1] + normal[2] * d[2];
            match determinant {
                above if above > self.bound => Some(Sign::Positive),
                below if below < -self.bound => Some(Sign::Negative),
                _ => None,
            }
        }
    }

    /// On which sides of the plane through three points the others lie.
    fn sides(&self, plane: [usize; 3]) -> Sides {
        let side = self.side(plane);
        let (mut above, mut below, mut unsure) = (false, false, false);
        for number in (0..self.points.len()).filter(|number| !plane.contains(number)) {
            match side(number) {
                Some(Sign::Positive) => above = true,
                Some(_) => below = true,
                None => unsure = true,
            }
            if above && below {
                return Sides::Both;
            }
        }
        match (above, below, unsure) {
            (true, false, false) => Sides::One(Sign::Positive),
            (false, true, false) => Sides::One(Sign::Negative),
            _ => Sides::Unsure,
        }
    }
}

/// Face loops of the hull, counter-clockwise seen from outside; none when the points are flat.
fn hull_faces<T: ExactRing>(points: &[Vec3<T>], filter: Option<&SideFilter>) -> Vec<Vec<u32>> {
    // The points of each plane found.
    let mut planes: Vec<Vec<u32>> = Vec::new();
    let mut faces = Vec::new();
    let n = points.len();
    for i in 0..n {
        for j in i + 1..n {
            for k in j + 1..n {
                let plane = [i, j, k];
                // A plane that was found, or three points in a line, which span none.
                let holds_all = |found: &Vec<u32>| plane.iter().all(|&number| found.contains(&(number as u32)));
                if planes.iter().any(holds_all) {
                    continue;
                }
                let (face, on_plane) = match filter.map_or(Sides::Unsure, |filter| filter.sides(plane)) {
                    Sides::Both => continue,
                    Sides::One(side) => (triangle(points, plane, side), plane.map(|number| number as u32).to_vec()),
                    Sides::Unsure => match supporting_plane(points, plane, filter) {
                        Some((outward, on_plane)) => (polygon(points, &on_plane, &outward), on_plane),
                        None => continue,
                    },
                };
                faces.push(face);
                planes.push(on_plane);
            }
        }
    }
    faces
}

/// The plane through three points, if all points lie on one side of it: the outward normal and the points in the plane. `None` where the three span no
/// plane and when every point lies in it.
fn supporting_plane<T: ExactRing>(
    points: &[Vec3<T>],
    plane: [usize; 3],
    filter: Option<&SideFilter>,
) -> Option<(Vec3<T>, Vec<u32>)> {
    let [a, b, c] = plane.map(|number| &points[number]);
    let normal = b.minus(a).cross(&c.minus(a));
    if normal.components().iter().all(|c| c.sign().is_zero()) {
        return None;
    }
    let certain = filter.map(|filter| filter.side(plane));
    let mut side = Sign::Zero;
    let mut on_plane = Vec::new();
    for (number, point) in points.iter().enumerate() {
        let sign = match plane.contains(&number) {
            true => Sign::Zero,
            false => certain
                .as_ref()
                .and_then(|certain| certain(number))
                .unwrap_or_else(|| normal.dot(&point.minus(a)).sign()),
        };
        match sign {
            Sign::Zero => on_plane.push(number as u32),
            sign if side.is_zero() => side = sign,
            sign if sign != side => return None,
            _ => {}
        }
    }
    match side {
        Sign::Negative => Some((normal, on_plane)),
        Sign::Positive => Some((normal.negated(), on_plane)),
        Sign::Zero => None,
    }
}

/// The order of points by x, then y, then z.
fn lexicographic<T: ExactRing>(p: &Vec3<T>, q: &Vec3<T>) -> Ordering {
    let order = |a: &T, b: &T| match a.minus(b).sign() {
        Sign::Negative => Ordering::Less,
        Sign::Zero => Ordering::Equal,
        Sign::Positive => Ordering::Greater,
    };
    order(&p.x, &q.x).then_with(|| order(&p.y, &q.y)).then_with(|| order(&p.z, &q.z))
}

/// What [`polygon`] makes of three points, where all others lie strictly on the side `others` of their plane.
fn triangle<T: ExactRing>(points: &[Vec3<T>], [a, b, c]: [usize; 3], others: Sign) -> Vec<u32> {
    let mut corners = if others.is_positive() { [a, c, b] } else { [a, b, c] };
    let first = (0..3).min_by(|&p, &q| lexicographic(&points[corners[p]], &points[corners[q]])).unwrap_or(0);
    corners.rotate_left(first);
    corners.map(|number| number as u32).to_vec()
}

/// The corners of the convex polygon that points of one plane span, counter-clockwise about `outward` (Jarvis's march,
/// the furthest of collinear points first).
fn polygon<T: ExactRing>(points: &[Vec3<T>], on_plane: &[u32], outward: &Vec3<T>) -> Vec<u32> {
    let at = |v: u32| &points[v as usize];
    let Some(start) = on_plane.iter().copied().min_by(|v, w| lexicographic(at(*v), at(*w))) else { return Vec::new() };
    // Products of vectors in the plane are along `outward` or against it: one component tells which.
    let signs = outward.components().map(|c| c.sign());
    let Some(axis) = signs.iter().position(|sign| !sign.is_zero()) else { return Vec::new() };
    let turn = |v: &Vec3<T>, w: &Vec3<T>| {
        let ([v, w], [p, q]) = ([v, w].map(Vec3::components), [(axis + 1) % 3, (axis + 2) % 3]);
        v[p].times(w[q]).minus(&v[q].times(w[p])).sign().times(signs[axis])
    };
    let mut corners = vec![start];
    loop {
        let here = at(corners[corners.len() - 1]);
        let mut next: Option<(u32, Vec3<T>)> = None;
        for &candidate in on_plane {
            let to_candidate = at(candidate).minus(here);
            if to_candidate.components().iter().all(|c| c.sign().is_zero()) {
                continue;
            }
            let better = next.as_ref().is_none_or(|(_, to_best)| match turn(to_best, &to_candidate) {
                Sign::Negative => true,
                Sign::Positive => false,
                Sign::Zero => to_candidate.norm_squared().minus(&to_best.norm_squared()).sign().is_positive(),
            });
            if better {
                next = Some((candidate, to_candidate));
            }
        }
        match next {
            Some((next, _)) if next != start && corners.len() <= on_plane.len() => corners.push(next),
            _ => return corners,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(x: i32, y: i32, z: i32) -> Point {
        Vec3::new(Number::from_integer(x), Number::from_integer(y), Number::from_integer(z))
    }

    #[test]
    fn merges_coplanar_facets_and_drops_the_rest() {
        let mut points: Vec<Point> = (0..8).map(|i| point(2 * (i & 1), i & 2, (i & 4) / 2)).collect();
        points.extend([point(1, 1, 1), point(1, 0, 0), point(1, 1, 2), point(2, 2, 2)]);
        let hull = Hull::of(&points).unwrap();
        assert_eq!((hull.vertices().len(), hull.face_count()), (8, 6));
        let cube = hull.into_block().unwrap();
        assert_eq!((cube.vertices().len(), cube.topology().faces().len()), (8, 6));
        assert!(cube.is_convex());
        assert!(cube.topology().faces().iter().all(|f| f.len() == 4));
    }

    #[test]
    fn large_and_small_numbers_agree() {
        let points: Vec<Point> =
            [(0, 0, 0), (5, 1, 0), (1, 6, 2), (2, 2, 7), (4, 5, 5)].iter().map(|&(x, y, z)| point(x, y, z)).collect();
        let tiny = Number::from_f64(2f64.powi(-40)).unwrap();
        let moved: Vec<Point> = points.iter().map(|p| p.map(|c| c.plus(&tiny))).collect();
        let (a, b) = (convex_hull(&points).unwrap(), convex_hull(&moved).unwrap());
        assert_eq!(a.topology(), b.topology());
    }

    /// Points on a paraboloid and beside it by some last places, where f64 can tell nothing, all of them moved far away and made small.
    #[test]
    fn the_filter_changes_no_hull() {
        let f64s = |p: [f64; 3]| Vec3::new(p[0], p[1], p[2]).map(|c| Number::from_f64(*c).unwrap());
        for (scale, far) in [(1.0, 0.0), (2f64.powi(-30), 0.0), (1.0, 1e6), (2f64.powi(-300), 0.0)] {
            let mut points = Vec::new();
            for n in 0..20u32 {
                let (x, y) = (f64::from(n % 5) / 4.0 - 0.5, f64::from(n / 5) / 3.0 - 0.5);
                let bent = x * x + y * y + if n % 3 == 0 { f64::EPSILON * f64::from(n) } else { 0.0 };
                // A lid of coplanar points over it.
                points.push(f64s([far + scale * x, scale * y, scale * if n % 4 == 1 { 1.0 } else { bent }]));
            }
            let lattice = Lattice::covering(points.iter().flat_map(|p| p.components()));
            let units: Vec<_> = points.iter().map(|p| p.map(|c| lattice.units(c))).collect();
            let filter = SideFilter::new(&points);
            assert_eq!(filter.is_none(), scale < 1e-89);
            assert_eq!(hull_faces(&units, filter.as_ref()), hull_faces(&units, None), "{scale} {far}");
            let Some(filter) = filter else { continue };
            let counts = (0..18usize).map(|n| filter.sides([n, n + 1, n + 2]));
            let counts = counts.fold([0; 3], |mut counts, sides| {
                counts[match sides {
                    Sides::Both => 0,
                    Sides::One(_) => 1,
                    Sides::Unsure => 2,
                }] += 1;
                counts
            });
            assert!(counts[0] > 0 && counts[2] > 0, "{counts:?}: all that the filter can say is reached");
        }
    }

    #[test]
    fn flat_points_are_refused() {
        let flat: Vec<Point> = (0..6).map(|i| point(i, i * i, 3)).collect();
        assert_eq!(convex_hull(&flat), Err(HullError::Flat { points: 6 }));
        assert_eq!(convex_hull(&flat[..2]), Err(HullError::Flat { points: 2 }));
    }
}
