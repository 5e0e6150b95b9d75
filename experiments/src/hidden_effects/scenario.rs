//! Motion, sensors and nominal model of a case.

use std::f64::consts::TAU;

use nalgebra::{Matrix3, Vector3};
use tribo_friction::FrictionModel;
use tribo_friction::law::{CoulombViscous, JointFriction, Stribeck};
use tribo_regression::{CauseLabel, Nominal};
use tribo_robot::{Payload, presets};
use tribo_sim::excitation::{Chain, Envelope, Excitation, JointTrajectory};
use tribo_sim::{Recording, Session, TorqueSide, Truth};

use super::chance::Chance;
use super::world::{Reality, World};

/// Width of the smooth sign (rad/s).
const SMOOTHING_RAD_S: f64 = 0.005;

/// Everything of a case but what it hides.
pub struct Scenario {
    /// The model that diagnosis is given.
    pub nominal: Nominal<7>,
    /// The arm under the hidden causes.
    pub reality: Reality,
    /// One motion per log.
    pub motions: Vec<Box<dyn JointTrajectory<7>>>,
    /// How logs are taken.
    pub recording: Recording,
    /// A cycle every few minutes instead of one run.
    pub session: Option<Session>,
    /// Motion and sensors in words.
    pub description: String,
}

impl Scenario {
    /// Motions that show all of these causes in principle, and sensors that could see them; torque noise in a range (Nm).
    pub(super) fn draw(
        labels: &[CauseLabel],
        dual_encoder: bool,
        torque_sd_nm: [f64; 2],
        world: World,
        seed: u64,
    ) -> Self {
        let chance = &mut Chance::new(seed, 1);
        let mut nominal = nominal(chance);
        let has = |label| labels.contains(&label);
        let reality = match world {
            World::Identified => Reality::of_nominal(&nominal),
            World::WrongEverywhere => {
                // Streams of their own: the motion is that of the same seed in the other world.
                let chance = &mut Chance::new(seed, 3);
                nominal.friction = FrictionModel { joints: std::array::from_fn(|_| coulomb_viscous(chance).into()) };
                // What fades with warmth is a law's friction.
                Reality::beside(&nominal, !has(CauseLabel::ThermalFriction), chance)
            }
        };

        // Clock and sensors.
        let session = has(CauseLabel::ThermalFriction);
        let fastest: &[f64] = if session {
            &[100.0, 200.0]
        } else if has(CauseLabel::TorqueRipple) {
            &[500.0, 1000.0]
        } else if has(CauseLabel::Presliding) || has(CauseLabel::TimeDelay) || has(CauseLabel::JointElasticity) {
            &[250.0, 500.0, 1000.0]
        } else {
            &[100.0, 200.0, 250.0, 500.0, 1000.0]
        };
        let rate_hz = chance.pick(fastest);
        let quantised = chance.happens(0.3);
        let encoder_sd_rad = if quantised { 3e-6 } else { chance.log_between(3e-6, 5e-5) };
        let encoder_resolution_rad = if quantised { TAU / chance.pick(&[65_536.0, 131_072.0, 524_288.0]) } else { 0.0 };
        let recording = Recording {
            rate_hz,
            sampling_jitter_sd_s: if chance.happens(0.15) { 0.05 / rate_hz } else { 0.0 },
            stamp_jitter_sd_s: if chance.happens(0.1) { chance.log_between(5e-6, 5e-5) } else { 0.0 },
            repeated_fraction: if chance.happens(0.1) { chance.between(0.005, 0.05) } else { 0.0 },
            encoder_sd_rad,
            encoder_resolution_rad,
            torque_sd_nm: chance.log_between(torque_sd_nm[0], torque_sd_nm[1]),
            dual_encoder,
            motor_encoder_sd_rad: encoder_sd_rad,
            temperatures: session && chance.happens(0.3),
            ..Recording::default()
        };

        // Motions.
        let once = session || has(CauseLabel::ExternalContact);
        let count = if !once && chance.happens(0.2) { 2 } else { 1 };
        let mut words = Vec::new();
        let motions = (0..count)
            .map(|_| {
                let total_s =
                    if session { chance.between(10.0, 20.0) } else { chance.between(20.0, 90.0) / count as f64 };
                let parts = parts(labels, total_s, chance);
                let mut centre = presets::panda_ready_pose();
                centre.iter_mut().for_each(|q| *q += chance.between(-0.3, 0.3));
                let envelope = Envelope::around(&nominal.arm, centre);
                let speed = if chance.happens(0.3) { chance.between(0.5, 1.2) } else { f64::INFINITY };
                let slow = if has(CauseLabel::TorqueRipple) { chance.between(0.25, 0.6) } else { speed };
                let envelope = envelope.slower_than(slow);
                words.push(format!("{parts:?} {total_s:.0} s"));
                let each_s = total_s / parts.len() as f64;
                let mut drawn = parts.iter().map(|part| part.draw(&envelope, each_s, chance.seed()));
                match drawn.next() {
                    Some(first) => Box::new(Chain::new(first, drawn.collect())) as Box<dyn JointTrajectory<7>>,
                    None => Excitation::Multisine.draw(&envelope, total_s, chance.seed()),
                }
            })
            .collect();
        let session = session.then_some(Session { every_s: 300.0, duration_s: 7200.0 });
        let description = format!(
            "{}{}, {rate_hz} Hz, tau {:.3} Nm, q {:.1e} rad{}{}{}{}",
            words.join(" | "),
            if session.is_some() { " every 5 min for 2 h" } else { "" },
            recording.torque_sd_nm,
            encoder_sd_rad,
            if quantised { format!(" quantised {encoder_resolution_rad:.1e}") } else { String::new() },
            if recording.repeated_fraction > 0.0 { ", repeated rows" } else { "" },
            if recording.sampling_jitter_sd_s + recording.stamp_jitter_sd_s > 0.0 { ", jitter" } else { "" },
            if dual_encoder { ", two encoders" } else { "" },
        );
        Self { nominal, reality, motions, recording, session, description }
    }

