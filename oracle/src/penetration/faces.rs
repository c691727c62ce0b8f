//! How deep two convex blocks overlap at most, by the normals of their faces in f64.
//!
//! Of all directions that are measured exactly the one that parts the blocks by the least translation counts, so each of them bounds it from above: normals of
//! faces, which are few and cost no long numbers. Faces need not be planar, nor what is measured the least translation there is, so a normal of which f64 does not know
//! the direction well says nothing.

use crate::f64_vector::{cross, dot};
use rockproof_model::{Block, Number, VertexId};

/// The vertices of a block, and what f64 knows of the outward normals of its faces.
pub(super) struct FaceDirections {
    points: Vec<[f64; 3]>,
    normals: Vec<Normal>,
    /// No coordinate is larger.
    size: f64,
}

struct Normal {
    direction: [f64; 3],
    /// The exact normal is turned by no more (rad).
    turned: f64,
}

/// A normal of length |n| is turned by no more than so many roundoffs of the coordinates, times the corners of its face, times the longest distance of
/// one from the first, over |n|: coordinates and their differences are off by three roundoffs of the largest, a product of two by 26 times the distance,
/// the sum of them by 40, each component alike; and an angle below 1/2 is less than 1.1 times its sine.
const TURNED: f64 = 64.0 * f64::EPSILON;

/// Normals that may be turned by more say nothing.
const WELL_KNOWN: f64 = 1.0 / 1024.0;

/// A direction whose square is less may have lost digits to underflow.
const LEAST_SQUARE: f64 = 1e-200;

/// No more than this share of the largest coordinate is lost in measuring along a direction: half a roundoff of each coordinate, four of each product with
/// a direction, each √3 times, and four of the quotient, some 14 in all.
const LOST: f64 = 32.0 * f64::EPSILON;

/// To turn a direction by an angle moves a gap by no more than that angle times the distance of two points, which is below so many times the largest
/// coordinate.
const APART: f64 = 4.0;

impl FaceDirections {
    pub(super) fn of(block: &Block) -> FaceDirections {
        let points: Vec<[f64; 3]> = block.vertices().iter().map(|v| v.components().map(Number::approximate)).collect();
        let size = points.iter().flatten().fold(0.0, |most: f64, c| most.max(c.abs()));
        let normals = block.topology().faces().iter().filter_map(|face| Normal::of(face, &points, size)).collect();
        FaceDirections { points, normals, size }
    }
}

impl Normal {
    /// The normal of a face among points with no coordinate above `size`; `None` where f64 does not know it well.
    fn of(face: &[VertexId], points: &[[f64; 3]], size: f64) -> Option<Normal> {
        let first = points[face[0].index()];
        let arms: Vec<[f64; 3]> = face[1..]
            .iter()
            .map(|v| {
                let point = points[v.index()];
                [0, 1, 2].map(|axis| point[axis] - first[axis])
            })
            .collect();
        let direction = arms.windows(2).fold([0.0; 3], |sum, pair| {
            let part = cross(pair[0], pair[1]);
            [0, 1, 2].map(|axis| sum[axis] + part[axis])
        });
        let longest = arms.iter().map(|&arm| dot(arm, arm).sqrt()).fold(0.0, f64::max);
        let square = dot(direction, direction);
        let turned = TURNED * face.len() as f64 * longest * size / square.sqrt();
        (square > LEAST_SQUARE && turned < WELL_KNOWN).then_some(Normal { direction, turned })
    }
}

/// The blocks certainly overlap no deeper (m); not above zero where a normal proves them apart, infinite where none says anything.
pub(super) fn depth_bound(a: &FaceDirections, b: &FaceDirections) -> f64 {
    let size = a.size.max(b.size);
    // From B to A: against the outward normals of A, along those of B.
    let against = a.normals.iter().map(|n| (n.direction.map(|c| -c), n.turned));
    let along = b.normals.iter().map(|n| (n.direction, n.turned));
    let depths = against.chain(along).map(|(n, turned)| {
        let lowest = a.points.iter().map(|&p| dot(n, p)).fold(f64::INFINITY, f64::min);
        let highest = b.points.iter().map(|&p| dot(n, p)).fold(f64::NEG_INFINITY, f64::max);
        (highest - lowest) / dot(n, n).sqrt() + (LOST + APART * turned) * size
    });
    // Where numbers overflow nothing is known.
    depths.filter(|depth| depth.is_finite()).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::penetration::penetration;
    use num_rational::BigRational;
    use rockproof_model::Vec3;

    fn number(value: f64) -> Number {
        Number::from_f64(value).unwrap()
    }

    /// A cuboid of size 1 × 2 × 3 with corners moved by what a generator says, as a share of `bent`, turned, then moved by `x` along x.
    fn bent_cuboid(numbers: &mut u64, bent: f64, x: f64) -> Block {
        let mut next = || {
            *numbers = numbers.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (*numbers >> 40) as f64 / (1 << 24) as f64 - 0.5
        };
        let at = |c: [f64; 3]| Vec3::new(number(c[0]), number(c[1]), number(c[2]));
        let block = Block::cuboid(&at([0.0; 3]), &at([1.0, 2.0, 3.0])).unwrap();
        let (cosine, sine) = (0.8, 0.6);
        let moved = block.vertices().iter().map(|v| {
            let [a, b, c] = v.components().map(|c| c.approximate() + bent * next());
            at([cosine * a - sine * b + x, sine * a + cosine * b, c])
        });
        block.with_vertices(moved.collect())
    }

    #[test]
    fn no_pair_is_deeper_than_it_may_be_and_one_that_faces_part_is_nearly_as_deep() {
        let mut numbers = 7;
        let (mut overlap, mut near) = (0, 0);
        for far in [0.0, 1e3, 1e6] {
            for bent in [0.0, 1e-9, 1e-3] {
                for k in 0..12 {
                    let one = bent_cuboid(&mut numbers, bent, far);
                    let other = bent_cuboid(&mut numbers, bent, far + f64::from(k) / 8.0);
                    let most = depth_bound(&FaceDirections::of(&one), &FaceDirections::of(&other));
                    let found = penetration(&one, &other).unwrap();
                    if !found.gap.sign.is_negative() {
                        continue;
                    }
                    overlap += 1;
                    let square = BigRational::from_float(most).unwrap().pow(2);
                    assert!(most > 0.0 && square >= found.depth_squared(), "{far} {bent} {k}: {most}");
                    near += usize::from(most <= found.depth_m().unwrap() * 1.001 + far * 1e-10);
                }
            }
        }
        assert!(overlap > 80 && near > overlap / 2, "{near} of {overlap}");
    }

    #[test]
    fn faces_prove_blocks_apart_and_faces_without_area_nothing() {
        let mut numbers = 1;
        let of = |numbers: &mut u64, x: f64| FaceDirections::of(&bent_cuboid(numbers, 0.0, x));
        let (one, apart) = (of(&mut numbers, 0.0), of(&mut numbers, 4.0));
        assert!(depth_bound(&one, &apart) < 0.0 && depth_bound(&apart, &one) < 0.0);
        let block = bent_cuboid(&mut numbers, 0.0, 0.0);
        let line = block.vertices().iter().map(|v| Vec3::new(v.x.clone(), v.x.clone(), v.x.clone()));
        let line = FaceDirections::of(&block.with_vertices(line.collect()));
        assert_eq!(depth_bound(&line, &line), f64::INFINITY);
    }
}
