//! One motion, and the files that other programs would make of it.

use std::fmt::Write as _;
use std::io::{Cursor, Write as _};
use std::sync::Arc;

use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;
use rusqlite::Connection;
use tribo_logs::{LogColumns, RobotLog};
use zip::write::SimpleFileOptions;

use crate::common::ros2::Cdr;

pub const JOINTS: usize = 6;
pub const ROWS: usize = 300;

/// Joints of a Universal Robots arm, base to tool.
pub const UR: [&str; 6] =
    ["shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint", "wrist_2_joint", "wrist_3_joint"];
/// The same as a driver lists them: in alphabetical order.
pub const AS_LISTED: [usize; 6] = [2, 1, 0, 3, 4, 5];

/// Six joints, 500 rows per second.
pub fn motion() -> RobotLog {
    let time_s: Vec<f64> = (0..ROWS).map(|k| k as f64 / 500.0).collect();
    let wave = |f: &dyn Fn(f64, f64) -> f64| -> Vec<Vec<f64>> {
        (0..JOINTS).map(|j| time_s.iter().map(|t| f(j as f64, *t)).collect()).collect()
    };
    let log = LogColumns {
        q_rad: wave(&|j, t| 0.3 * j + 0.4 * ((2.0 + j) * t).sin()),
        dq_rad_s: wave(&|j, t| 0.4 * (2.0 + j) * ((2.0 + j) * t).cos()),
        tau_j_nm: wave(&|j, t| 20.0 - 3.0 * j + 5.0 * ((2.0 + j) * t).cos().signum() + t),
        time_s,
        ..LogColumns::default()
    };
    log.validate().unwrap()
}

/// A cell of each row.
pub type Cell<'c> = Box<dyn Fn(usize) -> String + 'c>;

/// A number as programs write it, to the last bit.
pub fn number<'c>(value: impl Fn(usize) -> f64 + 'c) -> Cell<'c> {
    Box::new(move |row| format!("{}", value(row)))
}

/// Columns of all joints in an order, under names made from the place in it, with a factor.
pub fn each<'c>(
    order: &[usize],
    name: impl Fn(usize) -> String,
    columns: &'c [Vec<f64>],
    factor: f64,
) -> Vec<(String, Cell<'c>)> {
    order.iter().map(|&j| (name(j), number(move |row| columns[j][row] * factor))).collect()
}

/// Joints base to tool.
pub const IN_ORDER: [usize; 6] = [0, 1, 2, 3, 4, 5];

/// A text table.
pub fn text(delimiter: &str, columns: &[(String, Cell)], header: bool) -> Vec<u8> {
    let mut text = String::new();
    let line = |cells: Vec<String>| cells.join(delimiter) + "\n";
    if header {
        text += &line(columns.iter().map(|(name, _)| name.clone()).collect());
    }
    for row in 0..ROWS {
        text += &line(columns.iter().map(|(_, cell)| cell(row)).collect());
    }
    text.into_bytes()
}

/// One row per joint and stamp, in the order a driver lists them, with a gripper.
pub fn long(log: &RobotLog, by_joint: bool) -> Vec<u8> {
    let mut text = "time,joint,position,velocity,effort\n".to_owned();
    let mut rows: Vec<(usize, usize)> = (0..ROWS).flat_map(|row| AS_LISTED.map(|j| (row, j))).collect();
    if by_joint {
        rows.sort_by_key(|(row, j)| (*j, *row));
    }
    for (row, j) in rows {
        let (q, dq, tau) = (log.q_rad[j][row], log.dq_rad_s[j][row], log.tau_j_nm[j][row]);
        writeln!(text, "{},{},{q},{dq},{tau}", log.time_s[row], UR[j]).unwrap();
        if j == 5 {
            writeln!(text, "{},finger_joint,0.1,0,0", log.time_s[row]).unwrap();
        }
    }
    text.into_bytes()
}

