//! Systems without process groups and pipes that can be watched: no external engine is started there.

use std::time::Duration;

/// Why a question got no line in answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NoAnswer {
    /// The program could not be started.
    NotStarted(String),
}

/// A program; there is none.
#[derive(Debug)]
pub enum Process {}

impl Process {
    /// Starts nothing.
    ///
    /// # Errors
    /// [`NoAnswer::NotStarted`], always.
    pub fn start(_command: &[String]) -> Result<Process, NoAnswer> {
        Err(NoAnswer::NotStarted("external engines need a Unix system, such as Linux or macOS".to_owned()))
    }

    /// How many questions it was asked before.
    pub fn asked(&self) -> u64 {
        match *self {}
    }

    /// Asks nothing.
    ///
    /// # Errors
    /// None: there is no program.
    pub fn ask(&mut self, _line: String, _patience: Duration) -> Result<Vec<u8>, NoAnswer> {
        match *self {}
    }

    /// Says nothing.
    pub fn has_unread_output(&mut self) -> bool {
        match *self {}
    }

    /// Ends nothing.
    pub fn kill(self) {
        match self {}
    }
}

/// Ends every engine that runs: there is none.
pub fn end_all() {}
