//! Logs in MCAP, the container of rosbag2 and Foxglove: the reader.
//!
//! ```text
//! channels  --which can be read, which says most-->  one channel  --messages-->  rows, joints in order, one clock
//! ```
//!
//! `ros2msg` messages in CDR are read by the definition that the file carries, JSON messages by the names in them (see
//! `message_source`). Of several channels that can be read, the one with most quantities is taken, then the one with most
//! messages; [`LogSummary::source`] tells which, and what else could have been.
//! Time is that of the first of three clocks that increases from row to row: `time` of the message (the robot's own),
//! `header.stamp`, the recorder's stamp; the last two count from the first message. A row that repeats the one before
//! under the same stamp is dropped. Messages without all joints of the arm (a gripper publishes on the same topic) are
//! left out and counted. Chunks may be packed by zstd or lz4; their checksums are compared.
//! Leaves out: ROS 1 messages, protobuf, CDR by IDL, other attachments of the file.

use std::collections::BTreeMap;
use std::io::BufReader;
use std::path::Path;
use std::sync::Arc;

use mcap::io::MessageReader;
use mcap::sans_io::LinearReaderOptions;
use mcap::{Channel, McapError, Message};

use crate::decoder::guarded;
use crate::error::{LogError, visible};
use crate::format::LogFormat;
use crate::joint_order::arm_joints;
use crate::log::{LogColumns, RobotLog};
use crate::message_source::{Sample, Source};
use crate::quantity::{MAX_JOINTS, Quantity};
use crate::source::{Counted, LogFile};
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

/// Reads the one channel of an MCAP file that says most about an arm.
///
/// # Errors
/// [`LogError::NoReadableTopic`] with the reason for each topic, [`LogError::BadMessage`] with topic, number and field,
/// [`LogError::Corrupt`] for a damaged or cut file, and those of opening it.
pub fn read_mcap(path: impl AsRef<Path>) -> Result<(RobotLog, LogSummary), LogError> {
    mcap(&LogFile::new(path.as_ref()))
}

/// Reads MCAP.
pub(crate) fn mcap(file: &LogFile) -> Result<(RobotLog, LogSummary), LogError> {
    // Whatever a damaged file makes the decoder do, it ends here; everything it touched is dropped with it.
    guarded(|| read_best_channel(file))
        .unwrap_or_else(|| Err(corrupt(file.path, "the MCAP decoder gave up on it".to_owned())))
}

fn read_best_channel(file: &LogFile) -> Result<(RobotLog, LogSummary), LogError> {
    let path = file.path;
    file.stretch(0.0, 0.5);
    let mut channels = survey(file)?;
    file.stretch(0.5, 1.0);
    let readable = |(id, candidate): (&u16, &Candidate)| {
        let arm = candidate.arm.as_ref().ok()?;
        Some((arm.quantities.len(), candidate.messages, std::cmp::Reverse(*id)))
    };
    let Some((_, _, std::cmp::Reverse(best))) = channels.iter().filter_map(readable).max() else {
        let topics = channels.into_values().map(Candidate::refusal).collect();
        return Err(LogError::NoReadableTopic { path: path.to_path_buf(), topics });
    };
    let others = channels.iter().filter(|(id, other)| **id != best && other.arm.is_ok());
    let others: Vec<String> = others.map(|(_, other)| format!("{} ({})", other.topic, other.kind)).collect();
    let Some(Candidate { topic, kind, source: Ok(source), arm: Ok(arm), .. }) = channels.remove(&best) else {
        return Err(corrupt(path, "its channels change".to_owned()));
    };

    // The rows of that channel.
    let mut rows = Rows::new(&arm);
    let length = usize::try_from(length_of(file)?).unwrap_or(usize::MAX);
    let most_cells = length.saturating_mul(CELLS_PER_BYTE).max(LEAST_CELLS);
    for message in messages(file)? {
        let message = message.map_err(|error| corrupt(path, told(&error)))?;
        if message.channel.id == best {
            let bad = |detail| LogError::BadMessage {
                path: path.to_path_buf(),
                topic: topic.clone(),
                message: rows.messages,
                detail,
            };
            let sample = source.sample(&message.data).map_err(bad)?;
            if rows.log_ns.len() >= most_cells / rows.columns.len().max(1) {
                return Err(corrupt(path, format!("unpacks to more than {most_cells} cells from {length} bytes")));
            }
            rows.push(&arm, sample, message.log_time).map_err(|detail| LogError::BadMessage {
                path: path.to_path_buf(),
                topic: topic.clone(),
                message: rows.messages - 1,
                detail,
            })?;
        }
    }
    let (log, dropped_repeats, clock) = rows.finish(&arm).map_err(|error| error.in_file(path))?;
    let mut summary = LogSummary::new(LogFormat::Mcap, &log, dropped_repeats, Vec::new());
    summary.dropped_incomplete = rows.incomplete;
    let also = if others.is_empty() { String::new() } else { format!("; could also be read: {}", others.join(", ")) };
    summary.source = Some(format!("topic {topic} ({kind}), {}, time from {clock}{also}", arm.described()));
    summary.warnings.extend(arm.warnings);
    Ok((log, summary))
}

