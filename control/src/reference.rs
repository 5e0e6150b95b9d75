//! The exciting Cartesian trajectory.

use nalgebra::{SVector, Vector3};
use tribo_robot::{Pose, sines, so3};

/// Phases of the reference run that all tables of the documentation use (rad), x y z then rotations.
pub const PAPER_PHASES_RAD: [f64; 6] = [3.21587, 5.97194, 0.905782, 5.96054, 1.959295, 2.659839];

/// Variable-frequency sinusoids about a fixed pose (roveda2022 eq. 35), behind a pre-roll:
///
/// ```text
/// x_i(t) = x0_i + r(t) A_i cos(2π F1_i (1 + cos(2π F2 t)) t + φ_i),    t = time − pre-roll
/// ```
///
/// r is 0 during the hold, rises as a quintic until t = 0 and stays 1; the phase is evaluated at negative t meanwhile.
/// Components 0–2 are the position (m) and 3–5 the rotation vector (rad) applied before R0, base axes.
/// Note: F2 is the same for all axes, so the instantaneous frequency is zero on every axis at t = 13.9 s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SinusoidReference {
    /// The pose x0 about which the arm moves, `base_from_flange`.
    pub centre: Pose,
    /// Amplitudes A: three in m, three in rad.
    pub amplitude: [f64; 6],
    /// Frequencies F1 (Hz).
    pub f1_hz: [f64; 6],
    /// Modulation frequency F2 (Hz).
    pub f2_hz: f64,
    /// Phases φ (rad).
    pub phase_rad: [f64; 6],
    /// Time at rest before the ramp (s).
    pub hold_s: f64,
    /// Length of the amplitude ramp (s).
    pub ramp_s: f64,
    /// Length of the trajectory after the pre-roll, T (s).
    pub duration_s: f64,
}

impl SinusoidReference {
    /// The paper's frequencies and amplitudes (25 mm, 5°, T = 30 s) with a pre-roll of 0.5 s hold and 2.5 s ramp.
    pub fn paper(centre: Pose, phase_rad: [f64; 6]) -> Self {
        let five_degrees = 5f64.to_radians();
        Self {
            centre,
            amplitude: [0.025, 0.025, 0.025, five_degrees, five_degrees, five_degrees],
            f1_hz: [0.05, 0.075, 0.05, 0.075, 0.1, 0.1],
            f2_hz: 0.015,
            phase_rad,
            hold_s: 0.5,
            ramp_s: 2.5,
            duration_s: 30.0,
        }
    }

    /// The same path, `factor` times as long, through the same orientations.
    pub fn scaled(mut self, factor: f64) -> Self {
        self.amplitude[..3].iter_mut().for_each(|amplitude_m| *amplitude_m *= factor);
        self
    }

    /// The same pre-roll and duration at a fixed set-point.
    pub fn fixed(centre: Pose) -> Self {
        Self { amplitude: [0.0; 6], ..Self::paper(centre, [0.0; 6]) }
    }

    /// Length of the pre-roll (s).
    pub fn pre_roll_s(&self) -> f64 {
        self.hold_s + self.ramp_s
    }

    /// Length of a whole trial (s).
    pub fn total_s(&self) -> f64 {
        self.pre_roll_s() + self.duration_s
    }

    /// Reference pose at `time_s` (s) since the start of the pre-roll.
    #[inline]
    pub fn at(&self, time_s: f64) -> Pose {
        let t = time_s - self.pre_roll_s();
        let ramp = quintic((time_s - self.hold_s) / self.ramp_s);
        let turn = 2.0 * std::f64::consts::PI;
        let modulation = 1.0 + (turn * self.f2_hz * t).cos();
        let phases = SVector::<f64, 6>::from_fn(|i, _| turn * self.f1_hz[i] * modulation * t + self.phase_rad[i]);
        let cosines = sines(&phases).map(|(_, cos)| cos);
        let x: [f64; 6] = std::array::from_fn(|i| ramp * self.amplitude[i] * cosines[i]);
        let rotation = so3::exp(&Vector3::new(x[3], x[4], x[5])) * self.centre.rotation.matrix();
        let position = self.centre.translation.vector + Vector3::new(x[0], x[1], x[2]);
        Pose::from_parts(position.into(), nalgebra::Rotation3::from_matrix_unchecked(rotation))
    }
}

/// `10 s³ − 15 s⁴ + 6 s⁵` on [0, 1], flat outside: position, speed and acceleration start and end smoothly.
#[inline]
fn quintic(s: f64) -> f64 {
    let s = s.clamp(0.0, 1.0);
    s * s * s * (10.0 + s * (6.0 * s - 15.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn starts_at_the_centre_and_is_the_papers_formula_after_the_pre_roll() {
        let reference = SinusoidReference::paper(Pose::identity(), PAPER_PHASES_RAD);
        assert!((reference.at(0.3).to_homogeneous() - Pose::identity().to_homogeneous()).amax() < 1e-15);
        let t: f64 = 7.3;
        let turn = 2.0 * std::f64::consts::PI;
        let x = 0.025 * (turn * 0.05 * (1.0 + (turn * 0.015 * t).cos()) * t + PAPER_PHASES_RAD[0]).cos();
        assert!((reference.at(t + 3.0).translation.x - x).abs() < 1e-15);
    }

    #[test]
    fn has_no_jump_in_position_or_speed() {
        let reference = SinusoidReference::paper(Pose::identity(), PAPER_PHASES_RAD);
        let dt = 1e-3;
        let mut last_speed = 0.0;
        for k in 1..33_000 {
            let (a, b) = (reference.at((k - 1) as f64 * dt), reference.at(k as f64 * dt));
            let speed = (b.translation.vector - a.translation.vector).norm() / dt;
            assert!(speed < 0.1 && (speed - last_speed).abs() < 5e-4, "tick {k}: {speed}");
            last_speed = speed;
        }
    }

    /// The common modulation stops every axis at th·sin(th) = 1 + cos(th), t = 13.9 s.
    #[test]
    fn all_axes_stop_together_near_fourteen_seconds() {
        let reference = SinusoidReference::paper(Pose::identity(), PAPER_PHASES_RAD);
        let speed = |t: f64| {
            let (a, b) = (reference.at(t + 3.0 - 5e-4), reference.at(t + 3.0 + 5e-4));
            (b.translation.vector - a.translation.vector).norm() / 1e-3
        };
        let slowest = (1200..1600).map(|k| k as f64 * 0.01).min_by(|a, b| speed(*a).total_cmp(&speed(*b))).unwrap();
        assert!((slowest - 13.9).abs() < 0.15, "{slowest}");
    }
}
