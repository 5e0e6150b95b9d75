//! Joints that the motion of a campaign does not move.

use std::fmt;

use serde::{Deserialize, Serialize};

/// A joint that its dry friction held in all of the last logs: no fit knows more of that than the torque that did not move it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Standing {
    /// The joint, from 0.
    pub joint: usize,
    /// Largest torque beyond gravity and Coriolis forces that did not move it (Nm).
    pub held_nm: f64,
}

/// `joints 4, 6 stood still in the last logs, …`.
pub struct Standings<'a>(pub &'a [Standing]);

impl fmt::Display for Standings<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let list = |of: &dyn Fn(&Standing) -> String| self.0.iter().map(of).collect::<Vec<_>>().join(", ");
        let (joints, held) = (list(&|it| it.joint.to_string()), list(&|it| format!("{:.2}", it.held_nm)));
        let (joint, is) = if self.0.len() == 1 { ("joint", "its") } else { ("joints", "their") };
        write!(
            f,
            "{joint} {joints} stood still in the last logs: {is} dry friction is at least {held} Nm and not known further; a motion that \
             turns {joint} {joints} more would tell it"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn says_which_joints_stand_and_what_would_help() {
        let standing = [Standing { joint: 4, held_nm: 0.594 }, Standing { joint: 6, held_nm: 0.031 }];
        assert_eq!(
            Standings(&standing).to_string(),
            "joints 4, 6 stood still in the last logs: their dry friction is at least 0.59, 0.03 Nm and not known further; a motion that \
             turns joints 4, 6 more would tell it"
        );
        assert!(
            Standings(&standing[..1]).to_string().starts_with("joint 4 stood still in the last logs: its dry friction")
        );
    }
}
