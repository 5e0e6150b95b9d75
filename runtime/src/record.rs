//! Everything one tick knew, for the log.

use nalgebra::SVector;
use tribo_control::{GuardTrip, TaskState, TorqueTerms};
use tribo_robot::{Pose, SensorFrame, WrenchEstimate};

use crate::TickFault;

/// Record of one tick.
#[derive(Clone, Copy, Debug)]
pub struct TickRecord<const N: usize> {
    /// What the sensors said; its time is the time of the tick.
    pub frame: SensorFrame<N>,
    /// What the estimator made of it.
    pub estimate: WrenchEstimate,
    /// Reference pose, `base_from_flange`.
    pub reference: Pose,
    /// Task state seen by the controller; zero under a fault.
    pub task: TaskState<N>,
    /// Torque terms before limits (Nm); zero under a fault.
    pub torque: TorqueTerms<N>,
    /// Torque sent (Nm).
    pub command: SVector<f64, N>,
    /// Whether a torque limit was hit.
    pub saturated: bool,
    /// Why the friction compensation was withdrawn, if it was.
    pub guard: Option<GuardTrip>,
    /// Why the safe torque was sent, if it was.
    pub fault: Option<TickFault>,
}

impl<const N: usize> TickRecord<N> {
    /// What stands before the first tick of an arm at rest at q (rad) that is to hold `reference`.
    pub fn none_yet(q: SVector<f64, N>, reference: Pose) -> Self {
        let zero = SVector::zeros();
        Self {
            frame: SensorFrame { time_s: 0.0, q, qd: zero, tau: zero, theta: None },
            estimate: WrenchEstimate::none_yet(),
            reference,
            task: TaskState::zero(),
            torque: TorqueTerms::zero(),
            command: zero,
            saturated: false,
            guard: None,
            fault: None,
        }
    }
}
