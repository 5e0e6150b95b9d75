//! Long work that Ctrl-C ends.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

/// How often Python is asked whether somebody pressed Ctrl-C.
const ASKED_EVERY: Duration = Duration::from_millis(50);

/// Runs `work` in a thread of its own, without Python's lock. `work` is told by the flag that somebody pressed Ctrl-C, and is waited for:
/// the exception comes when it has ended, whatever it gives.
///
/// # Errors
/// `KeyboardInterrupt`, or whatever else a signal handler raised.
pub(crate) fn interruptible<T: Send>(py: Python<'_>, work: impl FnOnce(&AtomicBool) -> T + Send) -> PyResult<T> {
    let stop = AtomicBool::new(false);
    py.detach(|| {
        std::thread::scope(|scope| {
            let (done, wait) = channel();
            let stopped = &stop;
            let running = scope.spawn(move || {
                let result = work(stopped);
                // Nobody waits where a signal has come.
                let _ = done.send(());
                result
            });
            let mut interrupted = None;
            while wait.recv_timeout(ASKED_EVERY) == Err(RecvTimeoutError::Timeout) {
                if interrupted.is_none()
                    && let Err(signal) = Python::attach(|py| py.check_signals())
                {
                    stop.store(true, Ordering::Relaxed);
                    interrupted = Some(signal);
                }
            }
            let result = running.join().map_err(|_| PyRuntimeError::new_err("a thread of tribo panicked"))?;
            interrupted.map_or(Ok(result), Err)
        })
    })
}
