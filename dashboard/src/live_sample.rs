//! One state of a robot that is watched while it lives.

/// What the robot sent, and what was made of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LiveSample {
    /// The robot's clock (s).
    pub time_s: f64,
    /// Joint positions (rad).
    pub q_rad: Vec<f64>,
    /// Joint velocities (rad/s).
    pub dq_rad_s: Vec<f64>,
    /// Measured joint torques (Nm).
    pub tau_j_nm: Vec<f64>,
    /// Our estimate of the wrench by the robot on the environment, base axes: force (N), then moment (Nm); none while it settles.
    pub wrench: Option<[f64; 6]>,
    /// Lower and upper end of its 95 % band.
    pub limits95: Option<[[f64; 6]; 2]>,
    /// The robot's own estimate, likewise.
    pub own_wrench: [f64; 6],
    /// Time since the state before, by the clock of this computer (ms).
    pub since_last_ms: f64,
    /// Time that our estimate took (µs).
    pub estimator_us: f64,
}
