//! Bytes of a ROS 2 message: OMG Common Data Representation, version 1 (XCDR1).
//!
//! ```text
//! 00 | 00 big, 01 little endian | 00 00 | fields in order
//! a number of n bytes starts at a multiple of n, counted after these four bytes
//! text: uint32 length with the final NUL, bytes      sequence: uint32 count, elements      message without fields: 1 byte
//! ```
//!
//! Every number becomes an `f64` (integers beyond 2^53 are rounded). Nothing is allocated before the bytes for it are there.
//! Leaves out: parameter lists (PL_CDR) and XCDR2, which ROS 2 does not record.

use crate::ros2_layout::{Count, Kind, Node};

/// What the fields bound to one slot held.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Slot {
    /// Numbers, in the order of the message.
    pub numbers: Vec<f64>,
    /// Texts, likewise.
    pub texts: Vec<String>,
}

/// A cursor over the bytes of one message.
pub struct Cdr<'m> {
    /// The message without its first four bytes.
    bytes: &'m [u8],
    place: usize,
    big_endian: bool,
}

/// Why a message could not be read.
type Outcome<T> = Result<T, String>;

impl<'m> Cdr<'m> {
    /// Begins a message.
    pub fn new(message: &'m [u8]) -> Outcome<Self> {
        match message {
            [0, endian @ (0 | 1), _, _, bytes @ ..] => Ok(Self { bytes, place: 0, big_endian: *endian == 0 }),
            [_, kind, ..] if message.len() >= 4 => {
                Err(format!("encapsulation {kind:#04x} is not plain CDR (0x00, 0x01)"))
            }
            _ => Err(format!("{} bytes are no CDR message", message.len())),
        }
    }

    /// Reads the fields of a message in order; those with a slot are kept.
    pub fn read(&mut self, nodes: &[Node], slots: &mut [Slot]) -> Outcome<()> {
        if nodes.is_empty() {
            return self.take(1).map(|_| ());
        }
        for node in nodes {
            self.field(node, slots).map_err(|detail| match &node.kind {
                Kind::Struct(_) => format!("{}.{detail}", node.name),
                _ => format!("{}: {detail}", node.name),
            })?;
        }
        Ok(())
    }

    fn field(&mut self, node: &Node, slots: &mut [Slot]) -> Outcome<()> {
        let count = match node.count {
            Count::One => 1,
            Count::Fixed(count) => count,
            Count::Sequence => self.number(&Kind::U32)? as usize,
        };
        // Whatever it is, an element has a byte: a count beyond the bytes left is damage, and is refused before the loop.
        if count > self.bytes.len() - self.place {
            return Err(format!("{count} elements in {} bytes", self.bytes.len() - self.place));
        }
        let mut slot = node.slot.and_then(|slot| slots.get_mut(slot));
        match &node.kind {
            Kind::Struct(inner) => {
                for _ in 0..count {
                    self.read(inner, slots)?;
                }
            }
            Kind::Text => {
                for _ in 0..count {
                    let text = self.text()?;
                    if let Some(slot) = &mut slot {
                        slot.texts.push(String::from_utf8_lossy(text).into_owned());
                    }
                }
            }
            Kind::WideText => {
                for _ in 0..count {
                    let characters = self.number(&Kind::U32)? as usize;
                    self.take(characters.saturating_mul(4))?;
                }
            }
            kind => {
                for _ in 0..count {
                    let number = self.number(kind)?;
                    if let Some(slot) = &mut slot {
                        slot.numbers.push(number);
                    }
                }
            }
        }
        Ok(())
    }

