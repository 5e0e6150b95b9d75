//! Independent uniform points.

use crate::random::{Purpose, stream, uniform_point};

/// `u ~ U[0,1)^d`, drawn from the stream of (seed, index); unit coordinates.
pub fn uniform_random_point(dimension: usize, index: usize, seed: u64) -> Vec<f64> {
    uniform_point(&mut stream(seed, index, Purpose::Design), dimension)
}
