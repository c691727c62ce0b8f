//! The area that two polygons of the plane have in common, exactly.
//!
//! Of two convex ones, what is left of the first after cutting along each side of the second. For others the plane is cut into strips at every corner of both and at every point where their sides cross. Within a strip the
//! sides keep their order, so the length that both polygons share of a vertical line is linear across it: the strip
//! contributes its width times that length in its middle. Polygons may be concave and go round either way.

use num_bigint::BigInt;
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use std::cmp::{max, min};

/// A point of the plane.
pub(crate) type Flat = [BigInt; 2];

/// The common area of two simple polygons.
pub(crate) fn common_area(one: &[Flat], two: &[Flat]) -> BigRational {
    match (convex(one), convex(two)) {
        (Some(one), Some(two)) => convex_area(&one, &two),
        _ => {
            let fractions = |polygon: &[Flat]| -> Vec<Fractions> {
                polygon.iter().map(|corner| corner.clone().map(BigRational::from_integer)).collect()
            };
            area_in_strips(&fractions(one), &fractions(two))
        }
    }
}

/// The corners of a convex polygon, counterclockwise; `None` for any other.
fn convex(polygon: &[Flat]) -> Option<Vec<&Flat>> {
    let corners: Vec<&Flat> = polygon.iter().collect();
    let on_one_side = |corners: &[&Flat]| {
        (0..corners.len()).all(|k| {
            let side = [corners[k], corners[(k + 1) % corners.len()]];
            corners.iter().all(|[x, y]| !left_of(side, x, y, &BigInt::one()).is_negative())
        })
    };
    if on_one_side(&corners) {
        return Some(corners);
    }
    let backwards: Vec<&Flat> = polygon.iter().rev().collect();
    on_one_side(&backwards).then_some(backwards)
}

/// Positive where the point (x/w, y/w), w > 0, is to the left of a line from its first point to its second.
fn left_of([p, q]: [&Flat; 2], x: &BigInt, y: &BigInt, w: &BigInt) -> BigInt {
    (&q[0] - &p[0]) * (y - &p[1] * w) - (&q[1] - &p[1]) * (x - &p[0] * w)
}

/// The point (x/w, y/w), w > 0, in lowest terms.
struct Corner {
    x: BigInt,
    y: BigInt,
    w: BigInt,
}

/// The common area of two convex polygons that go round counterclockwise.
fn convex_area(one: &[&Flat], two: &[&Flat]) -> BigRational {
    let whole = |[x, y]: &Flat| Corner { x: x.clone(), y: y.clone(), w: BigInt::one() };
    let mut corners: Vec<Corner> = one.iter().map(|corner| whole(corner)).collect();
    for k in 0..two.len() {
        corners = cut(corners, [two[k], two[(k + 1) % two.len()]]);
    }
    let mut double = BigRational::zero();
    let mut of_whole = BigInt::ZERO;
    for (k, p) in corners.iter().enumerate() {
        let q = &corners[(k + 1) % corners.len()];
        let (across, under) = (&p.x * &q.y - &p.y * &q.x, &p.w * &q.w);
        if under.is_one() {
            of_whole += across;
        } else if !across.is_zero() {
            double += BigRational::new(across, under);
        }
    }
    (double + of_whole) / BigInt::from(2)
}

/// What of a convex polygon is to the left of a line, or on it.
fn cut(corners: Vec<Corner>, line: [&Flat; 2]) -> Vec<Corner> {
    let sides: Vec<BigInt> = corners.iter().map(|c| left_of(line, &c.x, &c.y, &c.w)).collect();
    if sides.iter().all(|side| !side.is_negative()) {
        return corners;
    }
    let mut next: Vec<Option<Corner>> = Vec::with_capacity(corners.len() + 2);
    let crossings: Vec<Option<Corner>> = (0..corners.len())
        .map(|k| {
            let other = (k + 1) % corners.len();
            let (here, there) = (&sides[k], &sides[other]);
            if here.is_zero() || there.is_zero() || here.is_negative() == there.is_negative() {
                return None;
            }
            // Weights of the same sign, so that w stays positive.
            let (here, there) = (here.abs(), there.abs());
            let between = |p: &BigInt, q: &BigInt| p * &there + q * &here;
            let (p, q) = (&corners[k], &corners[other]);
            let (x, y, w) = (between(&p.x, &q.x), between(&p.y, &q.y), between(&p.w, &q.w));
            let common = x.gcd(&y).gcd(&w);
            Some(Corner { x: x / &common, y: y / &common, w: w / common })
        })
        .collect();
    for ((corner, side), crossing) in corners.into_iter().zip(&sides).zip(crossings) {
        next.push((!side.is_negative()).then_some(corner));
        next.push(crossing);
    }
    next.into_iter().flatten().collect()
}

