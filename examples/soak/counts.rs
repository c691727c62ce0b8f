//! What was tried.

use std::fmt;
use std::sync::Mutex;
use std::time::Duration;

/// Counts of everything that a soak does.
#[derive(Clone, Debug, Default)]
pub(crate) struct Counts {
    pub(crate) steps: u64,
    pub(crate) kills: u64,
    pub(crate) interruptions: u64,
    /// Writing failed because a file must not grow any more.
    pub(crate) limited_files: u64,
    /// Writing failed because the disk was full.
    pub(crate) full_disks: u64,
    pub(crate) read_only: u64,
    pub(crate) environments: u64,
    /// Processes that began under a clock set anew.
    pub(crate) clocks: u64,
    /// Those of them that were found to know the time that the clock was set to.
    pub(crate) clocks_seen: u64,
    pub(crate) damages_refused: u64,
    pub(crate) damages_harmless: u64,
    pub(crate) faulty_engines: u64,
    pub(crate) program_inputs: u64,
    pub(crate) reader_inputs: u64,
    /// Runs that were compared with an undisturbed one, byte by byte.
    pub(crate) comparisons: u64,
    pub(crate) processes: u64,
    pub(crate) failures: u64,
    pub(crate) longest: Duration,
    /// The longest input to a reader in this process.
    pub(crate) longest_input: Duration,
    /// The largest resident memory of a process, in KiB.
    pub(crate) memory: u64,
}

impl Counts {
    /// Adds what one step did.
    fn add(&mut self, other: &Counts) {
        let pairs = [
            (&mut self.steps, other.steps),
            (&mut self.kills, other.kills),
            (&mut self.interruptions, other.interruptions),
            (&mut self.limited_files, other.limited_files),
            (&mut self.full_disks, other.full_disks),
            (&mut self.read_only, other.read_only),
            (&mut self.environments, other.environments),
            (&mut self.clocks, other.clocks),
            (&mut self.clocks_seen, other.clocks_seen),
            (&mut self.damages_refused, other.damages_refused),
            (&mut self.damages_harmless, other.damages_harmless),
            (&mut self.faulty_engines, other.faulty_engines),
            (&mut self.program_inputs, other.program_inputs),
            (&mut self.reader_inputs, other.reader_inputs),
            (&mut self.comparisons, other.comparisons),
            (&mut self.processes, other.processes),
            (&mut self.failures, other.failures),
        ];
        pairs.into_iter().for_each(|(sum, more)| *sum += more);
        self.longest = self.longest.max(other.longest);
        self.longest_input = self.longest_input.max(other.longest_input);
        self.memory = self.memory.max(other.memory);
    }
}

impl fmt::Display for Counts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} steps: {} kills, {} interruptions, {} files and {} disks full, {} read-only directories, {} environments, \
             {} clocks ({} told by the program), {} damaged files ({} refused, {} harmless), {} faulty engines, {} mutated inputs to the program and {} to readers; \
             {} processes, {} comparisons with an undisturbed run, longest process {:.1} s, longest input {:.1} s, peak memory {} MiB; {} failures",
            grouped(self.steps),
            grouped(self.kills),
            grouped(self.interruptions),
            grouped(self.limited_files),
            grouped(self.full_disks),
            grouped(self.read_only),
            grouped(self.environments),
            grouped(self.clocks),
            grouped(self.clocks_seen),
            grouped(self.damages_refused + self.damages_harmless),
            grouped(self.damages_refused),
            grouped(self.damages_harmless),
            grouped(self.faulty_engines),
            grouped(self.program_inputs),
            grouped(self.reader_inputs),
            grouped(self.processes),
            grouped(self.comparisons),
            self.longest.as_secs_f64(),
            self.longest_input.as_secs_f64(),
            self.memory / 1024,
            grouped(self.failures),
        )
    }
}

/// A number with a comma between thousands.
fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let place = |k: usize| k > 0 && (digits.len() - k).is_multiple_of(3);
    digits.chars().enumerate().flat_map(|(k, c)| place(k).then_some(',').into_iter().chain([c])).collect()
}

/// Counts that many threads add to.
#[derive(Debug, Default)]
pub(crate) struct Total(Mutex<Counts>);

impl Total {
    pub(crate) fn add(&self, counts: &Counts) {
        self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner).add(counts);
    }

    pub(crate) fn now(&self) -> Counts {
        self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner).clone()
    }
}
