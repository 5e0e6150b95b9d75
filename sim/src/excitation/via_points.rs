//! A trajectory file: where to be, when.

use nalgebra::SVector;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::{Envelope, JointTrajectory, Motion, Path};

/// `(time, q)` points joined by quintic pieces, at rest at the first and the last.
///
/// ```text
/// resting       q̇ = q̈ = 0 at every point: minimum-jerk moves
/// passing       q̇_k = mean slope of the neighbouring pieces, q̈_k = 0 at inner points
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct ViaPoints<const N: usize> {
    /// Times (s), increasing from 0.
    pub time_s: Vec<f64>,
    /// Positions (rad), one per time.
    pub q_rad: Vec<SVector<f64, N>>,
    /// Whether the arm comes to rest at every point.
    pub resting: bool,
}

impl<const N: usize> ViaPoints<N> {
    /// The path through the points; points beyond the shorter of the two columns are left out.
    pub fn path(&self) -> Path<N> {
        let count = self.time_s.len().min(self.q_rad.len());
        let slope = |k: usize| (self.q_rad[k + 1] - self.q_rad[k]) / (self.time_s[k + 1] - self.time_s[k]);
        let qd = (0..count)
            .map(|k| {
                let inner = k > 0 && k + 1 < count;
                if self.resting || !inner { SVector::zeros() } else { 0.5 * (slope(k - 1) + slope(k)) }
            })
            .collect();
        Path::through(&Motion {
            time_s: self.time_s[..count].to_vec(),
            q: self.q_rad[..count].to_vec(),
            qd,
            qdd: vec![SVector::zeros(); count],
        })
    }

    /// Resting points that move all joints at once about the centre of the envelope, to and fro at two speeds, for about `duration_s`
    /// (s): what a first log of an arm should hold. `seed` draws the points.
    ///
    /// ```text
    /// q_k = centre ± u half range, u in [0.4, 1);   time of a move = 1.875 max |Δq|/v,   v = a quarter of the speed, then all of it
    /// ```
    pub fn exploring(envelope: &Envelope<N>, duration_s: f64, seed: u64) -> Self {
        let mut rng = Pcg64::seed_from_u64(seed);
        let centre = envelope.centre_rad;
        let (mut time_s, mut q_rad) = (vec![0.0], vec![centre]);
        // Each joint turns back at its own moments, so that no two look alike.
        let mut sides = [1.0; N];
        let move_to = |q: SVector<f64, N>, share: f64, time_s: &mut Vec<f64>, q_rad: &mut Vec<SVector<f64, N>>| {
            let (last, from) = (time_s[time_s.len() - 1], q_rad[q_rad.len() - 1]);
            let slowest = (q - from).abs().component_div(&(envelope.speed_rad_s * share)).max();
            // To the millisecond, as files are read by people.
            time_s.push(((last + (1.9 * slowest).max(0.5)) * 1e3).ceil() / 1e3);
            q_rad.push(q);
        };
        while time_s[time_s.len() - 1] < duration_s {
            let fast = q_rad.len() % 2 == 0;
            let q = SVector::from_fn(|j, _| {
                if rng.random_range(0.0..1.0) < 0.8 {
                    sides[j] = -sides[j];
                }
                let q = centre[j] + sides[j] * rng.random_range(0.4..1.0) * envelope.half_range_rad[j];
                (q * 1e4).round() / 1e4
            });
            move_to(q, if fast { 1.0 } else { 0.25 }, &mut time_s, &mut q_rad);
        }
        move_to(centre, 0.5, &mut time_s, &mut q_rad);
        Self { time_s, q_rad, resting: true }
    }

    /// [`Self::path`] for where any trajectory will do.
    pub fn trajectory(&self) -> Box<dyn JointTrajectory<N>> {
        Box::new(self.path())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tribo_robot::presets;

    /// Within the envelope and the speed, and every joint comes both ways.
    #[test]
    fn an_exploring_motion_uses_its_envelope_and_no_more() {
        let arm = presets::panda();
        let envelope = Envelope::around(&arm, presets::panda_ready_pose()).within(0.5).slower_than(1.0);
        for seed in 0..20 {
            let points = ViaPoints::exploring(&envelope, 40.0, seed);
            let motion = Motion::at_rate(&points.path(), 100.0);
            assert!((40.0..50.0).contains(&motion.time_s[motion.time_s.len() - 1]));
            for j in 0..7 {
                let (q, qd): (Vec<f64>, Vec<f64>) =
                    motion.q.iter().zip(&motion.qd).map(|(q, qd)| (q[j], qd[j])).unzip();
                let reach = |sign: f64| q.iter().map(|q| sign * (q - envelope.centre_rad[j])).fold(0.0, f64::max);
                let room = envelope.half_range_rad[j] + 1e-4;
                assert!(
                    (0.4 * room..room).contains(&reach(1.0)) && (0.4 * room..room).contains(&reach(-1.0)),
                    "joint {j}"
                );
                assert!(qd.iter().all(|qd| qd.abs() < envelope.speed_rad_s[j]), "joint {j}");
            }
        }
    }

    fn points(resting: bool) -> ViaPoints<2> {
        let q = [[0.0, 0.0], [0.5, -0.2], [0.4, -0.6], [0.0, 0.0]];
        ViaPoints { time_s: vec![0.0, 1.0, 2.5, 4.0], q_rad: q.map(SVector::from).to_vec(), resting }
    }

    #[test]
    fn points_are_met_and_rest_is_a_choice() {
        for resting in [true, false] {
            let (via, path) = (points(resting), points(resting).path());
            for (&t, q) in via.time_s.iter().zip(&via.q_rad) {
                assert!((path.at(t).q - q).amax() < 1e-12);
                assert!(path.at(t).qdd.amax() < 1e-9);
            }
            assert_eq!(path.at(1.0).qd.amax() < 1e-9, resting);
            assert!(path.at(4.0).qd.amax() < 1e-9);
            assert_eq!(path.duration_s(), 4.0);
        }
    }

    /// Closed form: a minimum-jerk move passes its middle at 1.875 times the mean speed.
    #[test]
    fn a_resting_move_has_minimum_jerk() {
        let state = points(true).path().at(0.5);
        assert!((state.q[0] - 0.25).abs() < 1e-12 && (state.qd[0] - 1.875 * 0.5).abs() < 1e-12);
    }
}
