//! A log that grows while a robot moves: joint states in MCAP, as rosbag2 keeps them.

use std::collections::BTreeMap;
use std::io::BufWriter;
use std::path::Path;

use mcap::records::MessageHeader;
use mcap::{McapResult, WriteOptions, Writer};
use tempfile::NamedTempFile;
use tribo_files::{AtomicFile, LogError, failed};

use crate::joint_state::{JOINT_STATE, JOINT_STATE_FIELDS, JointState};
use crate::mcap_write::told;

/// Writes joint states as they come. The file appears whole, when it is finished.
///
/// ```text
/// one topic, sensor_msgs/msg/JointState in CDR with its definition;  log_time = when it arrived, publish_time = header.stamp (ns)
/// ```
///
/// [`read_log`](crate::read_log) and `ros2 bag play` read it. One that is dropped leaves nothing.
pub struct JointStateRecorder {
    writer: Writer<BufWriter<NamedTempFile>>,
    file: AtomicFile,
    channel_id: u16,
    sequence: u32,
}

impl JointStateRecorder {
    /// Begins a recording of this topic.
    ///
    /// # Errors
    /// A place where no file can be made.
    pub fn create(path: impl AsRef<Path>, topic: &str) -> Result<Self, LogError> {
        let (file, temporary) = AtomicFile::begin(path.as_ref())?;
        let begin = || {
            let options = WriteOptions::new().compression_threads(0).library("tribo").profile("ros2");
            let mut writer = options.create(BufWriter::new(temporary))?;
            let schema = writer.add_schema(JOINT_STATE, "ros2msg", JOINT_STATE_FIELDS.as_bytes())?;
            let channel_id = writer.add_channel(schema, topic, "cdr", &BTreeMap::new())?;
            McapResult::Ok((writer, channel_id))
        };
        let (writer, channel_id) = begin().map_err(|error| told(file.target(), error))?;
        Ok(Self { writer, file, channel_id, sequence: 0 })
    }

    /// Appends a message that arrived at this time since 1970 (ns).
    ///
    /// # Errors
    /// Those of the disk.
    pub fn push(&mut self, state: &JointState, arrived_ns: u64) -> Result<(), LogError> {
        let (channel_id, sequence) = (self.channel_id, self.sequence);
        self.sequence = sequence.wrapping_add(1);
        let header = MessageHeader { channel_id, sequence, log_time: arrived_ns, publish_time: state.stamp_ns };
        let written = self.writer.write_to_known_channel(&header, &state.to_cdr());
        written.map_err(|error| told(self.file.target(), error))
    }

    /// Ends the file, which is there from now on.
    ///
    /// # Errors
    /// Those of the disk.
    pub fn finish(mut self) -> Result<(), LogError> {
        let ended = self.writer.finish().map(|_| ());
        ended.map_err(|error| told(self.file.target(), error))?;
        let temporary = self.writer.into_inner().into_inner();
        let temporary = temporary.map_err(|error| failed(self.file.target(), "write", error.into_error()))?;
        self.file.commit(temporary)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{RobotLog, read_log};

    fn recorded(path: &Path, rows: u64) -> RobotLog {
        let mut recorder = JointStateRecorder::create(path, "/joint_states").unwrap();
        assert!(!path.exists());
        for k in 0..rows {
            let (t, at) = (k as f64 * 1e-3, |x: f64| vec![x, x + 1.0]);
            let names = vec!["joint2".into(), "joint1".into()];
            let (position, velocity, effort) = (at(t.sin()), at(t.cos()), at(t / 3.0));
            let stamp_ns = 1_700_000_000_000_000_000 + k * 1_000_000;
            recorder.push(&JointState { stamp_ns, names, position, velocity, effort }, stamp_ns + 77).unwrap();
        }
        recorder.finish().unwrap();
        read_log(path).unwrap().0
    }

    /// The reader of logs sorts the joints and takes the time from the stamps.
    #[test]
    fn a_recording_is_a_log_to_the_bit() {
        let directory = tempfile::tempdir().unwrap();
        let log = recorded(&directory.path().join("a.mcap"), 100);
        assert_eq!((log.rows(), log.joints(), log.time_s[99]), (100, 2, 99.0 / 1e3));
        let t = 50.0 * 1e-3_f64;
        assert_eq!((log.q_rad[1][50], log.q_rad[0][50], log.tau_j_nm[1][50]), (t.sin(), t.sin() + 1.0, t / 3.0));
    }

    #[test]
    fn what_is_not_finished_leaves_nothing() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("b.mcap");
        drop(JointStateRecorder::create(&path, "/x").unwrap());
        assert_eq!(std::fs::read_dir(directory.path()).unwrap().count(), 0);
        assert!(JointStateRecorder::create(directory.path().join("no/c.mcap"), "/x").is_err());
        assert!(JointStateRecorder::create(directory.path(), "/x").is_err());
    }
}
