//! What the plant leaves out of its effects, and what only its torque sensor shows.

use tribo_robot::JointNames;

use crate::Effect;

/// One sentence, without a full stop, for every cause of a truth that [`BoxFrictionPlant`](crate::BoxFrictionPlant) does not have, or
/// not where one might look for it.
pub fn not_simulated(effects: &[Effect], names: &JointNames) -> Vec<String> {
    let mut causes: Vec<(&'static str, &'static str, Vec<usize>)> = Vec::new();
    for effect in effects {
        let Some(what) = limit_of(effect) else { continue };
        let joint = effect.joint();
        match causes.iter_mut().find(|(cause, known, _)| *cause == effect.cause() && *known == what) {
            Some((_, _, joints)) => joints.extend(joint),
            None => causes.push((effect.cause(), what, joint.into_iter().collect())),
        }
    }
    let sentence = |(cause, what, joints): (&str, &str, Vec<usize>)| match joints.is_empty() {
        true => format!("{cause} {what}"),
        false => format!("{cause} of {} {what}", names.several(&joints)),
    };
    causes.into_iter().map(sentence).collect()
}

fn limit_of(effect: &Effect) -> Option<&'static str> {
    match *effect {
        Effect::TimeDelay { delay_s } if delay_s < 0.0 => {
            Some("below zero is not simulated: a torque cannot be known before it acts")
        }
        Effect::TimeDelay { delay_s } if delay_s > 0.0 => {
            Some("is simulated in tau_J of the log alone: controller and estimator take the torque that was commanded")
        }
        Effect::TorqueGain { gain_error, .. } if gain_error != 0.0 => {
            Some("is simulated in tau_J of the log alone: controller and estimator take the torque that was commanded")
        }
        Effect::Backlash { half_gap_rad, .. } if half_gap_rad > 0.0 => {
            Some("is simulated in the encoders alone: the free flight inside the gap is left out")
        }
        Effect::FrictionLead { amplitude_nm, .. } if amplitude_nm != 0.0 => {
            Some("is simulated along a given motion alone: in a trial dry friction turns round with the velocity")
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_limit_is_a_sentence_and_nothing_else_is() {
        let gain = |joint| Effect::TorqueGain { joint, gain_error: 0.1 };
        let effects = [
            gain(1),
            Effect::Viscous { joint: 0, delta_viscous_nm_s_per_rad: 0.1 },
            gain(2),
            gain(4),
            Effect::TimeDelay { delay_s: -0.01 },
            Effect::Backlash { joint: 3, half_gap_rad: 1e-4 },
            Effect::TorqueGain { joint: 5, gain_error: 0.0 },
        ];
        let told = not_simulated(&effects, &JointNames::default());
        assert_eq!(told.len(), 3, "{told:?}");
        assert!(
            told[0].starts_with("torque_gain of joints 1, 2 and 4 is simulated in tau_J of the log alone"),
            "{told:?}"
        );
        assert_eq!(told[1], "time_delay below zero is not simulated: a torque cannot be known before it acts");
        assert!(told[2].starts_with("backlash of joint 3 is simulated in the encoders alone"), "{told:?}");
    }
}
