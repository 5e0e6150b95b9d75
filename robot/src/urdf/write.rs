//! An arm as URDF.

use nalgebra::{Matrix3, Vector3};
use std::fmt::Write;

use crate::{Arm, DescribedArm, LinkInertia};

/// The URDF of an arm: `link_0` (the base, without mass), `joint_1` … `joint_N` about z, and `flange` fixed to the last
/// link. Rotor inertia, torque rates and gravity have no place in a URDF and are lost; roll, pitch and yaw repeat rotations
/// to rounding.
pub fn to_urdf<const N: usize>(arm: &Arm<N>) -> String {
    let joint_names = std::array::from_fn(|k| format!("joint_{}", k + 1));
    written(arm, &joint_names, |_| String::new())
}

impl<const N: usize> DescribedArm<N> {
    /// The arm as a URDF: [`to_urdf`] with the joints' names and, as `<dynamics>`, their friction.
    pub fn to_urdf(&self) -> String {
        written(&self.arm, &self.joint_names, |k| {
            let (damping, friction) = (self.viscous_nm_s_per_rad[k], self.coulomb_nm[k]);
            format!("    <dynamics damping=\"{damping}\" friction=\"{friction}\"/>\n")
        })
    }
}

fn written<const N: usize>(arm: &Arm<N>, joint_names: &[String; N], dynamics: impl Fn(usize) -> String) -> String {
    let mut text =
        format!("<?xml version=\"1.0\"?>\n<robot name=\"{}\">\n  <link name=\"link_0\"/>\n", escaped(&arm.name));
    for k in 0..N {
        let (placement, limits) = (&arm.placements[k], &arm.limits);
        // Writing to a string cannot fail.
        let _ = write!(
            text,
            "  <joint name=\"{}\" type=\"revolute\">\n    {}\n    <parent link=\"link_{k}\"/>\n    <child link=\"link_{}\"/>\n    \
             <axis xyz=\"0 0 1\"/>\n    <limit lower=\"{}\" upper=\"{}\" velocity=\"{}\" effort=\"{}\"/>\n{}  </joint>\n{}",
            escaped(&joint_names[k]),
            origin(&placement.rotation, &placement.translation),
            k + 1,
            limits.q_min_rad[k],
            limits.q_max_rad[k],
            limits.qd_max_rad_s[k],
            limits.tau_max_nm[k],
            dynamics(k),
            link(k + 1, &arm.links[k]),
        );
    }
    let mut flange_joint = "flange_joint".to_owned();
    while joint_names.contains(&flange_joint) {
        flange_joint.push('_');
    }
    let flange = origin(&arm.link_from_flange_rotation, &arm.link_from_flange_translation);
    let _ = write!(
        text,
        "  <link name=\"flange\"/>\n  <joint name=\"{flange_joint}\" type=\"fixed\">\n    {flange}\n    \
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
    let [roll, pitch, yaw] = roll_pitch_yaw(rotation);
    let [x, y, z]: [f64; 3] = (*translation).into();
    format!("<origin xyz=\"{x} {y} {z}\" rpy=\"{roll} {pitch} {yaw}\"/>")
}

/// Angles of `RotZ(yaw) RotY(pitch) RotX(roll)`. Roll is what is left after the yaw that was chosen, so the product is the
/// rotation to rounding even beside a pitch of a right angle, where yaw alone means little.
fn roll_pitch_yaw(r: &Matrix3<f64>) -> [f64; 3] {
    let yaw = r[(1, 0)].atan2(r[(0, 0)]);
    let (sin, cos) = yaw.sin_cos();
    let pitch = (-r[(2, 0)]).atan2(cos * r[(0, 0)] + sin * r[(1, 0)]);
    let roll = (sin * r[(0, 2)] - cos * r[(1, 2)]).atan2(cos * r[(1, 1)] - sin * r[(0, 1)]);
    [roll, pitch, yaw]
}

/// Text of an attribute; what XML forbids shows as `�`.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\u{fffe}' | '\u{ffff}' => escaped.push('\u{fffd}'),
            control if control.is_control() => escaped.push('\u{fffd}'),
            letter => escaped.push(letter),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;

    /// At, beside and away from a pitch of a right angle.
    #[test]
    fn angles_repeat_the_rotation_to_rounding() {
        let right = std::f64::consts::FRAC_PI_2;
        for pitch in [right, -right, right - 1e-9, right - 1e-8, 1e-6 - right, 0.3, 2.0] {
            for (roll, yaw) in [(0.0, 0.0), (0.7, -2.9), (-1.3, 0.2), (3.1, right)] {
                let rotation = Rotation3::from_euler_angles(roll, pitch, yaw).into_inner();
                let [roll, pitch, yaw] = roll_pitch_yaw(&rotation);
                let again = Rotation3::from_euler_angles(roll, pitch, yaw).into_inner();
                assert!((again - rotation).amax() < 4e-16, "{roll} {pitch} {yaw}: {}", (again - rotation).amax());
            }
        }
    }
}
