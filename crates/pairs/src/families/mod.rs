//! The families: named generators of block pairs, each made to reach some kinds of contact.

mod concave_notch;
mod coplanar_slide;
mod corner_corner;
pub mod edge_cross;
mod face_stack;
mod far_origin;
mod joint_cut;
mod motion_style;
mod quasi_parallel_edges;
pub mod real;
pub mod sampler;
mod sharp_wedge;
mod size_ratio;
mod sliver;
mod unit_scale;
mod vertex_on_edge;

pub use motion_style::MotionStyle;
pub use real::RealNeighbours;
pub use sampler::{CoordinateStyle, PairSampler};

use rand_chacha::ChaCha8Rng;
use rockproof_model::{Block, ContactKind};
use std::fmt;
use std::sync::Arc;

/// A generator of block pairs.
pub trait Family: fmt::Debug + Send + Sync {
    /// The name used in files and tables.
    fn name(&self) -> &'static str;
    /// What the pairs look like and what they are for, in one sentence.
    fn describe(&self) -> &'static str;
    /// The kinds of contact its pairs must be seen to have.
    fn reaches(&self) -> &'static [ContactKind];
    /// The next pair: two canonical blocks, near enough for contacts to be likely. A function of the generator's
    /// state alone.
    fn generate(&self, rng: &mut ChaCha8Rng) -> (Block, Block);
    /// How its pairs move, where they do.
    fn motion_style(&self) -> MotionStyle {
        MotionStyle::Any
    }
}

/// A family that draws every pair by itself.
#[derive(Debug)]
struct Drawn {
    name: &'static str,
    about: &'static str,
    reaches: &'static [ContactKind],
    style: MotionStyle,
    draw: fn(&mut PairSampler<'_>) -> (Block, Block),
}

impl Family for Drawn {
    fn name(&self) -> &'static str {
        self.name
    }

    fn describe(&self) -> &'static str {
        self.about
    }

    fn reaches(&self) -> &'static [ContactKind] {
        self.reaches
    }

    fn generate(&self, rng: &mut ChaCha8Rng) -> (Block, Block) {
        (self.draw)(&mut PairSampler::new(rng))
    }

    fn motion_style(&self) -> MotionStyle {
        self.style
    }
}

/// Every family, with `real` on the pairs the program carries. The order is part of what a seed means.
pub fn all() -> Vec<Arc<dyn Family>> {
    let mut families = local();
    families.push(Arc::new(far_origin::FarOrigin::new(local())));
    families.push(Arc::new(unit_scale::UnitScale::new(local())));
    families.push(Arc::new(joint_cut::JointCut));
    families.push(Arc::new(RealNeighbours::bundled()));
    families
}

/// The families named, in the order of [`all`]; or the first name that no family has.
///
/// # Errors
/// The unknown name.
pub fn named<'n>(names: &[&'n str]) -> Result<Vec<Arc<dyn Family>>, &'n str> {
    let all = all();
    if let Some(unknown) = names.iter().find(|name| all.iter().all(|f| f.name() != **name)) {
        return Err(unknown);
    }
    Ok(all.into_iter().filter(|f| names.contains(&f.name())).collect())
}

/// The families of ordinary size near the origin.
fn local() -> Vec<Arc<dyn Family>> {
    let families = [
        face_stack::FACE_STACK,
        corner_corner::CORNER_CORNER,
        edge_cross::EDGE_CROSS,
        quasi_parallel_edges::QUASI_PARALLEL_EDGES,
        sharp_wedge::SHARP_WEDGE,
        sliver::SLIVER,
        vertex_on_edge::VERTEX_ON_EDGE,
        coplanar_slide::COPLANAR_SLIDE,
        size_ratio::SIZE_RATIO,
        concave_notch::CONCAVE_NOTCH,
    ];
    families.into_iter().map(|family| Arc::new(family) as Arc<dyn Family>).collect()
}
