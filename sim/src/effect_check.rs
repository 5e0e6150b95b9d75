//! What an effect may be.

use nalgebra::{Matrix3, Vector3};
use thiserror::Error;
use tribo_friction::{MAX_BRISTLES, MAX_CURVES, MAX_RIPPLES};

use crate::Effect;

/// Why an effect cannot be simulated.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum EffectError {
    /// A parameter is not finite or outside its range.
    #[error("{cause}: {field}: {value} is outside {allowed}")]
    OutOfRange {
        /// The cause.
        cause: &'static str,
        /// The parameter.
        field: &'static str,
        /// Its value.
        value: f64,
        /// The allowed range.
        allowed: &'static str,
    },
    /// The arm has no such joint or link.
    #[error("{cause}: {index} is outside 0..{joints}: joints and links count from 0")]
    NoSuchJoint {
        /// The cause.
        cause: &'static str,
        /// Joint or link asked for.
        index: usize,
        /// Joints of the arm.
        joints: usize,
    },
    /// A joint has the same cause more often than it can be told apart.
    #[error("{cause}: {count} of them on joint {joint}, at most {most}")]
    TooMany {
        /// The cause.
        cause: &'static str,
        /// The joint.
        joint: usize,
        /// How many are listed.
        count: usize,
        /// How many one joint takes.
        most: usize,
    },
    /// A link would be lighter than nothing.
    #[error("link_inertial: link {link} would have the mass {mass_kg} kg")]
    MasslessLink {
        /// The link.
        link: usize,
        /// Its mass with all effects (kg).
        mass_kg: f64,
    },
}

/// A parameter, its value, and its closed range with its text.
type Bound = (&'static str, f64, f64, f64, &'static str);

