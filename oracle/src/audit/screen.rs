//! What f64 proves of overlaps before anything is calculated exactly, for blocks at places that a stepper gives in f64: pairs
//! that are apart, how deep others overlap at most, contacts whose gap is negative. A model at rest has many pairs that overlap
//! a little; the exact depth of one costs as much as a step of some of them.

use crate::boxes::{Box3, meeting_pairs};
use crate::f64_vector::dot;
use crate::number::{Approx, Ball, UNDERFLOW};
use crate::predicate::{Orientation, Polynomial, plane};
use crate::view::{ExactBlock, ExactPair, ExactView, LazyScales, Scales};
use rockproof_model::block::face_normal;
use rockproof_model::{Block, Entrance, Number, Vec3, VertexId};
use std::cell::OnceCell;

/// Blocks at places whose coordinates are f64, taken as exact.
pub struct Screen<'s> {
    bodies: Vec<ScreenedBlock<'s>>,
}

struct ScreenedBlock<'s> {
    shape: &'s Block,
    vertices: Vec<[f64; 3]>,
    bounds: Box3,
    directions: Vec<FaceDirection>,
    /// Bounds the coordinates.
    largest: f64,
}

/// A direction next to the normal of a face, outwards, and how far the block reaches along it.
struct FaceDirection {
    /// Of about unit length.
    along: [f64; 3],
    reach: f64,
    /// At most so far is `along` from the face's unit normal.
    error: f64,
}

