//! Progress of a campaign, of a merge or of an audit of overlaps, while it works.

use crate::exit::{print_note, shows_progress};
use crate::table::grouped;
use indicatif::{HumanDuration, ProgressBar, ProgressStyle};
use rockproof_campaign::journal::Seen;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Shows how much of so many pairs has been seen, until `work` ends, and gives what it gives.
pub(crate) fn shown_while<T>(pairs: u64, seen: Arc<Seen>, work: impl FnOnce() -> T) -> T {
    let now = || {
        let shrinking = if seen.shrinking.load(Ordering::Relaxed) { ", shrinking some" } else { "" };
        let told = format!("{} findings{shrinking}", grouped(seen.findings.load(Ordering::Relaxed)));
        (seen.pairs.load(Ordering::Relaxed), told)
    };
    told_while(pairs, &now, work)
}

/// Shows how many of so many pairs `work` has counted, and what it does with them, until it ends, and gives what it gives.
pub(crate) fn counted_while<T>(pairs: u64, doing: &str, work: impl FnOnce(&AtomicU64) -> T) -> T {
    let done = AtomicU64::new(0);
    told_while(pairs, &|| (done.load(Ordering::Relaxed), doing.to_owned()), || work(&done))
}

/// Shows what `now` tells: pairs done, and what else there is to say.
fn told_while<T>(pairs: u64, now: &(dyn Fn() -> (u64, String) + Sync), work: impl FnOnce() -> T) -> T {
    let ended = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| Display::new(pairs, now).show_until(&ended));
        let _ends = Ends(&ended);
        work()
    })
}

/// Ends the display when work ends, however it ends.
struct Ends<'e>(&'e AtomicBool);

impl Drop for Ends<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// A bar on a terminal, a line now and then otherwise; from the first pair on.
struct Display<'n> {
    bar: Option<ProgressBar>,
    pairs: u64,
    now: &'n dyn Fn() -> (u64, String),
}

/// How often a bar moves.
const MOVES: Duration = Duration::from_millis(200);
/// How often there is a line.
const LINES: Duration = Duration::from_secs(10);

impl<'n> Display<'n> {
    fn new(pairs: u64, now: &'n dyn Fn() -> (u64, String)) -> Display<'n> {
        let bar = shows_progress().then(|| {
            let bar = ProgressBar::new(pairs);
            let template = "{bar:40} {human_pos}/{human_len} pairs, {msg}";
            if let Ok(style) = ProgressStyle::with_template(template) {
                bar.set_style(style);
            }
            bar.set_position(now().0);
            bar.reset_eta();
            bar
        });
        Display { bar, pairs, now }
    }

    fn show_until(&self, ended: &AtomicBool) {
        let mut last = Instant::now();
        while !ended.load(Ordering::Relaxed) {
            let (pairs, told) = (self.now)();
            match &self.bar {
                Some(bar) => {
                    bar.set_position(pairs);
                    // There is no telling before anything is done.
                    let left = bar.eta();
                    let left = if left.is_zero() { String::new() } else { format!(", {} left", HumanDuration(left)) };
                    bar.set_message(format!("{told}{left}"));
                }
                None if last.elapsed() > LINES => {
                    last = Instant::now();
                    print_note(&format!("{} of {} pairs, {told}", grouped(pairs), grouped(self.pairs)));
                }
                None => {}
            }
            std::thread::park_timeout(MOVES);
        }
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
