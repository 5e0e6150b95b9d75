//! `<compiler>` and `<option>`: what holds for the whole model.

use nalgebra::Vector3;

use super::MjcfError;
use super::element::{Xml, numbers};

/// Where the inertia of a body comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum InertiaSource {
    /// `<inertial>` alone.
    Inertial,
    /// The geoms alone.
    Geoms,
    /// The geoms where there is no `<inertial>`.
    Either,
}

/// Settings of a model, MuJoCo's defaults where it says nothing.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Compiler {
    /// Radians in the file's unit of angles.
    pub angle_rad: f64,
    /// Whether a range alone makes a limit.
    pub autolimits: bool,
    pub inertia: InertiaSource,
    /// Axes of the Euler angles: lower case in the turned frame, upper case in the fixed one.
    pub eulerseq: [char; 3],
    pub balanceinertia: bool,
    /// Least mass of a body (kg).
    pub boundmass_kg: f64,
    /// Least moment of inertia of a body [kg m²].
    pub boundinertia_kg_m2: f64,
    /// Groups of the geoms that have mass.
    pub groups: [f64; 2],
    /// Gravity [m/s²] in world axes.
    pub gravity_m_s2: Vector3<f64>,
}

impl Compiler {
    /// Reads the settings; where elements repeat, the last one counts.
    pub fn of(model: Xml<'_>) -> Result<Self, MjcfError> {
        let mut settings = Self {
            angle_rad: 1.0_f64.to_radians(),
            autolimits: true,
            inertia: InertiaSource::Either,
            eulerseq: ['x', 'y', 'z'],
            balanceinertia: false,
            boundmass_kg: 0.0,
            boundinertia_kg_m2: 0.0,
            groups: [0.0, 5.0],
            gravity_m_s2: Vector3::new(0.0, 0.0, -9.81),
        };
        let named = |tag: &'static str| model.children().filter(move |node| node.has_tag_name(tag));
        for attribute in named("compiler").flat_map(|node| node.attributes()) {
            settings.set(attribute.name(), attribute.value())?;
        }
        for option in named("option") {
            if let Some(text) = option.attribute("gravity") {
                let gravity = numbers("option", "gravity", text, 3..=3)?;
                settings.gravity_m_s2 = Vector3::from_column_slice(&gravity);
            }
        }
        let flags = named("option").flat_map(|node| node.children()).filter(|node| node.has_tag_name("flag"));
        if flags.filter_map(|node| node.attribute("gravity")).next_back() == Some("disable") {
            settings.gravity_m_s2 = Vector3::zeros();
        }
        Ok(settings)
    }

    fn set(&mut self, name: &str, value: &str) -> Result<(), MjcfError> {
        let refuse = |attribute, allowed| {
            let value = value.escape_debug().to_string();
            Err(MjcfError::Attribute { element: "compiler".to_owned(), attribute, value, allowed })
        };
        let least = |attribute| match numbers("compiler", attribute, value, 1..=1)?[0] {
            least if least >= 0.0 => Ok(least),
            _ => refuse(attribute, "0 or above").map(|()| 0.0),
        };
        match (name, value) {
            ("angle", "radian") => self.angle_rad = 1.0,
            ("angle", "degree") => self.angle_rad = 1.0_f64.to_radians(),
            ("angle", _) => return refuse("angle", "radian or degree"),
            ("autolimits", "true" | "false") => self.autolimits = value == "true",
            ("autolimits", _) => return refuse("autolimits", "true or false"),
            ("balanceinertia", "true" | "false") => self.balanceinertia = value == "true",
            ("balanceinertia", _) => return refuse("balanceinertia", "true or false"),
            ("inertiafromgeom", "true") => self.inertia = InertiaSource::Geoms,
            ("inertiafromgeom", "false") => self.inertia = InertiaSource::Inertial,
            ("inertiafromgeom", "auto") => self.inertia = InertiaSource::Either,
            ("inertiafromgeom", _) => return refuse("inertiafromgeom", "true, false or auto"),
            ("boundmass", _) => self.boundmass_kg = least("boundmass")?,
            ("boundinertia", _) => self.boundinertia_kg_m2 = least("boundinertia")?,
            ("inertiagrouprange", _) => {
                let range = numbers("compiler", "inertiagrouprange", value, 2..=2)?;
                self.groups = [range[0], range[1]];
            }
            ("eulerseq", _) => match value.chars().collect::<Vec<char>>()[..] {
                [a, b, c] if [a, b, c].iter().all(|axis| "xyzXYZ".contains(*axis)) => self.eulerseq = [a, b, c],
                _ => return refuse("eulerseq", "three of x, y, z, X, Y, Z"),
            },
            ("settotalmass", _) if least("settotalmass").is_ok_and(|mass| mass > 0.0) => {
                let (what, why) = ("compiler settotalmass".to_owned(), "give the bodies their masses");
                return Err(MjcfError::NotSupported { what, why });
            }
            ("coordinate", "global") => {
                let (what, why) = ("compiler coordinate global".to_owned(), "MuJoCo has no such coordinates either");
                return Err(MjcfError::NotSupported { what, why });
            }
            _ => {}
        }
        Ok(())
    }
}
