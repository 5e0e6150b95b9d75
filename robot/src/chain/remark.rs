//! What was decided while an arm was read, since its description leaves it open.

use std::fmt;

/// A decision that the user should know of.
#[derive(Clone, Debug, PartialEq)]
pub enum ChainRemark {
    /// Of several chains, this one is the arm.
    Chosen {
        /// The base.
        base: String,
        /// The tip.
        tip: String,
    },
    /// Joints beside or beyond the chain are held where the description draws them, and what they move is part of the arm.
    Held {
        /// Names of the joints.
        joints: Vec<String>,
    },
    /// Joints without a torque limit: it is assumed, see [`crate::SerialChain::arm`].
    NoTorqueLimit {
        /// Names of the joints.
        joints: Vec<String>,
    },
    /// Joints without a speed limit: π rad/s is assumed.
    NoSpeedLimit {
        /// Names of the joints.
        joints: Vec<String>,
    },
    /// Something of the file that is not read, in words.
    NotRead(String),
}

impl fmt::Display for ChainRemark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Chosen { base, tip } => {
                write!(f, "the arm goes from `{base}` to `{tip}` (--base-link and --tip-link name others)")
            }
            Self::Held { joints } => {
                write!(f, "held where the file draws them, as they are not between base and tip: {}", joints.join(", "))
            }
            Self::NoTorqueLimit { joints } => write!(
                f,
                "no torque limit of {}: assumed is what holds the arm anywhere, turns its friction and accelerates each \
                 joint by 10 rad/s² (limits.tau_max_nm of a model file says better)",
                range(joints)
            ),
            Self::NoSpeedLimit { joints } => write!(
                f,
                "no speed limit of {}: assumed is π rad/s (limits.qd_max_rad_s of a model file says better)",
                range(joints)
            ),
            Self::NotRead(what) => write!(f, "not read: {what}"),
        }
    }
}

/// Names in few words.
fn range(joints: &[String]) -> String {
    match joints {
        [first, _, _, .., last] => format!("{} joints, `{first}` to `{last}`", joints.len()),
        few => few.join(", "),
    }
}
