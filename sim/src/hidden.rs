//! The effects of a truth, sorted by where they act.

use nalgebra::{SVector, Vector3};
use tribo_friction::law::{leading_sign, smooth_sign};
use tribo_friction::{BristlePart, Curve, JointEffects, JointFriction, MAX_BRISTLES, Ripple};
use tribo_robot::{Arm, LinkInertia, Payload, Wrench, so3};

use crate::effect_check::{symmetric, validate_together};
use crate::{Effect, EffectError, Truth};

/// Loss of one joint's dry and viscous friction by its own warmth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct JointThermal {
    pub drop_fraction: f64,
    pub time_constant_s: f64,
}

impl JointThermal {
    /// Warmth x = 1 − exp(−t/τ) after `worked_s` (s) of the same cycle: the power over its own mean is 1 in the mean.
    #[inline]
    pub fn warmth(&self, worked_s: f64) -> f64 {
        1.0 - (-worked_s.max(0.0) / self.time_constant_s).exp()
    }

    /// Scale of dry and viscous friction [-].
    #[inline]
    pub fn scale(&self, worked_s: f64) -> f64 {
        1.0 - self.drop_fraction * self.warmth(worked_s)
    }
}

/// Spring and damper of one joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Elasticity {
    pub stiffness_nm_per_rad: f64,
    pub damping_nm_s_per_rad: f64,
}

/// Dry friction of one joint that turns round before the joint does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FrictionLead {
    pub joint: usize,
    pub amplitude_nm: f64,
    pub width_rad_s: f64,
    pub lead_s: f64,
}

impl FrictionLead {
    /// `A (clip((qd + ℓ qdd)/w) − s)` (Nm), `s = tanh(qd/smoothing)`, at qd [rad/s] and qdd [rad/s²] of the joint.
    pub fn torque_nm(&self, qd: f64, qdd: f64, smoothing_rad_s: f64) -> f64 {
        self.amplitude_nm * (leading_sign(qd, qdd, self.width_rad_s, self.lead_s) - smooth_sign(qd, smoothing_rad_s))
    }
}

/// A push on the flange during a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Contact {
    /// Robot on environment, base axes.
    pub wrench: Wrench,
    pub start_s: f64,
    pub end_s: f64,
}

impl Contact {
    /// The wrench at `time_s` (s), with edges of `edge_s` (s) inside the window, quintic in shape.
    #[inline]
    pub fn at(&self, time_s: f64, edge_s: f64) -> Wrench {
        let inside_s = (time_s - self.start_s).min(self.end_s - time_s);
        let weight = if inside_s < 0.0 {
            0.0
        } else if inside_s < edge_s {
            let u = inside_s / edge_s;
            u * u * u * (10.0 - 15.0 * u + 6.0 * u * u)
        } else {
            1.0
        };
        Wrench { moment_nm: self.wrench.moment_nm * weight, force_n: self.wrench.force_n * weight }
    }
}

/// Everything hidden, ready to be evaluated.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Hidden<const N: usize> {
    /// The arm with payload, link inertia, rotor inertia and tilt.
    pub arm: Arm<N>,
    /// Torques that add to the friction law.
    pub joints: [JointEffects; N],
    /// Dry friction that turns round early. It asks for the acceleration: along a given motion it is known, a plant that is pushed by torques
    /// leaves it out.
    pub leads: Vec<FrictionLead>,
    /// Own warmth of the joints.
    pub thermal: [Option<JointThermal>; N],
    /// Springs between motor and link.
    pub elasticity: [Option<Elasticity>; N],
    /// Half gaps between motor and link (rad).
    pub half_gap_rad: [f64; N],
    /// Measured over true torque [-].
    pub gain: SVector<f64, N>,
    /// Lateness of the torque signal (s).
    pub delay_s: f64,
    /// Pushes.
    pub contacts: Vec<Contact>,
}

impl<const N: usize> Hidden<N> {
    /// Sorts the effects. Those naming a joint or link that the arm lacks are left out: see [`Truth::validate`].
    #[inline(never)]
    pub fn of(truth: &Truth<N>) -> Self {
        let mut hidden = Self {
            arm: truth.arm.clone(),
            joints: [JointEffects::default(); N],
            leads: Vec::new(),
            thermal: [None; N],
            elasticity: [None; N],
            half_gap_rad: [0.0; N],
            gain: SVector::repeat(1.0),
            delay_s: 0.0,
            contacts: Vec::new(),
        };
        let known = |effect: &&Effect| match effect {
            Effect::LinkInertial { link, .. } => *link < N,
            _ => effect.joint().is_none_or(|joint| joint < N),
        };
        truth.effects.iter().filter(known).for_each(|effect| hidden.add(effect));
        hidden
    }

