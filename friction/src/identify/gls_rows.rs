//! Rows of the regression of estimated wrenches on friction.

use nalgebra::{DMatrix, Matrix6, Vector6};

use super::{GlsSample, GlsSettings};

/// Where each unknown sits in the parameter vector, with its prior and bounds.
pub(super) struct Layout {
    pub total: usize,
    pub offset: Option<usize>,
    pub payload: Option<usize>,
    pub prior_sd: Vec<f64>,
    pub lower: Vec<f64>,
    pub upper: Vec<f64>,
}

impl Layout {
    pub fn new<const N: usize>(settings: &GlsSettings<N>) -> Self {
        let columns = settings.basis.columns();
        let mut layout = Self { total: 0, offset: None, payload: None, prior_sd: vec![], lower: vec![], upper: vec![] };
        for j in 0..N {
            for c in 0..columns {
                layout.push(settings.prior_sd[j][c], settings.lower[j][c], settings.upper[j][c]);
            }
        }
        if let Some(sd) = settings.offset_sd_nm {
            layout.offset = Some(layout.total);
            for _ in 0..N {
                layout.push(sd, f64::NEG_INFINITY, f64::INFINITY);
            }
        }
        if let Some(sd) = settings.payload_sd_kg {
            layout.payload = Some(layout.total);
            layout.push(sd, f64::NEG_INFINITY, f64::INFINITY);
        }
        layout
    }

    fn push(&mut self, prior_sd: f64, lower: f64, upper: f64) {
        self.prior_sd.push(prior_sd);
        self.lower.push(lower);
        self.upper.push(upper);
        self.total += 1;
    }
}

/// Rows `[W_j Φ(qd_j) …, W_j …, g e_z]` of one sample.
#[inline(never)]
pub(super) fn fill_rows<const N: usize>(
    rows: &mut DMatrix<f64>,
    sample: &GlsSample<N>,
    settings: &GlsSettings<N>,
    layout: &Layout,
) {
    /// Standard gravity used for the mass nuisance [m/s²].
    const GRAVITY_M_S2: f64 = 9.81;
    let columns = settings.basis.columns();
    for j in 0..N {
        let sign = if sample.slides[j] { sample.qd[j].signum() } else { 0.0 };
        let phi = settings.basis.evaluate(sample.qd[j], sign);
        for c in 0..columns {
            for r in 0..6 {
                rows[(r, j * columns + c)] = sample.wrench_from_torque[(r, j)] * phi[c];
            }
        }
    }
    if let Some(first) = layout.offset {
        for j in 0..N {
            for r in 0..6 {
                rows[(r, first + j)] = sample.wrench_from_torque[(r, j)];
            }
        }
    }
    if let Some(k) = layout.payload {
        for r in 0..6 {
            rows[(r, k)] = if r == 5 { GRAVITY_M_S2 } else { 0.0 };
        }
    }
}

/// `diag(moment², force²) + Σ_{j rests} W_j W_jᵀ Fc0²/3`.
pub(super) fn error_covariance<const N: usize>(sample: &GlsSample<N>, settings: &GlsSettings<N>) -> Matrix6<f64> {
    let (m, f) = (settings.moment_sd_nm.powi(2), settings.force_sd_n.powi(2));
    let mut covariance = Matrix6::from_diagonal(&Vector6::new(m, m, m, f, f, f));
    for j in 0..N {
        if !sample.slides[j] {
            let w = sample.wrench_from_torque.column(j);
            covariance += w * w.transpose() * (settings.stuck_coulomb_nm[j].powi(2) / 3.0);
        }
    }
    covariance
}
