//! One period of the control loop.

use nalgebra::{SVector, Vector6};
use tribo_control::{
    DampedPseudoInverse, ImpedanceController, ImpedanceSettings, ReferenceModel, SafeTorque, SinusoidReference,
    TaskState, TorqueLimiter, TorqueTerms,
};
use tribo_friction::{Bristles, Compensator, CompensatorInput};
use tribo_robot::{Arm, ControlTerms, EstimatorInput, Plant, SensorFrame, WrenchEstimate, WrenchEstimator};

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
    applied: Option<Applied<N>>,
    estimate: WrenchEstimate,
    fault: Option<TickFault>,
}

/// What acted during the period before this tick.
#[derive(Clone, Copy, Debug)]
struct Applied<const N: usize> {
    tau: SVector<f64, N>,
    friction: SVector<f64, N>,
    acceleration: Vector6<f64>,
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
            applied: None,
            estimate: WrenchEstimate::none_yet(),
            fault: None,
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
        self.fault.get_or_insert(fault);
    }

    /// One tick. No heap, no lock, no clock, no panic.
    #[inline]
    pub fn tick<P: Plant<N>>(&mut self, plant: &mut P) -> TickRecord<N> {
        let frame = plant.sense();
        let reference = self.settings.reference.at(frame.time_s);
        let decision = self.check(&frame).and_then(|()| self.decide(&frame, &reference));
        let (torque, task) = match decision {
            Ok(terms) => {
                self.safe.remember(&frame.q);
                terms
            }
            Err(fault) => {
                // The first reason stays: what follows a fault is only its echo.
                self.fault.get_or_insert(fault);
                (TorqueTerms::zero(), TaskState::zero())
            }
        };
        let wanted = match self.fault {
            None => torque.total(),
            Some(_) => self.safe.torque(&self.arm, &frame.q, &frame.qd),
        };
        let (command, saturated) = self.limiter.limit(&wanted, self.settings.dt_s);
        plant.actuate(&command);
        self.applied = Some(Applied {
            tau: command,
            friction: torque.friction + torque.effects,
            acceleration: task.acceleration_command,
        });
        TickRecord { frame, estimate: self.estimate, reference, task, torque, command, saturated, fault: self.fault }
    }

    #[inline]
    fn check(&self, frame: &SensorFrame<N>) -> Result<(), TickFault> {
        self.fault.or_else(|| TickFault::of_frame(&self.arm, frame)).map_or(Ok(()), Err)
    }

    /// Estimate, then control.
    #[inline]
    fn decide(
        &mut self,
        frame: &SensorFrame<N>,
        reference: &tribo_robot::Pose,
    ) -> Result<(TorqueTerms<N>, TaskState), TickFault> {
        let terms = ControlTerms::at(&self.arm, &frame.q, &frame.qd);
        match &self.applied {
            Some(applied) => {
                self.estimate = self.estimator.step(&EstimatorInput {
                    frame,
                    terms: &terms,
                    tau_motor: &applied.tau,
                    tau_friction: &applied.friction,
                    acceleration_command: &applied.acceleration,
                    dt_s: self.settings.dt_s,
                });
            }
            None => self.estimator.reset(frame, &terms),
        }
        let twist_model = self.model.step(&self.settings.impedance, reference, self.settings.dt_s);
        let (compensator, bristles, dt_s) = (&self.settings.compensator, &mut self.bristles, self.settings.dt_s);
        self.controller
            .tick(&terms, &frame.q, &frame.qd, reference, &twist_model, |measured, modelled, load| {
                let (q, qd_measured, qd_reference, load_nm) = (frame.q, *measured, *modelled, *load);
                let input = CompensatorInput { q, qd_measured, qd_reference, load_nm, dt_s };
                let compensation = compensator.tick(bristles, &input);
                (compensation.law_nm, compensation.effects_nm)
            })
            .map_err(|_| TickFault::TorqueNotFinite)
    }
}
