//! Reading a journal while somebody else writes it.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use super::{JournalTrial, Replay, StudyRecord};
use tribo_model::FileError;

/// What a look at the journal brought.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum News {
    /// Nothing has been added.
    None,
    /// Lines have been added.
    Lines,
    /// The file has become shorter and was read from its beginning: its torn end was repaired, or it was replaced.
    Restarted,
}

/// Follows a journal without lock and without writing: whoever runs the campaign does not notice.
///
/// Only whole lines are read. What stands behind the last line break is either still being written or the torn end of a
/// campaign that was killed; it is left for later, and [`Self::torn_bytes`] counts it.
#[derive(Clone, Debug)]
pub struct JournalTail {
    path: PathBuf,
    /// Bytes of whole lines taken so far.
    taken: u64,
    torn: u64,
    replay: Replay,
}

impl JournalTail {
    /// A follower that has read nothing yet; the file need not exist.
    pub fn new(path: &Path) -> Self {
        Self { path: path.to_owned(), taken: 0, torn: 0, replay: Replay::default() }
    }

    /// Reads what has been added.
    pub fn poll(&mut self) -> Result<News, FileError> {
        let mut file = match File::open(&self.path) {
            Ok(file) => file,
            // Between `campaign.yaml` and the first line there is no journal yet.
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(News::None),
            Err(error) => return Err(FileError::io(&self.path)(error)),
        };
        let length = file.metadata().map_err(FileError::io(&self.path))?.len();
        let restarted = length < self.taken;
        if restarted {
            (self.taken, self.replay) = (0, Replay::default());
        }
        file.seek(SeekFrom::Start(self.taken)).map_err(FileError::io(&self.path))?;
        let mut added = Vec::new();
        file.read_to_end(&mut added).map_err(FileError::io(&self.path))?;
        let whole = added.iter().rposition(|byte| *byte == b'\n').map_or(0, |last| last + 1);
        self.torn = (added.len() - whole) as u64;
        if whole == 0 {
            return Ok(if restarted { News::Restarted } else { News::None });
        }
        self.replay.extend(&self.path, &added[..whole])?;
        self.taken += whole as u64;
        Ok(if restarted { News::Restarted } else { News::Lines })
    }

    /// The trials so far, by number.
    pub fn trials(&self) -> &[JournalTrial] {
        self.replay.trials()
    }

    /// What the lines so far say of the campaign as a whole.
    pub fn study(&self) -> &StudyRecord {
        self.replay.study()
    }

    /// Bytes behind the last whole line.
    pub fn torn_bytes(&self) -> u64 {
        self.torn
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::journal::{Journal, TrialState};
    use std::io::Write;

    fn clock() -> String {
        "2026-01-01T00:00:00.000000+00:00".to_owned()
    }

    fn journal(path: &Path, trials: usize) {
        let mut journal = Journal::create(path, clock).unwrap();
        for trial in 0..trials {
            journal.create_trial().unwrap();
            journal.set_params(trial, [("x", trial as f64, 0.0, 9.0)].into_iter()).unwrap();
            journal.finish(trial, &[], TrialState::Complete, Some(1.0)).unwrap();
        }
    }

    /// Byte by byte as a slow disk would show it: never an error, and in the end the same as at once.
    #[test]
    fn follows_a_file_that_grows_byte_by_byte() {
        let dir = tempfile::tempdir().unwrap();
        let (whole, growing) = (dir.path().join("whole.log"), dir.path().join("growing.log"));
        journal(&whole, 2);
        let bytes = std::fs::read(&whole).unwrap();
        let mut tail = JournalTail::new(&growing);
        assert_eq!(tail.poll().unwrap(), News::None);
        let mut file = File::create(&growing).unwrap();
        for (k, byte) in bytes.iter().enumerate() {
            file.write_all(&[*byte]).unwrap();
            let news = tail.poll().unwrap();
            assert_eq!(news == News::Lines, *byte == b'\n');
            let torn = bytes[..=k].iter().rev().take_while(|byte| **byte != b'\n').count();
            assert_eq!(tail.torn_bytes(), torn as u64);
        }
        assert_eq!(tail.trials(), crate::journal::replay(&whole, &bytes).unwrap());
    }

    /// A journal that is repaired or replaced is read anew.
    #[test]
    fn notices_a_shorter_file() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("journal.log");
        journal(&path, 3);
        let mut tail = JournalTail::new(&path);
        tail.poll().unwrap();
        assert_eq!(tail.trials().len(), 3);
        std::fs::remove_file(&path).unwrap();
        journal(&path, 1);
        assert_eq!(tail.poll().unwrap(), News::Restarted);
        assert_eq!(tail.trials().len(), 1);
        std::fs::write(&path, "no\n").unwrap();
        assert!(tail.poll().unwrap_err().to_string().contains("journal.log:1: corrupt journal"));
    }
}
