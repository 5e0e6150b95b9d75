//! What people call the joints of an arm.

use std::fmt;
use std::sync::Arc;

/// Names of an arm's joints, base to tool, for people: `panda_joint4 (3)` is the joint of the columns `q_3`, `tau_J_3` …; where nobody
/// knows a name, `joint 3`. Files hold the number alone.
///
/// ```
/// use tribo_robot::{JointNames, presets};
///
/// assert_eq!(presets::panda().joint_names.of(3).to_string(), "panda_joint4 (3)");
/// assert_eq!(JointNames::default().of(3).to_string(), "joint 3");
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct JointNames(Arc<[String]>);

/// One joint as people read it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NamedJoint<'a> {
    /// Its name, where somebody gave it one.
    pub name: Option<&'a str>,
    /// Its number, from 0.
    pub joint: usize,
}

impl JointNames {
    /// `panda_joint1`, `panda_joint2` … of a prefix.
    pub(crate) fn numbered(prefix: &str, joints: usize) -> Self {
        (1..=joints).map(|number| format!("{prefix}{number}")).collect()
    }

    /// A joint, from 0.
    pub fn of(&self, joint: usize) -> NamedJoint<'_> {
        let name = self.0.get(joint).map(String::as_str).filter(|name| !name.is_empty());
        NamedJoint { name, joint }
    }

    /// Several joints, as in a sentence: `panda_joint2 (1) and panda_joint4 (3)`, else `joints 1 and 3`; `all joints` of three or more.
    pub fn several(&self, joints: &[usize]) -> String {
        if joints.len() > 2 && joints.iter().copied().eq(0..self.0.len()) {
            return "all joints".to_owned();
        }
        let named = joints.iter().all(|joint| self.of(*joint).name.is_some());
        let (before, parts): (_, Vec<String>) = if named || joints.len() == 1 {
            ("", joints.iter().map(|joint| self.of(*joint).to_string()).collect())
        } else {
            ("joints ", joints.iter().map(ToString::to_string).collect())
        };
        match &parts[..] {
            [] => "no joint".to_owned(),
            [one] => one.clone(),
            [most @ .., last] => format!("{before}{} and {last}", most.join(", ")),
        }
    }
}

impl FromIterator<String> for JointNames {
    fn from_iter<I: IntoIterator<Item = String>>(names: I) -> Self {
        Self(names.into_iter().collect())
    }
}

impl fmt::Display for NamedJoint<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.name {
            Some(name) => f.pad(&format!("{name} ({})", self.joint)),
            None => f.pad(&format!("joint {}", self.joint)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_joint_has_its_name_and_its_number_or_its_number_alone() {
        let names: JointNames = ["shoulder", "", "wrist"].map(str::to_owned).into_iter().collect();
        let of = |joint| names.of(joint).to_string();
        assert_eq!([of(0), of(1), of(2), of(3)], ["shoulder (0)", "joint 1", "wrist (2)", "joint 3"]);
        assert_eq!(names.several(&[0, 2]), "shoulder (0) and wrist (2)");
        assert_eq!(names.several(&[0, 1, 3]), "joints 0, 1 and 3", "one form in one list");
        assert_eq!([names.several(&[1]), names.several(&[])], ["joint 1", "no joint"]);
        assert_eq!([names.several(&[0, 1, 2]), names.several(&[0, 2, 1])], ["all joints", "joints 0, 2 and 1"]);
        assert_eq!(JointNames::numbered("lbr_A", 2).several(&[0, 1]), "lbr_A1 (0) and lbr_A2 (1)");
    }
}
