//! Friction parameters from logs.

mod basis;
mod box_least_squares;
mod column_fit;
mod gls;
mod gls_error;
mod gls_rows;
mod gls_sample;
mod gls_settings;
mod held_out;
mod normal_equations;
mod savitzky_golay;
mod torque_fit;
mod torque_fit_error;

pub use basis::{Basis, STRIBECK_BASIS_INVERSE_VELOCITY_S_PER_RAD, STRIBECK_BASIS_SHAPE};
pub use box_least_squares::{BoxLeastSquares, minimize_in_box};
pub use column_fit::{ColumnFit, fit_columns};
pub use gls::{GlsFit, fit_from_wrench};
pub use gls_error::GlsError;
pub use gls_sample::GlsSample;
pub use gls_settings::GlsSettings;
pub use held_out::unexplained_on_held_out;
pub use savitzky_golay::SavitzkyGolay;
pub use torque_fit::{JointTorqueFit, fit_joint_torque};
pub use torque_fit_error::TorqueFitError;
