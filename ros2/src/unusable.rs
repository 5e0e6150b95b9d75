//! Why a message moves no estimator.

/// What is wrong with a `JointState`, as one sentence without its topic.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unusable {
    /// It is no CDR of that message.
    #[error("{0}")]
    Broken(String),
    /// It lacks joints of the arm.
    #[error("has the joints {found}, which lack {missing}")]
    NoArm {
        /// Names in the message, or how many entries without names.
        found: String,
        /// The joints that are missing, or how many an arm has.
        missing: String,
    },
    /// It has no torques.
    #[error("has no effort; a wrench needs the torque of every joint")]
    NoEffort,
    /// A list is not as long as the names.
    #[error("{list} has {found} entries, expected {expected}")]
    Entries {
        /// The list.
        list: &'static str,
        /// Its length.
        found: usize,
        /// That of the names.
        expected: usize,
    },
    /// A number is NaN or infinite.
    #[error("{list} of {joint} is not finite")]
    NotFinite {
        /// The list.
        list: &'static str,
        /// Name of the joint.
        joint: String,
    },
    /// Its stamp is not later than the one before.
    #[error("header.stamp is not later than the one before it")]
    NotLater,
    /// Its stamp is zero.
    #[error("header.stamp is not set; the time between messages comes from it")]
    NoStamp,
}