/// A point of the plane, as fractions.
type Fractions = [BigRational; 2];

/// The common area of any two simple polygons.
fn area_in_strips(one: &[Fractions], two: &[Fractions]) -> BigRational {
    let mut cuts: Vec<BigRational> = one.iter().chain(two).map(|corner| corner[0].clone()).collect();
    for side in sides(one) {
        cuts.extend(sides(two).filter_map(|other| crossing(side, other)));
    }
    cuts.sort_unstable();
    cuts.dedup();
    let two_of = BigInt::from(2);
    cuts.windows(2).fold(BigRational::zero(), |area, strip| {
        let (width, middle) = (&strip[1] - &strip[0], (&strip[0] + &strip[1]) / &two_of);
        area + width * shared(&inside(one, &middle), &inside(two, &middle))
    })
}

fn sides(polygon: &[Fractions]) -> impl Iterator<Item = [&Fractions; 2]> {
    (0..polygon.len()).map(|k| [&polygon[k], &polygon[(k + 1) % polygon.len()]])
}

/// Where two sides cross, by its first coordinate; parallel ones do not.
fn crossing([p, q]: [&Fractions; 2], [r, s]: [&Fractions; 2]) -> Option<BigRational> {
    if max(&p[0], &q[0]) < min(&r[0], &s[0]) || max(&r[0], &s[0]) < min(&p[0], &q[0]) {
        return None;
    }
    if max(&p[1], &q[1]) < min(&r[1], &s[1]) || max(&r[1], &s[1]) < min(&p[1], &q[1]) {
        return None;
    }
    let (d, e) = ([&q[0] - &p[0], &q[1] - &p[1]], [&s[0] - &r[0], &s[1] - &r[1]]);
    let across = &d[0] * &e[1] - &d[1] * &e[0];
    if across.is_zero() {
        return None;
    }
    let apart = [&r[0] - &p[0], &r[1] - &p[1]];
    let share = (&apart[0] * &e[1] - &apart[1] * &e[0]) / across;
    Some(&p[0] + share * &d[0])
}

/// What a vertical line, through no corner, has inside a polygon: ends of intervals, ascending.
fn inside(polygon: &[Fractions], x: &BigRational) -> Vec<BigRational> {
    let mut ends: Vec<BigRational> = sides(polygon)
        .filter(|[p, q]| (p[0] < *x) != (q[0] < *x))
        .map(|[p, q]| &p[1] + (x - &p[0]) * (&q[1] - &p[1]) / (&q[0] - &p[0]))
        .collect();
    ends.sort_unstable();
    ends
}

