//! A CSV file as lines and cells: one row is one line, cells are split at the delimiter, quotes protect it.
//!
//! Hand-written because errors must name the line an editor shows; blank lines are skipped and still counted.
//! Leaves out: line breaks inside quotes (an unclosed quote is an error of its line).

use std::io::{BufRead, Read};
use std::ops::Range;
use std::path::Path;

use crate::error::{LogError, shown};

/// What some editors and spreadsheets put before UTF-8 text.
pub const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";

/// The longest line accepted. A row of numbers has a few kilobytes; a file without line ends is no CSV.
const LONGEST_LINE_BYTES: u64 = 1 << 20;

/// The lines with content of a text file, one buffer for all.
pub struct Lines<'p, R> {
    reader: R,
    buffer: Vec<u8>,
    /// The name that errors show.
    path: &'p Path,
    /// Number of the current line, from 1.
    pub number: u64,
    /// Whether the current line ended with a line feed.
    ended: bool,
}

impl<'p, R: BufRead> Lines<'p, R> {
    /// Lines of `reader`; errors name `path`.
    pub fn new(reader: R, path: &'p Path) -> Self {
        Self { reader, buffer: Vec::new(), path, number: 0, ended: true }
    }

    /// Moves to the next line that is not blank; `false` at the end of the file.
    pub fn advance(&mut self) -> Result<bool, LogError> {
        loop {
            self.buffer.clear();
            let mut limited = self.reader.by_ref().take(LONGEST_LINE_BYTES);
            let read = limited.read_until(b'\n', &mut self.buffer).map_err(|e| LogError::io(self.path, "read", e))?;
            if read == 0 {
                return Ok(false);
            }
            self.number += 1;
            self.ended = self.buffer.last() == Some(&b'\n');
            if !self.ended && read as u64 == LONGEST_LINE_BYTES {
                return Err(self.bad_line(format!("longer than {LONGEST_LINE_BYTES} bytes")));
            }
            if self.number == 1 && self.buffer.starts_with(BYTE_ORDER_MARK) {
                self.buffer.drain(..BYTE_ORDER_MARK.len());
            }
            if !self.text().is_empty() {
                return Ok(true);
            }
        }
    }

    /// The current line without surrounding spaces, line ending and byte-order mark.
    pub fn text(&self) -> &[u8] {
        self.buffer.trim_ascii()
    }

    /// Column names and delimiter of the first line.
    pub fn header(&mut self) -> Result<(Vec<String>, u8), LogError> {
        if !self.advance()? {
            return Err(LogError::Empty { path: self.path.to_path_buf() });
        }
        header_names(self.text()).ok_or_else(|| self.bad_line("the header has an unclosed quote or is not UTF-8"))
    }

    /// At the end of the file: what to suspect if the last line has no line feed.
    pub fn cut_off(&self) -> Option<String> {
        (!self.ended).then(|| format!("line {} has no line ending: the file may be cut off", self.number))
    }

    /// An error about the whole current line.
    pub fn bad_line(&self, detail: impl Into<String>) -> LogError {
        LogError::BadLine { path: self.path.to_path_buf(), line: self.number, detail: detail.into() }
    }

    /// An error about a cell of the current line.
    pub fn bad_cell(&self, column: &str, cell: &[u8]) -> LogError {
        let (path, column) = (self.path.to_path_buf(), column.to_owned());
        LogError::BadCell { path, line: self.number, column, value: shown(cell) }
    }
}

/// Which cells of every line are read, and what errors call them.
pub struct RowLayout {
    /// Cells in a line.
    pub cell_count: usize,
    /// Comma, semicolon or tab.
    pub delimiter: u8,
    /// Name of each column read, and its position in a line.
    pub columns: Vec<(String, usize)>,
}

