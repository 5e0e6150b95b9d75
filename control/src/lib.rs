#![doc = include_str!("../README.md")]
//!
//! ```text
//! tau = B(q)(γ − Dn (I − J#J) qd) + C qd + g + tau_f_hat,     γ = J#(a − J̇ qd),     M a = −(D v + K e)
//! ```
//!
//! [`SinusoidReference`] is the exciting trajectory, [`ImpedanceController`] the law, [`JointTracking`] a stiff one in joint
//! space for recording logs, [`TorqueLimiter`] what the drives accept, [`SafeTorque`] what is sent when something is wrong, [`CompensationGuard`] what takes a friction compensator away
//! before it shakes the arm. Each tick returns every torque term, for the log.
//!
//! # What the paper says, what we do, why
//!
//! | paper | here | why |
//! |---|---|---|
//! | (3)–(6): orientation by intrinsic Euler angles of R_dᵀR, D on their rates | `e = log(R R_dᵀ)` in base axes, D on ω | (6)/(7) mix Euler rates with the geometric J; not integrable, singular |
//! | (5): M̃ = (R T)⁻¹ M | M acts on ω̇ in base axes | the order is reversed in (5); equal for isotropic M, which the paper uses |
//! | translation damps absolute, rotation relative velocity | both damp absolute velocity | consistent; the arm lags its reference by D/K (95 ms, 67 ms) |
//! | (7): J⁻¹ | `J# = Jᵀ(J Jᵀ + λ² I)⁻¹`, λ = 0 away from singularities | seven joints; see [`DampedPseudoInverse`] |
//! | (10): L = M Λ⁻¹ | unchanged: stiffness felt by a hand is diag(Λ M⁻¹ K), not K | inertia shaping would need the wrench in the loop |
//! | (33): pure damping in the null space | the same, plus an optional posture spring | damping alone lets the elbow slide away under over-compensation |
//! | (35) starts with a jump of up to 2.5 cm | 3 s pre-roll: hold, then quintic amplitude ramp | without it J is 9 instead of 3 and the tool jumps by 5 m/s² |
//!
//! ```
//! use nalgebra::{SVector, Vector6};
//! use tribo_control::{DampedPseudoInverse, ImpedanceController, ImpedanceSettings};
//! use tribo_robot::{ControlTerms, Kinematics, presets};
//!
//! let (arm, q, qd) = (presets::panda(), presets::panda_ready_pose(), SVector::<f64, 7>::zeros());
//! let controller = ImpedanceController {
//!     settings: ImpedanceSettings::default(),
//!     pseudo_inverse: DampedPseudoInverse::default(),
//!     posture: q,
//!     rotor_inertia_kg_m2: arm.rotor_inertia_kg_m2,
//! };
//! let terms = ControlTerms::at(&arm, &q, &qd);
//! let here = Kinematics::at(&arm, &q).base_from_flange();
//! let no_friction = |_: &_, _: &_, _: &_| (SVector::zeros(), SVector::zeros());
//! let (torque, _) = controller.tick(&terms, &q, &qd, &here, &Vector6::zeros(), no_friction)?;
//! // At its reference and at rest the arm carries its weight and nothing else.
//! assert!((torque.total() - terms.gravity_nm).amax() < 1e-9);
//! # Ok::<(), tribo_control::ControlFault>(())
//! ```
//! Leaves out: force control, inertia shaping, singularity crossing.

mod compensation_guard;
mod guard_input;
mod impedance;
mod joint_tracking;
mod limiter;
mod oscillation_energy;
mod pose_error;
mod pseudo_inverse;
mod reference;
mod reference_model;
mod safe_torque;

pub use compensation_guard::{CompensationGuard, GuardSettings, GuardTrip};
pub use guard_input::GuardInput;
pub use impedance::{ControlFault, ImpedanceController, ImpedanceSettings, TaskState, TorqueTerms};
pub use joint_tracking::{JointTarget, JointTracking};
pub use limiter::TorqueLimiter;
pub use pseudo_inverse::DampedPseudoInverse;
pub use reference::{PAPER_PHASES_RAD, SinusoidReference};
pub use reference_model::ReferenceModel;
pub use safe_torque::SafeTorque;
