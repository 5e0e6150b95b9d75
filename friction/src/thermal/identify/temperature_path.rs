//! From parameters to the friction of every block.

use super::blocks::{Block, Weights};
use crate::thermal::{HeatBalance, TemperatureFactor, ThermalResponse};

/// Number of parameters.
pub(super) const PARAMETERS: usize = 12;
pub(super) type Parameters = nalgebra::SVector<f64, PARAMETERS>;
/// Where each sits: c0 … c4, α, β, γ, δ, ln K, ln C, h.
pub(super) const STRIBECK: usize = 4;
pub(super) const ALPHA: usize = 5;
pub(super) const BETA: usize = 6;
pub(super) const GAMMA: usize = 7;
pub(super) const DELTA: usize = 8;
pub(super) const LN_K: usize = 9;
pub(super) const LN_C: usize = 10;
pub(super) const DECAY: usize = 11;

/// The blocks of one session, and where it starts.
#[derive(Clone, Debug)]
pub(super) struct SessionBlocks {
    pub ambient_c: f64,
    pub start_c: f64,
    pub blocks: Vec<Block>,
}

impl SessionBlocks {
    /// Weights of the columns in every block: friction of the block is `φ · weights`. The temperature follows the closed
    /// form through each block, with the block's mean power; `decay_of_columns` is the h the columns were made with, to
    /// which h may be close (first order).
    pub fn weights(&self, p: &Parameters, reference_c: f64, decay_of_columns: f64) -> Vec<Weights> {
        let heat = HeatBalance { conductance_w_per_k: p[LN_K].exp(), capacity_j_per_k: p[LN_C].exp() };
        let f = TemperatureFactor { slope_per_k: p[ALPHA], level: p[BETA] };
        let g = TemperatureFactor { slope_per_k: p[GAMMA], level: p[DELTA] };
        let dh = p[DECAY] - decay_of_columns;
        let mut temperature = self.start_c;
        self.blocks
            .iter()
            .map(|block| {
                let polynomial_w: f64 = (0..STRIBECK).map(|i| p[i] * block.work[i]).sum();
                let stribeck_w = p[STRIBECK] * (block.work[4] + dh * block.work[5]);
                let effective = heat.conductance_w_per_k - f.slope_per_k * polynomial_w - g.slope_per_k * stribeck_w;
                // A trial step may overshoot into runaway; the optimiser then finds it no better.
                let effective = effective.max(1e-6 * heat.conductance_w_per_k);
                let heating = f.level * polynomial_w
                    + g.level * stribeck_w
                    + heat.conductance_w_per_k * (self.ambient_c - reference_c);
                let response = ThermalResponse {
                    start_c: temperature,
                    steady_c: reference_c + heating / effective,
                    time_constant_s: heat.capacity_j_per_k / effective,
                };
                let rise = response.mean_c(block.duration_s) - reference_c;
                temperature = response.temperature_c(block.duration_s);
                let (f, g) = (f.at(rise), g.at(rise));
                Weights::from([p[0] * f, p[1] * f, p[2] * f, p[3] * f, p[4] * g, p[4] * g * dh])
            })
            .collect()
    }
}
