//! Bags of ROS 2 in SQLite (`.db3`), what `ros2 bag record` wrote before MCAP.
//!
//! ```text
//! topics (id, name, type, serialization_format)     messages (topic_id, timestamp in ns, data in CDR)
//! message_definitions (topic_type, encoding, encoded_message_definition)         bags since Iron; before, only JointState is known here
//! ```
//!
//! Messages become rows as those of MCAP do (`arm_rows`). The file is opened for reading alone, and its schema is not trusted: only
//! tables are asked, not views.
//! Leaves out: bags packed by file or message (`ros2 bag convert` unpacks them), bags in several files.

use std::collections::BTreeMap;
use std::path::Path;

use rusqlite::config::DbConfig;
use rusqlite::types::ValueRef;
use rusqlite::{Connection, OpenFlags, Row};
use tribo_files::{LogError, LogFile, RawBytes};

use crate::arm_rows::{Candidate, Chosen, Rows, Wanted};
use crate::format::LogFormat;
use crate::log::RobotLog;
use crate::message_source::Source;
use crate::summary::LogSummary;

/// First bytes of an SQLite database.
pub(crate) const SQLITE_MAGIC: &[u8] = b"SQLite format 3\0";

/// The message that bags without definitions may hold, as ROS 2 defines it.
const JOINT_STATE: (&str, &str) = (
    "sensor_msgs/msg/JointState",
    "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n\
     ================================================================================\n\
     MSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n\
     ================================================================================\n\
     MSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n",
);

/// The largest message believed (bytes): a damaged length asks for no more.
const LONGEST_MESSAGE: i32 = 1 << 24;

/// The most topics of a bag.
const MOST_TOPICS: usize = 1 << 12;

/// Reads the one topic of a bag that says most about an arm; errors as those of an MCAP file.
pub(crate) fn bag(file: &LogFile, wanted: Wanted) -> Result<(RobotLog, LogSummary), LogError> {
    let path = file.path;
    let damaged = |error: rusqlite::Error| {
        let detail = match error.sqlite_error_code() {
            Some(rusqlite::ErrorCode::OperationInterrupted) => {
                "its pages hold more rows than its bytes justify".to_owned()
            }
            _ => error.to_string(),
        };
        LogError::Corrupt { path: path.to_path_buf(), detail }
    };
    let connection = open(file, damaged)?;
    file.stretch(0.0, 0.5);
    let mut topics = topics(&connection, path).map_err(damaged)??;
    let total = length(&connection).map_err(damaged)?;
    each_message(&connection, None, path, |topic, data, _, number| {
        if number % HEARD == 0 {
            file.done(number as f64 / total).map_err(|error| LogError::io(path, "read", error))?;
        }
        if let Some(candidate) = topics.get_mut(&topic) {
            candidate.look_at(data, wanted);
        }
        Ok(())
    })
    .map_err(damaged)??;
    topics.retain(|_, candidate| candidate.has_messages());
    file.stretch(0.5, 1.0);
    let chosen = Chosen::of(topics, wanted, path)?;
    let mut rows = Rows::new(&chosen.arm);
    each_message(&connection, Some(chosen.id), path, |_, data, log_ns, number| {
        if number % HEARD == 0 {
            file.done(number as f64 / total).map_err(|error| LogError::io(path, "read", error))?;
        }
        chosen.push(&mut rows, data, log_ns, path)
    })
    .map_err(damaged)??;
    let (log, dropped_repeats, clock) = rows.finish(&chosen.arm).map_err(|error| error.in_file(path))?;
    let mut summary = LogSummary::new(LogFormat::Bag, &log, dropped_repeats, Vec::new());
    summary.dropped_incomplete = rows.incomplete;
    summary.source = Some(chosen.described(clock));
    summary.warnings.extend(chosen.arm.warnings);
    Ok((log, summary))
}

/// Messages between two words to whoever watches.
const HEARD: u64 = 1 << 12;

/// The most steps of the database's machine per byte of a file, and of a small file: a message takes about fifteen, twice.
const STEPS_PER_BYTE: u64 = 16;
const LEAST_STEPS: u64 = 1 << 20;

/// Steps between two counts of them.
const STEPS_HEARD: i32 = 1000;

