//! Expected improvement of a sum of which every part has a model of its own.

use super::AcquisitionFunction;
use crate::Targets;
use crate::design::scrambled_sobol;
use crate::gp::{Gp, Posterior};
use crate::random::{Purpose, scramble_key};

/// Samples of the parts. A power of two, for the balance of the sequence.
const SAMPLES: usize = 64;
/// Width of the smooth maximum, in parts of the incumbent's cost.
const SOFTNESS: f64 = 0.01;

/// One part: its process, and what undoes the transform of its costs.
#[derive(Debug, Clone)]
pub struct Part {
    /// The process over unit coordinates and standardised targets.
    pub gp: Gp,
    /// The targets it was conditioned on.
    pub targets: Targets,
}

/// Monte-Carlo LogEI of `J = Σ_k c_k(t_k)`, t_k ~ N(mean_k(x), (f sd_k(x))²) independent, c_k the inverse of part k's transform:
///
/// ```text
/// ln 1/M Σ_m τ softplus((J_best − Σ_k c_k(mean_k + f sd_k z_mk))/τ),    τ = 0.01 J_best
/// ```
///
/// z: scrambled Sobol points made normal, the same for every x, so that the function is smooth (balandat2020). A sum knows
/// more than its total: each part is smoother than the whole, and its maximum of many is not lost in the others (astudillo2019).
#[derive(Debug)]
pub struct SumLogEi {
    parts: Vec<Part>,
    best: f64,
    sd_factor: f64,
    /// M rows of K normal numbers.
    normal: Vec<Vec<f64>>,
}

impl SumLogEi {
    /// The acquisition over the incumbent's cost `best` > 0.
    pub fn new(parts: Vec<Part>, best: f64, sd_factor: f64, seed: u64, trial: usize) -> Self {
        let key = scramble_key(seed, trial, Purpose::Samples);
        let row = |m: usize| normal_pairs(&scrambled_sobol(2 * parts.len().div_ceil(2), m, key));
        let normal = (0..SAMPLES).map(row).collect();
        Self { parts, best, sd_factor, normal }
    }

    /// Value, and its slopes in mean and deviation of each part.
    fn evaluate(&self, at: &[Posterior]) -> (f64, Vec<[f64; 2]>) {
        let tau = (SOFTNESS * self.best.abs()).max(f64::MIN_POSITIVE);
        let mut logs = [0.0; SAMPLES];
        // ∂ ln softplus(u)/∂u of each sample, and ∂c/∂t of each part in it.
        let mut rates = [0.0; SAMPLES];
        let mut slopes = vec![0.0; SAMPLES * at.len()];
        for (m, z) in self.normal.iter().enumerate() {
            let mut sum = 0.0;
            for (k, (part, at)) in self.parts.iter().zip(at).enumerate() {
                let (cost, slope) = part.targets.cost_and_slope(at.mean + self.sd_factor * at.sd * z[k]);
                sum += cost;
                slopes[m * self.parts.len() + k] = slope;
            }
            let u = ((self.best - sum) / tau).max(-1e12);
            (logs[m], rates[m]) = log_softplus(u);
        }
        let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let weights = logs.map(|log| (log - most).exp());
        let total: f64 = weights.iter().sum();
        let value = most + (total / SAMPLES as f64).ln() + tau.ln();
        let slope_of = |k: usize| {
            let mut slope = [0.0; 2];
            for (m, z) in self.normal.iter().enumerate() {
                let by_target = -weights[m] / total * rates[m] / tau * slopes[m * self.parts.len() + k];
                slope[0] += by_target;
                slope[1] += by_target * self.sd_factor * z[k];
            }
            slope
        };
        (value, (0..at.len()).map(slope_of).collect())
    }

    /// Mean over the samples of the cost at x, and their standard deviation.
    pub fn cost(&self, x: &[f64]) -> [f64; 2] {
        let at: Vec<Posterior> = self.parts.iter().map(|part| part.gp.posterior_slope(x).at).collect();
        let sum = |z: &Vec<f64>| -> f64 {
            let parts = self.parts.iter().zip(&at).zip(z);
            parts.map(|((part, at), z)| part.targets.cost_and_slope(at.mean + at.sd * z).0).sum()
        };
        let sums: Vec<f64> = self.normal.iter().map(sum).collect();
        let mean = sums.iter().sum::<f64>() / SAMPLES as f64;
        let variance = sums.iter().map(|sum| (sum - mean).powi(2)).sum::<f64>() / SAMPLES as f64;
        [mean, variance.sqrt()]
    }
}

impl AcquisitionFunction for SumLogEi {
    fn values(&self, points: &[Vec<f64>]) -> Vec<f64> {
        let posteriors: Vec<Vec<Posterior>> = self.parts.iter().map(|part| part.gp.posterior_batch(points)).collect();
        let at = |i: usize| posteriors.iter().map(|part| part[i]).collect::<Vec<_>>();
        (0..points.len()).map(|i| self.evaluate(&at(i)).0).collect()
    }

