//! Progress of a campaign, of a merge or of an audit of overlaps, while it works.

use crate::exit::{print_note, shows_progress};
use crate::table::grouped;
use crate::terminal::Progress;
use rockproof_campaign::journal::Seen;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Shows how much of so many pairs has been seen, until `work` ends, and gives what it gives.
pub(crate) fn shown_while<T>(pairs: u64, seen: Arc<Seen>, work: impl FnOnce() -> T) -> T {
    let now = || {
        let shrinking = if seen.shrinking.load(Ordering::Relaxed) { ", shrinking some" } else { "" };
        let findings = grouped(seen.findings.load(Ordering::Relaxed));
        (seen.pairs.load(Ordering::Relaxed), format!("{findings} findings{shrinking}"))
    };
    progress(pairs, &now).shown_while(work)
}

/// Shows how many of so many pairs `work` has counted, and what it does with them, until it ends, and gives what it gives.
pub(crate) fn counted_while<T>(pairs: u64, doing: &str, work: impl FnOnce(&AtomicU64) -> T) -> T {
    let done = AtomicU64::new(0);
    progress(pairs, &|| (done.load(Ordering::Relaxed), doing.to_owned())).shown_while(|| work(&done))
}

fn progress(pairs: u64, now: &(dyn Fn() -> (u64, String) + Sync)) -> Progress<'_> {
    Progress { pairs, now, has_bar: shows_progress(), line: print_note, lines_every: Duration::from_secs(10) }
}
