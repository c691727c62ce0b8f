//! The stepper against closed forms: each case runs a scene in f32 and f64 and says how far it is from the known answer. And the exact side against
//! itself, on pairs ([`self_comparison`]).
//!
//! `cargo run --release -p rockproof-validation` writes the tables of `docs/validation.md` with its plots, and those of `docs/step.md`; `tests/closed_forms.rs` and
//! `tests/energy.rs` hold the figures. Scenes are those of `cases/handmade`; every case takes the rules of the step as a parameter, so that a test can plant a
//! mistake and see the case fail.

pub mod arch;
pub mod case;
pub mod convergence;
pub mod dominoes;
pub mod elastic;
pub mod energy;
pub mod flight;
pub mod impact;
pub mod incline;
pub mod iterations;
pub mod physics_report;
pub mod plot;
pub mod regimes;
pub mod report;
pub mod rest;
pub mod restitution;
pub mod self_comparison;
pub mod slab;
pub mod stepped_scene;
pub mod toppling;
pub mod wall;
pub mod wedge;

pub use case::{CaseMeasurement, CasePrecision, ValidationCase};
pub use stepped_scene::{CaseFailure, SteppedScene};

use rockproof_stepper::contact::SpecRules;
use rockproof_stepper::dynamics::StepRules;

/// Every case by the rules of SPEC, in the order of the table.
pub fn table() -> Vec<ValidationCase> {
    cases::<SpecRules>()
}

/// Every case by other rules.
pub fn cases<M: StepRules>() -> Vec<ValidationCase> {
    let groups: [fn() -> Vec<ValidationCase>; 12] = [
        flight::cases::<M>,
        incline::cases::<M>,
        slab::cases::<M>,
        rest::cases::<M>,
        elastic::cases::<M>,
        impact::cases::<M>,
        regimes::cases::<M>,
        wedge::cases::<M>,
        arch::cases::<M>,
        toppling::cases::<M>,
        dominoes::cases::<M>,
        restitution::cases::<M>,
    ];
    groups.into_iter().flat_map(|group| group()).collect()
}
