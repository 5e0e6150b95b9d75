#![doc = include_str!("../README.md")]
//!
//! ```text
//! v̇ = u − Λ⁻¹ h + w_a,     ẋ = v,     ḣ = w_h,     y = x + n          Λ⁻¹ = J B⁻¹ Jᵀ
//! ```
//!
//! x is the pose (p ∈ R³, R ∈ SO(3)), v its twist, h the wrench by the robot on the environment. The only measurement is
//! the pose computed from the encoders; no torque sensor. u is what the tool's acceleration would be without a wrench:
//! in free motion whatever h reports is friction that was not compensated, `h_hat = J̄ᵀ(tau_f − tau_f_hat)`.
//!
//! # What the paper says, what we do, why
//!
//! | paper | here | why |
//! |---|---|---|
//! | (20): K = P C R⁻¹ | K = P Cᵀ S⁻¹ | the transpose is missing; discrete update, symmetric by construction |
//! | (17): Euler angles integrated from ω | R ← exp(dt ω) R | Euler rates are not ω: not integrable |
//! | (18): noise on ẋ = v through M⁻¹ | noise on the acceleration and on h only | ẋ = v is an identity |
//! | u = −M⁻¹(D v + K e) | known input `J B⁻¹(tau − tau_f_hat − bias) + J̇ qd`, the paper's as a setting | stays right under saturation; the results are nearly equal |
//! | (19): y has x and ẋ | pose only | the filtered velocity is coloured and correlated with the pose: optimistic covariance, no better estimate |
//!
//! [`WrenchEkf`] is the filter, [`AugmentedCovariance`] its 18×18 covariance in 6×6 blocks. Each update returns its evidence:
//! innovation, its covariance, NIS. [`FrictionAwareEkf`] adds what is not known of friction to the covariance of the wrench.
//!
//! ```
//! use nalgebra::{SVector, Vector6};
//! use tribo_ekf::{WrenchEkf, WrenchEkfSettings};
//! use tribo_robot::{ControlTerms, EstimatorInput, SensorFrame, WrenchEstimator, presets};
//!
//! let (arm, q, none) = (presets::panda(), presets::panda_ready_pose(), SVector::<f64, 7>::zeros());
//! let mut ekf = WrenchEkf::new(WrenchEkfSettings::default());
//! let terms = ControlTerms::at(&arm, &q, &none);
//! let frame = SensorFrame { time_s: 0.0, q, qd: none, tau: none, theta: None };
//! ekf.reset(&frame, &terms);
//! // The arm stands still under its weight and 2 Nm more in joint 1: something holds the tool.
//! let mut tau_motor = terms.gravity_nm;
//! tau_motor[1] += 2.0;
//! let mut estimate = None;
//! for tick in 1..500 {
//!     let frame = SensorFrame { time_s: f64::from(tick) * 1e-3, ..frame };
//!     estimate = Some(ekf.step(&EstimatorInput {
//!         frame: &frame,
//!         terms: &terms,
//!         tau_motor: &tau_motor,
//!         tau_friction: &none,
//!         acceleration_command: &Vector6::zeros(),
//!         dt_s: 1e-3,
//!     }));
//! }
//! let estimate = estimate.ok_or("it has run")?;
//! assert!(estimate.wrench_base.force_n.norm() > 2.0 && estimate.nis.is_some());
//! # Ok::<(), &str>(())
//! ```

mod covariance;
mod friction_aware;
mod settings;
mod wrench_ekf;

pub use covariance::AugmentedCovariance;
pub use friction_aware::FrictionAwareEkf;
pub use settings::{KnownInput, MeasurementNoise, WrenchEkfSettings};
pub use wrench_ekf::{Innovation, WrenchEkf, wrench_from_torque};
