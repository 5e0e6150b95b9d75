//! What the columns that a log lacks switch off.

use tribo_logs::Quantity;

/// What a command does without an optional quantity that it would use; `None` where nobody uses it. Temperatures are such:
/// `thermal` keeps its own balance of heat, from cold.
#[must_use]
pub fn switched_off_without(quantity: Quantity) -> Option<&'static str> {
    match quantity {
        Quantity::MotorPosition => {
            Some("estimate leaves out double_encoder; diagnose sees springs and gaps of the gears in the torque only")
        }
        Quantity::ExternalWrench => Some("estimate has no error figures, double_encoder no calibration"),
        Quantity::TorqueDesired => Some(
            "diagnose cannot tell what the controller made of noise and keeps the whole band; tell needs tau_J of the motors",
        ),
        Quantity::FrictionCompensation => Some("tell works the compensation out from the velocities of the log"),
        Quantity::LinkTorque => Some("estimate has no friction of the gears apart from the arm"),
        Quantity::Position | Quantity::Velocity | Quantity::Torque => Some("every estimator"),
        Quantity::Time | Quantity::MotorVelocity | Quantity::Temperature | Quantity::TemperatureAmbient => None,
    }
}
