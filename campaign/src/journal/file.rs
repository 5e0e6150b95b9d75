//! The journal on disk.

use std::fs::{File, OpenOptions};
use std::io::{Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::{JournalTrial, Replay, StudyRecord, TrialState};
use crate::strategy::LawChange;
use crate::{Conclusion, StopBelow};
use tribo_model::FileError;

/// What tells the time for the time stamps of the journal: RFC 3339 with microseconds and offset.
pub type Clock = fn() -> String;

/// An open journal, held exclusively until dropped.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    clock: Clock,
    study: StudyRecord,
}

/// Name of the writer in the records; a campaign has one.
const WORKER: &str = "tribo";

impl Journal {
    /// Creates a journal with an empty study. An existing file is an error.
    pub fn create(path: &Path, clock: Clock) -> Result<Self, FileError> {
        let file =
            OpenOptions::new().read(true).append(true).create_new(true).open(path).map_err(FileError::io(path))?;
        let mut journal = Self { path: path.to_owned(), file, clock, study: StudyRecord::default() };
        journal.lock()?;
        journal.append(&[study()])?;
        Ok(journal)
    }

    /// Takes hold of the journal of a campaign that is about to begin, empty until [`Self::begin`]. Of several who try at once one
    /// gets it; a file left empty by somebody who was killed here is taken over. `wait` for whoever holds it, or be refused at once.
    ///
    /// # Errors
    /// Somebody else holds it; it has content.
    pub(crate) fn claim(path: &Path, clock: Clock, wait: bool) -> Result<Self, FileError> {
        let file = OpenOptions::new().read(true).append(true).create(true).open(path).map_err(FileError::io(path))?;
        let mut journal = Self { path: path.to_owned(), file, clock, study: StudyRecord::default() };
        if wait {
            journal.file.lock().map_err(FileError::io(path))?;
        } else {
            journal.lock()?;
        }
        if journal.file.metadata().map_err(FileError::io(path))?.len() > 0 {
            let message = "has content already: a campaign has begun here".to_owned();
            return Err(FileError::Campaign { path: path.to_owned(), message });
        }
        Ok(journal)
    }

    /// Writes the first lines of a journal that was claimed: its study, and the settings of its campaign.
    pub(crate) fn begin(&mut self, settings: &Value) -> Result<(), FileError> {
        self.append(&[study(), study_attribute(StudyRecord::SETTINGS, settings)])?;
        self.study.settings = Some(settings.clone());
        Ok(())
    }

    /// Its file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What it says of the campaign as a whole.
    pub fn study(&self) -> &StudyRecord {
        &self.study
    }

    /// Records settings of a campaign whose journal has none: an earlier version began it, or it was killed in its first moment.
    pub(crate) fn adopt_settings(&mut self, settings: &Value) -> Result<(), FileError> {
        self.append(&[study_attribute(StudyRecord::SETTINGS, settings)])?;
        self.study.settings = Some(settings.clone());
        Ok(())
    }

    /// Records how many trials the campaign is to have from now on.
    pub(crate) fn set_trials(&mut self, trials: usize) -> Result<(), FileError> {
        self.append(&[study_attribute(StudyRecord::TRIALS, &json!(trials))])?;
        self.study.trials = Some(trials);
        Ok(())
    }

    /// Records when the campaign ends before its last trial, from now on.
    pub(crate) fn set_stop_below(&mut self, stop_below: StopBelow) -> Result<(), FileError> {
        self.append(&[study_attribute(StudyRecord::STOP_BELOW, &json!(stop_below))])?;
        self.study.stop_below = Some(stop_below);
        Ok(())
    }

    /// Records the friction law that the campaign goes over to.
    pub(crate) fn set_law(&mut self, change: &LawChange) -> Result<(), FileError> {
        self.append(&[study_attribute(StudyRecord::LAW, &json!(change))])?;
        self.study.law_change = Some(*change);
        Ok(())
    }

