//! Joint-space motions that excite what a log is to show.
//!
//! ```text
//! q(t), q̇(t), q̈(t):  0 ≤ t ≤ duration,  q twice continuously differentiable,  at rest at the envelope's centre at both ends
//! ```
//!
//! [`Excitation`] names the kinds and draws one from a seed, inside an [`Envelope`]; [`ViaPoints`] is a trajectory file.
//! Since every motion ends where it began, at rest, motions repeat as cycles and follow each other in a [`Chain`].
//! Leaves out: collisions of the arm with itself or its surroundings.

mod chain;
mod envelope;
mod kind;
mod multisine;
mod path;
mod poses;
mod profile;
mod strokes;
mod via_points;

pub use chain::Chain;
pub use envelope::Envelope;
pub use kind::Excitation;
pub use multisine::Multisine;
pub use path::Path;
pub use profile::JointProfile;
pub use via_points::ViaPoints;

use nalgebra::SVector;

/// Position, velocity and acceleration of every joint at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointState<const N: usize> {
    /// Positions (rad).
    pub q: SVector<f64, N>,
    /// Velocities [rad/s].
    pub qd: SVector<f64, N>,
    /// Accelerations [rad/s²].
    pub qdd: SVector<f64, N>,
}

impl<const N: usize> JointState<N> {
    /// At rest at q (rad).
    pub fn resting_at(q: SVector<f64, N>) -> Self {
        Self { q, qd: SVector::zeros(), qdd: SVector::zeros() }
    }
}

/// A motion of all joints that can be asked at any time.
pub trait JointTrajectory<const N: usize>: Send + Sync {
    /// Length (s).
    fn duration_s(&self) -> f64;

    /// State at `time_s` (s); before 0 and after the end the arm rests where the motion starts and ends.
    fn at(&self, time_s: f64) -> JointState<N>;
}

/// A trajectory on stamps, column by column.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Motion<const N: usize> {
    /// Stamps (s).
    pub time_s: Vec<f64>,
    /// Positions (rad).
    pub q: Vec<SVector<f64, N>>,
    /// Velocities [rad/s].
    pub qd: Vec<SVector<f64, N>>,
    /// Accelerations [rad/s²].
    pub qdd: Vec<SVector<f64, N>>,
}

impl<const N: usize> Motion<N> {
    /// The trajectory at the stamps.
    pub fn sampled(trajectory: &dyn JointTrajectory<N>, time_s: Vec<f64>) -> Self {
        let states: Vec<JointState<N>> = time_s.iter().map(|&t| trajectory.at(t)).collect();
        Self {
            q: states.iter().map(|state| state.q).collect(),
            qd: states.iter().map(|state| state.qd).collect(),
            qdd: states.iter().map(|state| state.qdd).collect(),
            time_s,
        }
    }

    /// The whole trajectory at a constant rate (Hz).
    pub fn at_rate(trajectory: &dyn JointTrajectory<N>, rate_hz: f64) -> Self {
        let last = (trajectory.duration_s() * rate_hz).floor() as usize;
        Self::sampled(trajectory, (0..=last).map(|k| k as f64 / rate_hz).collect())
    }
}
