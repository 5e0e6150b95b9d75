//! How far the parameters of a finding are off.

use nalgebra::Vector3;
use tribo_sim::Effect;

/// Distance (m) that errors of a centre of mass are relative to.
const COM_SCALE_M: f64 = 0.1;
/// Angle (rad) that errors of a rest position are relative to.
const REST_SCALE_RAD: f64 = 1.0;

/// Relative errors of the main parameters of an effect of the same cause; nothing if the causes differ.
///
/// ```text
/// scalar |x̂ − x|/|x|,   vector ‖x̂ − x‖/‖x‖,   centre of mass ‖ĉ − c‖/0.1 m,   rest |r̂ − r|/1 rad,   window |t̂ − t|/length
/// ```
///
/// Of a link only the first moment across the axis of its joint counts, the rest may sit on the link before.
pub fn parameter_errors(found: &Effect, hidden: &Effect) -> Vec<(&'static str, f64)> {
    let scalar = |found: f64, hidden: f64| (found - hidden).abs() / hidden.abs().max(1e-12);
    let vector = |found: &[f64; 3], hidden: &[f64; 3]| {
        (Vector3::from(*found) - Vector3::from(*hidden)).norm() / Vector3::from(*hidden).norm().max(1e-12)
    };
    match (found, hidden) {
        (Effect::Coulomb { delta_coulomb_nm: a, .. }, Effect::Coulomb { delta_coulomb_nm: b, .. }) => {
            vec![("delta_coulomb_nm", scalar(*a, *b))]
        }
        (
            Effect::Viscous { delta_viscous_nm_s_per_rad: a, .. },
            Effect::Viscous { delta_viscous_nm_s_per_rad: b, .. },
        ) => vec![("delta_viscous_nm_s_per_rad", scalar(*a, *b))],
        (
            Effect::Stribeck { breakaway_minus_coulomb_nm: a, stribeck_velocity_rad_s: v, .. },
            Effect::Stribeck { breakaway_minus_coulomb_nm: b, stribeck_velocity_rad_s: w, .. },
        ) => vec![("breakaway_minus_coulomb_nm", scalar(*a, *b)), ("stribeck_velocity_rad_s", scalar(*v, *w))],
        (Effect::CoulombAsymmetry { asymmetry_nm: a, .. }, Effect::CoulombAsymmetry { asymmetry_nm: b, .. }) => {
            vec![("asymmetry_nm", scalar(*a, *b))]
        }
        (Effect::TorqueOffset { offset_nm: a, .. }, Effect::TorqueOffset { offset_nm: b, .. }) => {
            vec![("offset_nm", scalar(*a, *b))]
        }
        (Effect::TorqueGain { gain_error: a, .. }, Effect::TorqueGain { gain_error: b, .. }) => {
            vec![("gain_error", scalar(*a, *b))]
        }
        (
            Effect::ThermalFriction { drop_fraction: a, time_constant_s: t, .. },
            Effect::ThermalFriction { drop_fraction: b, time_constant_s: u, .. },
        ) => vec![("drop_fraction", scalar(*a, *b)), ("time_constant_s", scalar(*t, *u))],
        (Effect::LoadFriction { load_coefficient: a, .. }, Effect::LoadFriction { load_coefficient: b, .. }) => {
            vec![("load_coefficient", scalar(*a, *b))]
        }
        (Effect::Payload { mass_kg: a, com_m: c, .. }, Effect::Payload { mass_kg: b, com_m: d, .. }) => {
            let com = (Vector3::from(*c) - Vector3::from(*d)).norm() / COM_SCALE_M;
            vec![("mass_kg", scalar(*a, *b)), ("com_m", com)]
        }
        (Effect::BaseTilt { angle_rad: a, axis: x }, Effect::BaseTilt { angle_rad: b, axis: y }) => {
            let turn = |angle: f64, axis: &[f64; 3]| {
                let axis = Vector3::from(*axis);
                let turn = axis / axis.norm().max(1e-12) * angle;
                // About the vertical, gravity does not change.
                [turn.x, turn.y, 0.0]
            };
            vec![("angle_rad", vector(&turn(*a, x), &turn(*b, y)))]
        }
        (
            Effect::LinkInertial { delta_first_moment_kg_m: a, .. },
            Effect::LinkInertial { delta_first_moment_kg_m: b, .. },
        ) => vec![("delta_first_moment_kg_m", vector(&[a[0], a[1], 0.0], &[b[0], b[1], 0.0]))],
        (
            Effect::RotorInertia { delta_rotor_inertia_kg_m2: a, .. },
            Effect::RotorInertia { delta_rotor_inertia_kg_m2: b, .. },
        ) => vec![("delta_rotor_inertia_kg_m2", scalar(*a, *b))],
        (
            Effect::TorqueRipple { cycles_per_rev: n, amplitude_nm: a, .. },
            Effect::TorqueRipple { cycles_per_rev: m, amplitude_nm: b, .. },
        ) => vec![("cycles_per_rev", scalar(*n, *m)), ("amplitude_nm", scalar(a.abs(), b.abs()))],
        (
            Effect::Presliding { presliding_distance_rad: a, .. },
            Effect::Presliding { presliding_distance_rad: b, .. },
        ) => vec![("presliding_distance_rad", scalar(*a, *b))],
        (
            Effect::JointElasticity { stiffness_nm_per_rad: a, .. },
            Effect::JointElasticity { stiffness_nm_per_rad: b, .. },
        ) => vec![("stiffness_nm_per_rad", scalar(*a, *b))],
        (Effect::Backlash { half_gap_rad: a, .. }, Effect::Backlash { half_gap_rad: b, .. }) => {
            vec![("half_gap_rad", scalar(*a, *b))]
        }
        (Effect::TimeDelay { delay_s: a }, Effect::TimeDelay { delay_s: b }) => vec![("delay_s", scalar(*a, *b))],
        (
            Effect::ExternalContact { force_n: f, start_s: a, end_s: b, .. },
            Effect::ExternalContact { force_n: g, start_s: c, end_s: d, .. },
        ) => vec![("force_n", vector(f, g)), ("window", (a - c).abs().max((b - d).abs()) / (d - c))],
        (
            Effect::PositionSpring { stiffness_nm_per_rad: a, rest_rad: r, .. },
            Effect::PositionSpring { stiffness_nm_per_rad: b, rest_rad: s, .. },
        ) => vec![("stiffness_nm_per_rad", scalar(*a, *b)), ("rest_rad", (r - s).abs() / REST_SCALE_RAD)],
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_relative_and_need_the_same_cause() {
        let offset = |offset_nm| Effect::TorqueOffset { joint: 1, offset_nm };
        let errors = parameter_errors(&offset(0.9), &offset(1.0));
        assert!(errors.len() == 1 && (errors[0].1 - 0.1).abs() < 1e-12);
        assert!(parameter_errors(&offset(1.0), &Effect::TimeDelay { delay_s: 0.01 }).is_empty());
        // A tilt about −x by −a is one about x by a.
        let tilt = |angle_rad, x| Effect::BaseTilt { angle_rad, axis: [x, 0.0, 0.0] };
        assert!(parameter_errors(&tilt(-0.02, -3.0), &tilt(0.02, 1.0))[0].1 < 1e-12);
    }
}
