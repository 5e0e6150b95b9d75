//! Generalised least squares on the estimated wrench, with the stuck-joint projector.

use nalgebra::{DMatrix, SVector, Vector6};

use super::gls_rows::{Layout, fill_rows};
use super::normal_equations::{NormalEquations, Solution};
use super::{Basis, GlsError, GlsSample, GlsSettings};
use crate::FrictionModel;

/// Identified friction with its uncertainty.
#[derive(Clone, Debug, PartialEq)]
pub struct GlsFit<const N: usize> {
    /// The friction law of each joint.
    pub friction: FrictionModel<N>,
    /// Coefficients per joint, in the order of [`Basis`] (unused entries 0).
    pub coefficients: [[f64; 3]; N],
    /// Standard deviation of the coefficients, bounds ignored (unused entries 0).
    pub sd: [[f64; 3]; N],
    /// Covariance of the coefficients of each joint, bounds ignored (unused entries 0).
    pub covariance: [[[f64; 3]; 3]; N],
    /// What the coefficients are those of.
    pub basis: Basis,
    /// Torque offset per joint (Nm) (0 if left out).
    pub offset_nm: SVector<f64, N>,
    /// Unmodelled mass at the flange (kg) (0 if left out).
    pub payload_kg: f64,
    /// Weighted mean square of the residual [-]: near 1 / (correlation) when the law explains the log.
    pub mean_square: f64,
    /// Root mean square of the wrench [Nm Nm Nm N N N] before and after the fit.
    pub wrench_rms: [Vector6<f64>; 2],
    /// Samples used.
    pub samples: usize,
}

impl<const N: usize> GlsFit<N> {
    /// Standard deviation (Nm) of the friction of a joint that moves at qd [rad/s].
    pub fn torque_sd_nm(&self, joint: usize, qd: f64) -> f64 {
        let columns = self.basis.evaluate(qd, qd.signum());
        let weighted = |row: &[f64; 3]| row.iter().zip(&columns).map(|(c, x)| c * x).sum::<f64>();
        let rows = self.covariance[joint].iter().zip(&columns);
        rows.map(|(row, x)| x * weighted(row)).sum::<f64>().max(0.0).sqrt()
    }
}

/// Fits friction to the wrench that an estimator reports in free motion, in one log or several.
///
/// ```text
/// y_t = h_hat_t + W_t tau_f_hat_t = W_t Φ(qd_t) θ + e_t
/// Cov(e_t) = diag(moment², force²) + Σ_{j rests} W_j W_jᵀ Fc0²/3
/// ```
///
/// The friction of a joint that rests, or did just before or will just after, is anything within ±Fc, not Fc sign(qd): its sign column is dropped and its direction of the
/// wrench is widened by the variance of a uniform torque, which projects it out. Prior N(0, prior_sd²), bounds by a
/// box-constrained solve. This replaces naive least squares, which at low speed is wrong by 20–30 % in the cost.
pub fn fit_from_wrench<const N: usize>(
    logs: &[&[GlsSample<N>]],
    settings: &GlsSettings<N>,
) -> Result<GlsFit<N>, GlsError> {
    let columns = settings.basis.columns();
    let layout = Layout::new(settings);
    let (need, got) = (10 * layout.total, logs.iter().map(|log| log.len()).sum());
    if got < need {
        return Err(GlsError::TooFewSamples { need, got });
    }

    let samples = || logs.iter().copied().flatten();
    let equations = NormalEquations::of(samples(), 0, settings, &layout)?;
    let Solution { theta, covariance } = equations.solve(settings.correlated_samples, &layout);

    let mut coefficients = [[0.0; 3]; N];
    let mut sd = [[0.0; 3]; N];
    let mut covariance_of_joints = [[[0.0; 3]; 3]; N];
    for j in 0..N {
        for c in 0..columns {
            coefficients[j][c] = theta[j * columns + c];
            sd[j][c] = covariance[(j * columns + c, j * columns + c)].max(0.0).sqrt();
            for d in 0..columns {
                covariance_of_joints[j][c][d] = covariance[(j * columns + c, j * columns + d)];
            }
        }
    }
    let friction = FrictionModel { joints: coefficients.map(|c| settings.basis.law(&c)) };
    let offset_nm = SVector::from_fn(|j, _| layout.offset.map_or(0.0, |first| theta[first + j]));
    let payload_kg = layout.payload.map_or(0.0, |k| theta[k]);

    let mut before = Vector6::<f64>::zeros();
    let mut after = Vector6::<f64>::zeros();
    let mut rows = DMatrix::<f64>::zeros(6, layout.total);
    for sample in samples() {
        let y = sample.wrench + sample.wrench_from_torque * sample.tau_compensation;
        fill_rows(&mut rows, sample, settings, &layout);
        let residual = y - Vector6::from_iterator((&rows * &theta).iter().copied());
        before += sample.wrench.component_mul(&sample.wrench);
        after += residual.component_mul(&residual);
    }
    let count = got as f64;
    Ok(GlsFit {
        friction,
        coefficients,
        sd,
        covariance: covariance_of_joints,
        basis: settings.basis,
        offset_nm,
        payload_kg,
        mean_square: equations.square_left(&theta) / (6.0 * count),
        wrench_rms: [before, after].map(|sum| sum.map(|value| (value / count).sqrt())),
        samples: got,
    })
}

