//! Shapes of blocks, each held once.

use crate::block::{Block, BlockShape};
use std::collections::HashSet;
use std::sync::Arc;

/// The shapes of some blocks: bricks fit together alike, and what touches what takes more memory than where it is.
#[derive(Debug, Default)]
pub struct Shapes(HashSet<Arc<BlockShape>>);

impl Shapes {
    /// Makes a block hold its shape together with the earlier blocks of the same one. It stays equal to what it was.
    pub fn share(&mut self, block: &mut Block) {
        match self.0.get(&block.shape) {
            Some(shape) => block.shape = Arc::clone(shape),
            None => {
                self.0.insert(Arc::clone(&block.shape));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::Number;
    use crate::scene::{Scene, SceneBlock, SceneFormat};
    use crate::vector::Vec3;

    fn cuboid(low: [i32; 3], high: [i32; 3]) -> Block {
        let [low, high] = [low, high].map(|corner| {
            let [x, y, z] = corner.map(Number::from_integer);
            Vec3::new(x, y, z)
        });
        Block::cuboid(&low, &high).expect("a block")
    }

    fn tetrahedron() -> Block {
        let at = |x: i32, y: i32, z: i32| Vec3::new(x, y, z).map(|c| Number::from_integer(*c));
        let vertices = vec![at(0, 0, 0), at(1, 0, 0), at(0, 1, 0), at(0, 0, 1)];
        let faces: Vec<Vec<u32>> = vec![vec![0, 2, 1], vec![0, 1, 3], vec![1, 2, 3], vec![2, 0, 3]];
        Block::new(vertices, faces, &crate::BlockOptions::default()).expect("a block")
    }

    #[test]
    fn blocks_of_one_shape_share_it_and_others_do_not() {
        let separate = [cuboid([0; 3], [1; 3]), tetrahedron(), cuboid([5, 0, 0], [7, 1, 3]), tetrahedron()];
        let mut shared = separate.clone();
        let mut shapes = Shapes::default();
        shared.iter_mut().for_each(|block| shapes.share(block));
        assert_eq!(shared, separate);
        let same = |blocks: &[Block; 4], i: usize, j: usize| Arc::ptr_eq(&blocks[i].shape, &blocks[j].shape);
        for (i, j, is_same) in [(0, 2, true), (1, 3, true), (0, 1, false), (2, 3, false)] {
            assert!(!same(&separate, i, j));
            assert_eq!(same(&shared, i, j), is_same, "{i} and {j}");
        }
        // What is not equal in every list of the shape is not shared: a cuboid whose flags are others.
        let mut other = cuboid([0; 3], [1; 3]);
        let flags = Arc::make_mut(&mut other.shape);
        flags.edge_convex[3] = false;
        let mut given = other.clone();
        shapes.share(&mut given);
        assert_eq!(given, other);
        assert!(!Arc::ptr_eq(&given.shape, &shared[0].shape));
    }

    #[test]
    fn blocks_that_are_read_share_their_shape() {
        let text = "[[block]]\nbox = { min = [0, 0, 0], max = [1, 1, 1] }\n[[block]]\nbox = { min = [0, 0, 1], max = [3, 1, 2] }\n";
        let path = std::path::Path::new("scene.toml");
        let scene = Scene::parse(text, SceneFormat::Toml, path).expect("a scene");
        assert!(Arc::ptr_eq(&scene.blocks[0].block.shape, &scene.blocks[1].block.shape));
        let mut made = Scene::on_fixed("floor", cuboid([0; 3], [9, 1, 1]));
        made.blocks.push(SceneBlock::new("cube", cuboid([0, 0, 1], [1, 1, 2])));
        let before = made.clone();
        made.share_shapes();
        assert!(Arc::ptr_eq(&made.blocks[0].block.shape, &made.blocks[1].block.shape));
        assert_eq!(made, before);
    }
}