/// As LeRobot lays its episodes out: lists of numbers per row, two episodes one behind the other.
pub fn episodes(log: &RobotLog) -> Vec<u8> {
    let list =
        |name: &str| format!("OPTIONAL group {name} (LIST) {{ REPEATED group list {{ OPTIONAL DOUBLE element; }} }}");
    let names = ["observation.state", "observation.velocity", "observation.effort", "action"];
    let lists: String = names.iter().map(|name| list(name)).collect();
    let schema = format!(
        "message m {{ {lists} OPTIONAL DOUBLE timestamp; OPTIONAL INT64 frame_index; OPTIONAL INT64 episode_index; OPTIONAL INT64 index; OPTIONAL INT64 task_index; }}"
    );
    let schema = Arc::new(parse_message_type(&schema).unwrap());
    let mut writer = SerializedFileWriter::new(Vec::new(), schema, Arc::new(WriterProperties::default())).unwrap();
    for episode in 0..2 {
        let mut group = writer.next_row_group().unwrap();
        for columns in [&log.q_rad, &log.dq_rad_s, &log.tau_j_nm, &log.q_rad] {
            let shift = if episode == 0 { 1.0 } else { 0.0 };
            let values: Vec<f64> = (0..ROWS).flat_map(|row| columns.iter().map(move |c| c[row] + shift)).collect();
            let levels: Vec<i16> = (0..values.len()).map(|k| i16::from(k % JOINTS != 0)).collect();
            let mut column = group.next_column().unwrap().unwrap();
            column.typed::<DoubleType>().write_batch(&values, Some(&vec![3; values.len()]), Some(&levels)).unwrap();
            column.close().unwrap();
        }
        let there = vec![1; ROWS];
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<DoubleType>().write_batch(&log.time_s, Some(&there), None).unwrap();
        column.close().unwrap();
        for value in [&|row| row as i64 as f64, &|_| f64::from(episode), &|row| row as f64, &|_| 0.0]
            as [&dyn Fn(usize) -> f64; 4]
        {
            let values: Vec<i64> = (0..ROWS).map(|row| value(row) as i64).collect();
            let mut column = group.next_column().unwrap().unwrap();
            column.typed::<Int64Type>().write_batch(&values, Some(&there), None).unwrap();
            column.close().unwrap();
        }
        group.close().unwrap();
    }
    writer.into_inner().unwrap()
}

/// A wide frame of pandas: stamps since 1970 in nanoseconds, one column per joint and quantity.
pub fn frame(log: &RobotLog) -> Vec<u8> {
    let doubles: Vec<(String, &Vec<f64>)> =
        [("position", &log.q_rad), ("velocity", &log.dq_rad_s), ("effort", &log.tau_j_nm)]
            .into_iter()
            .flat_map(|(name, columns)| {
                columns.iter().enumerate().map(move |(j, column)| (format!("{name}_{j}"), column))
            })
            .collect();
    let fields: String = doubles.iter().map(|(name, _)| format!("OPTIONAL DOUBLE {name}; ")).collect();
    let schema = format!(
        "message schema {{ OPTIONAL INT64 timestamp (TIMESTAMP(NANOS,false)); OPTIONAL BYTE_ARRAY note (UTF8); {fields} }}"
    );
    let schema = Arc::new(parse_message_type(&schema).unwrap());
    let mut writer = SerializedFileWriter::new(Vec::new(), schema, Arc::new(WriterProperties::default())).unwrap();
    let mut group = writer.next_row_group().unwrap();
    let there = vec![1; ROWS];
    let mut column = group.next_column().unwrap().unwrap();
    column.typed::<Int64Type>().write_batch(&stamps_ns(), Some(&there), None).unwrap();
    column.close().unwrap();
    let mut column = group.next_column().unwrap().unwrap();
    column.typed::<ByteArrayType>().write_batch(&vec![ByteArray::from("x"); ROWS], Some(&there), None).unwrap();
    column.close().unwrap();
    for (_, values) in doubles {
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<DoubleType>().write_batch(values, Some(&there), None).unwrap();
        column.close().unwrap();
    }
    group.close().unwrap();
    writer.into_inner().unwrap()
}

/// Nanoseconds since 1970.
pub fn stamps_ns() -> Vec<i64> {
    (0..ROWS as i64).map(|row| 1_700_000_000_123_456_789 + row * 2_000_000).collect()
}

