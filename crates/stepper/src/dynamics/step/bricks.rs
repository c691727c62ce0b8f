//! Walls and masses of bricks, whose steps do not depend on the number of threads: `tests/differential/step_threads.rs` takes the steps, the tests of this
//! crate hold that the bricks' islands are what is meant.

use rockproof_model::{
    Block, BlockOptions, Motion, Number, Precision, Scene, SceneBlock, ToleranceSet, ToleranceSpec, Vec3,
};

/// Bricks along a course, behind one another and above one another; whether they stand there twice; how they move; whether
/// their factors are in f32, so many they are: a wall, a rigid one, two islands, and two masses.
pub(crate) const BRICKS: [([u32; 3], bool, Motion, bool); 5] = [
    ([18, 1, 18], false, Motion::Deformable, false),
    ([22, 1, 22], false, Motion::Rigid, false),
    ([14, 1, 14], true, Motion::Deformable, false),
    ([8, 8, 9], false, Motion::Deformable, true),
    ([10, 10, 10], false, Motion::Rigid, true),
];

fn block(points: &[[f64; 3]], faces: &[&[u32]]) -> SceneBlock {
    let number = |x: f64| Number::from_f64(x).expect("finite");
    let vertices = points.iter().map(|p| Vec3::new(number(p[0]), number(p[1]), number(p[2]))).collect();
    let faces = faces.iter().map(|face| face.to_vec()).collect();
    SceneBlock::new("block", Block::new(vertices, faces, &BlockOptions::default()).expect("a block"))
}

/// Bricks in running bond on a fixed floor: so many along a course, behind one another and above one another; far from it the same again if `twice`.
pub(crate) fn bricks([along, deep, high]: [u32; 3], twice: bool, motion: Motion) -> (Scene, ToleranceSet) {
    let cuboid = |low: [u32; 3], size: [u32; 3]| {
        let corner =
            |k: u32| [0, 1, 2].map(|axis| f64::from(low[axis] + if k >> axis & 1 == 1 { size[axis] } else { 0 }));
        let points: Vec<[f64; 3]> = (0..8).map(corner).collect();
        block(&points, &[&[0, 2, 3, 1], &[4, 5, 7, 6], &[0, 1, 5, 4], &[1, 3, 7, 5], &[3, 2, 6, 7], &[2, 0, 4, 6]])
    };
    let mut blocks = Vec::new();
    for wall in 0..=u32::from(twice) {
        let begin = wall * (2 * along + 10);
        let mut floor = cuboid([begin, 0, 0], [2 * along + 1, 2 * deep + 1, 1]);
        floor.body.motion = Motion::Fixed;
        blocks.push(floor);
        for number in 0..along * deep * high {
            let (x, y, z) = (number % along, number / along % deep, number / (along * deep));
            let size = if deep == 1 { [2, 1, 1] } else { [2, 2, 1] };
            let mut brick =
                cuboid([begin + 2 * x + z % 2, size[1] * y + if deep == 1 { 0 } else { z % 2 }, z + 1], size);
            brick.body.motion = motion;
            blocks.push(brick);
        }
    }
    let mut scene = Scene { blocks, ..Scene::default() };
    // A thick mass slides and locks for long once it is let go.
    scene.simulation.control.settle = if deep == 1 { 1 } else { 2 };
    let set = ToleranceSpec::default().derive(&scene.shapes(), Precision::F64).expect("tolerances");
    scene.derive_stiffness(&set);
    (scene, set)
}