impl Effect {
    /// Name of the cause, as in files.
    pub fn cause(&self) -> &'static str {
        match self {
            Self::Coulomb { .. } => "coulomb",
            Self::Viscous { .. } => "viscous",
            Self::Stribeck { .. } => "stribeck",
            Self::FrictionCurve { .. } => "friction_curve",
            Self::FrictionLead { .. } => "friction_lead",
            Self::CoulombAsymmetry { .. } => "coulomb_asymmetry",
            Self::TorqueOffset { .. } => "torque_offset",
            Self::TorqueGain { .. } => "torque_gain",
            Self::ThermalFriction { .. } => "thermal_friction",
            Self::LoadFriction { .. } => "load_friction",
            Self::Payload { .. } => "payload",
            Self::BaseTilt { .. } => "base_tilt",
            Self::LinkInertial { .. } => "link_inertial",
            Self::RotorInertia { .. } => "rotor_inertia",
            Self::TorqueRipple { .. } => "torque_ripple",
            Self::Presliding { .. } => "presliding",
            Self::JointElasticity { .. } => "joint_elasticity",
            Self::Backlash { .. } => "backlash",
            Self::TimeDelay { .. } => "time_delay",
            Self::ExternalContact { .. } => "external_contact",
            Self::PositionSpring { .. } => "position_spring",
        }
    }

    /// The joint it acts on, if it acts on one.
    pub fn joint(&self) -> Option<usize> {
        match *self {
            Self::Coulomb { joint, .. }
            | Self::Viscous { joint, .. }
            | Self::Stribeck { joint, .. }
            | Self::FrictionCurve { joint, .. }
            | Self::FrictionLead { joint, .. }
            | Self::CoulombAsymmetry { joint, .. }
            | Self::TorqueOffset { joint, .. }
            | Self::TorqueGain { joint, .. }
            | Self::ThermalFriction { joint, .. }
            | Self::LoadFriction { joint, .. }
            | Self::RotorInertia { joint, .. }
            | Self::TorqueRipple { joint, .. }
            | Self::Presliding { joint, .. }
            | Self::JointElasticity { joint, .. }
            | Self::Backlash { joint, .. }
            | Self::PositionSpring { joint, .. } => Some(joint),
            Self::Payload { .. }
            | Self::BaseTilt { .. }
            | Self::LinkInertial { .. }
            | Self::TimeDelay { .. }
            | Self::ExternalContact { .. } => None,
        }
    }

    /// Checks joint or link against an arm of `joints` joints, and every parameter against its physical range.
    ///
    /// # Errors
    /// [`EffectError::NoSuchJoint`] or [`EffectError::OutOfRange`], whichever is met first.
    pub fn validate(&self, joints: usize) -> Result<(), EffectError> {
        let cause = self.cause();
        let place = match *self {
            Self::LinkInertial { link, .. } => Some(link),
            _ => self.joint(),
        };
        if let Some(index) = place.filter(|&index| index >= joints) {
            return Err(EffectError::NoSuchJoint { cause, index, joints });
        }
        for (field, value, least, most, allowed) in self.bounds() {
            if !(value >= least && value <= most) {
                return Err(EffectError::OutOfRange { cause, field, value, allowed });
            }
        }
        Ok(())
    }

    /// Every parameter with its range.
    fn bounds(&self) -> Vec<Bound> {
        const TORQUE: (f64, f64, &str) = (-1e3, 1e3, "-1000..1000");
        const POSITIVE: f64 = 1e-9;
        let one = |field, value, (least, most, allowed): (f64, f64, &'static str)| (field, value, least, most, allowed);
        let each = |field, values: &[f64], range: (f64, f64, &'static str)| {
            values.iter().map(|&v| one(field, v, range)).collect()
        };
        match *self {
            Self::Coulomb { delta_coulomb_nm, .. } => vec![one("delta_coulomb_nm", delta_coulomb_nm, TORQUE)],
            Self::Viscous { delta_viscous_nm_s_per_rad: value, .. } => {
                vec![one("delta_viscous_nm_s_per_rad", value, TORQUE)]
            }
            Self::Stribeck { breakaway_minus_coulomb_nm, stribeck_velocity_rad_s, .. } => vec![
                one("breakaway_minus_coulomb_nm", breakaway_minus_coulomb_nm, TORQUE),
                one("stribeck_velocity_rad_s", stribeck_velocity_rad_s, (1e-5, 10.0, "1e-5..10")),
            ],
            Self::FrictionCurve { amplitude_nm, width_rad_s, .. } => vec![
                one("amplitude_nm", amplitude_nm, TORQUE),
                one("width_rad_s", width_rad_s, (1e-5, 100.0, "1e-5..100")),
            ],
            Self::FrictionLead { amplitude_nm, width_rad_s, lead_s, .. } => vec![
                one("amplitude_nm", amplitude_nm, TORQUE),
                one("width_rad_s", width_rad_s, (1e-5, 100.0, "1e-5..100")),
                one("lead_s", lead_s, (-1.0, 1.0, "-1..1")),
            ],
            Self::CoulombAsymmetry { asymmetry_nm, .. } => vec![one("asymmetry_nm", asymmetry_nm, TORQUE)],
            Self::TorqueOffset { offset_nm, .. } => vec![one("offset_nm", offset_nm, TORQUE)],
            Self::TorqueGain { gain_error, .. } => vec![one("gain_error", gain_error, (-0.9, 10.0, "-0.9..10"))],
            Self::ThermalFriction { drop_fraction, time_constant_s, .. } => vec![
                one("drop_fraction", drop_fraction, (-2.0, 1.0, "-2..1")),
                one("time_constant_s", time_constant_s, (1.0, 1e6, "1..1e6")),
            ],
            Self::LoadFriction { load_coefficient, .. } => {
                vec![one("load_coefficient", load_coefficient, (-1.0, 1.0, "-1..1"))]
            }
            Self::Payload { mass_kg, com_m, inertia_kg_m2 } => {
                let mut bounds: Vec<Bound> = each("com_m", &com_m, (-2.0, 2.0, "-2..2"));
                bounds.push(one("mass_kg", mass_kg, (0.0, 200.0, "0..200")));
                bounds.extend(each_inertia("inertia_kg_m2", &inertia_kg_m2));
                let least = symmetric(&inertia_kg_m2).symmetric_eigenvalues().min();
                bounds.push(one("inertia_kg_m2", least, (-1e-9, 100.0, "positive semidefinite tensors")));
                bounds
            }
            Self::BaseTilt { angle_rad, axis } => {
                let mut bounds: Vec<Bound> = each("axis", &axis, (-1e6, 1e6, "-1e6..1e6"));
                bounds.push(one("angle_rad", angle_rad, (-3.2, 3.2, "-3.2..3.2")));
                bounds.push(one("axis", Vector3::from(axis).norm(), (1e-6, 1e7, "lengths above 1e-6")));
                bounds
            }
            Self::LinkInertial { delta_mass_kg, delta_first_moment_kg_m, delta_inertia_kg_m2, .. } => {
                let moment = (-100.0, 100.0, "-100..100");
                let mut bounds: Vec<Bound> = each("delta_first_moment_kg_m", &delta_first_moment_kg_m, moment);
                bounds.push(one("delta_mass_kg", delta_mass_kg, (-200.0, 200.0, "-200..200")));
                bounds.extend(each_inertia("delta_inertia_kg_m2", &delta_inertia_kg_m2));
                bounds
            }
            Self::RotorInertia { delta_rotor_inertia_kg_m2: value, .. } => {
                vec![one("delta_rotor_inertia_kg_m2", value, (-100.0, 100.0, "-100..100"))]
            }
            Self::TorqueRipple { cycles_per_rev, amplitude_nm, phase_rad, .. } => vec![
                one("cycles_per_rev", cycles_per_rev, (POSITIVE, 1e5, "above 0 up to 1e5")),
                one("amplitude_nm", amplitude_nm, TORQUE),
                one("phase_rad", phase_rad, (-1e3, 1e3, "-1000..1000")),
            ],
            Self::Presliding { presliding_distance_rad: value, amplitude_nm, .. } => vec![
                one("presliding_distance_rad", value, (1e-6, 1.0, "1e-6..1")),
                one("amplitude_nm", amplitude_nm.unwrap_or(0.0), TORQUE),
            ],
            Self::JointElasticity { stiffness_nm_per_rad, damping_nm_s_per_rad, .. } => vec![
                one("stiffness_nm_per_rad", stiffness_nm_per_rad, (100.0, 1e8, "100..1e8")),
                one("damping_nm_s_per_rad", damping_nm_s_per_rad, (0.0, 1e5, "0..1e5")),
            ],
            Self::Backlash { half_gap_rad, .. } => vec![one("half_gap_rad", half_gap_rad, (0.0, 0.5, "0..0.5"))],
            Self::TimeDelay { delay_s } => vec![one("delay_s", delay_s, (-1.0, 1.0, "-1..1"))],
            Self::ExternalContact { force_n, moment_nm, start_s, end_s } => {
                let mut bounds: Vec<Bound> = each("force_n", &force_n, (-1e4, 1e4, "-1e4..1e4"));
                bounds.extend(each("moment_nm", &moment_nm, (-1e4, 1e4, "-1e4..1e4")) as Vec<Bound>);
                bounds.push(one("start_s", start_s, (-1e12, 1e12, "finite times")));
                bounds.push(("end_s", end_s, start_s, 1e12, "times from start_s on"));
                bounds
            }
            Self::PositionSpring { stiffness_nm_per_rad, rest_rad, .. } => vec![
                one("stiffness_nm_per_rad", stiffness_nm_per_rad, (-1e4, 1e4, "-1e4..1e4")),
                one("rest_rad", rest_rad, (-100.0, 100.0, "-100..100")),
            ],
        }
    }

    /// Whether the other takes the same places on a joint: of the same cause, and both the whole presliding or both a part.
    fn same_kind(&self, other: &Self) -> bool {
        let part = |effect: &Self| matches!(effect, Self::Presliding { amplitude_nm: Some(_), .. });
        self.cause() == other.cause() && part(self) == part(other)
    }

    /// How many of this kind one joint takes; the others simply add up.
    fn most_per_joint(&self) -> usize {
        match self {
            Self::TorqueRipple { .. } => MAX_RIPPLES,
            Self::FrictionCurve { .. } => MAX_CURVES,
            Self::Presliding { amplitude_nm: Some(_), .. } => MAX_BRISTLES,
            Self::Stribeck { .. }
            | Self::ThermalFriction { .. }
            | Self::Presliding { .. }
            | Self::JointElasticity { .. }
            | Self::Backlash { .. }
            | Self::PositionSpring { .. } => 1,
            _ => usize::MAX,
        }
    }
}

