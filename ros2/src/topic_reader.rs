//! One topic that is read, and how many publish on it.

use rustdds::dds::ReadError;
use rustdds::mio1::event::Source;
use rustdds::no_key::SimpleDataReader;
use rustdds::{DataReaderStatus, StatusEvented};

use crate::raw::{Raw, RawAdapter};

/// Takes messages as bytes.
pub(crate) struct TopicReader {
    reader: SimpleDataReader<Raw, RawAdapter>,
    publishers: usize,
}

impl TopicReader {
    pub fn new(reader: SimpleDataReader<Raw, RawAdapter>) -> Self {
        Self { reader, publishers: 0 }
    }

    /// What becomes readable when a message comes.
    pub fn source(&mut self) -> &mut impl Source {
        &mut self.reader
    }

    /// Has to be called before the messages are taken, so that the next one is announced.
    pub fn begin_taking(&mut self) {
        self.reader.drain_read_notifications();
    }

    /// The next message, if one is there.
    pub fn take(&mut self) -> Option<Vec<u8>> {
        loop {
            match self.reader.try_take_one() {
                Ok(Some(change)) => return Some(change.into_value().0),
                Ok(None) => return None,
                // A message of another encoding; those behind it may be well.
                Err(ReadError::Deserialization { .. } | ReadError::UnknownKey { .. }) => {}
                Err(_) => return None,
            }
        }
    }

    /// Publishers whose messages arrive from now on: a publisher may know of this reader earlier, and what it sends until then is lost.
    pub fn publishers(&mut self) -> usize {
        while let Some(status) = self.reader.try_recv_status() {
            if let DataReaderStatus::SubscriptionMatched { current, .. } = status {
                self.publishers = usize::try_from(current.count()).unwrap_or_default();
            }
        }
        self.publishers
    }
}
