//! Joints whose torque has the opposite sign, as the work of friction tells.
//!
//! ```text
//! ρ±_j = Σ_w (r_w − r̄) Δq_w / Σ_w |(r_w − r̄) Δq_w|,   r_w: mean of ±τ_j − g_j(q) over a window,   Δq_w: the angle turned in it
//! r̄ = Σ_w r_w |Δq_w| / Σ_w |Δq_w|
//! ```
//!
//! In free motion friction takes energy, whatever its law; offsets, gravity, inertia and springs give back what they take, and noise of torques
//! has nothing to do with the angle turned. So ρ₊ is near 1 of a joint with friction (at least .5 of the laws and arms that were simulated), within .3 of
//! zero without, and ρ₋ at most .12. A joint that moves too little for least squares to tell its sign is told apart all the same.

use nalgebra::SVector;
use tribo_logs::recognise::{Fault, Remark};
use tribo_logs::{RobotLog, row};
use tribo_robot::{Arm, gravity_torque};

/// Length of a window (s): velocities of a trial hardly change in it, noise does.
const WINDOW_S: f64 = 0.1;
/// Least ρ₋ of a joint whose sign is turned, and its largest ρ₊.
const TAKES: f64 = 0.7;
const DOES_NOT_TAKE: f64 = 0.3;

/// The remark on joints whose torque takes energy only with the opposite sign; `log` holds the torque that acted as `tau_j_nm`, and
/// is looked at from row `from` on.
pub fn turned_signs<const N: usize>(arm: &Arm<N>, log: &RobotLog, from: usize) -> Option<Remark> {
    let [as_it_is, turned] = shares_of_work(arm, log, from);
    let joints: Vec<usize> = (0..N).filter(|&j| turned[j] > TAKES && as_it_is[j] < DOES_NOT_TAKE).collect();
    if joints.is_empty() {
        return None;
    }
    let listed = |of: &[f64; N]| joints.iter().map(|&j| format!("{:.2}", of[j])).collect::<Vec<_>>().join(", ");
    let columns = |prefix: &str| joints.iter().map(|j| format!("{prefix}_{j}")).collect::<Vec<_>>().join(", ");
    Some(Remark::refuse(
        Fault::TorqueOrPositionSign,
        joints.clone(),
        format!(
            "torque or position of {} has the opposite sign: friction takes energy, and the torque beside gravity does so only with it (net over total work {}, with \
             the opposite sign {})",
            arm.joint_names.several(&joints),
            listed(&as_it_is),
            listed(&turned)
        ),
        format!("multiply {}, or {} and {}, by -1", columns("tau_J"), columns("q"), columns("dq")),
    ))
}

/// ρ₊ and ρ₋ of each joint; zero of one that does no work.
fn shares_of_work<const N: usize>(arm: &Arm<N>, log: &RobotLog, from: usize) -> [[f64; N]; 2] {
    let windows = windows(arm, log, from);
    [1.0, -1.0].map(|sign| {
        std::array::from_fn(|j| {
            let beside_gravity = |window: &Window<N>| sign * window.torque_nm[j] - window.gravity_nm[j];
            let mut sums = [0.0; 2];
            for window in &windows {
                sums[0] += beside_gravity(window) * window.turned_rad[j].abs();
                sums[1] += window.turned_rad[j].abs();
            }
            let mean = if sums[1] > 0.0 { sums[0] / sums[1] } else { 0.0 };
            let works = windows.iter().map(|window| (beside_gravity(window) - mean) * window.turned_rad[j]);
            let (net, total) = works.fold((0.0, 0.0), |(net, total), work| (net + work, total + work.abs()));
            if total > 0.0 { net / total } else { 0.0 }
        })
    })
}

/// Means of torque and gravity over a window, and the angles turned in it.
struct Window<const N: usize> {
    torque_nm: SVector<f64, N>,
    gravity_nm: SVector<f64, N>,
    turned_rad: SVector<f64, N>,
}

