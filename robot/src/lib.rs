#![doc = include_str!("../README.md")]
//!
//! ```text
//! tau_motor = M(q) qdd + C(q, qd) qd + g(q) + Ir qdd + tau_friction(qd) + Jᵀ h
//! ```
//!
//! h is the wrench the robot exerts **on the environment** (see [`Wrench`]). The rotor inertia Ir is part of the model:
//! an [`Arm`] with `rotor_inertia_kg_m2 = 0` is the link-side arm. Every algorithm has the form
//! `algorithm(&arm, q, qd, …)`, keeps its temporaries on the stack and allocates nothing; [`Kinematics`] is the
//! workspace that several of them share.
//!
//! Conventions: SI units, radians, twists and wrenches angular part first, at the flange origin, in base axes.
//!
//! ```
//! use nalgebra::SVector;
//! use tribo_robot::{presets, rnea, mass_matrix, forward_dynamics};
//!
//! let arm = presets::panda();
//! let q = presets::panda_ready_pose();
//! let qd = SVector::<f64, 7>::repeat(0.1);
//! let qdd = SVector::<f64, 7>::repeat(0.5);
//! let tau = rnea(&arm, &q, &qd, &qdd);
//! assert!((forward_dynamics(&arm, &q, &qd, &tau) - qdd).amax() < 1e-10);
//! assert!(mass_matrix(&arm, &q).cholesky().is_some());
//! ```
//!
//! Arms come from [`presets`], whose every number has a source, from a URDF ([`urdf`]) or from a model of MuJoCo ([`mjcf`]).
//!
//! Leaves out: prismatic joints, branching trees, joint flexibility.

mod aba;
mod arm;
mod canonical;
mod chain;
mod control_terms;
mod crba;
mod description;
mod estimator;
mod frame;
mod inertia;
mod joint_names;
mod kinematics;
mod link_dynamics;
mod link_motion;
mod mechanism;
pub mod mjcf;
mod placement;
mod plant;
mod prepared;
pub mod presets;
mod product;
mod regressor;
mod rnea;
mod sines;
pub mod so3;
mod spatial;
mod spd_factor;
pub mod urdf;
mod well_conditioned;

pub use aba::forward_dynamics;
pub use arm::{Arm, Limits};
pub use chain::{ChainError, ChainRemark, DescribedArm, SerialChain};
pub use control_terms::ControlTerms;
pub use crba::mass_matrix;
pub use description::{DescriptionError, parse_description};
pub use estimator::{EstimateFault, EstimatorInput, LAMBDA_95, WrenchEstimate, WrenchEstimator, WrenchLimits};
pub use inertia::{LinkInertia, Payload};
pub use joint_names::{JointNames, NamedJoint};
pub use kinematics::Kinematics;
pub use mechanism::Mechanism;
pub use placement::{JointPlacement, ModifiedDh, StandardDh};
pub use plant::{Plant, PlantLost, SensorFrame};
pub use prepared::PreparedMechanism;
pub use product::{minus_product_transposed, multiply_add, product, product_transposed, transposed_product};
pub use regressor::{inverse_dynamics_regressor, link_regressor};
pub use rnea::{bias_torque, gravity_torque, rnea};
pub use sines::sines;
pub use spatial::{Pose, Twist, Wrench};
pub use spd_factor::SpdFactor;
pub use well_conditioned::well_conditioned_poses;
