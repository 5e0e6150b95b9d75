//! Logs in MCAP: the writer.
//!
//! ```text
//! topic /robot, JSON messages with a JSON schema:  {"time":0.001,"q":[…],"dq":[…],"tau_J":[…],…,"O_F_ext":[fx,fy,fz,mx,my,mz]}
//! log_time = round(1e9 (time − min(first, 0))) ns, strictly increasing
//! ```
//!
//! JSON rather than ROS messages, because PlotJuggler and Foxglove open it as it is (`/robot/q[0]`), no ROS message has
//! `tau_J_d`, `theta` or temperatures, and numbers are written in the shortest form that reads back to the same bits.
//! Arrays are named like the canonical columns without index. Chunks are packed by zstd.
//! Leaves out: ROS 2 messages. `ros2 bag play` does not play JSON.

use std::collections::BTreeMap;
use std::io::Write;
use std::ops::Range;
use std::path::Path;

use mcap::records::MessageHeader;
use mcap::{McapError, McapResult, WriteOptions, Writer};
use tribo_files::{LogError, Output, failed};

use crate::quantity::Quantity;

const TOPIC: &str = "/robot";
const SCHEMA_NAME: &str = "tribo.Log";

/// A field of the messages: a quantity, and where its columns stand among the canonical ones.
type Field = (Quantity, Range<usize>);

/// An MCAP file being written.
pub(crate) struct McapWriter<'o> {
    writer: Writer<&'o mut dyn Output>,
    channel_id: u16,
    fields: Vec<Field>,
    /// What is added to time so that no stamp is negative (s).
    shift_s: Option<f64>,
    previous_ns: Option<u64>,
    sequence: u32,
    text: Vec<u8>,
}

impl<'o> McapWriter<'o> {
    /// Begins a file with columns of these names, in canonical order, time first.
    pub fn new(out: &'o mut dyn Output, path: &Path, names: &[String]) -> Result<Self, LogError> {
        let mut fields: Vec<Field> = Vec::new();
        for (place, (quantity, _)) in names.iter().filter_map(|name| Quantity::from_column_name(name)).enumerate() {
            match fields.last_mut() {
                Some((last, columns)) if *last == quantity => columns.end = place + 1,
                _ => fields.push((quantity, place..place + 1)),
            }
        }
        let begin = || {
            // One thread packs: the same log gives the same bytes.
            let mut writer = WriteOptions::new().compression_threads(0).library("tribo").create(out)?;
            let schema = writer.add_schema(SCHEMA_NAME, "jsonschema", schema(&fields).as_bytes())?;
            let channel_id = writer.add_channel(schema, TOPIC, "json", &BTreeMap::new())?;
            Ok((writer, channel_id))
        };
        let (writer, channel_id) = begin().map_err(|error| told(path, error))?;
        Ok(Self { writer, channel_id, fields, shift_s: None, previous_ns: None, sequence: 0, text: Vec::new() })
    }

    /// Appends rows, given by columns of one length.
    pub fn write(&mut self, columns: &[&[f64]], path: &Path) -> Result<(), LogError> {
        self.write_rows(columns).map_err(|error| told(path, error))
    }

    fn write_rows(&mut self, columns: &[&[f64]]) -> McapResult<()> {
        for (row, &time_s) in columns.first().copied().unwrap_or_default().iter().enumerate() {
            self.text.clear();
            message(&mut self.text, &self.fields, columns, row)?;
            let shift_s = *self.shift_s.get_or_insert(-time_s.min(0.0));
            let rounded_ns = ((time_s + shift_s) * 1e9).round() as u64;
            let log_time = self.previous_ns.map_or(rounded_ns, |previous| rounded_ns.max(previous.saturating_add(1)));
            self.previous_ns = Some(log_time);
            let (channel_id, sequence) = (self.channel_id, self.sequence);
            self.sequence = sequence.wrapping_add(1);
            let header = MessageHeader { channel_id, sequence, log_time, publish_time: log_time };
            self.writer.write_to_known_channel(&header, &self.text)?;
        }
        Ok(())
    }

    /// Ends the file with its index.
    pub fn finish(mut self, path: &Path) -> Result<(), LogError> {
        self.writer.finish().map(|_| ()).map_err(|error| told(path, error))
    }
}

/// JSON schema of the messages.
fn schema(fields: &[Field]) -> String {
    let property = |(quantity, columns): &Field| {
        let kind = if is_scalar(*quantity) {
            r#"{"type":"number"}"#.to_owned()
        } else {
            format!(r#"{{"type":"array","items":{{"type":"number"}},"minItems":{0},"maxItems":{0}}}"#, columns.len())
        };
        format!(r#""{}":{kind}"#, quantity.label())
    };
    let properties: Vec<String> = fields.iter().map(property).collect();
    format!(r#"{{"title":"{SCHEMA_NAME}","type":"object","properties":{{{}}}}}"#, properties.join(","))
}

/// One row. `{:?}` of a finite number is JSON.
fn message(text: &mut Vec<u8>, fields: &[Field], columns: &[&[f64]], row: usize) -> std::io::Result<()> {
    for (place, (quantity, range)) in fields.iter().enumerate() {
        let scalar = is_scalar(*quantity);
        write!(
            text,
            "{}\"{}\":{}",
            if place == 0 { '{' } else { ',' },
            quantity.label(),
            if scalar { "" } else { "[" }
        )?;
        for (index, column) in columns[range.clone()].iter().enumerate() {
            write!(text, "{}{:?}", if index == 0 { "" } else { "," }, column[row])?;
        }
        text.extend_from_slice(if scalar { b"" } else { b"]" });
    }
    text.push(b'}');
    Ok(())
}

fn is_scalar(quantity: Quantity) -> bool {
    quantity.column_count(2) == 1
}

/// The error of a writer of MCAP.
pub(crate) fn told(path: &Path, error: McapError) -> LogError {
    match error {
        McapError::Io(source) => failed(path, "write", source),
        other => LogError::Corrupt { path: path.to_path_buf(), detail: other.to_string() },
    }
}