fn windows<const N: usize>(arm: &Arm<N>, log: &RobotLog, from: usize) -> Vec<Window<N>> {
    let mut windows = Vec::new();
    let mut start = from;
    while start < log.rows() {
        let until_s = log.time_s[start] + WINDOW_S;
        let end = start + log.time_s[start..].partition_point(|time_s| *time_s < until_s);
        let zero = (SVector::zeros(), SVector::zeros());
        let (torque, gravity) = (start..end).fold(zero, |(torque, gravity), k| {
            let (q, tau) = (SVector::from(row(&log.q_rad, k)), SVector::from(row(&log.tau_j_nm, k)));
            (torque + tau, gravity + gravity_torque(arm, &q))
        });
        let rows = (end - start) as f64;
        windows.push(Window {
            torque_nm: torque / rows,
            gravity_nm: gravity / rows,
            turned_rad: SVector::from(row(&log.q_rad, end - 1)) - SVector::from(row(&log.q_rad, start)),
        });
        start = end;
    }
    windows
}

#[cfg(test)]
mod tests {
    use super::*;
    use tribo_logs::LogColumns;
    use tribo_robot::presets;

    /// A Panda that swings about its ready pose for 20 s, with this much dry friction (Nm) and gravity times `gravity`; the torque of
    /// `turned` is logged with the opposite sign, and all torques with an oscillation that no joint follows.
    fn log(rate_hz: f64, dry_nm: f64, gravity: f64, turned: Option<usize>) -> RobotLog {
        let arm = presets::panda();
        let mut columns = LogColumns {
            q_rad: vec![Vec::new(); 7],
            dq_rad_s: vec![Vec::new(); 7],
            tau_j_nm: vec![Vec::new(); 7],
            ..LogColumns::default()
        };
        for k in 0..(20.0 * rate_hz) as usize {
            let time_s = k as f64 / rate_hz;
            let speed = |j: usize| 0.8 + 0.1 * j as f64;
            let q = presets::panda_ready_pose() + SVector::from_fn(|j, _| 0.03 * (speed(j) * time_s).sin());
            let dq = SVector::<f64, 7>::from_fn(|j, _| 0.03 * speed(j) * (speed(j) * time_s).cos());
            let tau = gravity_torque(&arm, &q) * gravity + dq.map(|speed| dry_nm * (speed / 1e-3).tanh());
            columns.time_s.push(time_s);
            for j in 0..7 {
                let sign = if turned == Some(j) { -1.0 } else { 1.0 };
                columns.q_rad[j].push(q[j]);
                columns.dq_rad_s[j].push(dq[j]);
                columns.tau_j_nm[j].push(sign * (tau[j] + 0.3 * (73.0 * time_s).sin()));
            }
        }
        columns.validate().unwrap()
    }

    /// Each turned joint is told, at any rate, and with gravity that is a tenth off no other is.
    #[test]
    fn a_turned_joint_gives_energy() {
        for rate_hz in [1000.0, 125.0, 40.0] {
            for turned in (0..7).map(Some).chain([None]) {
                let remark = turned_signs(&presets::panda(), &log(rate_hz, 0.5, 1.1, turned), 0);
                let joints = remark.map(|remark| remark.joints);
                assert_eq!(joints, turned.map(|joint| vec![joint]), "{rate_hz} Hz");
            }
        }
    }

    /// Without friction nothing is told, whichever sign the torque has.
    #[test]
    fn without_friction_nothing_is_told() {
        for turned in (0..7).map(Some).chain([None]) {
            assert_eq!(turned_signs(&presets::panda(), &log(1000.0, 0.0, 1.05, turned), 0), None);
        }
        assert_eq!(turned_signs(&presets::panda(), &log(1000.0, 0.5, 1.0, Some(2)), 20_000), None, "nothing is left");
    }
}
