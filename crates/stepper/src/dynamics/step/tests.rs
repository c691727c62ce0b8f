use super::bricks::{BRICKS, bricks};
use super::*;
use crate::dynamics::island::{BySingle, SingleFactor, islands};
use crate::dynamics::products::Products;
use crate::dynamics::system::System;
use rockproof_model::{Block, BlockOptions, Number, Precision, SceneBlock, ToleranceSpec, Vec3};

fn block(points: &[[f64; 3]], faces: &[&[u32]]) -> SceneBlock {
    let number = |x: f64| Number::from_f64(x).expect("finite");
    let vertices = points.iter().map(|p| Vec3::new(number(p[0]), number(p[1]), number(p[2]))).collect();
    let faces = faces.iter().map(|face| face.to_vec()).collect();
    SceneBlock::new("block", Block::new(vertices, faces, &BlockOptions::default()).expect("a block"))
}

/// A pyramid on a quadrilateral, of which one side is as short as f32 has it below 1024 m and as none above.
fn pyramid(x: f64) -> SceneBlock {
    let short = f64::from(f32::EPSILON) * 512.0;
    let points = [[x, 0.0, 0.0], [x + short, 0.0, 0.0], [x + 1.0, 1.0, 0.0], [x - 1.0, 1.0, 0.0], [x, 0.5, 1.0]];
    block(&points, &[&[0, 3, 2, 1], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]])
}

#[test]
fn a_step_that_collapses_a_block_leaves_all_as_before() {
    let mut scene = Scene { blocks: vec![pyramid(8.0), pyramid(1022.5), pyramid(16.0)], ..Scene::default() };
    for block in &mut scene.blocks {
        block.body.velocity.x = Number::from_integer(100);
    }
    let mut set = ToleranceSpec::default().derive(&scene.shapes(), Precision::F32).expect("tolerances");
    set.max_displacement = Number::from_integer(10);
    scene.derive_stiffness(&set);
    let mut dynamics = Dynamics::<f32>::new(&scene, &set).expect("a scene");
    let agrees =
        |dynamics: &Dynamics<f32>| {
            dynamics.prepared.iter().zip(&dynamics.state.blocks).all(|(block, state)| {
                block.vertices().iter().map(|vertex| vertex.at).eq(state.vertices.iter().copied())
            })
        };
    dynamics.step().expect("below 1024 m nothing collapses");
    assert!(agrees(&dynamics));
    let (state, moments) = (dynamics.state.clone(), dynamics.moments.clone());
    for _ in 0..2 {
        let stopped = dynamics.step().expect_err("above it a side does");
        assert!(matches!(stopped, StepError::Collapsed { step: 2, block: 1, .. }), "{stopped}");
        assert_eq!((&dynamics.state, &dynamics.moments), (&state, &moments));
        assert!(agrees(&dynamics), "what is prepared is not what stands");
    }
}

/// Cubes of 1 m on one another, on a fixed one.
fn stack(cubes: u32) -> Dynamics<f64> {
    let cube = |low: u32| {
        let [low, high] = [low, low + 1].map(f64::from);
        let points: Vec<[f64; 3]> =
            (0..8).map(|k| [f64::from(k & 1), f64::from(k >> 1 & 1), if k < 4 { low } else { high }]).collect();
        block(&points, &[&[0, 2, 3, 1], &[4, 5, 7, 6], &[0, 1, 5, 4], &[1, 3, 7, 5], &[3, 2, 6, 7], &[2, 0, 4, 6]])
    };
    let mut scene = Scene { blocks: (0..=cubes).map(cube).collect(), ..Scene::default() };
    scene.blocks[0].body.motion = rockproof_model::Motion::Fixed;
    let set = ToleranceSpec::default().derive(&scene.shapes(), Precision::F64).expect("tolerances");
    scene.derive_stiffness(&set);
    Dynamics::new(&scene, &set).expect("a scene")
}

#[test]
fn a_factor_in_f32_is_refined_to_the_solution_in_f64() {
    let mut dynamics = stack(12);
    let mut contacts = dynamics.contacts();
    contacts.iter_mut().for_each(|contact| contact.reset::<SpecRules>(contact.begins));
    // One slides, so that its spring across the slip takes part.
    let slip = Vector::new(1e-6, 2e-6, 0.0);
    contacts[5].iterate.mode = Mode::Sliding;
    contacts[5].iterate.friction =
        Friction::along::<SpecRules>(slip, 1e8, contacts[5].joint.shear, contacts[5].plane.normal);
    let block_systems = dynamics.block_systems(0.01, false);
    let unknowns: Vec<usize> = block_systems.iter().map(|block| block.unknowns).collect();
    let pairs: Vec<[u32; 2]> = contacts.iter().map(|contact| contact.blocks).collect();
    let modes: Vec<Mode> = contacts.iter().map(|contact| contact.iterate.mode).collect();
    let all = islands(&unknowns, &pairs, &modes);
    let island = &all[0];
    let layout = dynamics.layouts.of(&island.couplings).expect("a layout");
    let panels = layout.pattern.panel_count();
    let mut single = SingleFactor::none(panels, false);
    let mut memory = Vec::new();
    // By a new factor, then after a small change by the same one.
    for news in [0, 1] {
        if news == 1 {
            let friction = &mut contacts[5].iterate.friction;
            *friction = Friction { spring: friction.spring * 1.01, ..*friction };
        }
        let closed = (&contacts[..], &island.contacts[..]);
        let system = System::new(&island.couplings.blocks, &layout, &block_systems, closed);
        let (force, products) = (system.force(), Products::new(&system));
        let mut times = IterationTimes::default();
        let by = BySingle { products: &products, memory: &mut memory, force: &force };
        let all = vec![true; panels];
        assert!(by.solve(&mut single, &all, news, &mut times));
        assert_eq!(times.factor.is_zero(), news == 1, "the factor is that of the solve before");
        let bearing = system.bearing(&all);
        let (mut values, mut direct) = (vec![0.0; layout.pattern.values()], force.clone());
        f64::factorize(&layout.pattern, &mut values, &all, &|panel, own| system.fill(panel, &bearing, own))
            .expect("a factor");
        f64::substitute(&layout.pattern, &values, &mut direct).expect("a solution");
        let refined = single.before.as_ref().expect("a solution");
        let largest = direct.iter().fold(0.0f64, |most, x| most.max(x.abs()));
        let apart = direct.iter().zip(refined).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
        assert!(largest > 1e-5 && apart < 1e-11 * largest, "{apart} of {largest}");
    }
}

/// Otherwise tests of steps on many threads would not try what they are for.
#[test]
fn the_islands_of_bricks_are_as_many_and_as_large_as_meant() {
    for (size, twice, motion, very_large) in BRICKS {
        let (scene, set) = bricks(size, twice, motion);
        let mut dynamics = Dynamics::<f64>::new(&scene, &set).expect("a scene");
        let mut contacts = dynamics.contacts();
        contacts.iter_mut().for_each(|contact| contact.reset::<SpecRules>(contact.begins));
        let unknowns: Vec<usize> = dynamics.setup.bodies.iter().map(|body| body.motion.unknowns()).collect();
        let pairs: Vec<[u32; 2]> = contacts.iter().map(|contact| contact.blocks).collect();
        let modes: Vec<Mode> = contacts.iter().map(|contact| contact.iterate.mode).collect();
        let islands = islands(&unknowns, &pairs, &modes);
        assert_eq!(islands.len(), 1 + usize::from(twice));
        let layout = dynamics.layouts.of(&islands[0].couplings).expect("a layout");
        assert_eq!(layout.is_iterative(), very_large, "{size:?}");
    }
}