    fn add(&mut self, effect: &Effect) {
        match *effect {
            Effect::Coulomb { joint, delta_coulomb_nm } => self.joints[joint].coulomb_nm += delta_coulomb_nm,
            Effect::Viscous { joint, delta_viscous_nm_s_per_rad } => {
                self.joints[joint].viscous_nm_s_per_rad += delta_viscous_nm_s_per_rad;
            }
            Effect::Stribeck { joint, breakaway_minus_coulomb_nm, stribeck_velocity_rad_s } => {
                self.joints[joint].breakaway_minus_coulomb_nm = breakaway_minus_coulomb_nm;
                self.joints[joint].stribeck_velocity_rad_s = stribeck_velocity_rad_s;
            }
            Effect::FrictionCurve { joint, amplitude_nm, width_rad_s } => {
                let free = self.joints[joint].curves.iter_mut().find(|curve| curve.amplitude_nm == 0.0);
                if let Some(curve) = free {
                    *curve = Curve { amplitude_nm, width_rad_s };
                }
            }
            Effect::FrictionLead { joint, amplitude_nm, width_rad_s, lead_s } => {
                self.leads.push(FrictionLead { joint, amplitude_nm, width_rad_s, lead_s });
            }
            Effect::CoulombAsymmetry { joint, asymmetry_nm } => self.joints[joint].asymmetry_nm += asymmetry_nm,
            Effect::TorqueOffset { joint, offset_nm } => self.joints[joint].offset_nm += offset_nm,
            Effect::TorqueGain { joint, gain_error } => self.gain[joint] *= 1.0 + gain_error,
            Effect::ThermalFriction { joint, drop_fraction, time_constant_s } => {
                self.thermal[joint] = Some(JointThermal { drop_fraction, time_constant_s });
            }
            Effect::LoadFriction { joint, load_coefficient } => self.joints[joint].load_coefficient += load_coefficient,
            Effect::Payload { mass_kg, com_m, inertia_kg_m2 } => {
                let (com_m, inertia_kg_m2) = (Vector3::from(com_m), symmetric(&inertia_kg_m2));
                self.arm = self.arm.clone().with_payload(&Payload { mass_kg, com_m, inertia_kg_m2 });
            }
            Effect::BaseTilt { angle_rad, axis } => {
                let turn = Vector3::from(axis).try_normalize(0.0).unwrap_or_default() * angle_rad;
                self.arm.gravity_m_s2 = so3::exp(&turn).transpose() * self.arm.gravity_m_s2;
            }
            Effect::LinkInertial { link, delta_mass_kg, delta_first_moment_kg_m, delta_inertia_kg_m2 } => {
                let moment = Vector3::from(delta_first_moment_kg_m);
                self.arm = self.arm.clone().altered(|arm| {
                    arm.links[link] = altered(&arm.links[link], delta_mass_kg, moment, &delta_inertia_kg_m2);
                });
            }
            Effect::RotorInertia { joint, delta_rotor_inertia_kg_m2 } => {
                self.arm.rotor_inertia_kg_m2[joint] += delta_rotor_inertia_kg_m2;
            }
            Effect::TorqueRipple { joint, cycles_per_rev, amplitude_nm, phase_rad } => {
                let free = self.joints[joint].ripples.iter_mut().find(|ripple| ripple.amplitude_nm == 0.0);
                if let Some(ripple) = free {
                    *ripple = Ripple { cycles_per_rev, amplitude_nm, phase_rad };
                }
            }
            Effect::Presliding { joint, presliding_distance_rad, amplitude_nm: Some(amplitude_nm) } => {
                let free = self.joints[joint].bristles.iter_mut().find(|part| part.amplitude_nm == 0.0);
                if let Some(part) = free {
                    *part = BristlePart { amplitude_nm, distance_rad: presliding_distance_rad };
                }
            }
            Effect::Presliding { joint, presliding_distance_rad, amplitude_nm: None } => {
                self.joints[joint].presliding_distance_rad = presliding_distance_rad;
            }
            Effect::JointElasticity { joint, stiffness_nm_per_rad, damping_nm_s_per_rad } => {
                self.elasticity[joint] = Some(Elasticity { stiffness_nm_per_rad, damping_nm_s_per_rad });
            }
            Effect::Backlash { joint, half_gap_rad } => self.half_gap_rad[joint] = half_gap_rad,
            Effect::TimeDelay { delay_s } => self.delay_s += delay_s,
            Effect::ExternalContact { force_n, moment_nm, start_s, end_s } => {
                let on_robot = Wrench { moment_nm: Vector3::from(moment_nm), force_n: Vector3::from(force_n) };
                self.contacts.push(Contact { wrench: on_robot.reaction(), start_s, end_s });
            }
            Effect::PositionSpring { joint, stiffness_nm_per_rad, rest_rad } => {
                self.joints[joint].spring_nm_per_rad = stiffness_nm_per_rad;
                self.joints[joint].spring_rest_rad = rest_rad;
            }
        }
    }

