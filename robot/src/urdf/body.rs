//! What a link says of its mass.

use nalgebra::{Matrix3, Vector3};
use urdf_rs::Link;

use super::UrdfError;
use super::origin::frame_of;
use crate::LinkInertia;

/// Moments of inertia below this are rounding [kg m²].
const ROUNDING_KG_M2: f64 = 1e-12;

/// The `<inertial>` of a link in its own frame; of no mass where there is none.
pub(super) fn inertia_of(link: &Link) -> Result<LinkInertia, UrdfError> {
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
