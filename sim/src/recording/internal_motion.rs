//! What moves inside the joints while the encoders follow the prescribed motion.

use nalgebra::SVector;
use tribo_friction::MAX_BRISTLES;
use tribo_robot::mass_matrix;

use super::internal::Internal;
use super::true_torque::TrueTorque;
use crate::gap::Gap;
use crate::hidden::{JointBristles, presliding_rad};
use crate::oscillator::oscillator_step;

/// Step of the integration (s): 5 kHz, a tenth of the period of the stiffest wrist.
const STEP_S: f64 = 2e-4;

/// Internal states on a fine grid, empty for joints without any:
///
/// ```text
/// bristle, each       ż = (q̇ − |q̇| z)/distance,  z(0) as given                    exact per step
/// one encoder         M_jj δ̈ + D δ̇ + K δ = tau_link(motor angles)                  exact per step
/// two encoders        D δ̇ + K δ = tau_link(link angles)                            exact per step
/// gap                 half gap × sign(tau_link), behind two lags of 4 ms
/// ```
///
/// It starts at rest: δ = tau/K. Deflections of different joints are coupled through tau_link only, not through M.
#[derive(Clone, Debug)]
pub(super) struct InternalMotion<const N: usize> {
    start_s: f64,
    bristles: [Vec<f64>; N],
    /// Bristles of parts of dry friction.
    parts: [[Vec<f64>; MAX_BRISTLES]; N],
    /// δ, δ̇, δ̈.
    deflections: [Vec<[f64; 3]>; N],
    gaps: [Vec<f64>; N],
}

impl<const N: usize> InternalMotion<N> {
    /// From `start_s` to `end_s` (s), time of the motion; bristles start at `bristles`.
    pub fn integrate(torque: &TrueTorque<'_, N>, start_s: f64, end_s: f64, bristles: &[JointBristles; N]) -> Self {
        let mut motion = Self {
            start_s,
            bristles: std::array::from_fn(|_| Vec::new()),
            parts: std::array::from_fn(|_| std::array::from_fn(|_| Vec::new())),
            deflections: std::array::from_fn(|_| Vec::new()),
            gaps: std::array::from_fn(|_| Vec::new()),
        };
        let (truth, hidden) = (torque.truth, &torque.hidden);
        let distance: [f64; N] = std::array::from_fn(|j| presliding_rad(&truth.friction.joints[j], &hidden.joints[j]));
        let loaded = (0..N).any(|j| hidden.elasticity[j].is_some() || hidden.half_gap_rad[j] > 0.0);
        let parted = hidden.joints.iter().flat_map(|effects| &effects.bristles).any(|part| part.amplitude_nm != 0.0);
        if !loaded && !parted && distance.iter().all(|&d| d == 0.0) {
            return motion;
        }

        let steps = ((end_s - start_s) / STEP_S).ceil() as usize + 1;
        let mut last_load = SVector::<f64, N>::zeros();
        let mut last_speed = SVector::<f64, N>::zeros();
        let mut gaps = [Gap::default(); N];
        for k in 0..=steps {
            let time_s = start_s + k as f64 * STEP_S;
            let state = torque.trajectory.at(time_s);
            let load = if loaded { torque.link_torque(time_s, &state) } else { SVector::zeros() };
            // Deflections by the mean load of the step.
            let inertia =
                if loaded && !torque.dual_encoder { Some(mass_matrix(&torque.link_arm, &state.q)) } else { None };
            for j in 0..N {
                let Some(spring) = hidden.elasticity[j] else { continue };
                let (stiffness, damping) = (spring.stiffness_nm_per_rad, spring.damping_nm_s_per_rad);
                let mean = 0.5 * (load[j] + last_load[j]);
                let next = match (motion.deflections[j].last(), &inertia) {
                    (None, _) => [load[j] / stiffness, 0.0, 0.0],
                    (Some(&[d, _, _]), None) => {
                        let decay = if damping > 0.0 { (-STEP_S * stiffness / damping).exp() } else { 0.0 };
                        let goal = if damping > 0.0 { mean } else { load[j] } / stiffness;
                        [goal + (d - goal) * decay, 0.0, 0.0]
                    }
                    (Some(&[d, v, _]), Some(mass)) => {
                        let m = mass[(j, j)];
                        let [d, v] = oscillator_step([d - mean / stiffness, v], stiffness / m, damping / m, STEP_S);
                        let d = d + mean / stiffness;
                        [d, v, (load[j] - damping * v - stiffness * d) / m]
                    }
                };
                motion.deflections[j].push(next);
            }
            // Gaps.
            for j in 0..N {
                let half = hidden.half_gap_rad[j];
                if half > 0.0 {
                    gaps[j] = if k == 0 { Gap::under(half, load[j]) } else { gaps[j].advanced(load[j], STEP_S) };
                    motion.gaps[j].push(gaps[j].lead_rad);
                }
            }
            // Bristles by the mean speed of the step.
            for j in 0..N {
                let speed = 0.5 * (state.qd[j] + last_speed[j]);
                if distance[j] > 0.0 {
                    let start = bristles[j].whole.unwrap_or(0.0);
                    push_bristle(&mut motion.bristles[j], start, speed, distance[j]);
                }
                for (k, part) in hidden.joints[j].bristles.iter().enumerate() {
                    if part.amplitude_nm != 0.0 {
                        push_bristle(&mut motion.parts[j][k], bristles[j].parts[k], speed, part.distance_rad);
                    }
                }
            }
            (last_load, last_speed) = (load, state.qd);
        }
        if torque.dual_encoder {
            motion.deflections.iter_mut().for_each(|deflections| differentiate(deflections));
        }
        motion
    }

