//! Hyper-parameters and their logarithmic coordinates.

use serde::{Deserialize, Serialize};

use crate::kernel::{Kernel, KernelShape, Trend};

/// ℓ, σ_f², σ_n² and, where the kernel has one, the trend of a zero-mean Gaussian process.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HyperParameters {
    /// ℓ_i, one per coordinate, in unit coordinates.
    pub lengthscales: Vec<f64>,
    /// σ_f², squared units of the target.
    pub signal_variance: f64,
    /// σ_n², squared units of the target.
    pub noise_variance: f64,
    /// Variances of the trend.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub trend: Option<Trend>,
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
    /// θ = (ln ℓ …, ln σ_f², ln σ_n²[, ln linear, ln quadratic]) with `lengthscales` entries ln ℓ → hyper-parameters;
    /// a single ln ℓ is spread over all coordinates.
    pub fn from_log(theta: &[f64], lengthscales: Lengthscales, dimension: usize) -> Self {
        let count = lengthscales.count(dimension);
        let (lengths, rest) = theta.split_at(count);
        let trend = (rest.len() == 4).then(|| Trend { linear: rest[2].exp(), quadratic: rest[3].exp() });
        Self {
            lengthscales: (0..dimension).map(|i| lengths[i.min(count - 1)].exp()).collect(),
            signal_variance: rest[0].exp(),
            noise_variance: rest[1].exp(),
            trend,
        }
    }

    /// Hyper-parameters → θ; the isotropic kernel takes ln ℓ_0.
    pub fn to_log(&self, lengthscales: Lengthscales) -> Vec<f64> {
        let count = lengthscales.count(self.lengthscales.len());
        let mut theta: Vec<f64> = self.lengthscales[..count].iter().map(|l| l.ln()).collect();
        theta.push(self.signal_variance.ln());
        theta.push(self.noise_variance.ln());
        theta.extend(self.trend.into_iter().flat_map(|trend| [trend.linear.ln(), trend.quadratic.ln()]));
        theta
    }

    /// The kernel with these parameters.
    pub fn kernel(&self, shape: impl Into<KernelShape>) -> Kernel {
        let KernelShape { family, structure, .. } = shape.into();
        Kernel {
            family,
            structure,
            signal_variance: self.signal_variance,
            lengthscales: self.lengthscales.clone(),
            trend: self.trend,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logarithmic_coordinates_are_inverse() {
        let trend = Some(Trend { linear: 0.3, quadratic: 0.1 });
        let hyper = HyperParameters { lengthscales: vec![0.5, 2.0], signal_variance: 1.5, noise_variance: 1e-3, trend };
        let back = HyperParameters::from_log(&hyper.to_log(Lengthscales::Ard), Lengthscales::Ard, 2);
        assert!((back.lengthscales[1] - 2.0).abs() < 1e-15 && (back.noise_variance - 1e-3).abs() < 1e-17);
        assert!(back.trend.is_some_and(|trend| (trend.quadratic - 0.1).abs() < 1e-15));
        let one = HyperParameters { trend: None, ..hyper }.to_log(Lengthscales::Isotropic);
        let one = HyperParameters::from_log(&one, Lengthscales::Isotropic, 2);
        assert_eq!((one.lengthscales, one.trend), (vec![0.5, 0.5], None));
    }
}