#[cfg(test)]
mod tests {
    use nalgebra::SMatrix;

    use super::*;

    /// A made-up arm whose map W turns slowly, so that seven torques show through six wrench components.
    fn samples(count: usize, truth: impl Fn(usize, f64) -> f64, compensation: f64) -> Vec<GlsSample<7>> {
        (0..count)
            .map(|t| {
                let time = t as f64 * 0.01;
                let w = SMatrix::<f64, 6, 7>::from_fn(|r, c| ((r * 7 + c) as f64 * 1.7 + 0.4 * time).sin());
                let qd = SVector::<f64, 7>::from_fn(|j, _| 0.1 * (time * (0.4 + 0.13 * j as f64) + j as f64).sin());
                let tau = SVector::<f64, 7>::from_fn(|j, _| truth(j, qd[j]));
                let tau_compensation = tau * compensation;
                let slides = std::array::from_fn(|j| qd[j].abs() >= 0.004);
                GlsSample { wrench: w * (tau - tau_compensation), wrench_from_torque: w, qd, slides, tau_compensation }
            })
            .collect()
    }

    #[test]
    fn recovers_the_parameters_it_was_given() {
        let truth = |j: usize, qd: f64| (0.5 + 0.1 * j as f64) * qd + (0.3 + 0.05 * j as f64) * qd.signum();
        let mut settings = GlsSettings::new(Basis::CoulombViscous);
        settings.prior_sd = [[100.0; 3]; 7];
        for compensation in [0.0, 0.7] {
            let fit = fit_from_wrench(&[&samples(3000, truth, compensation)], &settings).unwrap();
            for j in 0..7 {
                assert!((fit.coefficients[j][0] - (0.5 + 0.1 * j as f64)).abs() < 0.02, "{:?}", fit.coefficients[j]);
                assert!((fit.coefficients[j][1] - (0.3 + 0.05 * j as f64)).abs() < 0.002, "{:?}", fit.coefficients[j]);
            }
        }
    }

    #[test]
    fn several_logs_are_one_that_is_as_long() {
        let settings = GlsSettings::new(Basis::CoulombViscous);
        let all = samples(2000, |_, qd| 0.4 * qd.signum(), 0.5);
        let whole = fit_from_wrench(&[&all], &settings).unwrap();
        assert_eq!(fit_from_wrench(&[&all[..700], &all[700..]], &settings).unwrap(), whole);
        assert_ne!(fit_from_wrench(&[&all[..700]], &settings).unwrap(), whole);
    }

    #[test]
    fn bounds_hold_and_negative_friction_is_refused() {
        let fit = fit_from_wrench(
            &[&samples(2000, |_, qd| -0.5 * qd.signum(), 0.0)],
            &GlsSettings::new(Basis::CoulombViscous),
        )
        .unwrap();
        assert!(fit.coefficients.iter().flatten().all(|&c| c >= 0.0));
    }

    #[test]
    fn too_few_or_broken_samples_are_errors() {
        let settings = GlsSettings::new(Basis::CoulombViscous);
        let mut some = samples(500, |_, qd| qd, 0.0);
        assert!(matches!(fit_from_wrench(&[&some[..10]], &settings), Err(GlsError::TooFewSamples { got: 10, .. })));
        some[3].wrench[2] = f64::NAN;
        assert_eq!(fit_from_wrench(&[&some], &settings), Err(GlsError::NotFinite { index: 3 }));
    }
}
