//! The model of version 10.

use tribo_robot::{Arm, urdf::to_urdf};

use crate::unit::MotionLimits;
use crate::wire::FciVersion;

/// URDF of the arm as an FR3 sends it: links `link0` … `link7` and the flange `link8`, joints `joint1` … `joint7`, each with
/// the `position_based_velocity_limits` that libfranka's rate limiter reads.
pub fn urdf(arm: &Arm<7>) -> String {
    let limits = MotionLimits::of(FciVersion::V10, arm);
    let mut named = arm.clone();
    named.name = "fr3".to_owned();
    for j in 0..7 {
        [named.limits.q_min_rad[j], named.limits.q_max_rad[j]] = limits.q_rad[j];
        named.limits.qd_max_rad_s[j] = limits.qd_rad_s[j];
    }
    let text = to_urdf(&named)
        .replace("\"link_", "\"link")
        .replace("\"joint_", "\"joint")
        .replace("\"flange\"", "\"link8\"")
        .replace("\"flange_joint\"", "\"joint8\"");
    let mut envelopes = limits.envelopes.iter().flatten();
    let mut urdf = String::with_capacity(text.len() + 1024);
    for line in text.lines() {
        urdf.push_str(line);
        urdf.push('\n');
        if line.trim_start().starts_with("<limit ")
            && let Some(envelope) = envelopes.next()
        {
            urdf.push_str(&format!(
                "    <position_based_velocity_limits velocity_offset=\"{}\" deceleration_limit=\"{}\"/>\n",
                envelope.offset_rad_s, envelope.deceleration_rad_s2
            ));
        }
    }
    urdf
}

#[cfg(test)]
mod tests {
    use super::*;
    use franka::{Frame, JointVelocityLimitsConfig, Model, robot_state::RobotState};
    use nalgebra::{SMatrix, SVector};
    use tribo_robot::{Kinematics, gravity_torque, mass_matrix, presets, rnea};

    /// The client's own reader (`franka-rs`): dynamics to 1e-9 of ours with a load, limits of all joints.
    #[test]
    fn a_client_reads_our_dynamics_and_limits() {
        let arm = presets::fr3();
        let text = urdf(&arm);
        let limits = JointVelocityLimitsConfig::from_urdf(&text).unwrap();
        assert!((limits.upper_limits(&[0.0; 7])[4] - (5.26 - 1e-3)).abs() < 1e-12);
        let model = Model::from_urdf(&text).unwrap();
        let arm = arm.link_side();
        for pose in 0..5 {
            let q = SVector::<f64, 7>::from_fn(|j, _| (1.3 * (pose * 7 + j) as f64).sin());
            let qd = SVector::<f64, 7>::from_fn(|j, _| (0.7 * (pose * 7 + j) as f64).cos());
            let state = RobotState { q: q.into(), dq: qd.into(), ..RobotState::default() };
            let mut state = state;
            for i in [0, 5, 10, 15] {
                (state.F_T_EE[i], state.EE_T_K[i]) = (1.0, 1.0);
            }
            let close = |theirs: [f64; 7], ours: SVector<f64, 7>| (SVector::from(theirs) - ours).amax() < 1e-9;
            assert!(close(model.gravity(&state), gravity_torque(&arm, &q)));
            let zero = SVector::zeros();
            let coriolis = rnea(&arm, &q, &qd, &zero) - rnea(&arm, &q, &zero, &zero);
            assert!(close(model.coriolis(&state), coriolis));
            let mass = SMatrix::<f64, 7, 7>::from_column_slice(&model.mass(&state));
            assert!((mass - mass_matrix(&arm, &q)).amax() < 1e-9);
            let flange = Kinematics::at(&arm, &q).base_from_flange().to_homogeneous();
            let theirs = model.pose(Frame::Flange, &state);
            assert!(flange.iter().zip(theirs).all(|(ours, theirs)| (ours - theirs).abs() < 1e-9));
        }
    }
}
