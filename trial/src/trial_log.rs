//! What a trial leaves behind.

use nalgebra::{SVector, Vector3, Vector6};
use tribo_runtime::TickRecord;

/// Decimated record of one trial, one row per sample; what the grey box identifies from and the views draw.
///
/// Values have single precision, in memory as on disk, so that a resumed campaign computes with the same bits.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrialLog<const N: usize> {
    /// Sample period (s).
    pub period_s: f64,
    /// Time since the start of the judged part (s); negative during the pre-roll.
    pub time_s: Vec<f64>,
    /// Measured joint positions (rad).
    pub q: Vec<SVector<f64, N>>,
    /// Measured joint velocities [rad/s].
    pub qd: Vec<SVector<f64, N>>,
    /// Motor torque sent (Nm).
    pub tau_command: Vec<SVector<f64, N>>,
    /// Compensation of the friction law in it (Nm); what is believed beyond the law is not to be identified, and left out.
    pub tau_friction: Vec<SVector<f64, N>>,
    /// Task torque in it (Nm).
    pub tau_task: Vec<SVector<f64, N>>,
    /// Null-space torque in it (Nm).
    pub tau_nullspace: Vec<SVector<f64, N>>,
    /// Gravity torque in it (Nm).
    pub tau_gravity: Vec<SVector<f64, N>>,
    /// Coriolis torque in it (Nm).
    pub tau_coriolis: Vec<SVector<f64, N>>,
    /// Estimated wrench `[moment; force]` [Nm; N], base axes.
    pub wrench: Vec<Vector6<f64>>,
    /// Standard deviation of the estimated wrench `[moment; force]` [Nm; N].
    pub wrench_sd: Vec<Vector6<f64>>,
    /// Reference position of the flange (m), base axes.
    pub reference_position: Vec<Vector3<f64>>,
    /// Pose error `[log(R R_dᵀ); p − p_d]` [rad; m], base axes.
    pub error: Vec<Vector6<f64>>,
}

impl<const N: usize> TrialLog<N> {
    /// Number of samples.
    pub fn len(&self) -> usize {
        self.time_s.len()
    }

    /// Whether there are no samples.
    pub fn is_empty(&self) -> bool {
        self.time_s.is_empty()
    }
}

impl<const N: usize> TrialLog<N> {
    /// An empty log with room for `samples` of period `period_s` (s).
    pub fn with_capacity(samples: usize, period_s: f64) -> Self {
        Self {
            period_s,
            time_s: Vec::with_capacity(samples),
            q: Vec::with_capacity(samples),
            qd: Vec::with_capacity(samples),
            tau_command: Vec::with_capacity(samples),
            tau_friction: Vec::with_capacity(samples),
            tau_task: Vec::with_capacity(samples),
            tau_nullspace: Vec::with_capacity(samples),
            tau_gravity: Vec::with_capacity(samples),
            tau_coriolis: Vec::with_capacity(samples),
            wrench: Vec::with_capacity(samples),
            wrench_sd: Vec::with_capacity(samples),
            reference_position: Vec::with_capacity(samples),
            error: Vec::with_capacity(samples),
        }
    }

    /// Appends one tick, every value rounded to single precision.
    pub fn push(&mut self, time_s: f64, record: &TickRecord<N>) {
        self.time_s.push(time_s);
        self.q.push(single(&record.frame.q));
        self.qd.push(single(&record.frame.qd));
        self.tau_command.push(single(&record.command));
        self.tau_friction.push(single(&record.torque.friction));
        self.tau_task.push(single(&record.torque.task));
        self.tau_nullspace.push(single(&record.torque.nullspace));
        self.tau_gravity.push(single(&record.torque.gravity));
        self.tau_coriolis.push(single(&record.torque.coriolis));
        self.wrench.push(single(&record.estimate.wrench_base.to_vector()));
        self.wrench_sd.push(single(&record.estimate.covariance.diagonal().map(|variance| variance.max(0.0).sqrt())));
        self.reference_position.push(single(&record.reference.translation.vector));
        self.error.push(single(&record.task.error));
    }
}

/// Rounds to 24 bits: a ten-millionth of the value, far below any sensor, for half the size on disk.
#[allow(clippy::cast_possible_truncation)]
fn single<const R: usize>(x: &SVector<f64, R>) -> SVector<f64, R> {
    x.map(|value| f64::from(value as f32))
}
