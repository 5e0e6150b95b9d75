//! What a controller makes of a model that it believes in.

use tribo_friction::{BristlePart, Curve, FrictionModel, JointEffects, Ripple};
use tribo_robot::presets::joint_stiffness_nm_per_rad;
use tribo_robot::{Arm, JointNames};
use tribo_sim::{Effect, Truth};

use crate::Model;

/// A model split into what each part of a controller can use of it:
///
/// ```text
/// payload base_tilt link_inertial rotor_inertia                                          → arm
/// coulomb viscous stribeck coulomb_asymmetry torque_offset load_friction
/// torque_ripple position_spring presliding friction_curve                                → effects of the compensator
/// torque_gain thermal_friction joint_elasticity backlash time_delay external_contact
/// friction_lead                                                                          → not cancelled, with the reason
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ControllerModel<const N: usize> {
    /// The arm with all rigid-body effects.
    pub arm: Arm<N>,
    /// The friction law.
    pub friction: FrictionModel<N>,
    /// Torques beyond the law, joint by joint.
    pub effects: [JointEffects; N],
    /// What is left.
    pub not_cancelled: Vec<NotCancelled>,
}

/// An effect that is believed in and yet not cancelled.
#[derive(Clone, Debug, PartialEq)]
pub struct NotCancelled {
    /// The effect.
    pub effect: Effect,
    /// Why, as one sentence without a full stop.
    pub why: &'static str,
}

impl<const N: usize> ControllerModel<N> {
    /// For a controller, which drives motors: a link-side model gets the robot's rotor inertia.
    pub fn by_controller(model: &Model<N>) -> Self {
        Self::of(model.to_truth())
    }

    /// For reading a log: the arm stays on the model's side of the gears.
    pub fn on_log(model: &Model<N>) -> Self {
        Self::of(Truth { arm: model.arm.clone(), ..model.to_truth() })
    }

    /// Stiffness of the gears (Nm/rad): of the model's `joint_elasticity` where it has one, else what is assumed of the arm.
    pub fn joint_stiffness_nm_per_rad(&self) -> [f64; N] {
        let mut stiffness = joint_stiffness_nm_per_rad(&self.arm);
        for left in &self.not_cancelled {
            if let Effect::JointElasticity { joint, stiffness_nm_per_rad, .. } = left.effect
                && let Some(of_joint) = stiffness.get_mut(joint)
            {
                *of_joint = stiffness_nm_per_rad;
            }
        }
        stiffness
    }

    /// All there is to know of a truth; cold, where it warms up.
    pub fn of(truth: Truth<N>) -> Self {
        let (effects, not_cancelled) = joint_effects(&truth.effects);
        Self { arm: truth.true_arm(), friction: truth.friction, effects, not_cancelled }
    }
}

impl NotCancelled {
    /// `backlash of panda_joint3 (2) is not cancelled: …`.
    pub fn sentence(&self, names: &JointNames) -> String {
        let cause = self.effect.cause();
        match self.effect.joint() {
            Some(joint) => format!("{cause} of {} is not cancelled: {}", names.of(joint), self.why),
            None => format!("{cause} is not cancelled: {}", self.why),
        }
    }
}

/// What is not cancelled, one sentence per cause and reason: `torque_gain of joints 0, 1 and 2 is not cancelled: …`.
pub fn not_cancelled_sentences(left: &[NotCancelled], names: &JointNames) -> Vec<String> {
    let mut groups: Vec<(&NotCancelled, Vec<usize>)> = Vec::new();
    for one in left {
        let same = |other: &NotCancelled| other.effect.cause() == one.effect.cause() && other.why == one.why;
        match groups.iter_mut().find(|(other, joints)| same(other) && !joints.is_empty()) {
            Some((_, joints)) => joints.extend(one.effect.joint()),
            None => groups.push((one, one.effect.joint().into_iter().collect())),
        }
    }
    groups
        .into_iter()
        .map(|(one, joints)| match &joints[..] {
            [] | [_] => one.sentence(names),
            _ => format!("{} of {} is not cancelled: {}", one.effect.cause(), names.several(&joints), one.why),
        })
        .collect()
}

