//! The friction-compensation-like functions of `docs/optimiser_problems.md`, on the unit cube.

use std::f64::consts::PI;

const AMPLITUDE: [f64; 7] = [0.6, 0.5, 0.7, 0.6, 0.8, 0.9, 1.0];
const FREQUENCY: [f64; 7] = [0.05, 0.075, 0.05, 0.075, 0.1, 0.1, 0.0875];
const W: [[f64; 7]; 6] = [
    [-1.179, 2.4332, 0.1198, 1.7398, -0.1698, 0.3863, -1.0825],
    [0.7317, 1.4654, 1.3369, 1.0656, 0.1228, 1.0658, 1.7807],
    [-0.3711, 1.0758, -0.0389, 3.4331, -0.1695, -2.2735, 0.6245],
    [-0.0447, -0.2059, -0.1038, -0.3485, 0.8807, 0.5657, -0.1978],
    [-0.1648, 0.2814, -0.0192, 0.3936, 0.4206, -0.9803, 0.2164],
    [-0.0599, 0.0934, -0.0101, 0.1287, 0.1772, -0.3301, -0.991],
];
pub const TRUE14: [[f64; 2]; 7] =
    [[2.35, 1.40], [1.90, 1.15], [2.15, 1.30], [1.65, 1.05], [1.45, 0.90], [1.25, 0.80], [1.10, 0.70]];
pub const TRUE35: [[f64; 5]; 7] = [
    [0.62, 0.71, 0.55, 4.2, 1.30],
    [0.48, 0.66, 0.43, 5.1, 1.05],
    [0.55, 0.58, 0.61, 3.6, 1.45],
    [0.41, 0.63, 0.37, 6.0, 0.95],
    [0.36, 0.44, 0.32, 4.8, 1.20],
    [0.29, 0.39, 0.28, 5.6, 1.10],
    [0.24, 0.33, 0.25, 3.9, 1.35],
];
const DAMPING14: [f64; 7] = [1.6, 1.6, 1.4, 1.4, 0.9, 0.8, 0.7];
const DAMPING35: [f64; 7] = [1.1, 1.1, 1.0, 1.0, 0.65, 0.55, 0.5];

pub const WIDTH14: [f64; 2] = [5.0, 2.5];
pub const WIDTH35: [f64; 5] = [1.5, 1.5, 1.5, 10.0, 2.5];

pub fn fric14(u: &[f64]) -> f64 {
    fric14_aborted(u).0
}

/// J and, of a trial that crashed, the part of it that was seen.
pub fn fric14_aborted(u: &[f64]) -> (f64, Option<f64>) {
    let friction = |p: &[f64], v: f64| p[0] * v + p[1] * sign(v);
    cost(u, &WIDTH14, TRUE14.as_flattened(), &DAMPING14, friction)
}

pub fn fric35(u: &[f64]) -> f64 {
    fric35_aborted(u).0
}

/// J and, of a trial that crashed, the part of it that was seen.
pub fn fric35_aborted(u: &[f64]) -> (f64, Option<f64>) {
    let friction = |p: &[f64], v: f64| p[0] * v + (p[1] + p[2] * (-((p[3] * v).abs().powf(p[4]))).exp()) * sign(v);
    cost(u, &WIDTH35, TRUE35.as_flattened(), &DAMPING35, friction)
}

fn sign(v: f64) -> f64 {
    if v == 0.0 { 0.0 } else { v.signum() }
}

fn cost(
    u: &[f64],
    box_width: &[f64],
    truth: &[f64],
    damping: &[f64; 7],
    friction: impl Fn(&[f64], f64) -> f64,
) -> (f64, Option<f64>) {
    let per_joint = box_width.len();
    let theta: Vec<f64> = u.iter().enumerate().map(|(k, u)| box_width[k % per_joint] * u).collect();
    let (mut y, mut largest, mut sum) = ([0.0; 6], [0.0_f64; 6], [0.0; 6]);
    let (mut energy, mut aborted, mut steps) = (0.0_f64, None, 0.0);
    for k in 0..300 {
        let t = 0.1 * f64::from(k);
        let mut r = [0.0; 7];
        let mut power = 0.0;
        for i in 0..7 {
            let phase = 2.0 * PI * FREQUENCY[i] * (1.0 + (2.0 * PI * 0.015 * t).cos()) * t + 0.9 * i as f64;
            let v = AMPLITUDE[i] * phase.cos();
            let joint = i * per_joint..(i + 1) * per_joint;
            r[i] = friction(&truth[joint.clone()], v) - friction(&theta[joint], v);
            power += (-r[i]) * v - (damping[i] * v) * v;
        }
        for j in 0..6 {
            let mut filtered = 0.0;
            for i in 0..7 {
                filtered += W[j][i] * r[i];
            }
            y[j] += 0.6 * (filtered - y[j]);
            largest[j] = largest[j].max(y[j].abs());
            sum[j] += y[j].abs();
        }
        steps += 1.0;
        energy = (0.98 * energy + 0.1 * power).max(0.0);
        if energy > 2.0 {
            aborted = Some(t / 30.0);
            break;
        }
    }
    let penalty = aborted.map_or(0.0, |part: f64| 1000.0 * (-part).exp());
    ((0..6).map(|j| largest[j] + sum[j] / steps).sum::<f64>() + penalty, aborted)
}
