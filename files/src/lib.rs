#![doc = include_str!("../README.md")]
//!
//! ```
//! use tribo_files::{Table, read_table, write_table};
//! let path = std::env::temp_dir().join(format!("tribo-files-{}.parquet", std::process::id()));
//! let columns = vec![("time_s".to_owned(), vec![0.0, 0.1]), ("q".to_owned(), vec![1.0, 1.5])];
//! write_table(&path, &Table { columns, ..Table::default() })?;
//! assert_eq!(read_table(&path)?.column("q"), Some(&[1.0, 1.5][..]));
//! std::fs::remove_file(path)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Leaves out: what the columns mean. That is the matter of `tribo-logs`.

mod atomic;
mod cdr;
mod cdr_write;
pub mod csv_lines;
mod csv_writer;
mod decoder;
mod error;
mod limited;
mod parquet_bytes;
pub mod parquet_pages;
mod parquet_table;
pub mod ros2_layout;
mod seal;
mod source;

pub use atomic::{AtomicFile, Output, failed, replace, write_atomic, write_new};
pub use cdr::{Cdr, Slot};
pub use cdr_write::CdrWriter;
pub use csv_writer::CsvWriter;
pub use decoder::guarded;
pub use error::{LogError, shown, visible};
pub use limited::Limited;
pub use parquet_bytes::ParquetBytes;
pub use parquet_table::{ROWS_PER_GROUP, Table, TableWriter, most_cells, read_table, table_of, write_table};
pub use seal::seal_of;
pub use source::{Counted, LogFile, RawBytes, peek};