/// The torques of every joint that a compensator can add, and the effects that are no such torques.
#[inline(never)]
pub fn joint_effects<const N: usize>(effects: &[Effect]) -> ([JointEffects; N], Vec<NotCancelled>) {
    let mut joints = [JointEffects::default(); N];
    let mut not_cancelled = Vec::new();
    for effect in effects {
        if let Err(why) = add_to(&mut joints, effect) {
            not_cancelled.push(NotCancelled { effect: effect.clone(), why });
        }
    }
    (joints, not_cancelled)
}

/// Adds one effect to its joint, or says why that cannot be.
fn add_to<const N: usize>(joints: &mut [JointEffects; N], effect: &Effect) -> Result<(), &'static str> {
    let joint = match effect.joint() {
        Some(joint) => joints.get_mut(joint).ok_or("the arm has no such joint")?,
        None => &mut JointEffects::default(),
    };
    match *effect {
        Effect::Coulomb { delta_coulomb_nm, .. } => joint.coulomb_nm += delta_coulomb_nm,
        Effect::Viscous { delta_viscous_nm_s_per_rad, .. } => {
            joint.viscous_nm_s_per_rad += delta_viscous_nm_s_per_rad;
        }
        Effect::Stribeck { breakaway_minus_coulomb_nm, stribeck_velocity_rad_s, .. } => {
            joint.breakaway_minus_coulomb_nm = breakaway_minus_coulomb_nm;
            joint.stribeck_velocity_rad_s = stribeck_velocity_rad_s;
        }
        Effect::FrictionCurve { amplitude_nm, width_rad_s, .. } => {
            let slot = joint.curves.iter_mut().find(|curve| curve.amplitude_nm == 0.0);
            *slot.ok_or("the compensator keeps only the first curves of a joint")? =
                Curve { amplitude_nm, width_rad_s };
        }
        Effect::CoulombAsymmetry { asymmetry_nm, .. } => joint.asymmetry_nm += asymmetry_nm,
        Effect::TorqueOffset { offset_nm, .. } => joint.offset_nm += offset_nm,
        Effect::LoadFriction { load_coefficient, .. } => joint.load_coefficient += load_coefficient,
        Effect::TorqueRipple { cycles_per_rev, amplitude_nm, phase_rad, .. } => {
            let slot = joint.ripples.iter_mut().find(|ripple| ripple.amplitude_nm == 0.0);
            *slot.ok_or("the compensator keeps only the first ripples of a joint")? =
                Ripple { cycles_per_rev, amplitude_nm, phase_rad };
        }
        Effect::PositionSpring { stiffness_nm_per_rad, rest_rad, .. } => {
            (joint.spring_nm_per_rad, joint.spring_rest_rad) = (stiffness_nm_per_rad, rest_rad);
        }
        Effect::Presliding { presliding_distance_rad, amplitude_nm: Some(amplitude_nm), .. } => {
            let slot = joint.bristles.iter_mut().find(|part| part.amplitude_nm == 0.0);
            *slot.ok_or("the compensator keeps only the first bristles of a joint")? =
                BristlePart { amplitude_nm, distance_rad: presliding_distance_rad };
        }
        Effect::Presliding { presliding_distance_rad, amplitude_nm: None, .. } => {
            joint.presliding_distance_rad = presliding_distance_rad;
        }
        // In the arm.
        Effect::Payload { .. }
        | Effect::BaseTilt { .. }
        | Effect::LinkInertial { .. }
        | Effect::RotorInertia { .. } => {}
        Effect::FrictionLead { .. } => {
            return Err("it needs the acceleration; dry friction is cancelled as if it turned round with the velocity");
        }
        Effect::TorqueGain { .. } => return Err("it scales every torque, and a compensator only adds"),
        Effect::ThermalFriction { .. } => {
            return Err("the compensator knows no temperature and believes the cold friction");
        }
        Effect::JointElasticity { .. } => {
            return Err("the torque of a rigid-joint controller acts on the motor, not on the link behind the spring");
        }
        Effect::Backlash { .. } => {
            return Err("inside the gap no motor torque reaches the link, and the side of the gap is not measured");
        }
        Effect::TimeDelay { .. } => return Err("torque that arrives late cannot be sent before it is known"),
        Effect::ExternalContact { .. } => {
            return Err("it belongs to the occasion on which it was seen, not to the robot");
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use tribo_robot::presets;
    use tribo_sim::TorqueSide;

    /// One of each cause, all on joint 3.
    fn one_of_each() -> Vec<Effect> {
        let joint = 3;
        vec![
            Effect::Coulomb { joint, delta_coulomb_nm: 0.1 },
            Effect::Viscous { joint, delta_viscous_nm_s_per_rad: 0.2 },
            Effect::Stribeck { joint, breakaway_minus_coulomb_nm: 0.3, stribeck_velocity_rad_s: 0.05 },
            Effect::CoulombAsymmetry { joint, asymmetry_nm: 0.04 },
            Effect::TorqueOffset { joint, offset_nm: -0.5 },
            Effect::LoadFriction { joint, load_coefficient: 0.06 },
            Effect::TorqueRipple { joint, cycles_per_rev: 7.0, amplitude_nm: 0.08, phase_rad: 0.9 },
            Effect::PositionSpring { joint, stiffness_nm_per_rad: 1.1, rest_rad: -1.2 },
            Effect::Presliding { joint, presliding_distance_rad: 1e-3, amplitude_nm: None },
            Effect::Presliding { joint, presliding_distance_rad: 2e-2, amplitude_nm: Some(-0.07) },
            Effect::FrictionCurve { joint, amplitude_nm: 0.09, width_rad_s: 0.4 },
            Effect::Payload { mass_kg: 1.0, com_m: [0.0, 0.0, 0.05], inertia_kg_m2: [0.0; 6] },
            Effect::BaseTilt { angle_rad: 0.1, axis: [1.0, 0.0, 0.0] },
            Effect::LinkInertial {
                link: joint,
                delta_mass_kg: 0.5,
                delta_first_moment_kg_m: [0.0; 3],
                delta_inertia_kg_m2: [0.0; 6],
            },
            Effect::RotorInertia { joint, delta_rotor_inertia_kg_m2: 0.2 },
            Effect::TorqueGain { joint, gain_error: 0.1 },
            Effect::ThermalFriction { joint, drop_fraction: 0.2, time_constant_s: 600.0 },
            Effect::JointElasticity { joint, stiffness_nm_per_rad: 1e4, damping_nm_s_per_rad: 10.0 },
            Effect::Backlash { joint, half_gap_rad: 1e-3 },
            Effect::TimeDelay { delay_s: 2e-3 },
            Effect::ExternalContact { force_n: [1.0; 3], moment_nm: [0.0; 3], start_s: 1.0, end_s: 2.0 },
        ]
    }

    /// Every cause ends in exactly one of the three places.
    #[test]
    fn each_cause_has_its_place() {
        let bare = ControllerModel::by_controller(&Model::panda(TorqueSide::Motor));
        let mut places = [Vec::new(), Vec::new(), Vec::new()];
        for effect in one_of_each() {
            let model = Model { effects: vec![effect.clone()], ..Model::panda(TorqueSide::Motor) };
            let controller_model = ControllerModel::by_controller(&model);
            let at = [
                controller_model.arm != bare.arm,
                controller_model.effects != bare.effects,
                !controller_model.not_cancelled.is_empty(),
            ];
            assert_eq!(at.iter().filter(|&&here| here).count(), 1, "{effect:?}: {at:?}");
            for (place, here) in places.iter_mut().zip(at) {
                place.extend(here.then(|| effect.cause()));
            }
            for left in &controller_model.not_cancelled {
                let said = left.sentence(&JointNames::default());
                assert!(said.starts_with(effect.cause()) && said.contains(": "), "{said}");
            }
        }
        let [arm, joints, left] = places;
        assert_eq!(arm, ["payload", "base_tilt", "link_inertial", "rotor_inertia"]);
        assert_eq!(joints.len(), 11);
        let expected =
            ["torque_gain", "thermal_friction", "joint_elasticity", "backlash", "time_delay", "external_contact"];
        assert_eq!(left, expected);
    }

    #[test]
    fn one_reason_is_one_sentence() {
        let gain = |joint| Effect::TorqueGain { joint, gain_error: 0.1 };
        let (_, left) = joint_effects::<7>(&[gain(0), gain(3), Effect::TimeDelay { delay_s: 1e-3 }, gain(5)]);
        let sentences = not_cancelled_sentences(&left, &JointNames::default());
        assert_eq!(sentences.len(), 2);
        assert!(sentences[0].starts_with("torque_gain of joints 0, 3 and 5 is not cancelled: "), "{}", sentences[0]);
    }

    #[test]
    fn parameters_keep_joint_and_value() {
        let (joints, left) = joint_effects::<7>(&one_of_each());
        assert_eq!(left.len(), 6);
        let (it, none) = (joints[3], JointEffects::default());
        assert!((0..7).filter(|&j| j != 3).all(|j| joints[j] == none));
        let got = [it.coulomb_nm, it.viscous_nm_s_per_rad, it.breakaway_minus_coulomb_nm, it.stribeck_velocity_rad_s];
        assert_eq!(got, [0.1, 0.2, 0.3, 0.05]);
        assert_eq!([it.asymmetry_nm, it.offset_nm, it.load_coefficient], [0.04, -0.5, 0.06]);
        assert_eq!(it.ripples[0], Ripple { cycles_per_rev: 7.0, amplitude_nm: 0.08, phase_rad: 0.9 });
        assert_eq!([it.spring_nm_per_rad, it.spring_rest_rad, it.presliding_distance_rad], [1.1, -1.2, 1e-3]);
        assert_eq!(it.bristles[0], BristlePart { amplitude_nm: -0.07, distance_rad: 2e-2 });
        assert_eq!(it.curves[0], Curve { amplitude_nm: 0.09, width_rad_s: 0.4 });
        assert_eq!((it.bristles[1], it.curves[1]), (BristlePart::default(), Curve::default()));
    }

    /// What a joint has no place for is said, and what it has keeps its order.
    #[test]
    fn a_joint_keeps_three_curves_and_three_bristles() {
        let curve = |k: u32| Effect::FrictionCurve { joint: 2, amplitude_nm: f64::from(k), width_rad_s: 0.1 };
        let part =
            |k: u32| Effect::Presliding { joint: 2, presliding_distance_rad: 1e-3, amplitude_nm: Some(f64::from(k)) };
        let effects: Vec<Effect> = (1..=4).flat_map(|k| [curve(k), part(k)]).collect();
        let (joints, left) = joint_effects::<7>(&effects);
        assert_eq!(joints[2].curves.map(|curve| curve.amplitude_nm), [1.0, 2.0, 3.0]);
        assert_eq!(joints[2].bristles.map(|part| part.amplitude_nm), [1.0, 2.0, 3.0]);
        let seen: Vec<Effect> = left.iter().map(|left| left.effect.clone()).collect();
        assert_eq!(seen, [curve(4), part(4)]);
    }

    #[test]
    fn a_link_side_model_drives_motors_and_reads_links() {
        let model = Model {
            effects: vec![Effect::RotorInertia { joint: 2, delta_rotor_inertia_kg_m2: 0.1 }],
            ..Model::panda(TorqueSide::Link)
        };
        let preset = presets::panda().rotor_inertia_kg_m2;
        assert_eq!(ControllerModel::by_controller(&model).arm.rotor_inertia_kg_m2[2], preset[2] + 0.1);
        assert_eq!(ControllerModel::by_controller(&model).arm.rotor_inertia_kg_m2[0], preset[0]);
        assert_eq!(ControllerModel::on_log(&model).arm.rotor_inertia_kg_m2[2], 0.1);
        assert_eq!(ControllerModel::on_log(&model).arm.rotor_inertia_kg_m2[0], 0.0);
    }

    /// Springs that the model names are those of the two encoders; the others are what is assumed of the arm.
    #[test]
    fn the_gears_are_as_stiff_as_the_model_says() {
        let spring = Effect::JointElasticity { joint: 2, stiffness_nm_per_rad: 4321.0, damping_nm_s_per_rad: 1.0 };
        let plain = ControllerModel::of(Truth::panda_coulomb_viscous()).joint_stiffness_nm_per_rad();
        let known = ControllerModel::of(Truth { effects: vec![spring], ..Truth::panda_coulomb_viscous() });
        let stiffness = known.joint_stiffness_nm_per_rad();
        assert_eq!((stiffness[2], &stiffness[3..]), (4321.0, &plain[3..]));
        assert!(plain[2] != 4321.0);
    }
}
