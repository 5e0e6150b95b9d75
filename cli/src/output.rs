//! Tables and JSON on standard output, messages on standard error.

use std::io::{self, Write};
use std::sync::OnceLock;

use comfy_table::{CellAlignment, Table, presets};
use serde_json::{Value, json};
use tribo_logs::{LogSummary, Mapping};
use tribo_model::FileError;

use crate::terminal::{Form, write_line};

/// A plain table; all columns but the first are right-aligned.
pub fn table(header: &[&str]) -> Table {
    let mut table = Table::new();
    table.load_style(presets::NOTHING).set_header(header.iter().copied());
    for column in 1..header.len() {
        if let Some(column) = table.column_mut(column) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    table
}

/// What kept the first text from standard output, if anything did.
static FAILED: OnceLock<io::Error> = OnceLock::new();

/// Prints text and a newline.
pub fn print(text: impl std::fmt::Display) {
    noted(write_line(&mut io::stdout().lock(), Form::Text, text));
}

/// Prints bytes as they are.
pub fn print_bytes(bytes: &[u8]) {
    noted(io::stdout().lock().write_all(bytes));
}

/// Keeps what came of writing to standard output for [`printed`]. A reader that has gone (`tribo … | head`) is no error of ours.
pub fn noted(written: io::Result<()>) {
    if let Err(error) = written
        && error.kind() != io::ErrorKind::BrokenPipe
    {
        // The first error is the one that explains.
        let _ = FAILED.set(error);
    }
}

/// Whether all that was printed has arrived; asked once, at the end.
///
/// # Errors
/// A full disk, say: what is on standard output is not whole.
pub fn printed() -> Result<(), FileError> {
    noted(io::stdout().lock().flush());
    match FAILED.get() {
        Some(error) => {
            let source = io::Error::new(error.kind(), error.to_string());
            Err(FileError::Io { path: "standard output".into(), source })
        }
        None => Ok(()),
    }
}

/// A message on standard error. If it cannot be written nobody can be told, and the work goes on.
pub fn message(text: impl std::fmt::Display) {
    let _ = write_line(&mut io::stderr().lock(), Form::Text, text);
}

/// Prints one JSON document.
pub fn print_json(document: &Value) {
    noted(write_line(&mut io::stdout().lock(), Form::Json, format_args!("{document:#}")));
}

/// Sizes from here on are written as powers of ten.
const LARGE: f64 = 1e9;

/// A number with `digits` significant digits, for tables; `-` where there is none: not a number, or without bound.
pub fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return "-".to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    if value.abs() >= LARGE {
        return format!("{value:.*e}", digits.saturating_sub(1));
    }
    let magnitude = value.abs().log10().floor() as i64;
    let decimals = (digits as i64 - 1 - magnitude).clamp(0, 9) as usize;
    format!("{value:.decimals$}")
}

/// A number with so many decimals, as [`significant`] where it is too large for them or none.
pub fn fixed(value: f64, decimals: usize) -> String {
    if value.is_finite() && value.abs() < LARGE { format!("{value:.decimals$}") } else { significant(value, 3) }
}

/// What to know about the log.
pub fn log_json(log: &LogSummary) -> Value {
    json!({"rows": log.rows, "duration_s": log.duration_s, "rate_hz": log.rate_hz, "dropped_repeats": log.dropped_repeats, "read_as": log.mapping.as_ref().map(Mapping::to_json)})
}

#[cfg(test)]
mod tests {
    use super::{fixed, significant};

    #[test]
    fn three_significant_digits() {
        assert_eq!(significant(24.1567, 3), "24.2");
        assert_eq!(significant(0.012345, 3), "0.0123");
        assert_eq!(significant(1234.5, 3), "1234");
        assert_eq!(significant(0.0, 3), "0");
        assert_eq!(significant(-0.0, 3), "0");
    }

    #[test]
    fn no_table_says_inf_or_nan_or_two_hundred_digits() {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert_eq!((significant(value, 3), fixed(value, 2)), ("-".to_owned(), "-".to_owned()));
        }
        assert_eq!(
            (significant(1.7876e250, 3), fixed(-1.7876e250, 3)),
            ("1.79e250".to_owned(), "-1.79e250".to_owned())
        );
        assert_eq!(fixed(-1.2345, 3), "-1.234");
    }
}
