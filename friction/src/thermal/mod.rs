//! Joint friction that depends on the temperature inside the joint (simoni2017, simoni2019).
//!
//! ```text
//! tau_f(q̇, T) = tau_pol(q̇) [α (T − T0) + β] + tau_str(q̇) [γ (T − T0) + δ]      simoni2017 (6)
//! C Ṫ = q̇ tau_f(q̇, T) − K (T − T_env)                                           simoni2017 (7), simoni2019 (17)
//! ```
//!
//! [`ThermalLaw`] is the first line, [`HeatBalance`] the second, [`ThermalJoint`] both. For a steady duty cycle
//! [`ThermalJoint::response`] solves them in closed form; [`identify_thermal`] finds their parameters in logs of several
//! duty cycles.
//!
//! | what the papers say | what we do | why |
//! |---|---|---|
//! | (23) has T_env where (24) has T0, right only if T0 = T_env | T0, T_env and the start are three temperatures | a room is not always as warm as on the day of the identification |
//! | (8): Euler step | exact step for constant power over the period | the same limit, stable at any period |
//! | (25): one injected power | one for the polynomial, one for the Stribeck part | (6) has two factors; γ = 0 or no Stribeck part gives (25) |
//! | (4) leaves c0 out | c0 too, as in (6) and in simoni2019 (18) | (6) is the law that is used |
//! | α, β, K, C from logs that all start at T0 = T_env | a room of another temperature, or a capacity that is known, is asked for | without one T could be counted in any unit: α/s, K/s, C/s fit as well |

mod closed_form;
mod cold_friction;
mod duty_cycle;
mod error;
mod heat_balance;
mod identify;
mod joint;
mod law;

pub use closed_form::ThermalResponse;
pub use cold_friction::{ColdFriction, PolynomialStribeck};
pub use duty_cycle::{DutyCycle, InjectedPower};
pub use error::ThermalError;
pub use heat_balance::HeatBalance;
pub use identify::{
    CapacityAnchor, ColdFit, Estimated, ThermalFit, ThermalFitError, ThermalFitSettings, ThermalSample, ThermalSession,
    identify_cold, identify_thermal,
};
pub use joint::ThermalJoint;
pub use law::{TemperatureFactor, ThermalLaw};
