//! The campaign's journal, in Optuna's journal-file format.
//!
//! One JSON object per line; op_code 0 creates the study, 4 a trial, 5 sets a parameter, 8 a user attribute, 6 ends a
//! trial. The file is only ever appended to, and every record is on the disk before it counts: a killed campaign loses
//! nothing that was finished, and a torn last line is cut off when the journal is opened. `optuna-dashboard` opens it.

mod file;
mod replay;
mod tail;
mod trial_record;

pub use file::{Clock, Journal};
pub use replay::{JournalTrial, Replay, TrialState, replay};
pub use tail::{JournalTail, News};
pub(crate) use trial_record::{REPORTED, attributes, finished_trial, reported};
