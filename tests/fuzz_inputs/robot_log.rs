//! Robot logs of every format of one file.

use std::io::Cursor;
use std::path::Path;

use flate2::Crc;
use tribo_logs::{
    ColumnMap, ColumnNames, LogTarget, ReadOptions, Resampling, RobotLog, read_from, read_log_from, resample,
    write_log_to,
};

/// What errors call the input.
const NAME: &str = "input.log";

/// A log, whatever its format, written as CSV.
pub fn csv_log(input: &[u8]) {
    check(input, LogTarget::Csv(ColumnNames::Canonical));
}

/// A log, whatever its format, written as MCAP.
pub fn mcap_log(input: &[u8]) {
    check(input, LogTarget::Mcap);
}

/// A log, whatever its format, written as Parquet. Where the input has our checksum it is set right: without, no damage would
/// get past it.
pub fn parquet_log(input: &[u8]) {
    check(input, LogTarget::Parquet);
    if let Some(sealed) = resealed(input) {
        check(&sealed, LogTarget::Parquet);
    }
}

/// Bags in SQLite, written as CSV.
pub fn bag_log(input: &[u8]) {
    check(input, LogTarget::Csv(ColumnNames::Canonical));
}

/// Tables of other programs: CSV wide and long, Parquet with lists, NumPy. First as their names say, then by one of
/// the maps that fit those of the seeds.
pub fn foreign_log(input: &[u8]) {
    check(input, LogTarget::Csv(ColumnNames::Canonical));
    let maps = [
        "time=time,q=position,dq=velocity,tau=effort,joint=joint",
        "time=t[ms],q=q[{joint}],tau=tau[{joint}]",
        "rate=100,q=pos{joint}[deg],tau=cur{joint}[mA*2]",
        "episode=1",
    ];
    let map: ColumnMap = maps[input.len() % maps.len()].parse().expect("a map");
    if let Ok((log, _)) = read_from(input.to_vec(), Path::new(NAME), &ReadOptions::from(map)) {
        log.into_columns().validate().expect("a log that was read is valid");
    }
}

/// A log is refused with the name of the input, or is valid and the same to the bit after it was written and read.
pub(super) fn check(input: &[u8], target: LogTarget) {
    let name = Path::new(NAME);
    match read_log_from(input.to_vec(), name) {
        Ok((log, summary)) => {
            assert_eq!(summary.rows, log.rows());
            assert!(summary.duration_s.is_finite() && !summary.to_string().is_empty());
            let log = log.into_columns().validate().expect("a log that was read is valid");
            // Values too large to interpolate between are an error.
            if let Ok(resampled) = resample(&log, &Resampling::default()) {
                let rows: usize = resampled.bursts.iter().map(|burst| burst.rows()).sum();
                assert!(rows <= 2 * log.rows(), "{rows} rows of {}", log.rows());
            }
            let mut file = Cursor::new(Vec::new());
            write_log_to(&mut file, name, &log, target).expect("a valid log can be written");
            let (again, _) = read_log_from(file.into_inner(), name).expect("a log that was written is read");
            assert_eq!(bits(&again), bits(&log));
        }
        Err(error) => {
            let message = error.to_string();
            assert!(message.contains(NAME), "an error that does not name its file: {message}");
        }
    }
}

/// All cells as bits: `==` alone does not tell zero from minus zero.
pub(super) fn bits(log: &RobotLog) -> Vec<(String, Vec<u64>)> {
    log.named().into_iter().map(|(name, column)| (name, column.iter().map(|value| value.to_bits()).collect())).collect()
}

/// The input with the checksum that belongs to it, if it has the place for one (`files/src/seal.rs`).
fn resealed(input: &[u8]) -> Option<Vec<u8>> {
    if input.get(4..12)? != b"TRIBOCRC" || input.len() < 20 {
        return None;
    }
    let mut crc = Crc::new();
    crc.update(&input[..12]);
    crc.update(&input[20..]);
    let mut sealed = input.to_vec();
    sealed[12..20].copy_from_slice(format!("{:08x}", crc.sum()).as_bytes());
    (sealed != input).then_some(sealed)
}
