//! Whether one plane separates two sets of points, exactly and completely: what decides whether two convex blocks overlap.
//!
//! The hulls of two sets, both with inner points, share inner points exactly when no direction n ≠ 0 has
//! `n·(a − b) ≥ 0` for every a of the one and b of the other (Minkowski's theorem of the separating plane). The directions
//! that satisfy all these inequalities form a cone. It is searched for in six parts, one around each half axis: each begins
//! as the pyramid over a side of a cube and is cut by one inequality after the other, as a polygon is clipped by half
//! planes (I. E. Sutherland and G. W. Hodgman, 1974), its boundary kept. A part is empty when nothing is left of it, and a
//! direction that is left in the end separates. **A plane that both sets touch separates them.**
//!
//! A ray of a part is the cross product of two inequalities' vectors, so every sign asked for is that of a determinant of
//! three differences of points: it is taken from [`Ball`]s where these prove it, else from [`DoubleBall`]s, else from
//! integers. Which inequality comes next is chosen in f64 by the points that hinder the middle of the part most; that choice
//! decides nothing but the time.

mod points;

use crate::f64_vector::dot;
use crate::field::{DoubleBall, Field};
use crate::number::{Approx, Ball};
use num_bigint::BigInt;
pub(crate) use points::{PointSet, SeparablePoints, on_lattice};
use rockproof_model::ring::ExactRing;
use rockproof_model::{Ring, Sign, Vec3};
use smallvec::SmallVec;
use std::cell::{Cell, OnceCell};

/// What is known of two sets of points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SeparationAnswer {
    /// Whether a plane separates them; **touching says yes**.
    pub(crate) is_separated: bool,
    /// Whether f64 with its bounds decided every sign.
    pub(crate) by_float: bool,
}

/// Whether a plane separates two sets of points; **a plane that both touch does**.
pub(crate) fn separate(a: PointSet<'_>, b: PointSet<'_>) -> SeparationAnswer {
    let search = Search::new([a, b]);
    let is_separated = search.parts_in_order().into_iter().any(|part| search.survives(part));
    SeparationAnswer { is_separated, by_float: !search.is_beyond_f64.get() }
}

/// The side of the cube a part of the directions passes through.
#[derive(Clone, Copy)]
struct CubeSide {
    axis: usize,
    is_negative: bool,
}

/// A condition `n · vector ≥ 0` on directions n.
#[derive(Clone, Copy)]
enum Condition {
    /// Within the pyramid over a side of the cube: a vector of −1, 0 and 1.
    Cube([i32; 3]),
    /// A point of the first set is not before one of the second.
    Apart(usize, usize),
}

/// A direction on the boundary of two conditions.
#[derive(Clone)]
struct Ray {
    conditions: [usize; 2],
    /// Against the cross product of the two.
    is_reversed: bool,
    near: Vec3<Ball>,
    /// The cross product in some 100 bits, when a sign has asked for it.
    double: OnceCell<Vec3<DoubleBall>>,
    /// The cross product itself, when a sign has asked for it.
    exact: OnceCell<Vec3<BigInt>>,
    /// The condition with equality between this ray and the next.
    next_edge: usize,
}

struct Search<'p> {
    sets: [PointSet<'p>; 2],
    doubles: OnceCell<[Vec<Vec3<DoubleBall>>; 2]>,
    integers: OnceCell<[Vec<Vec3<BigInt>>; 2]>,
    is_beyond_f64: Cell<bool>,
}

/// What is left of a part after some conditions.
struct DirectionCone<'s, 'p> {
    search: &'s Search<'p>,
    side: CubeSide,
    conditions: Vec<(Condition, Vec3<Ball>)>,
    rays: Vec<Ray>,
}