/// The length that two unions of intervals share.
fn shared(one: &[BigRational], two: &[BigRational]) -> BigRational {
    let intervals =
        |ends: &'_ [BigRational]| ends.chunks_exact(2).map(|two| (two[0].clone(), two[1].clone())).collect();
    let (one, two): (Vec<_>, Vec<_>) = (intervals(one), intervals(two));
    let mut length = BigRational::zero();
    for (low, high) in &one {
        for (other_low, other_high) in &two {
            let (low, high) = (max(low, other_low), min(high, other_high));
            if low < high {
                length += high - low;
            }
        }
    }
    length
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A common denominator of all coordinates below.
    const UNIT: i64 = 30;

    fn polygon(corners: &[[i64; 2]], by: (i64, i64)) -> Vec<Flat> {
        let at = |value: i64| BigInt::from(value * UNIT);
        corners.iter().map(|c| [at(c[0]) + by.0 * UNIT / by.1, at(c[1])]).collect()
    }

    fn area(value: (i64, i64)) -> BigRational {
        BigRational::new((value.0 * UNIT * UNIT).into(), value.1.into())
    }

    /// The polygon turned by the angle of cosine 3/5.
    fn turned(polygon: &[Flat]) -> Vec<Flat> {
        polygon.iter().map(|[x, y]| [(x * 3 - y * 4) / 5, (x * 4 + y * 3) / 5]).collect()
    }

    /// The area by both ways where both polygons are convex.
    fn checked(one: &[Flat], two: &[Flat]) -> BigRational {
        let fractions = |polygon: &[Flat]| -> Vec<Fractions> {
            polygon.iter().map(|corner| corner.clone().map(BigRational::from_integer)).collect()
        };
        let found = common_area(one, two);
        assert_eq!(found, area_in_strips(&fractions(one), &fractions(two)));
        found
    }

    #[test]
    fn convex_polygons_are_known_whichever_way_they_go_round() {
        let corners = [[-3, 1], [2, -2], [4, 0], [4, 3], [-1, 4]];
        let pentagon = polygon(&corners, (0, 1));
        let counterclockwise: Vec<&Flat> = pentagon.iter().collect();
        let backwards: Vec<Flat> = pentagon.iter().rev().cloned().collect();
        assert_eq!(convex(&pentagon), Some(counterclockwise.clone()));
        assert_eq!(convex(&backwards), Some(counterclockwise));
        // A corner in line with its neighbours bends nothing.
        let straight = polygon(&[[-1, -1], [0, -1], [1, -1], [1, 1], [-1, 1]], (0, 1));
        assert_eq!(convex(&straight).map(|corners| corners.len()), Some(5));
        for notch in [[1, 1], [-1, 2]] {
            let mut bent = corners.to_vec();
            bent.insert(4, notch);
            assert_eq!(convex(&polygon(&bent, (0, 1))), None);
            bent.reverse();
            assert_eq!(convex(&polygon(&bent, (0, 1))), None);
        }
    }

    #[test]
    fn overlaps_worked_by_hand_come_out_turned_and_reversed() {
        let square = polygon(&[[0, 0], [1, 0], [1, 1], [0, 1]], (0, 1));
        let shifted = polygon(&[[0, 0], [1, 0], [1, 1], [0, 1]], (1, 3));
        // A U of two prongs 1 wide on a base 1 high, and a bar of height 1 across both prongs.
        let prongs = polygon(&[[0, 0], [3, 0], [3, 3], [2, 3], [2, 1], [1, 1], [1, 3], [0, 3]], (0, 1));
        let bar = polygon(&[[0, 2], [3, 2], [3, 3], [0, 3]], (1, 2));
        let diamond = polygon(&[[1, 0], [2, 1], [1, 2], [0, 1]], (0, 1));
        let cases = [
            (&square, &square, (1, 1)),
            (&square, &shifted, (2, 3)),
            // The bar from 1/2 to 7/2: half of the first prong, all of the second.
            (&prongs, &bar, (3, 2)),
            (&prongs, &prongs, (7, 1)),
            (&square, &diamond, (1, 2)),
            // Sharing a corner or a side only.
            (&square, &polygon(&[[1, 1], [2, 1], [2, 2]], (0, 1)), (0, 1)),
            (&square, &polygon(&[[1, 0], [2, 0], [2, 1], [1, 1]], (0, 1)), (0, 1)),
            // Nothing at all.
            (&square, &polygon(&[[5, 0], [6, 0], [6, 1], [5, 1]], (0, 1)), (0, 1)),
            // Below x + y = 3: of the base 5/2, of the first prong 3/2, of the second a corner.
            (&prongs, &polygon(&[[3, 0], [0, 3], [0, 0]], (0, 1)), (4, 1)),
        ];
        for (k, (one, two, expected)) in cases.into_iter().enumerate() {
            let backwards: Vec<Flat> = two.iter().rev().cloned().collect();
            for (a, b) in [(one, two), (two, one), (one, &backwards), (&turned(one), &turned(two))] {
                assert_eq!(checked(a, b), area(expected), "case {k}");
            }
        }
    }

    #[test]
    fn a_square_turned_in_a_square_leaves_an_octagon() {
        // Side 2, turned by 3-4-5 about the middle: each corner cut off is a right triangle. With the distances of the
        // turned corners from the axes 1/5 and 7/5, the triangles' legs are 1/2 and 2/3 long.
        let square = polygon(&[[-1, -1], [1, -1], [1, 1], [-1, 1]], (0, 1));
        assert_eq!(checked(&square, &turned(&square)), area((4, 1)) - area((2, 3)));
    }
}
