//! A signal at a lower rate.

/// Every `factor`-th sample of the thrice averaged signal.
///
/// ```text
/// y_i = Σ_k h_k x(i·factor + k),   h = box * box * box of `factor` samples each,   gain(f) = |sin(π f factor) / (factor sin(π f))|³
/// ```
///
/// f in sample rates. The gain is zero at every multiple of the new rate, so that little is folded onto slow parts. Nothing is guessed at the ends:
/// only whole sums count. A symmetric sum delays nothing where stamps pass it too.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Decimation {
    factor: usize,
    weights: Vec<f64>,
}

/// Sums that are made side by side.
const LANES: usize = 8;

impl Decimation {
    /// Of a factor from 1, which leaves every signal as it is.
    pub fn by(factor: usize) -> Self {
        let factor = factor.max(1);
        let mut weights = vec![1.0];
        for _ in 0..3 {
            let mut wider = vec![0.0; weights.len() + factor - 1];
            for (start, weight) in weights.iter().enumerate() {
                wider[start..start + factor].iter_mut().for_each(|sum| *sum += weight / factor as f64);
            }
            weights = wider;
        }
        Self { factor, weights }
    }

    /// Samples in for one sample out.
    pub fn factor(&self) -> usize {
        self.factor
    }

    /// Samples that make one.
    pub fn taps(&self) -> usize {
        self.weights.len()
    }

    /// y of x; empty where x is too short for one sum.
    pub fn apply(&self, x: &[f64]) -> Vec<f64> {
        if self.factor == 1 {
            return x.to_vec();
        }
        x.windows(self.taps()).step_by(self.factor).map(|window| self.weighted(window)).collect()
    }

    fn weighted(&self, window: &[f64]) -> f64 {
        let ((weights, rest), (x, x_rest)) = (self.weights.as_chunks::<LANES>(), window.as_chunks::<LANES>());
        let mut sums = [0.0; LANES];
        for (weights, x) in weights.iter().zip(x) {
            for lane in 0..LANES {
                sums[lane] += weights[lane] * x[lane];
            }
        }
        let rest: f64 = rest.iter().zip(x_rest).map(|(weight, x)| weight * x).sum();
        sums.iter().sum::<f64>() + rest
    }

    /// Gain at a frequency (in sample rates of x).
    pub fn gain(&self, frequency: f64) -> f64 {
        let x = std::f64::consts::PI * frequency;
        let factor = self.factor as f64;
        if self.factor == 1 || x.sin() == 0.0 { 1.0 } else { ((factor * x).sin() / (factor * x.sin())).abs().powi(3) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_stay_lines_and_stamps_say_where() {
        for factor in [1, 2, 5, 8] {
            let decimation = Decimation::by(factor);
            let x: Vec<f64> = (0..100).map(|k| 3.0 - 0.25 * f64::from(k)).collect();
            let stamps: Vec<f64> = (0..100).map(f64::from).collect();
            let (y, at) = (decimation.apply(&x), decimation.apply(&stamps));
            assert_eq!(y.len(), (100 - decimation.taps()) / factor + 1);
            for (y, at) in y.iter().zip(&at) {
                assert!((y - (3.0 - 0.25 * at)).abs() < 1e-12);
            }
            assert!(at.windows(2).all(|pair| (pair[1] - pair[0] - factor as f64).abs() < 1e-9));
            assert!(decimation.apply(&x[..decimation.taps() - 1]).is_empty());
        }
    }

    /// Witness: the closed-form gain, which `apply` never evaluates.
    #[test]
    fn sinusoids_take_the_known_gain_and_keep_their_phase() {
        let decimation = Decimation::by(6);
        for frequency in [0.003, 0.02, 0.0834, 0.16, 1.0 / 6.0, 0.3] {
            let wave = |at: f64| (2.0 * std::f64::consts::PI * frequency * at + 0.4).sin();
            let x: Vec<f64> = (0..600).map(|k| wave(f64::from(k))).collect();
            let middle = (decimation.taps() - 1) as f64 / 2.0;
            // The sine over the sine changes its sign at every multiple of the new rate.
            let sign = f64::powi(-1.0, (6.0 * frequency).floor() as i32);
            for (i, y) in decimation.apply(&x).iter().enumerate() {
                let wanted = sign * decimation.gain(frequency) * wave(6.0 * i as f64 + middle);
                assert!((y - wanted).abs() < 1e-9, "{frequency}: {y} for {wanted}");
            }
        }
    }
}
