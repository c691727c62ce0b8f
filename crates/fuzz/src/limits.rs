//! What an input may take of time and memory.

use crate::Target;
use crate::reach::Reach;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

/// An input may take less than so many seconds.
pub const MAX_SECONDS: u64 = 20;
/// So much memory a process may hold, in KiB.
pub const MAX_MEMORY: u64 = 1 << 20;

impl Target {
    /// Takes an input as [`Target::run`] does; how long it took.
    ///
    /// # Errors
    /// When it took [`MAX_SECONDS`] or more, or the process came to hold more than [`MAX_MEMORY`] meanwhile: in this thread or in another.
    ///
    /// # Panics
    /// When something is wrong.
    pub fn run_within_limits(&self, bytes: &[u8], reach: &mut Reach) -> Result<Duration, String> {
        within(Duration::from_secs(MAX_SECONDS), MAX_MEMORY, || self.run(bytes, reach))
    }
}

/// Does something within a time and so many KiB of memory.
fn within(most_time: Duration, most_memory: u64, work: impl FnOnce()) -> Result<Duration, String> {
    let (begin, before) = (Instant::now(), peak_memory(Path::new("/proc/self")));
    work();
    let took = begin.elapsed();
    if took >= most_time {
        return Err(format!("an input of {took:.0?}"));
    }
    let memory = peak_memory(Path::new("/proc/self"));
    // The peak is that of all threads, and never falls.
    if before <= most_memory && memory > most_memory {
        return Err(format!("{} MiB while it read this or another thread something else", memory / 1024));
    }
    Ok(took)
}

/// The most memory that a process has held, in KiB, where the system tells (Linux); otherwise 0. `proc` is its directory beneath `/proc`.
pub fn peak_memory(proc: &Path) -> u64 {
    let status = fs::read_to_string(proc.join("status")).unwrap_or_default();
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    peak.and_then(|text| text.trim().strip_suffix("kB")?.trim().parse().ok()).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_input_that_takes_long_is_told() {
        let short = Duration::from_millis(1);
        let error = within(short, u64::MAX, || std::thread::sleep(5 * short)).expect_err("too long");
        assert!(error.starts_with("an input of "), "{error}");
        assert!(within(Duration::from_secs(3600), u64::MAX, || ()).is_ok());
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn an_input_that_takes_much_memory_is_told() {
        const MIB: usize = 1 << 20;
        let hour = Duration::from_secs(3600);
        let most = peak_memory(Path::new("/proc/self")) + 32 * 1024;
        let held = |mib: usize| drop(std::hint::black_box(vec![1_u8; mib * MIB]));
        assert!(within(hour, most, || held(1)).is_ok());
        let error = within(hour, most, || held(128)).expect_err("too much");
        assert!(error.contains(" MiB while it read this"), "{error}");
    }
}
