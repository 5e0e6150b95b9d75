//! Deflection without load, learnt.

use nalgebra::SVector;
use tribo_bayesopt::BayesoptError;
use tribo_bayesopt::gp::{Fit, FitSettings, Gp, HyperPrior, InducingGp, Lengthscales, Posterior, fit_coarse_to_fine};
use tribo_bayesopt::kernel::KernelFamily;

use super::{Rest, ValidDoubleEncoder};

/// Inputs of one joint's process: the joint angles, and what of its approach the settings ask for.
#[inline]
pub(super) fn inputs<const N: usize>(
    settings: &ValidDoubleEncoder,
    joint: usize,
    rest: &Rest<N>,
    x: &mut SVector<f64, N>,
    approach: &mut [f64; 2],
) -> usize {
    *x = rest.q;
    let mut count = 0;
    for (wanted, value) in
        [(settings.direction_input, rest.direction[joint]), (settings.loading_input, rest.loading[joint])]
    {
        if wanted {
            approach[count] = value;
            count += 1;
        }
    }
    N + count
}

/// One joint's process on what its mean function leaves of Δθ₁; everything scaled to unit deviation inside.
///
/// ```text
/// Δθ₁(x) = m(x) + f(x) + ε,   f ~ GP(0, σ_f² exp(−½ Σ ((x_i − x_i')/ℓ_i)²)),   ε ~ N(0, σ_n²)
/// ```
///
/// uhlmann2023, eqs. (8)–(15): squared exponential with a length-scale per input, hyper-parameters by marginal
/// likelihood alone. ε is what does not repeat: the encoders, and stiction.
#[derive(Clone, Debug)]
pub struct DeflectionGp {
    shift: Vec<f64>,
    scale: Vec<f64>,
    target_mean_rad: f64,
    target_sd_rad: f64,
    fit: Fit,
    exact: Gp,
    inducing: InducingGp,
    compression_rms_rad: f64,
}

impl DeflectionGp {
    /// Fits the process to targets (rad) at rows of inputs.
    ///
    /// # Errors
    /// Those of the regression.
    pub(super) fn fit(
        settings: &ValidDoubleEncoder,
        rows: &[Vec<f64>],
        targets_rad: &[f64],
        seed: u64,
    ) -> Result<Self, BayesoptError> {
        let (n, dimension) = (rows.len() as f64, rows.first().map_or(0, Vec::len));
        let moments = |values: &dyn Fn(usize) -> f64| {
            let mean = (0..rows.len()).map(values).sum::<f64>() / n;
            let variance = (0..rows.len()).map(|k| (values(k) - mean).powi(2)).sum::<f64>() / n;
            // An input that never changes stays where it is.
            (mean, if variance > 0.0 { variance.sqrt() } else { 1.0 })
        };
        let (shift, scale): (Vec<f64>, Vec<f64>) = (0..dimension).map(|i| moments(&|k| rows[k][i])).unzip();
        let (target_mean_rad, target_sd_rad) = moments(&|k| targets_rad[k]);
        let points: Vec<Vec<f64>> =
            rows.iter().map(|row| (0..dimension).map(|i| (row[i] - shift[i]) / scale[i]).collect()).collect();
        let targets: Vec<f64> = targets_rad.iter().map(|t| (t - target_mean_rad) / target_sd_rad).collect();
        let chosen = FitSettings {
            family: KernelFamily::SquaredExponential,
            lengthscales: Lengthscales::Ard,
            prior: HyperPrior::Flat,
            starts: 1,
            iterations: 100,
            fit_limit: rows.len(),
        };
        let fit = fit_coarse_to_fine(&chosen, &points, &targets, settings.coarse, seed)?;
        let inducing = InducingGp::new(chosen.family, &fit.hyper, &points, &targets, settings.inducing)?;
        let exact = Gp::new(chosen.family, &fit.hyper, points.clone(), &targets)?;
        let (mut scratch, mut slope) = (vec![0.0; inducing.len()], vec![0.0; dimension]);
        let squares: f64 = points
            .iter()
            .zip(exact.posterior_batch(&points))
            .map(|(x, want)| (inducing.posterior(x, &mut scratch, &mut slope).mean - want.mean).powi(2))
            .sum();
        let compression_rms_rad = (squares / n).sqrt() * target_sd_rad;
        Ok(Self { shift, scale, target_mean_rad, target_sd_rad, fit, exact, inducing, compression_rms_rad })
    }

    /// Exact posterior (rad) at rows of inputs; the deviation is that of f, without ε.
    pub fn predict_rad(&self, rows: &[Vec<f64>]) -> Vec<Posterior> {
        let scaled = |row: &Vec<f64>| (0..row.len()).map(|i| (row[i] - self.shift[i]) / self.scale[i]).collect();
        let points: Vec<Vec<f64>> = rows.iter().map(scaled).collect();
        self.exact.posterior_batch(&points).into_iter().map(|p| self.in_rad(p)).collect()
    }

    /// The same on the inducing points, with the slope of the mean per input; no allocation.
    ///
    /// `x` holds the inputs and is scaled in place, `scratch` at least [`Self::inducing_points`] numbers.
    #[inline]
    pub(super) fn predict_fast_rad(&self, x: &mut [f64], scratch: &mut [f64], slope: &mut [f64]) -> Posterior {
        for ((x, shift), scale) in x.iter_mut().zip(&self.shift).zip(&self.scale) {
            *x = (*x - shift) / scale;
        }
        let at = self.inducing.posterior(x, scratch, slope);
        for (slope, scale) in slope.iter_mut().zip(&self.scale) {
            *slope *= self.target_sd_rad / scale;
        }
        self.in_rad(at)
    }

    /// σ_n (rad).
    pub fn noise_rad(&self) -> f64 {
        self.fit.hyper.noise_variance.sqrt() * self.target_sd_rad
    }

    /// How the hyper-parameters were found.
    pub fn fit_evidence(&self) -> &Fit {
        &self.fit
    }

    /// Number of inducing points.
    pub fn inducing_points(&self) -> usize {
        self.inducing.len()
    }

    /// RMS over the training inputs of what the inducing points miss of the exact mean (rad).
    pub fn compression_rms_rad(&self) -> f64 {
        self.compression_rms_rad
    }

    #[inline]
    fn in_rad(&self, p: Posterior) -> Posterior {
        Posterior { mean: p.mean * self.target_sd_rad + self.target_mean_rad, sd: p.sd * self.target_sd_rad }
    }
}
