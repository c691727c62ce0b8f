//! Stepper, oracle and engines side by side: agreement, causes, families, lockstep, and planted mistakes that must be found.

#[path = "../support/boxes.rs"]
mod boxes;
#[path = "../../crates/stepper/src/dynamics/step/bricks.rs"]
mod bricks;
#[path = "../support/mistaken_engine.rs"]
mod mistaken_engine;
#[path = "../../crates/stepper/tests/support/mistakes.rs"]
mod mistakes;
#[path = "../support/place.rs"]
mod place;
#[path = "../support/side_by_side_step.rs"]
mod side_by_side_step;
#[path = "../../crates/stepper/tests/support/step_mistakes.rs"]
mod step_mistakes;
#[path = "../support/thread_ranks.rs"]
mod thread_ranks;

mod campaign_machinery;
mod campaign_mistakes;
mod campaign_steps;
mod exact_trajectory;
mod families;
mod lockstep;
mod lockstep_table;
mod passages;
mod planted_step_mistakes;
mod shrunk_cases;
mod state_files;
mod step_threads;
mod tune_ranks;