impl<'s> Screen<'s> {
    /// Blocks with the vertices where each is now (m), in the order of the block's own; `None` where a coordinate is not finite.
    ///
    /// # Panics
    /// When a block has another number of vertices.
    pub fn new(blocks: impl IntoIterator<Item = (&'s Block, Vec<[f64; 3]>)>) -> Option<Screen<'s>> {
        let body = |(shape, vertices): (&'s Block, Vec<[f64; 3]>)| {
            assert_eq!(vertices.len(), shape.vertices().len(), "a moved block keeps its vertices");
            let is_finite = vertices.iter().flatten().all(|c| c.is_finite());
            is_finite.then(|| ScreenedBlock::new(shape, vertices))
        };
        Some(Screen { bodies: blocks.into_iter().map(body).collect::<Option<_>>()? })
    }

    /// The largest magnitude of a coordinate (m).
    pub fn largest_coordinate(&self) -> f64 {
        self.bodies.iter().fold(0.0, |most, body| most.max(body.largest))
    }

    /// A block where it is now.
    ///
    /// # Panics
    /// When there is no block of this number.
    pub fn block(&self, number: usize) -> Block {
        let body = &self.bodies[number];
        // Finite, as `new` has seen.
        let exactly = |c: f64| Number::from_f64(c).unwrap_or(Number::ZERO);
        body.shape
            .with_vertices(body.vertices.iter().map(|&[x, y, z]| Vec3::new(x, y, z).map(|&c| exactly(c))).collect())
    }

    /// The pairs whose boxes share more than their surfaces, the lower number first, in ascending order. All others are apart.
    pub fn pairs(&self) -> Vec<[usize; 2]> {
        let boxes: Vec<Box3> = self.bodies.iter().map(|body| body.bounds).collect();
        let mut pairs = meeting_pairs(&boxes);
        pairs.retain(|&[i, j]| boxes[i].overlaps(&boxes[j]));
        pairs.sort_unstable();
        pairs
    }

    /// The depth in m that the penetration of a pair certainly does not exceed, infinite where f64 knows none; `None` where the
    /// blocks certainly do not overlap.
    ///
    /// # Panics
    /// When there is no block of one of the numbers.
    pub fn greatest_depth(&self, blocks: [usize; 2]) -> Option<f64> {
        let bodies = blocks.map(|k| &self.bodies[k]);
        let span = bodies[0].bounds.span() + bodies[1].bounds.span();
        let size = bodies[0].largest.max(bodies[1].largest);
        let mut most = f64::INFINITY;
        for [own, other] in [bodies, [bodies[1], bodies[0]]] {
            for FaceDirection { along: n, reach, error } in &own.directions {
                let start = other.vertices.iter().map(|p| dot(*n, *p)).fold(f64::INFINITY, f64::min);
                let gap = start - reach;
                // As in `planes::separating_face`: twice what a dot product of three terms and a difference are off.
                let doubt = (n[0].abs() + n[1].abs() + n[2].abs()) * (size * (8.0 * f64::EPSILON)) + 16.0 * UNDERFLOW;
                if gap > doubt {
                    return None;
                }
                // Moving along the face's unit normal by so much parts the blocks: the gap is the difference of two points,
                // no farther from one another than both boxes are long, along a direction that is off by `error`.
                most = most.min((doubt - gap + error * span) * (1.0 + 8.0 * f64::EPSILON));
            }
        }
        // Of other blocks SPEC section 7 asks for the distance of a point from a surface, which uneven faces can make larger.
        if bodies.iter().all(|body| body.shape.is_convex()) { Some(most) } else { Some(f64::INFINITY) }
    }

    /// Whether the gap of an entrance of the pair is negative for certain; where not, `Pair::gap` knows.
    ///
    /// # Panics
    /// When there is no such block or feature.
    pub fn surely_negative_gap(&self, blocks: [usize; 2], entrance: &Entrance) -> bool {
        let [a, b] = blocks.map(|k| self.bodies[k].in_balls());
        let geometry = ExactPair { a, b };
        // No tolerance enters a gap.
        let no_scales = LazyScales { made: &OnceCell::new(), make: &Scales::none };
        let view = ExactView { geometry: &geometry, scales: no_scales };
        let (p, _) = plane(&view, entrance);
        let sign = p.certain_sign();
        let sign = match *entrance {
            Entrance::EdgeEdge(edge_a, edge_b) => {
                let side = Orientation { edge_a, edge_b }.value(&view).certain_sign();
                sign.zip(side).map(|(sign, side)| if side.is_negative() { sign.reversed() } else { sign })
            }
            Entrance::VertexFace(..) | Entrance::FaceVertex(..) => sign,
        };
        sign.is_some_and(|sign| sign.is_negative())
    }
}

impl<'s> ScreenedBlock<'s> {
    fn new(shape: &'s Block, vertices: Vec<[f64; 3]>) -> ScreenedBlock<'s> {
        let points: Vec<Vec3<Approx>> =
            vertices.iter().map(|&[x, y, z]| Vec3::new(x, y, z).map(|&c| Approx(c))).collect();
        let faces = shape.topology().faces().iter();
        ScreenedBlock {
            directions: faces.filter_map(|face| FaceDirection::new(face, &points)).collect(),
            bounds: Box3::of_points(&vertices),
            largest: vertices.iter().flatten().fold(0.0f64, |most, c| most.max(c.abs())),
            shape,
            vertices,
        }
    }

    /// For polynomials that follow the bounds of their errors.
    fn in_balls(&self) -> ExactBlock<'s, Ball> {
        let ball = |middle: f64| Ball { middle, radius: 0.0 };
        let vertices = self.vertices.iter().map(|&[x, y, z]| Vec3::new(ball(x), ball(y), ball(z)));
        ExactBlock::new(self.shape.topology(), vertices.collect())
    }
}

impl FaceDirection {
    /// `None` where rounding may make up much of the normal.
    fn new(face: &[VertexId], points: &[Vec3<Approx>]) -> Option<FaceDirection> {
        let n = array(&face_normal(points, face));
        let origin = &points[face[0].index()];
        let sides = face.iter().map(|v| array(&points[v.index()].minus(origin)));
        let longest = sides.flatten().fold(0.0f64, |most, c| most.max(c.abs()));
        let (size, square) = (dot(n, n).sqrt(), longest * longest);
        // A component of N is the sum of two products of sides for each triangle: 3 roundoffs for a product with its factors, one for
        // the difference, one a triangle for the sum, each of at most 2·square a triangle; times √3 for the three components.
        let triangles = (face.len() - 2) as f64;
        let doubt = 2.0 * (triangles + 4.0) * triangles * square * f64::EPSILON;
        // Below, underflow may lose more than that; what is not a number is left out as well.
        let is_known = square > 1e-200 && size.is_finite() && doubt < size / 1024.0;
        // Dividing by the length takes 6 roundoffs; a vector off by a share of its length turns by no more than twice that share.
        is_known.then(|| {
            let along = n.map(|c| c / size);
            let reach = points.iter().map(|p| dot(along, array(p))).fold(f64::NEG_INFINITY, f64::max);
            FaceDirection { along, reach, error: 2.5 * doubt / size + 4.0 * f64::EPSILON }
        })
    }
}

fn array(v: &Vec3<Approx>) -> [f64; 3] {
    [v.x.0, v.y.0, v.z.0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::audit::Auditor;
    use crate::{Pair, PreparedBlock};
    use num_rational::BigRational;
    use rockproof_model::preset::{Preset, derive};
    use rockproof_model::{BlockOptions, EdgeId, FaceId, Precision, Sign};

    fn cuboid(sides: [f64; 3]) -> Block {
        let corner = |c: [f64; 3]| Vec3::new(c[0], c[1], c[2]).map(|&c| Number::from_f64(c).expect("a number"));
        Block::cuboid(&corner([0.0; 3]), &corner(sides)).expect("a block")
    }

    /// The vertices of a block turned about two axes and moved.
    fn placed(block: &Block, [one, two]: [f64; 2], by: [f64; 3]) -> Vec<[f64; 3]> {
        let turn = |angle: f64, p: f64, q: f64| (p * angle.cos() - q * angle.sin(), p * angle.sin() + q * angle.cos());
        let place = |v: &Vec3<Number>| {
            let [x, y, z] = v.components().map(|c| c.approximate());
            let (x, y) = turn(one, x, y);
            let (y, z) = turn(two, y, z);
            [x + by[0], y + by[1], z + by[2]]
        };
        block.vertices().iter().map(place).collect()
    }

    /// Numbers from 0 to 1, always the same ones.
    fn shares() -> impl FnMut() -> f64 {
        let mut state = 11u64;
        move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / 2f64.powi(53)
        }
    }

    /// Two blocks beside, on or in one another: by all of their size, by a little, by the last bits; far away, too.
    fn cases(count: usize) -> Vec<[(Block, Vec<[f64; 3]>); 2]> {
        let mut share = shares();
        let case = |number: usize| {
            let [one, two] = [(); 2].map(|()| cuboid([0.5 + share(), 0.5 + share(), 0.5 + share()]));
            let small = [1.0, 1e-6, 1e-15, 0.0][number % 4];
            let turn = [share() * small, share() * small];
            let far = [0.0, 1e6][number / 4 % 2];
            let height = two.bounds().max.z.approximate();
            let by = match number % 4 {
                // Beside one another at an angle: boxes meet, and often the blocks do not.
                0 => [(); 3].map(|()| far + height * (0.6 + 0.4 * share())),
                _ => [far + 0.3 * share(), far + 0.3 * share(), far + height - small * (share() - 0.3)],
            };
            let under = placed(&two, [0.0; 2], [far; 3]);
            [(one.clone(), placed(&one, turn, by)), (two, under)]
        };
        (0..count).map(case).collect()
    }

    #[test]
    fn what_is_called_apart_or_bounded_is_so_exactly() {
        let [mut apart, mut near, mut loose] = [0; 3];
        for blocks in cases(480) {
            let screen = Screen::new(blocks.iter().map(|(block, at)| (block, at.clone()))).expect("finite");
            let prepared = [0, 1].map(|k| PreparedBlock::new(&screen.block(k)));
            let set =
                derive(Preset::Auto, &prepared.each_ref().map(PreparedBlock::block), Precision::F64).expect("a set");
            let depth = Auditor::new(&prepared, &set).depth([0, 1]);
            if screen.pairs().is_empty() {
                assert!(depth.is_none());
                continue;
            }
            match (screen.greatest_depth([0, 1]), depth) {
                (None, depth) => {
                    assert!(depth.is_none());
                    apart += 1;
                }
                (Some(_), None) => {}
                (Some(most), Some(depth)) => {
                    let exactly = BigRational::from_float(most).expect("finite");
                    assert!(depth.depth_squared() <= &exactly * &exactly, "{most} {depth:?}");
                    let depth = depth.depth_m().expect("a depth");
                    let is_near = most <= depth + 1e-12 * (1.0 + screen.largest_coordinate());
                    if is_near {
                        near += 1
                    } else {
                        loose += 1
                    };
                }
            }
        }
        // Bounds by faces are close but where edges cross.
        assert!(apart > 10 && near > 60 && near > 2 * loose, "{apart} {near} {loose}");
    }

    /// A tetrahedron that stands on its corner, at (1, 1, `corner`).
    fn on_its_corner(corner: f64) -> Block {
        let at = [[0.0, 0.0, 0.0], [1.0, 0.0, 1.0], [-1.0, 1.0, 1.0], [-1.0, -1.0, 1.0]];
        let vertices = at.map(|[x, y, z]| {
            Vec3::new(1.0 + x, 1.0 + y, corner + z).map(|&c: &f64| Number::from_f64(c).expect("a number"))
        });
        let faces = [[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]];
        Block::new(vertices.to_vec(), faces.map(Vec::from).to_vec(), &BlockOptions::default()).expect("a block")
    }

    /// A corner on the middle of a face that lies askew, in it or above it by no more than rounding moves it: in f64 some that are in it are above.
    #[test]
    fn blocks_that_overlap_by_less_than_f64_sees_are_not_called_apart() {
        let (slab, mut share) = (cuboid([2.0, 2.0, 1.0]), shares());
        let [mut overlapping, mut seem_apart] = [0; 2];
        for number in 0..2400 {
            let far = [0.0, 1e6][number % 2];
            let (turn, by) = ([share(), share()], [far + share(), far + share(), far + share()]);
            let corner = on_its_corner(1.0 - (share() - 0.5) * (1.0 + far) * f64::EPSILON);
            let screen = Screen::new([&slab, &corner].map(|block| (block, placed(block, turn, by)))).expect("finite");
            let prepared = [0, 1].map(|k| PreparedBlock::new(&screen.block(k)));
            let set =
                derive(Preset::Auto, &prepared.each_ref().map(PreparedBlock::block), Precision::F64).expect("a set");
            if Auditor::new(&prepared, &set).depth([0, 1]).is_none() {
                continue;
            }
            assert!(screen.greatest_depth([0, 1]).is_some() && screen.greatest_depth([1, 0]).is_some(), "{number}");
            overlapping += 1;
            let is_above =
                |face: &FaceDirection| screen.bodies[1].vertices.iter().all(|p| dot(face.along, *p) > face.reach);
            seem_apart += usize::from(screen.bodies[0].directions.iter().any(is_above));
        }
        assert!(overlapping > 500 && seem_apart > 10, "{overlapping} {seem_apart}");
    }

    #[test]
    fn a_gap_that_is_surely_negative_is_negative() {
        let [mut negative, mut open] = [0; 2];
        for blocks in cases(40) {
            let screen = Screen::new(blocks.iter().map(|(block, at)| (block, at.clone()))).expect("finite");
            let prepared = [0, 1].map(|k| PreparedBlock::new(&screen.block(k)));
            let pair = Pair::new(&prepared[0], &prepared[1]);
            let faces = |v| {
                (0..6).flat_map(move |f| {
                    [Entrance::VertexFace(VertexId(v), FaceId(f)), Entrance::FaceVertex(FaceId(f), VertexId(v))]
                })
            };
            let edges = (0..12).flat_map(|a| (0..12).map(move |b| Entrance::EdgeEdge(EdgeId(a), EdgeId(b))));
            for entrance in (0..8).flat_map(faces).chain(edges) {
                let exactly = pair.gap(&entrance).sign;
                if screen.surely_negative_gap([0, 1], &entrance) {
                    assert_eq!(exactly, Sign::Negative, "{entrance:?}");
                    negative += 1;
                } else if exactly == Sign::Negative {
                    open += 1;
                }
            }
        }
        assert!(negative > 1000 && open * 20 < negative, "{negative} {open}");
    }

    #[test]
    fn blocks_that_are_not_convex_are_not_bounded() {
        // An L and a cube in its foot.
        let profile = [[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [1.0, 1.0], [1.0, 4.0], [0.0, 4.0]];
        let at = |y: f64| {
            profile.map(|[x, z]| Vec3::new(x, y, z).map(|&c: &f64| Number::from_f64(c).expect("a number"))).to_vec()
        };
        let sides = (0..6).map(|k| vec![k, k + 6, (k + 1) % 6 + 6, (k + 1) % 6]);
        let faces = [(0..6).collect(), (6..12).rev().collect()].into_iter().chain(sides).collect();
        let l = Block::new([at(0.0), at(1.0)].concat(), faces, &BlockOptions::default()).expect("a block");
        let cube = cuboid([1.0; 3]);
        let by = [2.5, 0.25, 0.25];
        let screen = Screen::new([(&l, placed(&l, [0.0; 2], [0.0; 3])), (&cube, placed(&cube, [0.0; 2], by))]);
        let screen = screen.expect("finite");
        assert_eq!(screen.pairs(), [[0, 1]]);
        assert_eq!([[0, 1], [1, 0]].map(|pair| screen.greatest_depth(pair)), [Some(f64::INFINITY); 2]);
    }

    #[test]
    fn boxes_that_touch_make_no_pair_and_what_is_not_finite_no_screen() {
        let cube = cuboid([1.0; 3]);
        let at = |x: f64| (&cube, placed(&cube, [0.0; 2], [x, 0.0, 0.0]));
        let screen = Screen::new([at(0.0), at(1.0), at(1.0f64.next_down())]).expect("finite");
        assert_eq!(screen.pairs(), [[0, 2], [1, 2]]);
        assert!(Screen::new([at(0.0), at(f64::INFINITY)]).is_none());
    }
}
