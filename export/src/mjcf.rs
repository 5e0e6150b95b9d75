//! The robot as MJCF.

use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};
use tribo_figure::escape::escape;
use tribo_robot::LinkInertia;

use super::float::spaced;
use super::joint_dynamics::JointDynamics;
use super::text::in_comment;
use super::{ExportError, Exported, Format, Loss, TunedCompensator};

/// Radius of the capsules that are drawn for the links (m).
const DRAWN_RADIUS_M: f64 = 0.03;
/// Least slack of a link's moments of inertia [kg m²]: MuJoCo takes none at zero, and none of a flat body that rounding
/// has made flatter. A thousandth of what 1e-9 of a mass matrix is worth.
const LEAST_INERTIA_KG_M2: f64 = 1e-12;

/// The believed arm as a model of MuJoCo: bodies with their inertia, joints with range, `damping`, `frictionloss` and
/// `armature` (rotor inertia), `stiffness` and `springref` where the model has a spring, a motor per joint within its
/// torque limit, a site at the flange, the ready pose as keyframe `ready`. Capsules are drawn, and touch nothing.
///
/// ```text
/// M(q) qdd + bias(q, qd) + damping qd + frictionloss sign(qd) + stiffness (q − springref) = ctrl
/// ```
pub(super) fn export<const N: usize>(tuned: &TunedCompensator<N>, name: Option<&str>) -> Result<Exported, ExportError> {
    let arm = tuned.known_arm()?;
    let friction = JointDynamics::of(tuned, Format::Mjcf)?;
    let mut losses = friction.losses(tuned, true);
    losses.push(Loss::new(format!("speed limits {:?} rad/s", arm.limits.qd_max_rad_s.as_slice()), "left out"));

    let mut xml = Xml::default();
    xml.open(&format!("mujoco model=\"{}\"", escape(name.unwrap_or(&tuned.robot))));
    xml.comment(&format!("{}: arm and friction. {}.", tuned.robot, tuned.origin));
    for loss in &losses {
        xml.comment(&format!("Not in this file: {loss}"));
    }
    xml.leaf("compiler angle=\"radian\" autolimits=\"true\" inertiafromgeom=\"false\"");
    // 1 kHz, as the control loop; implicit in the damping.
    let gravity = spaced(arm.gravity_m_s2.iter().copied());
    xml.leaf(&format!("option timestep=\"0.001\" integrator=\"implicitfast\" gravity=\"{gravity}\""));
    xml.open("worldbody");
    let names = tuned.names().map(|name| escape(&name));
    for k in 0..N {
        let (place, limits) = (&arm.placements[k], &arm.limits);
        xml.open(&format!("body name=\"link_{}\" {}", k + 1, pose(&place.rotation, &place.translation)));
        xml.leaf(&inertial(&arm.links[k], k)?);
        let effects = &tuned.compensator.effects[k];
        let spring = match effects.spring_nm_per_rad == 0.0 {
            true => String::new(),
            false => {
                let [stiffness, rest] =
                    [effects.spring_nm_per_rad, effects.spring_rest_rad].map(|value| spaced([value]));
                format!(" stiffness=\"{stiffness}\" springref=\"{rest}\"")
            }
        };
        xml.leaf(&format!(
            "joint name=\"{}\" type=\"hinge\" axis=\"0 0 1\" range=\"{}\" damping=\"{}\" frictionloss=\"{}\" armature=\"{}\"{spring}",
            names[k],
            spaced([limits.q_min_rad[k], limits.q_max_rad[k]]),
            spaced([friction.viscous_nm_s_per_rad[k]]),
            spaced([friction.coulomb_nm[k]]),
            spaced([arm.rotor_inertia_kg_m2[k]]),
        ));
        let end = arm.placements.get(k + 1).map_or(arm.link_from_flange_translation, |next| next.translation);
        xml.leaf(&drawn(&end));
    }
    let flange = pose(&arm.link_from_flange_rotation, &arm.link_from_flange_translation);
    xml.leaf(&format!("site name=\"flange\" {flange}"));
    for _ in 0..N {
        xml.close("body");
    }
    xml.close("worldbody");
    xml.open("actuator");
    for k in 0..N {
        let limit = arm.limits.tau_max_nm[k];
        xml.leaf(&format!("motor name=\"{0}\" joint=\"{0}\" ctrlrange=\"{1}\"", names[k], spaced([-limit, limit])));
    }
    xml.close("actuator");
    if let Some(pose_rad) = tuned.pose_rad {
        xml.open("keyframe");
        xml.leaf(&format!("key name=\"ready\" qpos=\"{}\"", spaced(pose_rad)));
        xml.close("keyframe");
    }
    xml.close("mujoco");
    Ok(Exported { text: xml.text, losses })
}

/// XML text, indented.
#[derive(Default)]
struct Xml {
    text: String,
    depth: usize,
}

impl Xml {
    fn line(&mut self, line: &str) {
        self.text.push_str(&format!("{:1$}{line}\n", "", 2 * self.depth));
    }

    fn comment(&mut self, text: &str) {
        self.line(&format!("<!-- {} -->", in_comment(text)));
    }

    fn leaf(&mut self, element: &str) {
        self.line(&format!("<{element}/>"));
    }

    fn open(&mut self, element: &str) {
        self.line(&format!("<{element}>"));
        self.depth += 1;
    }

    fn close(&mut self, name: &str) {
        self.depth -= 1;
        self.line(&format!("</{name}>"));
    }
}

fn pose(rotation: &Matrix3<f64>, translation: &Vector3<f64>) -> String {
    let q = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(*rotation));
    let quat = spaced([q.w, q.i, q.j, q.k]);
    format!("pos=\"{}\" quat=\"{quat}\"", spaced(translation.iter().copied()))
}

/// `<inertial>` of one link, about its centre of mass in the axes of the link.
fn inertial(link: &LinkInertia, joint: usize) -> Result<String, ExportError> {
    let mut i = link.inertia_kg_m2;
    let moments = i.symmetric_eigenvalues();
    // Of a body with extent, each moment is above 0 and at most the sum of the two others.
    let slack = moments.min().min(moments.sum() - 2.0 * moments.max());
    if slack < -1e-9 * moments.amax().max(1e-3) || link.mass_kg <= 0.0 {
        let what = format!("link of {} kg with moments of inertia {:?} kg m2", link.mass_kg, moments.as_slice());
        let why = "mass and moments must be above 0, and no moment above the sum of the two others";
        return Err(ExportError::Joint { joint, what, format: Format::Mjcf.name(), why });
    }
    if slack < LEAST_INERTIA_KG_M2 {
        i += Matrix3::identity() * (LEAST_INERTIA_KG_M2 - slack);
    }
    let full = spaced([i[(0, 0)], i[(1, 1)], i[(2, 2)], i[(0, 1)], i[(0, 2)], i[(1, 2)]]);
    let (com, mass) = (spaced(link.com_m.iter().copied()), spaced([link.mass_kg]));
    Ok(format!("inertial pos=\"{com}\" mass=\"{mass}\" fullinertia=\"{full}\""))
}

/// What is drawn from the origin of a link to its far end.
fn drawn(end: &Vector3<f64>) -> String {
    let radius = spaced([DRAWN_RADIUS_M]);
    let shape = match end.norm() > DRAWN_RADIUS_M {
        true => format!("type=\"capsule\" fromto=\"0 0 0 {}\"", spaced(end.iter().copied())),
        false => "type=\"sphere\"".to_owned(),
    };
    format!("geom {shape} size=\"{radius}\" contype=\"0\" conaffinity=\"0\" rgba=\"0.7 0.7 0.75 1\"")
}