impl<'p> Search<'p> {
    fn new(sets: [PointSet<'p>; 2]) -> Search<'p> {
        Search { sets, doubles: OnceCell::new(), integers: OnceCell::new(), is_beyond_f64: Cell::new(false) }
    }

    /// The six parts, first the one in which the sets' middles lie apart.
    fn parts_in_order(&self) -> [CubeSide; 6] {
        let middle = |set: &PointSet<'_>| {
            let sum = set.near.iter().fold(Vec3::new(Approx(0.0), Approx(0.0), Approx(0.0)), |s, p| s.plus(p));
            sum.map(|c| c.0 / set.near.len() as f64)
        };
        let (a, b) = (middle(&self.sets[0]), middle(&self.sets[1]));
        let towards = [a.x - b.x, a.y - b.y, a.z - b.z];
        let mut parts = std::array::from_fn(|k| CubeSide { axis: k % 3, is_negative: k >= 3 });
        let along = |part: &CubeSide| if part.is_negative { -towards[part.axis] } else { towards[part.axis] };
        parts.sort_by(|one, two| along(two).total_cmp(&along(one)));
        parts
    }

    /// Whether a direction of a part separates the sets.
    fn survives(&self, side: CubeSide) -> bool {
        let mut part = DirectionCone::new(self, side);
        loop {
            let n = part.middle();
            let [a, b] = self.hindering(n);
            let hinders = dot(n, self.near(0, a)) < dot(n, self.near(1, b));
            if hinders && part.add(Condition::Apart(a, b)) {
                if part.rays.is_empty() {
                    return false;
                }
                continue;
            }
            // f64 sees nothing more to cut away.
            return self.surely_separates(n) || part.survives_all();
        }
    }

    fn near(&self, set: usize, point: usize) -> [f64; 3] {
        let p = &self.sets[set].near[point];
        [p.x.0, p.y.0, p.z.0]
    }

    /// The first set's lowest and the second's highest point along n, in f64.
    fn hindering(&self, n: [f64; 3]) -> [usize; 2] {
        [(0, 1.0), (1, -1.0)].map(|(set, sign): (usize, f64)| {
            let along = |&k: &usize| sign * dot(n, self.near(set, k));
            (0..self.sets[set].near.len()).min_by(|i, j| along(i).total_cmp(&along(j))).unwrap_or(0)
        })
    }

    /// Whether balls prove that a direction of f64 numbers, taken as exact, separates the sets.
    fn surely_separates(&self, n: [f64; 3]) -> bool {
        if n == [0.0; 3] || n.iter().any(|c| !c.is_finite()) {
            return false;
        }
        let exact = |c: f64| Ball { middle: c, radius: 0.0 };
        let n = Vec3::new(exact(n[0]), exact(n[1]), exact(n[2]));
        let origin = self.near(0, 0);
        let origin = Vec3::new(exact(origin[0]), exact(origin[1]), exact(origin[2]));
        let along = |set: usize| (0..self.sets[set].near.len()).map(move |k| (set, k));
        let value = |(set, k): (usize, usize)| n.dot(&self.ball(set, k).minus(&origin));
        // One float outwards makes up for the rounding of the difference.
        let low =
            along(0).map(value).map(|v| (v.middle - v.radius).next_down()).fold(f64::INFINITY, nan_first(f64::min));
        let high =
            along(1).map(value).map(|v| (v.middle + v.radius).next_up()).fold(f64::NEG_INFINITY, nan_first(f64::max));
        low >= high
    }

    fn ball(&self, set: usize, point: usize) -> Vec3<Ball> {
        let radius = self.sets[set].error;
        self.sets[set].near[point].map(|c| Ball { middle: c.0, radius })
    }

    fn balls_of(&self, condition: Condition) -> Vec3<Ball> {
        match condition {
            Condition::Cube([x, y, z]) => Vec3::new(x, y, z).map(|&c| Ball::from_i32(c)),
            Condition::Apart(a, b) => self.ball(0, a).minus(&self.ball(1, b)),
        }
    }

    fn doubles_of(&self, condition: Condition) -> Vec3<DoubleBall> {
        match condition {
            Condition::Cube([x, y, z]) => Vec3::new(x, y, z).map(|&c| DoubleBall::from_i32(c)),
            Condition::Apart(a, b) => {
                self.is_beyond_f64.set(true);
                let points = self.doubles.get_or_init(|| self.sets.map(|set| set.doubles()));
                points[0][a].minus(&points[1][b])
            }
        }
    }

    fn integers_of(&self, condition: Condition) -> Vec3<BigInt> {
        match condition {
            Condition::Cube([x, y, z]) => Vec3::new(x, y, z).map(|&c| BigInt::from(c)),
            Condition::Apart(a, b) => {
                let points = self.integers.get_or_init(|| on_lattice(self.sets.map(|set| set.exact)));
                points[0][a].minus(&points[1][b])
            }
        }
    }
}

/// A minimum or maximum that keeps what is not a number.
fn nan_first(pick: fn(f64, f64) -> f64) -> impl Fn(f64, f64) -> f64 {
    move |one, two| if one.is_nan() || two.is_nan() { f64::NAN } else { pick(one, two) }
}

impl<'s, 'p> DirectionCone<'s, 'p> {
    fn new(search: &'s Search<'p>, side: CubeSide) -> DirectionCone<'s, 'p> {
        let mut part = DirectionCone { search, side, conditions: Vec::with_capacity(16), rays: Vec::with_capacity(8) };
        let sign = if side.is_negative { -1 } else { 1 };
        // The other coordinate along `l` is at most, or against it at least, that along the axis.
        for (l, against) in [(1, -1), (2, -1), (1, 1), (2, 1)] {
            let mut vector = [0; 3];
            vector[side.axis] = sign;
            vector[(side.axis + l) % 3] = against;
            let condition = Condition::Cube(vector);
            part.conditions.push((condition, search.balls_of(condition)));
        }
        part.rays = [([0, 1], 1), ([2, 1], 2), ([2, 3], 3), ([0, 3], 0)].map(|(two, edge)| part.ray(two, edge)).into();
        part
    }

