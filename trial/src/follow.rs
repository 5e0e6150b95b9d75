//! A joint-space motion followed on the simulated arm.

use nalgebra::SVector;
use tribo_control::{JointTarget, JointTracking, TorqueLimiter};
use tribo_files::LogError;
use tribo_friction::{Bristles, Compensator, CompensatorInput, FrictionModel};
use tribo_logs::RobotLog;
use tribo_robot::{ControlTerms, Plant, SensorFrame, Wrench};
use tribo_runtime::TickFault;
use tribo_sim::BoxFrictionPlant;
use tribo_sim::excitation::JointTrajectory;

use crate::log_recorder::LogRecorder;
use crate::{AbortReason, Trial};

/// How well a motion was followed; errors are those of the true joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Followed<const N: usize> {
    /// Time that was run (s).
    pub duration_s: f64,
    /// RMS of `q − q_d` per joint (rad).
    pub rms_error_rad: SVector<f64, N>,
    /// Largest |q − q_d| per joint (rad).
    pub max_error_rad: SVector<f64, N>,
    /// Ticks at which a torque limit was hit.
    pub saturated_ticks: u64,
    /// Why and when (s) the run was stopped, if it was.
    pub aborted: Option<(AbortReason, f64)>,
}

/// Follows `motion` from rest at its start with [`JointTracking`], the torque limits of the arm and the compensator of
/// the trial, and records the run as a canonical log (see [`crate::simulate_log`]).
///
/// Of the trial it takes plant, sensors, the controller's belief, velocity source and period. A joint that leaves its
/// limits ends the run.
pub fn follow<const N: usize>(
    trial: &Trial<N>,
    friction: &FrictionModel<N>,
    motion: &dyn JointTrajectory<N>,
    seed: u64,
) -> Result<(Followed<N>, RobotLog), LogError> {
    let mut plant = BoxFrictionPlant::new(trial.truth.clone(), trial.sensors, motion.at(0.0).q, seed)
        .with_sub_steps(trial.sub_steps)
        .with_period(trial.dt_s);
    let (joints, wrench) = (|plant: &BoxFrictionPlant<N>, _: &SensorFrame<N>| *plant.q(), BoxFrictionPlant::wrench);
    follow_seen(&mut plant, trial, friction, motion, joints, |plant| Some(wrench(plant)))
}

/// Follows `motion` on any robot that stands at its start, as [`follow`] does; errors are those of the measured joints. A
/// robot that gives no more samples ends the run.
///
/// # Errors
/// A run that ended on its first ticks.
pub fn follow_on<const N: usize, P: Plant<N>>(
    plant: &mut P,
    trial: &Trial<N>,
    friction: &FrictionModel<N>,
    motion: &dyn JointTrajectory<N>,
) -> Result<(Followed<N>, RobotLog), LogError> {
    follow_seen(plant, trial, friction, motion, |_, frame| frame.q, |_| None)
}

fn follow_seen<const N: usize, P: Plant<N>>(
    plant: &mut P,
    trial: &Trial<N>,
    friction: &FrictionModel<N>,
    motion: &dyn JointTrajectory<N>,
    joints: impl Fn(&P, &SensorFrame<N>) -> SVector<f64, N>,
    wrench: impl Fn(&P) -> Option<Wrench>,
) -> Result<(Followed<N>, RobotLog), LogError> {
    let dt_s = trial.dt_s;
    let compensator = Compensator::new(*friction, trial.velocity).with_effects(trial.effects);
    let (tracking, mut bristles) = (JointTracking::default(), Bristles::default());
    let mut limiter = TorqueLimiter::new(&trial.model.limits);
    let mut recorder = LogRecorder::new(N);
    let (mut sum, mut max_error_rad) = (SVector::<f64, N>::zeros(), SVector::<f64, N>::zeros());
    let (mut saturated_ticks, mut aborted) = (0, None);
    let ticks = (motion.duration_s() / dt_s).round() as u64;
    let mut done = 0;

    while done < ticks {
        // Sense.
        let Ok(frame) = plant.sense() else {
            aborted = Some((TickFault::PlantLost.into(), done as f64 * dt_s));
            break;
        };
        let wanted = motion.at(frame.time_s);
        let error = joints(plant, &frame) - wanted.q;
        sum += error.component_mul(&error);
        max_error_rad = max_error_rad.sup(&error.abs());
        if let Some(fault) = TickFault::of_frame(&trial.model, &frame) {
            aborted = Some((fault.into(), frame.time_s));
            break;
        }

        // Decide.
        let terms = ControlTerms::at(&trial.model, &frame.q, &frame.qd);
        let target = JointTarget { q: wanted.q, qd: wanted.qd, qdd: wanted.qdd };
        let (rigid, qdd) = tracking.tick(&terms, &frame.q, &frame.qd, &target);
        let load_nm = rigid - trial.model.rotor_inertia_kg_m2.component_mul(&qdd);
        let (q, qd_measured, qd_reference) = (frame.q, frame.qd, wanted.qd);
        let input = CompensatorInput { q, qd_measured, qd_reference, load_nm, dt_s };
        let compensation = compensator.tick(&mut bristles, &input).total();
        let torque = rigid + compensation;

        // Limit, actuate, record.
        let (command, saturated) = limiter.limit(&torque, &terms.gravity_nm, dt_s);
        plant.actuate(&command);
        recorder.push(&frame, &command, &compensation, wrench(plant).as_ref());
        saturated_ticks += u64::from(saturated);
        done += 1;
    }

    let count = (done + u64::from(aborted.is_some())).max(1) as f64;
    let rms_error_rad = (sum / count).map(f64::sqrt);
    let followed = Followed { duration_s: done as f64 * dt_s, rms_error_rad, max_error_rad, saturated_ticks, aborted };
    Ok((followed, recorder.finish()?))
}
