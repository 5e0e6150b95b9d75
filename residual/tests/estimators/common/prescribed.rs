//! A Panda that follows a prescribed motion under a prescribed wrench and friction, at 1 kHz.
//!
//! The torque over a period is inverse dynamics at its middle, the sensors read its end: no controller and no integrator.

use nalgebra::{SVector, Vector6};
use tribo_friction::FrictionModel;
use tribo_robot::{
    Arm, ControlTerms, EstimatorInput, Kinematics, SensorFrame, Wrench, WrenchEstimate, WrenchEstimator, presets, rnea,
};

/// Control period (s).
pub const DT_S: f64 = 1e-3;

type Joints = SVector<f64, 7>;

/// Position, velocity and acceleration (rad, rad/s, rad/s²) at a time (s).
pub type Motion = fn(f64) -> [Joints; 3];

/// One sample as an estimator gets it, with what is true.
#[derive(Clone, Debug)]
pub struct Sample {
    pub frame: SensorFrame<7>,
    pub terms: ControlTerms<7>,
    pub tau_motor: Joints,
    pub tau_friction: Joints,
    pub acceleration_command: Vector6<f64>,
    pub dt_s: f64,
}

impl Sample {
    pub fn input(&self) -> EstimatorInput<'_, 7> {
        EstimatorInput {
            frame: &self.frame,
            terms: &self.terms,
            tau_motor: &self.tau_motor,
            tau_friction: &self.tau_friction,
            acceleration_command: &self.acceleration_command,
            dt_s: self.dt_s,
        }
    }
}

/// The ready pose, held.
pub fn hold(_: f64) -> [Joints; 3] {
    [presets::panda_ready_pose(), Joints::zeros(), Joints::zeros()]
}

/// Every joint at its own constant speed, 0.2 to 0.5 rad/s: no reversal, so friction is known.
pub fn slide(t: f64) -> [Joints; 3] {
    let speed = Joints::from_column_slice(&[0.3, -0.2, 0.4, 0.25, -0.5, 0.35, -0.45]);
    [presets::panda_ready_pose() + speed * t, speed, Joints::zeros()]
}

/// Slow sines around the ready pose, every joint at its own frequency and phase.
pub fn sway(t: f64) -> [Joints; 3] {
    let w = Joints::from_fn(|j, _| 2.0 + 0.3 * j as f64);
    let x = Joints::from_fn(|j, _| w[j] * t + j as f64);
    let (s, c) = (x.map(f64::sin) * 0.15, x.map(f64::cos) * 0.15);
    [presets::panda_ready_pose() + s, c.component_mul(&w), -s.component_mul(&w).component_mul(&w)]
}

/// The samples at 0, 1, … `count` periods.
pub fn samples(
    motion: Motion,
    wrench: &dyn Fn(f64) -> Wrench,
    friction: &FrictionModel<7>,
    count: usize,
) -> Vec<Sample> {
    let arm: Arm<7> = presets::panda();
    (0..=count)
        .map(|k| {
            let end_s = k as f64 * DT_S;
            let middle_s = end_s - 0.5 * DT_S;
            let (end, [qm, qdm, qddm]) = (motion(end_s), motion(middle_s));
            let [q, qd, _] = end;
            let jacobian = Kinematics::at(&arm, &qm).jacobian();
            let tau_friction = friction.torque(&qdm, 0.0);
            let tau_motor =
                rnea(&arm, &qm, &qdm, &qddm) + tau_friction + jacobian.transpose() * wrench(middle_s).to_vector();
            let terms = ControlTerms::at(&arm, &q, &qd);
            let theta = q + deflection(&arm, &end, &wrench(end_s));
            let frame = SensorFrame { time_s: end_s, q, qd, tau: tau_motor, theta: Some(theta) };
            Sample { frame, terms, tau_motor, tau_friction, acceleration_command: Vector6::zeros(), dt_s: DT_S }
        })
        .collect()
}

/// Stiffness of the prescribed arm's gears (Nm/rad): the motor encoders read the link angle and what the gears yield.
pub const STIFFNESS_NM_PER_RAD: [f64; 7] = presets::PANDA_JOINT_STIFFNESS_NM_PER_RAD;

/// Deflection of the gears (rad) under what the links need: friction and rotors lie on the other side of the gears.
fn deflection(arm: &Arm<7>, [q, qd, qdd]: &[Joints; 3], wrench: &Wrench) -> Joints {
    let mut links = arm.clone();
    links.rotor_inertia_kg_m2 = Joints::zeros();
    let jacobian = Kinematics::at(arm, q).jacobian();
    let load = rnea(&links, q, qd, qdd) + jacobian.transpose() * wrench.to_vector();
    load.component_div(&Joints::from(STIFFNESS_NM_PER_RAD))
}

/// Resets the estimator at the first sample and steps through the rest.
pub fn run<E: WrenchEstimator<7>>(estimator: &mut E, samples: &[Sample]) -> Vec<WrenchEstimate> {
    estimator.reset(&samples[0].frame, &samples[0].terms);
    samples[1..].iter().map(|sample| estimator.step(&sample.input())).collect()
}
