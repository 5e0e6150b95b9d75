//! The seal of a Parquet file: a checksum of the whole file, in a place every Parquet reader skips.
//!
//! ```text
//! bytes 0..4 `PAR1` | 4..12 `TRIBOCRC` | 12..20 CRC-32 of all other bytes, hexadecimal | columns | footer
//! ```
//!
//! Parquet finds everything by offsets in its footer, so bytes after the magic are legal padding. With the seal one
//! changed byte anywhere is found before the Parquet decoder, which may panic on damaged input, sees the file.
//! The key `tribo.seal` and the program name in the footer say that the seal belongs there, so damage to the marker is
//! found as well.

use std::io::{Read, SeekFrom, Write};

use flate2::Crc;

use crate::atomic::Output;
use crate::source::read_pieces;

/// Key of the footer entry that promises a seal.
pub(crate) const SEAL_KEY: &str = "tribo.seal";
/// Value of that entry.
pub(crate) const SEAL_VALUE: &str = "crc32";
/// What a writer puts after the magic, before [`Sealer::close`].
pub(crate) const OPEN_SEAL: &[u8; 16] = b"TRIBOCRC00000000";

const MARKER_START: usize = 4;
const SUM_START: usize = 12;
const SUM_END: usize = 20;

/// What a file says about itself.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Seal {
    /// No marker: a file of another program.
    Absent,
    /// The checksum is right.
    Intact,
    /// The checksum is wrong.
    Broken,
}

/// Bytes on their way to a file that begins with the magic and [`OPEN_SEAL`]; the checksum is put in at the end.
pub(crate) struct Sealer<'o> {
    out: &'o mut dyn Output,
    crc: Crc,
    place: usize,
}

impl<'o> Sealer<'o> {
    pub fn new(out: &'o mut dyn Output) -> Self {
        Self { out, crc: Crc::new(), place: 0 }
    }

    /// Closes the seal.
    pub fn close(self) -> std::io::Result<()> {
        self.out.seek(SeekFrom::Start(SUM_START as u64))?;
        self.out.write_all(&hexadecimal(self.crc.sum()))?;
        self.out.seek(SeekFrom::End(0)).map(|_| ())
    }
}

impl Write for Sealer<'_> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let written = self.out.write(bytes)?;
        let at = |place: usize| place.saturating_sub(self.place).min(written);
        self.crc.update(&bytes[..at(SUM_START)]);
        self.crc.update(&bytes[at(SUM_END)..written]);
        self.place += written;
        Ok(written)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.out.flush()
    }
}

/// Reads a whole file and compares.
pub(crate) fn check(file: &mut impl Read) -> std::io::Result<Seal> {
    let mut head = Vec::with_capacity(SUM_END);
    file.by_ref().take(SUM_END as u64).read_to_end(&mut head)?;
    if head.len() < SUM_END || head[MARKER_START..SUM_START] != OPEN_SEAL[..SUM_START - MARKER_START] {
        return Ok(Seal::Absent);
    }
    let mut crc = Crc::new();
    crc.update(&head[..SUM_START]);
    read_pieces(file, |piece| crc.update(piece))?;
    Ok(if head[SUM_START..] == hexadecimal(crc.sum()) { Seal::Intact } else { Seal::Broken })
}

/// The checksum that a Parquet file of ours carries, eight hexadecimal digits; none of a file of another program. Only the mark is
/// read: whether the content is still the one that was sealed, readers find out.
///
/// # Errors
/// A file that cannot be read.
pub fn seal_of(path: impl AsRef<std::path::Path>) -> std::io::Result<Option<String>> {
    let mut head = Vec::with_capacity(SUM_END);
    std::fs::File::open(path)?.take(SUM_END as u64).read_to_end(&mut head)?;
    let ours = head.len() == SUM_END && head[MARKER_START..SUM_START] == OPEN_SEAL[..SUM_START - MARKER_START];
    Ok(ours.then(|| String::from_utf8_lossy(&head[SUM_START..]).into_owned()))
}

fn hexadecimal(sum: u32) -> [u8; SUM_END - SUM_START] {
    const DIGITS: &[u8; 16] = b"0123456789abcdef";
    std::array::from_fn(|k| DIGITS[(sum >> (28 - 4 * k)) as usize & 0xf])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_single_byte_counts() {
        let whole = b"PAR1TRIBOCRC00000000some columns and a footer PAR1";
        let sealed = |piece: usize| {
            let mut file = std::io::Cursor::new(Vec::new());
            let mut sealer = Sealer::new(&mut file);
            whole.chunks(piece).for_each(|bytes| sealer.write_all(bytes).unwrap());
            sealer.close().unwrap();
            file.into_inner()
        };
        let file = sealed(whole.len());
        for piece in 1..30 {
            assert_eq!(sealed(piece), file, "in pieces of {piece}");
        }
        assert_eq!(check(&mut &file[..]).unwrap(), Seal::Intact);
        for k in 0..file.len() {
            let mut torn = file.clone();
            torn[k] ^= 1;
            let expected = if (MARKER_START..SUM_START).contains(&k) { Seal::Absent } else { Seal::Broken };
            assert_eq!(check(&mut &torn[..]).unwrap(), expected, "byte {k}");
        }
        assert_eq!(check(&mut &file[..10]).unwrap(), Seal::Absent);
    }
}
