//! Rigid bodies: links welded by fixed joints.

use std::collections::BTreeSet;

use nalgebra::{Matrix3, Vector3};
use urdf_rs::{JointType, Link};

use super::UrdfError;
use super::frame::{Frame, chained, frame_of};
use super::tree::Tree;
use crate::LinkInertia;

const NO_MASS: LinkInertia = LinkInertia {
    mass_kg: 0.0,
    com_m: Vector3::new(0.0, 0.0, 0.0),
    inertia_kg_m2: Matrix3::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
};

/// Moments of inertia below this are rounding [kg m²].
const ROUNDING_KG_M2: f64 = 1e-12;

/// The `<inertial>` of a link in its own frame; of no mass where there is none.
fn inertia_of(link: &Link) -> Result<LinkInertia, UrdfError> {
    let refuse = |field, value: String, allowed| UrdfError::Link { link: link.name.clone(), field, value, allowed };
    let (mass_kg, i) = (link.inertial.mass.value, &link.inertial.inertia);
    if !(0.0..=1e6).contains(&mass_kg) {
        return Err(refuse("mass", mass_kg.to_string(), "0 to 1e6 kg"));
    }
    let Some(at) = frame_of(&link.inertial.origin) else {
        return Err(refuse("origin of <inertial>", format!("{:?}", link.inertial.origin), "finite numbers"));
    };
    let inertia_kg_m2 = Matrix3::new(i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz);
    // Rounded tables are a little off, and points without extent are off by rounding; what is far off is no inertia of a body.
    let possible = inertia_kg_m2.iter().all(|value| value.is_finite() && value.abs() < 1e9)
        && inertia_kg_m2.symmetric_eigenvalues().min() >= -1e-4 * inertia_kg_m2.amax() - ROUNDING_KG_M2;
    if !possible {
        let value = format!("{:?}", [i.ixx, i.ixy, i.ixz, i.iyy, i.iyz, i.izz]);
        return Err(refuse("inertia", value, "ixx ixy ixz iyy iyz izz of a positive semi-definite matrix"));
    }
    Ok(LinkInertia { mass_kg, com_m: Vector3::zeros(), inertia_kg_m2 }.placed(&at.rotation, &at.translation))
}

/// Everything welded to `link`, which is at `body_from_link`, but for what hangs on the joints of the chain, in any order.
pub(super) fn welded(
    tree: &Tree,
    link: &str,
    body_from_link: Frame,
    chain: &BTreeSet<usize>,
) -> Result<LinkInertia, UrdfError> {
    let mut body = NO_MASS;
    let mut waiting = vec![(link.to_owned(), body_from_link)];
    while let Some((name, at)) = waiting.pop() {
        if let Some(link) = tree.link(&name) {
            body = body.combined(&inertia_of(link)?.placed(&at.rotation, &at.translation));
        }
        for (k, joint) in tree.below(&name) {
            let fixed = joint.joint_type == JointType::Fixed;
            if !fixed && !chain.contains(&k) {
                return Err(UrdfError::MovesBeside { joint: joint.name.clone() });
            }
            if fixed {
                let origin = super::joint::origin(joint)?;
                waiting.push((joint.child.link.clone(), chained(&at, &origin)));
            }
        }
    }
    Ok(body)
}
