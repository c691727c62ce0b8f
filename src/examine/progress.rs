//! What `examine` is doing: a bar on a terminal, a line now and then otherwise.

use crate::exit::{print_note, shows_progress};
use crate::table::grouped;
use indicatif::{ProgressBar, ProgressStyle};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Time between two lines.
const LINES: Duration = Duration::from_secs(10);

/// A part of the work, which can be stopped.
pub(crate) struct Stage<'s> {
    what: &'static str,
    total: u64,
    done: AtomicU64,
    stop: &'s AtomicBool,
    bar: Option<ProgressBar>,
    told: Mutex<Instant>,
}

impl<'s> Stage<'s> {
    /// A part that has so much to do; 0 where nobody knows.
    pub(crate) fn new(what: &'static str, total: u64, stop: &'s AtomicBool) -> Stage<'s> {
        let bar = shows_progress().then(|| {
            let bar = if total > 0 { ProgressBar::new(total) } else { ProgressBar::new_spinner() };
            let template = if total > 0 { "{msg}: {bar:40} {human_pos}/{human_len}, {eta} left" } else { "{msg} …" };
            if let Ok(style) = ProgressStyle::with_template(template) {
                bar.set_style(style);
            }
            bar.set_message(what);
            bar.tick();
            bar
        });
        Stage { what, total, done: AtomicU64::new(0), stop, bar, told: Mutex::new(Instant::now()) }
    }

    /// Whether the work is to end.
    pub(crate) fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::SeqCst)
    }

    /// One more is done.
    pub(crate) fn advance(&self) {
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        if let Some(bar) = &self.bar {
            bar.set_position(done);
            return;
        }
        // Whoever finds it taken leaves the line to the other.
        let Ok(mut told) = self.told.try_lock() else { return };
        if told.elapsed() > LINES {
            *told = Instant::now();
            print_note(&format!("{}: {} of {}", self.what, grouped(done), grouped(self.total)));
        }
    }
}

impl Drop for Stage<'_> {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
