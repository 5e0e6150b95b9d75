//! The band that torque of unseen motion lies in, as wide as held-out parts ask for.
//!
//! ```text
//! Var r_j(t) = w_j² (σ_j² + c V_j(t)),   V_j what the parameters leave open
//! ```
//!
//! What is left of a real robot is error of its model, which grows away from what was fitted: c, common to all joints, is the
//! likeliest for parts that were held out; w_j then holds 95 % of a joint's samples there.

/// |z| that 95 % of a Gaussian lie within.
const Z95: f64 = 1.96;
/// Decimal logarithm of the largest c, and steps per decade.
const DECADES: [usize; 2] = [4, 4];
/// Largest square of a standardised residual that counts: the tails are no Gaussian's.
const MOST_SQUARE: f64 = 9.0;

/// A residual (Nm) with what it was foretold to vary by (Nm²).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Deviation {
    pub residual_nm: f64,
    /// By noise.
    pub own: f64,
    /// By what the parameters leave open.
    pub unknown: f64,
}

/// The band.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Band {
    /// c.
    pub unknown_scale: f64,
    /// w of each joint.
    pub widths: Vec<f64>,
}

impl Band {
    /// The band of held-out residuals, one list per joint.
    pub fn of(unseen: &[Vec<Deviation>]) -> Self {
        let scales = (0..=DECADES[0] * DECADES[1]).map(|k| 10f64.powf(k as f64 / DECADES[1] as f64));
        let likeliest = scales
            .map(|scale| (scale, cost(unseen, scale)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map_or(1.0, |(scale, _)| scale);
        let width = |joint: &Vec<Deviation>| {
            let squares = joint.iter().map(|at| square(at, likeliest)).collect();
            (quantile(squares, 0.95).sqrt() / Z95).max(1e-3)
        };
        Self { unknown_scale: likeliest, widths: unseen.iter().map(width).collect() }
    }

    /// Standard deviation of a joint's torque (Nm), from variances by noise and by what is unknown (Nm²).
    pub fn sd_nm(&self, joint: usize, own: f64, unknown: f64) -> f64 {
        self.widths[joint] * (own + self.unknown_scale * unknown).sqrt()
    }

    /// Whether a residual of a joint lies in the 95 % band.
    pub fn holds(&self, joint: usize, at: &Deviation) -> bool {
        at.residual_nm.abs() <= Z95 * self.sd_nm(joint, at.own, at.unknown)
    }
}

fn square(at: &Deviation, scale: f64) -> f64 {
    at.residual_nm.powi(2) / (at.own + scale * at.unknown).max(f64::MIN_POSITIVE)
}

/// Minus the logarithm of the likelihood of all joints at their common width.
fn cost(unseen: &[Vec<Deviation>], scale: f64) -> f64 {
    let all = || unseen.iter().flatten().filter(|at| at.own > 0.0);
    let width = (quantile(all().map(|at| square(at, scale)).collect(), 0.95) / Z95.powi(2)).max(1e-6);
    all()
        .map(|at| {
            let grown = (at.own + scale * at.unknown) / at.own;
            0.5 * ((square(at, scale) / width).min(MOST_SQUARE) + (width * grown).ln())
        })
        .sum()
}

/// A quantile; of nothing, that of a Gaussian's squares.
fn quantile(mut values: Vec<f64>, part: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let at = ((values.len() as f64 - 1.0) * part).round().max(0.0) as usize;
    values.get(at).copied().unwrap_or(Z95 * Z95)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise_level::gaussian;

    /// Residuals of variance 4 (1 + 10 V) are held by the band in 95 % of samples, with small V and with large.
    #[test]
    fn the_band_finds_how_errors_grow() {
        let mut gauss = gaussian(3);
        let mut draw = |unknown: f64| {
            let residual_nm = 2.0 * (1.0 + 10.0 * unknown).sqrt() * gauss();
            Deviation { residual_nm, own: 1.0, unknown }
        };
        let seen: Vec<Vec<Deviation>> =
            (0..3).map(|_| (0..3000).map(|k| draw(f64::from(k % 10) * 0.05)).collect()).collect();
        let band = Band::of(&seen);
        assert!((5.0..20.0).contains(&band.unknown_scale), "{band:?}");
        let far: Vec<Deviation> = (0..3000).map(|_| draw(3.0)).collect();
        let inside = far.iter().filter(|at| band.holds(1, at)).count() as f64 / 3000.0;
        assert!((0.91..0.99).contains(&inside), "{inside}");
        // One that takes the fit at its word holds less.
        let narrow = Band { unknown_scale: 1.0, ..band };
        let inside = far.iter().filter(|at| narrow.holds(1, at)).count() as f64 / 3000.0;
        assert!(inside < 0.85, "{inside}");
    }
}
