//! Whether it is inside a block next to a place: how many triangles a ray from there crosses.
//!
//! Rays go along (1, k, k²). Seen along such a direction a triangle and a place have the coordinates y − k·x and z − k²·x, and a
//! ray passes through a triangle only where the triangle holds the place as seen. So of each block the triangles' boxes in
//! these two coordinates, rounded outwards, are kept in a tree for each k that is asked for, and only triangles whose boxes
//! hold the place are asked more.

use super::surfaces::{HomogeneousPoint, Surfaces, Triangle, ends_of};
use crate::boxes::{Box3, BoxTree};
use crate::number::Ball;
use num_bigint::BigInt;
use rockproof_model::ring::ExactRing;
use rockproof_model::{Ring, Sign, Vec3, VertexId};
use std::cell::RefCell;
use std::rc::Rc;

/// The triangles of a block seen along the directions asked for so far, k from 1 on.
#[derive(Default)]
pub(super) struct Rays(RefCell<Vec<Rc<BoxTree>>>);

/// What else must be asked, where a ray does not tell.
enum Next {
    /// Another ray: this one meets an edge, or lies in the plane of a triangle.
    Ray,
    /// Another place: this one is on a triangle.
    Place,
}

/// The way from a place to a vertex, times the place's denominator.
struct Way {
    vertex: VertexId,
    near: Vec3<Ball>,
}

/// Where a line passes a triangle.
enum Passage {
    Beside,
    Through,
    /// Through an edge or a corner.
    Edge,
}

impl Surfaces {
    /// Whether next to a place in a triangle of some plane it is inside a block: below the plane and above it, as the plane's
    /// vector across points. `None` where the place is on another triangle, which is not in the plane.
    ///
    /// A ray each way is followed, for the first k that tells. It leaves the plane at once, so that triangles in it are not
    /// crossed. A place that is on no triangle has such a k: the line of each edge and the plane of each triangle exclude two at
    /// most, but for the line of an edge through the place, which is then outside the triangle as every line sees it.
    pub(super) fn insides(&self, block: usize, place: &HomogeneousPoint, plane: &Triangle) -> Option<[bool; 2]> {
        // Outside the block's box nothing is inside.
        if !place.bounds().meets(&self.body(block).bounds) {
            return Some([false; 2]);
        }
        let told = (1i32..).find_map(|k| match self.insides_along(k, block, place, plane) {
            Ok(insides) => Some(Some(insides)),
            Err(Next::Place) => Some(None),
            Err(Next::Ray) => None,
        });
        told.flatten()
    }

    fn insides_along(
        &self,
        k: i32,
        block: usize,
        place: &HomogeneousPoint,
        plane: &Triangle,
    ) -> Result<[bool; 2], Next> {
        let leaves = self.along(plane, k);
        if leaves.is_zero() {
            return Err(Next::Ray);
        }
        let mut odd = [false; 2];
        for triangle in self.seen_along(k, block).meeting(&place.bounds_along(k)) {
            let triangle = &self.of_block(block)[triangle];
            let towards = self.along(triangle, k);
            let ways = triangle.corners.map(|v| self.way(place, block, v));
            if towards.is_zero() {
                // Beside its plane the line stays there.
                if self.before(triangle, place, &ways[0]).is_zero() {
                    return Err(Next::Ray);
                }
                continue;
            }
            let passage = self.passage(place, block, &ways, k, towards);
            if matches!(passage, Passage::Beside) {
                continue;
            }
            let before = self.before(triangle, place, &ways[0]);
            if before.is_zero() {
                if self.sides(plane, triangle).iter().all(|side| side.is_zero()) {
                    continue;
                }
                return Err(Next::Place);
            }
            if matches!(passage, Passage::Edge) {
                return Err(Next::Ray);
            }
            // Ahead of the place, or behind it.
            odd[usize::from(before == towards)] ^= true;
        }
        // What is ahead is above the plane where the ray goes up.
        Ok(if leaves.is_positive() { odd } else { [odd[1], odd[0]] })
    }

    /// How the line through a place along (1, k, k²) passes a triangle, seen from the place at `ways`, whose vector across
    /// points along it as `towards` says, not zero.
    fn passage(&self, place: &HomogeneousPoint, block: usize, ways: &[Way; 3], k: i32, towards: Sign) -> Passage {
        let mut touches = false;
        for i in 0..3 {
            let (p, q) = (&ways[i], &ways[(i + 1) % 3]);
            let near = p.near.cross(&q.near).dot(&ray(k));
            let sign = near.certain_sign().unwrap_or_else(|| {
                let [p, q] = [p, q].map(|way| self.exact_way(place, block, way.vertex));
                ExactRing::sign(&p.cross(&q).dot(&ray(k)))
            });
            if sign == towards.reversed() {
                return Passage::Beside;
            }
            touches |= sign.is_zero();
        }
        if touches { Passage::Edge } else { Passage::Through }
    }

    /// On which side of a place the plane of a triangle is, along its vector across; `first` leads to its first corner.
    fn before(&self, triangle: &Triangle, place: &HomogeneousPoint, first: &Way) -> Sign {
        let near = triangle.normal().dot(&first.near).certain_sign();
        near.unwrap_or_else(|| {
            let way = self.exact_way(place, triangle.block, first.vertex);
            ExactRing::sign(&triangle.across(self).dot(&way))
        })
    }

