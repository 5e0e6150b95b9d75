//! When a trial must be stopped.

use nalgebra::Vector6;
use serde::{Deserialize, Serialize};
use tribo_control::GuardTrip;
use tribo_runtime::{TickFault, TickRecord};

/// Limits whose violation ends a trial with a penalty (the paper names them and gives no numbers).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PenaltyLimits {
    /// Linear acceleration of the tool [m/s²].
    pub acceleration_m_s2: f64,
    /// Angular acceleration of the tool [rad/s²].
    pub acceleration_rad_s2: f64,
    /// Position error of the tool (m).
    pub error_m: f64,
    /// Orientation error of the tool (rad).
    pub error_rad: f64,
    /// Null-space joint speed [rad/s]: the elbow runs away while the tool stays on its path.
    pub nullspace_speed_rad_s: f64,
    /// Time a torque limit may be held (s).
    pub saturation_s: f64,
    /// Cut-off of the filter on the acceleration (Hz).
    pub acceleration_cutoff_hz: f64,
}

impl PenaltyLimits {
    /// The same for a tool that goes `factor` times as far in the same time: its acceleration and its error do too. A shorter path keeps
    /// the limits: noise and stick-slip do not shrink with it.
    pub fn for_path(self, factor: f64) -> Self {
        let factor = factor.max(1.0);
        Self { acceleration_m_s2: factor * self.acceleration_m_s2, error_m: factor * self.error_m, ..self }
    }
}

impl Default for PenaltyLimits {
    fn default() -> Self {
        Self {
            acceleration_m_s2: 5.0,
            acceleration_rad_s2: 30.0,
            error_m: 0.05,
            error_rad: 0.25,
            nullspace_speed_rad_s: 1.0,
            saturation_s: 0.05,
            acceleration_cutoff_hz: 15.0,
        }
    }
}

/// Why a trial was stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, thiserror::Error)]
#[serde(rename_all = "snake_case")]
pub enum AbortReason {
    /// Tool acceleration above its limit.
    #[error("tool acceleration")]
    Acceleration,
    /// Tool error above its limit.
    #[error("tool error")]
    Error,
    /// A joint left its position limits.
    #[error("joint limit")]
    JointLimit,
    /// A joint exceeded its speed limit.
    #[error("joint speed")]
    JointSpeed,
    /// A torque limit was held for too long.
    #[error("torque saturation")]
    TorqueSaturation,
    /// The null-space motion ran away.
    #[error("null-space run-away")]
    NullspaceRunaway,
    /// The guard withdrew the compensator: it put in more energy than friction took.
    #[error("over-compensation, or a push: energy surplus")]
    EnergySurplus,
    /// The guard withdrew the compensator: it fed an oscillation.
    #[error("over-compensation, or a push: oscillation")]
    Oscillation,
    /// The guard withdrew the compensator: a joint swung.
    #[error("over-compensation: a joint swings")]
    LimitCycle,
    /// The guard withdrew the compensator: the arm slid while the tool stayed on its path.
    #[error("over-compensation: the arm slides")]
    NullSpaceDrift,
    /// A signal was NaN or infinite.
    #[error("signal not finite")]
    NotFinite,
    /// Somebody stopped it, or something that does not depend on the parameters.
    #[error("stopped from outside")]
    Stopped,
    /// Another reason of somebody who ran the trial elsewhere.
    #[error("reported by its user")]
    Reported,
}

impl From<TickFault> for AbortReason {
    fn from(fault: TickFault) -> Self {
        match fault {
            TickFault::SensorNotFinite { .. } | TickFault::TorqueNotFinite => Self::NotFinite,
            TickFault::JointLimit { .. } => Self::JointLimit,
            TickFault::JointSpeed { .. } => Self::JointSpeed,
            // None of these depends on the parameters.
            TickFault::DeadlineMissed
            | TickFault::PlantLost
            | TickFault::Stopped
            | TickFault::ClockJumped
            | TickFault::SensorJumped { .. }
            | TickFault::SensorFrozen { .. } => Self::Stopped,
        }
    }
}

impl From<GuardTrip> for AbortReason {
    fn from(trip: GuardTrip) -> Self {
        match trip {
            GuardTrip::EnergySurplus => Self::EnergySurplus,
            GuardTrip::Oscillation => Self::Oscillation,
            GuardTrip::LimitCycle { .. } => Self::LimitCycle,
            GuardTrip::NullSpaceDrift => Self::NullSpaceDrift,
        }
    }
}

/// Watches the ticks of one trial.
#[derive(Clone, Copy, Debug)]
pub struct TrialMonitor {
    limits: PenaltyLimits,
    dt_s: f64,
    /// Share of a new sample in the filtered acceleration.
    weight: f64,
    last_twist: Option<Vector6<f64>>,
    acceleration: Vector6<f64>,
    saturated_s: f64,
}

impl TrialMonitor {
    /// A monitor for a loop of period `dt_s` (s).
    pub fn new(limits: PenaltyLimits, dt_s: f64) -> Self {
        let weight = 1.0 - (-2.0 * std::f64::consts::PI * limits.acceleration_cutoff_hz * dt_s).exp();
        Self { limits, dt_s, weight, last_twist: None, acceleration: Vector6::zeros(), saturated_s: 0.0 }
    }

    /// Judges one tick; the first violated limit, if any.
    #[inline]
    pub fn check<const N: usize>(&mut self, record: &TickRecord<N>) -> Option<AbortReason> {
        if let Some(fault) = record.fault {
            return Some(fault.into());
        }
        if let Some(trip) = record.guard {
            return Some(trip.into());
        }
        let twist = record.task.twist;
        if let Some(last) = self.last_twist {
            self.acceleration += ((twist - last) / self.dt_s - self.acceleration) * self.weight;
        }
        self.last_twist = Some(twist);
        self.saturated_s = if record.saturated { self.saturated_s + self.dt_s } else { 0.0 };
        let (rotational, linear) = (self.acceleration.fixed_rows::<3>(0), self.acceleration.fixed_rows::<3>(3));
        let (error_rad, error_m) = (record.task.error.fixed_rows::<3>(0), record.task.error.fixed_rows::<3>(3));
        let limits = &self.limits;
        // Negated comparisons: NaN counts as a violation.
        let within = |value: f64, limit: f64| value <= limit;
        if !within(linear.amax(), limits.acceleration_m_s2) || !within(rotational.amax(), limits.acceleration_rad_s2) {
            Some(AbortReason::Acceleration)
        } else if !within(error_m.amax(), limits.error_m) || !within(error_rad.amax(), limits.error_rad) {
            Some(AbortReason::Error)
        } else if self.saturated_s > limits.saturation_s {
            Some(AbortReason::TorqueSaturation)
        } else if !within(record.task.nullspace_qd.norm(), limits.nullspace_speed_rad_s) {
            Some(AbortReason::NullspaceRunaway)
        } else {
            None
        }
    }
}
