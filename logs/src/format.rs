//! Names of the formats.

use std::fmt;

/// A format that can be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum LogFormat {
    /// Canonical CSV, plain.
    Csv,
    /// Canonical CSV, gzip.
    CsvGz,
    /// Parquet with the canonical columns.
    Parquet,
    /// Directory of text files of the Panda data of gaz2019.
    PandaGaz,
    /// CSV of the Kinova Gen3 data of `dynamic-identification`, plain or gzip.
    KinovaGen3,
    /// CSV that libfranka's `logToCSV` writes, plain or gzip.
    Libfranka,
    /// MCAP with messages of a kind that is understood.
    Mcap,
    /// rosbag2 in SQLite.
    Bag,
    /// Text table with the columns of another program, plain.
    Table,
    /// Text table with the columns of another program, gzip.
    TableGz,
    /// NumPy arrays, `.npz` or structured `.npy`.
    Numpy,
}

impl fmt::Display for LogFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Csv => "canonical CSV",
            Self::CsvGz => "canonical CSV (gzip)",
            Self::Parquet => "Parquet",
            Self::PandaGaz => "Panda text files (Gaz 2019)",
            Self::KinovaGen3 => "Kinova Gen3 CSV",
            Self::Libfranka => "libfranka CSV",
            Self::Mcap => "MCAP",
            Self::Bag => "rosbag2 (SQLite)",
            Self::Table => "CSV of other columns",
            Self::TableGz => "CSV of other columns (gzip)",
            Self::Numpy => "NumPy",
        })
    }
}