    /// The direction of the part with equality in two conditions. Along the part's axis no direction of it is zero.
    fn ray(&self, conditions: [usize; 2], next_edge: usize) -> Ray {
        let [first, second] = conditions.map(|k| &self.conditions[k]);
        let near = first.1.cross(&second.1);
        let along_axis = near.components()[self.side.axis];
        let two = [first.0, second.0];
        let sign = along_axis.certain_sign().or_else(|| {
            let [first, second] = two.map(|condition| self.search.doubles_of(condition));
            first.cross(&second).components()[self.side.axis].certain_sign()
        });
        let sign = sign.unwrap_or_else(|| {
            let [first, second] = two.map(|condition| self.search.integers_of(condition));
            ExactRing::sign(first.cross(&second).components()[self.side.axis])
        });
        let is_reversed = sign.is_negative() != self.side.is_negative;
        Ray {
            conditions,
            is_reversed,
            near: if is_reversed { near.negated() } else { near },
            double: OnceCell::new(),
            exact: OnceCell::new(),
            next_edge,
        }
    }

    /// The sign of a ray's dot product with the vector of a condition.
    fn sign(&self, ray: &Ray, (asked, vector): &(Condition, Vec3<Ball>)) -> Sign {
        let two = ray.conditions.map(|k| self.conditions[k].0);
        ray.near.dot(vector).certain_sign().unwrap_or_else(|| {
            let double = ray.double.get_or_init(|| {
                let [first, second] = two.map(|condition| self.search.doubles_of(condition));
                first.cross(&second)
            });
            let sign = double.dot(&self.search.doubles_of(*asked)).certain_sign();
            let sign = sign.unwrap_or_else(|| {
                let exact = ray.exact.get_or_init(|| {
                    let [first, second] = two.map(|condition| self.search.integers_of(condition));
                    first.cross(&second)
                });
                ExactRing::sign(&exact.dot(&self.search.integers_of(*asked)))
            });
            if ray.is_reversed { sign.reversed() } else { sign }
        })
    }

    /// Takes away what does not satisfy a condition; whether that was anything.
    fn add(&mut self, condition: Condition) -> bool {
        let k = self.conditions.len();
        let asked = (condition, self.search.balls_of(condition));
        let signs: SmallVec<[Sign; 12]> = self.rays.iter().map(|ray| self.sign(ray, &asked)).collect();
        if signs.iter().all(|sign| sign.is_at_least_zero()) {
            return false;
        }
        self.conditions.push(asked);
        let mut left = Vec::with_capacity(self.rays.len() + 1);
        for (i, ray) in self.rays.iter().enumerate() {
            let next = signs[(i + 1) % signs.len()];
            match (signs[i], next) {
                (Sign::Positive, Sign::Negative) => {
                    left.push(ray.clone());
                    left.push(self.ray([ray.next_edge, k], k));
                }
                (Sign::Zero, Sign::Negative) => left.push(Ray { next_edge: k, ..ray.clone() }),
                (Sign::Negative, Sign::Positive) => left.push(self.ray([ray.next_edge, k], ray.next_edge)),
                (Sign::Negative, _) => {}
                _ => left.push(ray.clone()),
            }
        }
        self.rays = left;
        true
    }

