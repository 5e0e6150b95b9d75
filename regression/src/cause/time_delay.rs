//! Torques stamped late.

use nalgebra::SVector;
use tribo_sim::Effect;

use super::Candidate;
use crate::column::FineColumn;
use crate::label::{CauseLabel, Location};
use crate::regression_data::RegressionData;

/// `tau(t − d) − tau(t)`, one delay for all joints: the column is that difference over d, so its coefficient is d.
/// Shape d. Positive is torque late. Confusable with viscous friction where accelerations are small, and with
/// elasticity.
pub(super) struct TimeDelay;

/// Longest believable delay (s).
const LONGEST_S: f64 = 0.1;
/// Shortest believable delay (s): below it, filters and stamps decide.
const SHORTEST_BELIEVED_S: f64 = 4e-4;
/// Shortest difference (s).
const SHORTEST_S: f64 = 1e-4;

impl<const N: usize> Candidate<N> for TimeDelay {
    fn label(&self) -> CauseLabel {
        CauseLabel::TimeDelay
    }

    fn location(&self) -> Location {
        Location::Arm
    }

    fn shapes(&self, _data: &RegressionData<N>) -> Vec<Vec<f64>> {
        vec![vec![1e-3]]
    }

    fn fixed_point(&self, _shape: &[f64], coefficients: &[f64]) -> Option<Vec<f64>> {
        let delay_s = coefficients[0].clamp(-LONGEST_S, LONGEST_S);
        Some(vec![if delay_s.abs() < SHORTEST_S { SHORTEST_S } else { delay_s }])
    }

    fn columns(&self, data: &RegressionData<N>, shape: &[f64]) -> Vec<FineColumn<N>> {
        let delay_s = shape[0];
        let mut column = Vec::with_capacity(data.motion.len());
        for burst in &data.bursts {
            let samples = &data.of_model[burst.fine.clone()];
            let back = delay_s / data.period_s(burst);
            for k in 0..samples.len() {
                let before = interpolated(samples.len(), k as f64 - back, |i| samples[i].model_nm);
                column.push((before - samples[k].model_nm) / delay_s);
            }
        }
        vec![FineColumn::Arm(column)]
    }

    fn admissible(&self, _data: &RegressionData<N>, _shape: &[f64], coefficients: &[f64]) -> bool {
        (SHORTEST_BELIEVED_S..LONGEST_S).contains(&coefficients[0].abs())
    }

    fn effect(&self, _data: &RegressionData<N>, _shape: &[f64], coefficients: &[f64]) -> Option<Effect> {
        Some(Effect::TimeDelay { delay_s: coefficients[0] })
    }
}

/// Linear interpolation at a fractional index, held at the ends.
pub(crate) fn interpolated<const N: usize>(
    len: usize,
    index: f64,
    value: impl Fn(usize) -> SVector<f64, N>,
) -> SVector<f64, N> {
    let last = len.saturating_sub(1);
    let index = index.clamp(0.0, last as f64);
    let (row, fraction) = (index.floor() as usize, index.fract());
    value(row) * (1.0 - fraction) + value((row + 1).min(last)) * fraction
}
