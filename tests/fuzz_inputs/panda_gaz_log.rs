//! The directory of four text files of gaz2019.

use tribo_logs::read_log;

use super::scratch::{directory, put};

/// What stands between the four files of an input.
const BETWEEN: &[u8] = b"---\n";

/// A directory is refused with its name, or is a valid log.
pub fn check(input: &[u8]) {
    let directory = directory().join("panda_gaz");
    std::fs::create_dir_all(&directory).expect("a directory");
    let mut rest = input;
    for name in ["time", "positions", "velocity", "torques"] {
        let end = rest.windows(BETWEEN.len()).position(|window| window == BETWEEN).unwrap_or(rest.len());
        put(&directory.join(format!("exciting_traj_{name}.txt")), &rest[..end]);
        rest = rest.get(end + BETWEEN.len()..).unwrap_or_default();
    }
    match read_log(&directory) {
        Ok((log, summary)) => {
            assert_eq!(summary.rows, log.rows());
            log.into_columns().validate().expect("a log that was read is valid");
        }
        Err(error) => assert!(error.to_string().contains("panda_gaz"), "{error}"),
    }
}
