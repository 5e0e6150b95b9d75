//! Why a robot with two encoders could not be calibrated.

use tribo_bayesopt::BayesoptError;

/// What is wrong with the settings or the data, with what would mend it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CalibrationError {
    /// A setting outside its range.
    #[error("setting {field} = {value}: allowed is {allowed}")]
    BadSetting {
        /// Field of the settings.
        field: &'static str,
        /// What was given.
        value: f64,
        /// The allowed range, in words.
        allowed: &'static str,
    },
    /// The log has another number of joints than the arm.
    #[error("the log has {got} joints, the arm {need}")]
    JointCount {
        /// Joints of the arm.
        need: usize,
        /// Joints of the log.
        got: usize,
    },
    /// No motor-side encoder.
    #[error("the log has no columns theta_i (motor positions): a calibration needs both encoders of every joint")]
    NoMotorPositions,
    /// Too few rests without load.
    #[error("{got} rests without load, {need} are needed: hold the arm at more poses")]
    TooFewPoses {
        /// Fewest that can be used.
        need: usize,
        /// Rests at hand.
        got: usize,
    },
    /// Too few known loads on a joint.
    #[error(
        "joint {joint}: {got} known loads, {need} are needed: push the tool at rest, with the wrench in O_F_ext_0..5"
    )]
    TooFewLoads {
        /// The joint, from 0.
        joint: usize,
        /// Fewest that can be used.
        need: usize,
        /// Loads at hand.
        got: usize,
    },
    /// The known loads do not turn the joint, or not by different amounts.
    #[error("joint {joint}: the known loads do not deflect it: push where they have a lever about it")]
    NoLoadRange {
        /// The joint, from 0.
        joint: usize,
    },
    /// A stiffness that is not positive: usually a sign of the wrench or of theta.
    #[error(
        "joint {joint}: the fitted stiffness is {stiffness_nm_per_rad} Nm/rad; check the signs of theta and of the wrench"
    )]
    SoftJoint {
        /// The joint, from 0.
        joint: usize,
        /// The fitted slope (Nm/rad).
        stiffness_nm_per_rad: f64,
    },
    /// The Gaussian process of a joint could not be fitted.
    #[error("joint {joint}: {source}")]
    Regression {
        /// The joint, from 0.
        joint: usize,
        /// Why.
        source: BayesoptError,
    },
}
