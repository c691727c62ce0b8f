//! Progress of a campaign, of a merge, of classification or of an examination, while it works.

use crate::exit::{print_note, shows_progress};
use crate::table::grouped;
use crate::terminal::{BAR_INTERVAL, Progress, beside, in_groups};
use indicatif::{ProgressBar, ProgressStyle};
use rockproof_campaign::journal::ProgressCounts;
use rockproof_examine::{MeasuredOverlaps, OverlapScope, Overlaps, Stage, StageProgress, WorkProgress};
use rockproof_model::{Scene, ToleranceSet};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Time between two lines, where there is no bar.
const LINES: Duration = Duration::from_secs(10);

/// Shows how much of so many pairs has been seen, until `work` ends, and gives what it gives.
pub(crate) fn shown_while<T>(pairs: u64, seen: Arc<ProgressCounts>, work: impl FnOnce() -> T) -> T {
    let now = || {
        let shrinking = if seen.shrinking.load(Ordering::Relaxed) { ", shrinking some" } else { "" };
        let findings = grouped(seen.findings.load(Ordering::Relaxed));
        (seen.pairs.load(Ordering::Relaxed), format!("{findings} findings{shrinking}"))
    };
    progress((pairs, "pairs"), &now).shown_while(work)
}

/// Shows how many of so many `work` has counted, of what, and what it does with them, until it ends, and gives what it gives.
pub(crate) fn counted_while<T>(all: (u64, &'static str), doing: &str, work: impl FnOnce(&AtomicU64) -> T) -> T {
    let done = AtomicU64::new(0);
    progress(all, &|| (done.load(Ordering::Relaxed), doing.to_owned())).shown_while(|| work(&done))
}

fn progress<'n>(all: (u64, &'static str), now: &'n (dyn Fn() -> (u64, String) + Sync)) -> Progress<'n> {
    Progress { all, now, has_bar: shows_progress(), line: print_note, lines_every: LINES }
}

/// The overlaps of all neighbouring pairs of a scene, or of some, measured where they may be more than rounding, with progress.
pub(crate) fn overlaps(scene: &Scene, tolerances: &ToleranceSet, only: Option<&[(usize, usize)]>) -> Overlaps {
    let (seen, stop) = (WorkProgress::default(), AtomicBool::new(false));
    stages_while(&seen, || {
        let (measured, fixed) = (MeasuredOverlaps::BeyondRounding, scene.fixed());
        let scope = OverlapScope { only, measured, fixed: &fixed };
        rockproof_examine::overlaps(&scene.shapes(), tolerances, scope, &seen, &stop)
    })
}

/// Shows what `work` tells `seen`, part by part, until it ends, and gives what it gives.
pub(crate) fn stages_while<T>(seen: &WorkProgress, work: impl FnOnce() -> T) -> T {
    beside(|ended| show_stages(seen, ended), work)
}

fn show_stages(seen: &WorkProgress, ended: &AtomicBool) {
    let has_bar = shows_progress();
    let mut bar: Option<(Stage, ProgressBar)> = None;
    let mut last = Instant::now();
    while !ended.load(Ordering::Relaxed) {
        if let Some(now) = seen.now() {
            if has_bar {
                move_bar(&mut bar, now);
            } else if last.elapsed() > LINES {
                last = Instant::now();
                print_note(&format!("{}: {} of {}", now.stage.name(), grouped(now.done), grouped(now.total)));
            }
        }
        std::thread::park_timeout(BAR_INTERVAL);
    }
    if let Some((_, bar)) = bar {
        bar.finish_and_clear();
    }
}

/// Moves the bar of a part, in the place of that of the part before.
fn move_bar(bar: &mut Option<(Stage, ProgressBar)>, now: StageProgress) {
    if bar.as_ref().is_none_or(|(stage, _)| *stage != now.stage) {
        let new = ProgressBar::new(now.total);
        if let Ok(style) = ProgressStyle::with_template("{msg}: {bar:40} {done}/{all}, {eta} left") {
            new.set_style(in_groups(style));
        }
        new.set_message(now.stage.name());
        if let Some((_, old)) = bar.replace((now.stage, new)) {
            old.finish_and_clear();
        }
    }
    if let Some((_, bar)) = bar {
        bar.set_length(now.total);
        bar.set_position(now.done);
    }
}
