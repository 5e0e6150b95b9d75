//! The inertia of a body: its `<inertial>`, or that of its geoms.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

use super::MjcfError;
use super::bodies::Body;
use super::compiler::{Compiler, InertiaSource};
use super::element::{Defaults, Element, called};
use super::geom::{GeomInertia, inertia_of};
use super::pose::pose_of;
use crate::LinkInertia;
use crate::chain::frame::{Frame, chained};
use crate::chain::weld::NO_MASS;

/// Largest mass (kg) and moment of inertia [kg m²].
const LARGEST: f64 = 1e6;

/// The inertia of a body in its own frame, as MuJoCo's compiler makes it.
pub(super) fn body_inertia(
    body: &Body<'_>,
    defaults: &Defaults<'_>,
    compiler: &Compiler,
) -> Result<LinkInertia, MjcfError> {
    let own = match (compiler.inertia, &body.inertial) {
        (InertiaSource::Inertial | InertiaSource::Either, Some((element, around))) => {
            stated(*element, around, defaults, compiler)?
        }
        (InertiaSource::Inertial, None) => NO_MASS,
        (InertiaSource::Geoms, _) | (InertiaSource::Either, None) => of_geoms(body, defaults, compiler)?,
    };
    bounded(own, body, compiler)
}

fn of_geoms(body: &Body<'_>, defaults: &Defaults<'_>, compiler: &Compiler) -> Result<LinkInertia, MjcfError> {
    let mut sum = NO_MASS;
    for (element, around) in &body.geoms {
        match inertia_of(*element, around, defaults, compiler)? {
            GeomInertia::Nothing => {}
            GeomInertia::Body(solid) => sum = sum.combined(&solid),
            GeomInertia::Mesh => {
                return Err(MjcfError::Mesh { geom: called(element.node), body: body.name.clone() });
            }
        }
    }
    Ok(sum)
}

/// `<inertial pos mass diaginertia|fullinertia>` with an orientation.
fn stated(
    element: Element<'_>,
    around: &Frame,
    defaults: &Defaults<'_>,
    compiler: &Compiler,
) -> Result<LinkInertia, MjcfError> {
    let refuse = |attribute, value: String, allowed| {
        Err(MjcfError::Attribute { element: called(element.node), attribute, value, allowed })
    };
    let at = chained(around, &pose_of(element, defaults, compiler)?);
    let mass_kg = defaults.number(element, "mass")?.unwrap_or(0.0);
    if !(0.0..=LARGEST).contains(&mass_kg) {
        return refuse("mass", mass_kg.to_string(), "0 to 1e6 kg");
    }
    let diagonal = defaults.numbers(element, "diaginertia", 3..=3)?;
    let full = defaults.numbers(element, "fullinertia", 6..=6)?;
    let inertia_kg_m2 = match (diagonal, full) {
        (Some(_), Some(_)) => return refuse("fullinertia", "beside diaginertia".to_owned(), "one of both"),
        (Some(d), None) => Matrix3::from_diagonal(&Vector3::new(d[0], d[1], d[2])),
        // MuJoCo's order: xx yy zz xy xz yz.
        (None, Some(f)) => Matrix3::new(f[0], f[3], f[4], f[3], f[1], f[5], f[4], f[5], f[2]),
        (None, None) => Matrix3::zeros(),
    };
    if inertia_kg_m2.amax() > LARGEST || inertia_kg_m2.symmetric_eigenvalues().min() < -1e-9 {
        let value = format!("{:?}", inertia_kg_m2.as_slice());
        return refuse("inertia", value, "a positive semi-definite matrix up to 1e6 kg m²");
    }
    Ok(LinkInertia { mass_kg, com_m: Vector3::zeros(), inertia_kg_m2 }.placed(&at.rotation, &at.translation))
}

/// `boundmass`, `boundinertia` and `balanceinertia`: A + B ≥ C of the principal moments, by their mean or not at all.
fn bounded(own: LinkInertia, body: &Body<'_>, compiler: &Compiler) -> Result<LinkInertia, MjcfError> {
    if compiler.boundmass_kg == 0.0 && compiler.boundinertia_kg_m2 == 0.0 && !compiler.balanceinertia {
        return Ok(own);
    }
    let mass_kg = own.mass_kg.max(compiler.boundmass_kg);
    let eigen = SymmetricEigen::new(own.inertia_kg_m2);
    let least = compiler.boundinertia_kg_m2;
    let mut moments = eigen.eigenvalues.map(|moment| moment.max(least));
    if compiler.balanceinertia && 2.0 * moments.max() > moments.sum() {
        moments = Vector3::repeat(moments.sum() / 3.0);
    }
    let inertia_kg_m2 = eigen.eigenvectors * Matrix3::from_diagonal(&moments) * eigen.eigenvectors.transpose();
    if !inertia_kg_m2.iter().all(|value| value.is_finite()) {
        let (element, value) = (format!("body `{}`", body.name), format!("{:?}", own.inertia_kg_m2.as_slice()));
        return Err(MjcfError::Attribute { element, attribute: "inertia", value, allowed: "finite numbers" });
    }
    Ok(LinkInertia { mass_kg, inertia_kg_m2, ..own })
}
