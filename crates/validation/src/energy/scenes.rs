//! What falls: bricks and other shapes, turned and placed by sequences that are the same on every machine.

use crate::stepped_scene::{CaseFailure, cuboid, hexahedron, number, polyhedron, vector};
use rockproof_model::scene::SceneBlock;
use rockproof_model::simulation::Unconverged;
use rockproof_model::{Block, Motion, Scene};

rockproof_model::named_enum! {
    /// Scenes of the energy suites.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum DropScene {
        /// Two bricks that turn fall on one another and on a floor.
        Tumbling = "two tumbling bricks",
        /// A brick falls on an edge.
        Edge = "a brick on its edge",
        /// A brick falls on a corner.
        Corner = "a brick on its corner",
        /// Ten bricks are poured into a bin.
        Poured = "ten bricks poured into a bin",
        /// Eight shapes fall on a floor: tetrahedra, prisms, bricks, hulls of points.
        Mixed = "eight mixed shapes",
    }
}

/// Half a brick (m).
const BRICK: [f64; 3] = [0.5, 0.25, 0.2];

impl DropScene {
    /// How many variants there are.
    pub fn variants(self) -> u32 {
        8
    }

    /// How long it runs (s).
    pub fn duration(self) -> f64 {
        match self {
            DropScene::Tumbling | DropScene::Edge | DropScene::Corner => 1.0,
            DropScene::Poured | DropScene::Mixed => 1.5,
        }
    }

    /// A variant of the scene: 10 m/s² downwards, 2600 kg/m³, springs of 1e8 N/m, tan φ = 1/2; Δt is that of the default.
    pub(super) fn build(self, variant: u32, motion: Motion) -> Result<Scene, CaseFailure> {
        let mut scene = Scene::on_fixed("floor", cuboid([-4.0, -4.0, -1.0], [4.0, 4.0, 0.0])?);
        match self {
            DropScene::Tumbling => tumbling(&mut scene, variant)?,
            DropScene::Edge | DropScene::Corner => dropped(&mut scene, self == DropScene::Corner, variant)?,
            DropScene::Poured => poured(&mut scene, variant)?,
            DropScene::Mixed => mixed(&mut scene, variant)?,
        }
        for block in scene.blocks.iter_mut().filter(|block| !block.body.is_fixed()) {
            block.body.motion = motion;
        }
        scene.simulation.gravity = vector([0.0, 0.0, -10.0])?;
        scene.simulation.control.unconverged = Unconverged::Accept;
        let joint = &mut scene.simulation.joints.other;
        (joint.friction, joint.normal_stiffness) = (number(0.5)?, Some(number(1e8)?));
        Ok(scene)
    }
}

fn tumbling(scene: &mut Scene, variant: u32) -> Result<(), CaseFailure> {
    let share = f64::from(variant) / 4.0;
    let lower = cuboid([0.0, 0.0, 0.25], [2.0, 1.0, 1.25])?;
    let upper = cuboid([0.5 - share, share / 2.0, 2.0], [2.5 - share, 1.0 + share / 2.0, 3.0])?;
    for (name, block, velocity, spin) in
        [("lower", lower, [0.5, 0.0, 0.0], [0.5, 1.0 + share, 0.0]), ("upper", upper, [0.0; 3], [-share, -1.0, 0.25])]
    {
        let mut block = SceneBlock::new(name, block);
        (block.body.velocity, block.body.spin) = (vector(velocity)?, vector(spin)?);
        scene.blocks.push(block);
    }
    Ok(())
}

/// Variant 0 falls with its centre exactly above the edge or corner, the others lean.
fn dropped(scene: &mut Scene, on_corner: bool, variant: u32) -> Result<(), CaseFailure> {
    let [a, b, c] = BRICK;
    // The turn about y that brings the diagonal of the face across y upright, and for a corner that of the whole brick.
    let upright = (a / c).atan();
    let lean = 0.1 * f64::from(variant) * if variant.is_multiple_of(2) { 1.0 } else { -1.0 };
    let about_y = turn([0.0, 1.0, 0.0], upright + lean);
    let about_x = turn([1.0, 0.0, 0.0], if on_corner { (b / a.hypot(c)).atan() + lean / 2.0 } else { 0.0 });
    let turned: Vec<[f64; 3]> = brick().into_iter().map(|p| apply(about_x, apply(about_y, p))).collect();
    scene.blocks.push(SceneBlock::new("brick", standing(&turned, &hexahedron(), [0.0, 0.0, 0.5])?));
    Ok(())
}

fn poured(scene: &mut Scene, variant: u32) -> Result<(), CaseFailure> {
    for (name, low, high) in [
        ("west", [-1.4, -1.2, 0.0], [-1.2, 1.2, 2.0]),
        ("east", [1.2, -1.2, 0.0], [1.4, 1.2, 2.0]),
        ("south", [-1.2, -1.4, 0.0], [1.2, -1.2, 2.0]),
        ("north", [-1.2, 1.2, 0.0], [1.2, 1.4, 2.0]),
    ] {
        let mut wall = SceneBlock::new(name, cuboid(low, high)?);
        wall.body.motion = Motion::Fixed;
        scene.blocks.push(wall);
    }
    for k in 0..10 {
        let turned = turned(&brick(), 10 * variant + k);
        let [x, y] = [0, 1].map(|axis| 0.8 * spread(10 * variant + k, 3 + axis));
        // No two overlap: half the diagonal of a brick is 0.6 m.
        let z = 0.2 + 0.65 * f64::from(k) * 2.0;
        scene.blocks.push(SceneBlock::new(format!("brick_{k}"), standing(&turned, &hexahedron(), [x, y, z])?));
    }
    Ok(())
}

