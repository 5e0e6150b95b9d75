//! Opening files for reading, with the errors people meet told apart.

use std::cell::Cell;
use std::fs::{self, File};
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::rc::Rc;

use flate2::bufread::MultiGzDecoder;

use crate::error::LogError;

/// First bytes of a gzip stream.
pub(crate) const GZIP_MAGIC: [u8; 2] = [0x1f, 0x8b];

/// Bytes looked at to know a format, and read at once.
const BUFFER_BYTES: usize = 1 << 16;

/// Opens a file; `expected` says what kind for the error about a directory.
pub(crate) fn open(path: &Path, expected: &'static str) -> Result<File, LogError> {
    let metadata = fs::metadata(path).map_err(|source| LogError::io(path, "open", source))?;
    if metadata.is_dir() {
        return Err(LogError::IsDirectory { path: path.to_path_buf(), expected });
    }
    File::open(path).map_err(|source| LogError::io(path, "open", source))
}

/// A file as text, unpacked if its first bytes are those of gzip. The flag says whether it was.
pub(crate) fn open_text(path: &Path, expected: &'static str) -> Result<(Box<dyn BufRead>, bool), LogError> {
    TextFile::new(path).open(expected)
}

/// A text file that tells how much of it has been read.
pub(crate) struct TextFile<'p> {
    pub path: &'p Path,
    /// Bytes of the file, packed or not, taken since it was opened last.
    taken: Rc<Cell<u64>>,
}

impl<'p> TextFile<'p> {
    pub fn new(path: &'p Path) -> Self {
        Self { path, taken: Rc::default() }
    }

    /// Opens it from its start, unpacked if its first bytes are those of gzip. The flag says whether it was.
    pub fn open(&self, expected: &'static str) -> Result<(Box<dyn BufRead>, bool), LogError> {
        self.taken.set(0);
        let file = Counted { file: open(self.path, expected)?, taken: Rc::clone(&self.taken) };
        let mut reader = BufReader::with_capacity(BUFFER_BYTES, file);
        if peek(self.path, &mut reader)?.starts_with(&GZIP_MAGIC) {
            let unpacked = MultiGzDecoder::new(reader);
            return Ok((Box::new(BufReader::with_capacity(BUFFER_BYTES, unpacked)), true));
        }
        Ok((Box::new(reader), false))
    }

    /// The part of the file that has been read, 0 to 1.
    pub fn part_read(&self) -> f64 {
        let length = fs::metadata(self.path).map_or(0, |metadata| metadata.len());
        if length == 0 { 1.0 } else { (self.taken.get() as f64 / length as f64).min(1.0) }
    }
}

/// A file that counts what is read from it.
struct Counted {
    file: File,
    taken: Rc<Cell<u64>>,
}

impl Read for Counted {
    fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
        let count = self.file.read(bytes)?;
        self.taken.set(self.taken.get() + count as u64);
        Ok(count)
    }
}

/// The next bytes of a reader, without taking them.
pub(crate) fn peek<'a>(path: &Path, reader: &'a mut dyn BufRead) -> Result<&'a [u8], LogError> {
    reader.fill_buf().map_err(|source| LogError::io(path, "read", source))
}

/// Feeds everything a reader holds to `take`, piece by piece.
pub(crate) fn read_pieces(reader: &mut impl Read, mut take: impl FnMut(&[u8])) -> std::io::Result<()> {
    let mut piece = vec![0; BUFFER_BYTES];
    loop {
        match reader.read(&mut piece) {
            Ok(0) => return Ok(()),
            Ok(count) => take(&piece[..count]),
            Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
}
