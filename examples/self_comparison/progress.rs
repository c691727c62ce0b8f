//! How far a comparison is: a bar on a terminal, a line now and then elsewhere.

use indicatif::{HumanDuration, ProgressBar, ProgressStyle};
use rockproof_report::table::grouped;
use rockproof_validation::self_comparison::run::Seen;
use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// How often a bar moves.
const MOVES: Duration = Duration::from_millis(200);
/// How often there is a line.
const LINES: Duration = Duration::from_secs(60);

/// Shows how much of so many pairs has been seen until `work` ends, and gives what it gives.
pub(crate) fn shown_while<T>(pairs: u64, seen: &Seen, work: impl FnOnce() -> T) -> T {
    let ended = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| show(pairs, seen, &ended));
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

fn show(pairs: u64, seen: &Seen, ended: &AtomicBool) {
    let bar = std::io::stderr().is_terminal().then(|| {
        let bar = ProgressBar::new(pairs);
        if let Ok(style) = ProgressStyle::with_template("{bar:40} {human_pos}/{human_len} pairs, {msg}") {
            bar.set_style(style);
        }
        bar
    });
    let (mut last, mut is_first) = (Instant::now(), true);
    while !ended.load(Ordering::Relaxed) {
        let done = seen.pairs.load(Ordering::Relaxed);
        let told = format!("{} disagreements", grouped(seen.disagreements.load(Ordering::Relaxed)));
        match &bar {
            Some(bar) => {
                bar.set_position(done);
                if std::mem::take(&mut is_first) {
                    // What an earlier session did says nothing of how fast this one is.
                    bar.reset_eta();
                }
                let left = bar.eta();
                let left = if left.is_zero() { String::new() } else { format!(", {} left", HumanDuration(left)) };
                bar.set_message(told + &left);
            }
            None if last.elapsed() > LINES => {
                last = Instant::now();
                eprintln!("note: {} of {} pairs, {told}", grouped(done), grouped(pairs));
            }
            None => {}
        }
        std::thread::park_timeout(MOVES);
    }
    if let Some(bar) = bar {
        bar.finish_and_clear();
    }
}
