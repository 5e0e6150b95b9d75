//! Low-discrepancy points.

use sobol_burley::sample;

use crate::random::{Purpose, scramble_key};

/// Dimensions of one table of direction numbers (`sobol_burley` 0.5).
const TABLE_DIMENSIONS: usize = 256;
/// Longest sequence of one scramble (`sobol_burley` 0.5).
const SEQUENCE_LENGTH: usize = 1 << 16;

/// Point `index` of the Owen-scrambled Sobol sequence of `seed` (burley2020), unit coordinates in `[0, 1)`.
///
/// Every 2^k-aligned block of 2^k points is a (t, m, d)-net. Values have the 24 bits of `f32`.
/// Beyond 256 coordinates or 65536 points a new scramble is padded on, as Burley describes.
pub fn sobol_point(dimension: usize, index: usize, seed: u64) -> Vec<f64> {
    let key = scramble_key(seed, index / SEQUENCE_LENGTH, Purpose::Design);
    scrambled_sobol(dimension, index % SEQUENCE_LENGTH, key)
}

/// The same sequence for a given scrambling key; `index < 65536`.
pub(crate) fn scrambled_sobol(dimension: usize, index: usize, key: u32) -> Vec<f64> {
    let coordinate = |i: usize| {
        let padded_key = key.wrapping_add((i / TABLE_DIMENSIONS) as u32);
        f64::from(sample(index as u32, (i % TABLE_DIMENSIONS) as u32, padded_key))
    };
    (0..dimension).map(coordinate).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sixteen_points_fall_into_sixteen_intervals_of_every_coordinate() {
        for seed in 0..5 {
            for axis in 0..50 {
                let mut cells: Vec<usize> = (0..16).map(|i| (sobol_point(50, i, seed)[axis] * 16.0) as usize).collect();
                cells.sort_unstable();
                assert_eq!(cells, (0..16).collect::<Vec<_>>(), "seed {seed}, axis {axis}");
            }
        }
    }

    #[test]
    fn wide_and_long_requests_stay_in_the_cube() {
        let point = sobol_point(600, SEQUENCE_LENGTH + 3, 1);
        assert_eq!(point.len(), 600);
        assert!(point.iter().all(|u| (0.0..1.0).contains(u)));
        assert_ne!(point[..256], point[256..512]);
    }
}
