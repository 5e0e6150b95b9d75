//! What a log of the user's robot is worth.

use nalgebra::{SVector, Translation3, UnitQuaternion, Vector6};
use tribo_control::{TaskState, TorqueTerms};
use tribo_friction::{Bristles, Compensator, CompensatorInput, VelocitySource};
use tribo_logs::{GAP_TOLERANCE, Quantity, RobotLog, bursts, median_period_s, row};
use tribo_robot::{ControlTerms, EstimatorInput, Pose, SensorFrame, WrenchEstimate, WrenchEstimator};
use tribo_runtime::{LONGEST_GAP_PERIODS, TickRecord};
use tribo_trial::{AnyEstimator, Cost, CostAccumulator, EstimatorName, TrialLog, frame_at};

use super::judge_error::{JudgeError, LEAST_USED};
use super::logged_compensation::LoggedCompensation;
use super::{SentTorque, UserTrials};
use crate::ValidTune;

/// A trial that ran elsewhere, judged.
#[derive(Clone, Debug, PartialEq)]
pub struct JudgedLog<const N: usize> {
    /// The cost and its parts.
    pub cost: Cost,
    /// Time of the failure since the start of the judged part (s), of a trial that failed.
    pub aborted_at_s: Option<f64>,
    /// The decimated log. Task and null-space torque are not told apart; reference and error are not known.
    pub log: TrialLog<N>,
    /// Judged samples.
    pub samples: usize,
    /// Those of them that the estimator could not use.
    pub faults: usize,
    /// Whether the log says itself what the compensator added.
    pub logged_compensation: bool,
}

/// Period of the decimated log (s).
const LOG_PERIOD_S: f64 = 0.01;

