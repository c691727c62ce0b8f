//! What an examination is doing, for whoever shows it meanwhile.

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

/// A part of the work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Neighbouring pairs are looked at for overlaps.
    Overlaps,
    /// Neighbouring pairs are classified exactly and in floats, and differences explained.
    Pairs,
    /// Steps are made and audited, settling among them.
    Steps,
    /// Tolerance sets are tried.
    Sets,
}

impl Stage {
    /// What is counted.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Overlaps => "overlaps",
            Stage::Pairs => "pairs",
            Stage::Steps => "steps",
            Stage::Sets => "tolerance sets",
        }
    }
}

/// How far a part of the work is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StageProgress {
    /// The part.
    pub stage: Stage,
    /// How much is done.
    pub done: u64,
    /// How much there is.
    pub total: u64,
}

/// How far the work is, counted while it goes on.
#[derive(Debug, Default)]
pub struct WorkProgress {
    stage: Mutex<Option<(Stage, u64)>>,
    done: AtomicU64,
}

impl WorkProgress {
    /// What is being done; nothing before the first part begins.
    pub fn now(&self) -> Option<StageProgress> {
        let stage = self.stage.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        stage.map(|(stage, total)| StageProgress { stage, done: self.done.load(Ordering::Relaxed), total })
    }

    /// A part that has so much to do begins.
    pub(crate) fn begin(&self, stage: Stage, total: usize) {
        let mut now = self.stage.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        self.done.store(0, Ordering::Relaxed);
        *now = Some((stage, total as u64));
    }

    /// One more is done.
    pub(crate) fn advance(&self) {
        self.done.fetch_add(1, Ordering::Relaxed);
    }
}
