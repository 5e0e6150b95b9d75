//! An arm as URDF.

use nalgebra::{Matrix3, Rotation3, Vector3};
use std::fmt::Write;

use crate::{Arm, LinkInertia};

/// The URDF of an arm: `link_0` (the base, without mass), `joint_1` … `joint_N` about z, and `flange` fixed to the last
/// link. Rotor inertia, torque rates and gravity have no place in a URDF and are lost; roll, pitch and yaw repeat rotations
/// to rounding.
pub fn to_urdf<const N: usize>(arm: &Arm<N>) -> String {
    let mut text =
        format!("<?xml version=\"1.0\"?>\n<robot name=\"{}\">\n  <link name=\"link_0\"/>\n", escaped(&arm.name));
    for k in 0..N {
        let (placement, limits) = (&arm.placements[k], &arm.limits);
        // Writing to a string cannot fail.
        let _ = write!(
            text,
            "  <joint name=\"joint_{}\" type=\"revolute\">\n    {}\n    <parent link=\"link_{k}\"/>\n    <child link=\"link_{}\"/>\n    \
             <axis xyz=\"0 0 1\"/>\n    <limit lower=\"{}\" upper=\"{}\" velocity=\"{}\" effort=\"{}\"/>\n  </joint>\n{}",
            k + 1,
            origin(&placement.rotation, &placement.translation),
            k + 1,
            limits.q_min_rad[k],
            limits.q_max_rad[k],
            limits.qd_max_rad_s[k],
            limits.tau_max_nm[k],
            link(k + 1, &arm.links[k]),
        );
    }
    let flange = origin(&arm.link_from_flange_rotation, &arm.link_from_flange_translation);
    let _ = write!(
        text,
        "  <link name=\"flange\"/>\n  <joint name=\"flange_joint\" type=\"fixed\">\n    {flange}\n    \
         <parent link=\"link_{N}\"/>\n    <child link=\"flange\"/>\n  </joint>\n</robot>\n"
    );
    text
}

fn link(number: usize, link: &LinkInertia) -> String {
    let i = &link.inertia_kg_m2;
    format!(
        "  <link name=\"link_{number}\">\n    <inertial>\n      {}\n      <mass value=\"{}\"/>\n      \
         <inertia ixx=\"{}\" ixy=\"{}\" ixz=\"{}\" iyy=\"{}\" iyz=\"{}\" izz=\"{}\"/>\n    </inertial>\n  </link>\n",
        origin(&Matrix3::identity(), &link.com_m),
        link.mass_kg,
        i[(0, 0)],
        i[(0, 1)],
        i[(0, 2)],
        i[(1, 1)],
        i[(1, 2)],
        i[(2, 2)],
    )
}

fn origin(rotation: &Matrix3<f64>, translation: &Vector3<f64>) -> String {
    let (roll, pitch, yaw) = Rotation3::from_matrix_unchecked(*rotation).euler_angles();
    let [x, y, z]: [f64; 3] = (*translation).into();
    format!("<origin xyz=\"{x} {y} {z}\" rpy=\"{roll} {pitch} {yaw}\"/>")
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
