//! The causes, one per file: physics, regressors, profiled parameters with their bounds, and what they need.
//!
//! ```text
//! residual = Σ_c column_c(q, qd, qdd, t; shape) · coefficient_c + noise
//! ```
//!
//! A candidate is a cause at a place. Its columns are linear in the coefficients; what is not linear (a speed, a
//! distance, a time constant) is its *shape*, searched over a grid and then refined.

mod backlash;
mod base_tilt;
mod coulomb;
mod coulomb_asymmetry;
mod external_contact;
mod friction_curve;
mod friction_lead;
mod joint_elasticity;
mod link_inertial;
mod load_friction;
mod payload;
mod position_spring;
mod presliding;
mod rotor_inertia;
mod stribeck;
mod thermal_friction;
mod time_delay;
mod torque_gain;
mod torque_offset;
mod torque_ripple;
mod unknown;
mod viscous;

pub(crate) use backlash::{Backlash, transmitted_sign};
pub use base_tilt::{base_tilt_columns, tilt_of};
pub use external_contact::ExternalContact;
pub(crate) use joint_elasticity::JointElasticity;
pub use payload::link_from_flange;
pub use presliding::bristle;
pub(crate) use time_delay::interpolated;
pub use torque_ripple::TorqueRipple;

use std::ops::Range;

use nalgebra::SVector;
use tribo_sim::Effect;

use crate::column::{Column, FineColumn};
use crate::label::{CauseLabel, Location};
use crate::regression_data::RegressionData;

/// A cause at a place.
pub trait Candidate<const N: usize>: Send + Sync {
    /// What.
    fn label(&self) -> CauseLabel;

    /// Where.
    fn location(&self) -> Location;

    /// The log that it acts in; `None` for what acts in all.
    fn log(&self) -> Option<usize> {
        None
    }

    /// Why these data cannot show it, if so.
    fn unavailable(&self, _data: &RegressionData<N>) -> Option<String> {
        None
    }

    /// Grid of the nonlinear parameters; one empty shape for a linear cause.
    fn shapes(&self, _data: &RegressionData<N>) -> Vec<Vec<f64>> {
        vec![Vec::new()]
    }

    /// Bounds of the one nonlinear parameter that is refined on a logarithmic scale.
    fn profile(&self) -> Option<[f64; 2]> {
        None
    }

    /// A better shape, where a coefficient says so (fixed point of a linearisation).
    fn fixed_point(&self, _shape: &[f64], _coefficients: &[f64]) -> Option<Vec<f64>> {
        None
    }

    /// Torque per unit of each coefficient on the fine grid.
    fn columns(&self, data: &RegressionData<N>, shape: &[f64]) -> Vec<FineColumn<N>>;

    /// `sum += Σ coefficient · column` on the fine grid.
    fn add_to(&self, data: &RegressionData<N>, shape: &[f64], coefficients: &[f64], sum: &mut [SVector<f64, N>]) {
        self.columns(data, shape).iter().zip(coefficients).for_each(|(column, c)| column.add_to(sum, *c));
    }

    /// The columns in the band, which not every candidate needs to filter anew.
    fn filtered(&self, data: &RegressionData<N>, shape: &[f64]) -> Vec<Column<N>> {
        data.filter_all(&self.columns(data, shape))
    }

    /// Which columns of the widest candidate of the same cause and place these are, if they are any: they are kept once.
    fn columns_of_widest(&self) -> Option<Range<usize>> {
        None
    }

    /// Whether physics allows these values.
    fn admissible(&self, _data: &RegressionData<N>, _shape: &[f64], _coefficients: &[f64]) -> bool {
        true
    }

    /// The effect with these values; `None` for what no model can take.
    fn effect(&self, data: &RegressionData<N>, shape: &[f64], coefficients: &[f64]) -> Option<Effect>;

    /// What the torque goes with, for an unknown cause.
    fn signature(&self) -> Option<String> {
        None
    }
}

/// Every candidate that does not have to be searched for in time or over the joint angle.
pub fn candidates<const N: usize>() -> Vec<Box<dyn Candidate<N>>> {
    let mut all: Vec<Box<dyn Candidate<N>>> = Vec::new();
    for joint in 0..N {
        all.push(Box::new(coulomb::Coulomb { joint }));
        all.push(Box::new(viscous::Viscous { joint }));
        all.push(Box::new(torque_offset::TorqueOffset { joint }));
        all.push(Box::new(coulomb_asymmetry::CoulombAsymmetry { joint }));
        all.push(Box::new(torque_gain::TorqueGain { joint }));
        all.push(Box::new(rotor_inertia::RotorInertia { joint }));
        all.push(Box::new(load_friction::LoadFriction { joint }));
        all.push(Box::new(position_spring::PositionSpring { joint }));
        all.push(Box::new(stribeck::Stribeck { joint }));
        all.push(Box::new(presliding::Presliding { joint }));
        all.push(Box::new(thermal_friction::ThermalFriction { joint }));
        all.push(Box::new(JointElasticity { joint }));
        for family in unknown::Family::of_joint::<N>(joint) {
            all.push(Box::new(unknown::Unknown { joint, family }));
        }
    }
    for extent in [payload::Extent::PointMass, payload::Extent::Body] {
        all.push(Box::new(payload::Payload { extent }));
    }
    for gravity_changes_length in [false, true] {
        all.push(Box::new(base_tilt::BaseTilt { large: gravity_changes_length }));
    }
    for link in 0..N {
        for extent in link_inertial::Extent::ALL {
            all.push(Box::new(link_inertial::LinkInertial { link, extent }));
        }
    }
    all.push(Box::new(time_delay::TimeDelay));
    all
}