fn mixed(scene: &mut Scene, variant: u32) -> Result<(), CaseFailure> {
    let third = |k: u32| 2.0 * std::f64::consts::PI * f64::from(k) / 3.0;
    let triangle = |z: f64| (0..3).map(move |k| [0.5 * third(k).cos(), 0.5 * third(k).sin(), z]);
    let tetrahedron: Vec<[f64; 3]> = triangle(-0.25).chain([[0.0, 0.0, 0.5]]).collect();
    let prism: Vec<[f64; 3]> = triangle(-0.4).chain(triangle(0.4)).collect();
    let prism_faces = vec![vec![0, 2, 1], vec![3, 4, 5], vec![0, 1, 4, 3], vec![1, 2, 5, 4], vec![2, 0, 3, 5]];
    for k in 0..8u32 {
        let place = 8 * variant + k;
        let (points, faces) = match k % 4 {
            0 => (tetrahedron.clone(), hull(&tetrahedron)),
            1 => (prism.clone(), prism_faces.clone()),
            2 => (brick(), hexahedron()),
            _ => {
                let points: Vec<[f64; 3]> = (0..10).map(|n| on_sphere(16 * place + n)).collect();
                let faces = hull(&points);
                (points, faces)
            }
        };
        let turned = turned(&points, place);
        let [x, y] = [0, 1].map(|axis| 0.8 * spread(place, 3 + axis));
        let z = 0.2 + 1.3 * f64::from(k / 2) + 0.1 * f64::from(k % 2);
        // Two beside one another in each layer.
        let aside = if k % 2 == 0 { -0.65 } else { 0.65 };
        scene.blocks.push(SceneBlock::new(format!("shape_{k}"), standing(&turned, &faces, [aside + 0.1 * x, y, z])?));
    }
    Ok(())
}

/// The k-th number of a sequence between −1/2 and 1/2 that fills it evenly; each `dimension` below 8 has one of its own.
fn spread(k: u32, dimension: usize) -> f64 {
    const ROOTS: [f64; 8] = [2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0];
    (f64::from(k + 1) * ROOTS[dimension].sqrt()).fract() - 0.5
}

/// A point on a sphere of half a metre.
fn on_sphere(k: u32) -> [f64; 3] {
    let (z, angle) = (2.0 * spread(k, 5), 2.0 * std::f64::consts::PI * spread(k, 6));
    let across = 0.5 * (1.0 - z * z).sqrt();
    [across * angle.cos(), across * angle.sin(), 0.5 * z]
}

type Rotation = [[f64; 3]; 3];

/// The rotation about a unit vector by an angle.
fn turn(axis: [f64; 3], angle: f64) -> Rotation {
    let (sine, cosine) = angle.sin_cos();
    let [x, y, z] = axis;
    let skew = [[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]];
    std::array::from_fn(|r| {
        std::array::from_fn(|c| {
            let unit = if r == c { cosine } else { 0.0 };
            unit + (1.0 - cosine) * axis[r] * axis[c] + sine * skew[r][c]
        })
    })
}

fn apply(rotation: Rotation, point: [f64; 3]) -> [f64; 3] {
    rotation.map(|row| row.iter().zip(point).map(|(a, b)| a * b).sum())
}

/// Points turned by the k-th rotation of a sequence.
fn turned(points: &[[f64; 3]], k: u32) -> Vec<[f64; 3]> {
    let [x, y, z] = [0, 1, 2].map(|d| spread(k, d) + 0.01);
    let length = (x * x + y * y + z * z).sqrt();
    let rotation = turn([x / length, y / length, z / length], 2.0 * std::f64::consts::PI * spread(k, 7));
    points.iter().map(|&point| apply(rotation, point)).collect()
}

fn brick() -> Vec<[f64; 3]> {
    let [a, b, c] = BRICK;
    let base = |z: f64| [[-a, -b, z], [a, -b, z], [a, b, z], [-a, b, z]];
    base(-c).into_iter().chain(base(c)).collect()
}

/// The triangles of the hull of points no four of which lie in a plane.
fn hull(points: &[[f64; 3]]) -> Vec<Vec<u32>> {
    let less = |a: [f64; 3], b: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| a[k] - b[k]) };
    let volume = |a: usize, b: usize, c: usize, d: usize| {
        let [u, v, w] = [b, c, d].map(|k| less(points[k], points[a]));
        u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0])
    };
    let all = 0..points.len();
    let mut faces = Vec::new();
    for a in all.clone() {
        for b in a + 1..points.len() {
            for c in b + 1..points.len() {
                let mut sides = all.clone().filter(|d| ![a, b, c].contains(d)).map(|d| volume(a, b, c, d) > 0.0);
                let Some(first) = sides.next() else { continue };
                if sides.all(|side| side == first) {
                    // Seen from outside the corners go round against the clock.
                    let order = if first { [a, c, b] } else { [a, b, c] };
                    faces.push(order.map(|k| k as u32).to_vec());
                }
            }
        }
    }
    faces
}

/// A block of these points, moved so that the middle of their box is above (x, y) and their lowest is at z.
fn standing(points: &[[f64; 3]], faces: &[Vec<u32>], [x, y, z]: [f64; 3]) -> Result<Block, CaseFailure> {
    let ends = |axis: usize| {
        let along = points.iter().map(|p| p[axis]);
        [along.clone().fold(f64::INFINITY, f64::min), along.fold(f64::NEG_INFINITY, f64::max)]
    };
    let middle = |axis: usize| ends(axis).iter().sum::<f64>() / 2.0;
    let offset = [x - middle(0), y - middle(1), z - ends(2)[0]];
    polyhedron(points.iter().map(|p| std::array::from_fn(|k| p[k] + offset[k])), faces.to_vec())
}
