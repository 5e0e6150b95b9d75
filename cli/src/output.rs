//! Tables and JSON on standard output.

use std::io::{self, Write};
use std::sync::OnceLock;

use comfy_table::{CellAlignment, Table, presets};
use serde_json::{Value, json};
use tribo_experiments::files::FileError;
use tribo_logs::LogSummary;

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
    noted(writeln!(io::stdout().lock(), "{text}"));
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
    let _ = writeln!(io::stderr().lock(), "{text}");
}

/// Prints one JSON document.
pub fn print_json(document: &Value) {
    print(format_args!("{document:#}"));
}

/// A number with `digits` significant digits, for tables.
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let magnitude = value.abs().log10().floor() as i64;
    let decimals = (digits as i64 - 1 - magnitude).clamp(0, 9) as usize;
    format!("{value:.decimals$}")
}

/// What to know about the log.
pub fn log_json(log: &LogSummary) -> Value {
    json!({"rows": log.rows, "duration_s": log.duration_s, "rate_hz": log.rate_hz, "dropped_repeats": log.dropped_repeats})
}

#[cfg(test)]
mod tests {
    use super::significant;

    #[test]
    fn three_significant_digits() {
        assert_eq!(significant(24.1567, 3), "24.2");
        assert_eq!(significant(0.012345, 3), "0.0123");
        assert_eq!(significant(1234.5, 3), "1234");
        assert_eq!(significant(0.0, 3), "0");
    }
}
