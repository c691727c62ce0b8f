//! Volumes and centroids: closed forms under random maps, a second implementation by the divergence theorem, and bodies cut in two.

use super::blocks::{Surface, Units, cross, dot, matrix, shapes};
use num_rational::BigRational;
use num_traits::Zero;
use proptest::prelude::*;
use rockproof_model::{Block, BlockOptions, Number, Precision, Vec3};

type Place = [BigRational; 3];

fn fraction(numerator: i64, denominator: i64) -> BigRational {
    BigRational::new(numerator.into(), denominator.into())
}

fn whole(n: i128) -> BigRational {
    BigRational::from_integer(n.into())
}

fn block(vertices: &[Place], faces: &[Vec<usize>]) -> Block {
    let point =
        |[x, y, z]: &Place| Vec3::new(x.clone(), y.clone(), z.clone()).map(|c| Number::from_rational(c.clone()));
    let faces = faces.iter().map(|face| face.iter().map(|&v| v as u32).collect()).collect();
    Block::new(vertices.iter().map(point).collect(), faces, &BlockOptions::default()).expect("a block")
}

fn measured(block: &Block) -> (BigRational, Place) {
    let Vec3 { x, y, z } = block.centroid();
    (block.volume(), [x, y, z])
}

/// Volume and first moments as integrals over the surface. Each face is cut from the first vertex of its loop. Over a triangle abc with
/// w = (b − a) × (c − a), `6V = Σ a·w` and `48·∫x dV = Σ wₓ·((a + b)ₓ² + (b + c)ₓ² + (c + a)ₓ²)`. No vertex of the block is singled out.
fn by_divergence(vertices: &[Place], faces: &[Vec<usize>]) -> (BigRational, Place) {
    let (mut volume, mut moments) = (BigRational::zero(), [0; 3].map(|_| BigRational::zero()));
    for face in faces {
        for k in 1..face.len() - 1 {
            let [a, b, c] = [face[0], face[k], face[k + 1]].map(|v| &vertices[v]);
            for axis in 0..3 {
                let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
                let w = (&b[i] - &a[i]) * (&c[j] - &a[j]) - (&b[j] - &a[j]) * (&c[i] - &a[i]);
                let squares = [(a, b), (b, c), (c, a)].map(|(p, q)| (&p[axis] + &q[axis]) * (&p[axis] + &q[axis]));
                volume += &a[axis] * &w / whole(6);
                moments[axis] += w * squares.into_iter().sum::<BigRational>() / whole(48);
            }
        }
    }
    let centroid = moments.map(|moment| moment / &volume);
    (volume, centroid)
}

/// A pyramid with a square for its base, whose apex stands over a corner.
fn pyramid() -> Surface {
    Surface {
        vertices: vec![[0, 0, 0], [6, 0, 0], [6, 6, 0], [0, 6, 0], [0, 0, 4]],
        faces: vec![vec![0, 3, 2, 1], vec![0, 1, 4], vec![1, 2, 4], vec![2, 3, 4], vec![3, 0, 4]],
    }
}

