//! The joint-deformation regression: n = 960 + 40 samples of six outputs in six joint angles, and a circle to be scored on.

use crate::random_source::RandomSource;

const HALF_RANGE: [f64; 6] = [2.8, 1.2, 1.5, 2.5, 1.9, 2.8];
const NOISE_SD: [f64; 6] = [1.0, 0.8, 0.6, 0.4, 0.4, 0.5];

/// The outputs without noise.
pub fn torque(q: &[f64]) -> [f64; 6] {
    let (a, b) = (q[1] + q[2], q[1] + q[2] + q[4]);
    [
        1.5 * (3.0 * q[0]).sin() + 0.8 * (q[0] + q[1]).cos(),
        25.0 * q[1].sin() + 12.0 * a.sin() + 3.0 * b.sin() + 1.5 * (2.0 * q[0]).sin(),
        14.0 * a.sin() + 4.0 * q[3].cos() * b.sin(),
        3.0 * q[3].sin() * a.cos() + 1.2 * (q[3] + q[5]).sin(),
        6.0 * q[3].cos() * b.sin() + q[5].sin(),
        0.8 * q[5].sin() * q[4].sin(),
    ]
}

/// x_i = q_i/(h_i/√3).
fn scaled(q: &[f64]) -> Vec<f64> {
    q.iter().zip(HALF_RANGE).map(|(q, h)| q / (h / 3.0_f64.sqrt())).collect()
}

/// 1000 scaled inputs, and six outputs with noise.
pub fn data() -> (Vec<Vec<f64>>, Vec<Vec<f64>>) {
    let mut source = RandomSource::seed(4242);
    let (mut points, mut outputs) = (vec![], vec![vec![]; 6]);
    for _ in 0..1000 {
        let q: Vec<f64> = HALF_RANGE.iter().map(|h| source.range(-h, *h)).collect();
        for (j, t) in torque(&q).into_iter().enumerate() {
            outputs[j].push(t + NOISE_SD[j] * source.normal());
        }
        points.push(scaled(&q));
    }
    (points, outputs)
}

/// 100 scaled inputs of the circle and the outputs without noise.
#[allow(dead_code)] // of the callers only those that predict need it
pub fn circle() -> (Vec<Vec<f64>>, Vec<[f64; 6]>) {
    let on_circle = |k: usize| {
        let s = 2.0 * std::f64::consts::PI * k as f64 / 100.0;
        [
            0.6 * s.cos(),
            0.3 + 0.25 * s.sin(),
            -0.2 + 0.3 * s.cos(),
            0.5 * (2.0 * s).sin(),
            0.4 + 0.3 * s.sin(),
            0.8 * (2.0 * s).cos(),
        ]
    };
    (0..100).map(|k| (scaled(&on_circle(k)), torque(&on_circle(k)))).unzip()
}
