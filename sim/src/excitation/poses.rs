//! Static poses joined by quintic moves.

use nalgebra::SVector;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::profile::{QUINTIC_PEAK_ACCELERATION, QUINTIC_PEAK_SPEED};
use super::{Envelope, JointProfile, Path};

/// Random poses of the envelope, each held for `hold_s` (s) with all joints at rest, then home.
///
/// Between poses every joint starts a little later or earlier and takes its own time.
pub(super) fn static_poses<const N: usize>(envelope: &Envelope<N>, hold_s: f64, duration_s: f64, seed: u64) -> Path<N> {
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut joints = std::array::from_fn(|j| JointProfile::resting_at(envelope.centre_rad[j]));
    let longest_home_s = move_times(envelope, &(envelope.half_range_rad + envelope.centre_rad), &joints).max() * 1.5;
    loop {
        let pose = SVector::<f64, N>::from_fn(|j, _| {
            envelope.centre_rad[j] + envelope.half_range_rad[j] * rng.random_range(-1.0..1.0)
        });
        let fastest = move_times(envelope, &pose, &joints);
        let moves = fastest.map(|time_s| (rng.random_range(0.0..0.3), time_s * rng.random_range(1.05..1.4)));
        let window_s = moves.iter().map(|(late_s, time_s)| late_s + time_s).fold(0.0, f64::max) + hold_s;
        if joints[0].duration_s() + window_s + longest_home_s > duration_s {
            break;
        }
        let end_s = joints[0].duration_s() + window_s;
        for j in 0..N {
            let (late_s, time_s) = moves[j];
            joints[j].hold(late_s);
            joints[j].quintic_to(pose[j], 0.0, 0.0, time_s);
            let rest_s = end_s - joints[j].duration_s();
            joints[j].hold(rest_s);
        }
    }
    let home_s = move_times(envelope, &envelope.centre_rad, &joints) * 1.1;
    for j in 0..N {
        joints[j].quintic_to(envelope.centre_rad[j], 0.0, 0.0, home_s[j]);
    }
    Path::new(joints).lasting(duration_s)
}

/// Shortest quintic moves (s) from where the joints are that keep speed and acceleration.
fn move_times<const N: usize>(
    envelope: &Envelope<N>,
    pose: &SVector<f64, N>,
    joints: &[JointProfile; N],
) -> SVector<f64, N> {
    SVector::from_fn(|j, _| {
        let way = (pose[j] - joints[j].end_rad()).abs();
        let by_speed = QUINTIC_PEAK_SPEED * way / envelope.speed_rad_s[j];
        let by_acceleration = (QUINTIC_PEAK_ACCELERATION * way / envelope.acceleration_rad_s2[j]).sqrt();
        by_speed.max(by_acceleration)
    })
}