/// A bag that was recorded before definitions were stored, of a driver with its own order and a finger.
pub fn bag(log: &RobotLog) -> Vec<u8> {
    let path = tempfile::NamedTempFile::new().unwrap();
    let connection = Connection::open(path.path()).unwrap();
    connection
        .execute_batch(
            "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);
             CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data BLOB NOT NULL);
             INSERT INTO topics VALUES (1, '/rosout', 'rcl_interfaces/msg/Log', 'cdr', ''), (2, '/joint_states', 'sensor_msgs/msg/JointState', 'cdr', '');
             BEGIN;",
        )
        .unwrap();
    let names: Vec<&str> = AS_LISTED.iter().map(|&j| UR[j]).chain(["finger_joint"]).collect();
    for (row, stamp) in stamps_ns().into_iter().enumerate() {
        let of =
            |columns: &[Vec<f64>]| -> Vec<f64> { AS_LISTED.iter().map(|&j| columns[j][row]).chain([0.5]).collect() };
        let message =
            Cdr::new().joint_state(stamp as u64, &names, &of(&log.q_rad), &of(&log.dq_rad_s), &of(&log.tau_j_nm));
        let sql = "INSERT INTO messages (topic_id, timestamp, data) VALUES (?1, ?2, ?3)";
        connection.execute(sql, (1, stamp, vec![0_u8, 1, 0, 0])).unwrap();
        connection.execute(sql, (2, stamp + 1_000, message.bytes())).unwrap();
    }
    connection.execute_batch("COMMIT;").unwrap();
    connection.close().unwrap();
    std::fs::read(path.path()).unwrap()
}

/// Bytes of one NumPy array.
fn array(descr: &str, shape: &str, data: Vec<u8>) -> Vec<u8> {
    let mut header = format!("{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}, }}");
    while (10 + header.len() + 1) % 64 != 0 {
        header.push(' ');
    }
    header.push('\n');
    [&b"\x93NUMPY\x01\x00"[..], &(header.len() as u16).to_le_bytes(), header.as_bytes(), &data].concat()
}

fn bytes(values: impl Iterator<Item = f64>) -> Vec<u8> {
    values.flat_map(f64::to_le_bytes).collect()
}

/// `numpy.savez_compressed(q=(n, N), dq=(N, n), tau=(n, N), time=(n))`; stamps left out where there is a rate.
pub fn archive(log: &RobotLog, with_time: bool) -> Vec<u8> {
    let by_row =
        |columns: &[Vec<f64>]| bytes((0..ROWS).flat_map(|row| columns.iter().map(move |c| c[row]).collect::<Vec<_>>()));
    let by_joint = |columns: &[Vec<f64>]| bytes(columns.iter().flatten().copied());
    let mut members = vec![
        ("q", array("'<f8'", "(300, 6)", by_row(&log.q_rad))),
        ("dq", array("'<f8'", "(6, 300)", by_joint(&log.dq_rad_s))),
        (
            "tau",
            array(
                "'>f8'",
                "(300, 6)",
                by_row(&log.tau_j_nm).chunks(8).flat_map(|b| b.iter().rev().copied().collect::<Vec<u8>>()).collect(),
            ),
        ),
        ("names", array("'<U4'", "(6,)", vec![0; 6 * 16])),
    ];
    if with_time {
        members.push(("time", array("'<f8'", "(300,)", bytes(log.time_s.iter().copied()))));
    }
    let mut writer = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in members {
        let options = SimpleFileOptions::default().compression_method(zip::CompressionMethod::Deflated);
        writer.start_file(format!("{name}.npy"), options).unwrap();
        writer.write_all(&content).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

/// A structured array: time, and three vectors per row.
pub fn structured(log: &RobotLog) -> Vec<u8> {
    let row = |row: usize| {
        let vectors = [&log.q_rad, &log.dq_rad_s, &log.tau_j_nm];
        bytes([log.time_s[row]].into_iter().chain(vectors.into_iter().flat_map(move |c| c.iter().map(move |c| c[row]))))
    };
    let descr = "[('time', '<f8'), ('q', '<f8', (6,)), ('dq', '<f8', (6,)), ('tau', '<f8', (6,))]";
    array(descr, "(300,)", (0..ROWS).flat_map(row).collect())
}
