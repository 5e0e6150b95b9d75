//! What a joint that stands says of its torques: next to nothing.
//!
//! ```text
//! stands(t): q moves less than 10 mrad within t ± 0.25 s
//! y = τ0 + A θ + e + u,   u anywhere within ± F while the joint stands:   weight² = σ²/(σ² + F²)
//! ```
//!
//! F and σ are dry friction and noise of the plain fit to the samples in motion. A joint that turns back is asked: over less than
//! the longest distance of presliding its friction is a state of its own.

use nalgebra::{Matrix3, Vector3};
use tribo_regression::{RegressionData, robust_sd};

use crate::joint_columns::JointColumns;
use crate::joint_term::JointTerm;
use crate::prior::PRESLIDING_RAD;

/// Half of the time in which a standing joint has not moved (s).
const HALF_WINDOW_S: f64 = 0.25;
/// Samples in motion that a plain fit needs.
const LEAST_SAMPLES: usize = 30;

/// Weight of each output sample of a joint, 1 in motion; `columns` before any weights.
pub(crate) fn weights<const N: usize>(data: &RegressionData<N>, joint: usize, columns: &JointColumns) -> Vec<f64> {
    let stands = standing(data, joint);
    let moving: Vec<usize> = (0..stands.len()).filter(|k| !stands[*k]).collect();
    if moving.len() < LEAST_SAMPLES || moving.len() == stands.len() {
        return vec![1.0; stands.len()];
    }
    let terms = [JointTerm::Offset, JointTerm::Coulomb, JointTerm::Viscous].map(JointTerm::place);
    let matrix = &columns.matrix;
    let row = |k: usize| Vector3::from_fn(|i, _| matrix[(k, terms[i])]);
    let target = |k: usize| matrix[(k, columns.measured())] - matrix[(k, columns.nominal())];
    let gram = moving.iter().fold(Matrix3::zeros(), |sum, k| sum + row(*k) * row(*k).transpose());
    let score = moving.iter().fold(Vector3::zeros(), |sum, k| sum + row(*k) * target(*k));
    let Some(cholesky) = gram.cholesky() else { return vec![1.0; stands.len()] };
    let plain = cholesky.solve(&score);
    let sigma = robust_sd(moving.iter().map(|k| target(*k) - row(*k).dot(&plain))).max(data.noise_floor_nm[joint]);
    let dry = data.nominal.dry_nm(joint) + plain[1];
    let weight = (1.0 + (dry / sigma.max(f64::MIN_POSITIVE)).powi(2)).sqrt().recip();
    stands.into_iter().map(|stands| if stands { weight } else { 1.0 }).collect()
}

/// Whether a joint stands at each output sample.
fn standing<const N: usize>(data: &RegressionData<N>, joint: usize) -> Vec<bool> {
    let longest_rad = PRESLIDING_RAD.into_iter().fold(0.0, f64::max);
    let mut stands = Vec::with_capacity(data.time_s.len());
    for burst in &data.bursts {
        let q = &data.q[joint][burst.out.clone()];
        let half = ((HALF_WINDOW_S * data.chains[burst.log].output_rate_hz()).round() as usize).max(1);
        stands.extend((0..q.len()).map(|k| {
            let window = &q[k.saturating_sub(half)..(k + half + 1).min(q.len())];
            let most = window.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let least = window.iter().copied().fold(f64::INFINITY, f64::min);
            most - least < longest_rad
        }));
    }
    stands
}

#[cfg(test)]
mod tests {
    use nalgebra::{DVector, SVector};
    use tribo_friction::FrictionModel;
    use tribo_logs::LogColumns;
    use tribo_robot::{presets, rnea};
    use tribo_sim::TorqueSide;

    use super::super::columns::Columns;
    use super::super::prior::ArmScale;
    use super::*;
    use tribo_regression::Nominal;

    /// A joint that swings with dry friction of 2 Nm and then stands under 1.5 Nm is asked where it moves and where it turns
    /// back, and hardly where it stands; joints that never move keep their weights.
    #[test]
    fn a_standing_joint_has_a_fraction_of_a_vote() {
        const JOINT: usize = 3;
        const SWING_S: f64 = 3.5 * std::f64::consts::PI;
        let time_s: Vec<f64> = (0..3000).map(|k| f64::from(k) / 200.0).collect();
        let arm = presets::panda().link_side();
        let mut gauss = crate::gaussian::gaussian(7);
        let [mut q_rad, mut dq_rad_s, mut tau_j_nm] = [0; 3].map(|_| vec![Vec::<f64>::new(); 7]);
        for t in &time_s {
            let swings = *t < SWING_S;
            let angle = 0.4 * t.min(SWING_S).sin();
            let rate = if swings { 0.4 * t.cos() } else { 0.0 };
            let only = |x: f64| SVector::<f64, 7>::from_fn(|j, _| if j == JOINT { x } else { 0.0 });
            let q = presets::panda_ready_pose() + only(angle);
            let rigid = rnea(&arm, &q, &only(rate), &only(if swings { -angle } else { 0.0 }));
            let tau = rigid + only(if swings { 2.0 * (rate / 0.02).tanh() } else { 1.5 });
            for j in 0..7 {
                q_rad[j].push(q[j]);
                dq_rad_s[j].push(only(rate)[j]);
                tau_j_nm[j].push(tau[j] + 0.05 * gauss());
            }
        }
        let log = LogColumns { time_s, q_rad, dq_rad_s, tau_j_nm, ..LogColumns::default() }.validate().unwrap();
        let nominal = Nominal { smoothing_rad_s: 0.01, ..Nominal::new(arm, FrictionModel::none(), TorqueSide::Link) };
        let data = RegressionData::of_logs(&[log], &nominal, Some(10.0)).unwrap();
        let columns = Columns::of(&data, &ArmScale::of(&data), 1);
        // The weighted constant is the weight.
        let weights = |joint: usize| {
            let offset = DVector::from_fn(columns.joints[joint].matrix.ncols(), |c, _| {
                f64::from(u8::from(c == JointTerm::Offset.place()))
            });
            columns.combined(joint, &offset, &[0])
        };
        let at = |t: f64| data.time_s.iter().position(|time| *time > t).unwrap();
        let swinging = weights(JOINT);
        assert!(swinging[at(3.0)] > 0.9, "{}", swinging[at(3.0)]);
        let turns = std::f64::consts::FRAC_PI_2;
        assert!(swinging[at(turns)] > 5.0 * swinging[at(13.0)], "{} {}", swinging[at(turns)], swinging[at(13.0)]);
        assert!(swinging[at(13.0)] < 0.1, "{}", swinging[at(13.0)]);
        assert!(weights(0)[at(13.0)] > 0.9);
    }
}
