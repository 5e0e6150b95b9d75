//! The robot as URDF with its friction.

use tribo_robot::DescribedArm;

use super::joint_dynamics::JointDynamics;
use super::text::in_comment;
use super::{ExportError, Exported, Format, Loss, TunedCompensator};

/// Gravity that whoever reads a URDF takes for granted [m/s²], in base axes.
const GRAVITY_M_S2: [f64; 3] = [0.0, 0.0, -9.81];

/// The believed arm as URDF, `<dynamics damping friction>` in every joint (see [`JointDynamics`] for how).
pub(super) fn export<const N: usize>(tuned: &TunedCompensator<N>, name: Option<&str>) -> Result<Exported, ExportError> {
    let mut arm = tuned.known_arm()?.clone();
    if let Some(name) = name {
        name.clone_into(&mut arm.name);
    }
    let friction = JointDynamics::of(tuned, Format::Urdf)?;
    let mut losses = friction.losses(tuned, false);
    if arm.rotor_inertia_kg_m2.amax() > 0.0 {
        losses.push(Loss::new(
            format!("rotor inertia {:?} kg m2", arm.rotor_inertia_kg_m2.as_slice()),
            "left out; the mass matrix is that of the links",
        ));
    }
    if arm.gravity_m_s2.as_slice() != GRAVITY_M_S2 {
        losses.push(Loss::new(
            format!("gravity {:?} m/s2 in base axes", arm.gravity_m_s2.as_slice()),
            "set it in your program",
        ));
    }
    let remarks = [format!("{}: arm and friction. {}.", tuned.robot, tuned.origin)];
    let comment: String = remarks
        .into_iter()
        .chain(losses.iter().map(|loss| format!("Not in this file: {loss}")))
        .map(|remark| format!("<!-- {} -->\n", in_comment(&remark)))
        .collect();
    let text = DescribedArm {
        arm,
        joint_names: tuned.names(),
        coulomb_nm: friction.coulomb_nm,
        viscous_nm_s_per_rad: friction.viscous_nm_s_per_rad,
    }
    .to_urdf();
    // Behind the XML declaration, which must be first.
    Ok(Exported { text: text.replacen("?>\n", &format!("?>\n{comment}"), 1), losses })
}
