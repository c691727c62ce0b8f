//! A run of the stepper over time, and what it leaves on disk: tables, pictures for ParaView, checkpoints.
//!
//! `docs/simulate.md` describes the files. A run can be killed at any moment and resumes from its last
//! checkpoint with byte-identical files.

pub mod audit;
pub mod checkpoint;
pub mod energy_gain;
pub mod exact_float;
pub mod f64_vector;
pub mod false_entrances;
pub mod frame;
pub mod identity;
pub mod plan;
pub mod record;
pub mod run;
pub mod standstill;
pub mod stretch;
pub mod tables;
pub mod totals;
pub mod volume_change;
pub mod worst_intrusions;

pub use audit::{AuditScope, AuditTotals, PairDepth, StepAudit, StepPassages};
pub use energy_gain::{EnergyBalance, EnergyGain, EnergyInput};
pub use false_entrances::{FalseEntrance, FalseEntranceSteps, FalseEntranceTotals, FirstFalseEntrance};
pub use plan::Plan;
pub use record::RunRecord;
pub use run::{Ending, Run, RunError, Stepping};
pub use standstill::{Standstill, StandstillWatch};
pub use stretch::Stretch;
pub use totals::Totals;
pub use volume_change::VolumeChange;
pub use worst_intrusions::{IntrusionRow, WorstIntrusion, WorstIntrusions};
