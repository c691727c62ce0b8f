//! Faces that meet, on many surfaces: small grids full of ties against a plain calculation, jagged blocks, and times.

use super::meeting::{Mesh, accepted, build, ring};
use super::*;

/// An octahedron whose faces are cut into `parts²` triangles: directions, and loops.
fn octahedron(parts: i32) -> (Vec<[i32; 3]>, Vec<Vec<u32>>) {
    let mut numbers = std::collections::BTreeMap::new();
    let mut faces = Vec::new();
    for signs in 0..8 {
        let [sx, sy, sz] = [1, 2, 4].map(|bit| if signs & bit == 0 { 1 } else { -1 });
        let mut at = |i: i32, j: i32| {
            let next = numbers.len() as u32;
            *numbers.entry([sx * i, sy * j, sz * (parts - i - j)]).or_insert(next)
        };
        for i in 0..parts {
            for j in 0..parts - i {
                let mut triangles = vec![vec![at(i, j), at(i + 1, j), at(i, j + 1)]];
                if i + j + 2 <= parts {
                    triangles.push(vec![at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
                if sx * sy * sz < 0 {
                    triangles.iter_mut().for_each(|t| t.reverse());
                }
                faces.extend(triangles);
            }
        }
    }
    let mut directions = vec![[0; 3]; numbers.len()];
    numbers.into_iter().for_each(|(direction, number)| directions[number as usize] = direction);
    (directions, faces)
}

/// The corners of the common part of two triangles, by clipping one with the planes of the other, in fractions.
fn common_part(triangle: &[Vec3<BigRational>], other: &[Vec3<BigRational>]) -> Vec<Vec3<BigRational>> {
    let normal = other[1].minus(&other[0]).cross(&other[2].minus(&other[0]));
    let mut planes = vec![(normal.clone(), 0), (normal.negated(), 0)];
    planes.extend((0..3).map(|k| (normal.cross(&other[(k + 1) % 3].minus(&other[k])), k)));
    let mut part = triangle.to_vec();
    for (inward, k) in planes {
        let height = |v: &Vec3<BigRational>| inward.dot(&v.minus(&other[k]));
        let mut clipped = Vec::new();
        for (i, v) in part.iter().enumerate() {
            let w = &part[(i + 1) % part.len()];
            let (at_v, at_w) = (height(v), height(w));
            if !at_v.is_negative() {
                clipped.push(v.clone());
            }
            if at_v.is_positive() && at_w.is_negative() || at_v.is_negative() && at_w.is_positive() {
                clipped.push(v.plus(&w.minus(v).scaled(&(&at_v / (&at_v - &at_w)))));
            }
        }
        part = clipped;
    }
    part
}

/// Whether the triangles have common points other than those of their common corners and of the line between two.
fn runs_through_itself((vertices, faces): &Mesh) -> bool {
    let places: Vec<Vec3<BigRational>> = vertices.iter().map(|v| v.map(Number::to_rational)).collect();
    let corners = |face: &Vec<u32>| face.iter().map(|&v| places[v as usize].clone()).collect::<Vec<_>>();
    let is_allowed = |place: &Vec3<BigRational>, shared: &[&Vec3<BigRational>]| match shared {
        [a] => place == *a,
        [a, b] => {
            let (to_a, to_b) = (a.minus(place), b.minus(place));
            to_a.cross(&to_b).norm_squared().is_zero() && !to_a.dot(&to_b).is_positive()
        }
        _ => false,
    };
    faces.iter().enumerate().any(|(i, f)| {
        faces[..i].iter().any(|g| {
            let shared: Vec<_> = f.iter().filter(|v| g.contains(v)).map(|&v| &places[v as usize]).collect();
            common_part(&corners(f), &corners(g)).iter().any(|place| !is_allowed(place, &shared))
        })
    })
}

#[test]
fn small_grids_agree_with_clipping() {
    agree_on_small_grids(8_000);
}

#[test]
#[ignore = "three seconds; .ci/run runs it"]
fn small_grids_agree_with_clipping_at_full_size() {
    agree_on_small_grids(20_000);
}

fn agree_on_small_grids(surfaces: usize) {
    // Octahedra with corners on a grid of 4³ points are full of ties; both answers must be frequent.
    let mut seed = 7_u64;
    let mut random = |below: u64| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) % below
    };
    let faces = octahedron(1).1;
    let (mut whole, mut pierced) = (0, 0);
    for _ in 0..surfaces {
        let vertices: Vec<Point> = (0..6)
            .map(|_| Vec3::new(random(4), random(4), random(4)).map(|&c| Number::from_integer(c as i32)))
            .collect();
        let mesh = (vertices, faces.clone());
        let expected = match build(mesh.clone()) {
            Ok(_) => false,
            Err(BlockError::FacesMeet { .. }) => true,
            Err(_) => continue,
        };
        *(if expected { &mut pierced } else { &mut whole }) += 1;
        assert_eq!(runs_through_itself(&mesh), expected, "{mesh:?}");
    }
    assert!(whole * 100 > surfaces && pierced * 100 > surfaces, "{whole} blocks, {pierced} refused");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Every surface that each ray from the origin meets once is accepted, however jagged.
    #[test]
    fn star_shaped_blocks_are_accepted(radii in prop::collection::vec(1_i32..1_000_000, 38)) {
        let (directions, faces) = octahedron(3);
        prop_assert_eq!(directions.len(), 38);
        let vertices = directions.iter().zip(&radii).map(|(direction, &radius)| {
            let [x, y, z] = direction.map(|c| Number::from_integer(c * radius));
            Vec3::new(x, y, z)
        });
        let block = accepted((vertices.collect(), faces));
        prop_assert!(block.topology().faces().len() > 60);
    }
}

/// Prints how long it takes to build blocks of 12, 200 and 2,000 faces: `cargo test -- --ignored --nocapture times`.
#[test]
#[ignore = "a measurement"]
fn building_times() {
    let jagged = |parts: i32, spread: u64| {
        let (directions, faces) = octahedron(parts);
        let place = |(k, d): (usize, &[i32; 3])| {
            let length = d.iter().map(|&c| f64::from(c * c)).sum::<f64>().sqrt();
            let radius = 1.0 + ((k as u64 * 7919) % 1000 * spread) as f64 * 1e-4;
            let [x, y, z] = d.map(|c| Number::from_f64(f64::from(c) / length * radius).unwrap());
            Vec3::new(x, y, z)
        };
        (directions.iter().enumerate().map(place).collect::<Vec<Point>>(), faces)
    };
    let round = |sides: i32| {
        let corner = |k: i32| {
            let angle = f64::from(k) / f64::from(sides) * std::f64::consts::TAU;
            (angle.cos(), angle.sin())
        };
        let level = |z: f64| {
            let at = move |v: f64| Number::from_f64(v).unwrap();
            (0..sides).map(move |k| Vec3::new(at(corner(k).0), at(corner(k).1), at(z)))
        };
        let faces = prism(&vec![(0, 0); sides as usize]).1;
        (level(0.0).chain(level(1.0)).collect::<Vec<Point>>(), faces)
    };
    let cuboid = cuboid_mesh(&point("0.1 0.2 0.3"), &point("1.7 1/3 0.7"));
    let meshes = [
        ("cuboid", cuboid),
        ("prism of 12 faces", round(10)),
        ("prism of 200 faces", round(198)),
        ("prism of 2000 faces", round(1998)),
        ("jagged, 8 faces", jagged(1, 2)),
        ("convex, 200 faces", jagged(5, 0)),
        ("jagged, 200 faces", jagged(5, 2)),
        ("convex, 2048 faces", jagged(16, 0)),
        ("jagged, 2048 faces", jagged(16, 2)),
        ("notched", prism(&[(0, 0), (6, 0), (6, 4), (4, 4), (3, 1), (2, 4), (0, 4)])),
        ("comb of 202 faces", prism(&comb(100))),
        ("torus", ring(4, -1)),
    ];
    for (name, mesh) in meshes {
        let faces = mesh.1.len();
        let repeats = (4000 / faces).max(3);
        let start = std::time::Instant::now();
        for _ in 0..repeats {
            Block::new(mesh.0.clone(), mesh.1.clone(), &BlockOptions::default()).unwrap();
        }
        println!("{name:20} {faces:5} faces {:9.3} ms", start.elapsed().as_secs_f64() * 1e3 / repeats as f64);
    }
}

/// A polygon of `teeth` teeth.
fn comb(teeth: i32) -> Vec<(i32, i32)> {
    let mut outline = vec![(0, 0), (2 * teeth - 1, 0)];
    outline.extend((0..2 * teeth).rev().map(|x| (x, if x % 2 == 0 { 9 } else { 1 })));
    outline
}
