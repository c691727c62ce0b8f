//! Ctrl-C: long work stops in good order.

use crate::exit::note;
use anyhow::Context;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A flag that Ctrl-C sets, which is told. A second Ctrl-C ends the program at once, with exit code 130; what is on disk bears it.
///
/// # Errors
/// When the system gives no handler, or one was set before.
pub(crate) fn on_ctrl_c() -> anyhow::Result<Arc<AtomicBool>> {
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    ctrlc::set_handler(move || {
        if flag.swap(true, Ordering::Relaxed) {
            // What comes next stands on a line of its own, whatever a bar left there.
            note("stopped at once");
            std::process::exit(130);
        }
        note("finishing what has begun; Ctrl-C again to quit at once");
    })
    .context("cannot catch Ctrl-C")?;
    Ok(stop)
}