/// [`Effect::validate`] for each, and that they fit on one joint together.
pub(crate) fn validate_together(effects: &[Effect], joints: usize) -> Result<(), EffectError> {
    for effect in effects {
        effect.validate(joints)?;
        if let Some(joint) = effect.joint() {
            let (cause, most) = (effect.cause(), effect.most_per_joint());
            let count = effects.iter().filter(|e| e.joint() == Some(joint) && e.same_kind(effect)).count();
            if count > most {
                return Err(EffectError::TooMany { cause, joint, count, most });
            }
        }
    }
    Ok(())
}

/// The tensor written xx xy xz yy yz zz.
pub(crate) fn symmetric(&[xx, xy, xz, yy, yz, zz]: &[f64; 6]) -> Matrix3<f64> {
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}

fn each_inertia(field: &'static str, values: &[f64; 6]) -> impl Iterator<Item = Bound> {
    values.map(|value| (field, value, -100.0, 100.0, "-100..100")).into_iter()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_name_field_and_range() {
        let ripple = Effect::TorqueRipple { joint: 2, cycles_per_rev: 100.0, amplitude_nm: f64::NAN, phase_rad: 0.0 };
        assert_eq!(
            ripple.validate(7).unwrap_err().to_string(),
            "torque_ripple: amplitude_nm: NaN is outside -1000..1000"
        );
        let coulomb = Effect::Coulomb { joint: 7, delta_coulomb_nm: 0.1 };
        assert!(coulomb.validate(7).unwrap_err().to_string().contains("7 is outside 0..7"));
        assert!(coulomb.validate(8).is_ok());
        let backwards = Effect::ExternalContact { force_n: [0.0; 3], moment_nm: [0.0; 3], start_s: 2.0, end_s: 1.0 };
        assert!(backwards.validate(7).unwrap_err().to_string().contains("end_s"));
        let tilt = Effect::BaseTilt { angle_rad: 0.1, axis: [0.0; 3] };
        assert!(tilt.validate(7).is_err());
        let hollow = Effect::Payload { mass_kg: 1.0, com_m: [0.0; 3], inertia_kg_m2: [-0.1, 0.0, 0.0, 0.1, 0.0, 0.1] };
        assert!(hollow.validate(7).unwrap_err().to_string().contains("semidefinite"));
    }

    #[test]
    fn a_joint_takes_each_nonlinear_cause_once() {
        let bristle = |amplitude_nm| Effect::Presliding { joint: 1, presliding_distance_rad: 1e-3, amplitude_nm };
        let presliding = bristle(None);
        assert!(validate_together(&[presliding.clone(), presliding.clone()], 7).is_err());
        let offset = Effect::TorqueOffset { joint: 1, offset_nm: 0.1 };
        assert!(validate_together(&[offset.clone(), offset, presliding.clone()], 7).is_ok());
        // Three curves, and three bristles of parts beside that of the whole.
        let curve = Effect::FrictionCurve { joint: 1, amplitude_nm: 0.1, width_rad_s: 0.2 };
        let mut most = vec![bristle(Some(0.1)); 3];
        most.extend([presliding.clone(), curve.clone(), curve.clone(), curve.clone()]);
        assert_eq!(validate_together(&most, 7), Ok(()));
        for one_more in [bristle(Some(-0.1)), presliding, curve] {
            let cause = one_more.cause();
            let error = validate_together(&[&most[..], &[one_more]].concat(), 7).unwrap_err();
            assert!(matches!(error, EffectError::TooMany { cause: of, joint: 1, .. } if of == cause), "{error}");
        }
    }

    #[test]
    fn curves_and_bristles_have_ranges() {
        let curve = |amplitude_nm, width_rad_s| Effect::FrictionCurve { joint: 0, amplitude_nm, width_rad_s };
        assert!(curve(-0.2, 0.1).validate(7).is_ok());
        let refused = |effect: Effect| effect.validate(7).unwrap_err().to_string();
        assert_eq!(refused(curve(0.1, 0.0)), "friction_curve: width_rad_s: 0 is outside 1e-5..100");
        assert_eq!(refused(curve(f64::NAN, 0.1)), "friction_curve: amplitude_nm: NaN is outside -1000..1000");
        let bristle = |amplitude_nm, presliding_distance_rad| Effect::Presliding {
            joint: 0,
            presliding_distance_rad,
            amplitude_nm: Some(amplitude_nm),
        };
        assert!(bristle(-0.2, 1e-3).validate(7).is_ok());
        assert_eq!(refused(bristle(0.1, 0.0)), "presliding: presliding_distance_rad: 0 is outside 1e-6..1");
        assert_eq!(refused(bristle(2e3, 1e-3)), "presliding: amplitude_nm: 2000 is outside -1000..1000");
    }

    /// The name in errors is the name in files.
    #[test]
    fn the_cause_is_the_tag() {
        let tag = "{\"cause\":\"time_delay\",\"delay_s\":0.002}";
        let effect = Effect::TimeDelay { delay_s: 0.002 };
        assert!(tag.contains(effect.cause()));
        assert_eq!(effect.joint(), None);
    }
}
