//! Fourier series with faded ends.

use nalgebra::SVector;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;

use super::{Envelope, JointState, JointTrajectory};

/// Step (s) of the search for the largest excursion, speed and acceleration.
const SEARCH_STEP_S: f64 = 5e-3;
/// Part of the envelope that is used: the search may miss a peak by less than the rest.
const USED: f64 = 0.99;

/// Fourier series per joint (swevers1997), faded in and out:
///
/// ```text
/// q_j(t) = centre_j + w(t) Σ_k (a_jk sin kωt + b_jk cos kωt),   w = 10u³ − 15u⁴ + 6u⁵ at both ends, 1 between
/// ```
///
/// Coefficients are normal, falling as 1/k; each joint is scaled until it meets its envelope.
#[derive(Clone, Debug, PartialEq)]
pub struct Multisine<const N: usize> {
    centre_rad: SVector<f64, N>,
    /// Per harmonic, sine and cosine amplitudes of every joint (rad).
    amplitudes_rad: Vec<[SVector<f64, N>; 2]>,
    fundamental_rad_s: f64,
    fade_s: f64,
    duration_s: f64,
}

impl<const N: usize> Multisine<N> {
    /// Drawn inside the envelope: `harmonics` multiples of `fundamental_hz` (Hz) over `duration_s` (s), each fade
    /// `fade_s` (s) or half the duration.
    pub fn drawn(
        envelope: &Envelope<N>,
        fundamental_hz: f64,
        harmonics: usize,
        fade_s: f64,
        duration_s: f64,
        seed: u64,
    ) -> Self {
        let mut rng = Pcg64::seed_from_u64(seed);
        let amplitudes_rad = (1..=harmonics)
            .map(|k| {
                let mut draw = || SVector::from_fn(|_, _| rng.sample::<f64, _>(StandardNormal) / k as f64);
                [draw(), draw()]
            })
            .collect();
        let fundamental_rad_s = std::f64::consts::TAU * fundamental_hz;
        let fade_s = fade_s.min(0.5 * duration_s);
        let centre_rad = SVector::zeros();
        let mut multisine = Self { centre_rad, amplitudes_rad, fundamental_rad_s, fade_s, duration_s };
        let scale = multisine.scale_into(envelope);
        for amplitude in multisine.amplitudes_rad.iter_mut().flatten() {
            amplitude.component_mul_assign(&scale);
        }
        multisine.centre_rad = envelope.centre_rad;
        multisine
    }

    /// The largest factor per joint that keeps the envelope.
    fn scale_into(&self, envelope: &Envelope<N>) -> SVector<f64, N> {
        let mut scale = SVector::<f64, N>::repeat(f64::INFINITY);
        let steps = (self.duration_s / SEARCH_STEP_S) as usize;
        for k in 0..=steps {
            let state = self.at(k as f64 * SEARCH_STEP_S);
            let bounds = [&envelope.half_range_rad, &envelope.speed_rad_s, &envelope.acceleration_rad_s2];
            for (value, bound) in [state.q, state.qd, state.qdd].iter().zip(bounds) {
                for j in 0..N {
                    if value[j] != 0.0 {
                        scale[j] = f64::min(scale[j], USED * bound[j] / value[j].abs());
                    }
                }
            }
        }
        scale.map(|factor| if factor.is_finite() { factor } else { 0.0 })
    }

    /// Fade w and its first two derivatives.
    fn fade(&self, time_s: f64) -> [f64; 3] {
        let (edge_s, direction) =
            if 2.0 * time_s <= self.duration_s { (time_s, 1.0) } else { (self.duration_s - time_s, -1.0) };
        if edge_s >= self.fade_s || self.fade_s <= 0.0 {
            return [1.0, 0.0, 0.0];
        }
        let (u, f) = (edge_s / self.fade_s, self.fade_s);
        let v = 1.0 - u;
        let w = u * u * u * (10.0 - 15.0 * u + 6.0 * u * u);
        [w, direction * 30.0 * u * u * v * v / f, 60.0 * u * v * (1.0 - 2.0 * u) / (f * f)]
    }
}

impl<const N: usize> JointTrajectory<N> for Multisine<N> {
    fn duration_s(&self) -> f64 {
        self.duration_s
    }

    fn at(&self, time_s: f64) -> JointState<N> {
        if !(0.0..=self.duration_s).contains(&time_s) {
            return JointState::resting_at(self.centre_rad);
        }
        let (s1, c1) = (self.fundamental_rad_s * time_s).sin_cos();
        let (mut s, mut c) = (0.0, 1.0);
        let mut series = JointState::resting_at(SVector::<f64, N>::zeros());
        for (k, [a, b]) in self.amplitudes_rad.iter().enumerate() {
            // The next harmonic by the addition theorem.
            (s, c) = (s * c1 + c * s1, c * c1 - s * s1);
            let w = self.fundamental_rad_s * (k + 1) as f64;
            let wave = a * s + b * c;
            series.q += wave;
            series.qd += (a * c - b * s) * w;
            series.qdd -= wave * (w * w);
        }
        let [f, fd, fdd] = self.fade(time_s);
        JointState {
            q: self.centre_rad + series.q * f,
            qd: series.qd * f + series.q * fd,
            qdd: series.qdd * f + series.qd * (2.0 * fd) + series.q * fdd,
        }
    }
}
