#![doc = include_str!("../README.md")]
//!
//! | format | for | leaves out |
//! |---|---|---|
//! | `yaml`, `json` | Tribo itself, scripts | nothing |
//! | `c`, `rust` | a controller's source: the compensator itself, bounded by half of the joints' largest torques | nothing of it |
//! | `ros2` | parameters of a ROS 2 node | nothing of it |
//! | `crisp` | `crisp_controllers` | viscous friction, the Stribeck curve |
//! | `urdf` | everything that reads URDF | all but Coulomb and viscous friction, rotor inertia |
//! | `mjcf` | MuJoCo | all but Coulomb and viscous friction |
//!
//! What is left out, and how much torque that is, is in [`Exported::losses`] and in the file.

mod bounds;
mod c_header;
mod columns;
mod crisp;
mod error;
mod float;
mod joint_dynamics;
mod loss;
mod mjcf;
mod parameter_file;
mod program;
mod ros2;
mod rust_source;
mod terms;
mod text;
mod tuned_compensator;
mod urdf;

use serde::Deserialize;

use tribo_model::{ModelFile, TunedFile, to_yaml};

pub use error::ExportError;
pub use loss::Loss;
pub use tuned_compensator::TunedCompensator;

/// A format that compensators are written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Format {
    /// `tuned.yaml`.
    Yaml,
    /// The same as JSON.
    Json,
    /// ROS 2 parameter file.
    Ros2,
    /// ROS 2 parameter file for the CRISP controllers.
    Crisp,
    /// URDF with `<dynamics>`.
    Urdf,
    /// MuJoCo model.
    Mjcf,
    /// C99 header.
    C,
    /// Rust module.
    Rust,
}

impl Format {
    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Yaml => "yaml",
            Self::Json => "json",
            Self::Ros2 => "ros2",
            Self::Crisp => "crisp",
            Self::Urdf => "urdf",
            Self::Mjcf => "mjcf",
            Self::C => "c",
            Self::Rust => "rust",
        }
    }
}

/// The text of a file in another format.
#[derive(Clone, Debug, PartialEq)]
pub struct Exported {
    /// The whole text.
    pub text: String,
    /// What it does not say.
    pub losses: Vec<Loss>,
}

/// Writes tuned parameters in another format. `name` is what the target shall call it: the node (`ros2`, `crisp`), the
/// prefix of identifiers (`c`), the model (`urdf`, `mjcf`).
///
/// # Errors
/// A compensator that the format cannot represent, or a name that it does not take.
pub fn export(tuned: &TunedFile, format: Format, name: Option<&str>) -> Result<Exported, ExportError> {
    match tuned.joints() {
        6 => export_joints::<6>(tuned, format, name),
        _ => export_joints::<7>(tuned, format, name),
    }
}

/// Writes a robot as `urdf` or `mjcf`: the bare arm of a model file, with the friction that it is known to have. `name` is what
/// the target shall call the model.
///
/// # Errors
/// Another format, a field that is out of range, or an arm that the format cannot represent.
pub fn export_robot(file: &ModelFile, format: Format, name: Option<&str>) -> Result<Exported, ExportError> {
    match file.arm_joints()? {
        6 => robot_of_joints::<6>(file, format, name),
        _ => robot_of_joints::<7>(file, format, name),
    }
}

fn robot_of_joints<const N: usize>(
    file: &ModelFile,
    format: Format,
    name: Option<&str>,
) -> Result<Exported, ExportError> {
    let robot = TunedCompensator::<N>::of_robot(file)?;
    match format {
        Format::Urdf => urdf::export(&robot, name),
        Format::Mjcf => mjcf::export(&robot, name),
        other => Err(ExportError::NothingTuned { format: other.name() }),
    }
}

#[inline(never)]
fn export_joints<const N: usize>(
    tuned: &TunedFile,
    format: Format,
    name: Option<&str>,
) -> Result<Exported, ExportError> {
    if let (Format::Yaml | Format::Json | Format::Rust, Some(name)) = (format, name) {
        let allowed = "nothing: formats yaml, json and rust name nothing";
        return Err(ExportError::Name { name: name.to_owned(), allowed });
    }
    let whole = |text: Result<String, String>| {
        text.map(|text| Exported { text, losses: Vec::new() }).map_err(ExportError::Serialise)
    };
    let compensator = || TunedCompensator::<N>::of(tuned);
    match format {
        Format::Yaml => whole(to_yaml(tuned).map_err(|error| error.to_string())),
        Format::Json => whole(serde_json::to_string_pretty(tuned).map(|text| text + "\n").map_err(|it| it.to_string())),
        Format::Ros2 => ros2::export(&compensator()?, name),
        Format::Crisp => crisp::export(&compensator()?, name),
        Format::Urdf => urdf::export(&compensator()?, name),
        Format::Mjcf => mjcf::export(&compensator()?, name),
        Format::C => c_header::export(&compensator()?, name),
        Format::Rust => rust_source::export(&compensator()?),
    }
}
