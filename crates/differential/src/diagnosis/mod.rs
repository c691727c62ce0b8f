//! What is wrong with an engine, by hypotheses: its answers beside those that an exact engine with one mistake would give.
//!
//! A hypothesis counts by how many of the differing answers it explains, and only while no answer that is right speaks against it. What no
//! hypothesis explains is either so near to a tie that rounding can be the reason, or stays unexplained; both are said.

mod altered_rules;
mod answers;
mod constants;
mod contradictions;
mod hypothesis;
mod input;
mod judge;
mod lag;
mod parts;
mod question;
mod ranges;
mod row;
mod states;
mod tolerances;

pub use contradictions::OtherQuestions;
pub use judge::{Asking, Sample, diagnose};
pub use question::{Question, Reply, ask};
pub use row::{DIAGNOSIS_COLUMNS, DiagnosisRow, DiagnosisVerdict, diagnosis_lines};
