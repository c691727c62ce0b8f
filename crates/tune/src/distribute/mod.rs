//! A search on many processes. Each measures whole candidates, and those ahead of the next one as well: which they are depends on the best
//! so far, and seldom does the best change (`lookahead.rs`). What was measured of a candidate that is not tried after all is forgotten. Rank 0
//! takes candidates in order and keeps the record, so this holds what one process writes, byte for byte.
//!
//! Messages travel by a [`Transport`](rockproof_campaign::distribute::Transport), as those of a campaign.

mod crew;
mod lookahead;
mod message;
mod worker;

pub use crew::{Crew, StopCriterion};
pub use worker::{SearchTask, serve};
