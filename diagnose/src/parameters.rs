//! The parameters of an effect by their names in files.

use tribo_sim::Effect;

/// Name with unit suffix, and one value or three.
pub(crate) fn parameters_of(effect: &Effect) -> Vec<(&'static str, Vec<f64>)> {
    match *effect {
        Effect::Coulomb { delta_coulomb_nm, .. } => vec![("delta_coulomb_nm", vec![delta_coulomb_nm])],
        Effect::Viscous { delta_viscous_nm_s_per_rad, .. } => {
            vec![("delta_viscous_nm_s_per_rad", vec![delta_viscous_nm_s_per_rad])]
        }
        Effect::Stribeck { breakaway_minus_coulomb_nm, stribeck_velocity_rad_s, .. } => vec![
            ("breakaway_minus_coulomb_nm", vec![breakaway_minus_coulomb_nm]),
            ("stribeck_velocity_rad_s", vec![stribeck_velocity_rad_s]),
        ],
        Effect::CoulombAsymmetry { asymmetry_nm, .. } => vec![("asymmetry_nm", vec![asymmetry_nm])],
        Effect::TorqueOffset { offset_nm, .. } => vec![("offset_nm", vec![offset_nm])],
        Effect::TorqueGain { gain_error, .. } => vec![("gain_error", vec![gain_error])],
        Effect::ThermalFriction { drop_fraction, time_constant_s, .. } => {
            vec![("drop_fraction", vec![drop_fraction]), ("time_constant_s", vec![time_constant_s])]
        }
        Effect::LoadFriction { load_coefficient, .. } => vec![("load_coefficient", vec![load_coefficient])],
        Effect::Payload { mass_kg, com_m, .. } => vec![("mass_kg", vec![mass_kg]), ("com_m", com_m.to_vec())],
        Effect::BaseTilt { angle_rad, axis } => vec![("angle_rad", vec![angle_rad]), ("axis", axis.to_vec())],
        Effect::LinkInertial { delta_mass_kg, delta_first_moment_kg_m, .. } => {
            vec![("delta_mass_kg", vec![delta_mass_kg]), ("delta_first_moment_kg_m", delta_first_moment_kg_m.to_vec())]
        }
        Effect::RotorInertia { delta_rotor_inertia_kg_m2, .. } => {
            vec![("delta_rotor_inertia_kg_m2", vec![delta_rotor_inertia_kg_m2])]
        }
        Effect::TorqueRipple { cycles_per_rev, amplitude_nm, phase_rad, .. } => vec![
            ("cycles_per_rev", vec![cycles_per_rev]),
            ("amplitude_nm", vec![amplitude_nm]),
            ("phase_rad", vec![phase_rad]),
        ],
        Effect::Presliding { presliding_distance_rad, amplitude_nm, .. } => {
            let mut parameters = vec![("presliding_distance_rad", vec![presliding_distance_rad])];
            parameters.extend(amplitude_nm.map(|amplitude_nm| ("amplitude_nm", vec![amplitude_nm])));
            parameters
        }
        Effect::FrictionCurve { amplitude_nm, width_rad_s, .. } => {
            vec![("amplitude_nm", vec![amplitude_nm]), ("width_rad_s", vec![width_rad_s])]
        }
        Effect::FrictionLead { amplitude_nm, width_rad_s, lead_s, .. } => {
            vec![("amplitude_nm", vec![amplitude_nm]), ("width_rad_s", vec![width_rad_s]), ("lead_s", vec![lead_s])]
        }
        Effect::JointElasticity { stiffness_nm_per_rad, damping_nm_s_per_rad, .. } => vec![
            ("stiffness_nm_per_rad", vec![stiffness_nm_per_rad]),
            ("damping_nm_s_per_rad", vec![damping_nm_s_per_rad]),
        ],
        Effect::Backlash { half_gap_rad, .. } => vec![("half_gap_rad", vec![half_gap_rad])],
        Effect::TimeDelay { delay_s } => vec![("delay_s", vec![delay_s])],
        Effect::ExternalContact { force_n, moment_nm, start_s, end_s } => vec![
            ("force_n", force_n.to_vec()),
            ("moment_nm", moment_nm.to_vec()),
            ("start_s", vec![start_s]),
            ("end_s", vec![end_s]),
        ],
        Effect::PositionSpring { stiffness_nm_per_rad, rest_rad, .. } => {
            vec![("stiffness_nm_per_rad", vec![stiffness_nm_per_rad]), ("rest_rad", vec![rest_rad])]
        }
    }
}
