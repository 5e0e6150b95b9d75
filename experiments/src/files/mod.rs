//! The project's own YAML files: models, campaign settings, tuned parameters, trajectories.

mod effects_section;
mod error;
mod friction_section;
mod model;
mod model_choice;
mod model_file;
mod references_file;
mod robot_section;
mod trajectory_file;
mod tuned_file;
mod yaml;

pub use error::FileError;
pub use friction_section::{FrictionSection, JointParameters, LawName};
pub use model::{AnyModel, Model, SIGN_SMOOTHING_RAD_S};
pub use model_choice::ModelChoice;
pub use model_file::{ModelFile, PayloadSection};
pub use robot_section::LimitsSection;
pub use trajectory_file::{TrajectoryFile, ViaPoint};
pub use tuned_file::TunedFile;
pub(crate) use yaml::file_name;
pub use yaml::{FieldError, YamlDocument, read_text, to_yaml};
