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

/// What Ctrl-C does to work that has to be made ready first.
pub(crate) struct ReadyingStop {
    /// Whether the work has begun.
    begun: Arc<AtomicBool>,
    stop: Arc<AtomicBool>,
}

impl ReadyingStop {
    /// Says that the work begins; what comes back is as from [`on_ctrl_c`].
    pub(crate) fn begin(self) -> Arc<AtomicBool> {
        self.begun.store(true, Ordering::SeqCst);
        self.stop
    }
}

/// As [`on_ctrl_c`], but as long as the work is made ready, when nothing is there to keep, Ctrl-C ends the program at once, and `note` is told.
///
/// # Errors
/// As [`on_ctrl_c`].
pub(crate) fn on_ctrl_c_while_readying(note: &'static str) -> anyhow::Result<ReadyingStop> {
    let begun = Arc::new(AtomicBool::new(false));
    let is_begun = Arc::clone(&begun);
    let ended = move || {
        if !is_begun.load(Ordering::SeqCst) {
            ENDED.store(true, Ordering::SeqCst);
            print_note(note);
            std::process::exit(INTERRUPTED.into());
        }
        end_all();
    };
    let stop = stop_flag(ended, print_note).context(NO_HANDLER)?;
    Ok(ReadyingStop { begun, stop })
}

/// As [`on_ctrl_c`], where another process tells the user.
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
