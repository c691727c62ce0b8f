//! How a pair of blocks moves: what turns it into a scene.

use rockproof_model::scene::SceneBlock;
use rockproof_model::simulation::{Simulation, derive_stiffness};
use rockproof_model::{Block, Body, Number, Scene, ToleranceSet};

/// How a pair moves, and for how many steps.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PairMotion {
    /// How each block moves, and its velocity.
    pub bodies: [Body; 2],
    /// Gravity, materials, joints and control.
    pub simulation: Simulation,
    /// Steps to make.
    pub steps: u32,
}

impl PairMotion {
    /// The pair as a scene, its joints' stiffnesses derived.
    pub fn scene(&self, a: &Block, b: &Block, set: &ToleranceSet) -> Scene {
        let named = |(name, block): (&str, &Block), body: &Body| {
            let mut scene = SceneBlock::new(name, block.clone());
            // Blocks from files may be less planar than a scene asks for.
            scene.planarity = Number::from_integer(1);
            scene.body = body.clone();
            scene
        };
        let mut simulation = self.simulation.clone();
        derive_stiffness(&mut simulation, &[(a, &self.bodies[0]), (b, &self.bodies[1])], set);
        let blocks = vec![named(("A", a), &self.bodies[0]), named(("B", b), &self.bodies[1])];
        Scene { blocks, tolerances: None, simulation }
    }
}
