//! Interpolants of [`resample`] against NumPy and `scipy.interpolate`, on stamps that jitter.
//!
//! Cubic pieces: `CubicHermiteSpline` with the slopes of `numpy.gradient(edge_order=2)`. Six rows: `BarycentricInterpolator`.
//! Linear: `numpy.interp`.

use crate::python_witness::{answer, numbers, python};
use serde_json::json;
use tribo_logs::{LogColumns, Resampling, resample};

/// Of values of about one.
const TOLERANCE: f64 = 1e-12;

const SCIPY: &str = r#"
import json, sys, numpy as np
from scipy.interpolate import BarycentricInterpolator, CubicHermiteSpline
answers = []
for case in json.load(open(sys.argv[1])):
    t, y, at = (np.array(case[name]) for name in ("time_s", "values", "at_s"))
    slopes = np.gradient(y, t, edge_order=2)
    row = np.clip(np.searchsorted(t, at, side="right") - 1, 0, len(t) - 2)
    first = np.clip(row - 2, 0, max(len(t) - 6, 0))
    answers.append({
        "linear": np.interp(at, t, y).tolist(),
        "cubic": CubicHermiteSpline(t, y, slopes)(at).tolist(),
        "six_point": [float(BarycentricInterpolator(t[k:k + 6], y[k:k + 6])(s)) for k, s in zip(first, at)],
    })
print(json.dumps(answers))
"#;

#[test]
fn interpolants_are_those_of_scipy() {
    let Some(python) = python("scipy", "resampling is UNTESTED against SciPy") else { return };
    let (mut questions, mut ours) = (Vec::new(), Vec::new());
    for (period_s, position, torque) in [(1e-3, "cubic", "linear"), (0.01, "six_point", "cubic")] {
        for rows in [3, 4, 5, 6, 8, 300] {
            let time_s: Vec<f64> =
                (0..rows).map(|k| period_s * (f64::from(k) + 0.4 * f64::from(k * k % 7) / 7.0)).collect();
            // Six frequencies and a kink at every fifth row.
            let values: Vec<f64> =
                (0..rows).map(|k| (f64::from(k * k) * 0.01).sin() + 0.1 * f64::from(k % 5)).collect();
            let log = LogColumns {
                q_rad: vec![values.clone()],
                dq_rad_s: vec![values.clone()],
                tau_j_nm: vec![values.clone()],
                time_s: time_s.clone(),
                ..LogColumns::default()
            };
            let settings = Resampling { period_s: Some(0.37 * period_s), gap_tolerance: 3.0, min_rows: 2 };
            let resampled = resample(&log.validate().expect("a log"), &settings).expect("resampled");
            let [burst] = resampled.bursts.as_slice() else { panic!("one burst") };
            questions.push(json!({"time_s": time_s, "values": values, "at_s": burst.time_s}));
            let columns = [(position, &burst.q_rad), (torque, &burst.tau_j_nm), ("linear", &burst.dq_rad_s)];
            ours.push(columns.map(|(interpolant, column)| (interpolant, column[0].clone())));
        }
    }
    let mut worst = 0.0_f64;
    let answers = answer(&python, SCIPY, &questions.into());
    for (columns, witness) in ours.iter().zip(answers.as_array().expect("a list")) {
        for (interpolant, ours) in columns {
            let theirs = numbers(&witness[interpolant]);
            assert_eq!(ours.len(), theirs.len());
            let off = ours.iter().zip(&theirs).fold(0.0_f64, |off, (a, b)| off.max((a - b).abs()));
            assert!(off < TOLERANCE, "{interpolant} on {} samples is off by {off:e}", ours.len());
            worst = worst.max(off);
        }
    }
    println!("SciPy: {} columns within {worst:.1e}", 3 * ours.len());
}