/// Judges the log of a trial that ran with parameters θ on the user's robot, by the estimator of the campaign.
///
/// What acted between two samples is what was commanded at the first (of measured torque, the mean of both). The compensator's part of it is
/// `tau_friction`, or else the compensator at θ at the velocities of the log: of one that believes the measured velocity. Near rest the others
/// believe the reference velocity, which logs do not hold; theirs have to say what was added. Stamps count to the nanosecond, so that the log of a simulated
/// trial gives the bits of that trial. The last sample of a trial that `failed` is the one at which it failed.
///
/// # Errors
/// A log of another robot, one without the columns that are needed, with a gap, or too short for a trial that did not fail.
pub fn judge_log<const N: usize>(
    tune: &ValidTune<N>,
    user_trials: &UserTrials,
    theta: &[f64],
    log: &RobotLog,
    failed: bool,
) -> Result<JudgedLog<N>, JudgeError> {
    check::<N>(log, user_trials, tune.config.residual, failed)?;
    let (arm, friction) = (&tune.trial.model, tune.space.friction(theta));
    let told = log.tau_friction_nm.is_some() || tune.config.velocity == VelocitySource::Measured;
    if !told && theta != tune.space.zero() {
        return Err(JudgeError::Missing { column: Quantity::FrictionCompensation, why: NOT_TOLD });
    }
    let mut estimator = AnyEstimator::for_tuning(tune.config.residual, tune.config.ekf, &tune.trial, &friction)?;
    let compensator = Compensator::new(friction, VelocitySource::Measured).with_effects(tune.trial.effects);
    let mut bristles = Bristles::default();
    let mut compensation = LoggedCompensation::new();
    let (mut accumulator, mut samples, mut faults) = (CostAccumulator::new(tune.trial.measure), 0, 0);
    let period_s = nanoseconds(median_period_s(&log.time_s).unwrap_or_default());
    let every = (LOG_PERIOD_S / period_s).round().max(1.0);
    let log_period_s = every * period_s;
    let mut decimated = TrialLog::with_capacity((log.rows() as f64 / every) as usize + 1, log_period_s);
    let (mut acted, mut estimate) = (None, WrenchEstimate::none_yet());

    for k in 0..log.rows() {
        let since_start_s = log.time_s[k] - log.time_s[0];
        let since_judged_s = since_start_s - user_trials.judged_from_s;
        // Half a period decides between neighbours, whatever the rounding of the stamps.
        let judged = since_judged_s > -0.5 * period_s;
        if since_judged_s > user_trials.judged_s - 0.5 * period_s || (failed && k + 1 == log.rows()) {
            break;
        }
        let frame: SensorFrame<N> = frame_at(log, k);
        let terms = ControlTerms::at(arm, &frame.q, &frame.qd);
        let dt_s = if k == 0 { period_s } else { nanoseconds(log.time_s[k] - log.time_s[k - 1]) };
        match acted {
            None => estimator.reset(&frame, &terms),
            Some((tau_motor, tau_friction)) => {
                let tau_motor: SVector<f64, N> = match user_trials.torque {
                    SentTorque::Measured => (tau_motor + frame.tau) * 0.5,
                    SentTorque::Commanded | SentTorque::CommandedWithoutGravity => tau_motor,
                };
                estimate = estimator.step(&EstimatorInput {
                    frame: &frame,
                    terms: &terms,
                    tau_motor: &tau_motor,
                    tau_friction: &tau_friction,
                    acceleration_command: &Vector6::zeros(),
                    dt_s,
                });
            }
        }
        if judged {
            accumulator.add(&estimate.wrench_base);
            samples += 1;
            faults += usize::from(estimate.fault.is_some());
        }

        // What acts until the next sample.
        let (q, qd_measured, qd_reference, load_nm) = (frame.q, frame.qd, frame.qd, terms.bias_nm());
        let input = CompensatorInput { q, qd_measured, qd_reference, load_nm, dt_s };
        let believed = compensator.tick(&mut bristles, &input);
        if let Some(all) = &log.tau_friction_nm {
            compensation.add(&frame.qd, &row(all, k).into(), &believed.total());
        }
        let law_nm = log
            .tau_friction_nm
            .as_ref()
            .map_or(believed.law_nm, |all| SVector::from(row(all, k)) - believed.effects_nm);
        let command = match (user_trials.torque, &log.tau_j_d_nm) {
            (SentTorque::Commanded, Some(tau)) => row(tau, k).into(),
            (SentTorque::CommandedWithoutGravity, Some(tau)) => SVector::from(row(tau, k)) + terms.gravity_nm,
            _ => frame.tau,
        };
        acted = Some((command, law_nm + believed.effects_nm));
        if since_start_s >= decimated.len() as f64 * log_period_s - 0.5 * period_s {
            let torque = TorqueTerms {
                task: command - law_nm - believed.effects_nm - terms.coriolis_nm - terms.gravity_nm,
                nullspace: SVector::zeros(),
                coriolis: terms.coriolis_nm,
                gravity: terms.gravity_nm,
                friction: law_nm,
                effects: believed.effects_nm,
            };
            let task = TaskState { error: Vector6::repeat(f64::NAN), ..TaskState::zero() };
            let nowhere =
                Pose::from_parts(Translation3::new(f64::NAN, f64::NAN, f64::NAN), UnitQuaternion::identity().into());
            let record = TickRecord {
                frame,
                estimate,
                reference: nowhere,
                task,
                torque,
                command,
                saturated: false,
                guard: None,
                fault: None,
            };
            decimated.push(since_judged_s, &record);
        }
    }

    let aborted_at_s = failed.then(|| log.time_s[log.rows() - 1] - log.time_s[0] - user_trials.judged_from_s);
    if !failed && (samples - faults) as f64 <= LEAST_USED * samples as f64 {
        return Err(JudgeError::Unused { samples, faults });
    }
    compensation.is_the_asked_one()?;
    let cost = accumulator.finish(aborted_at_s, user_trials.judged_s);
    if !cost.total().is_finite() {
        return Err(JudgeError::NotFinite(cost.total()));
    }
    Ok(JudgedLog {
        cost,
        samples,
        aborted_at_s,
        log: decimated,
        faults,
        logged_compensation: log.tau_friction_nm.is_some(),
    })
}

/// Why the torque of the compensator cannot be worked out.
const NOT_TOLD: &str = "what the compensator added: near rest it believes the reference velocity, which logs do not hold; log it, or begin a \
     campaign with --velocity measured";

