//! Draws from one seed.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// A random stream with the draws that cases need.
#[derive(Clone, Debug)]
pub(super) struct Chance(Pcg64);

impl Chance {
    /// The stream number `stream` of a seed: draws of one stream do not shift another.
    pub fn new(seed: u64, stream: u64) -> Self {
        Self(Pcg64::seed_from_u64(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ (stream << 48)))
    }

    /// Uniform.
    pub fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.0.random_range(0.0..1.0)
    }

    /// Uniform in the logarithm.
    pub fn log_between(&mut self, least: f64, most: f64) -> f64 {
        self.between(least.ln(), most.ln()).exp()
    }

    /// True with this probability.
    pub fn happens(&mut self, probability: f64) -> bool {
        self.0.random_range(0.0..1.0) < probability
    }

    /// −1 or 1.
    pub fn side(&mut self) -> f64 {
        if self.happens(0.5) { 1.0 } else { -1.0 }
    }

    /// One of several; `items` is not empty.
    pub fn pick<T: Copy>(&mut self, items: &[T]) -> T {
        items[self.0.random_range(0..items.len())]
    }

    /// A seed for something else.
    pub fn seed(&mut self) -> u64 {
        self.0.random_range(0..u64::MAX >> 12)
    }

    /// A direction in space.
    pub fn direction(&mut self) -> [f64; 3] {
        let z = self.between(-1.0, 1.0);
        let (s, c) = self.between(0.0, std::f64::consts::TAU).sin_cos();
        let r = (1.0 - z * z).sqrt();
        [r * c, r * s, z]
    }
}
