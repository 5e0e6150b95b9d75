//! Tables and JSON on standard output, messages on standard error.

use comfy_table::{CellAlignment, Table, presets};
use serde_json::{Value, json};
use tribo_logs::LogSummary;

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

/// Prints text and a newline. A reader that has gone (`tribo … | head`) is no error of ours.
pub fn print(text: impl std::fmt::Display) {
    let _ = write_line(&mut std::io::stdout().lock(), Form::Text, text);
}

/// Prints one JSON document.
pub fn print_json(document: &Value) {
    let _ = write_line(&mut std::io::stdout().lock(), Form::Json, format_args!("{document:#}"));
}

/// Says something on standard error; nobody may be listening.
pub fn tell(text: impl std::fmt::Display) {
    let _ = write_line(&mut std::io::stderr().lock(), Form::Text, text);
}

/// Says something on standard error, as `eprintln!` does, with control characters written out.
macro_rules! say {
    ($($part:tt)*) => { $crate::output::tell(format_args!($($part)*)) };
}
pub(crate) use say;

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
