//! A wrench estimator behind the sensors of an arm that somebody else drives: a log, a topic.

use nalgebra::{SVector, Vector6};
use tribo_friction::{Bristles, Compensator, CompensatorInput};
use tribo_robot::{Arm, ControlTerms, EstimatorInput, SensorFrame, WrenchEstimate, WrenchEstimator};

/// Time after a beginning in which nobody should look at the wrench (s): the estimator is still forgetting its start.
pub const SETTLE_S: f64 = 0.5;

/// Gaps up to this many periods are bridged: a busy computer skips a few samples at a time.
pub const LONGEST_GAP_PERIODS: f64 = 20.0;

/// The wrench from measurements alone.
///
/// ```text
/// tau_motor_k = (tau_k + tau_{k-1})/2 - effects(q_k, qd_k, C qd + g),   tau_friction_k = law(qd_k), or what the controller tells
/// h_k = estimator(q_k, qd_k, tau_motor_k, tau_friction_k, t_k - t_{k-1})
/// ```
///
/// tau, on the same side of the gears as the arm believed, holds the torque that compensates friction, if there is any. Friction that grows
/// with the load takes gravity and Coriolis torque as the load. Allocates nothing in [`Self::begin`] and [`Self::step`].
/// Leaves out: gaps in the samples, after which somebody has to begin anew; a wish of the controller (its acceleration is zero).
#[derive(Clone, Debug)]
pub struct MeasuredWrench<const N: usize, E> {
    arm: Arm<N>,
    compensator: Compensator<N>,
    estimator: E,
    bristles: Bristles<N>,
    begun_s: f64,
    last_s: f64,
    last_tau: SVector<f64, N>,
}

impl<const N: usize, E: WrenchEstimator<N>> MeasuredWrench<N, E> {
    /// An estimator that has seen nothing; `compensator` holds law and effects believed.
    pub fn new(arm: Arm<N>, compensator: Compensator<N>, estimator: E) -> Self {
        let (bristles, last_tau) = (Bristles::default(), SVector::zeros());
        Self { arm, compensator, estimator, bristles, begun_s: 0.0, last_s: 0.0, last_tau }
    }

    /// Forgets what was and starts at this sample.
    pub fn begin(&mut self, frame: &SensorFrame<N>) {
        self.bristles = Bristles::default();
        (self.begun_s, self.last_s, self.last_tau) = (frame.time_s, frame.time_s, frame.tau);
        self.estimator.reset(frame, &ControlTerms::at(&self.arm, &frame.q, &frame.qd));
    }

    /// Takes the next sample. `told_nm` is the torque that the controller added for friction, where it tells; without, the law believed.
    pub fn step(&mut self, frame: &SensorFrame<N>, told_nm: Option<&SVector<f64, N>>) -> WrenchEstimate {
        let terms = ControlTerms::at(&self.arm, &frame.q, &frame.qd);
        let (tau_motor, dt_s) = ((frame.tau + self.last_tau) * 0.5, frame.time_s - self.last_s);
        (self.last_s, self.last_tau) = (frame.time_s, frame.tau);
        let (q, qd_measured, qd_reference, load_nm) = (frame.q, frame.qd, frame.qd, terms.bias_nm());
        let input = CompensatorInput { q, qd_measured, qd_reference, load_nm, dt_s };
        let compensation = self.compensator.tick(&mut self.bristles, &input);
        // What is no friction is nobody's band.
        let tau_motor = tau_motor - compensation.effects_nm;
        let tau_friction = told_nm.map_or(compensation.law_nm, |told| told - compensation.effects_nm);
        self.estimator.step(&EstimatorInput {
            frame,
            terms: &terms,
            tau_motor: &tau_motor,
            tau_friction: &tau_friction,
            acceleration_command: &Vector6::zeros(),
            dt_s,
        })
    }

    /// Whether the last sample is late enough after the first for its wrench to be looked at.
    pub fn has_settled(&self) -> bool {
        self.last_s - self.begun_s >= SETTLE_S
    }

    /// Delay (s) of the wrench at low frequency.
    pub fn delay_s(&self) -> f64 {
        self.estimator.delay_s()
    }
}