    /// Wrench of all contacts by the robot on the environment at `time_s` (s).
    #[inline]
    pub fn contact_at(&self, time_s: f64, edge_s: f64) -> Wrench {
        let mut total = Wrench::default();
        for contact in &self.contacts {
            let wrench = contact.at(time_s, edge_s);
            total.force_n += wrench.force_n;
            total.moment_nm += wrench.moment_nm;
        }
        total
    }
}

impl<const N: usize> Truth<N> {
    /// Checks every effect, that they fit together, and that every link keeps a positive mass.
    ///
    /// # Errors
    /// The first [`EffectError`] in the order of the list.
    pub fn validate(&self) -> Result<(), EffectError> {
        validate_together(&self.effects, N)?;
        let arm = Hidden::of(self).arm;
        let massless = arm.links.iter().position(|link| link.mass_kg <= 0.0);
        match massless.filter(|_| self.effects.iter().any(|e| matches!(e, Effect::LinkInertial { .. }))) {
            Some(link) => Err(EffectError::MasslessLink { link, mass_kg: arm.links[link].mass_kg }),
            None => Ok(()),
        }
    }

    /// The arm as it truly is: with the payload, link inertia, rotor inertia and tilt among the effects.
    pub fn true_arm(&self) -> Arm<N> {
        Hidden::of(self).arm
    }
}

/// The link with more mass (kg), first moment [kg m] and inertia about its origin [kg m²]:
/// `c = (m c + d)/m`, `I_c = I_o + m [c]×[c]×`. Unchanged if no mass is left.
fn altered(link: &LinkInertia, mass_kg: f64, first_moment: Vector3<f64>, inertia: &[f64; 6]) -> LinkInertia {
    let mass_kg = link.mass_kg + mass_kg;
    if mass_kg == 0.0 {
        return LinkInertia { mass_kg, ..*link };
    }
    let com_m = (link.com_m * link.mass_kg + first_moment) / mass_kg;
    let c = com_m.cross_matrix();
    LinkInertia { mass_kg, com_m, inertia_kg_m2: link.inertia_about_origin() + symmetric(inertia) + c * c * mass_kg }
}

/// Coulomb friction of a law at speed (Nm): the part that a bristle takes over. The Gaz sigmoid has none.
pub(crate) fn coulomb_nm(law: &JointFriction) -> f64 {
    match law {
        JointFriction::CoulombViscous(law) => law.coulomb_nm,
        JointFriction::Stribeck(law) => law.coulomb_nm,
        JointFriction::GazSigmoid(_) => 0.0,
        JointFriction::Asymmetric(law) => 0.5 * (law.coulomb_positive_nm + law.coulomb_negative_nm),
        JointFriction::Lugre(law) => law.coulomb_nm,
    }
}

/// Presliding distance of a joint (rad): of the effect, else of a LuGre law; 0 is none.
pub(crate) fn presliding_rad(law: &JointFriction, effects: &JointEffects) -> f64 {
    match law {
        JointFriction::Lugre(law) if effects.presliding_distance_rad == 0.0 => law.presliding_distance_rad,
        _ => effects.presliding_distance_rad,
    }
}

/// Deflections z of one joint's bristles over their largest [-].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct JointBristles {
    /// Of the whole Coulomb friction; `None` where that is the sign itself.
    pub whole: Option<f64>,
    /// Of its parts, in the order of [`JointEffects::bristles`]; 0 where there is none.
    pub parts: [f64; MAX_BRISTLES],
}