    /// Records what the trials amount to, unless it stands there.
    pub(crate) fn conclude(&mut self, conclusion: &Conclusion) -> Result<(), FileError> {
        if self.study.conclusion.as_ref() != Some(conclusion) {
            self.append(&[study_attribute(StudyRecord::CONCLUSION, &json!(conclusion))])?;
            self.study.conclusion = Some(conclusion.clone());
        }
        Ok(())
    }

    /// Takes back a trial that has ended. What stands in the journal stays: an attribute of the study says that it counts no more, as
    /// Optuna knows no change of a trial that has ended.
    pub(crate) fn withdraw(&mut self, trial: usize, reason: &str) -> Result<(), FileError> {
        let what = json!({"reason": reason, "datetime": (self.clock)()});
        self.append(&[study_attribute(&format!("{}{trial}", StudyRecord::WITHDRAWN), &what)])?;
        self.study.conclusion = None;
        Ok(())
    }

    /// Opens a journal, cuts off a torn last line, and replays the rest; an error if another process holds it.
    pub fn open(path: &Path, clock: Clock) -> Result<(Self, Vec<JournalTrial>), FileError> {
        let mut journal = Self::unlocked(path, clock)?;
        journal.lock()?;
        journal.replayed()
    }

    /// The same, as soon as no other process holds it.
    pub fn open_when_free(path: &Path, clock: Clock) -> Result<(Self, Vec<JournalTrial>), FileError> {
        let journal = Self::unlocked(path, clock)?;
        journal.file.lock().map_err(FileError::io(path))?;
        journal.replayed()
    }

    /// Keeps others from writing to the journal of a campaign until the file is dropped, if nobody does right now. Nothing is written.
    pub fn hold_if_idle(directory: &Path) -> Option<File> {
        let file = File::open(directory.join("journal.log")).ok()?;
        file.try_lock().ok()?;
        Some(file)
    }

    fn unlocked(path: &Path, clock: Clock) -> Result<Self, FileError> {
        let file = OpenOptions::new().read(true).append(true).open(path).map_err(FileError::io(path))?;
        Ok(Self { path: path.to_owned(), file, clock, study: StudyRecord::default() })
    }

    fn replayed(mut self) -> Result<(Self, Vec<JournalTrial>), FileError> {
        let bytes = std::fs::read(&self.path).map_err(FileError::io(&self.path))?;
        let whole = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |last| last + 1);
        // What is torn may end inside a letter; only whole lines have to be text.
        let mut replay = Replay::default();
        replay.extend(&self.path, &bytes[..whole])?;
        self.study = replay.study().clone();
        if whole < bytes.len() {
            self.cut(whole as u64).map_err(FileError::io(&self.path))?;
        }
        if whole == 0 {
            self.append(&[study()])?;
        }
        Ok((self, replay.into_trials()))
    }

    /// Shortens the file, and waits for the disk.
    fn cut(&mut self, length: u64) -> std::io::Result<()> {
        self.file.set_len(length)?;
        self.file.seek(SeekFrom::End(0))?;
        self.file.sync_all()
    }

    fn lock(&mut self) -> Result<(), FileError> {
        self.file.try_lock().map_err(|error| match error {
            std::fs::TryLockError::WouldBlock => FileError::Campaign {
                path: self.path.clone(),
                message: "another process is running this campaign; wait for it or stop it".to_owned(),
            },
            std::fs::TryLockError::Error(source) => FileError::Io { path: self.path.clone(), source },
        })
    }

    /// Creates the next trial, in state running.
    pub fn create_trial(&mut self) -> Result<(), FileError> {
        let now = (self.clock)();
        self.append(&[json!({"op_code": 4, "worker_id": WORKER, "study_id": 0, "datetime_start": now})])
    }

    /// Records parameters (name, value, lower, upper) of a running trial.
    pub fn set_params<'a>(
        &mut self,
        trial: usize,
        params: impl Iterator<Item = (&'a str, f64, f64, f64)>,
    ) -> Result<(), FileError> {
        let records: Vec<Value> = params
            .map(|(name, value, low, high)| {
                let distribution = json!({
                    "name": "FloatDistribution",
                    "attributes": {"step": null, "low": low, "high": high, "log": false},
                });
                json!({
                    "op_code": 5, "worker_id": WORKER, "trial_id": trial, "param_name": name,
                    "param_value_internal": value, "distribution": distribution.to_string(),
                })
            })
            .collect();
        self.append(&records)
    }

    /// Records a user attribute of a running trial.
    pub fn set_attribute(&mut self, trial: usize, key: &str, value: &Value) -> Result<(), FileError> {
        self.append(&[attribute(trial, key, value)])
    }

    /// Records user attributes of a running trial, then ends it. The end is what makes the trial count.
    pub fn finish(
        &mut self,
        trial: usize,
        attributes: &[(&str, Value)],
        state: TrialState,
        value: Option<f64>,
    ) -> Result<(), FileError> {
        let mut records: Vec<Value> = attributes.iter().map(|(key, value)| attribute(trial, key, value)).collect();
        records.push(json!({
            "op_code": 6, "worker_id": WORKER, "trial_id": trial, "state": state.code(),
            "values": value.map(|value| [value]), "datetime_complete": (self.clock)(),
        }));
        self.append(&records)
    }

    /// Appends whole lines with one write, then waits for the disk.
    fn append(&mut self, records: &[Value]) -> Result<(), FileError> {
        let mut text = String::new();
        for record in records {
            text.push_str(&record.to_string());
            text.push('\n');
        }
        self.file.write_all(text.as_bytes()).map_err(FileError::io(&self.path))?;
        self.file.sync_data().map_err(FileError::io(&self.path))
    }
}

