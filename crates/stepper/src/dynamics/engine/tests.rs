use super::*;
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
            dynamics.solids.iter().zip(&dynamics.state.blocks).all(|(solid, state)| {
                solid.vertices().iter().map(|vertex| vertex.at).eq(state.vertices.iter().copied())
            })
        };
    dynamics.step().expect("below 1024 m nothing collapses");
    assert!(agrees(&dynamics));
    let (state, moments) = (dynamics.state.clone(), dynamics.moments.clone());
    for _ in 0..2 {
        let stopped = dynamics.step().expect_err("above it a side does");
        assert!(matches!(stopped, Stopped::Collapsed { step: 2, block: 1, .. }), "{stopped}");
        assert_eq!((&dynamics.state, &dynamics.moments), (&state, &moments));
        assert!(agrees(&dynamics), "what is prepared is not what stands");
    }
}
