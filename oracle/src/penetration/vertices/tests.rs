//! Tests of where an edge passes through a triangle, and of points that are corners of neither block.

use super::*;

fn at([x, y, z]: [i32; 3]) -> Vec3<BigInt> {
    Vec3::new(x, y, z).map(|&c| BigInt::from(c))
}

/// The edge from `p` by `d` meets the triangle at this part of it, a fraction, or not at all: from whichever corner the
/// triangle is numbered, whichever way round, and the other way along the edge at what is left to one.
fn meets(triangle: [[i32; 3]; 3], p: [i32; 3], d: [i32; 3], expected: Option<[i32; 2]>) {
    let expected = expected.map(|[numerator, denominator]| BigRational::new(numerator.into(), denominator.into()));
    let [start, way, end] = [p, d, [0, 1, 2].map(|k| p[k] + d[k])].map(at);
    let [a, b, c] = triangle.map(at);
    for corners in [[&a, &b, &c], [&b, &c, &a], [&c, &a, &b], [&a, &c, &b], [&c, &b, &a], [&b, &a, &c]] {
        assert_eq!(crossing(&start, &way, corners), expected, "{corners:?} from {p:?} by {d:?}");
        let rest = expected.as_ref().map(|place| BigRational::one() - place);
        assert_eq!(crossing(&end, &way.negated(), corners), rest, "{corners:?} to {p:?} by {d:?}");
    }
}

/// In the plane z = 0.
const LEVEL: [[i32; 3]; 3] = [[0, 0, 0], [6, 0, 0], [0, 6, 0]];
/// In the plane x + y + z = 6.
const SLANTED: [[i32; 3]; 3] = [[6, 0, 0], [0, 6, 0], [0, 0, 6]];

#[test]
fn an_edge_crosses_a_triangle_where_it_passes_its_plane() {
    for [x, y] in [[1, 1], [4, 1], [2, 2]] {
        meets(LEVEL, [x, y, 3], [0, 0, -4], Some([3, 4]));
    }
    meets(LEVEL, [0, 0, 1], [2, 2, -3], Some([1, 3]));
    meets(LEVEL, [9, 9, 7], [-8, -8, -8], Some([7, 8]));
    meets(SLANTED, [0, 0, 0], [4, 4, 4], Some([1, 2]));
    meets(SLANTED, [1, 2, 3], [5, -7, 11], Some([0, 1]));
}

#[test]
fn the_boundary_of_a_triangle_belongs_to_it() {
    // The middles of its sides and its corners.
    for [x, y] in [[3, 0], [3, 3], [0, 3], [0, 0], [6, 0], [0, 6]] {
        meets(LEVEL, [x, y, 1], [0, 0, -3], Some([1, 3]));
        meets(LEVEL, [x - 1, y - 2, 1], [3, 6, -3], Some([1, 3]));
    }
    meets(SLANTED, [0, 0, 0], [6, 6, 0], Some([1, 2]));
    meets(SLANTED, [0, 0, 0], [0, 0, 9], Some([2, 3]));
}

#[test]
fn an_edge_beside_a_triangle_does_not_cross_it() {
    // Behind each side, in the angle behind each corner, and in line with each side at both of its ends.
    let behind_sides = [[3, -1], [4, 4], [-1, 3]];
    let behind_corners = [[-1, -1], [8, -1], [-1, 8]];
    let in_line = [[-1, 0], [7, 0], [7, -1], [-1, 7], [0, 7], [0, -1]];
    for [x, y] in behind_sides.into_iter().chain(behind_corners).chain(in_line) {
        meets(LEVEL, [x, y, 1], [0, 0, -3], None);
        meets(LEVEL, [x - 1, y - 2, 1], [3, 6, -3], None);
    }
    // These pass the planes at (4, 4, 0), at (6, 6, −6) and, after 9/20, at (4.55, 4.55, −3.1).
    meets(LEVEL, [1, 1, 1], [6, 6, -2], None);
    meets(SLANTED, [0, 0, 0], [6, 6, -6], None);
    meets(SLANTED, [5, 5, 5], [-1, -1, -18], None);
}

#[test]
fn the_ends_of_an_edge_belong_to_it_and_what_is_beyond_them_does_not() {
    meets(LEVEL, [1, 1, 0], [0, 0, 5], Some([0, 1]));
    meets(LEVEL, [1, 1, 5], [0, 0, -5], Some([1, 1]));
    meets(LEVEL, [0, 0, 0], [1, 1, 5], Some([0, 1]));
    meets(LEVEL, [1, 1, 1], [0, 0, 5], None);
    meets(LEVEL, [1, 1, 5], [0, 0, -4], None);
    meets(SLANTED, [0, 0, 0], [1, 1, 1], None);
    meets(SLANTED, [0, 0, 0], [2, 2, 2], Some([1, 1]));
}

#[test]
fn an_edge_along_the_plane_of_a_triangle_does_not_pass_through_it() {
    for z in [0, 2] {
        meets(LEVEL, [-1, 1, z], [9, 0, 0], None);
        meets(LEVEL, [0, 0, z], [6, 0, 0], None);
    }
    meets(SLANTED, [6, 0, 0], [-6, 6, 0], None);
    // Nor does any through a triangle without an area.
    meets([[0, 0, 0], [2, 2, 0], [4, 4, 0]], [2, 2, 1], [0, 0, -2], None);
}

#[test]
fn a_point_that_is_no_corner_is_as_deep_as_the_nearer_surface() {
    use rockproof_model::Number;
    let cube = |half: i32| {
        let end = |sign: i32| Vec3::new(half, half, half).map(|&c| Number::from_integer(sign * c));
        Block::cuboid(&end(-1), &end(1)).unwrap()
    };
    // (1, 0, 0) is 1 from the surface of the smaller and 5 from that of the larger cube.
    for [half, other] in [[2, 6], [6, 2]] {
        let (a, b) = (cube(half), cube(other));
        let pair = LatticePair::new(&a, &b);
        let view = View::of([&pair.points[0], &pair.points[1]]);
        let surfaces = [0, 1].map(|side| LatticeSurface::new(&pair, &view, side).unwrap());
        let point = Fraction::of(&pair.in_units([1.0, 0.0, 0.0]).unwrap());
        let found = deepest_common(&surfaces, None, std::iter::once(point)).unwrap();
        let square = pair.square_metres(found.nearest.numerator, found.nearest.denominator);
        assert_eq!(square, BigRational::one(), "{half} in {other}");
        assert_eq!(found.is_of_a, half == 6, "the point moves out of the smaller cube");
    }
}
