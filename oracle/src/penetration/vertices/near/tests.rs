//! f64 beside exact numbers: what it proves is so, ties and long numbers included, and it proves most of what is asked.

use super::super::{LatticeSurface, NearestPoint, crossing};
use super::*;
use crate::penetration::LatticePair;
use crate::point_in_surface::{surface_holds_origin, triangle_holds_origin};
use crate::soundness::Dice;
use num_rational::BigRational;
use rockproof_model::{BlockOptions, Number};

/// An L of width 4 and height 4, 3 deep, its corners moved by up to `spread` steps of the grid 2^−bits.
fn l_shape(dice: &mut Dice, bits: i32, spread: u64, far: i32) -> Block {
    let profile = [[4, 2], [2, 2], [2, 4], [0, 4], [0, 0], [4, 0]];
    let at = |y: i32| profile.iter().map(move |[x, z]| Vec3::new(*x, y, *z).map(|&c| Number::from_integer(c)));
    let mut faces: Vec<Vec<u32>> = vec![(0..6).collect(), (6..12).rev().collect()];
    faces.extend((0..6).map(|k| vec![k, k + 6, (k + 1) % 6 + 6, (k + 1) % 6]));
    let block = Block::new(at(0).chain(at(3)).collect(), faces, &BlockOptions::default()).expect("a block");
    let unit = 2f64.powi(-bits);
    let offset = [0, 1, 2].map(|_| dice.below(5) as i32 - 2);
    let mut along = |c: &Number, axis: usize| {
        let little = Number::from_f64((dice.below(2 * spread + 1) as f64 - spread as f64) * unit).expect("finite");
        c.plus(&little).plus(&Number::from_integer(offset[axis] + far))
    };
    let moved = block.vertices().iter().map(|v| Vec3::new(along(&v.x, 0), along(&v.y, 1), along(&v.z, 2)));
    block.with_vertices(moved.collect())
}

/// Pairs on coarse and on fine grids, close to the origin and far from it.
fn pairs() -> impl Iterator<Item = [Block; 2]> {
    let mut dice = Dice(11);
    (0..120).map(move |k| {
        let (bits, spread, far) = [(1, 0, 0), (1, 1, 0), (50, 3, 0), (60, 1 << 58, 0), (30, 5, 1 << 20)][k % 5];
        [0, 1].map(|_| l_shape(&mut dice, bits, spread, far))
    })
}

