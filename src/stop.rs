//! Ctrl-C, and what else asks a program to end (TERM, HUP): long work stops in good order, and no engine is left running.

use crate::exit::print_note;
use anyhow::Context;
use rockproof_differential::external::end_all;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The exit code of a program that was interrupted, as a shell has it.
pub(crate) const INTERRUPTED: u8 = 130;

/// A flag that Ctrl-C sets, which is told, before it ends all external engines, so that none of them is waited for: whoever asked one finds the
/// flag set. A second Ctrl-C ends the program at once, with exit code 130; what is on disk bears it.
///
/// # Errors
/// When the system gives no handler, or one was set before.
pub(crate) fn on_ctrl_c() -> anyhow::Result<Arc<AtomicBool>> {
    stop_flag(print_note)
}

/// The same where another process tells the user.
///
/// # Errors
/// As [`on_ctrl_c`].
#[cfg(feature = "mpi")]
pub(crate) fn on_ctrl_c_silently() -> anyhow::Result<Arc<AtomicBool>> {
    stop_flag(|_| {})
}

fn stop_flag(told: fn(&str)) -> anyhow::Result<Arc<AtomicBool>> {
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    ctrlc::set_handler(move || {
        let again = flag.swap(true, Ordering::SeqCst);
        end_all();
        if again {
            // What comes next stands on a line of its own, whatever a bar left there.
            told("stopped at once");
            std::process::exit(INTERRUPTED.into());
        }
        told("finishing what has begun; Ctrl-C again to quit at once");
    })
    .context("cannot catch Ctrl-C")?;
    Ok(stop)
}

/// For commands that have nothing to go on from: Ctrl-C ends the program at once, and its engines with it.
///
/// # Errors
/// As [`on_ctrl_c`].
pub(crate) fn end_on_ctrl_c() -> anyhow::Result<()> {
    ctrlc::set_handler(|| {
        // First, for a command whose engine is ended may come to its own end before this thread goes on.
        ENDED.store(true, Ordering::SeqCst);
        end_all();
        std::process::exit(INTERRUPTED.into());
    })
    .context("cannot catch Ctrl-C")
}

/// Whether a signal has ended the program at once.
pub(crate) fn is_ended() -> bool {
    ENDED.load(Ordering::SeqCst)
}

static ENDED: AtomicBool = AtomicBool::new(false);
