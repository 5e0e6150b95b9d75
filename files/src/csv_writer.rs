//! CSV text written in batches of rows.
//!
//! Numbers in the shortest form that reads back to the same bits (`{:?}`), with exponents where shorter.

use std::io::{self, Write};
use std::path::Path;

use flate2::Compression;
use flate2::write::GzEncoder;

use crate::atomic::Output;

/// Plain or packed text.
enum Text<'o> {
    Plain(&'o mut dyn Output),
    Packed(GzEncoder<&'o mut dyn Output>),
}

/// A CSV file being written.
pub struct CsvWriter<'o> {
    text: Text<'o>,
    line: Vec<u8>,
}

impl<'o> CsvWriter<'o> {
    /// Begins with the header; gzip if the name of the file ends in `.gz`.
    pub fn new(out: &'o mut dyn Output, path: &Path, names: &[String]) -> io::Result<Self> {
        let packed = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gz"));
        // Noise hardly packs: the best level takes six times as long for files a twelfth smaller.
        let text = if packed { Text::Packed(GzEncoder::new(out, Compression::fast())) } else { Text::Plain(out) };
        let mut writer = Self { text, line: Vec::new() };
        writer.line.extend_from_slice(names.join(",").as_bytes());
        writer.end_line()?;
        Ok(writer)
    }

    /// Appends rows, given by columns of one length.
    pub fn write(&mut self, columns: &[&[f64]]) -> io::Result<()> {
        for row in 0..columns.first().map_or(0, |column| column.len()) {
            for column in columns {
                write!(self.line, "{:?},", column[row])?;
            }
            self.line.pop();
            self.end_line()?;
        }
        Ok(())
    }

    /// Ends the file; the line feed of the last row is there already.
    pub fn finish(self) -> io::Result<()> {
        match self.text {
            Text::Plain(_) => Ok(()),
            Text::Packed(encoder) => encoder.finish().map(|_| ()),
        }
    }

    fn end_line(&mut self) -> io::Result<()> {
        self.line.push(b'\n');
        match &mut self.text {
            Text::Plain(out) => out.write_all(&self.line)?,
            Text::Packed(encoder) => encoder.write_all(&self.line)?,
        }
        self.line.clear();
        Ok(())
    }
}