    fn slope(&self, x: &[f64], gradient: &mut [f64]) -> f64 {
        let slopes: Vec<_> = self.parts.iter().map(|part| part.gp.posterior_slope(x)).collect();
        let at: Vec<Posterior> = slopes.iter().map(|slope| slope.at).collect();
        let (value, by_part) = self.evaluate(&at);
        gradient.fill(0.0);
        for (slope, [d_mean, d_sd]) in slopes.iter().zip(by_part) {
            for (i, gradient) in gradient.iter_mut().enumerate() {
                *gradient += d_mean * slope.d_mean[i] + d_sd * slope.d_sd[i];
            }
        }
        value
    }
}

/// Two normal numbers from each two uniform ones: `√(−2 ln(1 − u)) (cos 2πv, sin 2πv)` (boxmuller1958).
fn normal_pairs(uniform: &[f64]) -> Vec<f64> {
    let pair = |uv: &[f64]| {
        let (radius, angle) = ((-2.0 * (1.0 - uv[0]).ln()).sqrt(), 2.0 * std::f64::consts::PI * uv[1]);
        [radius * angle.cos(), radius * angle.sin()]
    };
    uniform.chunks_exact(2).flat_map(pair).collect()
}

/// `ln ln(1 + e^u)` and its slope; finite at both ends.
fn log_softplus(u: f64) -> (f64, f64) {
    if u < -30.0 {
        // softplus → e^u.
        return (u, 1.0);
    }
    let softplus = if u > 30.0 { u } else { u.exp().ln_1p() };
    (softplus.ln(), 1.0 / ((1.0 + (-u).exp()) * softplus))
}

#[cfg(test)]
mod tests {
    use super::super::acquisition_function::tests::slope_is_that_of_the_value;
    use super::*;
    use crate::{Domain, History, Outcome, Settings, SurrogateModel};

    fn parts(count: usize) -> (Vec<Part>, f64) {
        let domain = Domain::unit_cube(2).unwrap();
        let settings = Settings::bo(vec![0.2, 0.2]);
        let mut best = f64::INFINITY;
        let mut histories = vec![History::new(); count];
        for trial in 0..9 {
            let x = settings.design_point(&domain, trial, 4).unwrap();
            let value = |k: usize| 0.1 + (x[0] - 0.3).powi(2) + k as f64 * (x[1] - 0.5 + 0.1 * k as f64).powi(2);
            histories.iter_mut().enumerate().for_each(|(k, history)| {
                history.push(x.clone(), Outcome::Value(value(k)));
            });
            best = best.min((0..count).map(value).sum());
        }
        let model = settings.model.unwrap();
        let part = |history: &History| {
            let surrogate = SurrogateModel::of(&model, &domain, history, 1).unwrap().unwrap();
            Part { gp: surrogate.gp, targets: surrogate.targets }
        };
        (histories.iter().map(part).collect(), best)
    }

    #[test]
    fn gradient_is_that_of_the_value() {
        let (parts, best) = parts(3);
        let acquisition = SumLogEi::new(parts, best, 1.5, 3, 9);
        for x in [[0.31, 0.42], [0.9, 0.1], [0.25, 0.6]] {
            slope_is_that_of_the_value(&acquisition, x, 1e-9);
        }
    }

    /// With one part in the place of a sum, untransformed, it is LogEI in closed form to the error of the samples.
    #[test]
    fn one_part_is_the_closed_form() {
        let (parts, best) = parts(1);
        let targets = parts[0].targets.clone();
        let acquisition = SumLogEi::new(parts, best, 1.0, 3, 9);
        let (mean, sd) = (targets.mean + targets.sd * 0.2, 0.5 * targets.sd);
        if targets.logarithmic || targets.bend.is_some() {
            return;
        }
        let (value, _) = acquisition.evaluate(&[Posterior { mean: 0.2, sd: 0.5 }]);
        let closed = super::super::log_expected_improvement(mean, sd, best).value;
        assert!((value - closed).abs() < 0.1, "{value} {closed}");
    }

    #[test]
    fn is_finite_however_hopeless() {
        let (parts, best) = parts(2);
        let acquisition = SumLogEi::new(parts, best, 2.0, 3, 9);
        for mean in [-1e3, 0.0, 10.0, 1e3, 1e6] {
            let (value, slopes) = acquisition.evaluate(&[Posterior { mean, sd: 1e-9 }; 2]);
            assert!(value.is_finite() && slopes.iter().flatten().all(|slope| slope.is_finite()), "{mean}: {value}");
        }
        for u in [-29.999_999_9, 29.999_999_9] {
            let (low, high) = (log_softplus(u - 1e-6), log_softplus(u + 1e-6));
            assert!((low.0 - high.0).abs() < 3e-6 && (low.1 - high.1).abs() < 1e-6);
        }
    }
}
