//! Friction of the cold joint.

use nalgebra::{DMatrix, DVector, SMatrix};

use super::blocks::{Block, COLUMNS, Weights, blocks};
use super::{ThermalFitError, ThermalSession};
use crate::thermal::PolynomialStribeck;

/// Range of h that is searched [s/rad]: the bump fades to 1/e between 2 mrad/s and 2 rad/s.
const DECAYS: [f64; 2] = [0.5, 500.0];
/// Fewest sliding samples.
const FEWEST: usize = 100;
/// Samples of this many seconds count as one in the covariance (s).
const CLUSTER_S: f64 = 5.0;
/// Largest condition number of the normal matrix with unit columns.
const MAX_CONDITION: f64 = 1e12;

/// Friction at T0 with the covariance of its coefficients.
#[derive(Clone, Debug, PartialEq)]
pub struct ColdFit {
    /// c0 … c4 and h.
    pub friction: PolynomialStribeck,
    /// Covariance of (c0, …, c4, h), robust against noise that is correlated within five seconds; rows of parameters that
    /// were not fitted are zero.
    pub covariance: SMatrix<f64, COLUMNS, COLUMNS>,
    /// RMS of what is left (Nm).
    pub rms_nm: f64,
    /// Whether c4 and h were fitted.
    pub stribeck: bool,
}

/// c0 … c3, and with `stribeck` c4 and h, from cold joints by least squares (simoni2019 (12), simoni2017 (14)).
///
/// The other parameters are linear given h, which is searched over its range first and then refined. Polynomial and bump
/// need slow strokes beside fast ones.
///
/// # Errors
/// [`ThermalFitError::BadSample`], [`ThermalFitError::TooFewSamples`], [`ThermalFitError::Undetermined`].
pub fn identify_cold(
    sessions: &[ThermalSession],
    threshold_rad_s: f64,
    stribeck: bool,
) -> Result<ColdFit, ThermalFitError> {
    sessions.iter().enumerate().try_for_each(|(k, session)| session.check(k))?;
    let at = |decay: f64| -> Vec<Block> {
        sessions.iter().flat_map(|session| blocks(session, CLUSTER_S, threshold_rad_s, decay)).collect()
    };
    let linear = if stribeck { 5 } else { 4 };
    let got: usize = at(1.0).iter().map(|block| block.rows).sum();
    if got < FEWEST {
        return Err(ThermalFitError::TooFewSamples { got, need: FEWEST, threshold_rad_s });
    }
    let decay =
        if stribeck { best_decay(|decay| solve(&at(decay), linear).map_or(f64::INFINITY, |s| s.1)) } else { 0.0 };
    let blocks = at(decay);
    let undetermined = |parameter, sd, allowed| ThermalFitError::Undetermined {
        parameter,
        sd,
        allowed,
        remedy: "log slow and fast strokes of the cold joint",
    };
    let Some((c, square)) = solve(&blocks, linear) else {
        return Err(undetermined("c0 … c4", f64::INFINITY, MAX_CONDITION));
    };

    // Sandwich: H⁻¹ (Σ g gᵀ) H⁻¹ over clusters.
    let fitted = if stribeck { 6 } else { 4 };
    let mut weights = c;
    let mut jacobian = Weights::repeat(1.0);
    jacobian[5] = c[4];
    let (mut h, mut meat) = (DMatrix::zeros(fitted, fitted), DMatrix::zeros(fitted, fitted));
    weights[5] = 0.0;
    for block in &blocks {
        let g = block.score(&weights);
        for i in 0..fitted {
            for j in 0..fitted {
                h[(i, j)] += jacobian[i] * jacobian[j] * block.gram[(i, j)];
                meat[(i, j)] += jacobian[i] * g[i] * jacobian[j] * g[j];
            }
        }
    }
    let Some(inverse) = scaled_inverse(&h) else {
        return Err(undetermined("h", f64::INFINITY, decay));
    };
    let clusters = blocks.iter().filter(|block| block.rows > 0).count() as f64;
    let small = clusters / (clusters - fitted as f64).max(1.0);
    let robust = &inverse * meat * &inverse * small;
    let covariance = SMatrix::from_fn(|i, j| if i < fitted && j < fitted { robust[(i, j)] } else { 0.0 });
    if stribeck && covariance[(5, 5)].sqrt() > decay {
        return Err(undetermined("h", covariance[(5, 5)].sqrt(), decay));
    }
    let friction =
        PolynomialStribeck { polynomial: [c[0], c[1], c[2], c[3]], stribeck_nm: c[4], stribeck_decay_s_per_rad: decay };
    Ok(ColdFit { friction, covariance, rms_nm: (square / got as f64).max(0.0).sqrt(), stribeck })
}

/// Inverse by way of unit diagonals; none if the matrix is singular to working precision.
pub(super) fn scaled_inverse(h: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let n = h.nrows();
    let scale = DVector::from_fn(n, |i, _| h[(i, i)].sqrt());
    if !scale.iter().all(|s| *s > 0.0 && s.is_finite()) {
        return None;
    }
    let scaled = DMatrix::from_fn(n, n, |i, j| h[(i, j)] / (scale[i] * scale[j]));
    let eigenvalues = scaled.symmetric_eigenvalues();
    if eigenvalues.max() > MAX_CONDITION * eigenvalues.min().max(0.0) {
        return None;
    }
    let inverse = scaled.cholesky()?.inverse();
    Some(DMatrix::from_fn(n, n, |i, j| inverse[(i, j)] / (scale[i] * scale[j])))
}

/// Coefficients and what is left, Σ (tau − φ·c)².
fn solve(blocks: &[Block], linear: usize) -> Option<(Weights, f64)> {
    let (mut gram, mut cross, mut square) = (DMatrix::zeros(linear, linear), DVector::zeros(linear), 0.0);
    for block in blocks {
        gram += block.gram.view((0, 0), (linear, linear));
        cross += block.cross.rows(0, linear);
        square += block.square;
    }
    let c = scaled_inverse(&gram)? * &cross;
    let left = square - c.dot(&cross);
    Some((Weights::from_fn(|i, _| if i < linear { c[i] } else { 0.0 }), left))
}

/// Minimiser over h: a logarithmic grid, then golden sections between its best neighbours.
fn best_decay(mut cost: impl FnMut(f64) -> f64) -> f64 {
    const GRID: usize = 25;
    let ratio = (DECAYS[1] / DECAYS[0]).ln() / (GRID - 1) as f64;
    let grid = |k: usize| DECAYS[0].ln() + ratio * k as f64;
    let costs: Vec<f64> = (0..GRID).map(|k| cost(grid(k).exp())).collect();
    let best = (0..GRID).min_by(|&a, &b| costs[a].total_cmp(&costs[b])).unwrap_or(0);
    let (mut low, mut high) = (grid(best.saturating_sub(1)), grid((best + 1).min(GRID - 1)));
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    for _ in 0..30 {
        let (a, b) = (high - golden * (high - low), low + golden * (high - low));
        if cost(a.exp()) < cost(b.exp()) {
            high = b;
        } else {
            low = a;
        }
    }
    (0.5 * (low + high)).exp()
}
