//! Configurations in which an arm can move its tool every way.

use nalgebra::{Matrix6, SVector, SymmetricEigen};

use crate::{Arm, Kinematics};

/// Configurations that are tried.
const CANDIDATES: usize = 4096;
/// Part of the range of a joint, about its middle, that is used [-].
const MIDDLE: f64 = 0.7;
/// Widest range that is used (rad): a joint that turns further repeats itself.
const WIDEST_RAD: f64 = 2.0 * std::f64::consts::PI;
/// Part of its torque limit that a joint may need against gravity [-].
const GRAVITY_PART: f64 = 0.6;
/// Distance in joint space (rad) between two of the poses.
const APART_RAD: f64 = 1.0;

/// Three configurations (rad) with the largest smallest singular value of the flange's Jacobian, in metres and radians:
///
/// ```text
/// max over q of  σ_min(J(q)),     |g_j(q)| ≤ 0.6 τ_max,j,     q in the middle 70 % of its range,     1 rad apart
/// ```
///
/// The best of 4096 points of a Kronecker sequence: the same arm gives the same poses. Of an arm too weak for its weight
/// the middle of its range comes back.
pub fn well_conditioned_poses<const N: usize>(arm: &Arm<N>) -> [SVector<f64, N>; 3] {
    let (low, high) = (arm.limits.q_min_rad, arm.limits.q_max_rad);
    let middle = (low + high) * 0.5;
    let width = (high - low).map(|range| MIDDLE * range.min(WIDEST_RAD));
    // Powers of the root of x^(N+1) = x + 1 fill N dimensions evenly (roberts2018).
    let root = (0..60).fold(2.0_f64, |x, _| (1.0 + x).powf(1.0 / (N as f64 + 1.0)));
    let candidate = |k: usize| {
        let part = |j: usize| (0.5 + k as f64 * root.powi(-(j as i32 + 1))).fract() - 0.5;
        SVector::from_fn(|j, _| middle[j] + width[j] * part(j))
    };
    let mut ranked: Vec<(f64, SVector<f64, N>)> =
        (0..CANDIDATES).map(candidate).filter_map(|q| Some((conditioning(arm, &q)?, q))).collect();
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut poses: Vec<SVector<f64, N>> = Vec::new();
    for (_, q) in ranked {
        if poses.len() < 3 && poses.iter().all(|other| (other - q).norm() >= APART_RAD) {
            poses.push(q);
        }
    }
    std::array::from_fn(|k| poses.get(k).or(poses.first()).copied().unwrap_or(middle))
}

/// Smallest singular value of the Jacobian; none where gravity asks too much.
fn conditioning<const N: usize>(arm: &Arm<N>, q: &SVector<f64, N>) -> Option<f64> {
    let kinematics = Kinematics::at(arm, q);
    let gravity = kinematics.gravity_torque(arm);
    let bearable = (0..N).all(|j| gravity[j].abs() <= GRAVITY_PART * arm.limits.tau_max_nm[j]);
    let jacobian = kinematics.jacobian();
    let gram: Matrix6<f64> = jacobian * jacobian.transpose();
    let smallest = SymmetricEigen::new(gram).eigenvalues.min().max(0.0).sqrt();
    (bearable && smallest.is_finite()).then_some(smallest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::presets;

    #[test]
    fn poses_found_are_as_good_as_those_chosen_by_hand_and_apart() {
        let preset = presets::find("ur10e").expect("a preset");
        let preset = preset.with_joints::<6>().expect("six joints");
        let found = well_conditioned_poses(&preset.arm);
        let by_hand = conditioning(&preset.arm, &preset.poses_rad[0]).expect("bearable");
        for (k, q) in found.iter().enumerate() {
            assert!(conditioning(&preset.arm, q).expect("bearable") > by_hand, "{q}");
            assert_eq!(preset.arm.first_joint_outside_limits(q), None);
            assert!(found[..k].iter().all(|other| (other - q).norm() >= APART_RAD));
        }
    }
}
