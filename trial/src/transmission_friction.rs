//! Friction of the gears from a log with torque on both of their sides.

use tribo_friction::identify::{JointTorqueFit, TorqueFitError, fit_columns};
use tribo_friction::law::smooth_sign;
use tribo_logs::{Resampling, RobotLog, resample};
use tribo_regression::{filter::ZeroPhaseLowPass, rms};

/// Band (Hz): no acceleration is needed here, whose noise keeps the residual of a whole arm at 10 Hz.
const BAND_HZ: f64 = 15.0;
/// Highest band over the rate of the log.
const HIGHEST_BAND: f64 = 0.35;
/// Order of each of the two passes of the filter.
const ORDER: usize = 4;
/// Time at each end of a burst that follows the filter's guess of what was before, in periods of the band.
const TRIM_PERIODS: f64 = 1.5;

/// What the gears of every joint take, and how much of it three numbers per joint explain.
///
/// ```text
/// F(tau_J − tau_link) = Fc F(tanh(qd/ε)) + Fv F(qd) + offset        least squares over all bursts
/// ```
///
/// `tau_J` is measured on the motor side, `tau_link` behind the gear; F is a zero-phase low-pass. No model of the arm is
/// needed and the number of joints is that of the log.
/// Leaves out: rotor inertia, which the difference holds too, and friction that depends on load, position or heat; `tribo
/// diagnose` names those.
#[derive(Clone, Debug, PartialEq)]
pub struct TransmissionFriction {
    /// Cut-off of F (Hz).
    pub band_hz: f64,
    /// Samples behind the figures of each joint.
    pub samples: usize,
    /// ε (rad/s).
    pub smoothing_rad_s: f64,
    /// One entry per joint.
    pub joints: Vec<TransmissionJoint>,
}

/// One joint of [`TransmissionFriction`].
#[derive(Clone, Debug, PartialEq)]
pub struct TransmissionJoint {
    /// RMS of the filtered difference (Nm).
    pub rms_before_nm: f64,
    /// The fit and the RMS of what it leaves (Nm), or why there is none.
    pub fit: Result<(JointTorqueFit, f64), TorqueFitError>,
}

/// Condition of the fit beyond which dry friction and offset are one number: of the Kinova logs, joints that turn both ways
/// have 15 to 20, joints that turn one way 2e4 to 2e8.
const ONE_WAY_CONDITION: f64 = 1e3;

impl TransmissionJoint {
    /// Whether the joint turned one way only, so that Coulomb friction and offset have a sum and no values of their own.
    #[must_use]
    pub fn one_way(&self) -> bool {
        self.fit.as_ref().is_ok_and(|(fit, _)| fit.condition > ONE_WAY_CONDITION)
    }
}

