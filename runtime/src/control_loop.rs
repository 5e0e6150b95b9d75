//! One period of the control loop.

use nalgebra::SVector;
use tribo_control::{
    CompensationGuard, DampedPseudoInverse, GuardInput, GuardSettings, ImpedanceController, ImpedanceSettings,
    ReferenceModel, SafeTorque, SinusoidReference, TaskState, TorqueLimiter, TorqueTerms,
};
use tribo_friction::{Bristles, Compensator, CompensatorInput};
use tribo_robot::{Arm, ControlTerms, EstimatorInput, Plant, PlantLost, WrenchEstimator};

use crate::frame_watch::FrameWatch;
use crate::{TickFault, TickRecord};

/// What one trial of the loop is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopSettings<const N: usize> {
    /// Gains.
    pub impedance: ImpedanceSettings,
    /// Trajectory of the tool.
    pub reference: SinusoidReference,
    /// Friction compensator.
    pub compensator: Compensator<N>,
    /// What withdraws it before it shakes the arm; none trusts it.
    pub guard: Option<GuardSettings>,
    /// Control period (s).
    pub dt_s: f64,
}

/// The loop: model of the arm, estimator, controller, limits and the little memory between ticks.
#[derive(Clone, Debug)]
pub struct ControlLoop<const N: usize, E> {
    arm: Arm<N>,
    settings: LoopSettings<N>,
    estimator: E,
    controller: ImpedanceController<N>,
    model: ReferenceModel,
    limiter: TorqueLimiter<N>,
    bristles: Bristles<N>,
    safe: SafeTorque<N>,
    guard: Option<CompensationGuard<N>>,
    watch: FrameWatch<N>,
    /// Whether the estimator has seen its first sample, and `record` says what acted since.
    started: bool,
    record: TickRecord<N>,
}

impl<const N: usize, E: WrenchEstimator<N>> ControlLoop<N, E> {
    /// A loop for an arm at rest at q (rad), which also becomes the posture of the null-space spring.
    pub fn new(arm: Arm<N>, q: SVector<f64, N>, settings: LoopSettings<N>, estimator: E) -> Self {
        let start = settings.reference.at(0.0);
        Self {
            controller: ImpedanceController {
                settings: settings.impedance,
                pseudo_inverse: DampedPseudoInverse::default(),
                posture: q,
                rotor_inertia_kg_m2: arm.rotor_inertia_kg_m2,
            },
            model: ReferenceModel::at_rest(&start),
            limiter: TorqueLimiter::new(&arm.limits),
            bristles: Bristles::default(),
            safe: SafeTorque::new(q),
            guard: settings.guard.map(CompensationGuard::new),
            watch: FrameWatch::new(),
            started: false,
            record: TickRecord::none_yet(q, start),
            arm,
            settings,
            estimator,
        }
    }

    /// The estimator, for its evidence.
    pub fn estimator(&self) -> &E {
        &self.estimator
    }

    /// The model of the arm that the controller believes.
    pub fn arm(&self) -> &Arm<N> {
        &self.arm
    }

    /// Control period (s).
    pub fn period_s(&self) -> f64 {
        self.settings.dt_s
    }

    /// From the next tick on sends the safe torque, for a reason that the loop itself cannot see. An earlier fault stays.
    pub fn stop(&mut self, fault: TickFault) {
        self.record.fault.get_or_insert(fault);
    }

    /// One tick, and everything it knew. No heap, no lock, no clock, no panic.
    #[inline(never)]
    pub fn tick<P: Plant<N>>(&mut self, plant: &mut P) -> &TickRecord<N> {
        match plant.sense() {
            Ok(frame) => self.record.frame = frame,
            Err(PlantLost) => self.stop(TickFault::PlantLost),
        }
        self.record.reference = self.settings.reference.at(self.record.frame.time_s);
        match self.check().and_then(|()| self.decide()) {
            Ok(()) => self.safe.remember(&self.record.frame.q),
            Err(fault) => {
                // The first reason stays: what follows a fault is only its echo.
                self.record.fault.get_or_insert(fault);
                self.record.torque = TorqueTerms::zero();
                self.record.task = TaskState::zero();
            }
        }
        let record = &mut self.record;
        let (wanted, gravity) = match record.fault {
            None => (record.torque.total(), record.torque.gravity),
            Some(fault) => {
                // A sensor that has lied is not believed again: the last good position holds.
                let mut frame = record.frame;
                self.watch.disbelieve(fault, &mut frame);
                (self.safe.torque(&self.arm, &frame.q, &frame.qd), self.safe.gravity(&self.arm))
            }
        };
        (record.command, record.saturated) = self.limiter.limit(&wanted, &gravity, self.settings.dt_s);
        plant.actuate(&record.command);
        record
    }

    #[inline]
    fn check(&mut self) -> Result<(), TickFault> {
        let frame = &self.record.frame;
        let known = self.record.fault.or_else(|| TickFault::of_frame(&self.arm, frame));
        known.or_else(|| self.watch.check(&self.arm, frame, self.settings.dt_s)).map_or(Ok(()), Err)
    }

    /// Estimate, then control.
    #[inline(never)]
    fn decide(&mut self) -> Result<(), TickFault> {
        let record = &mut self.record;
        let frame = &record.frame;
        let terms = ControlTerms::at(&self.arm, &frame.q, &frame.qd);
        if self.started {
            record.estimate = self.estimator.step(&EstimatorInput {
                frame,
                terms: &terms,
                tau_motor: &record.command,
                tau_friction: &(record.torque.friction + record.torque.effects),
                acceleration_command: &record.task.acceleration_command,
                dt_s: self.settings.dt_s,
            });
        } else {
            self.estimator.reset(frame, &terms);
            self.started = true;
        }
        let twist_model = self.model.step(&self.settings.impedance, &record.reference, self.settings.dt_s);
        let (compensator, bristles, dt_s) = (&self.settings.compensator, &mut self.bristles, self.settings.dt_s);
        let share = self.guard.map_or(1.0, |guard| guard.share());
        (record.torque, record.task) = self
            .controller
            .tick(&terms, &frame.q, &frame.qd, &record.reference, &twist_model, |measured, modelled, load| {
                let (q, qd_measured, qd_reference, load_nm) = (frame.q, *measured, *modelled, *load);
                let input = CompensatorInput { q, qd_measured, qd_reference, load_nm, dt_s };
                let compensation = compensator.tick(bristles, &input);
                (compensation.law_nm * share, compensation.effects_nm * share)
            })
            .map_err(|_| TickFault::TorqueNotFinite)?;
        self.watch.meant(&record.task.qd_reference, dt_s);
        if let Some(guard) = &mut self.guard {
            record.guard = guard.observe(&GuardInput {
                qd: &frame.qd,
                qd_reference: &record.task.qd_reference,
                nullspace_qd: &record.task.nullspace_qd,
                compensation: &(record.torque.friction + record.torque.effects),
                task_torque: &record.torque.task,
                nullspace_torque: &record.torque.nullspace,
                twist: &record.task.twist,
                wrench: &record.estimate.wrench_base.to_vector(),
                dt_s,
            });
        }
        Ok(())
    }
}
