//! A trajectory file: where to be, when.

use nalgebra::SVector;

use super::{JointTrajectory, Motion, Path};

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

    /// [`Self::path`] for where any trajectory will do.
    pub fn trajectory(&self) -> Box<dyn JointTrajectory<N>> {
        Box::new(self.path())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
