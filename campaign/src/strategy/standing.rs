//! Joints that the motion of a campaign does not move.

use serde::{Deserialize, Serialize};
use tribo_robot::JointNames;

/// A joint that its dry friction held in all of the last logs: no fit knows more of that than the torque that did not move it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Standing {
    /// The joint, from 0.
    pub joint: usize,
    /// Largest torque beyond gravity and Coriolis forces that did not move it (Nm).
    pub held_nm: f64,
}

/// `joints 4 and 6 stood still in the last logs, …`.
pub fn standing_sentence(standing: &[Standing], names: &JointNames) -> String {
    let joints = names.several(&standing.iter().map(|it| it.joint).collect::<Vec<_>>());
    let held = standing.iter().map(|it| format!("{:.2}", it.held_nm)).collect::<Vec<_>>().join(", ");
    let its = if standing.len() == 1 { "its" } else { "their" };
    format!(
        "{joints} stood still in the last logs: {its} dry friction is at least {held} Nm and not known further; a motion that turns \
         {joints} more would tell it: a longer path, or one joint at a time back and forth"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn says_which_joints_stand_and_what_would_help() {
        let standing = [Standing { joint: 4, held_nm: 0.594 }, Standing { joint: 6, held_nm: 0.031 }];
        let sentence = |of: &[Standing]| standing_sentence(of, &JointNames::default());
        assert_eq!(
            sentence(&standing),
            "joints 4 and 6 stood still in the last logs: their dry friction is at least 0.59, 0.03 Nm and not known further; a motion that \
             turns joints 4 and 6 more would tell it: a longer path, or one joint at a time back and forth"
        );
        assert!(sentence(&standing[..1]).starts_with("joint 4 stood still in the last logs: its dry friction"));
    }
}
