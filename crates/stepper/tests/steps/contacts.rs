//! e-e contacts, what a contact carries from step to step, islands.

use crate::support::{begin, cube, cuboid, floor, n, near, run, scene, v, weightless};
use rockproof_model::scene::SceneBlock;
use rockproof_model::{Block, BlockOptions, ContactKind, Motion, Number, Scene, Vec3};
use rockproof_stepper::dynamics::{Dynamics, Mode};

/// A roof of 2 m length whose ridge lies in the plane z = 0: along x from below, or along y from above.
fn roof(name: &str, from_below: bool, motion: Motion) -> SceneBlock {
    let along = |a: i32, b: i32, z: i32| {
        let point = if from_below { [a, b, z] } else { [b, -a, z] };
        let [x, y, z] = point.map(Number::from_integer);
        Vec3::new(x, y, z)
    };
    let depth = if from_below { -1 } else { 1 };
    let corners = [(-1, -1, depth), (1, -1, depth), (1, 1, depth), (-1, 1, depth), (-1, 0, 0), (1, 0, 0)];
    let vertices = corners.map(|(a, b, z)| along(a, b, z)).to_vec();
    let mut faces = vec![vec![0, 3, 2, 1], vec![0, 1, 5, 4], vec![2, 3, 4, 5], vec![1, 2, 5], vec![3, 0, 4]];
    if !from_below {
        faces.iter_mut().for_each(|face: &mut Vec<u32>| face.reverse());
    }
    let block = Block::new(vertices, faces, &BlockOptions::default()).unwrap();
    let mut block = SceneBlock::new(name, block);
    block.body.motion = motion;
    block
}

#[test]
fn crossed_ridges_bear_in_one_edge_contact() {
    let mut scene = scene(vec![roof("below", true, Motion::Fixed), roof("above", false, Motion::Rigid)]);
    scene.simulation.control.settle = 100;
    let (dynamics, _) = run::<f64>(&scene, 130);
    let contacts = &dynamics.state().contacts;
    assert_eq!(contacts.len(), 1, "{contacts:?}");
    assert_eq!((contacts[0].contact.kind(), contacts[0].mode), (ContactKind::EdgeEdge, Mode::Locked));
    // 2 m³ of 2000 kg/m³, on one spring. The normal points from B to A: downwards.
    near(contacts[0].force.z, -40000.0, 1e-9);
    near(contacts[0].gap, -40000.0 / 1e8, 1e-9);
    assert!(contacts[0].points.iter().all(|p| p.x.abs() < 1e-12 && p.y.abs() < 1e-12));
}

#[test]
fn feet_that_wander_along_edges_lose_no_slip() {
    // The upper roof is dragged along x, so that the foot on its ridge stays and the one on the lower ridge wanders; then along y, where it
    // is the other way round. Friction is μN against the slip either way, N = 40 kN on 4000 kg: 10 μ m/s².
    for along in [0, 1] {
        let mut scene = scene(vec![roof("below", true, Motion::Fixed), roof("above", false, Motion::Rigid)]);
        scene.simulation.control.settle = 60;
        scene.simulation.joints.other.friction = n("1/20");
        scene.blocks[1].body.velocity = if along == 0 { v("1/2", "0", "0") } else { v("0", "1/2", "0") };
        let (dynamics, _) = run::<f64>(&scene, 60 + 10);
        let at = dynamics.centroid(1);
        let way = [at.x, at.y][along];
        near(way, 0.5 * 0.1 - 0.5 * 0.5 * 0.01, 2e-3);
    }
}

/// A block that begins on the corner of a floor and slides inwards: gravity leans by 3 m/s² both ways, μ = 1/4.
fn from_the_corner() -> Scene {
    let floor = cuboid("floor", ["0", "0", "-1"], ["8", "8", "0"], Motion::Fixed);
    let mut scene = scene(vec![floor, cube()]);
    scene.simulation.joints.other.friction = n("1/4");
    scene.simulation.control.settle = 60;
    scene.simulation.gravity = v("3", "3", "-10");
    scene
}

#[test]
fn a_contact_keeps_its_force_when_its_kind_changes() {
    // v-v and v-e become v-f. The way is that of steady friction, along the diagonal: a = 3√2 - 10/4 m/s².
    let mut dynamics = begin::<f64>(&from_the_corner());
    let kinds = |dynamics: &Dynamics<f64>| -> Vec<ContactKind> {
        dynamics.state().contacts.iter().map(|c| c.contact.kind()).collect()
    };
    for _ in 0..60 {
        dynamics.step().unwrap();
    }
    use ContactKind::{EdgeVertex, FaceVertex, VertexVertex};
    assert_eq!(kinds(&dynamics), [VertexVertex, EdgeVertex, EdgeVertex, FaceVertex]);
    for _ in 0..20 {
        dynamics.step().unwrap();
    }
    assert_eq!(kinds(&dynamics), [FaceVertex; 4]);
    let at = dynamics.centroid(1);
    let way = ((at.x - 0.5).powi(2) + (at.y - 0.5).powi(2)).sqrt();
    let expected = 0.5 * (3.0 * 2f64.sqrt() - 2.5) * 0.04;
    near(way, expected, 0.06);
    assert!(dynamics.state().contacts.iter().all(|c| c.mode == Mode::Sliding));
}

#[test]
fn what_does_not_touch_does_not_matter() {
    // A second stack on the same fixed floor, and a third that flies: the first moves by the same bits.
    let stack = || {
        let mut upper = cuboid("upper", ["1/8", "0", "1"], ["9/8", "1", "2"], Motion::Deformable);
        upper.body.velocity = v("1/4", "0", "0");
        vec![floor(), cube(), upper]
    };
    let (alone, _) = run::<f64>(&scene(stack()), 40);
    let mut blocks = stack();
    blocks.push(cuboid("other", ["3", "3", "0"], ["4", "4", "1"], Motion::Rigid));
    blocks.push(cuboid("flying", ["-3", "-3", "5"], ["-2", "-2", "6"], Motion::Deformable));
    let (together, _) = run::<f64>(&scene(blocks), 40);
    assert_eq!(alone.state().blocks[..], together.state().blocks[..3]);
}

#[test]
fn two_bodies_that_touch_share_their_momentum() {
    // Faces meet head on without friction: 2000 kg at 1 m/s and 2000 kg at rest. Whatever the spring does, momentum stays.
    let mut one = cube();
    one.body.velocity = v("1", "0", "0");
    let other = cuboid("other", ["17/16", "0", "0"], ["33/16", "1", "1"], Motion::Rigid);
    let (dynamics, reports) = run::<f64>(&weightless(vec![one, other]), 40);
    let velocity = |block: usize| dynamics.state().blocks[block].velocity[0];
    near(velocity(0) + velocity(1), 1.0, 1e-12);
    assert!(velocity(1) > velocity(0), "{} {}", velocity(0), velocity(1));
    assert!(reports[39].kinetic <= 1000.0 * (1.0 + 1e-12));
}
