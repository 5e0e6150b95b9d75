//! Filters of a diagnosis against `scipy.signal`.
//!
//! [`ZeroPhaseLowPass`] against `butter` and `sosfiltfilt`: the same prewarped bilinear transform, and with `padlen` set to
//! our reflection the same continuation and the same initial state, so ends are compared too. [`central_difference`] against
//! `savgol_coeffs` of the highest degree that a window carries, which are the same weights by another way.

use rand::{RngExt, SeedableRng};
use serde_json::{Value, json};
use tribo_regression::filter::{ZeroPhaseLowPass, central_difference};

use crate::python_witness::{answer, numbers, python};

const SCIPY: &str = r#"
import json, math, sys, numpy as np
from scipy.signal import butter, savgol_coeffs, sosfiltfilt
answers = []
for case in json.load(open(sys.argv[1])):
    x = np.array(case["x"])
    if "order" in case:
        sos = butter(case["order"], case["cutoff_hz"], fs=case["rate_hz"], output="sos")
        padlen = min(math.ceil(3.0 * case["rate_hz"] / case["cutoff_hz"]), len(x) - 1)
        y = sosfiltfilt(sos, x, padtype="odd", padlen=padlen)
    else:
        y = np.gradient(x, case["dt_s"], edge_order=1)
        for k in range(1, len(x) - 1):
            r = min(k, len(x) - 1 - k, 4)
            weights = savgol_coeffs(2 * r + 1, 2 * r, deriv=1, delta=case["dt_s"], use="dot")
            y[k] = weights @ x[k - r:k + r + 1]
    answers.append(y.tolist())
print(json.dumps(answers))
"#;

/// White noise on a random walk: every frequency, and ends that are far from rest.
fn signal(n: usize, seed: u64) -> Vec<f64> {
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(seed);
    let mut walk = 3.0;
    (0..n)
        .map(|_| {
            walk += random.random_range(-0.2..0.2);
            walk + random.random_range(-1.0..1.0)
        })
        .collect()
}

/// Compares our signals with SciPy's, each within `tolerance` of its largest value.
#[track_caller]
fn same(what: &str, questions: &[Value], ours: &[Vec<f64>], tolerance: f64) {
    let Some(python) = python("scipy", &format!("{what}: UNTESTED against SciPy")) else { return };
    let answers = answer(&python, SCIPY, &questions.to_vec().into());
    let mut worst = 0.0_f64;
    for ((question, ours), theirs) in questions.iter().zip(ours).zip(answers.as_array().expect("a list")) {
        let theirs = numbers(theirs);
        assert_eq!(ours.len(), theirs.len());
        let scale = theirs.iter().fold(0.0_f64, |scale, value| scale.max(value.abs()));
        let off = ours.iter().zip(&theirs).fold(0.0_f64, |off, (a, b)| off.max((a - b).abs())) / scale;
        let (order, cutoff_hz, n) = (&question["order"], &question["cutoff_hz"], ours.len());
        assert!(off < tolerance, "{what} (order {order}, {cutoff_hz} Hz) of {n} samples is off by {off:e}");
        worst = worst.max(off);
    }
    println!("SciPy, {what}: {} signals within {worst:.1e}", ours.len());
}

#[test]
fn zero_phase_low_pass_is_that_of_scipy() {
    let (mut questions, mut ours) = (Vec::new(), Vec::new());
    for order in 1..=8 {
        for (cutoff_hz, rate_hz) in [(5.0, 1000.0), (30.0, 1000.0), (240.0, 500.0), (12.5, 99.7)] {
            for n in [2, 30, 2500] {
                let x = signal(n, order as u64);
                let low_pass = ZeroPhaseLowPass::butterworth(order, cutoff_hz, rate_hz).expect("a design");
                ours.push(low_pass.filter(&x));
                questions.push(json!({"x": x, "order": order, "cutoff_hz": cutoff_hz, "rate_hz": rate_hz}));
            }
        }
    }
    // Poles near 1 amplify roundings of the coefficients; measured are 1.4e-12.
    same("zero-phase low-pass", &questions, &ours, 1e-11);
}

#[test]
fn central_difference_is_that_of_scipy() {
    let (mut questions, mut ours) = (Vec::new(), Vec::new());
    for (n, dt_s) in [(2, 0.1), (3, 1e-3), (6, 1e-3), (9, 0.02), (300, 1e-3)] {
        let x = signal(n, n as u64);
        ours.push(central_difference(&x, dt_s));
        questions.push(json!({"x": x, "dt_s": dt_s}));
    }
    // Least squares on powers up to the eighth cost SciPy some digits; measured are 1.5e-13.
    same("central difference", &questions, &ours, 1e-11);
}
