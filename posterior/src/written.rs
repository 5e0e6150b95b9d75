//! The posterior mean as effects of a model file.

use tribo_regression::RegressionData;
use tribo_regression::cause::tilt_of;
use tribo_sim::{Effect, SOFT_FRICTION_LEAD_S};

use crate::joint_term::{JointTerm, RIPPLES};
use crate::prior::{PAYLOAD_RADIUS_M, PRESLIDING_RAD};
use crate::problem::{Place, Problem, State};

/// The effects that make the nominal model predict `(1 + g)(τ0 + A θ)`, one per parameter that is not zero, one per link.
pub fn effects<const N: usize>(data: &RegressionData<N>, problem: &Problem, state: &State) -> Vec<Effect> {
    let at = |place: Place| problem.index(place).map_or(0.0, |i| state[i]);
    let mut effects = Vec::new();
    for joint in 0..N {
        for term in JointTerm::ALL {
            let value = at(Place::Own(joint, term));
            if value != 0.0 {
                effects.extend(own_effect(problem, joint, term, value));
            }
        }
        effects.extend((0..RIPPLES).filter_map(|k| ripple(problem, state, joint, k)));
    }
    let tilt = [at(Place::Tilt(0)), at(Place::Tilt(1))].map(|angle| angle * data.nominal.arm.gravity_m_s2.norm());
    effects.extend(tilt_of(data, tilt).filter(|_| tilt != [0.0; 2]));
    let mass_kg = at(Place::Payload(0));
    if mass_kg > 0.0 {
        let com = problem.payload_com_m(state);
        let own = PAYLOAD_RADIUS_M * PAYLOAD_RADIUS_M * mass_kg;
        let inertia_kg_m2 = [own, 0.0, 0.0, own, 0.0, own];
        effects.push(Effect::Payload { mass_kg, com_m: [com.x, com.y, com.z], inertia_kg_m2 });
    }
    for link in 0..N {
        let delta: [f64; 10] = std::array::from_fn(|i| at(Place::Link(link, i)));
        if delta != [0.0; 10] {
            let [mass, x, y, z, inertia @ ..] = delta;
            effects.push(Effect::LinkInertial {
                link,
                delta_mass_kg: mass,
                delta_first_moment_kg_m: [x, y, z],
                delta_inertia_kg_m2: inertia,
            });
        }
    }
    for joint in 0..N {
        let gain_error = problem.gain(state, joint);
        if gain_error != 0.0 {
            effects.push(Effect::TorqueGain { joint, gain_error });
        }
    }
    let delay_s = at(Place::Delay);
    if delay_s != 0.0 {
        effects.push(Effect::TimeDelay { delay_s });
    }
    effects
}

/// `a sin(n q) + b cos(n q)` of a joint as amplitude and phase, if there is any.
pub fn ripple(problem: &Problem, state: &State, joint: usize, k: usize) -> Option<Effect> {
    let at = |term: JointTerm| problem.index(Place::Own(joint, term)).map_or(0.0, |i| state[i]);
    let (sine, cosine) = (at(JointTerm::Sine(k)), at(JointTerm::Cosine(k)));
    let cycles_per_rev = problem.scale.waves_per_rev(joint, k)?;
    let (amplitude_nm, phase_rad) = (sine.hypot(cosine), cosine.atan2(sine));
    (amplitude_nm > 0.0).then_some(Effect::TorqueRipple { joint, cycles_per_rev, amplitude_nm, phase_rad })
}

/// The effect of one term; sines and cosines are one effect of both, see [`ripple`].
fn own_effect(problem: &Problem, joint: usize, term: JointTerm, value: f64) -> Option<Effect> {
    Some(match term {
        JointTerm::Sine(_) | JointTerm::Cosine(_) => return None,
        JointTerm::Offset => Effect::TorqueOffset { joint, offset_nm: value },
        JointTerm::Coulomb => Effect::Coulomb { joint, delta_coulomb_nm: value },
        JointTerm::Viscous => Effect::Viscous { joint, delta_viscous_nm_s_per_rad: value },
        JointTerm::Curve(k) => {
            Effect::FrictionCurve { joint, amplitude_nm: value, width_rad_s: problem.scale.curve_width_rad_s(joint, k) }
        }
        JointTerm::Lead(k) => Effect::FrictionLead {
            joint,
            amplitude_nm: value,
            width_rad_s: problem.scale.lead_width_rad_s(joint, k),
            lead_s: SOFT_FRICTION_LEAD_S,
        },
        JointTerm::Load => Effect::LoadFriction { joint, load_coefficient: value },
        JointTerm::Rotor => Effect::RotorInertia { joint, delta_rotor_inertia_kg_m2: value },
        JointTerm::Presliding(k) => {
            Effect::Presliding { joint, presliding_distance_rad: PRESLIDING_RAD[k], amplitude_nm: Some(value) }
        }
        JointTerm::Spring => Effect::PositionSpring { joint, stiffness_nm_per_rad: value, rest_rad: 0.0 },
    })
}
