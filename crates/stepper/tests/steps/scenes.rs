//! The paper's examples (cases/handmade): what must come of them.

use crate::support::{beginning, handmade, n, near};
use rockproof_model::{ContactKind, Number, Precision, Scene};
use rockproof_stepper::Vector;
use rockproof_stepper::dynamics::{Mode, Solve, StepReport};

fn total(report: &StepReport) -> f64 {
    report.kinetic + report.potential()
}

fn vertices_approach<R: Solve>(precision: Precision, relative: f64) {
    let (scene, set) = handmade("approaching_vertices.toml", precision);
    let mut dynamics = beginning::<R>(scene, &set);
    let mass = |block: usize| dynamics.mass(block)[0][0].to_f64();
    let masses = [mass(0), mass(1)];
    let begun = dynamics.mass(1)[2][2].to_f64() / 2.0;
    let mut kinds = Vec::new();
    for step in 1..=200 {
        let report = dynamics.step().unwrap();
        assert!(report.converged && report.retries.is_empty(), "{report:?}");
        assert!(total(&report) <= begun * (1.0 + relative), "step {step}: {} of {begun}", total(&report));
        // v/√(2p/m) with the m of a block: two of them meet with half of it.
        assert!(report.max_penetration < 0.003, "{report:?}");
        let velocity = |block: usize| [0, 1, 2].map(|k: usize| dynamics.state().blocks[block].velocity[k].to_f64());
        let (one, other) = (velocity(0), velocity(1));
        let momentum: [f64; 3] = std::array::from_fn(|k| masses[0] * one[k] + masses[1] * other[k]);
        let expected = [0.0, 0.0, -masses[1]];
        let off = (0..3).map(|k| (momentum[k] - expected[k]).abs()).fold(0.0, f64::max);
        assert!(off <= relative * masses[1], "step {step}: {momentum:?}");
        kinds.extend(dynamics.state().contacts.iter().filter(|c| c.mode.is_closed()).map(|c| c.contact.kind()));
    }
    use ContactKind::{EdgeVertex, VertexEdge, VertexVertex};
    assert!(
        kinds[0] == VertexVertex && kinds.iter().all(|k| [VertexVertex, VertexEdge, EdgeVertex].contains(k)),
        "{kinds:?}"
    );
    // Turned away to the side on which its tip stands.
    assert!(dynamics.state().blocks[1].velocity[0].to_f64() > 0.1);
}

#[test]
fn approaching_vertices_pass_each_other() {
    vertices_approach::<f64>(Precision::F64, 1e-12);
    vertices_approach::<f32>(Precision::F32, 1e-5);
}

fn ridges_cross<R: Solve>(precision: Precision, relative: f64) {
    let (scene, set) = handmade("quasi_parallel_edges.toml", precision);
    let mut dynamics = beginning::<R>(scene, &set);
    for _ in 0..120 {
        dynamics.step().unwrap();
        assert_eq!(dynamics.state().contacts.len(), 1);
    }
    let contact = &dynamics.state().contacts[0];
    assert_eq!((contact.contact.kind(), contact.mode), (ContactKind::EdgeEdge, Mode::Locked));
    let weight = dynamics.mass(1)[0][0].to_f64() * 10.0;
    near(weight, 52_020.8, 1e-6);
    near(-contact.force.z.to_f64(), weight, relative);
    near(-contact.gap.to_f64(), weight / 1e8, relative);
}

#[test]
fn quasi_parallel_edges_bear_where_they_cross() {
    ridges_cross::<f64>(Precision::F64, 1e-6);
    ridges_cross::<f32>(Precision::F32, 1e-3);
}

/// How far the middle of the upper ridge is below the lower one at the deepest.
fn sinks_with_parallel_angle(degrees: &str) -> f64 {
    let (mut scene, _) = handmade("quasi_parallel_edges.toml", Precision::F64);
    let mut spec = scene.tolerances.clone().unwrap();
    spec.assign(&format!("parallel_angle={degrees}")).unwrap();
    let set = spec.derive(&scene.shapes(), Precision::F64).unwrap();
    scene.simulation.control.settle = 0;
    let mut dynamics = beginning::<f64>(scene, &set);
    let mut deepest = 0.0f64;
    for _ in 0..20 {
        dynamics.step().unwrap();
        let ridge = &dynamics.state().blocks[1].vertices[4..6];
        deepest = deepest.max(-0.5 * (ridge[0].z + ridge[1].z));
    }
    deepest
}

#[test]
fn with_three_degrees_for_parallel_the_ridges_still_bear() {
    // At 1.15° the edges stray by more than the territory, which under `revised` must hold as well (version 1 took either, and they sank by
    // 20 mm). Let go at once, a weight sinks by up to twice its static overlap of 52020.8/1e8 m.
    let deepest = sinks_with_parallel_angle("3");
    assert!((5e-4..2.0 * 52_020.8 / 1e8).contains(&deepest), "{deepest}");
}

