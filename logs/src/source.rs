//! Opening files for reading, with the errors people meet told apart.

use std::fs::{self, File};
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

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
    let mut reader = BufReader::with_capacity(BUFFER_BYTES, open(path, expected)?);
    if peek(path, &mut reader)?.starts_with(&GZIP_MAGIC) {
        let unpacked = MultiGzDecoder::new(reader);
        return Ok((Box::new(BufReader::with_capacity(BUFFER_BYTES, unpacked)), true));
    }
    Ok((Box::new(reader), false))
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
