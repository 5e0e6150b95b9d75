//! A session in blocks of nearly constant temperature: all that a fit needs of them.

use nalgebra::{SMatrix, SVector};

use super::ThermalSession;
use crate::thermal::PolynomialStribeck;

/// Columns of the friction torque: c0 … c4, and the derivative of the Stribeck column by h.
pub(super) const COLUMNS: usize = 6;
pub(super) type Weights = SVector<f64, COLUMNS>;

/// Sums over the sliding samples of one block, and its heat.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    /// Length (s).
    pub duration_s: f64,
    /// Σ φ φᵀ over sliding samples.
    pub gram: SMatrix<f64, COLUMNS, COLUMNS>,
    /// Σ φ tau.
    pub cross: Weights,
    /// Σ tau².
    pub square: f64,
    /// Sliding samples.
    pub rows: usize,
    /// Mean of |q̇| |φ| over the block, rests included: power per unit of each coefficient.
    pub work: Weights,
}

impl Block {
    /// Σ (tau − φ·w)².
    pub fn squared_error(&self, w: &Weights) -> f64 {
        self.square - 2.0 * w.dot(&self.cross) + w.dot(&(self.gram * w))
    }

    /// −½ of the gradient of that: Σ φ (tau − φ·w).
    pub fn score(&self, w: &Weights) -> Weights {
        self.cross - self.gram * w
    }
}

/// Unsigned columns `[1, v, v², v³, e^{−hv}, −v e^{−hv}]` at speed v.
pub(super) fn columns(speed: f64, decay: f64) -> Weights {
    let [a, b, c, d, e] = PolynomialStribeck::columns(speed, decay);
    Weights::from([a, b, c, d, e, -speed * e])
}

/// Blocks of about `block_s` (s). Samples slower than the threshold carry heat only: a joint that hardly moves may have any
/// friction up to c0 + c4.
pub(super) fn blocks(session: &ThermalSession, block_s: f64, threshold_rad_s: f64, decay: f64) -> Vec<Block> {
    let samples = &session.samples;
    let mut blocks = Vec::new();
    let mut block: Option<Block> = None;
    let mut block_end_s = 0.0;
    for (k, sample) in samples.iter().enumerate() {
        // The last sample lasts as long as the one before.
        let dt = match samples.get(k + 1) {
            Some(next) => next.time_s - sample.time_s,
            None if k > 0 => sample.time_s - samples[k - 1].time_s,
            None => 0.0,
        };
        if block.is_some() && sample.time_s >= block_end_s {
            blocks.extend(block.take());
        }
        let b = block.get_or_insert_with(|| {
            block_end_s = sample.time_s + block_s;
            Block {
                duration_s: 0.0,
                gram: SMatrix::zeros(),
                cross: Weights::zeros(),
                square: 0.0,
                rows: 0,
                work: Weights::zeros(),
            }
        });
        b.duration_s += dt;
        let speed = sample.qd_rad_s.abs();
        if speed < threshold_rad_s {
            continue;
        }
        let phi = columns(speed, decay);
        let tau = sample.friction_nm * sample.qd_rad_s.signum();
        b.gram.ger(1.0, &phi, &phi, 1.0);
        b.cross += phi * tau;
        b.square += tau * tau;
        b.rows += 1;
        b.work += phi * (speed * dt);
    }
    blocks.extend(block);
    blocks.retain(|b| b.duration_s > 0.0);
    for b in &mut blocks {
        b.work /= b.duration_s;
    }
    blocks
}
