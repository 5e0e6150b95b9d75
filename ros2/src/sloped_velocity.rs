//! Velocities of a driver that has none.

use nalgebra::SVector;

/// Samples of a window.
const WINDOW: usize = 11;

/// Joint velocities from positions.
///
/// ```text
/// qd_k = slope of the line through q_{k-10} .. q_k, by least squares
/// ```
///
/// Late by five periods at low frequency; the fewer samples there are, the fewer are taken, and none has slope 0.
#[derive(Clone, Debug)]
pub(crate) struct SlopedVelocity<const N: usize> {
    samples: [(f64, SVector<f64, N>); WINDOW],
    count: usize,
}

impl<const N: usize> Default for SlopedVelocity<N> {
    fn default() -> Self {
        Self { samples: [(0.0, SVector::zeros()); WINDOW], count: 0 }
    }
}

impl<const N: usize> SlopedVelocity<N> {
    /// Takes positions (rad) at a time (s); the velocities there [rad/s].
    pub fn push(&mut self, time_s: f64, q: &SVector<f64, N>) -> SVector<f64, N> {
        self.samples[self.count % WINDOW] = (time_s, *q);
        self.count += 1;
        let known = &self.samples[..self.count.min(WINDOW)];
        let mean_s = known.iter().map(|(t, _)| t - time_s).sum::<f64>() / known.len() as f64;
        let (mut cross, mut square) = (SVector::zeros(), 0.0);
        for (t, q_then) in known {
            let lever = t - time_s - mean_s;
            cross += (q_then - q) * lever;
            square += lever * lever;
        }
        if square > 0.0 { cross / square } else { SVector::zeros() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line has its slope, a parabola that of five periods ago.
    #[test]
    fn lines_are_exact_and_parabolas_late_by_five_periods() {
        let mut velocity = SlopedVelocity::<2>::default();
        let mut last = SVector::zeros();
        for k in 0..40 {
            let t = f64::from(k) * 1e-3;
            last = velocity.push(t, &SVector::from([3.0 * t + 1.0, t * t]));
            assert!(k == 0 || (last[0] - 3.0).abs() < 1e-9, "{k}");
        }
        assert!((last[1] - 2.0 * (0.039 - 0.005)).abs() < 1e-9, "{}", last[1]);
    }
}