/// A candidate with its shape and coefficients.
pub(crate) type Placed<const N: usize> = (Box<dyn Candidate<N>>, Vec<f64>, Vec<f64>);

/// The candidate, shape and coefficients that reproduce an effect's torque, or `None` where it is not a torque.
pub fn candidate_of_effect<const N: usize>(effect: &Effect) -> Option<Placed<N>> {
    let placed: Placed<N> = match *effect {
        Effect::Coulomb { joint, delta_coulomb_nm } => {
            (Box::new(coulomb::Coulomb { joint }), vec![], vec![delta_coulomb_nm])
        }
        Effect::Viscous { joint, delta_viscous_nm_s_per_rad } => {
            (Box::new(viscous::Viscous { joint }), vec![], vec![delta_viscous_nm_s_per_rad])
        }
        Effect::Stribeck { joint, breakaway_minus_coulomb_nm, stribeck_velocity_rad_s } => {
            (Box::new(stribeck::Stribeck { joint }), vec![stribeck_velocity_rad_s], vec![breakaway_minus_coulomb_nm])
        }
        Effect::FrictionCurve { joint, amplitude_nm, width_rad_s } => {
            (Box::new(friction_curve::FrictionCurve { joint }), vec![width_rad_s], vec![amplitude_nm])
        }
        Effect::FrictionLead { joint, amplitude_nm, width_rad_s, lead_s } => {
            (Box::new(friction_lead::FrictionLead { joint }), vec![width_rad_s, lead_s], vec![amplitude_nm])
        }
        Effect::CoulombAsymmetry { joint, asymmetry_nm } => {
            (Box::new(coulomb_asymmetry::CoulombAsymmetry { joint }), vec![], vec![asymmetry_nm])
        }
        Effect::TorqueOffset { joint, offset_nm } => {
            (Box::new(torque_offset::TorqueOffset { joint }), vec![], vec![offset_nm])
        }
        Effect::TorqueGain { joint, gain_error } => {
            (Box::new(torque_gain::TorqueGain { joint }), vec![], vec![gain_error])
        }
        Effect::ThermalFriction { joint, drop_fraction, time_constant_s } => {
            (Box::new(thermal_friction::ThermalFriction { joint }), vec![time_constant_s], vec![drop_fraction])
        }
        Effect::LoadFriction { joint, load_coefficient } => {
            (Box::new(load_friction::LoadFriction { joint }), vec![], vec![load_coefficient])
        }
        Effect::Payload { mass_kg, com_m, inertia_kg_m2 } => (
            Box::new(payload::Payload { extent: payload::Extent::Body }),
            vec![],
            payload::coefficients(mass_kg, &com_m, &inertia_kg_m2),
        ),
        Effect::BaseTilt { angle_rad, axis } => {
            (Box::new(base_tilt::BaseTilt { large: true }), vec![], base_tilt::gravity_change(angle_rad, &axis))
        }
        Effect::LinkInertial { link, delta_mass_kg, delta_first_moment_kg_m, delta_inertia_kg_m2 } => {
            let mut coefficients = vec![delta_mass_kg];
            coefficients.extend(delta_first_moment_kg_m);
            coefficients.extend(delta_inertia_kg_m2);
            (Box::new(link_inertial::LinkInertial { link, extent: link_inertial::Extent::Body }), vec![], coefficients)
        }
        Effect::RotorInertia { joint, delta_rotor_inertia_kg_m2 } => {
            (Box::new(rotor_inertia::RotorInertia { joint }), vec![], vec![delta_rotor_inertia_kg_m2])
        }
        Effect::TorqueRipple { joint, cycles_per_rev, amplitude_nm, phase_rad } => (
            Box::new(TorqueRipple { joint }),
            vec![cycles_per_rev],
            vec![amplitude_nm * phase_rad.cos(), amplitude_nm * phase_rad.sin()],
        ),
        Effect::Presliding { joint, presliding_distance_rad, amplitude_nm } => {
            let amplitude = vec![amplitude_nm.unwrap_or(f64::NAN)];
            (Box::new(presliding::Presliding { joint }), vec![presliding_distance_rad], amplitude)
        }
        Effect::JointElasticity { joint, stiffness_nm_per_rad, damping_nm_s_per_rad } => {
            (Box::new(JointElasticity { joint }), vec![stiffness_nm_per_rad, damping_nm_s_per_rad], vec![1.0])
        }
        Effect::TimeDelay { delay_s } => (Box::new(time_delay::TimeDelay), vec![delay_s], vec![delay_s]),
        Effect::ExternalContact { force_n, moment_nm, start_s, end_s } => (
            Box::new(ExternalContact { log: None }),
            vec![start_s, end_s],
            force_n.into_iter().chain(moment_nm).collect(),
        ),
        Effect::PositionSpring { joint, stiffness_nm_per_rad, rest_rad } => (
            Box::new(position_spring::PositionSpring { joint }),
            vec![],
            vec![-stiffness_nm_per_rad * rest_rad, stiffness_nm_per_rad],
        ),
        Effect::Backlash { .. } => return None,
    };
    Some(placed)
}

/// Why causes of the rigid body are left out where the link torque is measured.
const RIGID_UNASKED: &str = "the link torque is measured: the residual is the transmission's alone";

/// Logarithmic grid from `low` to `high`.
fn log_grid(low: f64, high: f64, count: usize) -> Vec<Vec<f64>> {
    let ratio = (high / low).ln() / (count.max(2) - 1) as f64;
    (0..count).map(|k| vec![low * (ratio * k as f64).exp()]).collect()
}

/// The vector with one component.
fn only<const N: usize>(joint: usize, value: f64) -> SVector<f64, N> {
    SVector::from_fn(|j, _| if j == joint { value } else { 0.0 })
}

#[cfg(test)]
mod tests;