/// Why a log with torque on both sides gives no friction.
#[derive(Debug, thiserror::Error)]
pub enum TransmissionError {
    /// The log could not be resampled.
    #[error(transparent)]
    Log(#[from] tribo_files::LogError),
    /// The filter does not fit the rate.
    #[error(transparent)]
    Filter(#[from] tribo_regression::filter::FilterError),
    /// No burst outlasts the ends that the filter spoils.
    #[error("friction of the gears needs a burst longer than {need_s:.2} s; the log has {bursts} shorter ones")]
    TooShort {
        /// Length that a burst must exceed (s).
        need_s: f64,
        /// Bursts of the log.
        bursts: usize,
    },
}

/// The signals of one joint, all bursts after one another, filtered and trimmed.
#[derive(Default)]
struct Signals {
    lost_nm: Vec<f64>,
    sign: Vec<f64>,
    qd: Vec<f64>,
}

impl TransmissionFriction {
    /// Friction of the gears in a log; `None` if the log has no `tau_link_i`.
    ///
    /// # Errors
    /// [`TransmissionError`].
    pub fn of_log(log: &RobotLog, smoothing_rad_s: f64) -> Result<Option<Self>, TransmissionError> {
        if log.tau_link_nm.is_none() {
            return Ok(None);
        }
        let resampled = resample(log, &Resampling::default())?;
        let rate_hz = resampled.period_s.recip();
        let band_hz = BAND_HZ.min(HIGHEST_BAND * rate_hz);
        let filter = ZeroPhaseLowPass::butterworth(ORDER, band_hz, rate_hz)?;
        let trim = (TRIM_PERIODS / band_hz * rate_hz).ceil() as usize;

        let mut joints: Vec<Signals> = (0..log.joints()).map(|_| Signals::default()).collect();
        for burst in resampled.bursts.iter().filter(|burst| burst.rows() > 2 * trim) {
            let kept = trim..burst.rows() - trim;
            for ((j, joint), link) in joints.iter_mut().enumerate().zip(burst.tau_link_nm.iter().flatten()) {
                let (motor, qd) = (&burst.tau_j_nm[j], &burst.dq_rad_s[j]);
                let lost_nm: Vec<f64> = motor.iter().zip(link).map(|(motor, link)| motor - link).collect();
                let sign: Vec<f64> = qd.iter().map(|&v| smooth_sign(v, smoothing_rad_s)).collect();
                joint.lost_nm.extend_from_slice(&filter.filter(&lost_nm)[kept.clone()]);
                joint.sign.extend_from_slice(&filter.filter(&sign)[kept.clone()]);
                joint.qd.extend_from_slice(&filter.filter(qd)[kept.clone()]);
            }
        }
        let samples = joints.first().map_or(0, |joint| joint.lost_nm.len());
        if samples == 0 {
            let bursts = resampled.bursts.len() + resampled.skipped_bursts;
            return Err(TransmissionError::TooShort { need_s: 2.0 * trim as f64 / rate_hz, bursts });
        }
        Ok(Some(Self { band_hz, samples, smoothing_rad_s, joints: joints.iter().map(Signals::fit).collect() }))
    }
}

impl Signals {
    fn fit(&self) -> TransmissionJoint {
        let rows = 0..self.lost_nm.len();
        let ones = vec![1.0; rows.len()];
        let columns = [&self.sign[..], &self.qd, &ones];
        let fit = fit_columns(&columns, &self.lost_nm, std::slice::from_ref(&rows)).map(|fit| {
            let predicted =
                |k: usize| -> f64 { columns.iter().zip(&fit.coefficients).map(|(c, theta)| theta * c[k]).sum() };
            let left: Vec<f64> = rows.map(|k| self.lost_nm[k] - predicted(k)).collect();
            let found = JointTorqueFit {
                coulomb_nm: fit.coefficients[0],
                viscous_nm_s_per_rad: fit.coefficients[1],
                offset_nm: fit.coefficients[2],
                condition: fit.condition,
            };
            (found, rms(&left))
        });
        TransmissionJoint { rms_before_nm: rms(&self.lost_nm), fit }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tribo_logs::LogColumns;

    const SMOOTHING_RAD_S: f64 = 0.005;

    /// Friction of joint j: Coulomb, viscous, offset.
    const TRUTH: [[f64; 3]; 3] = [[0.8, 0.5, -0.2], [3.0, -0.1, 0.4], [0.05, 2.0, 0.0]];

    /// Twelve seconds at 500 Hz with a hole of two seconds; link torque of some motion, motor torque with friction on top.
    fn log(moves: [f64; 3]) -> RobotLog {
        let time_s: Vec<f64> = (0..6000).filter(|k| !(2000..3000).contains(k)).map(|k| f64::from(k) * 2e-3).collect();
        let swing = |j: usize, t: f64| moves[j] * (0.6 + 0.3 * j as f64) * ((1.1 + 0.7 * j as f64) * t).sin();
        let qd = |j: usize| time_s.iter().map(|&t| swing(j, t)).collect::<Vec<f64>>();
        let link = |j: usize| time_s.iter().map(|&t| 9.0 * (2.3 * t + j as f64).cos()).collect::<Vec<f64>>();
        let motor = |j: usize| -> Vec<f64> {
            let [coulomb, viscous, offset] = TRUTH[j];
            let friction = |v: f64| coulomb * (v / SMOOTHING_RAD_S).tanh() + viscous * v + offset;
            qd(j).into_iter().zip(link(j)).map(|(v, link)| link + friction(v)).collect()
        };
        LogColumns {
            q_rad: (0..3).map(qd).collect(),
            dq_rad_s: (0..3).map(qd).collect(),
            tau_j_nm: (0..3).map(motor).collect(),
            tau_link_nm: Some((0..3).map(link).collect()),
            time_s,
            ..LogColumns::default()
        }
        .validate()
        .unwrap()
    }

    #[test]
    fn known_friction_is_found_in_a_log_of_any_number_of_joints() {
        let found = TransmissionFriction::of_log(&log([1.0; 3]), SMOOTHING_RAD_S).unwrap().unwrap();
        // Two bursts of 4 and 6 s, 0.1 s off each of four ends.
        assert_eq!((found.joints.len(), found.samples, found.band_hz), (3, 5000 - 4 * 50, BAND_HZ));
        for (joint, [coulomb, viscous, offset]) in found.joints.iter().zip(TRUTH) {
            let (fit, rms_after_nm) = joint.fit.as_ref().unwrap();
            for (got, expected) in
                [(fit.coulomb_nm, coulomb), (fit.viscous_nm_s_per_rad, viscous), (fit.offset_nm, offset)]
            {
                assert!((got - expected).abs() < 1e-9, "{got} for {expected}");
            }
            assert!(*rms_after_nm < 1e-9 && joint.rms_before_nm > 0.05, "{rms_after_nm}");
        }
    }

    #[test]
    fn joints_at_rest_short_logs_and_one_torque_are_told_apart() {
        let found = TransmissionFriction::of_log(&log([1.0, 0.0, 1.0]), SMOOTHING_RAD_S).unwrap().unwrap();
        assert!(matches!(found.joints[1].fit, Err(TorqueFitError::NotSeparable { .. })));
        assert!((found.joints[1].rms_before_nm - 0.4).abs() < 1e-9, "the offset alone");
        assert!(found.joints[0].fit.is_ok() && found.joints[2].fit.is_ok());
        assert!(!found.joints[0].one_way());

        // Joint 0 slows down and never turns back.
        let mut one_way = log([1.0; 3]).into_columns();
        let friction = |v: f64| TRUTH[0][0] * (v / SMOOTHING_RAD_S).tanh() + TRUTH[0][1] * v + TRUTH[0][2];
        for k in 0..one_way.rows() {
            let v = 0.01 + one_way.dq_rad_s[0][k].abs();
            one_way.dq_rad_s[0][k] = v;
            one_way.tau_j_nm[0][k] = one_way.tau_link_nm.as_ref().unwrap()[0][k] + friction(v);
        }
        let found = TransmissionFriction::of_log(&one_way.validate().unwrap(), SMOOTHING_RAD_S).unwrap().unwrap();
        assert!(found.joints[0].one_way() && !found.joints[1].one_way(), "{found:?}");

        let short = log([1.0; 3]).slice(0..100).unwrap();
        let error = TransmissionFriction::of_log(&short, SMOOTHING_RAD_S).unwrap_err().to_string();
        assert_eq!(error, "friction of the gears needs a burst longer than 0.20 s; the log has 1 shorter ones");

        let one_side = LogColumns { tau_link_nm: None, ..log([1.0; 3]).into_columns() }.validate().unwrap();
        assert_eq!(TransmissionFriction::of_log(&one_side, SMOOTHING_RAD_S).unwrap(), None);
    }
}
