//! The `effects` section of a model file: its check, and how findings join it.

use nalgebra::Cholesky;
use tribo_diagnose::Diagnosis;
use tribo_friction::{MAX_BRISTLES, MAX_CURVES, MAX_RIPPLES};
use tribo_robot::mass_matrix;
use tribo_sim::{Effect, EffectError};

use crate::{FieldError, FrictionSection, Model, ModelFile};

/// The most effects of a model; a diagnosis leaves some hundred at most, and each is checked on top of all before it.
const MOST_EFFECTS: usize = 256;

/// Checks that every effect, on top of those before it, leaves something that can be simulated.
pub(crate) fn validate_effects<const N: usize>(effects: &[Effect], model: &Model<N>) -> Result<(), FieldError> {
    if effects.len() > MOST_EFFECTS {
        let allowed = format!("at most {MOST_EFFECTS} entries");
        return Err(FieldError::new("effects", format!("{} entries", effects.len()), allowed));
    }
    let mut truth = model.to_truth();
    for (k, effect) in effects.iter().enumerate() {
        truth.effects.push(effect.clone());
        truth.validate().map_err(|error| field_error(k, effect, &error))?;
        let rigid = truth.true_arm();
        if rigid != truth.arm && Cholesky::new(mass_matrix(&rigid, &model.robot.poses_rad[0])).is_none() {
            let allowed = "values that leave the mass matrix positive definite";
            return Err(FieldError::new(format!("effects[{k}]"), effect.cause(), allowed));
        }
    }
    Ok(())
}

/// The field of the k-th effect that an error is about.
fn field_error(k: usize, effect: &Effect, error: &EffectError) -> FieldError {
    let field = |name: &str| format!("effects[{k}].{name}");
    match error {
        EffectError::OutOfRange { field: name, value, allowed, .. } => FieldError::new(field(name), value, *allowed),
        EffectError::NoSuchJoint { index, joints, .. } => {
            let name = if effect.joint().is_some() { "joint" } else { "link" };
            FieldError::new(field(name), index, format!("0 to {}", joints - 1))
        }
        EffectError::TooMany { cause, joint, most, .. } => {
            FieldError::new(field("joint"), joint, format!("at most {most} {cause} per joint"))
        }
        EffectError::MasslessLink { link, mass_kg } => {
            let allowed = format!("what leaves link {link} a mass, not {mass_kg} kg");
            let value = match effect {
                Effect::LinkInertial { delta_mass_kg, .. } => *delta_mass_kg,
                _ => *mass_kg,
            };
            FieldError::new(field("delta_mass_kg"), value, allowed)
        }
    }
}

impl ModelFile {
    /// The model with all that a diagnosis of it found: its effects, the width of its smooth sign where the log shows a sharper one, and whether its joints stick.
    pub fn diagnosed(&self, diagnosis: &Diagnosis) -> Self {
        let mut file = self.extended(&diagnosis.effects());
        let none = || FrictionSection::none(diagnosis.joints.len());
        if let Some(width) = diagnosis.smoothing_rad_s {
            file.friction.get_or_insert_with(none).smoothing_rad_s = width;
        }
        if diagnosis.sticks {
            file.friction.get_or_insert_with(none).sticks = true;
        }
        file
    }

    /// The same file with `findings` on top, as `diagnose --extend` writes it. Findings that are linear in their
    /// parameters add up with what the file has of the same cause in the same place:
    ///
    /// ```text
    /// coulomb viscous coulomb_asymmetry torque_offset load_friction rotor_inertia link_inertial time_delay   sum
    /// friction_curve of one width, friction_lead of one width and lead, presliding of one distance with an amplitude   sum
    /// torque_ripple of one order     sum of the phasors     torque_gain         product of 1 + g
    /// position_spring                sum, as one spring     thermal_friction    product of 1 − drop, mean time constant
    /// stribeck                       sum of the bumps, mean velocity
    /// presliding joint_elasticity backlash                  the finding takes the place of the old entry
    /// ```
    ///
    /// Means are weighted by size and not exact, but a joint has one such curve. All else (a second payload, say) becomes
    /// an entry of its own; of more ripples, curves or bristles than a joint can have the weakest goes.
    fn extended(&self, findings: &[Effect]) -> Self {
        let mut file = self.clone();
        for finding in findings {
            let merged = file.effects.iter().enumerate().find_map(|(k, old)| Some((k, merged(old, finding)?)));
            match merged {
                Some((k, effect)) => file.effects[k] = effect,
                None => file.effects.push(finding.clone()),
            }
            if let Some(weakest) = weakest_too_many(&file.effects, finding) {
                file.effects.remove(weakest);
            }
        }
        file
    }
}