/// How far each block of the slope's front slid in a second (m), by name; and whether a corner of a fixed block holds it by a steep joint.
fn slides<R: Solve>(precision: Precision, friction: &str) -> Vec<(String, f64, bool)> {
    let (mut scene, set) = handmade("slope_failure.toml", precision);
    scene.simulation.joints.other.friction = n(friction);
    let front: Vec<usize> = (0..16).filter(|&k| !scene.blocks[k].body.is_fixed()).collect();
    let name = |block: usize| scene.blocks[block].name.clone();
    let names: Vec<String> = front.iter().map(|&block| name(block)).collect();
    assert!(names.len() == 6 && names.iter().all(|name| name.contains("front")), "{names:?}");
    let fixed: Vec<bool> = scene.blocks.iter().map(|block| block.body.is_fixed()).collect();
    let mut dynamics = beginning::<R>(scene, &set);
    while dynamics.state().settling > 0 {
        dynamics.step().unwrap();
    }
    let begun: Vec<Vector<R>> = front.iter().map(|&block| dynamics.centroid(block)).collect();
    while dynamics.state().time.to_f64() < 1.0 - 1e-4 {
        let report = dynamics.step().unwrap();
        assert!(report.converged && report.max_penetration < 1e-3, "{report:?}");
    }
    let time = dynamics.state().time.to_f64();
    let held = |block: usize| {
        let steep = dynamics.state().contacts.iter().filter(|c| c.mode.is_closed() && c.normal.z.to_f64().abs() < 0.5);
        let fixed = steep.filter(|c| fixed[c.blocks[0] as usize]);
        fixed.map(|c| c.blocks[1]).any(|other| other as usize == block)
    };
    let way = |k: usize| (dynamics.centroid(front[k]) - begun[k]).length().to_f64() / (time * time);
    names.into_iter().enumerate().map(|(k, name)| (name, way(k), held(front[k]))).collect()
}

/// ½(g sin 8° − g cos 8° tan φ) m.
fn rigid_way(friction: f64) -> f64 {
    let dip = 8f64.to_radians();
    0.5 * 9.81 * (dip.sin() - dip.cos() * friction)
}

/// All fail as rigid blocks on a plane would, but one: the lower left block, which a false entrance holds (see the scene's comment).
fn fails(ways: &[(String, f64, bool)]) {
    println!("{ways:?}, a rigid block {} m", rigid_way(0.1));
    for (name, way, held) in ways {
        if *held {
            assert_eq!(name, "lower_front_left");
        } else {
            assert!((way / rigid_way(0.1) - 1.0).abs() < 0.12, "{name}: {way} for {}", rigid_way(0.1));
        }
    }
}

#[test]
fn the_jointed_slope_fails_where_friction_is_less_than_the_dip() {
    fails(&slides::<f64>(Precision::F64, "1/10"));
    fails(&slides::<f32>(Precision::F32, "1/10"));
    // Smooth, nothing is held for good; what the false entrance costs shows.
    for (name, way, _) in slides::<f64>(Precision::F64, "0") {
        let within = if name == "lower_front_left" { 0.12 } else { 0.02 };
        assert!((way / rigid_way(0.0) - 1.0).abs() < within, "{name}: {way} for {}", rigid_way(0.0));
    }
}

#[test]
fn the_jointed_slope_stands_where_friction_is_more() {
    let ways = slides::<f64>(Precision::F64, "3/5");
    assert!(ways.iter().all(|(_, way, _)| *way < 1e-3), "{ways:?}");
}

#[test]
fn the_slope_holds_the_blocks_of_its_file() {
    // The file repeats blocks: 6 of 16 are distinct, and those are among the 16 of the scene. Corners to 1e-12 m.
    let corners = |scene: &Scene| -> Vec<Vec<[i64; 3]>> {
        let rounded = |x: &Number| (x.approximate() * 1e12).round() as i64;
        let block = |block: &rockproof_model::Block| {
            let mut corners: Vec<[i64; 3]> = block.vertices().iter().map(|v| v.components().map(rounded)).collect();
            corners.sort_unstable();
            corners
        };
        let mut all: Vec<_> = scene.blocks.iter().map(|b| block(&b.block)).collect();
        all.sort();
        all.dedup();
        all
    };
    let (cut, _) = handmade("slope_failure.toml", Precision::F64);
    let file = Scene::load(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../cases/real/slope_joints.dda")).unwrap();
    let (cut_blocks, file_blocks) = (corners(&cut), corners(&file));
    assert_eq!((cut_blocks.len(), file_blocks.len(), file.blocks.len()), (16, 6, 16));
    let close = |a: &[[i64; 3]], b: &[[i64; 3]]| a.iter().zip(b).all(|(a, b)| (0..3).all(|k| (a[k] - b[k]).abs() <= 1));
    assert!(file_blocks.iter().all(|block| cut_blocks.iter().any(|other| close(block, other))));
    let volume: f64 = cut.blocks.iter().map(|b| Number::from_rational(b.block.volume()).approximate()).sum();
    near(volume, 144.0, 1e-13);
}
