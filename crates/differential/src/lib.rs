//! What stands on both sides: engines and the oracle asked the same, their answers compared, and the cause of each difference
//! (SPEC section 6). Pairs of blocks at the top, steps of scenes in [`lockstep`].

pub mod agreement;
pub mod agreement_record;
pub mod answer_detail;
pub mod attribution;
pub mod builtin;
pub mod case_file;
pub mod collapse;
pub mod collision;
pub mod compare;
pub mod diagnosis;
pub mod engine;
pub mod explain;
pub mod external;
pub mod finding;
pub mod hull;
pub mod indexed_trace;
pub mod lockstep;
pub mod metamorphic;
pub mod motion;
pub mod neighbours;
pub mod row;
pub mod separation_state;
pub mod subject;
pub mod transform;