impl RowLayout {
    /// The numbers of the current line, in the order of `columns`; `cells` is scratch.
    pub fn read<R: BufRead>(
        &self,
        lines: &Lines<R>,
        cells: &mut Vec<Range<usize>>,
        row: &mut [f64],
    ) -> Result<(), LogError> {
        let line = lines.text();
        if !split_cells(line, self.delimiter, cells) {
            return Err(lines.bad_line("a quote is not closed"));
        }
        if cells.len() != self.cell_count {
            let (path, line) = (lines.path.to_path_buf(), lines.number);
            return Err(LogError::CellCount { path, line, got: cells.len(), expected: self.cell_count });
        }
        for ((column, position), slot) in self.columns.iter().zip(row) {
            let cell = &line[cells[*position].clone()];
            *slot = parse_number(cell, self.delimiter).ok_or_else(|| lines.bad_cell(column, cell))?;
        }
        Ok(())
    }
}

/// Splits a line into cells, spaces and quotes removed. `false` if a quote is not closed.
pub fn split_cells(line: &[u8], delimiter: u8, cells: &mut Vec<Range<usize>>) -> bool {
    cells.clear();
    let (mut start, mut quoted) = (0, false);
    for (k, &byte) in line.iter().enumerate() {
        if byte == b'"' {
            quoted = !quoted;
        } else if byte == delimiter && !quoted {
            cells.push(trimmed(line, start..k));
            start = k + 1;
        }
    }
    cells.push(trimmed(line, start..line.len()));
    !quoted
}

/// Column names and delimiter of a header line: semicolon if it has one, else comma, else tabulator. `None` if a quote is not closed
/// or the names are not UTF-8.
pub fn header_names(line: &[u8]) -> Option<(Vec<String>, u8)> {
    let delimiter = *[b';', b',', b'\t'].iter().find(|delimiter| line.contains(delimiter)).unwrap_or(&b',');
    let mut cells = Vec::new();
    if !split_cells(line, delimiter, &mut cells) {
        return None;
    }
    let names = cells.into_iter().map(|cell| std::str::from_utf8(&line[cell]).map(str::to_owned));
    Some((names.collect::<Result<_, _>>().ok()?, delimiter))
}

/// A finite number, with decimal comma where the delimiter leaves the comma free.
pub fn parse_number(cell: &[u8], delimiter: u8) -> Option<f64> {
    let text = std::str::from_utf8(cell).ok()?;
    let value = if delimiter != b',' && text.contains(',') { text.replacen(',', ".", 1).parse() } else { text.parse() };
    value.ok().filter(|v: &f64| v.is_finite())
}

/// The range without surrounding spaces, then without one pair of quotes.
fn trimmed(line: &[u8], range: Range<usize>) -> Range<usize> {
    let is_space = |k: usize| line[k].is_ascii_whitespace();
    let (mut start, mut end) = (range.start, range.end);
    while start < end && is_space(start) {
        start += 1;
    }
    while start < end && is_space(end - 1) {
        end -= 1;
    }
    if end - start >= 2 && line[start] == b'"' && line[end - 1] == b'"' { start + 1..end - 1 } else { start..end }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_lose_spaces_and_quotes() {
        let line = b" 1 ,\"a,b\",,\"\"";
        let mut cells = Vec::new();
        assert!(split_cells(line, b',', &mut cells));
        let texts: Vec<&[u8]> = cells.into_iter().map(|cell| &line[cell]).collect();
        assert_eq!(texts, [&b"1"[..], b"a,b", b"", b""]);
        assert!(!split_cells(b"\"a,b", b',', &mut Vec::new()));
    }

    #[test]
    fn numbers_are_finite_and_decimal() {
        assert_eq!(parse_number(b"-1e-3", b','), Some(-1e-3));
        assert_eq!(parse_number(b"1,5", b';'), Some(1.5));
        for text in ["1,5", "", "nan", "inf", "1e999", "0x1", "1.2.3", "\u{ff11}"] {
            assert_eq!(parse_number(text.as_bytes(), b','), None, "{text}");
        }
        assert_eq!(parse_number(b"1,234,5", b';'), None);
    }
}
