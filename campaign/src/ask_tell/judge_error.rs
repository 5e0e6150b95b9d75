//! Why a log cannot be judged.

use tribo_logs::Quantity;
use tribo_trial::EstimatorError;

/// Why a log cannot be judged.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum JudgeError {
    /// Another robot.
    #[error("{found} joints; the robot of the campaign has {expected}")]
    Joints {
        /// Joints of the log.
        found: usize,
        /// Joints of the campaign's robot.
        expected: usize,
    },
    /// A column is missing.
    #[error("missing columns {column}, {why}")]
    Missing {
        /// The columns.
        column: Quantity,
        /// What for, and what to do.
        why: &'static str,
    },
    /// The log ends before the trial should.
    #[error("ends after {found_s:.3} s, a trial takes {expected_s} s; if it was stopped, say so: --failed REASON")]
    Short {
        /// Length of the log (s).
        found_s: f64,
        /// Length of run-in and judged part (s).
        expected_s: f64,
    },
    /// A stretch is missing.
    #[error(
        "a gap of {gap_s:.3} s at time {at_s:.3} s; a trial needs one stretch without gaps beyond {allowed_s:.3} s"
    )]
    Gap {
        /// Time before the gap (s).
        at_s: f64,
        /// Its length (s).
        gap_s: f64,
        /// The longest that is bridged (s).
        allowed_s: f64,
    },
    /// An estimate that stands still costs nothing.
    #[error("the estimator could use {} of {samples} judged samples; a trial needs {} %", samples - faults, 100.0 * LEAST_USED)]
    Unused {
        /// Judged samples.
        samples: usize,
        /// Those that could not be used.
        faults: usize,
    },
    /// The trial of another compensator.
    #[error(
        "tau_friction_{joint} is not what was asked for: {logged_nm:.3} Nm RMS where the joint moves, {asked_nm:.3} Nm asked, {apart_nm:.3} Nm apart; \
         is it the log of another trial, or its sign or unit another?"
    )]
    OtherCompensation {
        /// The joint.
        joint: usize,
        /// RMS of what the log says was added (Nm).
        logged_nm: f64,
        /// RMS of what the asked compensator adds at the speeds of the log (Nm).
        asked_nm: f64,
        /// RMS of the difference (Nm).
        apart_nm: f64,
    },
    /// Positions or torques that are no arm's.
    #[error("its cost is {0}: no arm has such positions, speeds or torques")]
    NotFinite(f64),
    /// No estimator.
    #[error(transparent)]
    Estimator(#[from] EstimatorError),
}

/// Least share of the judged samples that the estimator uses.
pub(super) const LEAST_USED: f64 = 0.95;
