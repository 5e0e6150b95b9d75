//! The CSV that libfranka's `franka::logToCSV` writes, in its three headers, plain or gzip.
//!
//! ```text
//! current   time,success_rate,state.q[0],state.q[1],…,cmd.tau_J_d[6]                               87 columns
//! spaced    time, success_rate, state.q[0], state.q[1], …,cmd.tau_J_d[6]                           87 columns
//! legacy    duration, success rate, q[0], …,tau_ext_hat_filtered[6],sent commands,q_d[0], …,tau_J_d[6]     88 columns
//! ```
//!
//! time is in whole milliseconds, numbers have six significant digits. The legacy header names `q_d` and `dq_d` twice, as
//! state and as command; the column `sent commands`, empty in every row, stands between the two, and place decides.
//!
//! ```text
//! time = time · 1 ms   q, dq, tau_J = state   tau_J_d = state, else cmd   theta, dtheta = state   O_F_ext = state.O_F_ext_hat_K
//! ```
//!
//! `logToCSV` itself writes neither `theta` nor `O_F_ext_hat_K` nor `state.tau_J_d`; programs built after its example
//! add them under the same form of name, and they are read. Signs are libfranka's: `O_F_ext_hat_K` is what the robot
//! exerts. `tau_J` holds gravity and `tau_J_d` does not. A `cmd.tau_J_d` of zeros means that nobody commanded torques,
//! so it is left out with a warning.
//! Leaves out: `success_rate`, desired motion, commands other than torque, `tau_ext_hat_filtered`.
//!
//! Source: libfranka, `src/log.cpp` up to 0.9 (legacy until 0.3) and `src/logging/robot_state_log.cpp` since.

use std::io::BufRead;

use tribo_files::csv_lines::Lines;
use tribo_files::{LogError, LogFile};

use crate::csv_rows::{Clock, CsvRows};
use crate::format::LogFormat;
use crate::header::Header;
use crate::quantity::Quantity;

/// The column between state and command in the legacy header.
const LEGACY_MARK: &str = "sent commands";

/// Names of the state and of the command begin with these since the headers tell them apart.
const STATE: &str = "state.";
const COMMAND: &str = "cmd.";

/// The quantities of the state that are read, by their names there.
const READ: [(&str, Quantity); 7] = [
    ("q", Quantity::Position),
    ("dq", Quantity::Velocity),
    ("tau_J", Quantity::Torque),
    ("tau_J_d", Quantity::TorqueDesired),
    ("theta", Quantity::MotorPosition),
    ("dtheta", Quantity::MotorVelocity),
    ("O_F_ext_hat_K", Quantity::ExternalWrench),
];

/// Commanded torque: of the command where the state does not repeat it.
const COMMANDED_TORQUE: &str = "cmd.tau_J_d";

/// What is known and left out.
const LEFT_OUT: [&str; 9] = [
    "success_rate",
    LEGACY_MARK,
    "state.q_d",
    "state.dq_d",
    "state.tau_ext_hat_filtered",
    "cmd.q_d",
    "cmd.dq_d",
    "cmd.O_T_EE_d",
    "cmd.O_dP_EE_d",
];

/// Whether a header is of this family: the reader then says what is wrong with it.
pub(crate) fn is_libfranka(names: &[String]) -> bool {
    names.iter().any(|name| name == "state.q[0]" || name == LEGACY_MARK)
}

/// The rows of a file, header read. Where only the command tells the torque, the file is read before up to the first row that
/// has one.
pub(crate) fn libfranka_rows<'p>(file: &LogFile<'p>) -> Result<CsvRows<'p, Box<dyn BufRead>>, LogError> {
    let commanded = rows_with(file, true)?;
    if !commanded.header.quantities.contains(&Quantity::TorqueDesired) || ever_commanded(commanded) {
        return rows_with(file, true);
    }
    let mut rows = rows_with(file, false)?;
    rows.warnings.push("tau_J_d is zero throughout: no torque was commanded; left out".to_owned());
    Ok(rows)
}

