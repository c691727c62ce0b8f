//! Makes of the parts of a campaign the directory that one machine would have made: the same bytes in every table and case file.
//!
//! Counts add up in any order, and rows come in the order of the pairs. Which findings get a case file follows from all of them in that
//! order: the choice is made again from the rows, chunk by chunk as in one run, and only the files that it asks for are made.

mod parts;
mod replay;
mod rows;

pub use parts::{MergeError, Parts};
pub use replay::Merged;