    /// The sign of a triangle's vector across along (1, k, k²).
    fn along(&self, triangle: &Triangle, k: i32) -> Sign {
        let near = triangle.normal().dot(&ray(k)).certain_sign();
        near.unwrap_or_else(|| ExactRing::sign(&triangle.across(self).dot(&ray(k))))
    }

    fn way(&self, place: &HomogeneousPoint, block: usize, vertex: VertexId) -> Way {
        let near = self.near_vertex(block, vertex).scaled(&place.near_denominator).minus(&place.near);
        Way { vertex, near }
    }

    fn exact_way(&self, place: &HomogeneousPoint, block: usize, vertex: VertexId) -> Vec3<BigInt> {
        self.vertex(block, vertex).scaled(&place.denominator).minus(&place.numerators)
    }

    /// The boxes of a block's triangles seen along (1, k, k²).
    fn seen_along(&self, k: i32, block: usize) -> Rc<BoxTree> {
        let mut trees = self.body(block).rays.0.borrow_mut();
        while trees.len() < k as usize {
            let k = trees.len() as i32 + 1;
            let bounds = |triangle: &Triangle| {
                let corners = triangle.corners.map(|v| seen(k, self.near_vertex(block, v)));
                flat_box([0, 1].map(|axis| ends_of(corners.iter().map(|corner| corner[axis]))))
            };
            trees.push(Rc::new(BoxTree::new(self.of_block(block).iter().map(bounds).collect())));
        }
        trees[k as usize - 1].clone()
    }
}

impl HomogeneousPoint {
    /// A box that certainly holds it.
    fn bounds(&self) -> Box3 {
        let along = |c: Ball| quotient(c, self.near_denominator);
        Box3::between([along(self.near.x), along(self.near.y), along(self.near.z)])
    }

    /// The same as seen along (1, k, k²).
    fn bounds_along(&self, k: i32) -> Box3 {
        flat_box(seen(k, &self.near).map(|c| quotient(c, self.near_denominator)))
    }
}

fn ray<T: Ring>(k: i32) -> Vec3<T> {
    let k = T::from_i32(k);
    Vec3::new(T::from_i32(1), k.clone(), k.squared())
}

/// The coordinates of a point seen along (1, k, k²).
fn seen(k: i32, p: &Vec3<Ball>) -> [Ball; 2] {
    let ray: Vec3<Ball> = ray(k);
    [p.y.minus(&ray.y.times(&p.x)), p.z.minus(&ray.z.times(&p.x))]
}

fn flat_box([across, up]: [[f64; 2]; 2]) -> Box3 {
    Box3::between([across, up, [0.0; 2]])
}

/// The least and the greatest value that a quotient may have whose denominator is certainly above zero; of what is no number,
/// all.
fn quotient(numerator: Ball, denominator: Ball) -> [f64; 2] {
    let [[low, high], [least, most]] = [numerator, denominator].map(|c| ends_of([c].into_iter()));
    let low = (low / if low < 0.0 { least } else { most }).next_down();
    let high = (high / if high < 0.0 { most } else { least }).next_up();
    [if low.is_nan() { f64::NEG_INFINITY } else { low }, if high.is_nan() { f64::INFINITY } else { high }]
}

#[cfg(test)]
mod tests {
    use super::*;
    use num_rational::BigRational;

    #[test]
    fn a_box_of_a_place_holds_it_as_every_direction_sees_it() {
        let values = [0, 1, -1, 3, -7, 1_000_003, i64::MAX, i64::MIN].map(BigInt::from);
        let values: Vec<BigInt> =
            values.iter().flat_map(|value| [value.clone(), value * 12_345_678_901i64 + 1]).collect();
        for (i, x) in values.iter().enumerate() {
            let [y, z] = [5, 9].map(|step| values[(i + step) % values.len()].clone());
            for denominator in [1, 3, -3, 1 << 40, i64::MAX].map(BigInt::from) {
                let place = HomogeneousPoint::new(Vec3::new(x.clone(), y.clone(), z.clone()), denominator.clone());
                let exact = Vec3::new(x, &y, &z).map(|&c| BigRational::new(c.clone(), denominator.clone()));
                let holds = |ends: [f64; 2], value: &BigRational| {
                    let [low, high] = ends.map(|end| BigRational::from_float(end).expect("a finite number"));
                    low <= *value
                        && *value <= high
                        && high - low <= (value * value + BigRational::from_float(1.0).unwrap())
                };
                let ends = |c: Ball| quotient(c, place.near_denominator);
                assert!(holds(ends(place.near.x), &exact.x) && holds(ends(place.near.z), &exact.z));
                for k in 1..5 {
                    let [across, up] = seen(k, &place.near).map(ends);
                    let ray: Vec3<i32> = Vec3::new(1, k, k * k);
                    let along = |factor: i32| &exact.x * BigRational::from_integer(factor.into());
                    assert!(across[0] <= across[1] && holds(across, &(&exact.y - along(ray.y))), "{exact:?} {k}");
                    assert!(holds(up, &(&exact.z - along(ray.z))), "{exact:?} {k}");
                }
            }
        }
    }

    #[test]
    fn a_quotient_of_what_is_no_number_may_be_anything() {
        let whole = |middle: f64, radius: f64| Ball { middle, radius };
        let all = [f64::NEG_INFINITY, f64::INFINITY];
        assert_eq!(quotient(whole(f64::NAN, 0.0), whole(0.75, 0.0)), all);
        assert_eq!(quotient(whole(0.0, f64::INFINITY), whole(0.75, 0.0)), all);
        assert_eq!(quotient(whole(1.0, f64::NAN), whole(0.75, 0.0)), all);
    }
}