    /// Length of the shortest log (s).
    pub fn shortest_s(&self) -> f64 {
        self.motions.iter().map(|motion| motion.duration_s()).fold(f64::INFINITY, f64::min)
    }
}

/// Parts of one motion: one or two that suit the causes, or any if nothing is asked.
fn parts(labels: &[CauseLabel], total_s: f64, chance: &mut Chance) -> Vec<Excitation> {
    use Excitation::{BackAndForth, Cruise, JointByJoint, Multisine, SmallFast, StaticPoses};
    let mut parts = Vec::new();
    for label in labels {
        let choices: &[&[Excitation]] = match label {
            CauseLabel::Stribeck => &[&[Cruise, BackAndForth], &[Cruise], &[Cruise, JointByJoint]],
            CauseLabel::Presliding => &[&[BackAndForth, Multisine], &[BackAndForth], &[BackAndForth, Cruise]],
            CauseLabel::Payload | CauseLabel::BaseTilt | CauseLabel::LinkInertial | CauseLabel::TorqueGain => {
                &[&[Multisine], &[StaticPoses, Multisine], &[Multisine, Cruise], &[Cruise]]
            }
            CauseLabel::LoadFriction => &[&[StaticPoses, Cruise], &[Multisine], &[Cruise, Multisine]],
            CauseLabel::CoulombAsymmetry => {
                &[&[StaticPoses, Cruise], &[JointByJoint, Multisine], &[StaticPoses, Multisine]]
            }
            CauseLabel::RotorInertia | CauseLabel::TimeDelay => {
                &[&[Multisine], &[SmallFast, Multisine], &[Cruise, SmallFast], &[Multisine, Cruise]]
            }
            CauseLabel::JointElasticity => &[&[SmallFast, Multisine], &[Multisine]],
            CauseLabel::Backlash => &[&[Multisine], &[SmallFast, Multisine], &[Cruise, Multisine]],
            CauseLabel::TorqueRipple => &[&[Cruise], &[Cruise, BackAndForth], &[Multisine, Cruise]],
            CauseLabel::PositionSpring => {
                &[&[Multisine], &[Cruise], &[StaticPoses, Multisine], &[JointByJoint, Multisine]]
            }
            CauseLabel::TorqueOffset => &[&[Multisine], &[Cruise], &[StaticPoses, Cruise], &[StaticPoses, Multisine]],
            CauseLabel::ThermalFriction => &[&[Multisine], &[Cruise], &[Cruise, BackAndForth]],
            _ => {
                &[&[Multisine], &[Cruise], &[Cruise, BackAndForth], &[JointByJoint, Multisine], &[StaticPoses, Cruise]]
            }
        };
        for part in chance.pick(choices) {
            if !parts.contains(part) {
                parts.push(*part);
            }
        }
    }
    if parts.is_empty() {
        parts.push(chance.pick(&Excitation::ALL));
        parts.push(chance.pick(&[Multisine, Cruise]));
        parts.dedup();
    }
    // Every part gets 7 s at least.
    parts.truncate(((total_s / 7.0) as usize).max(1));
    parts
}

/// Bare Panda, motor side, with the friction of some arm and now and then a payload that is known.
fn nominal(chance: &mut Chance) -> Nominal<7> {
    let friction = match chance.pick(&[0, 1, 2, 3]) {
        0 => Truth::panda_coulomb_viscous().friction,
        1 => Truth::panda_stribeck().friction,
        2 => FrictionModel { joints: std::array::from_fn(|_| coulomb_viscous(chance).into()) },
        _ => FrictionModel { joints: std::array::from_fn(|_| stribeck(chance)) },
    };
    let mut arm = presets::panda();
    if chance.happens(0.3) {
        let com_m = Vector3::new(chance.between(-0.03, 0.03), chance.between(-0.03, 0.03), chance.between(0.02, 0.12));
        let mass_kg = chance.log_between(0.2, 1.5);
        let inertia_kg_m2 = Matrix3::identity() * (mass_kg * 0.03 * 0.03);
        arm = arm.with_payload(&Payload { mass_kg, com_m, inertia_kg_m2 });
    }
    let (smoothing_rad_s, torque_side) = (SMOOTHING_RAD_S, TorqueSide::Motor);
    Nominal { smoothing_rad_s, ..Nominal::new(arm, friction, torque_side) }
}

fn coulomb_viscous(chance: &mut Chance) -> CoulombViscous {
    let coulomb_nm = chance.log_between(0.2, 1.2);
    CoulombViscous { coulomb_nm, viscous_nm_s_per_rad: chance.log_between(0.15, 1.8) }
}

fn stribeck(chance: &mut Chance) -> JointFriction {
    let CoulombViscous { coulomb_nm, viscous_nm_s_per_rad } = coulomb_viscous(chance);
    Stribeck {
        coulomb_nm,
        viscous_nm_s_per_rad,
        breakaway_minus_coulomb_nm: coulomb_nm * chance.between(0.2, 0.8),
        inverse_stribeck_velocity_s_per_rad: chance.log_between(5.0, 40.0),
        shape: chance.between(1.2, 2.0),
    }
    .into()
}
