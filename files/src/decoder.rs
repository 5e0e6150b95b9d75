//! Decoders of other people that may panic on damaged files.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;

thread_local! {
    /// Whether a panic on this thread is an answer of a decoder, and no defect to be told.
    static DECODING: Cell<bool> = const { Cell::new(false) };
}

/// What `decode` returns; `None` where it panicked, of which nobody hears.
///
/// The process has one place that tells of panics, so the first call puts a word before it: panics of a thread that decodes are
/// left out, all others go on to whoever was there. `decode` must leave nothing half changed behind.
pub fn guarded<T>(decode: impl FnOnce() -> T) -> Option<T> {
    static QUIET: Once = Once::new();
    QUIET.call_once(|| {
        let tell = take_hook();
        set_hook(Box::new(move |panic| {
            if !DECODING.get() {
                tell(panic);
            }
        }));
    });
    let before = DECODING.replace(true);
    let decoded = catch_unwind(AssertUnwindSafe(decode));
    DECODING.set(before);
    decoded.ok()
}
