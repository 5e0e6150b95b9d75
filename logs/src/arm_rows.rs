//! Messages about the joints of an arm as rows, whatever container they lie in: which topic says most, who is which joint, which clock runs.
//!
//! ```text
//! topics  --which can be read, which says most-->  one topic  --messages-->  rows, joints in order, one clock
//! ```
//!
//! Time is that of the first of three clocks that increases from row to row: `time` of the message (the robot's own), `header.stamp`, the
//! recorder's stamp; the last two count from the first message.

use std::collections::BTreeMap;
use std::path::Path;

use tribo_files::{LogError, visible};

use crate::joint_order::arm_joints;
use crate::log::{LogColumns, RobotLog};
use crate::message_source::{Sample, Source};
use crate::quantity::{MAX_JOINTS, Quantity};

/// What is wanted of a bag.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Wanted<'w> {
    /// The topic; `None` is the one that says most.
    pub topic: Option<&'w str>,
    /// Names of the arm's joints, base to tool, where they are known.
    pub joints: &'w [String],
}

/// A channel, and what its first useful message says.
pub(crate) struct Candidate {
    pub topic: String,
    pub kind: String,
    pub source: Result<Source, String>,
    messages: u64,
    pub arm: Result<Arm, String>,
}

impl Candidate {
    /// A topic under its name, and how its messages are read.
    pub fn new(topic: &str, kind: &str, source: Result<Source, String>) -> Self {
        let arm = Err(source.as_ref().err().cloned().unwrap_or_default());
        Self { topic: visible(topic), kind: visible(kind), source, messages: 0, arm }
    }

    /// Looks at a message unless one before told enough.
    pub fn look_at(&mut self, message: &[u8], wanted: Wanted) {
        self.messages += 1;
        if let (Ok(source), Err(_)) = (&self.source, &self.arm)
            && self.messages <= LOOKED_AT
        {
            self.arm = source.sample(message).and_then(|sample| Arm::of(&sample, wanted.joints));
        }
    }

    /// Whether a message of it was seen.
    pub fn has_messages(&self) -> bool {
        self.messages > 0
    }

    fn refusal(self) -> String {
        format!("{} ({}): {}", self.topic, self.kind, self.arm.err().unwrap_or_default())
    }
}

/// Messages of a channel in which the arm is looked for: other publishers on the same topic come in turns.
const LOOKED_AT: u64 = 100;

/// The topic that is read.
pub(crate) struct Chosen {
    pub id: u64,
    pub topic: String,
    kind: String,
    pub source: Source,
    pub arm: Arm,
    /// What could also be read.
    others: Vec<String>,
}

impl Chosen {
    /// Takes the topic that is wanted, or the one with most quantities, then most messages.
    pub fn of(mut topics: BTreeMap<u64, Candidate>, wanted: Wanted, path: &Path) -> Result<Self, LogError> {
        if let Some(name) = wanted.topic {
            let names: Vec<String> = topics.values().map(|candidate| candidate.topic.clone()).collect();
            topics.retain(|_, candidate| candidate.topic == name);
            if topics.is_empty() {
                let detail = format!("no messages on topic {}; topics: {}", visible(name), names.join(", "));
                return Err(LogError::NotRead { path: path.to_path_buf(), detail });
            }
        }
        let readable = |(id, candidate): (&u64, &Candidate)| {
            let arm = candidate.arm.as_ref().ok()?;
            Some((arm.quantities.len(), candidate.messages, std::cmp::Reverse(*id)))
        };
        let Some((_, _, std::cmp::Reverse(id))) = topics.iter().filter_map(readable).max() else {
            let topics = topics.into_values().map(Candidate::refusal).collect();
            return Err(LogError::NoReadableTopic { path: path.to_path_buf(), topics });
        };
        let others = topics.iter().filter(|(other, candidate)| **other != id && candidate.arm.is_ok());
        let others: Vec<String> = others.map(|(_, other)| format!("{} ({})", other.topic, other.kind)).collect();
        let Some(Candidate { topic, kind, source: Ok(source), arm: Ok(arm), .. }) = topics.remove(&id) else {
            let detail = "its channels change".to_owned();
            return Err(LogError::Corrupt { path: path.to_path_buf(), detail });
        };
        Ok(Self { id, topic, kind, source, arm, others })
    }

    /// Appends one of its messages to the rows.
    pub fn push(&self, rows: &mut Rows, message: &[u8], log_ns: u64, path: &Path) -> Result<(), LogError> {
        let number = rows.messages;
        let bad = |detail| LogError::BadMessage {
            path: path.to_path_buf(),
            topic: self.topic.clone(),
            message: number,
            detail,
        };
        let sample = self.source.sample(message).map_err(bad)?;
        rows.push(&self.arm, sample, log_ns).map_err(bad)
    }

    /// Where the rows come from, in words.
    pub fn described(&self, clock: &str) -> String {
        let others = &self.others;
        let also =
            if others.is_empty() { String::new() } else { format!("; could also be read: {}", others.join(", ")) };
        format!("topic {} ({}), {}, time from {clock}{also}", self.topic, self.kind, self.arm.described())
    }
}

/// The joints of a channel and the quantities it has for all of them.
pub(crate) struct Arm {
    /// In order; empty where messages name no joints.
    names: Vec<String>,
    joints: usize,
    /// Without time, in canonical order.
    quantities: Vec<Quantity>,
    pub warnings: Vec<String>,
}

impl Arm {
    /// What a first message says, or what it lacks.
    fn of(sample: &Sample, known: &[String]) -> Result<Self, String> {
        let all_known = !known.is_empty() && known.iter().all(|name| sample.names.contains(name));
        let names = if all_known { known.to_vec() } else { arm_joints(&sample.names) };
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
pub(crate) struct Rows {
    /// Quantity by quantity, without time.
    pub columns: Vec<Vec<f64>>,
    time_s: Vec<Option<f64>>,
    stamp_ns: Vec<Option<u64>>,
    pub log_ns: Vec<u64>,
    messages: u64,
    pub incomplete: usize,
}

impl Rows {
    pub fn new(arm: &Arm) -> Self {
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
    pub fn finish(&self, arm: &Arm) -> Result<(RobotLog, usize, &'static str), LogError> {
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