    /// One number of a primitive type.
    fn number(&mut self, kind: &Kind) -> Outcome<f64> {
        Ok(match kind {
            Kind::Bool | Kind::U8 => f64::from(u8::from_le_bytes(self.aligned()?)),
            Kind::I8 => f64::from(i8::from_le_bytes(self.aligned()?)),
            Kind::U16 => f64::from(u16::from_le_bytes(self.aligned()?)),
            Kind::I16 => f64::from(i16::from_le_bytes(self.aligned()?)),
            Kind::U32 => f64::from(u32::from_le_bytes(self.aligned()?)),
            Kind::I32 => f64::from(i32::from_le_bytes(self.aligned()?)),
            Kind::U64 => u64::from_le_bytes(self.aligned()?) as f64,
            Kind::I64 => i64::from_le_bytes(self.aligned()?) as f64,
            Kind::F32 => f64::from(f32::from_le_bytes(self.aligned()?)),
            Kind::F64 => f64::from_le_bytes(self.aligned()?),
            Kind::Text | Kind::WideText | Kind::Struct(_) => return Err("is no number".to_owned()),
        })
    }

    /// The next `N` bytes at a multiple of `N`, least significant first.
    fn aligned<const N: usize>(&mut self) -> Outcome<[u8; N]> {
        self.place = self.place.next_multiple_of(N).min(self.bytes.len());
        let mut bytes = [0; N];
        bytes.copy_from_slice(self.take(N)?);
        if self.big_endian {
            bytes.reverse();
        }
        Ok(bytes)
    }

    fn text(&mut self) -> Outcome<&'m [u8]> {
        let length = self.number(&Kind::U32)? as usize;
        let bytes = self.take(length)?;
        Ok(bytes.strip_suffix(b"\0").unwrap_or(bytes))
    }

    fn take(&mut self, count: usize) -> Outcome<&'m [u8]> {
        let end = self.place.checked_add(count).filter(|&end| end <= self.bytes.len());
        let end = end.ok_or_else(|| format!("needs {count} bytes, {} are left", self.bytes.len() - self.place))?;
        let taken = &self.bytes[self.place..end];
        self.place = end;
        Ok(taken)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ros2_layout::{bind, expand};

    /// `bool b; float64 x; string s; int16[] v; Empty e; uint8 last` with x = 1.5, s = "ab", v = [-1, 2].
    fn little() -> Vec<u8> {
        let x = 1.5_f64.to_le_bytes();
        [&[0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0][..], &x, b"\x03\0\0\0ab\0\0", b"\x02\0\0\0\xff\xff\x02\0", &[0, 9]]
            .concat()
    }

    const TEXT: &str = "bool b\nfloat64 x\nstring s\nint16[] v\nEmpty e\nuint8 last\n===\nMSG: p/Empty\n# nothing\n";

    fn read(bytes: &[u8]) -> Outcome<Vec<Slot>> {
        let mut nodes = expand("p/M", TEXT).unwrap();
        for (slot, path) in ["x", "s", "v", "last"].into_iter().enumerate() {
            assert!(bind(&mut nodes, path, slot));
        }
        let mut slots = vec![Slot::default(); 4];
        Cdr::new(bytes)?.read(&nodes, &mut slots).map(|()| slots)
    }

    #[test]
    fn numbers_are_aligned_and_empty_messages_take_a_byte() {
        let slots = read(&little()).unwrap();
        assert_eq!(slots[0].numbers, [1.5]);
        assert_eq!(slots[1].texts, ["ab"]);
        assert_eq!((&slots[2].numbers[..], &slots[3].numbers[..]), (&[-1.0, 2.0][..], &[9.0][..]));
        let x = 1.5_f64.to_be_bytes();
        let big =
            [&[0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0][..], &x, b"\0\0\0\x03ab\0\0", b"\0\0\0\x02\xff\xff\0\x02", &[0, 9]];
        assert_eq!(read(&big.concat()).unwrap(), slots);
    }

    #[test]
    fn every_cut_is_an_error_with_the_field() {
        let whole = little();
        for length in 0..whole.len() {
            assert!(read(&whole[..length]).is_err(), "{length}");
        }
        assert_eq!(read(&whole[..22]).unwrap_err(), "s: needs 4 bytes, 2 are left");
        let mut long = whole;
        long[28..32].copy_from_slice(&u32::MAX.to_le_bytes());
        assert_eq!(read(&long).unwrap_err(), "v: 4294967295 elements in 6 bytes");
        assert!(read(&[0, 7, 0, 0, 1]).unwrap_err().contains("0x07 is not plain CDR"));
    }
}
