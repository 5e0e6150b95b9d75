//! Tuned compensators (`schema: tribo.tuned/1`).

use tribo_export::{Format, export};
use tribo_model::{TunedFile, to_yaml};

use super::document::{document, names_the_input, written};

/// A tuned compensator is refused with its field, or is the same after it was written and read.
pub fn check(input: &[u8]) {
    let Some(document) = document(input) else { return };
    match TunedFile::parse(&document) {
        Ok(tuned) => {
            let text = to_yaml(&tuned).expect("tuned parameters can be written");
            assert_eq!(TunedFile::parse(&written(&text)).expect("and are read"), tuned, "{text}");
            // A format may be unable to say it; it says so.
            let _ = export(&tuned, Format::C, None);
        }
        Err(error) => names_the_input(&error),
    }
}
