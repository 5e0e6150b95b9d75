//! A trial's log in columns.

use nalgebra::{SVector, Vector3, Vector6};
use tribo_friction::identify::SavitzkyGolay;
use tribo_robot::{Arm, Kinematics, rnea};
use tribo_trial::TrialLog;

/// The log of a trial of an arm with any number of joints, and what the views derive from it. Quantities of joints are
/// `[joint][row]`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TrialColumns {
    /// Time since the start of the judged part (s); negative during the pre-roll.
    pub time_s: Vec<f64>,
    /// Measured joint positions (rad).
    pub q: Vec<Vec<f64>>,
    /// Motor torque sent (Nm).
    pub tau_command: Vec<Vec<f64>>,
    /// Compensation of the friction law in it (Nm).
    pub tau_friction: Vec<Vec<f64>>,
    /// Task torque in it (Nm).
    pub tau_task: Vec<Vec<f64>>,
    /// Null-space torque in it (Nm).
    pub tau_nullspace: Vec<Vec<f64>>,
    /// Gravity torque in it (Nm).
    pub tau_gravity: Vec<Vec<f64>>,
    /// Coriolis torque in it (Nm).
    pub tau_coriolis: Vec<Vec<f64>>,
    /// Estimated wrench `[moment; force]` [Nm; N], base axes.
    pub wrench: Vec<Vector6<f64>>,
    /// Standard deviation of the estimated wrench `[moment; force]` [Nm; N].
    pub wrench_sd: Vec<Vector6<f64>>,
    /// Reference position of the flange (m), base axes.
    pub reference_position: Vec<Vector3<f64>>,
    /// Pose error `[log(R R_dᵀ); p − p_d]` [rad; m], base axes.
    pub error: Vec<Vector6<f64>>,
    /// Velocity from the measured positions without delay (rad/s).
    pub qd: Vec<Vec<f64>>,
    /// Torque that the controller's rigid-body model leaves unexplained: `command − rnea(q, qd, qdd)` (Nm). In free motion
    /// that is the friction.
    pub friction_torque: Vec<Vec<f64>>,
    /// The arm as points (m), base axes: base, origins of the link frames, flange; one row per sample.
    pub skeleton: Vec<Vec<Vector3<f64>>>,
}

/// Half-width of the Savitzky–Golay window (samples of 10 ms).
const HALF_WIDTH: usize = 8;

/// The arm as points (m), base axes: base, origins of the link frames, flange.
pub fn skeleton<const N: usize>(arm: &Arm<N>, q: &SVector<f64, N>) -> Vec<Vector3<f64>> {
    let at = Kinematics::at(arm, q);
    let mut points = vec![Vector3::zeros()];
    points.extend((0..N).map(|k| at.link(arm, k).1));
    points.push(at.flange_origin);
    points
}

impl TrialColumns {
    /// The columns of a log; `arm` is what the controller believed.
    pub fn of<const N: usize>(log: &TrialLog<N>, arm: &Arm<N>) -> Self {
        let columns = |rows: &[SVector<f64, N>]| -> Vec<Vec<f64>> {
            (0..N).map(|j| rows.iter().map(|row| row[j]).collect()).collect()
        };
        let filter = SavitzkyGolay { half_width: HALF_WIDTH };
        let derivative = |x: &[Vec<f64>]| -> Vec<Vec<f64>> {
            x.iter().map(|column| filter.derivative(column, log.period_s)).collect()
        };
        let q = columns(&log.q);
        let qd = derivative(&q);
        let qdd = derivative(&qd);
        let at = |x: &[Vec<f64>], k: usize| SVector::<f64, N>::from_fn(|j, _| x[j][k]);
        let unexplained: Vec<SVector<f64, N>> =
            (0..log.len()).map(|k| log.tau_command[k] - rnea(arm, &log.q[k], &at(&qd, k), &at(&qdd, k))).collect();
        Self {
            time_s: log.time_s.clone(),
            q,
            tau_command: columns(&log.tau_command),
            tau_friction: columns(&log.tau_friction),
            tau_task: columns(&log.tau_task),
            tau_nullspace: columns(&log.tau_nullspace),
            tau_gravity: columns(&log.tau_gravity),
            tau_coriolis: columns(&log.tau_coriolis),
            wrench: log.wrench.clone(),
            wrench_sd: log.wrench_sd.clone(),
            reference_position: log.reference_position.clone(),
            error: log.error.clone(),
            qd,
            friction_torque: columns(&unexplained),
            skeleton: log.q.iter().map(|q| skeleton(arm, q)).collect(),
        }
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.time_s.len()
    }

    /// Whether there are no samples.
    pub fn is_empty(&self) -> bool {
        self.time_s.is_empty()
    }

    /// Number of joints.
    pub fn joints(&self) -> usize {
        self.q.len()
    }
}
