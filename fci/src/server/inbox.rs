//! Messages out of a stream of bytes.

use std::io::{self, Read};
use std::net::TcpStream;

use franka::wire::HeaderLayout;

/// Longest request (bytes): the longest of both versions has 424.
const LONGEST: usize = 4096;

/// A message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Message<'a> {
    pub(crate) command: u32,
    pub(crate) id: u32,
    pub(crate) payload: &'a [u8],
}

/// What reading brought.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Arrival {
    /// Nothing beyond what may be in the inbox.
    Nothing,
    /// Bytes.
    Bytes,
    /// The end of the stream.
    End,
}

/// Collects bytes until messages are whole.
#[derive(Debug)]
pub(crate) struct Inbox {
    layout: HeaderLayout,
    bytes: [u8; LONGEST],
    filled: usize,
    /// Bytes of the message that was taken last.
    taken: usize,
}

impl Inbox {
    pub(crate) fn new(layout: HeaderLayout) -> Self {
        Self { layout, bytes: [0; LONGEST], filled: 0, taken: 0 }
    }

    /// Reads what is there without waiting.
    pub(crate) fn fill(&mut self, stream: &mut TcpStream) -> io::Result<Arrival> {
        self.forget_taken();
        match stream.read(&mut self.bytes[self.filled..]) {
            Ok(0) => Ok(Arrival::End),
            Ok(count) => {
                self.filled += count;
                Ok(Arrival::Bytes)
            }
            Err(error) if matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted) => {
                Ok(Arrival::Nothing)
            }
            Err(error) => Err(error),
        }
    }

    /// The next whole message; an error for a length that no message has.
    pub(crate) fn next(&mut self) -> Result<Option<Message<'_>>, Nonsense> {
        self.forget_taken();
        let Some((command, id, size)) = self.layout.decode_header(&self.bytes[..self.filled]) else { return Ok(None) };
        let size = size as usize;
        let header = self.layout.header_len();
        if !(header..=LONGEST).contains(&size) {
            return Err(Nonsense);
        }
        if self.filled < size {
            return Ok(None);
        }
        self.taken = size;
        Ok(Some(Message { command, id, payload: &self.bytes[header..size] }))
    }

    fn forget_taken(&mut self) {
        self.bytes.copy_within(self.taken..self.filled, 0);
        self.filled -= self.taken;
        self.taken = 0;
    }
}

/// Bytes that are no message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Nonsense;