fn study() -> Value {
    json!({"op_code": 0, "worker_id": WORKER, "study_name": "tribo", "directions": [1]})
}

fn study_attribute(key: &str, value: &Value) -> Value {
    json!({"op_code": 2, "worker_id": WORKER, "study_id": 0, "user_attr": {key: value}})
}

fn attribute(trial: usize, key: &str, value: &Value) -> Value {
    json!({"op_code": 8, "worker_id": WORKER, "trial_id": trial, "user_attr": {key: value}})
}

#[cfg(test)]
mod tests {
    use super::*;

    fn clock() -> String {
        "2026-01-01T00:00:00.000000+00:00".to_owned()
    }

    fn written(path: &Path) {
        let mut journal = Journal::create(path, clock).unwrap();
        for trial in 0..2 {
            journal.create_trial().unwrap();
            journal.set_params(trial, [("x", 0.1 + 0.2, 0.0, 1.0)].into_iter()).unwrap();
            journal
                .finish(trial, &[("reported", json!("Kabel geöffnet"))], TrialState::Complete, Some(1.0 / 3.0))
                .unwrap();
        }
    }

    #[test]
    fn numbers_come_back_to_the_last_bit() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("journal.log");
        written(&path);
        let (_journal, trials) = Journal::open(&path, clock).unwrap();
        assert_eq!((trials[1].params["x"], trials[1].value), (0.1 + 0.2, Some(1.0 / 3.0)));
    }

    /// Whatever the byte at which a write was torn, also inside a letter of two bytes, opening repairs the file and keeps every ended trial.
    #[test]
    fn a_torn_end_is_repaired_at_every_byte() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("journal.log");
        written(&path);
        let bytes = std::fs::read(&path).unwrap();
        for cut in 0..bytes.len() {
            std::fs::write(&path, &bytes[..cut]).unwrap();
            let whole_lines = bytes[..cut].split_inclusive(|byte| *byte == b'\n').filter(|line| line.ends_with(b"\n"));
            let ended = whole_lines.filter(|line| line.starts_with(b"{\"op_code\":6")).count();
            let (mut journal, trials) = Journal::open(&path, clock).unwrap();
            assert_eq!(trials.iter().filter(|trial| trial.state.is_finished()).count(), ended);
            journal.create_trial().unwrap();
            drop(journal);
            Journal::open(&path, clock).unwrap();
        }
    }

    #[test]
    fn two_processes_cannot_write_one_journal() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("journal.log");
        let _first = Journal::create(&path, clock).unwrap();
        let message = Journal::open(&path, clock).unwrap_err().to_string();
        assert!(message.contains("another process"), "{message}");
    }
}