/// Whether the log holds what it takes to judge it.
fn check<const N: usize>(
    log: &RobotLog,
    user_trials: &UserTrials,
    residual: EstimatorName,
    failed: bool,
) -> Result<(), JudgeError> {
    if log.joints() != N {
        return Err(JudgeError::Joints { found: log.joints(), expected: N });
    }
    if user_trials.torque != SentTorque::Measured && log.tau_j_d_nm.is_none() {
        let why = "the torque that was sent; a campaign can begin with --torque measured instead, if tau_J is that of the motors";
        return Err(JudgeError::Missing { column: Quantity::TorqueDesired, why });
    }
    if residual == EstimatorName::DoubleEncoder && log.theta_rad.is_none() {
        return Err(JudgeError::Missing { column: Quantity::MotorPosition, why: "which double_encoder needs" });
    }
    let period_s = median_period_s(&log.time_s).unwrap_or_default();
    let tolerance = GAP_TOLERANCE.max(LONGEST_GAP_PERIODS);
    if let Some(end) = bursts(&log.time_s, tolerance).first().map(|burst| burst.end).filter(|end| *end < log.rows()) {
        let (at_s, gap_s) = (log.time_s[end - 1], log.time_s[end] - log.time_s[end - 1]);
        return Err(JudgeError::Gap { at_s, gap_s, allowed_s: tolerance * period_s });
    }
    let found_s = log.time_s[log.rows() - 1] - log.time_s[0];
    let expected_s = user_trials.judged_from_s + user_trials.judged_s;
    if !failed && found_s < expected_s - 1.5 * period_s {
        return Err(JudgeError::Short { found_s, expected_s });
    }
    Ok(())
}

/// A time (s) to the nanosecond: the difference of two stamps is off by the rounding of both.
fn nanoseconds(time_s: f64) -> f64 {
    (time_s * 1e9).round() / 1e9
}

#[cfg(test)]
mod tests {
    use tribo_logs::LogColumns;

    use super::*;
    use crate::TuneConfig;
    use tribo_trial::simulate_log;

    /// An estimate that stands still because nothing of the log can be used costs nothing, and is refused: J of 0 would be the best there is.
    #[test]
    fn a_log_of_which_nothing_can_be_used_is_refused() {
        let user_trials = UserTrials { judged_from_s: 0.2, judged_s: 1.0, ..UserTrials::default() };
        let config = TuneConfig { user_trials: Some(user_trials), ..TuneConfig::default() };
        let linear = TuneConfig { residual: EstimatorName::Momentum, ..config.clone() }.validate::<7>().unwrap();
        let mut tune = config.validate::<7>().unwrap();
        tune.trial.reference.duration_s = 1.0;
        let friction = tune.space.friction(&tune.space.zero());
        let estimator =
            AnyEstimator::for_tuning(tune.config.residual, tune.config.ekf, &tune.trial, &friction).unwrap();
        let (_, log) = simulate_log(&tune.trial, &friction, estimator, 1).unwrap();
        let judged = |log: &RobotLog| judge_log(&tune, &user_trials, &tune.space.zero(), log, false);
        let whole = judged(&log).unwrap();
        assert_eq!((whole.samples, whole.faults), (1000, 0));
        let with_torque = |tau_nm: f64| {
            let absurd = log.tau_j_d_nm.as_ref().map(|all| all.iter().map(|tau| vec![tau_nm; tau.len()]).collect());
            LogColumns { tau_j_d_nm: absurd, ..log.clone().into_columns() }.validate().unwrap()
        };
        // Torques of which the sum over the joints is no number.
        match judged(&with_torque(f64::MAX)) {
            Err(JudgeError::Unused { samples: 1000, faults }) => assert!(faults > 990, "{faults}"),
            other => panic!("{:?}", other.map(|judged| (judged.cost, judged.faults))),
        }
        // Torques that an estimator without a check of its own takes, of which the sum over the samples is no number.
        match judge_log(&linear, &user_trials, &linear.space.zero(), &with_torque(1e306), false) {
            Err(JudgeError::NotFinite(cost)) => assert!(!cost.is_finite()),
            other => panic!("{:?}", other.map(|judged| (judged.cost, judged.faults))),
        }
    }
}
