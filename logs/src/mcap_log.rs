//! Logs in MCAP, the container of rosbag2 and Foxglove: the reader.
//!
//! ```text
//! channels  --which can be read, which says most-->  one channel  --messages-->  rows, joints in order, one clock
//! ```
//!
//! `ros2msg` messages in CDR are read by the definition that the file carries, JSON messages by the names in them (see
//! `message_source`). Of several channels that can be read, the one with most quantities is taken, then the one with most
//! messages; [`LogSummary::source`] tells which, and what else could have been.
//! The clock is chosen in `arm_rows`. A row that repeats the one before
//! under the same stamp is dropped. Messages without all joints of the arm (a gripper publishes on the same topic) are
//! left out and counted. Chunks may be packed by zstd or lz4; their checksums are compared.
//! Leaves out: ROS 1 messages, protobuf, CDR by IDL, other attachments of the file.

use std::collections::BTreeMap;
use std::io::BufReader;
use std::path::Path;

use mcap::io::MessageReader;
use mcap::sans_io::LinearReaderOptions;
use mcap::{Channel, McapError};
use tribo_files::{Counted, LogError, LogFile, guarded};

use crate::arm_rows::{Candidate, Chosen, Rows, Wanted};
use crate::format::LogFormat;
use crate::log::RobotLog;
use crate::message_source::Source;
use crate::summary::LogSummary;

/// First bytes of an MCAP file.
pub(crate) const MCAP_MAGIC: [u8; 5] = [0x89, b'M', b'C', b'A', b'P'];

/// The largest record believed, as a multiple of the file: no message packs better, and what a damaged length asks for stays
/// in proportion.
const RECORD_PER_FILE: u64 = 64;

/// The largest record believed in a small file (bytes).
const LEAST_RECORD_BYTES: u64 = 1 << 20;

/// The most cells believed per byte of a file: many chunks that unpack to the same message many times over are each small enough, and
/// together ask for more than the file justifies.
const CELLS_PER_BYTE: usize = 64;

/// The most cells believed of a small file.
const LEAST_CELLS: usize = 1 << 20;

/// Reads the one channel of an MCAP file that says most about an arm: [`LogError::NoReadableTopic`] with the reason for each topic,
/// [`LogError::BadMessage`] with topic, number and field, [`LogError::Corrupt`] for a damaged or cut file.
pub(crate) fn mcap(file: &LogFile, wanted: Wanted) -> Result<(RobotLog, LogSummary), LogError> {
    // Whatever a damaged file makes the decoder do, it ends here; everything it touched is dropped with it.
    guarded(|| read_best_channel(file, wanted))
        .unwrap_or_else(|| Err(corrupt(file.path, "the MCAP decoder gave up on it".to_owned())))
}

fn read_best_channel(file: &LogFile, wanted: Wanted) -> Result<(RobotLog, LogSummary), LogError> {
    let path = file.path;
    file.stretch(0.0, 0.5);
    let channels = survey(file, wanted)?;
    file.stretch(0.5, 1.0);
    let chosen = Chosen::of(channels, wanted, path)?;

    // The rows of that channel.
    let mut rows = Rows::new(&chosen.arm);
    let length = usize::try_from(length_of(file)?).unwrap_or(usize::MAX);
    let most_cells = length.saturating_mul(CELLS_PER_BYTE).max(LEAST_CELLS);
    for message in messages(file)? {
        let message = message.map_err(|error| corrupt(path, told(&error)))?;
        if u64::from(message.channel.id) == chosen.id {
            if rows.log_ns.len() >= most_cells / rows.columns.len().max(1) {
                return Err(corrupt(path, format!("unpacks to more than {most_cells} cells from {length} bytes")));
            }
            chosen.push(&mut rows, &message.data, message.log_time, path)?;
        }
    }
    let (log, dropped_repeats, clock) = rows.finish(&chosen.arm).map_err(|error| error.in_file(path))?;
    let mut summary = LogSummary::new(LogFormat::Mcap, &log, dropped_repeats, Vec::new());
    summary.dropped_incomplete = rows.incomplete;
    summary.source = Some(chosen.described(clock));
    summary.warnings.extend(chosen.arm.warnings);
    Ok((log, summary))
}

/// Every channel that has messages.
fn survey(file: &LogFile, wanted: Wanted) -> Result<BTreeMap<u64, Candidate>, LogError> {
    let mut channels = BTreeMap::new();
    for message in messages(file)? {
        let message = message.map_err(|error| corrupt(file.path, told(&error)))?;
        let id = u64::from(message.channel.id);
        channels.entry(id).or_insert_with(|| candidate(&message.channel)).look_at(&message.data, wanted);
    }
    Ok(channels)
}

fn candidate(channel: &Channel) -> Candidate {
    let schema = channel.schema.as_ref();
    let kind = schema.map_or(&channel.message_encoding, |schema| &schema.name);
    let definition = schema.map(|schema| (schema.name.as_str(), schema.encoding.as_str(), &schema.data[..]));
    Candidate::new(&channel.topic, kind, Source::of(&channel.message_encoding, definition))
}

fn length_of(file: &LogFile) -> Result<u64, LogError> {
    file.length().map_err(|source| LogError::io(file.path, "read", source))
}

/// The messages of a file from its start, records capped against the length of the file.
fn messages(file: &LogFile) -> Result<MessageReader<BufReader<Counted>>, LogError> {
    let raw = file.open_counted("MCAP")?;
    let length = length_of(file)?;
    let most = length.saturating_mul(RECORD_PER_FILE).max(LEAST_RECORD_BYTES);
    let options = LinearReaderOptions::default()
        .with_validate_chunk_crcs(true)
        .with_record_length_limit(usize::try_from(most).unwrap_or(usize::MAX));
    Ok(MessageReader::new_with_options(BufReader::new(raw), options))
}

/// The error and what caused it; the crate tells them apart.
fn told(error: &McapError) -> String {
    match std::error::Error::source(error) {
        Some(cause) => format!("{error}: {cause}"),
        None if matches!(error, McapError::UnexpectedEof) => format!("{error} (`mcap recover` keeps what is whole)"),
        None => error.to_string(),
    }
}

fn corrupt(path: &Path, detail: String) -> LogError {
    LogError::Corrupt { path: path.to_path_buf(), detail }
}
