//! Ctrl-C, and what else asks a program to end (TERM, HUP): long work stops in good order, and no engine is left running.

use crate::exit::print_note;
use crate::terminal::{INTERRUPTED, stop_flag};
use anyhow::Context;
use rockproof_differential::external::end_all;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A flag that Ctrl-C sets, which is told, before it ends all external engines, so that none of them is waited for: whoever asked one finds the
/// flag set. A second Ctrl-C ends the program at once, with exit code 130; what is on disk bears it.
///
/// # Errors
/// When the system gives no handler, or one was set before.
pub(crate) fn on_ctrl_c() -> anyhow::Result<Arc<AtomicBool>> {
    stop_flag(end_all, print_note).context(NO_HANDLER)
}

/// The same where another process tells the user.
///
/// # Errors
/// As [`on_ctrl_c`].
#[cfg(feature = "mpi")]
pub(crate) fn on_ctrl_c_silently() -> anyhow::Result<Arc<AtomicBool>> {
    stop_flag(end_all, |_| {}).context(NO_HANDLER)
}

/// For commands that have nothing to go on from: Ctrl-C ends the program at once, and its engines with it, and the user is told.
///
/// # Errors
/// As [`on_ctrl_c`].
pub(crate) fn end_on_ctrl_c() -> anyhow::Result<()> {
    ctrlc::set_handler(|| {
        // First, for a command whose engine is ended may come to its own end before this thread goes on.
        ENDED.store(true, Ordering::SeqCst);
        end_all();
        print_note("interrupted; there is nothing to go on from, so run the command again");
        std::process::exit(INTERRUPTED.into());
    })
    .context(NO_HANDLER)
}

const NO_HANDLER: &str = "cannot catch Ctrl-C";

/// Whether a signal has ended the program at once.
pub(crate) fn is_ended() -> bool {
    ENDED.load(Ordering::SeqCst)
}

static ENDED: AtomicBool = AtomicBool::new(false);