/// A channel, and what its first useful message says.
struct Candidate {
    topic: String,
    kind: String,
    source: Result<Source, String>,
    messages: u64,
    arm: Result<Arm, String>,
}

impl Candidate {
    fn new(channel: &Arc<Channel>) -> Self {
        let kind = channel.schema.as_ref().map_or(&channel.message_encoding, |schema| &schema.name).clone();
        let source = Source::of(channel);
        let arm = Err(source.as_ref().err().cloned().unwrap_or_default());
        Self { topic: visible(&channel.topic), kind: visible(&kind), source, messages: 0, arm }
    }

    /// Looks at a message unless one before told enough.
    fn look_at(&mut self, message: &Message) {
        self.messages += 1;
        if let (Ok(source), Err(_)) = (&self.source, &self.arm)
            && self.messages <= LOOKED_AT
        {
            self.arm = source.sample(&message.data).and_then(|sample| Arm::of(&sample));
        }
    }

    fn refusal(self) -> String {
        format!("{} ({}): {}", self.topic, self.kind, self.arm.err().unwrap_or_default())
    }
}

/// Messages of a channel in which the arm is looked for: other publishers on the same topic come in turns.
const LOOKED_AT: u64 = 100;

/// Every channel that has messages.
fn survey(file: &LogFile) -> Result<BTreeMap<u16, Candidate>, LogError> {
    let mut channels = BTreeMap::new();
    for message in messages(file)? {
        let message = message.map_err(|error| corrupt(file.path, told(&error)))?;
        channels.entry(message.channel.id).or_insert_with(|| Candidate::new(&message.channel)).look_at(&message);
    }
    Ok(channels)
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

/// The joints of a channel and the quantities it has for all of them.
struct Arm {
    /// In order; empty where messages name no joints.
    names: Vec<String>,
    joints: usize,
    /// Without time, in canonical order.
    quantities: Vec<Quantity>,
    warnings: Vec<String>,
}

impl Arm {
    /// What a first message says, or what it lacks.
    fn of(sample: &Sample) -> Result<Self, String> {
        let names = arm_joints(&sample.names);
        if names.is_empty() && !sample.names.is_empty() {
            return Err(format!("has no joint of an arm ({})", visible(&sample.names.join(", "))));
        }
        let joints = if names.is_empty() { sample.of(Quantity::Position).len() } else { names.len() };
        if !(1..=MAX_JOINTS).contains(&joints) {
            return Err(format!("has {joints} joints; allowed: 1 to {MAX_JOINTS}"));
        }
        let mut arm = Self { names, joints, quantities: Vec::new(), warnings: Vec::new() };
        let entries = arm.entries(sample).ok_or("names a joint twice")?;
        for quantity in Quantity::ALL.into_iter().filter(|&quantity| quantity != Quantity::Time) {
            match (arm.row_of(quantity, sample, &entries), quantity.is_required()) {
                (Ok(_), _) => arm.quantities.push(quantity),
                (Err(detail), true) => return Err(detail),
                (Err(_), false) if sample.of(quantity).is_empty() => {}
                (Err(detail), false) => arm.warnings.push(format!("{quantity} left out: {detail}")),
            }
        }
        Ok(arm)
    }

    /// Which entry of a message is which joint; `None` if it lacks one.
    fn entries(&self, sample: &Sample) -> Option<Vec<usize>> {
        if self.names.is_empty() {
            return Some((0..self.joints).collect());
        }
        let place = |joint| sample.names.iter().position(|name| name == joint);
        self.names.iter().map(place).collect()
    }

    /// The values of a quantity in the order of the joints, all finite.
    fn row_of(&self, quantity: Quantity, sample: &Sample, entries: &[usize]) -> Result<Vec<f64>, String> {
        let values = sample.of(quantity);
        let named = quantity.is_per_joint() && !self.names.is_empty();
        let expected = if named { sample.names.len() } else { quantity.column_count(self.joints) };
        if values.len() != expected {
            return Err(format!("{quantity}: {} entries, expected {expected}", values.len()));
        }
        let row: Vec<f64> = if named { entries.iter().map(|&entry| values[entry]).collect() } else { values.to_vec() };
        match row.iter().position(|value| !value.is_finite()) {
            Some(index) => Err(format!("{}: {} is not finite", quantity.column_name(index), row[index])),
            None => Ok(row),
        }
    }

    fn described(&self) -> String {
        match (self.names.first(), self.names.last()) {
            (Some(first), Some(last)) => format!("joints {} to {}", visible(first), visible(last)),
            _ => format!("{} joints without names", self.joints),
        }
    }
}

/// Rows with all their clocks.
struct Rows {
    /// Quantity by quantity, without time.
    columns: Vec<Vec<f64>>,
    time_s: Vec<Option<f64>>,
    stamp_ns: Vec<Option<u64>>,
    log_ns: Vec<u64>,
    messages: u64,
    incomplete: usize,
}

impl Rows {
    fn new(arm: &Arm) -> Self {
        let count = arm.quantities.iter().map(|quantity| quantity.column_count(arm.joints)).sum();
        let columns = vec![Vec::new(); count];
        Self { columns, time_s: Vec::new(), stamp_ns: Vec::new(), log_ns: Vec::new(), messages: 0, incomplete: 0 }
    }

    /// Appends a message; the error tells what is wrong with it.
    fn push(&mut self, arm: &Arm, sample: Sample, log_ns: u64) -> Result<(), String> {
        self.messages += 1;
        let Some(entries) = arm.entries(&sample) else {
            self.incomplete += 1;
            return Ok(());
        };
        let mut row = Vec::with_capacity(self.columns.len());
        for &quantity in &arm.quantities {
            row.extend(arm.row_of(quantity, &sample, &entries)?);
        }
        self.columns.iter_mut().zip(row).for_each(|(column, value)| column.push(value));
        self.time_s.push(sample.time_s.filter(|time_s| time_s.is_finite()));
        self.stamp_ns.push(sample.stamp_ns);
        self.log_ns.push(log_ns);
        Ok(())
    }

    /// The log, how many rows were repeats, and the clock that its time comes from.
    fn finish(&self, arm: &Arm) -> Result<(RobotLog, usize, &'static str), LogError> {
        let clocks = [
            ("field `time`", self.time_s.iter().copied().collect::<Option<Vec<f64>>>()),
            ("header.stamp", self.stamp_ns.iter().copied().collect::<Option<Vec<u64>>>().map(|ns| from_first(&ns))),
            ("the recorder", Some(from_first(&self.log_ns))),
        ];
        let runs = |time_s: &[f64]| time_s.first() < time_s.last();
        let increases =
            |time_s: &[f64]| (1..time_s.len()).all(|k| time_s[k] > time_s[k - 1] || self.repeats(time_s, k));
        let present: Vec<(&str, Vec<f64>)> =
            clocks.into_iter().filter_map(|(name, clock)| Some((name, clock?))).collect();
        let usable = present.iter().find(|(_, time_s)| runs(time_s) && increases(time_s));
        let running = || present.iter().find(|(_, time_s)| runs(time_s)).or(present.last());
        let Some((clock, time_s)) = usable.or_else(running) else {
            return LogColumns::default().validate().map(|log| (log, 0, ""));
        };

        let kept: Vec<usize> = (0..time_s.len()).filter(|&k| !self.repeats(time_s, k)).collect();
        let pick = |column: &Vec<f64>| -> Vec<f64> { kept.iter().map(|&k| column[k]).collect() };
        let mut log = LogColumns { time_s: pick(time_s), ..LogColumns::default() };
        let mut columns = self.columns.iter();
        for &quantity in &arm.quantities {
            let count = quantity.column_count(arm.joints);
            log.set_quantity(quantity, columns.by_ref().take(count).map(pick).collect());
        }
        Ok((log.validate()?, time_s.len() - kept.len(), clock))
    }

    fn repeats(&self, time_s: &[f64], k: usize) -> bool {
        k > 0 && time_s[k] == time_s[k - 1] && self.columns.iter().all(|column| column[k] == column[k - 1])
    }
}

/// Seconds since the first stamp.
fn from_first(stamps_ns: &[u64]) -> Vec<f64> {
    let first = stamps_ns.first().copied().unwrap_or(0);
    let signed = |stamp: u64| if stamp >= first { (stamp - first) as f64 } else { -((first - stamp) as f64) };
    stamps_ns.iter().map(|&stamp| signed(stamp) / 1e9).collect()
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
