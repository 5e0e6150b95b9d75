//! A hidden cause whose size is still open.

use std::f64::consts::TAU;

use tribo_regression::{CauseLabel, Nominal};
use tribo_sim::Effect;

use super::chance::Chance;
use super::world::World;

/// A cause with everything drawn but its size.
#[derive(Clone, Debug)]
pub(super) struct DrawnEffect {
    /// The effect at size 1.
    unit: Effect,
    /// Physically plausible sizes.
    pub sizes: [f64; 2],
    /// Whether the torque grows with the size in proportion.
    pub proportional: bool,
    /// Whether a second encoder, not the torque, shows it.
    pub seen_by_encoders: bool,
    /// Joint whose friction has the size as a factor, in place of the effect.
    pub carried_by_friction_of: Option<usize>,
}

impl DrawnEffect {
    /// Draws joint and shape; joints in `taken` are left to others.
    pub fn draw(
        label: CauseLabel,
        nominal: &Nominal<7>,
        world: World,
        taken: &[usize],
        shortest_s: f64,
        dual_encoder: bool,
        chance: &mut Chance,
    ) -> Option<Self> {
        let all: &[usize] = match label {
            CauseLabel::LoadFriction => &[1, 2, 3, 5],
            CauseLabel::TorqueGain => &[1, 2, 3, 5],
            CauseLabel::JointElasticity if !dual_encoder => &[1, 3],
            // Joints whose load bends the spring by more than an encoder's noise.
            CauseLabel::JointElasticity => &[1, 2, 3, 4, 5],
            // Where gravity never lets go, a gap is a constant offset of the encoders.
            CauseLabel::Backlash => &[0, 2, 4, 5],
            _ => &[0, 1, 2, 3, 4, 5, 6],
        };
        let joints: Vec<usize> = all.iter().copied().filter(|j| !taken.contains(j)).collect();
        if joints.is_empty() {
            return None;
        }
        let joint = chance.pick(&joints);
        let (coulomb, viscous) = (nominal.dry_nm(joint), nominal.viscous_nm_s(joint));
        let side = match (world, label) {
            // Under friction of another shape a law cannot give away what it does not have.
            (World::WrongEverywhere, CauseLabel::Coulomb) => 1.0,
            _ => chance.side(),
        };
        // A cause that takes friction away leaves a fifth of it.
        let removable = |of: f64| if side < 0.0 { 0.8 * of } else { 3.0 };
        let (mut proportional, mut seen_by_encoders, mut carried_by_friction_of) = (true, false, None);
        let (unit, sizes) = match label {
            CauseLabel::Coulomb => (Effect::Coulomb { joint, delta_coulomb_nm: side }, [0.0, removable(coulomb)]),
            CauseLabel::Viscous => {
                (Effect::Viscous { joint, delta_viscous_nm_s_per_rad: side }, [0.0, removable(viscous)])
            }
            CauseLabel::Stribeck => {
                let stribeck_velocity_rad_s = chance.log_between(0.015, 0.15);
                (Effect::Stribeck { joint, breakaway_minus_coulomb_nm: 1.0, stribeck_velocity_rad_s }, [0.0, 2.0])
            }
            CauseLabel::CoulombAsymmetry => (Effect::CoulombAsymmetry { joint, asymmetry_nm: side }, [0.0, 1.0]),
            CauseLabel::TorqueOffset => (Effect::TorqueOffset { joint, offset_nm: side }, [0.0, 3.0]),
            CauseLabel::TorqueGain => (Effect::TorqueGain { joint, gain_error: side }, [0.0, 0.3]),
            CauseLabel::ThermalFriction => {
                let time_constant_s = chance.log_between(180.0, 3600.0);
                (Effect::ThermalFriction { joint, drop_fraction: 1.0, time_constant_s }, [0.05, 0.5])
            }
            CauseLabel::LoadFriction => (Effect::LoadFriction { joint, load_coefficient: 1.0 }, [0.0, 0.2]),
            CauseLabel::Payload => {
                let com_m = [chance.between(-0.05, 0.05), chance.between(-0.05, 0.05), chance.between(0.01, 0.15)];
                let inertia = chance.between(1e-4, 3e-3);
                let inertia_kg_m2 = [inertia, 0.0, 0.0, inertia, 0.0, inertia];
                (Effect::Payload { mass_kg: 1.0, com_m, inertia_kg_m2 }, [0.0, 3.0])
            }
            CauseLabel::BaseTilt => {
                let (s, c) = chance.between(0.0, TAU).sin_cos();
                (Effect::BaseTilt { angle_rad: 1.0, axis: [c, s, 0.0] }, [0.0, 0.15])
            }
            CauseLabel::LinkInertial => (link_inertial(chance), [0.0, 1.0]),
            CauseLabel::RotorInertia => {
                let most = if side < 0.0 { 0.8 * nominal.arm.rotor_inertia_kg_m2[joint] } else { 1.0 };
                (Effect::RotorInertia { joint, delta_rotor_inertia_kg_m2: side }, [0.0, most])
            }
            CauseLabel::TorqueRipple => {
                let known = chance.pick(&[100.0, 200.0, 400.0, 600.0, 160.0, 240.0]);
                let cycles_per_rev = if chance.happens(0.25) { chance.between(20.0, 99.0).round() } else { known };
                let phase_rad = chance.between(0.0, TAU);
                (Effect::TorqueRipple { joint, cycles_per_rev, amplitude_nm: 1.0, phase_rad }, [0.0, 2.0])
            }
            CauseLabel::Presliding => {
                let presliding_distance_rad = chance.log_between(3e-4, 1e-2);
                if world == World::WrongEverywhere {
                    let effect = Effect::Presliding { joint, presliding_distance_rad, amplitude_nm: Some(1.0) };
                    return Some(Self {
                        unit: effect,
                        sizes: [0.0, 2.0],
                        proportional,
                        seen_by_encoders,
                        carried_by_friction_of,
                    });
                }
                carried_by_friction_of = Some(joint);
                // Friction of 0.05 to 2 Nm.
                let effect = Effect::Presliding { joint, presliding_distance_rad, amplitude_nm: None };
                (effect, [0.05 / coulomb, 2.0 / coulomb])
            }
            CauseLabel::JointElasticity => {
                (proportional, seen_by_encoders) = (false, dual_encoder);
                let damping_nm_s_per_rad = chance.between(1.0, 20.0);
                (
                    Effect::JointElasticity { joint, stiffness_nm_per_rad: 1.0, damping_nm_s_per_rad },
                    [1.0 / 3e4, 1.0 / 2e3],
                )
            }
            CauseLabel::Backlash => {
                (proportional, seen_by_encoders) = (false, true);
                (Effect::Backlash { joint, half_gap_rad: 1.0 }, [1e-4, 2e-3])
            }
            CauseLabel::TimeDelay => {
                proportional = false;
                (Effect::TimeDelay { delay_s: 1.0 }, [1e-3, 1e-2])
            }
            CauseLabel::ExternalContact => {
                let length_s = chance.between(0.5, 4.0);
                let start_s = chance.between(2.0, shortest_s - length_s - 2.0);
                let (force, moment) = (chance.direction(), chance.direction().map(|m| m * chance.between(0.0, 0.3)));
                let end_s = start_s + length_s;
                (Effect::ExternalContact { force_n: force, moment_nm: moment, start_s, end_s }, [0.0, 60.0])
            }
            CauseLabel::PositionSpring => {
                let centre = tribo_robot::presets::panda_ready_pose()[joint];
                let rest_rad = centre + chance.between(-0.5, 0.5);
                (Effect::PositionSpring { joint, stiffness_nm_per_rad: 1.0, rest_rad }, [0.0, 20.0])
            }
            CauseLabel::FrictionCurve => {
                let width_rad_s = chance.log_between(0.05, 0.8);
                (Effect::FrictionCurve { joint, amplitude_nm: side, width_rad_s }, [0.0, 3.0])
            }
            CauseLabel::Unknown => return None,
        };
        Some(Self { unit, sizes, proportional, seen_by_encoders, carried_by_friction_of })
    }