/// Index of the weakest of the finding's kind on its joint, if there are more ripples, curves or bristles than a joint can
/// have.
fn weakest_too_many(effects: &[Effect], finding: &Effect) -> Option<usize> {
    let (_, most) = several(finding)?;
    let size = |effect: &Effect| {
        let same = effect.cause() == finding.cause() && effect.joint() == finding.joint();
        several(effect).filter(|_| same).map(|(amplitude_nm, _)| amplitude_nm.abs())
    };
    let sizes: Vec<(usize, f64)> = effects.iter().enumerate().filter_map(|(k, it)| Some((k, size(it)?))).collect();
    let weakest = sizes.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    (sizes.len() > most).then_some(weakest.0)
}

/// Amplitude (Nm) of an effect of which a joint can have several, and how many.
fn several(effect: &Effect) -> Option<(f64, usize)> {
    match *effect {
        Effect::TorqueRipple { amplitude_nm, .. } => Some((amplitude_nm, MAX_RIPPLES)),
        Effect::FrictionCurve { amplitude_nm, .. } => Some((amplitude_nm, MAX_CURVES)),
        Effect::Presliding { amplitude_nm: Some(amplitude_nm), .. } => Some((amplitude_nm, MAX_BRISTLES)),
        _ => None,
    }
}

/// Mean of x and y with weights |a| and |b|.
fn weighted(a: f64, x: f64, b: f64, y: f64) -> f64 {
    let (a, b) = (a.abs(), b.abs());
    if a + b > 0.0 { (a * x + b * y) / (a + b) } else { 0.5 * (x + y) }
}

