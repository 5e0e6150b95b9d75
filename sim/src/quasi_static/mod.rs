//! Poses, gears and two encoders per joint, without inertia.

mod arm;
mod transmission;

pub use arm::QuasiStaticArm;
pub use transmission::Transmission;
