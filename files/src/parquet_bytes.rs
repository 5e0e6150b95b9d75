//! The bytes of a Parquet file, on the disk or in memory.

use std::fs::File;
use std::io::Read;
use std::sync::Arc;

use bytes::Bytes;
use parquet::errors::Result;
use parquet::file::reader::{ChunkReader, Length};

use crate::source::RawBytes;

/// What the decoder reads from: one type, so that the decoder is compiled once. Clones share the file.
#[derive(Clone)]
pub enum ParquetBytes {
    /// On disk.
    File(Arc<File>),
    /// In memory.
    Memory(Bytes),
}

impl ParquetBytes {
    /// Those of an open file, from its start wherever it stands.
    pub fn of(raw: RawBytes) -> Self {
        match raw {
            RawBytes::File(file) => Self::File(Arc::new(file)),
            RawBytes::Memory(memory) => Self::Memory(memory.into_inner()),
        }
    }
}

impl Length for ParquetBytes {
    fn len(&self) -> u64 {
        match self {
            Self::File(file) => Length::len(file.as_ref()),
            Self::Memory(bytes) => bytes.len() as u64,
        }
    }
}

impl ChunkReader for ParquetBytes {
    type T = Box<dyn Read>;

    fn get_read(&self, start: u64) -> Result<Self::T> {
        Ok(match self {
            Self::File(file) => Box::new(ChunkReader::get_read(file.as_ref(), start)?),
            Self::Memory(bytes) => Box::new(ChunkReader::get_read(bytes, start)?),
        })
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<Bytes> {
        match self {
            Self::File(file) => file.get_bytes(start, length),
            Self::Memory(bytes) => bytes.get_bytes(start, length),
        }
    }
}
