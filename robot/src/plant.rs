//! What a control loop can see of a robot.

use nalgebra::SVector;

/// One sample of the joint sensors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorFrame<const N: usize> {
    /// Time of the sample since the start of the trial (s).
    pub time_s: f64,
    /// Measured joint positions (rad).
    pub q: SVector<f64, N>,
    /// Measured (filtered) joint velocities [rad/s].
    pub qd: SVector<f64, N>,
    /// Measured joint torques (Nm) on the side of the gears that the model's `torque_side` states.
    pub tau: SVector<f64, N>,
    /// Measured motor positions through the gears (rad), of robots with two encoders per joint; `q` is then the link's.
    pub theta: Option<SVector<f64, N>>,
}

/// A robot gives no more samples: its connection is lost, or it has ended the motion itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the robot gives no more samples")]
pub struct PlantLost;

/// A robot that can be sensed and driven by joint torque, simulated or real. `runtime` knows nothing else of it.
pub trait Plant<const N: usize> {
    /// Reads the joint sensors.
    ///
    /// # Errors
    ///
    /// [`PlantLost`] where no sample will come any more; the plant itself knows why.
    fn sense(&mut self) -> Result<SensorFrame<N>, PlantLost>;

    /// Applies the motor torque `tau_nm` (Nm) until the next call, one control period later.
    fn actuate(&mut self, tau_nm: &SVector<f64, N>);
}
