//! Which entry of a `sensor_msgs/JointState` is which joint: the names decide, since drivers list joints in any order.
//!
//! ```text
//! …1, …2, … (panda_joint1, fr3_joint7, joint_3)        by the number at the end
//! shoulder_pan, shoulder_lift, elbow, wrist_1..3       along the chain (Universal Robots)
//! anything else                                        as listed
//! ```
//!
//! Fingers and grippers are left out.

/// Parts of names that belong to a tool.
const TOOLS: [&str; 3] = ["finger", "gripper", "knuckle"];

/// The joints of Universal Robots from base to tool.
const UNIVERSAL_ROBOTS: [&str; 6] = ["shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"];

/// Names of the joints of the arm, base to tool.
pub(crate) fn arm_joints(names: &[String]) -> Vec<String> {
    let mut joints: Vec<String> =
        names.iter().filter(|name| !TOOLS.iter().any(|tool| name.contains(tool))).cloned().collect();
    let along = |name: &String| UNIVERSAL_ROBOTS.iter().position(|part| name.contains(part));
    for rank in [&along as &dyn Fn(&String) -> Option<usize>, &|name| last_number(name)] {
        let mut ranks: Vec<usize> = joints.iter().filter_map(rank).collect();
        ranks.sort_unstable();
        ranks.dedup();
        if ranks.len() == joints.len() {
            joints.sort_by_key(rank);
            break;
        }
    }
    joints
}

/// The number a name ends with.
fn last_number(name: &str) -> Option<usize> {
    let digits = name.len() - name.trim_end_matches(|c: char| c.is_ascii_digit()).len();
    name[name.len() - digits..].parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ordered(names: &[&str]) -> Vec<String> {
        arm_joints(&names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>())
    }

    #[test]
    fn joints_come_base_to_tool() {
        assert_eq!(
            ordered(&["fr3_joint10", "fr3_joint2", "fr3_finger_joint1", "fr3_joint1"]),
            ["fr3_joint1", "fr3_joint2", "fr3_joint10"]
        );
        let ur = [
            "elbow_joint",
            "shoulder_lift_joint",
            "shoulder_pan_joint",
            "wrist_1_joint",
            "wrist_2_joint",
            "wrist_3_joint",
        ];
        assert_eq!(ordered(&ur)[..3], ["shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint"]);
        assert_eq!(ordered(&["b", "a"]), ["b", "a"]);
        // Two joints of one number are not told apart by it.
        assert_eq!(ordered(&["right_2", "left_1", "right_1"]), ["right_2", "left_1", "right_1"]);
    }
}
