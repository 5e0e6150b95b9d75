//! The other end of the loop's ring.

use std::time::Duration;

use tribo_runtime::{RecordDrain, TickRecord};

/// Pause of the reader when the ring is empty.
const PAUSE: Duration = Duration::from_millis(1);

/// Takes the records of a loop until it has ended, shows each to `see` with its tick number, and says how many there were.
pub fn drain<const N: usize>(mut ring: RecordDrain<N>, mut see: impl FnMut(u64, &TickRecord<N>)) -> u64 {
    while !ring.is_finished() {
        while let Some((tick, record)) = ring.pop() {
            see(tick, &record);
        }
        std::thread::sleep(PAUSE);
    }
    ring.received()
}
