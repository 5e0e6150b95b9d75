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
use std::io::{Seek, Write};
use std::path::Path;

use mcap::records::MessageHeader;
use mcap::{McapError, McapResult, WriteOptions};

use crate::atomic::replace;
use crate::error::LogError;
use crate::log::RobotLog;
use crate::quantity::Quantity;

const TOPIC: &str = "/robot";
const SCHEMA_NAME: &str = "tribo.Log";

/// Writes a log as MCAP. The file appears whole or not at all.
///
/// # Errors
/// Those of [`write_atomic`](crate::write_atomic).
pub fn write_mcap(path: impl AsRef<Path>, log: &RobotLog) -> Result<(), LogError> {
    let path = path.as_ref();
    replace(path, |file| {
        write_messages(file, log).map_err(|error| match error {
            McapError::Io(source) => LogError::Io { path: path.to_path_buf(), action: "write", source },
            other => LogError::Corrupt { path: path.to_path_buf(), detail: other.to_string() },
        })
    })
}

fn write_messages(out: impl Write + Seek, log: &RobotLog) -> McapResult<()> {
    let fields: Vec<(Quantity, Vec<&[f64]>)> = Quantity::ALL
        .into_iter()
        .map(|quantity| (quantity, log.quantity(quantity)))
        .filter(|(_, c)| !c.is_empty())
        .collect();

    // One thread packs: the same log gives the same bytes.
    let mut writer = WriteOptions::new().compression_threads(0).library("tribo").create(out)?;
    let schema = writer.add_schema(SCHEMA_NAME, "jsonschema", schema(&fields).as_bytes())?;
    let channel_id = writer.add_channel(schema, TOPIC, "json", &BTreeMap::new())?;
    let start_s = log.time_s.first().map_or(0.0, |first| first.min(0.0));
    let (mut text, mut previous_ns) = (Vec::new(), None);
    for (row, time_s) in log.time_s.iter().enumerate() {
        text.clear();
        message(&mut text, &fields, row)?;
        let rounded_ns = ((time_s - start_s) * 1e9).round() as u64;
        let log_time = previous_ns.map_or(rounded_ns, |previous: u64| rounded_ns.max(previous.saturating_add(1)));
        previous_ns = Some(log_time);
        let sequence = u32::try_from(row).unwrap_or(u32::MAX);
        writer
            .write_to_known_channel(&MessageHeader { channel_id, sequence, log_time, publish_time: log_time }, &text)?;
    }
    writer.finish().map(|_| ())
}

/// The name of a quantity's field.
fn field(quantity: Quantity) -> String {
    quantity.to_string().trim_end_matches("_i").to_owned()
}

/// JSON schema of the messages.
fn schema(fields: &[(Quantity, Vec<&[f64]>)]) -> String {
    let property = |(quantity, columns): &(Quantity, Vec<&[f64]>)| {
        let kind = if is_scalar(*quantity) {
            r#"{"type":"number"}"#.to_owned()
        } else {
            format!(r#"{{"type":"array","items":{{"type":"number"}},"minItems":{0},"maxItems":{0}}}"#, columns.len())
        };
        format!(r#""{}":{kind}"#, field(*quantity))
    };
    let properties: Vec<String> = fields.iter().map(property).collect();
    format!(r#"{{"title":"{SCHEMA_NAME}","type":"object","properties":{{{}}}}}"#, properties.join(","))
}

/// One row. `{:?}` of a finite number is JSON.
fn message(text: &mut Vec<u8>, fields: &[(Quantity, Vec<&[f64]>)], row: usize) -> std::io::Result<()> {
    for (place, (quantity, columns)) in fields.iter().enumerate() {
        let scalar = is_scalar(*quantity);
        write!(
            text,
            "{}\"{}\":{}",
            if place == 0 { '{' } else { ',' },
            field(*quantity),
            if scalar { "" } else { "[" }
        )?;
        for (index, column) in columns.iter().enumerate() {
            write!(text, "{}{:?}", if index == 0 { "" } else { "," }, column[row])?;
        }
        text.extend_from_slice(if scalar { b"" } else { b"]" });
    }
    text.push(b'}');
    Ok(())
}

fn is_scalar(quantity: Quantity) -> bool {
    matches!(quantity, Quantity::Time | Quantity::TemperatureAmbient)
}
