//! Long work beside an interpreter that goes on: it holds no lock of Python's, and Ctrl-C ends it.

use pyo3::prelude::*;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// How long signals may wait.
const PATIENCE: Duration = Duration::from_millis(50);

/// Runs `work` in a thread of its own, without Python's lock, while this one looks for signals. One that raises sets the flag that `work` is
/// given; what it raised is raised when `work` has ended.
///
/// # Errors
/// What a signal raised.
pub(crate) fn interruptible<T: Send>(py: Python<'_>, work: impl FnOnce(&AtomicBool) -> T + Send) -> PyResult<T> {
    interruptible_with(py, |_| Ok(()), work)
}

/// The same, where `tick` is called now and then; what it raises ends the work as a signal does.
///
/// # Errors
/// What a signal or `tick` raised.
pub(crate) fn interruptible_with<T: Send>(
    py: Python<'_>,
    tick: impl Fn(Python<'_>) -> PyResult<()> + Sync,
    work: impl FnOnce(&AtomicBool) -> T + Send,
) -> PyResult<T> {
    let stop = AtomicBool::new(false);
    py.detach(|| {
        thread::scope(|scope| {
            let (ended, end) = channel::<()>();
            let stop = &stop;
            let worker = scope.spawn(move || {
                // Dropped when the work ends, however it ends.
                let _ended = ended;
                work(stop)
            });
            let mut raised = None;
            while end.recv_timeout(PATIENCE) == Err(RecvTimeoutError::Timeout) {
                if raised.is_none() {
                    raised = Python::attach(|py| py.check_signals().and_then(|()| tick(py))).err();
                    stop.store(raised.is_some(), Ordering::SeqCst);
                }
            }
            let result = worker.join().unwrap_or_else(|panic| resume_unwind(panic));
            raised.map_or(Ok(result), Err)
        })
    })
}
