//! A recording that never makes the listener wait for the disk.

use std::path::Path;
use std::sync::mpsc::{Sender, channel};
use std::thread::JoinHandle;

use tribo_files::LogError;
use tribo_logs::{JointState, JointStateRecorder};

/// Joint states on their way to a file.
pub(crate) struct Recording {
    messages: Sender<(JointState, u64)>,
    writer: JoinHandle<Result<(), LogError>>,
    last_ns: u64,
}

impl Recording {
    /// Begins a file; an error where none can be made.
    pub fn begin(path: &Path, topic: &str) -> Result<Self, LogError> {
        let mut recorder = JointStateRecorder::create(path, topic)?;
        let (messages, incoming) = channel::<(JointState, u64)>();
        let writer = std::thread::spawn(move || {
            for (state, arrived_ns) in incoming {
                recorder.push(&state, arrived_ns)?;
            }
            recorder.finish()
        });
        Ok(Self { messages, writer, last_ns: 0 })
    }

    /// Keeps a message that arrived at this time since 1970 (ns), unless its stamp is not later than the one before: a log has one clock.
    /// Whether the file can still be written.
    pub fn push(&mut self, state: JointState, arrived_ns: u64) -> bool {
        if state.stamp_ns <= self.last_ns {
            return true;
        }
        self.last_ns = state.stamp_ns;
        self.messages.send((state, arrived_ns)).is_ok()
    }

    /// Ends the file; the first error that there was.
    pub fn finish(self) -> Result<(), LogError> {
        drop(self.messages);
        self.writer.join().unwrap_or(Ok(()))
    }
}
