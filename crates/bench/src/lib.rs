//! How fast pairs are classified, in floating point and exactly: the cases, the contestants, and a race that compares
//! them fairly on a busy machine. Beside it, what a step of a large
//! scene costs, and what a certified step does. The command `bench` prints the figures; `benches/` runs the same cases in criterion.

pub mod closed;
pub mod contestant;
pub mod error;
pub mod exact_stepping;
pub mod plot;
pub mod race;
pub mod sample;
pub mod stepping;
pub mod throughput;

pub use contestant::{Contestant, Mode, contestants};
pub use exact_stepping::{ExactCost, exact_stepping};
pub use race::{Disagreement, Figure, Plan, race};
pub use sample::{Ready, Sample, Sort};
pub use stepping::{Cost, SteppingError, rock, stack, stepping, wall};
pub use throughput::{Run, Throughput, ThroughputError, throughput};