/// One effect that does what both do, where there is one.
fn merged(old: &Effect, new: &Effect) -> Option<Effect> {
    use Effect as E;
    let place = |a: usize, b: usize| (a == b).then_some(a);
    Some(match (old.clone(), new.clone()) {
        (E::Coulomb { joint, delta_coulomb_nm: a }, E::Coulomb { joint: other, delta_coulomb_nm: b }) => {
            E::Coulomb { joint: place(joint, other)?, delta_coulomb_nm: a + b }
        }
        (
            E::Viscous { joint, delta_viscous_nm_s_per_rad: a },
            E::Viscous { joint: other, delta_viscous_nm_s_per_rad: b },
        ) => E::Viscous { joint: place(joint, other)?, delta_viscous_nm_s_per_rad: a + b },
        (
            E::Stribeck { joint, breakaway_minus_coulomb_nm: a, stribeck_velocity_rad_s: v },
            E::Stribeck { joint: other, breakaway_minus_coulomb_nm: b, stribeck_velocity_rad_s: w },
        ) => E::Stribeck {
            joint: place(joint, other)?,
            breakaway_minus_coulomb_nm: a + b,
            stribeck_velocity_rad_s: if v == w { v } else { weighted(a, v, b, w) },
        },
        (
            E::ThermalFriction { joint, drop_fraction: a, time_constant_s: v },
            E::ThermalFriction { joint: other, drop_fraction: b, time_constant_s: w },
        ) => E::ThermalFriction {
            joint: place(joint, other)?,
            drop_fraction: 1.0 - (1.0 - a) * (1.0 - b),
            time_constant_s: weighted(a, v, b, w),
        },
        (E::CoulombAsymmetry { joint, asymmetry_nm: a }, E::CoulombAsymmetry { joint: other, asymmetry_nm: b }) => {
            E::CoulombAsymmetry { joint: place(joint, other)?, asymmetry_nm: a + b }
        }
        (E::TorqueOffset { joint, offset_nm: a }, E::TorqueOffset { joint: other, offset_nm: b }) => {
            E::TorqueOffset { joint: place(joint, other)?, offset_nm: a + b }
        }
        (E::TorqueGain { joint, gain_error: a }, E::TorqueGain { joint: other, gain_error: b }) => {
            E::TorqueGain { joint: place(joint, other)?, gain_error: (1.0 + a) * (1.0 + b) - 1.0 }
        }
        (E::LoadFriction { joint, load_coefficient: a }, E::LoadFriction { joint: other, load_coefficient: b }) => {
            E::LoadFriction { joint: place(joint, other)?, load_coefficient: a + b }
        }
        (
            E::RotorInertia { joint, delta_rotor_inertia_kg_m2: a },
            E::RotorInertia { joint: other, delta_rotor_inertia_kg_m2: b },
        ) => E::RotorInertia { joint: place(joint, other)?, delta_rotor_inertia_kg_m2: a + b },
        (
            E::LinkInertial {
                link,
                delta_mass_kg: mass,
                delta_first_moment_kg_m: moment,
                delta_inertia_kg_m2: inertia,
            },
            E::LinkInertial { link: other, delta_mass_kg, delta_first_moment_kg_m, delta_inertia_kg_m2 },
        ) => E::LinkInertial {
            link: place(link, other)?,
            delta_mass_kg: mass + delta_mass_kg,
            delta_first_moment_kg_m: std::array::from_fn(|i| moment[i] + delta_first_moment_kg_m[i]),
            delta_inertia_kg_m2: std::array::from_fn(|i| inertia[i] + delta_inertia_kg_m2[i]),
        },
        (
            E::TorqueRipple { joint, cycles_per_rev, amplitude_nm: a, phase_rad: alpha },
            E::TorqueRipple { joint: other, cycles_per_rev: order, amplitude_nm: b, phase_rad: beta },
        ) if order == cycles_per_rev => {
            let (sine, cosine) = (a * alpha.sin() + b * beta.sin(), a * alpha.cos() + b * beta.cos());
            let joint = place(joint, other)?;
            E::TorqueRipple { joint, cycles_per_rev, amplitude_nm: sine.hypot(cosine), phase_rad: sine.atan2(cosine) }
        }
        (
            E::PositionSpring { joint, stiffness_nm_per_rad: a, rest_rad: r },
            E::PositionSpring { joint: other, stiffness_nm_per_rad: b, rest_rad: s },
        ) => {
            let joint = place(joint, other)?;
            // Springs that cancel leave their constant.
            if a + b == 0.0 {
                E::TorqueOffset { joint, offset_nm: -(a * r + b * s) }
            } else {
                E::PositionSpring { joint, stiffness_nm_per_rad: a + b, rest_rad: (a * r + b * s) / (a + b) }
            }
        }
        (E::TimeDelay { delay_s: a }, E::TimeDelay { delay_s: b }) => E::TimeDelay { delay_s: a + b },
        (
            E::FrictionCurve { joint, amplitude_nm: a, width_rad_s },
            E::FrictionCurve { joint: other, amplitude_nm: b, width_rad_s: width },
        ) if width == width_rad_s => E::FrictionCurve { joint: place(joint, other)?, amplitude_nm: a + b, width_rad_s },
        (
            E::FrictionLead { joint, amplitude_nm: a, width_rad_s, lead_s },
            E::FrictionLead { joint: other, amplitude_nm: b, width_rad_s: width, lead_s: lead },
        ) if width == width_rad_s && lead == lead_s => {
            E::FrictionLead { joint: place(joint, other)?, amplitude_nm: a + b, width_rad_s, lead_s }
        }
        (
            E::Presliding { joint, presliding_distance_rad, amplitude_nm: Some(a) },
            E::Presliding { joint: other, presliding_distance_rad: distance, amplitude_nm: Some(b) },
        ) if distance == presliding_distance_rad => {
            E::Presliding { joint: place(joint, other)?, presliding_distance_rad, amplitude_nm: Some(a + b) }
        }
        (E::Presliding { joint, amplitude_nm: None, .. }, E::Presliding { joint: other, amplitude_nm: None, .. })
        | (E::JointElasticity { joint, .. }, E::JointElasticity { joint: other, .. })
        | (E::Backlash { joint, .. }, E::Backlash { joint: other, .. }) => {
            place(joint, other)?;
            new.clone()
        }
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::joint_effects;
    use crate::{YamlDocument, to_yaml};
    use tribo_friction::law::CoulombViscous;
    use tribo_friction::{Bristles, Compensator, CompensatorInput, FrictionModel, VelocitySource};

    type Vector7 = nalgebra::SVector<f64, 7>;

    const BARE: &str = "schema: tribo.model/1\nrobot: panda\n";

    fn bare() -> ModelFile {
        YamlDocument::embedded("m.yaml", BARE).parse().unwrap()
    }

    fn every_cause() -> Vec<Effect> {
        let text = "\
- {cause: coulomb, joint: 0, delta_coulomb_nm: 0.1}
- {cause: viscous, joint: 1, delta_viscous_nm_s_per_rad: -0.2}
- {cause: stribeck, joint: 2, breakaway_minus_coulomb_nm: 0.3, stribeck_velocity_rad_s: 0.05}
- {cause: coulomb_asymmetry, joint: 3, asymmetry_nm: 0.04}
- {cause: torque_offset, joint: 4, offset_nm: -0.5}
- {cause: torque_gain, joint: 5, gain_error: 0.06}
- {cause: thermal_friction, joint: 6, drop_fraction: 0.3, time_constant_s: 600}
- {cause: load_friction, joint: 1, load_coefficient: 0.08}
- {cause: payload, mass_kg: 1.3, com_m: [0.02, -0.01, 0.07], inertia_kg_m2: [2e-3, 0, 0, 2e-3, 0, 1e-3]}
- {cause: payload, mass_kg: 0.1, com_m: [0, 0, 0.1]}
- {cause: base_tilt, angle_rad: 0.1, axis: [1, 2, 0]}
- {cause: link_inertial, link: 2, delta_mass_kg: 0.2, delta_first_moment_kg_m: [0.01, 0, 0.02]}
- {cause: rotor_inertia, joint: 0, delta_rotor_inertia_kg_m2: -0.05}
- {cause: torque_ripple, joint: 5, cycles_per_rev: 160, amplitude_nm: 0.1, phase_rad: 0.3333333333333333}
- {cause: presliding, joint: 6, presliding_distance_rad: 0.001}
- {cause: presliding, joint: 6, presliding_distance_rad: 0.02, amplitude_nm: -0.15}
- {cause: friction_curve, joint: 2, amplitude_nm: 0.3333333333333333, width_rad_s: 0.2}
- {cause: friction_lead, joint: 2, amplitude_nm: 0.25, width_rad_s: 0.2, lead_s: 0.0095}
- {cause: joint_elasticity, joint: 2, stiffness_nm_per_rad: 10000, damping_nm_s_per_rad: 12}
- {cause: backlash, joint: 3, half_gap_rad: 0.0007}
- {cause: time_delay, delay_s: 0.002}
- {cause: external_contact, force_n: [1, 2, 3], moment_nm: [0, 0, 0.1], start_s: 3, end_s: 4}
- {cause: position_spring, joint: 4, stiffness_nm_per_rad: 2.5, rest_rad: -0.1}
";
        YamlDocument::embedded("effects.yaml", text).parse().unwrap()
    }

    /// File → model → file, every cause, every bit.
    #[test]
    fn every_cause_survives_the_file() {
        let file = ModelFile { effects: every_cause(), ..bare() };
        let text = to_yaml(&file).unwrap();
        let back: ModelFile = YamlDocument::embedded("m.yaml", &text).parse().unwrap();
        assert_eq!(back, file);
        let model = back.validate::<7>().unwrap();
        assert_eq!(model.effects, file.effects);
        assert_eq!(model.to_nominal().effects, file.effects);
        assert_eq!(model.to_truth().effects, file.effects);
        assert_eq!(to_yaml(&back).unwrap(), text);
        assert!(!to_yaml(&bare()).unwrap().contains("effects"));
    }

    /// Second route: the torque of the merged effects is the sum of the torques of old and new.
    #[test]
    fn merged_torques_are_sums() {
        let pairs = [
            (Effect::Coulomb { joint: 2, delta_coulomb_nm: 0.3 }, Effect::Coulomb { joint: 2, delta_coulomb_nm: -0.1 }),
            (
                Effect::TorqueRipple { joint: 2, cycles_per_rev: 7.0, amplitude_nm: 0.2, phase_rad: 0.4 },
                Effect::TorqueRipple { joint: 2, cycles_per_rev: 7.0, amplitude_nm: 0.1, phase_rad: -2.0 },
            ),
            (
                Effect::PositionSpring { joint: 2, stiffness_nm_per_rad: 3.0, rest_rad: 0.2 },
                Effect::PositionSpring { joint: 2, stiffness_nm_per_rad: -1.0, rest_rad: 0.7 },
            ),
            (
                Effect::PositionSpring { joint: 2, stiffness_nm_per_rad: 3.0, rest_rad: 0.2 },
                Effect::PositionSpring { joint: 2, stiffness_nm_per_rad: -3.0, rest_rad: 0.7 },
            ),
            (
                Effect::Stribeck { joint: 2, breakaway_minus_coulomb_nm: 0.3, stribeck_velocity_rad_s: 0.1 },
                Effect::Stribeck { joint: 2, breakaway_minus_coulomb_nm: 0.1, stribeck_velocity_rad_s: 0.1 },
            ),
        ];
        let curve = |amplitude_nm, width_rad_s| Effect::FrictionCurve { joint: 2, amplitude_nm, width_rad_s };
        for (old, new) in pairs.into_iter().chain([(curve(0.3, 0.2), curve(-0.4, 0.2))]) {
            let file = bare().extended(std::slice::from_ref(&old)).extended(std::slice::from_ref(&new));
            assert_eq!(file.effects.len(), 1, "{old:?}");
            let torque =
                |effects: &[Effect], q, qd| joint_effects::<7>(effects).0[2].steady_torque_nm(q, qd, 5.0, 1e-3);
            for (q, qd) in [(0.3, 0.05), (-0.9, -0.2), (1.3, 0.001)] {
                let apart = torque(std::slice::from_ref(&old), q, qd) + torque(std::slice::from_ref(&new), q, qd);
                assert!((torque(&file.effects, q, qd) - apart).abs() < 1e-12, "{old:?} and {new:?}");
            }
        }
    }

    /// Second route: the compensator's torque along a swing. Parts of one distance are one, others stand side by side, and
    /// the bristle of the whole stays.
    #[test]
    fn merged_bristles_are_sums() {
        let part = |presliding_distance_rad, amplitude_nm| Effect::Presliding {
            joint: 2,
            presliding_distance_rad,
            amplitude_nm: Some(amplitude_nm),
        };
        let whole = Effect::Presliding { joint: 2, presliding_distance_rad: 2e-3, amplitude_nm: None };
        let findings = [whole.clone(), part(2e-3, 0.3), part(1e-2, 0.2), part(2e-3, -0.1)];
        let file = findings.iter().fold(bare(), |file, finding| file.extended(std::slice::from_ref(finding)));
        assert_eq!(file.effects, [whole, part(2e-3, 0.3 - 0.1), part(1e-2, 0.2)]);
        assert!(file.validate::<7>().is_ok());

        let law = CoulombViscous { coulomb_nm: 0.6, viscous_nm_s_per_rad: 0.4 };
        let compensator = Compensator::new(FrictionModel::<7>::uniform(law.into()), VelocitySource::Reference);
        let swing = |effects: &[Effect]| {
            let compensator = compensator.with_effects(joint_effects(effects).0);
            let mut bristles = Bristles::default();
            let torque = |tick: u32| {
                let qd = Vector7::repeat(0.2 * (0.01 * f64::from(tick)).cos());
                let (q, load_nm) = (Vector7::zeros(), Vector7::zeros());
                let input = CompensatorInput { q, qd_measured: qd, qd_reference: qd, load_nm, dt_s: 1e-3 };
                compensator.tick(&mut bristles, &input).effects_nm[2]
            };
            (0..1000).map(torque).collect::<Vec<f64>>()
        };
        let together = swing(&file.effects);
        let apart = findings.each_ref().map(|finding| swing(std::slice::from_ref(finding)));
        for (k, torque) in together.iter().enumerate() {
            let sum: f64 = apart.iter().map(|torques| torques[k]).sum();
            assert!((torque - sum).abs() < 1e-12, "{torque} for {sum} at tick {k}");
        }
        assert!(together.iter().any(|torque| torque.abs() > 0.3));
    }

    /// Whatever findings come on top, the file stays one that can be read.
    #[test]
    fn an_extended_file_is_valid_and_other_places_are_left_alone() {
        let file = bare().extended(&every_cause()).extended(&every_cause());
        assert!(file.validate::<7>().is_ok(), "{:?}", file.validate::<7>());
        let payloads = file.effects.iter().filter(|effect| effect.cause() == "payload").count();
        assert_eq!(payloads, 4);
        let coulomb = |joint| Effect::Coulomb { joint, delta_coulomb_nm: 0.1 };
        assert_eq!(bare().extended(&[coulomb(0), coulomb(1)]).effects, [coulomb(0), coulomb(1)]);
        let ripple = |order: u32| Effect::TorqueRipple {
            joint: 1,
            cycles_per_rev: f64::from(order),
            amplitude_nm: 0.1 * f64::from(order),
            phase_rad: 0.0,
        };
        let ripples: Vec<Effect> = [3, 1, 5, 2, 4].map(ripple).into();
        assert_eq!(bare().extended(&ripples).effects, [3, 5, 2, 4].map(ripple));
        let curve = |k: u32| Effect::FrictionCurve {
            joint: 1,
            amplitude_nm: -0.1 * f64::from(k),
            width_rad_s: 0.1 * f64::from(k),
        };
        assert_eq!(bare().extended(&[3, 1, 5, 2].map(curve)).effects, [3, 5, 2].map(curve));
        let part = |k: u32| Effect::Presliding {
            joint: 1,
            presliding_distance_rad: 0.1 * f64::from(k),
            amplitude_nm: Some(0.1 * f64::from(k)),
        };
        let whole = Effect::Presliding { joint: 1, presliding_distance_rad: 0.1, amplitude_nm: None };
        let findings = [part(3), whole.clone(), part(1), part(5), part(2)];
        assert_eq!(bare().extended(&findings).effects, [part(3), whole, part(5), part(2)]);
    }

    #[test]
    fn refusals_name_the_effect_and_its_field() {
        let refused = |effects: &str| {
            let text = format!("{BARE}effects:\n{effects}");
            let document = YamlDocument::embedded("m.yaml", &text);
            match document.parse::<ModelFile>() {
                Err(error) => error.to_string(),
                Ok(file) => document.explain(file.validate::<7>().unwrap_err()).to_string(),
            }
        };
        let cases = [
            (
                "- {cause: torque_offset, joint: 0, offset_nm: 1}\n- {cause: coulomb, joint: 7, delta_coulomb_nm: 1}\n",
                &["m.yaml:5: ", "`effects[1].joint` is 7", "0 to 6"][..],
            ),
            (
                "- cause: coulomb\n  joint: 1\n  delta_coulomb_nm: .nan\n",
                &["m.yaml:6:21: ", "delta_coulomb_nm`: not a finite number"],
            ),
            (
                "- cause: coulomb\n  joint: 1\n  delta_coulomb_nm: 2000\n",
                &["m.yaml:6: ", "`effects[0].delta_coulomb_nm` is 2000", "-1000..1000"],
            ),
            (
                "- {cause: link_inertial, link: 1, delta_mass_kg: -5, delta_first_moment_kg_m: [0, 0, 0]}\n",
                &["m.yaml:4: ", "`effects[0].delta_mass_kg` is -5", "link 1"],
            ),
            (
                "- {cause: rotor_inertia, joint: 6, delta_rotor_inertia_kg_m2: -5}\n",
                &["m.yaml:4: ", "`effects[0]`", "positive definite"],
            ),
            (
                "- {cause: presliding, joint: 1, presliding_distance_rad: 0.1}\n\
              - {cause: presliding, joint: 1, presliding_distance_rad: 0.1}\n",
                &["m.yaml:5: ", "`effects[1].joint` is 1", "at most 1 presliding per joint"],
            ),
            (
                &"- {cause: presliding, joint: 1, presliding_distance_rad: 0.1, amplitude_nm: 1}\n".repeat(4),
                &["m.yaml:7: ", "`effects[3].joint` is 1", "at most 3 presliding per joint"],
            ),
            (
                "- {cause: friction_curve, joint: 1, amplitude_nm: 1, width_rad_s: 0}\n",
                &["m.yaml:4: ", "`effects[0].width_rad_s` is 0", "1e-5..100"],
            ),
            ("- {cause: coulomb, joint: 1, delta_coulomb_nm: 1, color: red}\n", &["m.yaml:4", "`color`"]),
            (
                &"- {cause: time_delay, delay_s: 0}\n".repeat(257),
                &["m.yaml:3: ", "`effects` is 257 entries", "at most 256"],
            ),
            ("- {cause: gremlins, joint: 1}\n", &["m.yaml:4", "`gremlins`", "coulomb"]),
            ("- {cause: coulomb, joint: 1}\n", &["m.yaml:4", "delta_coulomb_nm"]),
            ("- {cause: coulomb, joint: one, delta_coulomb_nm: 1}\n", &["m.yaml:4"]),
        ];
        let mut complaints = Vec::new();
        for (effects, needles) in cases {
            let message = refused(effects);
            let missing = needles.iter().filter(|needle| !message.contains(**needle));
            complaints.extend(missing.map(|needle| format!("no `{needle}` in {message}")));
        }
        assert!(complaints.is_empty(), "{complaints:#?}");
    }
}
