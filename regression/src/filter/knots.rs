//! A smooth function of a motion, evaluated at few samples of it.

/// Where on a grid of samples a function is evaluated, and polynomials of fifth degree between.
///
/// ```text
/// f(k) = Σ_i L_i(k/stride) f(knot_i),   L the Lagrange polynomials of the six nearest knots
/// ```
///
/// With 8 knots per period of a part of f the error is 1e-3 of that part, with 16 it is 2e-5. The samples after the last knot are
/// evaluated themselves.
pub(crate) struct Knots {
    samples: usize,
    stride: usize,
    /// `[knots before the sample among the six][knot][sample within its cell]`.
    weights: Vec<[Vec<f64>; NODES]>,
}

const NODES: usize = 6;

impl Knots {
    /// Knots every `stride` samples, or on all samples where that makes fewer than six.
    pub fn of(samples: usize, stride: usize) -> Self {
        let stride = if samples > stride * NODES { stride.max(1) } else { 1 };
        let lagrange = |i: usize, x: f64| -> f64 {
            (0..NODES).filter(|m| *m != i).map(|m| (x - m as f64) / (i as f64 - m as f64)).product()
        };
        let at = |before: usize, k: usize| before as f64 + k as f64 / stride as f64;
        let cell = |before: usize| -> [Vec<f64>; NODES] {
            std::array::from_fn(|i| (0..stride).map(|k| lagrange(i, at(before, k))).collect())
        };
        let weights = if stride > 1 { (0..NODES - 1).map(cell).collect() } else { Vec::new() };
        Self { samples, stride, weights }
    }

    /// Samples that the function is evaluated at: the knots, then those after the last.
    pub fn places(&self) -> impl Iterator<Item = usize> + use<> {
        let last = self.cells() * self.stride;
        (0..last).step_by(self.stride).chain(last..self.samples)
    }

    /// The function at all samples, from its values at the places.
    pub fn fill(&self, values: &[f64]) -> Vec<f64> {
        let cells = self.cells();
        if self.stride == 1 {
            return values.to_vec();
        }
        let mut filled = vec![0.0; cells * self.stride];
        for (cell, filled) in filled.chunks_exact_mut(self.stride).enumerate() {
            let first = cell.saturating_sub(NODES / 2 - 1).min(cells + 1 - NODES);
            for (value, weights) in values[first..first + NODES].iter().zip(&self.weights[cell - first]) {
                filled.iter_mut().zip(weights).for_each(|(filled, weight)| *filled += value * weight);
            }
        }
        filled.extend_from_slice(&values[cells..]);
        filled
    }

    /// Whole cells between knots.
    fn cells(&self) -> usize {
        self.samples.saturating_sub(1) / self.stride
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Closed form: polynomials of fifth degree are exact, a sine is as near as promised, whatever the length.
    #[test]
    fn polynomials_are_exact_and_sines_near() {
        for (samples, stride) in [(1000, 4), (1003, 12), (25, 4), (24, 4), (7, 3), (1, 5), (0, 5)] {
            let knots = Knots::of(samples, stride);
            let filled =
                |f: &dyn Fn(f64) -> f64| knots.fill(&knots.places().map(|k| f(k as f64)).collect::<Vec<f64>>());
            let worst = |f: &dyn Fn(f64) -> f64| {
                let filled = filled(f);
                assert_eq!(filled.len(), samples);
                filled.iter().enumerate().map(|(k, x)| (x - f(k as f64)).abs()).fold(0.0, f64::max)
            };
            let quintic =
                |k: f64| (1..6).fold(1.0, |value, power| 0.3 - value * (k / samples as f64 - 0.1 * f64::from(power)));
            assert!(worst(&quintic) < 1e-12, "{samples} {stride}: {:e}", worst(&quintic));
            let sine = |periods: f64| move |k: f64| (2.0 * std::f64::consts::PI * k / (periods * stride as f64)).sin();
            // The ends have their knots on one side.
            let inner = |f: &dyn Fn(f64) -> f64| {
                let ends = (3 * stride).min(samples / 2);
                let filled = filled(f);
                (ends..samples - ends).map(|k| (filled[k] - f(k as f64)).abs()).fold(0.0, f64::max)
            };
            assert!(inner(&sine(8.0)) < 1.5e-3, "{samples} {stride}: {:e}", inner(&sine(8.0)));
            assert!(inner(&sine(16.0)) < 2e-5, "{samples} {stride}: {:e}", inner(&sine(16.0)));
        }
    }
}