/// Volumes and centroids by hand, as (numerator, denominator).
type ByHand = (&'static str, (i64, i64), [(i64, i64); 3]);
const BY_HAND: [ByHand; 7] = [
    ("box", (48, 1), [(2, 1), (1, 1), (3, 1)]),
    ("tetrahedron", (32, 3), [(1, 1), (1, 1), (1, 1)]),
    ("octahedron", (32, 3), [(0, 1), (0, 1), (0, 1)]),
    ("wedge", (48, 1), [(2, 1), (4, 3), (2, 1)]),
    // 8 × 8 around (4, 4) less 4 × 4 around (6, 6).
    ("L", (96, 1), [(10, 3), (10, 3), (1, 1)]),
    // A triangle of 32 around (4, 8/3) less one of 8 around (4, 2/3).
    ("arrow", (48, 1), [(4, 1), (10, 3), (1, 1)]),
    // A quarter of the way from (3, 3, 0) to the apex.
    ("pyramid", (48, 1), [(9, 4), (9, 4), (1, 1)]),
];

fn bodies() -> Vec<(&'static str, Surface)> {
    shapes().into_iter().chain([("pyramid", pyramid())]).collect()
}

/// A map of integers, then a shift by sevenths: what rounding to f32 cannot hold.
fn shifted(surface: &Surface, shift: [i64; 3]) -> Vec<Place> {
    let place = |v: &Units| [0, 1, 2].map(|axis| whole(v[axis]) + fraction(shift[axis], 7));
    surface.vertices.iter().map(place).collect()
}

fn shift() -> impl Strategy<Value = [i64; 3]> {
    prop::array::uniform3(-5000_i64..5000)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(if cfg!(debug_assertions) { 20 } else { 200 }))]

    #[test]
    fn volumes_and_centroids_are_those_of_closed_forms(number in 0_usize..7, matrix in matrix(), shift in shift()) {
        let (name, surface) = bodies().swap_remove(number);
        let (wanted, (n, d), centre) = BY_HAND[number];
        prop_assert_eq!(name, wanted);
        let determinant = dot(cross(matrix[0], matrix[1]), matrix[2]);
        let centre = centre.map(|(n, d)| fraction(n, d));
        let moved = [0, 1, 2].map(|row: usize| {
            (0..3).map(|k| whole(matrix[row][k]) * &centre[k]).sum::<BigRational>() + fraction(shift[row], 7)
        });
        let mapped = surface.mapped(matrix);
        let found = measured(&block(&shifted(&mapped, shift), &mapped.faces));
        prop_assert_eq!(found, (fraction(n, d) * whole(determinant), moved), "{}", name);
    }

    /// Also of blocks whose faces rounding has bent.
    #[test]
    fn volumes_and_centroids_are_those_of_the_divergence_theorem(number in 0_usize..7, matrix in matrix(), shift in shift()) {
        let (name, surface) = bodies().swap_remove(number);
        let surface = surface.mapped(matrix);
        let vertices = shifted(&surface, shift);
        let exact = block(&vertices, &surface.faces);
        prop_assert_eq!(measured(&exact), by_divergence(&vertices, &surface.faces), "{}", name);
        let rounded = exact.rounded(Precision::F32).expect("no overflow");
        let places: Vec<Place> =
            rounded.vertices().iter().map(|v| v.components().map(Number::to_rational)).collect();
        prop_assert_eq!(measured(&rounded), by_divergence(&places, &surface.faces), "{} in f32", name);
    }

    /// A tetrahedron cut at a point of one of its edges, and an L cut into two boxes: the parts add up to the whole.
    #[test]
    fn parts_add_up_to_the_whole(matrix in matrix(), shift in shift(), at in 1_i128..12) {
        let tetrahedron = |vertices: Vec<Units>| Surface { vertices, faces: shapes()[1].1.faces.clone() };
        let cuboid = |[x0, y0]: [i128; 2], [x1, y1]: [i128; 2]| {
            let corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
            let vertices = [0, 2].into_iter().flat_map(|z| corners.map(|[x, y]| [x, y, z])).collect();
            Surface { vertices, faces: shapes()[0].1.faces.clone() }
        };
        let (origin, far, y, z) = ([0; 3], [12, 0, 0], [0, 4, 0], [0, 0, 4]);
        let cut = [at, 0, 0];
        for (all, parts) in [
            (tetrahedron(vec![origin, far, y, z]), [tetrahedron(vec![origin, cut, y, z]), tetrahedron(vec![cut, far, y, z])]),
            (shapes()[4].1.clone(), [cuboid([0, 0], [8, 4]), cuboid([0, 4], [4, 8])]),
        ] {
            let measure = |surface: &Surface| {
                let mapped = surface.mapped(matrix);
                measured(&block(&shifted(&mapped, shift), &mapped.faces))
            };
            let (volume, centroid) = measure(&all);
            let parts = parts.map(|part| measure(&part));
            prop_assert_eq!(&volume, &(&parts[0].0 + &parts[1].0));
            for (axis, along) in centroid.iter().enumerate() {
                let moment: BigRational = parts.iter().map(|(volume, centroid)| volume * &centroid[axis]).sum();
                prop_assert_eq!(&volume * along, moment);
            }
        }
    }
}
