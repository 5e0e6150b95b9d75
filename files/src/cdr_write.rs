//! Writing a ROS 2 message: OMG Common Data Representation, version 1 (XCDR1), little endian; [`Cdr`](crate::cdr::Cdr) reads it.

/// The bytes of one message, field by field.
///
/// ```text
/// 00 01 00 00 | fields in order; a number of n bytes starts at a multiple of n, counted after these four bytes
/// text: uint32 length with the final NUL, bytes      sequence: uint32 count, elements
/// ```
///
/// The number of texts and of elements of a sequence is the writer's to say first ([`Self::count`]). Leaves out: wide text, and sequences
/// or texts of 4 GiB, which are cut at that length.
#[derive(Clone, Debug)]
pub struct CdrWriter {
    bytes: Vec<u8>,
}

/// What stands before the fields.
const ENCAPSULATION: [u8; 4] = [0, 1, 0, 0];

impl Default for CdrWriter {
    fn default() -> Self {
        Self { bytes: ENCAPSULATION.to_vec() }
    }
}

impl CdrWriter {
    /// Appends one byte.
    pub fn u8(&mut self, value: u8) -> &mut Self {
        self.bytes.push(value);
        self
    }

    /// Appends a signed number of four bytes.
    pub fn i32(&mut self, value: i32) -> &mut Self {
        self.aligned(value.to_le_bytes())
    }

    /// Appends an unsigned number of four bytes.
    pub fn u32(&mut self, value: u32) -> &mut Self {
        self.aligned(value.to_le_bytes())
    }

    /// Appends a number of double precision.
    pub fn f64(&mut self, value: f64) -> &mut Self {
        self.aligned(value.to_le_bytes())
    }

    /// Appends how many elements follow.
    pub fn count(&mut self, elements: usize) -> &mut Self {
        self.u32(u32::try_from(elements).unwrap_or(u32::MAX))
    }

    /// Appends a text.
    pub fn text(&mut self, text: &str) -> &mut Self {
        self.count(text.len() + 1);
        self.bytes.extend_from_slice(text.as_bytes());
        self.u8(0)
    }

    /// Appends a sequence of texts.
    pub fn texts(&mut self, texts: &[String]) -> &mut Self {
        self.count(texts.len());
        for text in texts {
            self.text(text);
        }
        self
    }

    /// Appends a sequence of numbers.
    pub fn f64s(&mut self, values: &[f64]) -> &mut Self {
        self.count(values.len());
        for value in values {
            self.f64(*value);
        }
        self
    }

    /// Appends `std_msgs/Header`: the time since 1970 (ns), seconds beyond 32 bits cut, and the frame.
    pub fn header(&mut self, stamp_ns: u64, frame_id: &str) -> &mut Self {
        let (seconds, nanoseconds) = (stamp_ns / 1_000_000_000, stamp_ns % 1_000_000_000);
        self.i32(i32::try_from(seconds).unwrap_or(i32::MAX));
        self.u32(nanoseconds as u32).text(frame_id)
    }

    /// The message, with the four bytes in front.
    pub fn finish(self) -> Vec<u8> {
        self.bytes
    }

    fn aligned<const N: usize>(&mut self, bytes: [u8; N]) -> &mut Self {
        let place = self.bytes.len() - ENCAPSULATION.len();
        self.bytes.resize(ENCAPSULATION.len() + place.next_multiple_of(N), 0);
        self.bytes.extend_from_slice(&bytes);
        self
    }
}
