//! What a difference did: how deep blocks overlap after the step, and which part of the stepper made that another depth.

use crate::finding::Cause;
use crate::lockstep::run::ComparedStep;
use crate::lockstep::scene::ExactScene;
use rockproof_model::{Block, Number, Precision};
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

/// A penetration after the stepper's step that is another than after the oracle's, by more than rounding explains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthDifference {
    /// Arithmetic, or a defect where the step has another one.
    pub cause: Cause,
    /// After the oracle's step and after the stepper's (m).
    pub depths: [f64; 2],
}

impl DepthDifference {
    /// Roundoffs of the largest coordinate that two depths may differ by, and be the same.
    const ROUNDOFFS: f64 = 64.0;

    /// That of a step of a scene with these blocks; `drifts` where the state after it deviates by more than rounding.
    ///
    /// Of blocks that are not convex the depth jumps by its definition (of the deepest vertex that is inside, or else of something else): two states that
    /// no decision parts, and no more than rounding, may have quite different ones. That says nothing of the stepper.
    pub fn of(blocks: &[&Block], precision: Precision, step: &ComparedStep, drifts: bool) -> Option<DepthDifference> {
        let [Some(stepper), Some(oracle)] = step.penetration else { return None };
        if !drifts && !step.differs() && blocks.iter().any(|block| !block.is_convex()) {
            return None;
        }
        let coordinates = blocks.iter().flat_map(|block| block.coordinates());
        let largest = coordinates.map(Number::approximate).fold(0.0, |most: f64, c| most.max(c.abs()));
        let rounding = DepthDifference::ROUNDOFFS * precision.epsilon() / 2.0 * largest;
        let least = rounding.max(StepPenetrations::NEGLIGIBLE_SHARE * stepper.max(oracle));
        let cause = if drifts || step.count(Cause::Defect) > 0 { Cause::Defect } else { Cause::Arithmetic };
        ((stepper - oracle).abs() > least).then_some(DepthDifference { cause, depths: [oracle, stepper] })
    }

    /// How much deeper the blocks are after the stepper's step (m).
    pub fn deeper_by(&self) -> f64 {
        self.depths[1] - self.depths[0]
    }

    /// `deeper` or `shallower`.
    pub fn name(&self) -> &'static str {
        if self.deeper_by() > 0.0 { "deeper" } else { "shallower" }
    }

    /// Both depths as tables have them.
    pub fn depth_texts(&self) -> [String; 2] {
        self.depths.map(|depth| format!("{depth:e}"))
    }

    /// The difference as a case of a campaign has it.
    pub fn words(&self) -> String {
        let [before, after] = self.depth_texts();
        format!("{} {}: {before} → {after}", self.cause, self.name())
    }

    /// The difference that a case records in these words, if they are about depths.
    pub fn recorded(words: &str) -> Option<DepthDifference> {
        let (_, depths) = words.split_once(": ")?;
        let (oracle, stepper) = depths.split_once(" → ")?;
        let depths = [oracle.parse().ok()?, stepper.parse().ok()?];
        let of_cause = |cause| DepthDifference { cause, depths };
        [Cause::Arithmetic, Cause::Defect].map(of_cause).into_iter().find(|one| one.words() == words)
    }

    /// Whether this is what a case records: the same cause, the same direction, and no more than twice as much.
    pub fn is_as(&self, recorded: &DepthDifference) -> bool {
        let ratio = self.deeper_by() / recorded.deeper_by();
        self.cause == recorded.cause && ratio > 0.0 && ratio <= 2.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_recorded_depth_is_read_again() {
        let one = DepthDifference { cause: Cause::Arithmetic, depths: [0.125, 0.1] };
        assert_eq!(one.words(), "arithmetic shallower: 1.25e-1 → 1e-1");
        assert_eq!(DepthDifference::recorded(&one.words()), Some(one));
        for other in
            ["arithmetic deeper: 1.25e-1 → 1e-1", "arithmetic velocity: 1 → 2", "tolerance mode v-f: open → locked"]
        {
            assert_eq!(DepthDifference::recorded(other), None, "{other}");
        }
        let found = |cause, stepper| DepthDifference { cause, depths: [0.125, stepper] }.is_as(&one);
        assert!(found(Cause::Arithmetic, 0.1) && found(Cause::Arithmetic, 0.12) && found(Cause::Arithmetic, 0.08));
        assert!(!found(Cause::Arithmetic, 0.07) && !found(Cause::Arithmetic, 0.13) && !found(Cause::Defect, 0.1));
    }

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
