//! The targets on inputs made here, in one program.

mod comparisons;
mod readers;