    /// The effect at a size.
    pub fn sized(&self, size: f64) -> Effect {
        let mut effect = self.unit.clone();
        match &mut effect {
            Effect::Coulomb { delta_coulomb_nm: x, .. }
            | Effect::Viscous { delta_viscous_nm_s_per_rad: x, .. }
            | Effect::Stribeck { breakaway_minus_coulomb_nm: x, .. }
            | Effect::FrictionCurve { amplitude_nm: x, .. }
            | Effect::FrictionLead { amplitude_nm: x, .. }
            | Effect::CoulombAsymmetry { asymmetry_nm: x, .. }
            | Effect::TorqueOffset { offset_nm: x, .. }
            | Effect::TorqueGain { gain_error: x, .. }
            | Effect::ThermalFriction { drop_fraction: x, .. }
            | Effect::LoadFriction { load_coefficient: x, .. }
            | Effect::BaseTilt { angle_rad: x, .. }
            | Effect::RotorInertia { delta_rotor_inertia_kg_m2: x, .. }
            | Effect::TorqueRipple { amplitude_nm: x, .. }
            | Effect::Backlash { half_gap_rad: x, .. }
            | Effect::TimeDelay { delay_s: x }
            | Effect::PositionSpring { stiffness_nm_per_rad: x, .. } => *x *= size,
            // The size is that of the friction it carries.
            Effect::Presliding { amplitude_nm: None, .. } => {}
            Effect::Presliding { amplitude_nm: Some(x), .. } => *x *= size,
            // The size is the compliance.
            Effect::JointElasticity { stiffness_nm_per_rad, .. } => *stiffness_nm_per_rad /= size,
            Effect::Payload { mass_kg, inertia_kg_m2, .. } => {
                *mass_kg *= size;
                inertia_kg_m2.iter_mut().for_each(|x| *x *= size);
            }
            Effect::LinkInertial { delta_mass_kg, delta_first_moment_kg_m, delta_inertia_kg_m2, .. } => {
                *delta_mass_kg *= size;
                delta_first_moment_kg_m.iter_mut().chain(delta_inertia_kg_m2).for_each(|x| *x *= size);
            }
            Effect::ExternalContact { force_n, moment_nm, .. } => {
                force_n.iter_mut().chain(moment_nm).for_each(|x| *x *= size);
            }
        }
        effect
    }
}

/// A point mass on a link, off the axis of its joint: on the axis it could sit on the link before as well.
///
/// Links 1 to 6: about the vertical axis of link 0 a mass is rotor inertia.
fn link_inertial(chance: &mut Chance) -> Effect {
    let link = chance.pick(&[1, 2, 3, 4, 5, 6]);
    let (s, c) = chance.between(0.0, TAU).sin_cos();
    let radius = chance.between(0.05, 0.12);
    let [x, y, z] = [radius * c, radius * s, chance.between(-0.1, 0.1)];
    Effect::LinkInertial {
        link,
        delta_mass_kg: 1.0,
        delta_first_moment_kg_m: [x, y, z],
        delta_inertia_kg_m2: [y * y + z * z, -x * y, -x * z, x * x + z * z, -y * z, x * x + y * y],
    }
}
