//! Boxes and tolerances of small scenes.

use rockproof_model::scene::SceneBlock;
use rockproof_model::{Block, Motion, Number, ToleranceSet, Vec3};

pub(crate) fn n(text: &str) -> Number {
    Number::parse(text).unwrap()
}

/// Without Eq. (1), εo and εc.
pub(crate) fn tolerances() -> ToleranceSet {
    ToleranceSet {
        search: n("1/10"),
        territory: n("1/100"),
        penetration: n("1/20"),
        overlap_sine: n("1/20"),
        parallel_sine: n("1/20"),
        max_displacement: n("1/20"),
        max_rotation: n("1/10"),
        ..ToleranceSet::ZERO
    }
}

pub(crate) fn cuboid(name: &str, min: [&str; 3], max: [&str; 3], motion: Motion) -> SceneBlock {
    let corner = |c: [&str; 3]| Vec3::new(n(c[0]), n(c[1]), n(c[2]));
    let mut block = SceneBlock::new(name, Block::cuboid(&corner(min), &corner(max)).unwrap());
    block.body.motion = motion;
    block
}