/// The rows of a file with or without the commanded torque.
fn rows_with<'p>(file: &LogFile<'p>, commanded_torque: bool) -> Result<CsvRows<'p, Box<dyn BufRead>>, LogError> {
    let mut lines = Lines::new(file.open_text("CSV")?.0, file.path);
    let (names, delimiter) = lines.header()?;
    let header = placed(&names, commanded_torque).map_err(|error| error.in_file(file.path))?;
    Ok(CsvRows::new(lines, file.path, LogFormat::Libfranka, &names, delimiter, header, Clock::Milliseconds))
}

/// Whether some row has a commanded torque. A row that cannot be read says yes: the error is told where the rows are used.
fn ever_commanded(mut rows: CsvRows<'_, Box<dyn BufRead>>) -> bool {
    let columns = rows.header.columns_of(Quantity::TorqueDesired);
    loop {
        match rows.advance() {
            Ok(Some(row)) if row[columns.clone()].iter().all(|&torque_nm| torque_nm == 0.0) => {}
            Ok(None) => return false,
            _ => return true,
        }
    }
}

/// Where the canonical columns stand.
fn placed(names: &[String], commanded_torque: bool) -> Result<Header, LogError> {
    let qualified = qualified(names);
    let in_state = qualified.iter().any(|name| split(name).is_some_and(|(stem, _)| stem == "state.tau_J_d"));
    let from_command = commanded_torque && !in_state;
    let canonical: Vec<String> = qualified
        .iter()
        .map(|name| match split(name) {
            Some((stem, index)) => {
                quantity_of(stem, from_command).map_or_else(|| name.clone(), |q| q.column_name(index))
            }
            None => name.clone(),
        })
        .collect();
    match Header::from_names(&canonical) {
        Ok(mut header) => {
            header.unknown.retain(|name| {
                let stem = split(name).map_or(name.as_str(), |(stem, _)| stem);
                !LEFT_OUT.contains(&stem) && stem != COMMANDED_TORQUE
            });
            Ok(header)
        }
        Err(LogError::MissingColumns { missing, .. }) => {
            let missing = missing.iter().map(|name| libfranka_name(name)).collect();
            Err(LogError::MissingColumns { missing, unknown: Vec::new() })
        }
        Err(error) => Err(error),
    }
}

/// The names of the current header, whichever header it is.
fn qualified(names: &[String]) -> Vec<String> {
    let Some(mark) = names.iter().position(|name| name == LEGACY_MARK) else { return names.to_vec() };
    let current = |(place, name): (usize, &String)| match name.as_str() {
        "duration" => Quantity::Time.column_name(0),
        "success rate" => "success_rate".to_owned(),
        LEGACY_MARK => LEGACY_MARK.to_owned(),
        name if place < mark => format!("{STATE}{name}"),
        name => format!("{COMMAND}{name}"),
    };
    names.iter().enumerate().map(current).collect()
}

/// `state.q[3]` as `state.q` and 3.
fn split(name: &str) -> Option<(&str, usize)> {
    let (stem, index) = name.strip_suffix(']')?.split_once('[')?;
    Some((stem, index.parse().ok()?))
}

/// What a stem stands for, if it is read.
fn quantity_of(stem: &str, commanded_torque: bool) -> Option<Quantity> {
    if stem == COMMANDED_TORQUE {
        return commanded_torque.then_some(Quantity::TorqueDesired);
    }
    let state = stem.strip_prefix(STATE)?;
    READ.into_iter().find_map(|(name, quantity)| (name == state).then_some(quantity))
}

/// The libfranka name of a canonical column.
fn libfranka_name(canonical: &str) -> String {
    let found = Quantity::from_column_name(canonical).and_then(|(quantity, index)| {
        let (name, _) = READ.into_iter().find(|&(_, read)| read == quantity)?;
        Some(format!("{STATE}{name}[{index}]"))
    });
    found.unwrap_or_else(|| canonical.to_owned())
}
