//! A campaign on many processes. One of them, rank 0, hands out ranges of pairs and keeps the journal; the others, the workers, examine pairs and
//! make case files. What the journal holds is what one process writes, byte for byte: rows are put in the order of the pairs, and case files are
//! chosen by rank 0, chunk by chunk.
//!
//! Messages travel by a [`Transport`]; this crate knows of none. What has to do with no campaign is in [`ranks`], for other jobs of many processes.

mod coordinator;
mod crew;
mod message;
mod plan;
pub mod ranks;
mod remote;
mod reread;
mod worker;

pub use crew::{Crew, Distributed};
pub use ranks::Introduction;
pub use reread::{DecodedMessage, MessageKind, reread};
pub use worker::{WorkerPanic, serve};

use std::time::Duration;

/// Carries messages between ranks, those of two ranks in the order in which they were sent.
pub trait Transport {
    /// How many ranks there are, this one among them.
    fn ranks(&self) -> usize;

    /// Sends a message. While this waits for the other rank, messages must still be taken in, for that one may be sending too.
    fn send(&mut self, to: usize, message: &[u8]);

    /// A message that has come, and from which rank.
    fn receive(&mut self) -> Option<(usize, Vec<u8>)>;
}

/// Why processes do not work together.
#[derive(Debug, thiserror::Error)]
pub enum DistributeError {
    /// A worker cannot begin.
    #[error("rank {rank} ({host}): {what}")]
    Worker {
        /// The worker.
        rank: usize,
        /// The machine it runs on.
        host: String,
        /// What it said.
        what: String,
    },
    /// A worker was started otherwise, or reads other files.
    #[error(
        "rank {rank} ({host}) is to do something else than rank 0:\n  {}\nstart all ranks with one command, on files that all of them see",
        differences.join("\n  ")
    )]
    Configuration {
        /// The worker.
        rank: usize,
        /// The machine it runs on.
        host: String,
        /// One line for each key that differs.
        differences: Vec<String>,
    },
    /// A worker answers differently.
    #[error(
        "rank {rank} ({host}, {machine}) and rank 0 ({here}) answer the first pairs differently, so what they find does not go together: start one build of the program, on machines of one kind"
    )]
    Answers {
        /// The worker.
        rank: usize,
        /// The machine it runs on.
        host: String,
        /// Its system and processor.
        machine: String,
        /// Those of rank 0.
        here: String,
    },
    /// A message that cannot be written.
    #[error("cannot write a message to another rank: {0}")]
    Unwritable(postcard::Error),
    /// An introduction that cannot be written.
    #[error("cannot write a message to rank 0: {0}")]
    Introduction(serde_json::Error),
    /// A message that cannot be understood.
    #[error("rank {rank} sent a message that cannot be read: {what}; start one build of the program on all ranks")]
    Message {
        /// Who sent it.
        rank: usize,
        /// What is wrong.
        what: String,
    },
}

/// Waits a little longer each time, so that a rank without work does not take time from one that has some.
#[derive(Default)]
pub struct Backoff(u32);

impl Backoff {
    const SHORTEST: Duration = Duration::from_micros(50);
    const DOUBLINGS: u32 = 6;

    /// Something came: the next wait is short.
    pub fn reset(&mut self) {
        self.0 = 0;
    }

    /// Sleeps, longer than the last time: from 50 µs up to 3 ms.
    pub fn wait(&mut self) {
        std::thread::sleep(Backoff::SHORTEST * (1 << self.0));
        self.0 = (self.0 + 1).min(Backoff::DOUBLINGS);
    }
}
