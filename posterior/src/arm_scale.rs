//! How large effects of an arm usually are, read off its limits, its links and where its log goes.

use nalgebra::SVector;
use tribo_regression::RegressionData;
use tribo_sim::{SoftFriction, TorqueSide};

use crate::prior::{ArmScale, MOST_WAVES};

impl ArmScale {
    /// What data say of an arm: torque and speed limits, where they are no fantasy, and its own weight.
    pub fn of<const N: usize>(data: &RegressionData<N>) -> Self {
        let limits = &data.nominal.arm.limits;
        let own_kg: f64 = data.nominal.arm.links.iter().map(|link| link.mass_kg.max(0.2)).sum();
        let largest = |of: &[f64]| of.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
        let seen = (0..N).map(|j| largest(&data.measured_nm[j])).fold(0.0, f64::max);
        // No arm has the same motor in every joint: such limits stand for nothing.
        let same = limits.tau_max_nm.max() <= 1.01 * limits.tau_max_nm.min();
        let torque_nm = (0..N)
            .map(|j| if same && N > 1 { STRONGEST_OVER_SEEN * seen * taper(j, N) } else { limits.tau_max_nm[j] })
            .map(|torque: f64| torque.max(1e-3))
            .collect();
        let speed_rad_s: Vec<f64> =
            (0..N).map(|j| if limits.qd_max_rad_s[j] <= 20.0 { limits.qd_max_rad_s[j] } else { 3.0 }).collect();
        let shown = |j: usize| largest(&data.qd[j]).max(LEAST_SHOWN * speed_rad_s[j]);
        let range_rad = |q: &[f64]| {
            q.iter().fold(f64::NEG_INFINITY, |a: f64, x| a.max(*x))
                - q.iter().fold(f64::INFINITY, |a: f64, x| a.min(*x))
        };
        let slowest = |j: usize| (1..=MOST_WAVES).find(|waves| *waves as f64 * range_rad(&data.q[j]) >= TURN_RAD);
        Self {
            torque_nm,
            soft_damping_nm_s: soft_damping(data),
            slowest_ripple: (0..N).map(slowest).collect(),
            shown_speed_rad_s: (0..N).map(shown).collect(),
            speed_rad_s,
            rated_payload_kg: 0.3 * own_kg,
            link_side: data.nominal.torque_side == TorqueSide::Link,
        }
    }
}

/// Torque per speed of [`SoftFriction`] in the middle of the log [Nm s/rad].
fn soft_damping<const N: usize>(data: &RegressionData<N>) -> Vec<f64> {
    let middle = SVector::<f64, N>::from_fn(|j, _| data.q[j].get(data.q[j].len() / 2).copied().unwrap_or(0.0));
    let without_limit = SVector::repeat(f64::INFINITY);
    let soft = SoftFriction::of(&data.nominal.arm, &middle, without_limit);
    let damping = soft.map(|soft| soft.torque(&SVector::repeat(1.0), &SVector::zeros()));
    damping.map_or_else(|| vec![1.0; N], |damping| damping.iter().map(|damping| damping.max(1e-3)).collect())
}

/// Least speed that a joint is taken to have shown, over its largest: one that stands still has no shape to tell.
const LEAST_SHOWN: f64 = 0.1;
/// A full turn (rad).
const TURN_RAD: f64 = 2.0 * std::f64::consts::PI;
/// Largest torque that a joint can have over the largest that a log shows: logs of a moving arm use half.
const STRONGEST_OVER_SEEN: f64 = 3.0;

/// Torque limit of a joint over that of the strongest: the wrists of Panda, LWR, iiwa, Gen3 and UR have a seventh to a fourth.
fn taper(joint: usize, joints: usize) -> f64 {
    match joint as f64 / (joints - 1) as f64 {
        x if x < 0.25 => 1.0,
        x if x < 0.7 => 0.55,
        _ => 0.2,
    }
}
