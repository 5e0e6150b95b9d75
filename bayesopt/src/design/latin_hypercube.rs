//! Stratified random points.

use rand::RngExt;

use crate::random::{Purpose, stream};

/// Point `index` of a Latin hypercube with `count` points:  `u_i = (π_i(index) + r_i)/count`
/// (mckay1979), π_i a random permutation per coordinate, r_i ~ U[0,1); unit coordinates.
///
/// Index `count` begins the next, independent hypercube. `count = 0` is read as 1.
pub fn latin_hypercube_point(dimension: usize, index: usize, count: usize, seed: u64) -> Vec<f64> {
    let count = count.max(1);
    let mut rng = stream(seed, index / count, Purpose::Design);
    let place = index % count;
    let mut permutation: Vec<usize> = (0..count).collect();
    let mut coordinate = |_| {
        // Fisher–Yates; the offsets of all points are drawn so that each point sees the same stream.
        for k in (1..count).rev() {
            permutation.swap(k, rng.random_range(0..=k));
        }
        let offsets: Vec<f64> = (0..count).map(|_| rng.random()).collect();
        (permutation[place] as f64 + offsets[place]) / count as f64
    };
    (0..dimension).map(&mut coordinate).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_stratum_of_each_coordinate_holds_one_point() {
        for block in 0..2 {
            let points: Vec<_> = (0..7).map(|i| latin_hypercube_point(3, 7 * block + i, 7, 5)).collect();
            for axis in 0..3 {
                let mut strata: Vec<usize> = points.iter().map(|point| (point[axis] * 7.0) as usize).collect();
                strata.sort_unstable();
                assert_eq!(strata, (0..7).collect::<Vec<_>>());
            }
        }
    }
}
