//! What the program and its long-running examples have in common at a terminal: output whose reader may go away, progress, Ctrl-C and the number
//! of worker threads. It uses nothing else of the program, so that an example can include it by its path.

use indicatif::{HumanDuration, ProgressBar, ProgressState, ProgressStyle};
use rockproof_report::table::grouped;
use std::io::{self, BufWriter, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::Thread;
use std::time::{Duration, Instant};

/// The exit code of a program that was interrupted, as a shell has it.
pub(crate) const INTERRUPTED: u8 = 130;

/// Writes to stdout. A reader that went away (`| head`) is no error.
pub(crate) fn to_stdout(write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut out = BufWriter::new(io::stdout().lock());
    match write(&mut out).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(error),
        _ => Ok(()),
    }
}

/// The most worker threads; more of them than cores gain nothing.
const MAX_THREADS: usize = 1024;

/// A number of worker threads; 0 for one a core.
pub(crate) fn threads(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(threads) if threads <= MAX_THREADS => Ok(threads),
        _ => Err(format!("allowed are 1 to {MAX_THREADS}, and 0 for one a core")),
    }
}

/// That the environment asks for no more worker threads than `--threads` may: a command without the option does as it says.
///
/// # Errors
/// With the variable, what was found and what is allowed.
pub(crate) fn check_environment() -> Result<(), String> {
    let asked = ["RAYON_NUM_THREADS", "RAYON_RS_NUM_CPUS"].map(|name| (name, std::env::var(name).unwrap_or_default()));
    match asked.iter().find(|(_, text)| text.parse::<u64>().is_ok_and(|threads| threads > MAX_THREADS as u64)) {
        Some((name, text)) => Err(format!("{name} is {text}; allowed are 1 to {MAX_THREADS}, and 0 for one a core")),
        None => Ok(()),
    }
}

/// A flag that Ctrl-C sets, after which it calls `ended`, and says so by `note`. A second Ctrl-C ends the program at once, with exit code 130;
/// what is on disk bears it.
///
/// # Errors
/// When the system gives no handler, or one was set before.
pub(crate) fn stop_flag(ended: impl Fn() + Send + 'static, note: fn(&str)) -> Result<Arc<AtomicBool>, ctrlc::Error> {
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    ctrlc::set_handler(move || {
        let again = flag.swap(true, Ordering::SeqCst);
        ended();
        if again {
            // What comes next stands on a line of its own, whatever a bar left there.
            note("stopped at once");
            std::process::exit(INTERRUPTED.into());
        }
        note("stopping in good order; Ctrl-C again to quit at once");
    })?;
    Ok(stop)
}

/// What is said of a directory on a file system without locks.
pub(crate) fn unprotected(dir: &Path) -> String {
    format!("{}: this file system has no locks, so nothing keeps a second process out of this directory", dir.display())
}

/// Progress through so many pairs or the like: a bar, or a line now and then; from the first one on.
pub(crate) struct Progress<'n> {
    /// How many there are, and of what.
    pub(crate) all: (u64, &'static str),
    /// How many are done, and what else there is to say.
    pub(crate) now: &'n (dyn Fn() -> (u64, String) + Sync),
    /// Whether there is a bar.
    pub(crate) has_bar: bool,
    /// Prints a line, where there is no bar.
    pub(crate) line: fn(&str),
    /// How often.
    pub(crate) lines_every: Duration,
}

/// Runs `show` in a thread of its own beside `work`; it is to end when the flag is set, however `work` ends.
pub(crate) fn beside<T>(show: impl FnOnce(&AtomicBool) + Send, work: impl FnOnce() -> T) -> T {
    let ended = AtomicBool::new(false);
    std::thread::scope(|scope| {
        let shown = scope.spawn(|| show(&ended)).thread().clone();
        let _ends = Ends { ended: &ended, shown };
        work()
    })
}

/// How often a bar moves.
pub(crate) const BAR_INTERVAL: Duration = Duration::from_millis(200);

impl Progress<'_> {
    /// Shows it until `work` ends, and gives what that gives.
    pub(crate) fn shown_while<T>(&self, work: impl FnOnce() -> T) -> T {
        beside(|ended| self.show_until(ended), work)
    }

    fn bar(&self) -> ProgressBar {
        let (count, what) = self.all;
        let bar = ProgressBar::new(count);
        if let Ok(style) = ProgressStyle::with_template(&format!("{{bar:40}} {{done}}/{{all}} {what}, {{msg}}")) {
            bar.set_style(in_groups(style));
        }
        // What an earlier session did says nothing of how fast this one is.
        bar.set_position((self.now)().0);
        bar.reset_eta();
        bar
    }

    fn show_until(&self, ended: &AtomicBool) {
        let bar = self.has_bar.then(|| self.bar());
        let mut last = Instant::now();
        while !ended.load(Ordering::Relaxed) {
            let (done, message) = (self.now)();
            match &bar {
                Some(bar) => {
                    bar.set_position(done);
                    // There is no telling before anything is done.
                    let left = bar.eta();
                    let left = if left.is_zero() { String::new() } else { format!(", {} left", HumanDuration(left)) };
                    bar.set_message(message + &left);
                }
                None if last.elapsed() > self.lines_every => {
                    last = Instant::now();
                    let (count, what) = self.all;
                    (self.line)(&format!("{} of {} {what}, {message}", grouped(done), grouped(count)));
                }
                None => {}
            }
            std::thread::park_timeout(BAR_INTERVAL);
        }
        if let Some(bar) = bar {
            bar.finish_and_clear();
        }
    }
}

/// Gives a style `done` and `all`, with the thousands apart as everywhere.
pub(crate) fn in_groups(style: ProgressStyle) -> ProgressStyle {
    let write = |count: u64, w: &mut dyn std::fmt::Write| {
        // A bar that cannot be written to shows nothing either way.
        let _ = w.write_str(&grouped(count));
    };
    style
        .with_key("done", move |state: &ProgressState, w: &mut dyn std::fmt::Write| write(state.pos(), w))
        .with_key("all", move |state: &ProgressState, w: &mut dyn std::fmt::Write| write(state.len().unwrap_or(0), w))
}

/// Ends the display when work ends, however it ends.
struct Ends<'e> {
    ended: &'e AtomicBool,
    shown: Thread,
}

impl Drop for Ends<'_> {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Relaxed);
        // It may be parked until the bar moves again, which nobody is to wait for.
        self.shown.unpark();
    }
}
