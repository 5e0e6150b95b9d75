//! The project's own YAML files: models, campaign settings, tuned parameters.

mod error;
mod friction_section;
mod model_file;
mod tuned_file;
mod yaml;

pub use error::FileError;
pub use friction_section::{FrictionSection, JointParameters, LawName};
pub use model_file::{Model, ModelFile, PayloadSection};
pub use tuned_file::TunedFile;
pub use yaml::{FieldError, YamlDocument, read_text, to_yaml};
