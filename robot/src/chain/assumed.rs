//! Limits of joints of which a description has none.

use nalgebra::SVector;

use crate::{Arm, Kinematics, mass_matrix};

/// Speed limit [rad/s].
pub(super) const SPEED_RAD_S: f64 = std::f64::consts::PI;
/// Acceleration that there is torque for [rad/s²].
const ACCELERATION_RAD_S2: f64 = 10.0;
/// Configurations that are tried.
const CONFIGURATIONS: usize = 512;

/// Largest torque limit (Nm) that is assumed: of what is no arm of this world.
pub(super) const LARGEST_NM: f64 = 9e5;

/// Torques (Nm) that hold an arm anywhere within its limits and accelerate each joint alone by 10 rad/s²:
/// the largest `|g_j| + 10 M_jj` over 512 points of a Kronecker sequence.
pub(super) fn torque_limits_nm<const N: usize>(arm: &Arm<N>) -> SVector<f64, N> {
    // Powers of the root of x^(N+1) = x + 1 fill N dimensions evenly (roberts2018).
    let root = (0..60).fold(2.0_f64, |x, _| (1.0 + x).powf(1.0 / (N as f64 + 1.0)));
    let mut most = SVector::<f64, N>::zeros();
    for k in 0..CONFIGURATIONS {
        let q = SVector::from_fn(|j, _| {
            let part = (0.5 + k as f64 * root.powi(-(j as i32 + 1))).fract();
            arm.limits.q_min_rad[j] + part * (arm.limits.q_max_rad[j] - arm.limits.q_min_rad[j])
        });
        let gravity = Kinematics::at(arm, &q).gravity_torque(arm).abs();
        most = most.sup(&(gravity + mass_matrix(arm, &q).diagonal() * ACCELERATION_RAD_S2));
    }
    most
}