/// Friction and further torques of one joint in prescribed motion (Nm):
///
/// ```text
/// scale (law(q̇, s) + dFc s + dFv q̇ + Fc (z − s)) + Σ b (z_b − s) + the other effects(q, q̇, s, load),   s = tanh(q̇/smoothing)
/// ```
///
/// Fc is the whole Coulomb friction, dFc included; z is there if it has a bristle. `scale` is that of the warmth: it applies
/// to the law, dFc, dFv and Fc, and to nothing else: not to friction curves, not to the parts b.
pub(crate) fn joint_torque_nm(
    law: &JointFriction,
    effects: &JointEffects,
    [q, qd]: [f64; 2],
    bristles: &JointBristles,
    scale: f64,
    load_nm: f64,
    smoothing_rad_s: f64,
) -> f64 {
    let s = smooth_sign(qd, smoothing_rad_s);
    let mut friction = law.torque(qd, smoothing_rad_s);
    let mut added = effects.torque_nm(q, qd, s, load_nm);
    for (part, z) in effects.bristles.iter().zip(bristles.parts) {
        added += part.amplitude_nm * (z - s);
    }
    if let Some(z) = bristles.whole {
        friction += coulomb_nm(law) * (z - s);
        added += effects.coulomb_nm * (z - s);
    }
    if scale != 1.0 {
        let dry = bristles.whole.unwrap_or(s);
        added += (scale - 1.0) * (effects.coulomb_nm * dry + effects.viscous_nm_s_per_rad * qd);
        friction *= scale;
    }
    friction + added
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Matrix3;
    use tribo_robot::{gravity_torque, presets, rnea};

    /// Two descriptions of one body: a payload at the flange, and the same added to the last link by its ten parameters.
    #[test]
    fn a_payload_is_a_change_of_the_last_link() {
        let inertia = [2e-3, 1e-4, 0.0, 3e-3, -2e-4, 2.5e-3];
        let payload = Effect::Payload { mass_kg: 1.3, com_m: [0.02, -0.01, 0.07], inertia_kg_m2: inertia };
        let with_payload = Truth { effects: vec![payload], ..Truth::panda_coulomb_viscous() }.true_arm();

        let arm = presets::panda();
        let body = LinkInertia {
            mass_kg: 1.3,
            com_m: arm.link_from_flange_rotation * Vector3::new(0.02, -0.01, 0.07) + arm.link_from_flange_translation,
            inertia_kg_m2: arm.link_from_flange_rotation
                * symmetric(&inertia)
                * arm.link_from_flange_rotation.transpose(),
        };
        let p = body.parameters();
        let link = Effect::LinkInertial {
            link: 6,
            delta_mass_kg: p[0],
            delta_first_moment_kg_m: [p[1], p[2], p[3]],
            delta_inertia_kg_m2: [p[4], p[5], p[6], p[7], p[8], p[9]],
        };
        let with_link = Truth { effects: vec![link], ..Truth::panda_coulomb_viscous() }.true_arm();
        let (q, qd) = (presets::panda_ready_pose(), SVector::<f64, 7>::from_fn(|j, _| 0.3 - 0.1 * j as f64));
        let qdd = SVector::<f64, 7>::from_fn(|j, _| (j as f64).cos());
        assert!((rnea(&with_payload, &q, &qd, &qdd) - rnea(&with_link, &q, &qd, &qdd)).amax() < 1e-12);
    }

    /// A base turned about x by a: the arm on the slope feels gravity (0, −g sin a, −g cos a) in its base axes.
    #[test]
    fn tilt_turns_gravity_the_other_way() {
        let tilt = Effect::BaseTilt { angle_rad: 0.2, axis: [2.0, 0.0, 0.0] };
        let arm = Truth { effects: vec![tilt], ..Truth::panda_frictionless() }.true_arm();
        let expected = Vector3::new(0.0, -9.81 * 0.2_f64.sin(), -9.81 * 0.2_f64.cos());
        assert!((arm.gravity_m_s2 - expected).amax() < 1e-12);
        // A vertical first axis carries no gravity torque; a tilted one does.
        assert!(gravity_torque(&arm, &presets::panda_ready_pose())[0].abs() > 0.1);
    }

    #[test]
    fn a_link_cannot_lose_more_than_it_has() {
        let effect = |delta_mass_kg| Effect::LinkInertial {
            link: 1,
            delta_mass_kg,
            delta_first_moment_kg_m: [0.0; 3],
            delta_inertia_kg_m2: [0.0; 6],
        };
        let truth = |mass| Truth { effects: vec![effect(mass)], ..Truth::panda_frictionless() };
        assert!(truth(-0.3).validate().is_ok());
        assert_eq!(truth(-1.0).validate().unwrap_err(), EffectError::MasslessLink { link: 1, mass_kg: 0.646926 - 1.0 });
    }

    #[test]
    fn altering_by_nothing_changes_nothing() {
        let link = presets::panda().links[2];
        let same = altered(&link, 0.0, Vector3::zeros(), &[0.0; 6]);
        assert!((same.inertia_kg_m2 - link.inertia_kg_m2).amax() < 1e-15);
        assert!((same.com_m - link.com_m).amax() < 1e-15);
        assert_eq!(
            symmetric(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]),
            Matrix3::new(1.0, 2.0, 3.0, 2.0, 4.0, 5.0, 3.0, 5.0, 6.0)
        );
    }
}
