//! The campaign's journal, in Optuna's journal-file format.
//!
//! One JSON object per line; op_code 0 creates the study, 2 sets an attribute of it ([`StudyRecord`]), 4 creates a trial, 5 sets a
//! parameter, 8 a user attribute, 6 ends a trial. The file is only ever appended to, and every record is on the disk before it counts: a killed campaign loses
//! nothing that was finished, and a torn last line is cut off when the journal is opened. `optuna-dashboard` opens it.

mod file;
mod journal_trial;
mod replay;
mod study_record;
mod tail;
mod trial_record;

pub use file::{Clock, Journal};
pub use journal_trial::{JournalTrial, TrialState};
pub use replay::{Replay, replay};
pub use study_record::StudyRecord;
pub use tail::{JournalTail, News};
pub(crate) use trial_record::{Ended, finish, theta};
pub use trial_record::{finished_trial, reported, seal};
