//! Variants of the standard functions, against settings that fit the standard ones by accident: optima elsewhere,
//! coordinates mixed, coordinates that do not matter.

use super::random_source::RandomSource;
use super::standard::{ackley, hartmann6, levy};

/// Ackley with its optimum at a different place in every coordinate, u between 0.15 and 0.85.
pub fn ackley14_shifted(u: &[f64]) -> f64 {
    ackley(&from_optimum(u, 101))
}

/// Ackley with its optimum off the centre and its coordinates mixed by a reflection.
pub fn ackley14_mixed(u: &[f64]) -> f64 {
    ackley(&reflected(from_optimum(u, 102), 103))
}

/// Levy with its optimum at a different place in every coordinate.
pub fn levy14_shifted(u: &[f64]) -> f64 {
    levy(&from_optimum(u, 104).iter().map(|x| 1.0 + x).collect::<Vec<_>>())
}

/// Levy with its coordinates mixed by a reflection.
pub fn levy14_mixed(u: &[f64]) -> f64 {
    levy(&reflected(from_optimum(u, 105), 106).iter().map(|x| 1.0 + x).collect::<Vec<_>>())
}

/// Hartmann of the first six of fourteen coordinates.
pub fn hartmann6_in_14(u: &[f64]) -> f64 {
    hartmann6(&u[..6])
}

/// A narrow quadratic valley, curvatures from 1 to 100 by coordinate.
pub fn ellipsoid14(u: &[f64]) -> f64 {
    let x = from_optimum(u, 107);
    x.iter().enumerate().map(|(i, x)| 100.0_f64.powf(i as f64 / 13.0) * x * x).sum()
}

/// x = 15 (u − u*), u* drawn from `seed(stream)`.
fn from_optimum(u: &[f64], stream: u64) -> Vec<f64> {
    let mut source = RandomSource::seed(stream);
    u.iter().map(|u| 15.0 * (u - source.range(0.15, 0.85))).collect()
}

/// x − 2 n (n·x), n a random unit vector.
fn reflected(x: Vec<f64>, stream: u64) -> Vec<f64> {
    let mut source = RandomSource::seed(stream);
    let n: Vec<f64> = x.iter().map(|_| source.normal()).collect();
    let square: f64 = n.iter().map(|n| n * n).sum();
    let along: f64 = 2.0 * n.iter().zip(&x).map(|(n, x)| n * x).sum::<f64>() / square;
    x.iter().zip(&n).map(|(x, n)| x - along * n).collect()
}