/// Opens a file, or bytes in memory, for reading.
fn open(file: &LogFile, damaged: impl Fn(rusqlite::Error) -> LogError + Copy) -> Result<Connection, LogError> {
    let mut connection = match file.open("rosbag2")? {
        RawBytes::File(_) => {
            let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
            Connection::open_with_flags(file.path, flags).map_err(damaged)?
        }
        RawBytes::Memory(memory) => {
            let mut connection = Connection::open_in_memory().map_err(damaged)?;
            let bytes = memory.into_inner();
            connection.deserialize_read_exact("main", &bytes[..], bytes.len(), true).map_err(damaged)?;
            connection
        }
    };
    let steps = file.length().unwrap_or(0).saturating_mul(STEPS_PER_BYTE).saturating_add(LEAST_STEPS)
        / u64::from(STEPS_HEARD.unsigned_abs());
    let mut heard = 0;
    let harden = |connection: &mut Connection| -> rusqlite::Result<()> {
        // Pages that point at each other could go on for ever.
        connection.progress_handler(
            STEPS_HEARD,
            Some(move || {
                heard += 1;
                heard > steps
            }),
        )?;
        connection.set_db_config(DbConfig::SQLITE_DBCONFIG_DEFENSIVE, true)?;
        connection.set_db_config(DbConfig::SQLITE_DBCONFIG_TRUSTED_SCHEMA, false)?;
        connection.set_db_config(DbConfig::SQLITE_DBCONFIG_ENABLE_VIEW, false)?;
        connection.set_db_config(DbConfig::SQLITE_DBCONFIG_ENABLE_TRIGGER, false)?;
        connection.pragma_update(None, "cell_size_check", true)?;
        connection.set_limit(rusqlite::limits::Limit::SQLITE_LIMIT_LENGTH, LONGEST_MESSAGE)?;
        Ok(())
    };
    harden(&mut connection).map_err(damaged)?;
    Ok(connection)
}

/// The topics, and how their messages are read.
fn topics(connection: &Connection, path: &Path) -> rusqlite::Result<Result<BTreeMap<u64, Candidate>, LogError>> {
    let mut tables = connection.prepare("SELECT name FROM sqlite_schema WHERE type = 'table'")?;
    let tables: Vec<String> = tables.query_map([], |row| row.get(0))?.collect::<rusqlite::Result<_>>()?;
    let has = |name: &str| tables.iter().any(|table| table == name);
    if !has("topics") || !has("messages") {
        let detail = format!(
            "an SQLite database that is no bag of ROS 2 (no tables topics and messages; it has: {})",
            tables.join(", ")
        );
        return Ok(Err(LogError::NotRead { path: path.to_path_buf(), detail }));
    }
    let mut definitions: Vec<(String, String, String)> = Vec::new();
    if has("message_definitions") {
        let mut query =
            connection.prepare("SELECT topic_type, encoding, encoded_message_definition FROM message_definitions")?;
        let mut rows = query.query([])?;
        while let Some(row) = rows.next()? {
            definitions.push((text(row, 0), text(row, 1), text(row, 2)));
            if definitions.len() >= MOST_TOPICS {
                break;
            }
        }
    }
    let mut query = connection.prepare("SELECT id, name, type, serialization_format FROM topics")?;
    let mut rows = query.query([])?;
    let mut topics = BTreeMap::new();
    while let Some(row) = rows.next()? {
        let (name, kind, encoding) = (text(row, 1), text(row, 2), text(row, 3));
        let Ok(id) = u64::try_from(row.get::<_, i64>(0)?) else { continue };
        let written =
            definitions.iter().find(|(of, encoding, text)| *of == kind && encoding == "ros2msg" && !text.is_empty());
        let definition = match written {
            Some((_, _, text)) => Some((kind.as_str(), "ros2msg", text.as_bytes())),
            None if kind == JOINT_STATE.0 => Some((JOINT_STATE.0, "ros2msg", JOINT_STATE.1.as_bytes())),
            None => None,
        };
        let source = match definition {
            None if encoding == "cdr" => {
                Err("the bag does not say how its messages are laid out (bags before Iron)".to_owned())
            }
            definition => Source::of(&encoding, definition),
        };
        topics.insert(id, Candidate::new(&name, &kind, source));
        if topics.len() >= MOST_TOPICS {
            break;
        }
    }
    Ok(Ok(topics))
}

/// A cell as text; empty where it is none.
fn text(row: &Row, column: usize) -> String {
    row.get::<_, String>(column).unwrap_or_default()
}

/// Number of messages.
fn length(connection: &Connection) -> rusqlite::Result<f64> {
    let count: i64 = connection.query_row("SELECT count(*) FROM messages", [], |row| row.get(0))?;
    Ok(count.max(1) as f64)
}

/// Every message in the order of the recorder's stamps: topic, bytes, stamp (ns), number.
fn each_message(
    connection: &Connection,
    topic: Option<u64>,
    path: &Path,
    mut take: impl FnMut(u64, &[u8], u64, u64) -> Result<(), LogError>,
) -> rusqlite::Result<Result<(), LogError>> {
    // Rows are stored as they came in: no sorting, which would hold the bag in memory.
    let mut query =
        connection.prepare("SELECT topic_id, timestamp, data FROM messages WHERE ?1 IS NULL OR topic_id = ?1")?;
    let mut rows = query.query([topic.map(|id| i64::try_from(id).unwrap_or(i64::MAX))])?;
    let mut number = 0;
    while let Some(row) = rows.next()? {
        let (of, stamp): (i64, i64) = (row.get(0)?, row.get(1)?);
        let ValueRef::Blob(data) = row.get_ref(2)? else {
            let detail = format!("message {number} holds no bytes");
            return Ok(Err(LogError::Corrupt { path: path.to_path_buf(), detail }));
        };
        if let Err(error) = take(u64::try_from(of).unwrap_or(u64::MAX), data, u64::try_from(stamp).unwrap_or(0), number)
        {
            return Ok(Err(error));
        }
        number += 1;
    }
    Ok(Ok(()))
}
