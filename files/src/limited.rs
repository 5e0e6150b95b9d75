//! Text that unpacks to no more than its file justifies.

use std::io::{self, Read};

/// The largest text that any packed file may hold (bytes): an hour of a still arm's rows, or a minute of a recorded one's, each 1 kHz.
const LEAST_TEXT_BYTES: u64 = 256 << 20;

/// The most text per packed byte beyond that: what is measured has about four.
const TEXT_PER_BYTE: u64 = 32;

/// A reader of unpacked bytes that ends with an error where a file of so many bytes holds more than the larger of both limits.
pub struct Limited<R> {
    unpacked: R,
    packed_bytes: u64,
    most_bytes: u64,
    taken: u64,
}

impl<R: Read> Limited<R> {
    /// `unpacked` comes out of `packed_bytes` bytes.
    pub fn new(unpacked: R, packed_bytes: u64) -> Self {
        let most_bytes = packed_bytes.saturating_mul(TEXT_PER_BYTE).max(LEAST_TEXT_BYTES);
        Self { unpacked, packed_bytes, most_bytes, taken: 0 }
    }
}

impl<R: Read> Read for Limited<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let count = self.unpacked.read(bytes)?;
        self.taken += count as u64;
        if self.taken > self.most_bytes {
            let (most, packed) = (self.most_bytes, self.packed_bytes);
            let detail = format!("unpacks to more than {most} bytes from {packed}; unpack it first if that is meant");
            return Err(io::Error::new(io::ErrorKind::InvalidData, detail));
        }
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_within_the_limit_is_left_alone() {
        let (most, larger) = (LEAST_TEXT_BYTES, LEAST_TEXT_BYTES / 16);
        for (packed, text, ends) in [(10, most, true), (10, most + 1, false), (larger, 32 * larger, true)] {
            let mut limited = Limited::new(io::repeat(b'0').take(text), packed);
            // In large pieces, for time's sake.
            let mut piece = vec![0; 1 << 24];
            let end = loop {
                match limited.read(&mut piece) {
                    Ok(0) => break true,
                    Ok(_) => {}
                    Err(error) => {
                        assert!(error.to_string().contains("unpacks to more than 268435456 bytes from 10"), "{error}");
                        break false;
                    }
                }
            };
            assert_eq!(end, ends, "{packed} {text}");
        }
    }
}
