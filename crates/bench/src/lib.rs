//! How fast pairs are classified, in floating point and exactly: the cases, the entries of the bench, and interleaved timing that compares
//! them fairly on a busy machine. Beside it, what a step of a large
//! scene costs, and what a certified step does. The command `bench` prints the figures; `benches/` runs the same cases in criterion.

pub mod accuracy;
pub mod bench_entry;
pub mod closed_forms;
pub mod exact_stepping;
pub mod plot;
pub mod sample;
pub mod skips;
pub mod stepping;
pub mod throughput;
pub mod time_interleaved;

pub use bench_entry::{BenchEntry, TimedPart, bench_entries};
pub use exact_stepping::{ExactCost, exact_stepping};
pub use sample::{PreparedPair, Sample, SampleKind};
pub use skips::{SKIPS, SkipCost, SkipScene, skip_cost, skip_scenes};
pub use stepping::{SteppingCost, SteppingError, rock, stack, stepping, wall};
pub use throughput::{Throughput, ThroughputError, ThroughputRun, throughput};
pub use time_interleaved::{Disagreement, Timing, TimingPlan, time_interleaved};
