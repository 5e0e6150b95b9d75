//! Memory of the direction from which a value came.

use nalgebra::SVector;

/// Stop operator (Prandtl's elastic-plastic element), rate-independent:
///
/// ```text
/// s_k = clamp(s_{k−1} + (x_k − x_{k−1})/w, −1, 1)
/// ```
///
/// After a way of 2 w in one direction s is its sign; movements smaller than w, such as noise, leave a memory of what was
/// before. s = 0 at the start: the direction is not known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StopOperator {
    half_width: f64,
    last: Option<f64>,
    state: f64,
}

impl StopOperator {
    /// Half-width w > 0, units of x.
    pub fn new(half_width: f64) -> Self {
        Self { half_width, last: None, state: 0.0 }
    }

    /// Takes the next value; returns s in [−1, 1].
    #[inline]
    pub fn push(&mut self, x: f64) -> f64 {
        let step = x - self.last.unwrap_or(x);
        self.last = Some(x);
        self.state = (self.state + step / self.half_width).clamp(-1.0, 1.0);
        self.state
    }

    /// s.
    #[inline]
    pub fn state(&self) -> f64 {
        self.state
    }
}

/// How every joint came to where it is: direction of its motion, and of its load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach<const N: usize> {
    direction: [StopOperator; N],
    loading: [StopOperator; N],
}

impl<const N: usize> Approach<N> {
    /// Half-widths (rad) of the joint angle and of the deflection.
    pub fn new(direction_travel_rad: f64, loading_travel_rad: f64) -> Self {
        Self {
            direction: [StopOperator::new(direction_travel_rad); N],
            loading: [StopOperator::new(loading_travel_rad); N],
        }
    }

    /// Takes the next joint angles and deflections (rad).
    #[inline]
    pub fn push(&mut self, q: &SVector<f64, N>, deflection_rad: &SVector<f64, N>) {
        for j in 0..N {
            self.direction[j].push(q[j]);
            self.loading[j].push(deflection_rad[j]);
        }
    }

    /// Direction from which the joints came, [−1, 1].
    #[inline]
    pub fn direction(&self) -> SVector<f64, N> {
        SVector::from_fn(|j, _| self.direction[j].state())
    }

    /// Direction in which the load changed last, [−1, 1]: the branch of the gear's hysteresis.
    #[inline]
    pub fn loading(&self) -> SVector<f64, N> {
        SVector::from_fn(|j, _| self.loading[j].state())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_ways_are_remembered_by_their_sign_and_noise_is_not() {
        let mut stop = StopOperator::new(0.1);
        assert_eq!(stop.push(5.0), 0.0);
        assert!((stop.push(5.05) - 0.5).abs() < 1e-12);
        assert_eq!(stop.push(6.0), 1.0);
        for k in 0..1000 {
            assert!(stop.push(6.0 + 0.005 * f64::from(k % 2)) > 0.9);
        }
        assert_eq!(stop.push(3.0), -1.0);
    }

    /// Rate independence: the same way in any number of steps ends in the same state.
    #[test]
    fn only_the_way_counts() {
        let end = |steps: usize| {
            let mut stop = StopOperator::new(0.3);
            for turn in [0.0, 1.0, 0.8, 1.1, 0.55] {
                let from = stop.last.unwrap_or(0.0);
                for k in 1..=steps {
                    stop.push(from + (turn - from) * k as f64 / steps as f64);
                }
            }
            stop.state()
        };
        assert!((end(1) - end(97)).abs() < 1e-12);
    }
}
