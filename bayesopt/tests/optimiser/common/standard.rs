//! The standard functions of `docs/optimiser_problems.md`, on the unit cube.

use std::f64::consts::PI;

pub fn branin2(u: &[f64]) -> f64 {
    let (x, y) = (-5.0 + 15.0 * u[0], 15.0 * u[1]);
    let (b, c, t) = (5.1 / (4.0 * PI * PI), 5.0 / PI, 1.0 / (8.0 * PI));
    (y - b * x * x + c * x - 6.0).powi(2) + 10.0 * (1.0 - t) * x.cos() + 10.0
}

pub fn hartmann6(u: &[f64]) -> f64 {
    const A: [[f64; 6]; 4] = [
        [10.0, 3.0, 17.0, 3.5, 1.7, 8.0],
        [0.05, 10.0, 17.0, 0.1, 8.0, 14.0],
        [3.0, 3.5, 1.7, 10.0, 17.0, 8.0],
        [17.0, 8.0, 0.05, 10.0, 0.1, 14.0],
    ];
    const P: [[f64; 6]; 4] = [
        [1312.0, 1696.0, 5569.0, 124.0, 8283.0, 5886.0],
        [2329.0, 4135.0, 8307.0, 3736.0, 1004.0, 9991.0],
        [2348.0, 1451.0, 3522.0, 2883.0, 3047.0, 6650.0],
        [4047.0, 8828.0, 8732.0, 5743.0, 1091.0, 381.0],
    ];
    const C: [f64; 4] = [1.0, 1.2, 3.0, 3.2];
    let exponent = |i: usize| (0..6).map(|j| A[i][j] * (u[j] - P[i][j] / 1e4).powi(2)).sum::<f64>();
    -(0..4).map(|i| C[i] * (-exponent(i)).exp()).sum::<f64>()
}

pub fn ackley14(u: &[f64]) -> f64 {
    ackley(&u.iter().map(|u| -5.0 + 15.0 * u).collect::<Vec<_>>())
}

/// Of x, least at 0.
pub fn ackley(x: &[f64]) -> f64 {
    let n = x.len() as f64;
    let square = x.iter().map(|x| x * x).sum::<f64>() / n;
    let cosine = x.iter().map(|x| (2.0 * PI * x).cos()).sum::<f64>() / n;
    -20.0 * (-0.2 * square.sqrt()).exp() - cosine.exp() + 20.0 + 1.0_f64.exp()
}

pub fn levy14(u: &[f64]) -> f64 {
    levy(&u.iter().map(|u| -5.0 + 15.0 * u).collect::<Vec<_>>())
}

/// Of x, least at 1.
pub fn levy(x: &[f64]) -> f64 {
    let w: Vec<f64> = x.iter().map(|x| 1.0 + (x - 1.0) / 4.0).collect();
    let last = w.len() - 1;
    let head = (PI * w[0]).sin().powi(2);
    let middle: f64 = w[..last].iter().map(|w| (w - 1.0).powi(2) * (1.0 + 10.0 * (PI * w + 1.0).sin().powi(2))).sum();
    head + middle + (w[last] - 1.0).powi(2) * (1.0 + (2.0 * PI * w[last]).sin().powi(2))
}
