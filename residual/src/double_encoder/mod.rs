//! Wrench from two encoders per joint (uhlmann2023).

mod calibrate;
mod deflection_gp;
mod error;
mod estimator;
mod model;
mod rest;
mod settings;
mod stiffness_curve;
mod stiffness_fit;
mod stop_operator;

pub use calibrate::calibrate;
pub use deflection_gp::DeflectionGp;
pub use error::CalibrationError;
pub use estimator::DoubleEncoderEstimator;
pub use model::{DoubleEncoderModel, RestWrench};
pub use rest::{LoadedRest, Rest, Rests};
pub use settings::{DeflectionMean, DoubleEncoderSettings, ValidDoubleEncoder};
pub use stiffness_curve::StiffnessCurve;
pub use stiffness_fit::LoadSample;
pub use stop_operator::Approach;
