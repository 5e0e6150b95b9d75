//! Mass and inertia of a geom.

use std::f64::consts::PI;

use nalgebra::{Matrix3, Vector3};

use super::MjcfError;
use super::compiler::Compiler;
use super::element::{Defaults, Element, called};
use super::pose::pose_of;
use crate::LinkInertia;
use crate::chain::frame::{Frame, chained, from_z_onto};

/// Density of water [kg/m³], MuJoCo's default.
const DENSITY_KG_M3: f64 = 1000.0;

/// What a geom adds to its body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum GeomInertia {
    /// Nothing: no mass, or in a group that has none.
    Nothing,
    /// A body, in the frame that `around` is in.
    Body(LinkInertia),
    /// That of a mesh.
    Mesh,
}

/// The inertia of a homogeneous solid of mass m about its centre, sizes as MuJoCo has them:
///
/// ```text
/// sphere     V = 4/3 π r³             I = 2/5 m r²
/// ellipsoid  V = 4/3 π a b c          Ixx = m (b² + c²)/5
/// box        V = 8 a b c              Ixx = m (b² + c²)/3
/// cylinder   V = π r² h               Ixx = m (3 r² + h²)/12                          Izz = m r²/2
/// capsule    cylinder and two half spheres of mass s: + 2/5 s r² + s h (3 r + 2 h)/8         + 2/5 s r²
/// ```
///
/// `around` is the frame that the geom's pose is in.
pub(super) fn inertia_of(
    element: Element<'_>,
    around: &Frame,
    defaults: &Defaults<'_>,
    compiler: &Compiler,
) -> Result<GeomInertia, MjcfError> {
    let refuse = |attribute, value: String, allowed| {
        Err(MjcfError::Attribute { element: called(element.node), attribute, value, allowed })
    };
    let kind = defaults.text(element, "type");
    let mesh = defaults.text(element, "mesh").is_some();
    let kind = kind.unwrap_or(if mesh { "mesh" } else { "sphere" });
    let group = defaults.number(element, "group")?.unwrap_or(0.0);
    let mass = defaults.number(element, "mass")?;
    let density = defaults.number(element, "density")?.unwrap_or(DENSITY_KG_M3);
    for (attribute, value) in [("mass", mass.unwrap_or(0.0)), ("density", density)] {
        if value < 0.0 {
            return refuse(attribute, value.to_string(), "0 or above");
        }
    }
    let weighs = mass.map_or(density > 0.0, |mass| mass > 0.0);
    if matches!(kind, "plane" | "hfield") || !weighs || group < compiler.groups[0] || group > compiler.groups[1] {
        return Ok(GeomInertia::Nothing);
    }
    if mesh || matches!(kind, "mesh" | "sdf") {
        return Ok(GeomInertia::Mesh);
    }
    if defaults.text(element, "shellinertia") == Some("true") {
        let what = format!("shellinertia of {}", called(element.node));
        return Err(MjcfError::NotSupported { what, why: "give the body an <inertial>" });
    }
    let mut pose = pose_of(element, defaults, compiler)?;
    let mut size = defaults.numbers(element, "size", 1..=3)?.unwrap_or_default();
    let sizes = match kind {
        "sphere" => 1,
        "capsule" | "cylinder" => 2,
        "ellipsoid" | "box" => 3,
        _ => return refuse("type", kind.escape_debug().to_string(), "a type of MuJoCo's geoms"),
    };
    if let Some(x) = defaults.numbers(element, "fromto", 6..=6)?.filter(|_| sizes > 1) {
        let [from, to] = [0, 3].map(|at| Vector3::from_column_slice(&x[at..at + 3]));
        let Some(rotation) = from_z_onto(&(from - to)) else {
            return refuse("fromto", format!("{x:?}"), "two places");
        };
        pose = Frame { rotation, translation: (from + to) * 0.5 };
        // Boxes and ellipsoids are as wide as they are thick.
        size.truncate(1);
        let width = size.first().copied().unwrap_or(0.0);
        size.resize(sizes - 1, width);
        size.push(0.5 * (from - to).norm());
    }
    if size.len() < sizes || size[..sizes].iter().any(|&it| !(it > 0.0 && it < 1e3)) {
        return refuse("size", format!("{size:?}"), "as many sizes as its type has, each above 0 m and below 1000 m");
    }
    let (a, b, c) = (size[0], size.get(1).copied().unwrap_or(0.0), size.get(2).copied().unwrap_or(0.0));
    let volume_m3 = match kind {
        "sphere" => 4.0 / 3.0 * PI * a * a * a,
        "ellipsoid" => 4.0 / 3.0 * PI * a * b * c,
        "box" => 8.0 * a * b * c,
        "cylinder" => PI * a * a * 2.0 * b,
        _ => PI * a * a * 2.0 * b + 4.0 / 3.0 * PI * a * a * a,
    };
    let m = mass.unwrap_or(density * volume_m3);
    let moments = match kind {
        "sphere" => Vector3::repeat(0.4 * m * a * a),
        "ellipsoid" => Vector3::new(b * b + c * c, a * a + c * c, a * a + b * b) * (m / 5.0),
        "box" => Vector3::new(b * b + c * c, a * a + c * c, a * a + b * b) * (m / 3.0),
        "cylinder" => cylinder(m, a, 2.0 * b),
        _ => {
            let height = 2.0 * b;
            let spheres = m * 4.0 * a / (4.0 * a + 3.0 * height);
            let (own, apart) = (0.4 * spheres * a * a, spheres * height * (3.0 * a + 2.0 * height) / 8.0);
            cylinder(m - spheres, a, height) + Vector3::new(own + apart, own + apart, own)
        }
    };
    let at = chained(around, &pose);
    let solid = LinkInertia { mass_kg: m, com_m: Vector3::zeros(), inertia_kg_m2: Matrix3::from_diagonal(&moments) };
    Ok(GeomInertia::Body(solid.placed(&at.rotation, &at.translation)))
}

fn cylinder(mass_kg: f64, radius_m: f64, height_m: f64) -> Vector3<f64> {
    let across = mass_kg * (3.0 * radius_m * radius_m + height_m * height_m) / 12.0;
    Vector3::new(across, across, 0.5 * mass_kg * radius_m * radius_m)
}
