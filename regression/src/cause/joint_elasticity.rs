//! A spring between motor and link, seen by an encoder on the motor.

use nalgebra::SVector;
use tribo_robot::{mass_matrix, rnea};
use tribo_sim::{Effect, oscillator_step};

use super::{Candidate, RIGID_UNASKED, log_grid, only};
use crate::column::FineColumn;
use crate::label::{CauseLabel, Location};
use crate::regression_data::{RegressionData, smooth_in_time};

/// The link lags the motor by δ, so its torque is that of another state:
///
/// ```text
/// M_jj δ'' + D δ' + K δ = tau_link,j(q),   column = tau_link(q − δ) − tau_link(q), all joints
/// ```
///
/// The coefficient of the right K is 1; K/c is better than a K with another c. Confusable with a
/// delay: both go with the rate of the torque. With two encoders theta − q answers instead.
pub(crate) struct JointElasticity {
    pub joint: usize,
}

/// Stiffness of joints of arms of this size [Nm/rad].
const STIFFNESS_NM_RAD: [f64; 2] = [1e3, 6e4];
/// Coefficients that a spring of the tried stiffness may have.
const COEFFICIENT: [f64; 2] = [0.6, 1.6];
/// Damping ratio assumed where the log cannot tell.
const DAMPING_RATIO: f64 = 0.05;

impl<const N: usize> Candidate<N> for JointElasticity {
    fn label(&self) -> CauseLabel {
        CauseLabel::JointElasticity
    }

    fn location(&self) -> Location {
        Location::Joint(self.joint)
    }

    fn unavailable(&self, data: &RegressionData<N>) -> Option<String> {
        if data.transmission {
            return Some(RIGID_UNASKED.to_owned());
        }
        data.deflection_rad.is_some().then(|| "theta − q shows it directly".to_owned())
    }

    fn shapes(&self, _data: &RegressionData<N>) -> Vec<Vec<f64>> {
        log_grid(STIFFNESS_NM_RAD[0], STIFFNESS_NM_RAD[1], 6)
    }

    fn fixed_point(&self, shape: &[f64], coefficients: &[f64]) -> Option<Vec<f64>> {
        let stiffness = shape[0] / coefficients[0];
        (stiffness.is_finite() && stiffness > 0.0)
            .then(|| vec![stiffness.clamp(STIFFNESS_NM_RAD[0], STIFFNESS_NM_RAD[1])])
    }

    fn columns(&self, data: &RegressionData<N>, shape: &[f64]) -> Vec<FineColumn<N>> {
        let (j, stiffness) = (self.joint, shape[0]);
        let damping = shape.get(1).copied().unwrap_or_else(|| assumed_damping(data, j, stiffness));
        let link_arm = data.nominal.arm.clone().link_side();
        let mut column = Vec::with_capacity(data.motion.len());
        for burst in &data.bursts {
            let (samples, of_model) = (&data.motion[burst.fine.clone()], &data.of_model[burst.fine.clone()]);
            let dt_s = data.period_s(burst);
            let Some(first) = samples.first() else { continue };
            // At its resonance the spring would magnify the noise of the acceleration above the band.
            let load: Vec<f64> = of_model.iter().map(|at| at.link_nm[j]).collect();
            let drive = data.chains[burst.log].in_band(&load);
            let mut inertia = mass_matrix(&link_arm, &first.q)[(j, j)].max(1e-4);
            let mut before = drive[0];
            let mut slope = drive.get(1).map_or(0.0, |next| (next - before) / dt_s);
            let (mut deflection, mut rate) = ((before - damping * slope / stiffness) / stiffness, slope / stiffness);
            // A free swing is linear in where it starts.
            let free = |inertia: f64| {
                [[1.0, 0.0], [0.0, 1.0]].map(|at| oscillator_step(at, stiffness / inertia, damping / inertia, dt_s))
            };
            let mut swings = free(inertia);
            let mut lag = Vec::with_capacity(samples.len());
            for (k, (at, drive)) in samples.iter().zip(drive).enumerate() {
                if k > 0 {
                    if k % INERTIA_EVERY == 0 {
                        inertia = mass_matrix(&link_arm, &at.q)[(j, j)].max(1e-4);
                        swings = free(inertia);
                    }
                    // Under a torque that rises linearly δ does too; what differs from that swings freely.
                    slope = (drive - before) / dt_s;
                    let steady = |torque: f64| (torque - damping * slope / stiffness) / stiffness;
                    let from = [deflection - steady(before), rate - slope / stiffness];
                    let [swing, swing_rate] = [0, 1].map(|i| swings[0][i] * from[0] + swings[1][i] * from[1]);
                    (deflection, rate) = (steady(drive) + swing, slope / stiffness + swing_rate);
                    before = drive;
                }
                lag.push([deflection, rate, (drive - damping * rate - stiffness * deflection) / inertia]);
            }
            let stride = data.chains[burst.log].knot_stride();
            column.extend(smooth_in_time(samples.len(), stride, |k| {
                let (at, [deflection, rate, acceleration]) = (&samples[k], lag[k]);
                let tau = rnea(
                    &link_arm,
                    &(at.q - only(j, deflection)),
                    &(at.qd - only(j, rate)),
                    &(at.qdd - only(j, acceleration)),
                );
                tau - of_model[k].link_nm
            }));
        }
        vec![FineColumn::Arm(column)]
    }

    fn admissible(&self, _data: &RegressionData<N>, _shape: &[f64], coefficients: &[f64]) -> bool {
        (COEFFICIENT[0]..COEFFICIENT[1]).contains(&coefficients[0])
    }

    fn effect(&self, data: &RegressionData<N>, shape: &[f64], coefficients: &[f64]) -> Option<Effect> {
        Some(Effect::JointElasticity {
            joint: self.joint,
            stiffness_nm_per_rad: shape[0] / coefficients[0],
            damping_nm_s_per_rad: assumed_damping(data, self.joint, shape[0]),
        })
    }
}

/// `2 ζ √(K M)`, ζ = 0.05: below its resonance a joint does not show its damping.
fn assumed_damping<const N: usize>(data: &RegressionData<N>, joint: usize, stiffness: f64) -> f64 {
    2.0 * DAMPING_RATIO * (stiffness * typical_inertia(data, joint)).sqrt()
}

/// Samples between two evaluations of the inertia, which varies with the posture alone.
const INERTIA_EVERY: usize = 50;

/// Inertia about the joint in the middle of the log [kg m²].
fn typical_inertia<const N: usize>(data: &RegressionData<N>, joint: usize) -> f64 {
    let q = data.motion.get(data.motion.len() / 2).map_or_else(SVector::zeros, |at| at.q);
    mass_matrix(&data.nominal.arm.clone().link_side(), &q)[(joint, joint)].max(1e-4)
}
