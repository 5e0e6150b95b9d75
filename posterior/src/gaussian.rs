//! Normal noise for the tests of this crate.

use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

/// Numbers of mean 0 and standard deviation 1.
pub(crate) fn gaussian(seed: u64) -> impl FnMut() -> f64 {
    let mut rng = Pcg64::seed_from_u64(seed);
    move || StandardNormal.sample(&mut rng)
}
