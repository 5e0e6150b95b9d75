//! Coulomb-viscous friction and offset of one joint from its torque residual.

use super::{TorqueFitError, fit_columns};
use crate::law::smooth_sign;

/// `residual = Fc tanh(qd/ε) + Fv qd + offset`, fitted by least squares.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JointTorqueFit {
    /// Coulomb friction (Nm).
    pub coulomb_nm: f64,
    /// Viscous friction [Nm s/rad].
    pub viscous_nm_s_per_rad: f64,
    /// Constant torque (Nm).
    pub offset_nm: f64,
    /// Condition number of the normal matrix with unit columns: large when, e.g., the joint moved in one direction only.
    pub condition: f64,
}

impl JointTorqueFit {
    /// Torque (Nm) of the fit at qd [rad/s], sign smoothed over `smoothing_rad_s`.
    pub fn torque(&self, qd: f64, smoothing_rad_s: f64) -> f64 {
        self.coulomb_nm * smooth_sign(qd, smoothing_rad_s) + self.viscous_nm_s_per_rad * qd + self.offset_nm
    }
}

/// Least squares of `residual_nm` (Nm) on `[tanh(qd/ε), qd, 1]`; qd [rad/s], both of the same length.
pub fn fit_joint_torque(
    qd: &[f64],
    residual_nm: &[f64],
    smoothing_rad_s: f64,
) -> Result<JointTorqueFit, TorqueFitError> {
    let sign: Vec<f64> = qd.iter().map(|&v| smooth_sign(v, smoothing_rad_s)).collect();
    let ones = vec![1.0; qd.len()];
    let rows = 0..qd.len().min(residual_nm.len());
    let fit = fit_columns(&[&sign, qd, &ones], residual_nm, std::slice::from_ref(&rows))?;
    Ok(JointTorqueFit {
        coulomb_nm: fit.coefficients[0],
        viscous_nm_s_per_rad: fit.coefficients[1],
        offset_nm: fit.coefficients[2],
        condition: fit.condition,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recovers_three_numbers_and_refuses_one_way_motion() {
        let qd: Vec<f64> = (0..500).map(|k| 0.5 * (f64::from(k) * 0.05).sin()).collect();
        let truth = JointTorqueFit { coulomb_nm: 0.4, viscous_nm_s_per_rad: 0.2, offset_nm: -0.1, condition: 0.0 };
        let residual: Vec<f64> = qd.iter().map(|&v| truth.torque(v, 0.005)).collect();
        let fit = fit_joint_torque(&qd, &residual, 0.005).unwrap();
        assert!((fit.coulomb_nm - 0.4).abs() < 1e-10 && (fit.viscous_nm_s_per_rad - 0.2).abs() < 1e-10);
        assert!((fit.offset_nm + 0.1).abs() < 1e-10);

        let one_way: Vec<f64> = (0..500).map(|k| 0.4 + 0.1 * (f64::from(k) * 0.05).sin()).collect();
        let residual: Vec<f64> = one_way.iter().map(|&v| truth.torque(v, 0.005)).collect();
        assert!(matches!(fit_joint_torque(&one_way, &residual, 0.005), Err(TorqueFitError::NotSeparable { .. })));
    }
}