/// Looks at the surfaces of each of [`pairs`].
fn each_pair(mut look: impl FnMut(&View, [&LatticeSurface<'_>; 2])) {
    for [a, b] in pairs() {
        let pair = LatticePair::new(&a, &b);
        let view = View::of([&pair.points[0], &pair.points[1]]);
        let surfaces = [0, 1].map(|side| LatticeSurface::new(&pair, &view, side).expect("faces with areas"));
        look(&view, surfaces.each_ref());
    }
}

/// Vertices of the other block, and points between two of them a third of the way.
fn points(other: &LatticeSurface<'_>) -> Vec<Fraction> {
    let third = BigRational::new(1.into(), 3.into());
    let vertices = other.points.iter().map(|p| Fraction::whole(p.clone()));
    let between = other.points.windows(2).map(|two| Fraction::between(&two[0], &two[1].minus(&two[0]), &third));
    vertices.chain(between).collect()
}

/// Points on the middles of a surface's triangles and of their first sides, and so close to them that f64 sees no difference.
fn points_on(surface: &LatticeSurface<'_>) -> Vec<Fraction> {
    let finer = BigInt::from(1) << 80;
    let at = |v: VertexId| &surface.points[v.index()];
    let middles = triangle_corners(surface.block).flat_map(|[a, b, c]| {
        let side = at(a).plus(at(b));
        [(side.plus(at(c)), 3), (side, 2)]
    });
    let beside = |(sum, count): (Vec3<BigInt>, u32)| {
        let (numerators, denominator) = (sum.scaled(&finer), &finer * count);
        [-1, 0, 1].map(|way| {
            let off = Vec3::new(0, way, 2 * way).map(|&c| BigInt::from(c));
            Fraction { numerators: numerators.plus(&off), denominator: denominator.clone() }
        })
    };
    middles.flat_map(beside).collect()
}

/// Whether a point is inside and not on the surface, by exact numbers alone.
fn is_inside(surface: &LatticeSurface<'_>, point: &Fraction) -> bool {
    let ways: Vec<_> = surface.points.iter().map(|v| point.way_to(v)).collect();
    let around: Vec<_> = triangle_corners(surface.block).map(|all| all.map(|v| ways[v.index()].clone())).collect();
    !around.iter().any(|corners| triangle_holds_origin(corners.each_ref())) && surface_holds_origin(&around)
}

#[test]
fn a_point_is_inside_or_outside_where_f64_says_so() {
    let (mut inside, mut outside, mut open, mut open_inside) = (0, 0, 0, 0);
    each_pair(|view, surfaces| {
        for side in 0..2 {
            for point in points(surfaces[1 - side]).into_iter().chain(points_on(surfaces[side])) {
                let near = view.point(&point);
                let found = surfaces[side].near.holds(&near);
                let exact = is_inside(surfaces[side], &point);
                match found {
                    Some(true) => inside += 1,
                    Some(false) => outside += 1,
                    None => {
                        open += 1;
                        open_inside += usize::from(exact);
                    }
                }
                assert!(found.is_none_or(|found| found == exact), "{:?}", surfaces.map(|s| s.block));
                assert_eq!(surfaces[side].holds(&point, &near), exact, "{:?}", surfaces.map(|s| s.block));
            }
        }
    });
    assert!(inside > 200 && outside > 2_000 && open > 2_000, "{inside} inside, {outside} outside, {open} open");
    assert!(
        open_inside * 5 > open && open_inside * 2 < open,
        "of {open} that f64 leaves open {open_inside} are inside"
    );
}

#[test]
fn the_nearest_feature_is_among_those_that_f64_leaves() {
    let (mut left, mut all, mut close, mut points_asked) = (0, 0, 0, 0);
    each_pair(|view, surfaces| {
        for side in 0..2 {
            let surface = surfaces[side];
            let topology = surface.block.topology();
            let faces = (0..topology.faces().len()).map(Feature::Face);
            let edges = (0..topology.edges().len()).map(Feature::Edge);
            let every: Vec<_> = faces.chain(edges).chain((0..surface.points.len()).map(Feature::Vertex)).collect();
            for point in points(surfaces[1 - side]) {
                let NearestFeatures { features: few, most_squared } =
                    surface.near.nearest_features(&view.point(&point));
                let [one, two] = [&few, &every].map(|features| surface.nearest(&point, features).expect("a vertex"));
                let parts = |p: &NearestPoint| (p.numerator.clone(), p.denominator.clone(), p.way.clone());
                assert_eq!(parts(&one), parts(&two), "{few:?}");
                let square = view.square(&one.numerator, &one.denominator);
                if let Some(most) = BigRational::from_float(most_squared) {
                    let unit = BigRational::from_integer(BigInt::from(1) << (2 * view.shift));
                    let exact = BigRational::new(one.numerator.clone(), one.denominator.clone()) / unit;
                    assert!(exact <= most, "{few:?}");
                }
                close += usize::from(most_squared * (1.0 - 1e-9) <= square.most);
                points_asked += 1;
                left += few.len();
                all += every.len();
            }
        }
    });
    assert!(left * 8 < all, "{left} of {all}");
    assert!(close * 10 > points_asked * 9, "the bound is close for {close} of {points_asked}");
}

#[test]
fn an_edge_that_f64_sees_pass_by_crosses_nothing() {
    let (mut passing, mut open) = (0, 0);
    each_pair(|_, [own, other]| {
        for edge in own.block.topology().edges() {
            let [p, q] = [edge.p, edge.q].map(|v| &own.points[v.index()]);
            for (triangle, corners) in triangle_corners(other.block).enumerate() {
                if other.near.may_be_crossed(&own.near, [edge.p, edge.q], triangle) {
                    open += 1;
                    continue;
                }
                passing += 1;
                let corners = corners.map(|v| &other.points[v.index()]);
                assert_eq!(crossing(p, &q.minus(p), corners), None, "{:?} {:?}", own.block, other.block);
            }
        }
    });
    assert!(passing > 8 * open, "{passing} pass by, {open} may not");
}
