//! What a difference did: how deep blocks overlap after the step, and which part of the stepper made that another depth.

use crate::lockstep::scene::ExactScene;
use rockproof_model::Block;
use rockproof_oracle::penetration::deepest;
use rockproof_oracle::step::State;

/// The deepest overlap of two blocks of a state (m), exact but for the last rounding; 0 where none overlap, `None` on overflow.
pub fn penetration(scene: &ExactScene, state: &State) -> Option<f64> {
    let blocks = scene.blocks_at(state);
    let blocks: Vec<&Block> = blocks.iter().collect();
    match deepest(&blocks).0 {
        None => Some(0.0),
        Some(deepest) => deepest.penetration.depth_m(),
    }
}

/// What made the penetration after the stepper's step another one than after the oracle's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PenetrationEffect {
    /// No more than rounding makes of equal decisions.
    None,
    /// Contacts that the stepper classified wrongly.
    Classification,
    /// Modes that its iteration decided wrongly.
    Iteration,
    /// Neither: its numbers.
    Arithmetic,
}

impl PenetrationEffect {
    /// The name in tables: `none`, `classification`, `iteration`, `arithmetic`.
    pub fn name(self) -> &'static str {
        match self {
            PenetrationEffect::None => "none",
            PenetrationEffect::Classification => "classification",
            PenetrationEffect::Iteration => "iteration",
            PenetrationEffect::Arithmetic => "arithmetic",
        }
    }
}

/// Penetrations (m) after one step from one state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepPenetrations {
    /// After the stepper's step.
    pub stepper: f64,
    /// After the stepper's with the oracle's contacts.
    pub contacts: f64,
    /// After the stepper's with the oracle's contacts, Δt and modes.
    pub modes: f64,
    /// After the oracle's.
    pub oracle: f64,
}

impl StepPenetrations {
    /// Changes below this share of the larger penetration are none.
    pub const NEGLIGIBLE_SHARE: f64 = 1.0 / 1_048_576.0;

    /// The largest of the three parts of the change from the oracle's to the stepper's penetration; of equal ones the first of
    /// classification, iteration, arithmetic. None, when the change is below [`StepPenetrations::NEGLIGIBLE_SHARE`].
    pub fn effect(&self) -> PenetrationEffect {
        let change = self.stepper - self.oracle;
        if change.abs() <= StepPenetrations::NEGLIGIBLE_SHARE * self.stepper.max(self.oracle) {
            return PenetrationEffect::None;
        }
        let parts = [
            (PenetrationEffect::Classification, self.stepper - self.contacts),
            (PenetrationEffect::Iteration, self.contacts - self.modes),
            (PenetrationEffect::Arithmetic, self.modes - self.oracle),
        ];
        let larger = |best: (PenetrationEffect, f64), next: (PenetrationEffect, f64)| {
            if next.1.abs() > best.1.abs() { next } else { best }
        };
        parts.into_iter().reduce(larger).map_or(PenetrationEffect::None, |(effect, _)| effect)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_part_names_the_effect() {
        let depths = |stepper, contacts, modes, oracle| StepPenetrations { stepper, contacts, modes, oracle }.effect();
        assert_eq!(depths(3.0, 1.0, 1.0, 1.0), PenetrationEffect::Classification);
        assert_eq!(depths(3.0, 3.0, 1.0, 1.0), PenetrationEffect::Iteration);
        assert_eq!(depths(3.0, 3.0, 3.0, 1.0), PenetrationEffect::Arithmetic);
        assert_eq!(depths(0.0, 0.0, 0.0, 0.0), PenetrationEffect::None);
        assert_eq!(depths(1.0, 0.5, 1.0, 1.0 + 1e-9), PenetrationEffect::None, "what cancels did nothing");
        assert_eq!(depths(0.0, 1.0, 1.0, 1.0), PenetrationEffect::Classification, "less deep is an effect too");
    }
}