    /// States at `time_s` (s), linear between grid points, constant outside.
    pub fn at(&self, time_s: f64) -> Internal<N> {
        let x = ((time_s - self.start_s) / STEP_S).max(0.0);
        let (k, u) = (x.floor() as usize, x.fract());
        let mut internal = Internal::none();
        for j in 0..N {
            let ratio = |z: &[f64]| between(z, k, u, |a, b, u| a + (b - a) * u);
            let parts = self.parts[j].each_ref().map(|z| ratio(z).unwrap_or(0.0));
            internal.bristles[j] = JointBristles { whole: ratio(&self.bristles[j]), parts };
            if let Some([d, v, a]) =
                between(&self.deflections[j], k, u, |a, b, u| std::array::from_fn(|i| a[i] + (b[i] - a[i]) * u))
            {
                internal.deflection[j] = d;
                internal.deflection_rate[j] = v;
                internal.deflection_acceleration[j] = a;
            }
            internal.gap[j] = between(&self.gaps[j], k, u, |a, b, u| a + (b - a) * u).unwrap_or(0.0);
        }
        internal
    }
}

/// Adds the bristle ratio after one more step at the mean `speed` [rad/s], the first time as it starts.
fn push_bristle(ratios: &mut Vec<f64>, start: f64, speed: f64, distance_rad: f64) {
    let next = ratios.last().map_or(start, |z| {
        let sign = if speed == 0.0 { 0.0 } else { speed.signum() };
        sign + (z - sign) * (-speed.abs() * STEP_S / distance_rad).exp()
    });
    ratios.push(next);
}

/// The value a share u of a step after grid point k, if there is any.
fn between<T: Copy>(values: &[T], k: usize, u: f64, blend: impl Fn(T, T, f64) -> T) -> Option<T> {
    let last = *values.last()?;
    let (a, b) = (values.get(k).copied().unwrap_or(last), values.get(k + 1).copied().unwrap_or(last));
    Some(blend(a, b, u))
}

/// First and second differences of δ in the place of its derivatives.
fn differentiate(deflections: &mut [[f64; 3]]) {
    for k in 1..deflections.len().saturating_sub(1) {
        let (before, here, after) = (deflections[k - 1][0], deflections[k][0], deflections[k + 1][0]);
        deflections[k][1] = (after - before) / (2.0 * STEP_S);
        deflections[k][2] = (after - 2.0 * here + before) / (STEP_S * STEP_S);
    }
}
