//! The derivative of [`SavitzkyGolay`] against `scipy.signal`: `savgol_filter` inside, `savgol_coeffs` of the window that is
//! left towards the ends. There SciPy itself would keep the last whole parabola; ours shrinks the window by design.

use crate::python_witness::{answer, numbers, python};
use rand::{RngExt, SeedableRng};
use serde_json::{Value, json};
use tribo_friction::identify::SavitzkyGolay;

/// Of the largest slope.
const TOLERANCE: f64 = 1e-12;

const SCIPY: &str = r#"
import json, sys, numpy as np
from scipy.signal import savgol_coeffs, savgol_filter
answers = []
for case in json.load(open(sys.argv[1])):
    x, m, dt = np.array(case["x"]), case["half_width"], case["dt_s"]
    y = np.gradient(x, dt, edge_order=1)
    if len(x) > 2 * m:
        y[m:len(x) - m] = savgol_filter(x, 2 * m + 1, 2, deriv=1, delta=dt)[m:len(x) - m]
    for k in range(1, len(x) - 1):
        r = min(k, len(x) - 1 - k)
        if r < m:
            y[k] = savgol_coeffs(2 * r + 1, 2, deriv=1, delta=dt, use="dot") @ x[k - r:k + r + 1]
    answers.append(y.tolist())
print(json.dumps(answers))
"#;

#[test]
fn derivative_is_that_of_scipy() {
    let Some(python) = python("scipy", "Savitzky–Golay derivatives are UNTESTED against SciPy") else { return };
    let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(5);
    let mut cases = Vec::new();
    for half_width in [1, 2, 5, 10, 25] {
        for (n, dt_s) in [(2, 1e-3), (3, 0.5), (20, 1e-3), (51, 0.01), (400, 1e-3)] {
            let x: Vec<f64> = (0..n).map(|_| random.random_range(-1.0..1.0)).collect();
            cases.push((SavitzkyGolay { half_width }, x, dt_s));
        }
    }
    let questions: Value =
        cases.iter().map(|(filter, x, dt_s)| json!({"x": x, "half_width": filter.half_width, "dt_s": dt_s})).collect();
    let mut worst = 0.0_f64;
    for ((filter, x, dt_s), theirs) in cases.iter().zip(answer(&python, SCIPY, &questions).as_array().expect("a list"))
    {
        let (ours, theirs) = (filter.derivative(x, *dt_s), numbers(theirs));
        assert_eq!(ours.len(), theirs.len());
        let scale = theirs.iter().fold(0.0_f64, |scale, slope| scale.max(slope.abs()));
        let off = ours.iter().zip(&theirs).fold(0.0_f64, |off, (a, b)| off.max((a - b).abs())) / scale;
        assert!(off < TOLERANCE, "{filter:?} on {} samples is off by {off:e}", x.len());
        worst = worst.max(off);
    }
    println!("SciPy: {} derivatives within {worst:.1e}", cases.len());
}
