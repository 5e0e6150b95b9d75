//! Dry friction that differs by direction.

use tribo_friction::law::smooth_sign;
use tribo_sim::Effect;

use super::Candidate;
use crate::column::FineColumn;
use crate::label::{CauseLabel, Location};
use crate::regression_data::RegressionData;

/// `a |tanh(qd/ε)|`. Linear. While the joint moves it is an offset; only standing still tells them apart.
///
/// The noise of qd would make |tanh| positive at rest: qd is shrunk, `qd max(0, 1 − (2.5 sd/qd)²)`.
pub(super) struct CoulombAsymmetry {
    pub joint: usize,
}

/// Standard deviations of velocity noise that are no motion.
const NOISE_SD: f64 = 2.5;

impl<const N: usize> Candidate<N> for CoulombAsymmetry {
    fn label(&self) -> CauseLabel {
        CauseLabel::CoulombAsymmetry
    }

    fn location(&self) -> Location {
        Location::Joint(self.joint)
    }

    fn columns(&self, data: &RegressionData<N>, _shape: &[f64]) -> Vec<FineColumn<N>> {
        let smoothing = data.nominal.smoothing_rad_s;
        let noise = NOISE_SD * data.velocity_sd_rad_s[self.joint];
        vec![data.joint_column(self.joint, |at| {
            let qd = at.qd[self.joint];
            let kept = if qd.abs() > noise { 1.0 - (noise / qd).powi(2) } else { 0.0 };
            smooth_sign(kept * qd, smoothing).abs()
        })]
    }

    fn effect(&self, _data: &RegressionData<N>, _shape: &[f64], coefficients: &[f64]) -> Option<Effect> {
        Some(Effect::CoulombAsymmetry { joint: self.joint, asymmetry_nm: coefficients[0] })
    }
}
