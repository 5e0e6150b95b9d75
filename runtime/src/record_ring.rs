//! Tick records on their way out of the loop.

use rtrb::{Consumer, Producer, RingBuffer};

use crate::TickRecord;

/// One end of a bounded ring: the loop's. Pushing takes no lock, allocates nothing and never waits.
#[derive(Debug)]
pub struct RecordSink<const N: usize> {
    producer: Producer<(u64, TickRecord<N>)>,
    dropped: u64,
}

/// The other end: another thread's, which finds from the numbers of the periods what it has missed.
#[derive(Debug)]
pub struct RecordDrain<const N: usize> {
    consumer: Consumer<(u64, TickRecord<N>)>,
    received: u64,
}

/// A ring for this many records. When it is full the newest record is dropped and counted: the loop does not wait for a
/// reader that is slow, and what was in the ring stays in order.
pub fn record_ring<const N: usize>(capacity: usize) -> (RecordSink<N>, RecordDrain<N>) {
    let (producer, consumer) = RingBuffer::new(capacity);
    (RecordSink { producer, dropped: 0 }, RecordDrain { consumer, received: 0 })
}

impl<const N: usize> RecordSink<N> {
    /// Puts the record of tick `tick` into the ring, or drops it.
    #[inline]
    pub fn push(&mut self, tick: u64, record: TickRecord<N>) {
        self.dropped += u64::from(self.producer.push((tick, record)).is_err());
    }

    /// Records dropped since the start.
    pub fn dropped(&self) -> u64 {
        self.dropped
    }
}

impl<const N: usize> RecordDrain<N> {
    /// The oldest record in the ring with its tick number, if there is one.
    #[inline]
    pub fn pop(&mut self) -> Option<(u64, TickRecord<N>)> {
        let next = self.consumer.pop().ok();
        self.received += u64::from(next.is_some());
        next
    }

    /// Whether the loop has ended and all of its records have been taken.
    pub fn is_finished(&self) -> bool {
        // In this order: a record pushed between the two questions is seen.
        self.consumer.is_abandoned() && self.consumer.is_empty()
    }

    /// Records taken.
    pub fn received(&self) -> u64 {
        self.received
    }

    /// Records that never arrived of a loop that ran `ticks` ticks.
    pub fn lost_of(&self, ticks: u64) -> u64 {
        ticks - self.received.min(ticks)
    }
}