    /// Whether something is left after every condition that points set.
    fn survives_all(&mut self) -> bool {
        let [ones, twos] = self.search.sets.map(|set| set.near.len());
        for (a, b) in (0..ones).flat_map(|a| (0..twos).map(move |b| (a, b))) {
            self.add(Condition::Apart(a, b));
            if self.rays.is_empty() {
                return false;
            }
        }
        true
    }

    /// A direction well inside the part, in f64.
    fn middle(&self) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for ray in &self.rays {
            let n = [ray.near.x.middle, ray.near.y.middle, ray.near.z.middle];
            // Along the axis a ray is longest.
            let size = n[self.side.axis].abs();
            for (sum, c) in sum.iter_mut().zip(n) {
                *sum += c / size;
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_rational::BigRational;
    use rockproof_model::Number;

    fn float(value: f64) -> Number {
        Number::from_f64(value).unwrap()
    }

    fn part(numerator: i32, denominator: i32) -> Number {
        Number::from_rational(BigRational::new(numerator.into(), denominator.into()))
    }

    fn points(of: Vec<[Number; 3]>) -> SeparablePoints {
        SeparablePoints::new(of.into_iter().map(|[x, y, z]| Vec3::new(x, y, z)).collect())
    }

    /// Whether every point of the first set is exactly at or beyond every one of the second along n.
    fn separates(n: [i32; 3], sets: [&SeparablePoints; 2]) -> bool {
        let n = Vec3::new(n[0], n[1], n[2]).map(|&c| BigRational::from_integer(c.into()));
        let [a, b] =
            sets.map(|set| set.set().exact.iter().map(|p| n.dot(&p.map(Number::to_rational))).collect::<Vec<_>>());
        a.iter().min() >= b.iter().max()
    }

    /// The first set is exactly below the second by less than a rounding, or f64 overflows: nothing is sure.
    #[test]
    fn what_f64_cannot_tell_separates_for_sure_nowhere() {
        let (fifth, third, two_thirds) = (0.2, 1.0 / 3.0, 2.0 / 3.0);
        for (name, n, a, b) in [
            (
                "a of fractions",
                [1, 1, 1],
                points(vec![[part(1, 5), part(1, 5), part(1, 5)]]),
                points(vec![[float(fifth), float(fifth), float(fifth - 2f64.powi(-55))]]),
            ),
            (
                "b of fractions",
                [1, 1, 1],
                points(vec![[float(third), float(third + 2f64.powi(-54)), float(two_thirds)]]),
                points(vec![[part(1, 3), part(1, 3), part(2, 3)]]),
            ),
            (
                "overflow",
                [0, 0, 1],
                points(vec![[float(0.0), float(0.0), float(1.2e308)], [float(0.0), float(0.0), float(-1.2e308)]]),
                points(vec![[float(0.0), float(0.0), float(0.0)]]),
            ),
        ] {
            assert!(!separates(n, [&a, &b]), "{name}");
            let search = Search::new([a.set(), b.set()]);
            assert!(!search.surely_separates(n.map(f64::from)), "{name}");
        }
    }

    /// A narrow cone of directions, far from every plane of a face: cutting must keep track of which condition bounds it where.
    #[test]
    fn tetrahedra_that_only_a_skew_plane_separates_are_separated() {
        let halves = |of: [[i32; 3]; 4]| points(of.map(|p| p.map(|c| part(c, 2))).to_vec());
        for (n, a, b) in [
            (
                [2, -1, -6],
                halves([[6, 2, 4], [4, 0, 4], [0, 4, 2], [4, 2, 0]]),
                halves([[3, 4, 3], [1, 0, 3], [1, 4, 5], [-1, 4, 5]]),
            ),
            (
                [-7, 2, -6],
                halves([[0, 6, 0], [6, 6, 0], [0, 6, 4], [2, 4, 4]]),
                halves([[4, 7, 3], [6, 3, -1], [4, 7, 5], [2, 7, 5]]),
            ),
        ] {
            assert!(separates(n, [&a, &b]), "{n:?}");
            assert!(separate(a.set(), b.set()).is_separated, "{n:?}");
            assert!(separate(b.set(), a.set()).is_separated, "{n:?}, exchanged");
        }
    }
}
