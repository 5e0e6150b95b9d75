//! Opening logs for reading, on the disk or in memory, with the errors people meet told apart.

use std::cell::Cell;
use std::fs::{self, File};
use std::io::{BufRead, BufReader, Cursor, Read, Seek, SeekFrom};
use std::path::Path;
use std::rc::Rc;

use bytes::Bytes;
use flate2::bufread::MultiGzDecoder;

use crate::error::LogError;
use crate::limited::Limited;

/// First bytes of a gzip stream.
pub(crate) const GZIP_MAGIC: [u8; 2] = [0x1f, 0x8b];

/// Bytes looked at to know a format, and read at once.
const BUFFER_BYTES: usize = 1 << 16;

/// The bytes of a log, in a file or in memory, and how much of them has been read.
pub struct LogFile<'p> {
    /// The file; of bytes in memory the name that errors show.
    pub path: &'p Path,
    /// The content, where it is in memory.
    memory: Option<Bytes>,
    /// Bytes, packed or not, taken as text since it was opened last.
    taken: Rc<Cell<u64>>,
    /// Who hears how far reading has come.
    watch: Option<Rc<Watch>>,
}

/// Who hears the part of a file that has been read, 0 to 1, and stops by saying false.
pub(crate) struct Watch {
    hear: Rc<dyn Fn(f64) -> bool>,
    /// Part that the next opening of the file begins at, and ends at.
    stretch: Cell<(f64, f64)>,
    /// Whether somebody has stopped.
    pub stopped: Cell<bool>,
}

impl Watch {
    /// The part of the stretch that has been read; an error where somebody stops.
    fn hear(&self, part: f64) -> std::io::Result<()> {
        let (from, to) = self.stretch.get();
        if (self.hear)(from + (to - from) * part.clamp(0.0, 1.0)) {
            return Ok(());
        }
        self.stopped.set(true);
        Err(std::io::Error::other("stopped"))
    }
}

/// Bytes between two words to whoever watches.
const WORD_BYTES: u64 = 1 << 20;

impl<'p> LogFile<'p> {
    /// A file on the disk.
    pub fn new(path: &'p Path) -> Self {
        Self { path, memory: None, taken: Rc::default(), watch: None }
    }

    /// The same file, watched by `hear`.
    pub fn watched(self, hear: Rc<dyn Fn(f64) -> bool>) -> Self {
        let (stretch, stopped) = (Cell::new((0.0, 1.0)), Cell::new(false));
        Self { watch: Some(Rc::new(Watch { hear, stretch, stopped })), ..self }
    }

    /// Whether whoever watches has stopped it.
    pub fn stopped(&self) -> bool {
        self.watch.as_ref().is_some_and(|watch| watch.stopped.get())
    }

    /// Says that reading goes on from this part of the work to that.
    pub fn stretch(&self, from: f64, to: f64) {
        if let Some(watch) = &self.watch {
            watch.stretch.set((from, to));
        }
    }

    /// Says that this part of the stretch is done; an error where somebody stops.
    pub fn done(&self, part: f64) -> std::io::Result<()> {
        self.watch.as_ref().map_or(Ok(()), |watch| watch.hear(part))
    }

    /// Bytes in memory under a name.
    pub fn in_memory(bytes: Bytes, name: &'p Path) -> Self {
        Self { path: name, memory: Some(bytes), taken: Rc::default(), watch: None }
    }

    /// Opens it from its start; `expected` says what kind for the error about a directory.
    pub fn open(&self, expected: &'static str) -> Result<RawBytes, LogError> {
        if let Some(bytes) = &self.memory {
            return Ok(RawBytes::Memory(Cursor::new(bytes.clone())));
        }
        let metadata = fs::metadata(self.path).map_err(|source| LogError::io(self.path, "open", source))?;
        if metadata.is_dir() {
            return Err(LogError::IsDirectory { path: self.path.to_path_buf(), expected });
        }
        File::open(self.path).map(RawBytes::File).map_err(|source| LogError::io(self.path, "open", source))
    }

    /// Opens it as text from its start, unpacked if its first bytes are those of gzip. The flag says whether it was.
    pub fn open_text(&self, expected: &'static str) -> Result<(Box<dyn BufRead>, bool), LogError> {
        let mut reader = BufReader::with_capacity(BUFFER_BYTES, self.open_counted(expected)?);
        if peek(self.path, &mut reader)?.starts_with(&GZIP_MAGIC) {
            let unpacked = Limited::new(MultiGzDecoder::new(reader), self.length().unwrap_or(0));
            return Ok((Box::new(BufReader::with_capacity(BUFFER_BYTES, unpacked)), true));
        }
        Ok((Box::new(reader), false))
    }

    /// Opens it from its start, counting what is read and telling whoever watches.
    pub fn open_counted(&self, expected: &'static str) -> Result<Counted, LogError> {
        self.taken.set(0);
        let length = self.length().unwrap_or(0).max(1);
        let (taken, watch) = (Rc::clone(&self.taken), self.watch.clone());
        Ok(Counted { raw: self.open(expected)?, length, taken, watch, told: 0 })
    }

    /// Number of bytes.
    pub fn length(&self) -> std::io::Result<u64> {
        match &self.memory {
            Some(bytes) => Ok(bytes.len() as u64),
            None => fs::metadata(self.path).map(|metadata| metadata.len()),
        }
    }

    /// The part of the text that has been read, 0 to 1.
    pub fn part_read(&self) -> f64 {
        let length = self.length().unwrap_or(0);
        if length == 0 { 1.0 } else { (self.taken.get() as f64 / length as f64).min(1.0) }
    }
}

/// Bytes from their start, as they are.
pub enum RawBytes {
    /// On disk.
    File(File),
    /// In memory.
    Memory(Cursor<Bytes>),
}

impl Read for RawBytes {
    fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
        match self {
            Self::File(file) => file.read(bytes),
            Self::Memory(memory) => memory.read(bytes),
        }
    }
}

impl Seek for RawBytes {
    fn seek(&mut self, place: SeekFrom) -> std::io::Result<u64> {
        match self {
            Self::File(file) => file.seek(place),
            Self::Memory(memory) => memory.seek(place),
        }
    }
}

/// Bytes that count what is read of them.
pub struct Counted {
    raw: RawBytes,
    length: u64,
    taken: Rc<Cell<u64>>,
    watch: Option<Rc<Watch>>,
    /// Bytes that were taken when whoever watches heard of it last.
    told: u64,
}

impl Read for Counted {
    fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
        let count = self.raw.read(bytes)?;
        let taken = self.taken.get() + count as u64;
        self.taken.set(taken);
        if let Some(watch) = self.watch.as_ref().filter(|_| taken >= self.told + WORD_BYTES) {
            self.told = taken;
            watch.hear(taken as f64 / self.length as f64)?;
        }
        Ok(count)
    }
}

/// The next bytes of a reader, without taking them.
pub fn peek<'a>(path: &Path, reader: &'a mut dyn BufRead) -> Result<&'a [u8], LogError> {
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
