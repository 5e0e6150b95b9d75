//! Streams of random numbers that depend on (seed, trial, purpose) and on nothing else.

use rand::RngExt;
use rand_pcg::Pcg64;

/// Why a stream is drawn; two purposes never share numbers.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Purpose {
    Design = 1,
    FitStarts = 2,
    Candidates = 3,
    Perturbations = 4,
    Samples = 5,
}

/// SplitMix64 finaliser  `z ← (z ⊕ z≫30)·c1; z ← (z ⊕ z≫27)·c2; z ⊕ z≫31`  (steele2014).
fn mix(word: u64) -> u64 {
    let z = word.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// PCG64 whose state is hashed from `(seed, trial)` and whose stream is the purpose.
pub(crate) fn stream(seed: u64, trial: usize, purpose: Purpose) -> Pcg64 {
    let high = mix(mix(seed) ^ trial as u64);
    let low = mix(high ^ purpose as u64);
    Pcg64::new((u128::from(high) << 64) | u128::from(low), purpose as u128)
}

/// A 32-bit key for the hash-based Owen scrambling of `sobol_burley`.
pub(crate) fn scramble_key(seed: u64, trial: usize, purpose: Purpose) -> u32 {
    (mix(mix(mix(seed) ^ trial as u64) ^ purpose as u64) >> 32) as u32
}

/// A point of the unit cube `[0, 1)^d`, coordinates in order.
pub(crate) fn uniform_point(rng: &mut Pcg64, dimension: usize) -> Vec<f64> {
    (0..dimension).map(|_| rng.random::<f64>()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_repeat_and_differ() {
        let draw = |seed, trial, purpose| uniform_point(&mut stream(seed, trial, purpose), 4);
        assert_eq!(draw(1, 2, Purpose::Design), draw(1, 2, Purpose::Design));
        assert_ne!(draw(1, 2, Purpose::Design), draw(1, 2, Purpose::Candidates));
        assert_ne!(draw(1, 2, Purpose::Design), draw(1, 3, Purpose::Design));
        assert_ne!(draw(1, 2, Purpose::Design), draw(2, 2, Purpose::Design));
        assert_ne!(draw(1, 2, Purpose::Design), draw(2, 1, Purpose::Design));
    }
}
