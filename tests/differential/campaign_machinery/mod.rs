//! The campaign's machinery with toys in place of oracle and engines: causes, interruption, threads.

mod attribution;
mod distribute;
mod merge;
mod metamorphic;
mod resume;
mod scripted;
