#![doc = include_str!("../README.md")]
//!
//! Every file is YAML with a `schema`; an error names file, line, field and the allowed range ([`FileError`]).

mod any_model;
mod checked_model;
mod config_error;
mod controller_model;
mod effect_entries;
mod effects_section;
mod error;
mod field_error;
mod friction_section;
mod limits_section;
mod model;
mod model_choice;
mod model_file;
mod not_cancelled_of;
mod pushes_file;
mod robot;
mod robot_section;
mod trajectory_file;
mod tuned_file;
mod yaml;

pub use any_model::AnyModel;
pub use config_error::ConfigError;
pub use controller_model::{ControllerModel, NotCancelled, joint_effects, not_cancelled_sentences};
pub use error::FileError;
pub use field_error::FieldError;
pub use friction_section::{FrictionSection, JointParameters, LawName};
pub use limits_section::LimitsSection;
pub use model::Model;
pub use model_choice::ModelChoice;
pub use model_file::{ModelFile, PayloadSection};
pub use not_cancelled_of::not_cancelled_of;
pub use pushes_file::{Push, PushesFile};
pub use robot::{POSES, Robot, joints_of_preset};
pub use trajectory_file::{TrajectoryFile, ViaPoint};
pub use tribo_regression::SIGN_SMOOTHING_RAD_S;
pub use tuned_file::TunedFile;
pub use yaml::{YamlDocument, file_name, read_text, to_yaml};
