//! Whether a law explains a log that it was not fitted to.

use super::gls_rows::Layout;
use super::normal_equations::NormalEquations;
use super::{GlsError, GlsSample, GlsSettings};

/// Least weighted square per sample that counts as friction: of an estimator that is off by some of its deviations, which of an arm without
/// friction is all there is, one percent of this is left.
const LEAST_SQUARE: f64 = 1000.0;
/// Contiguous parts that a log is cut into; samples in between would know their neighbours.
const BLOCKS: usize = 10;

/// Part of the friction's wrench that a law leaves unexplained [-] on blocks of the log that its parameters were not fitted to:
///
/// ```text
/// Σ_b Σ_{t ∈ b} |y_t − W_t Φ(qd_t) θ_{−b}|²_S  /  Σ_t |y_t|²_S,     |e|²_S = eᵀ Cov(e_t)⁻¹ e
/// ```
///
/// y, Cov and the fit θ are those of [`super::fit_from_wrench`]; θ_{−b} is from all blocks but b, ten contiguous ones. Near 0 where the
/// law is right; 1 and more where it is no better than none. The denominator is that of a friction that shows at least.
///
/// # Errors
/// Those of [`super::fit_from_wrench`]; of a block's complement, too.
pub fn unexplained_on_held_out<const N: usize>(
    samples: &[GlsSample<N>],
    settings: &GlsSettings<N>,
) -> Result<f64, GlsError> {
    let layout = Layout::new(settings);
    let need = 10 * layout.total * BLOCKS / (BLOCKS - 1) + BLOCKS;
    if samples.len() < need {
        return Err(GlsError::TooFewSamples { need, got: samples.len() });
    }
    let length = samples.len().div_ceil(BLOCKS);
    let blocks = samples
        .chunks(length)
        .enumerate()
        .map(|(b, block)| NormalEquations::of(block, b * length, settings, &layout))
        .collect::<Result<Vec<_>, _>>()?;
    let mut total = NormalEquations::zero(layout.total);
    for block in &blocks {
        total.add(block, 1.0);
    }
    let mut left = 0.0;
    for block in &blocks {
        let mut others = total.clone();
        others.add(block, -1.0);
        left += block.square_left(&others.solve(settings.correlated_samples, &layout).theta);
    }
    Ok(left / total.square.max(LEAST_SQUARE * samples.len() as f64))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::Basis;
    use nalgebra::{SMatrix, SVector};

    /// Seven torques through a map that turns slowly, as in a trial; velocities that do not repeat from block to block.
    fn samples(torque: impl Fn(f64, usize, f64) -> f64) -> Vec<GlsSample<7>> {
        (0..3000)
            .map(|t| {
                let time = t as f64 * 0.01;
                let w = SMatrix::<f64, 6, 7>::from_fn(|r, c| ((r * 7 + c).pow(2) as f64 * 1.7 + 0.4 * time).sin());
                let qd = SVector::<f64, 7>::from_fn(|j, _| 0.1 * (time * (0.4 + 0.13 * j as f64) + j as f64).sin());
                let tau = SVector::<f64, 7>::from_fn(|j, _| torque(time, j, qd[j]));
                let slides = std::array::from_fn(|j| qd[j].abs() >= 0.004);
                GlsSample { wrench: w * tau, wrench_from_torque: w, qd, slides, tau_compensation: SVector::zeros() }
            })
            .collect()
    }

    #[test]
    fn the_right_law_leaves_nothing_and_another_cause_stays() {
        let mut settings = GlsSettings::new(Basis::CoulombViscous);
        settings.prior_sd = [[100.0; 3]; 7];
        let friction = |_: f64, j: usize, qd: f64| (0.5 + 0.1 * j as f64) * qd + 0.4 * qd.signum();
        let right = unexplained_on_held_out(&samples(friction), &settings).unwrap();
        assert!(right < 1e-3, "{right}");
        // Half of the power is a torque that goes with time: no law of the velocity holds on another block.
        let wrong = |time: f64, j: usize, qd: f64| friction(time, j, qd) + 0.42 * (0.9 * time + j as f64).sin();
        let wrong = unexplained_on_held_out(&samples(wrong), &settings).unwrap();
        assert!((0.2..0.6).contains(&wrong), "{wrong}");
        // No friction at all: nothing that was fitted helps.
        let other = unexplained_on_held_out(&samples(|time, j, _| (0.9 * time + j as f64).sin()), &settings).unwrap();
        assert!(other > 0.8, "{other}");
    }

    #[test]
    fn too_short_and_broken_logs_are_refused() {
        let settings = GlsSettings::new(Basis::CoulombViscous);
        let mut some = samples(|_, _, qd| qd);
        assert!(matches!(
            unexplained_on_held_out(&some[..100], &settings),
            Err(GlsError::TooFewSamples { got: 100, .. })
        ));
        some[700].wrench[0] = f64::NAN;
        assert_eq!(unexplained_on_held_out(&some, &settings), Err(GlsError::NotFinite { index: 700 }));
    }
}
