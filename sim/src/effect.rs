//! One physical cause that a nominal model lacks.

use serde::{Deserialize, Serialize};

/// A cause with its parameters, as `effects:` of a model file lists it and as a diagnosis names it.
///
/// ```text
/// - {cause: stribeck, joint: 3, breakaway_minus_coulomb_nm: 0.4, stribeck_velocity_rad_s: 0.05}
/// ```
///
/// Joints and links count from 0. s is sign(qd), smoothed; torques are on the motor side of the gears.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "cause", rename_all = "snake_case", deny_unknown_fields)]
pub enum Effect {
    /// `dFc s`.
    Coulomb {
        /// Joint.
        joint: usize,
        /// Coulomb friction above the nominal model's (Nm).
        delta_coulomb_nm: f64,
    },
    /// `dFv qd`.
    Viscous {
        /// Joint.
        joint: usize,
        /// Viscous friction above the nominal model's [Nm s/rad].
        delta_viscous_nm_s_per_rad: f64,
    },
    /// `dF exp(−(qd/vs)²) s`.
    Stribeck {
        /// Joint.
        joint: usize,
        /// Breakaway torque less Coulomb friction, dF (Nm).
        breakaway_minus_coulomb_nm: f64,
        /// Stribeck velocity vs [rad/s].
        stribeck_velocity_rad_s: f64,
    },
    /// `A tanh(qd/w)`: friction that bends with speed; beside viscous friction it makes any rising curve.
    FrictionCurve {
        /// Joint.
        joint: usize,
        /// Torque far above the width, A (Nm).
        amplitude_nm: f64,
        /// Speed at which three quarters are reached, w [rad/s].
        width_rad_s: f64,
    },
    /// `A (clip((qd + ℓ qdd)/w) − s)`, clip to ±1: dry friction that turns round before the joint does, as the soft constraint of a physics engine
    /// makes it (see [`crate::SoftFriction`]). It is nothing at constant speed; where A is the whole dry friction, the ramp takes the place of the
    /// smooth sign s.
    FrictionLead {
        /// Joint.
        joint: usize,
        /// Dry friction that leads, A (Nm).
        amplitude_nm: f64,
        /// Speed at which all of it is reached, w [rad/s].
        width_rad_s: f64,
        /// Time by which it leads the velocity, ℓ (s).
        lead_s: f64,
    },
    /// `a |s|`: more friction forwards than backwards.
    CoulombAsymmetry {
        /// Joint.
        joint: usize,
        /// Half the difference of Coulomb friction forwards and backwards (Nm).
        asymmetry_nm: f64,
    },
    /// A constant torque.
    TorqueOffset {
        /// Joint.
        joint: usize,
        /// Measured less true torque (Nm).
        offset_nm: f64,
    },
    /// `measured = (1 + g) true`.
    TorqueGain {
        /// Joint.
        joint: usize,
        /// g [-].
        gain_error: f64,
    },
    /// Dry and viscous friction lose `drop x(t)`; x tends from 0 to 1 with the time constant while the joint works.
    ThermalFriction {
        /// Joint.
        joint: usize,
        /// Part of the cold friction that is lost when warm [-].
        drop_fraction: f64,
        /// Time constant of warming up (s).
        time_constant_s: f64,
    },
    /// `γ |tau_link| s`.
    LoadFriction {
        /// Joint.
        joint: usize,
        /// Coulomb friction per link-side torque γ [-].
        load_coefficient: f64,
    },
    /// A body bolted to the flange; flange frame.
    Payload {
        /// Mass (kg).
        mass_kg: f64,
        /// Centre of mass (m).
        com_m: [f64; 3],
        /// Inertia about the centre of mass [kg m²]: xx xy xz yy yz zz.
        #[serde(default)]
        inertia_kg_m2: [f64; 6],
    },
    /// The base is turned by the angle about the axis: gravity in base axes is `R(axis, angle)ᵀ g`.
    BaseTilt {
        /// Angle (rad).
        angle_rad: f64,
        /// Axis in base axes; normalised on use.
        axis: [f64; 3],
    },
    /// One link differs from the nominal model; link frame.
    LinkInertial {
        /// Link.
        link: usize,
        /// Mass above the nominal model's (kg).
        delta_mass_kg: f64,
        /// First moment m c above the nominal model's [kg m].
        delta_first_moment_kg_m: [f64; 3],
        /// Inertia about the link origin above the nominal model's [kg m²]: xx xy xz yy yz zz.
        #[serde(default)]
        delta_inertia_kg_m2: [f64; 6],
    },
    /// `dIr qdd`.
    RotorInertia {
        /// Joint.
        joint: usize,
        /// Reflected rotor inertia above the nominal model's [kg m²].
        delta_rotor_inertia_kg_m2: f64,
    },
    /// `A sin(n q + φ)`.
    TorqueRipple {
        /// Joint.
        joint: usize,
        /// n [1/rev].
        cycles_per_rev: f64,
        /// A (Nm).
        amplitude_nm: f64,
        /// φ (rad).
        phase_rad: f64,
    },
    /// Dry friction follows a bristle: `Fc z`, `dz/dt = (qd − |qd| z) / distance`, |z| ≤ 1, in place of `Fc s`; with an
    /// amplitude, so much of it: `a (z − s)`. Bristles of several distances add up.
    Presliding {
        /// Joint.
        joint: usize,
        /// Travel over which dry friction builds up (rad).
        presliding_distance_rad: f64,
        /// The part of dry friction that does, a (Nm); all of it if left out.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        amplitude_nm: Option<f64>,
    },
    /// A spring and damper between motor (or motor-side encoder) and link.
    JointElasticity {
        /// Joint.
        joint: usize,
        /// Stiffness [Nm/rad].
        stiffness_nm_per_rad: f64,
        /// Damping [Nm s/rad].
        damping_nm_s_per_rad: f64,
    },
    /// A gap between motor and link: theta − q jumps by twice the half gap when the load changes sign.
    Backlash {
        /// Joint.
        joint: usize,
        /// Half the gap (rad).
        half_gap_rad: f64,
    },
    /// Torques are stamped late by this much; all joints.
    TimeDelay {
        /// Delay (s); positive is torque late.
        delay_s: f64,
    },
    /// The environment pushes the flange during a window; base axes, reference point at the flange.
    ExternalContact {
        /// Force on the robot (N).
        force_n: [f64; 3],
        /// Moment on the robot (Nm).
        moment_nm: [f64; 3],
        /// Start, time of the log (s).
        start_s: f64,
        /// End, time of the log (s).
        end_s: f64,
    },
    /// `k (q − rest)`, such as a hose.
    PositionSpring {
        /// Joint.
        joint: usize,
        /// Stiffness k [Nm/rad].
        stiffness_nm_per_rad: f64,
        /// Angle at which it is slack (rad).
        rest_rad: f64,
    },
}
