//! Is this model safe? Its blocks and tolerances, every neighbouring pair, some steps, and a set of tolerances that does better.
//!
//! [`examine`] does the work: it tells how far it is by [`WorkProgress`], ends where a flag is set, prints nothing and writes nothing. [`Verdict`] is the
//! answer in words, [`write()`] leaves page, tables, grid and cases in a directory. What a model is looked at with is a [`CheckedModel`].

mod assess;
mod bare_edges;
mod cases;
mod checked;
mod deepest;
mod document;
mod error;
mod extents;
mod false_entrances;
mod intrusion_recorder;
mod local_origin;
mod naming;
mod near_others;
mod next_command;
mod overlaps;
mod pairs;
mod passed_rows;
mod past_middle;
mod pressed_springs;
mod progress;
mod recommend;
mod results;
mod step_audit;
mod step_line;
mod steps;
mod stored_energy;
mod unused_laws;
mod verdict;
mod view;
mod warning_lines;

pub use assess::{Assessment, Examination, Settings, examine};
pub use bare_edges::{BareEdge, bare_edges};
pub use cases::{KeptCase, worst_cases};
pub use checked::{
    BlockCounts, CheckError, CheckedModel, ignored_of_fixed, ignored_of_rigid, in_seven_digits, refuse_too_large,
    tolerances_json, violation_json, violations_text,
};
pub use document::document;
pub use error::ExamineError;
pub use extents::{Extents, short};
pub use intrusion_recorder::{IntrusionCases, IntrusionRecorder};
pub use local_origin::{LocalOrigin, point_in_decimals};
pub use naming::{Naming, file_name, reading, setting};
pub use overlaps::{MeasuredOverlaps, OverlapScope, Overlaps, overlaps};
pub use pairs::{EngineDifferences, ExaminedPair};
pub use passed_rows::passed_rows;
pub use pressed_springs::PressedSpring;
pub use progress::{Stage, StageProgress, WorkProgress};
pub use recommend::{PreferredSet, Recommendation};
pub use results::{FILES, WrittenFiles, findings_table, pair_table, tolerance_table, write};
pub use step_audit::AuditedRun;
pub use steps::{AuditedSteps, Steps};
pub use stored_energy::{StoredEnergy, unexplained_energy};
pub use unused_laws::unused_laws;
pub use verdict::{Line, Verdict, mark};
