//! Hyper-parameters and their logarithmic coordinates.

use serde::{Deserialize, Serialize};

use crate::kernel::{Kernel, KernelFamily};

/// ℓ, σ_f² and σ_n² of a zero-mean Gaussian process.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HyperParameters {
    /// ℓ_i, one per coordinate, in unit coordinates.
    pub lengthscales: Vec<f64>,
    /// σ_f², squared units of the target.
    pub signal_variance: f64,
    /// σ_n², squared units of the target.
    pub noise_variance: f64,
}

/// Number of length-scales: one per coordinate, or one for all.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Lengthscales {
    /// Automatic relevance determination: ℓ_i per coordinate.
    Ard,
    /// One ℓ.
    Isotropic,
}

impl Lengthscales {
    /// How many there are in `dimension` coordinates.
    pub fn count(self, dimension: usize) -> usize {
        match self {
            Self::Ard => dimension,
            Self::Isotropic => 1,
        }
    }
}

impl HyperParameters {
    /// θ = (ln ℓ …, ln σ_f², ln σ_n²) → hyper-parameters; a single ln ℓ is spread over all coordinates.
    pub fn from_log(theta: &[f64], dimension: usize) -> Self {
        let count = theta.len() - 2;
        Self {
            lengthscales: (0..dimension).map(|i| theta[i.min(count - 1)].exp()).collect(),
            signal_variance: theta[count].exp(),
            noise_variance: theta[count + 1].exp(),
        }
    }

    /// Hyper-parameters → θ; the isotropic kernel takes ln ℓ_0.
    pub fn to_log(&self, lengthscales: Lengthscales) -> Vec<f64> {
        let count = lengthscales.count(self.lengthscales.len());
        let mut theta: Vec<f64> = self.lengthscales[..count].iter().map(|l| l.ln()).collect();
        theta.push(self.signal_variance.ln());
        theta.push(self.noise_variance.ln());
        theta
    }

    /// The kernel with these parameters.
    pub fn kernel(&self, family: KernelFamily) -> Kernel {
        Kernel { family, signal_variance: self.signal_variance, lengthscales: self.lengthscales.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logarithmic_coordinates_are_inverse() {
        let hyper = HyperParameters { lengthscales: vec![0.5, 2.0], signal_variance: 1.5, noise_variance: 1e-3 };
        let back = HyperParameters::from_log(&hyper.to_log(Lengthscales::Ard), 2);
        assert!((back.lengthscales[1] - 2.0).abs() < 1e-15 && (back.noise_variance - 1e-3).abs() < 1e-17);
        let one = HyperParameters::from_log(&hyper.to_log(Lengthscales::Isotropic), 2);
        assert_eq!(one.lengthscales, vec![0.5, 0.5]);
    }
}
