#![doc = include_str!("../README.md")]
//!
//! ```text
//! file or directory  --read_log-->  (RobotLog, LogSummary)  --write_csv / write_parquet / write_mcap-->  file
//! file or directory  --convert (in batches of rows where the formats allow it)-->                        file, LogSummary
//! ```
//!
//! [`RobotLog`] is columnar and always valid: at least two rows, finite cells, columns of one length, strictly
//! increasing time. Every way a file can be wrong is a `LogError` that names the file, the line or row, the column
//! and the value. [`LogSummary`] says what was read, dropped, missing and not understood.
//! Files are written atomically: a reader sees the old content or the new one, never a part.
//! SI units and radians; degrees Celsius for temperatures; wrenches in the base frame, force first.
//! Leaves out: model files, campaign journals and every computation on the data except resampling.
//!
//! ```
//! use tribo_logs::{LogColumns, bursts, read_log, write_csv};
//! let directory = tempfile::tempdir()?;
//! let path = directory.path().join("swing.csv.gz");
//! let time_s: Vec<f64> = (0..1000).map(|k| f64::from(k) * 1e-3).collect();
//! let q_rad = vec![time_s.iter().map(|t| t.sin()).collect::<Vec<f64>>()];
//! let dq_rad_s = vec![time_s.iter().map(|t| t.cos()).collect::<Vec<f64>>()];
//! let log = LogColumns { tau_j_nm: vec![vec![0.0; 1000]], time_s, q_rad, dq_rad_s, ..LogColumns::default() }.validate()?;
//! write_csv(&path, &log)?;
//! let (same, summary) = read_log(&path)?;
//! assert_eq!(log, same);
//! assert_eq!((same.joints(), summary.bursts), (1, bursts(&same.time_s, tribo_logs::GAP_TOLERANCE).len()));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod arm_rows;
mod bag_log;
mod bursts;
mod canonical_csv;
mod convert;
mod csv_rows;
mod detect;
mod differentiated;
mod foreign;
mod format;
mod header;
mod joint_order;
mod joint_state;
mod joint_state_recorder;
mod kinova_gen3;
mod libfranka;
mod log;
mod mcap_log;
mod mcap_write;
mod message_source;
mod panda_gaz;
mod parquet_log;
mod quantity;
mod read_options;
pub mod recognise;
mod resample;
mod stretches;
mod summary;
mod write_log;

pub use bursts::{GAP_TOLERANCE, bursts, median_period_s};
pub use canonical_csv::read_csv;
pub use convert::{convert, convert_by};
pub use detect::{detect, read, read_from, read_log, read_log_from, read_log_watched, read_watched};
pub use foreign::{ColumnMap, MappedColumn, Mapping, Unit};
pub use format::LogFormat;
pub use joint_state::{JointState, JointStateReader};
pub use joint_state_recorder::JointStateRecorder;
pub use log::{LogColumns, RobotLog, row};
pub use panda_gaz::read_panda_gaz;
pub use parquet_log::{log_of_table, read_parquet};
pub use quantity::Quantity;
pub use read_options::ReadOptions;
pub use resample::{Resampled, Resampling, resample};
pub use summary::LogSummary;
pub use write_log::{ColumnNames, LogTarget, write_csv, write_log, write_log_to, write_mcap, write_parquet};
