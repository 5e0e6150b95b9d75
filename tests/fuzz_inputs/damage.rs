//! Small damages to bytes, the same in every run.

/// Marsaglia's xorshift (marsaglia2003): damages need variety, not quality.
pub struct XorShift(pub u64);

impl XorShift {
    fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % limit as u64) as usize
    }
}

/// `bytes` with one to four bytes changed, removed, inserted or cut off, or a piece of it repeated elsewhere.
pub fn mutated(bytes: &[u8], random: &mut XorShift) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    for _ in 0..=random.below(4) {
        if bytes.is_empty() {
            break;
        }
        let (place, byte) = (random.below(bytes.len()), random.below(256) as u8);
        match random.below(17) {
            0 => drop(bytes.remove(place)),
            1 => bytes.insert(place, byte),
            2 => bytes.truncate(place),
            3 => bytes[place] = *b",;\n\r\"-.e:[{".get(random.below(12)).unwrap_or(&0),
            4..=9 => bytes[place] ^= 1 << random.below(8),
            10 => {
                let piece = bytes[place..bytes.len().min(place + 1 + random.below(64))].to_vec();
                let at = random.below(bytes.len());
                bytes.splice(at..at, piece);
            }
            _ => bytes[place] = byte,
        }
    }
    bytes
}
