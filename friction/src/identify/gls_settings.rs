//! What a fit to estimated wrenches assumes.

use super::Basis;

/// What the fit assumes of noise, and of stiction and prior of each of N joints. Defaults are those found to work in closed loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GlsSettings<const N: usize> {
    /// Columns per joint.
    pub basis: Basis,
    /// Standard deviation of an estimated force (N).
    pub force_sd_n: f64,
    /// Standard deviation of an estimated moment (Nm).
    pub moment_sd_nm: f64,
    /// Coulomb friction that a joint may hide which does not slide (Nm); its torque is uniform within ± this.
    pub stuck_coulomb_nm: [f64; N],
    /// Number of samples that carry the information of one, because neighbours are correlated.
    pub correlated_samples: f64,
    /// Prior standard deviation of the coefficients of each joint about zero, in the order of [`Basis`]: Fv, Fc, dF.
    pub prior_sd: [[f64; 3]; N],
    /// Lower bounds of the coefficients of each joint, in the order of [`Basis`].
    pub lower: [[f64; 3]; N],
    /// Upper bounds of the coefficients of each joint, in the order of [`Basis`].
    pub upper: [[f64; 3]; N],
    /// Prior standard deviation of a constant torque offset per joint (Nm); none leaves offsets out.
    pub offset_sd_nm: Option<f64>,
    /// Prior standard deviation of an unmodelled mass at the flange (kg); none leaves it out.
    pub payload_sd_kg: Option<f64>,
}

impl<const N: usize> GlsSettings<N> {
    /// Standard settings for a basis, of joints as large as a Panda's; bounds [0, 5] Nm s/rad, [0, 5] Nm, [0, 1.5] Nm.
    pub fn new(basis: Basis) -> Self {
        Self {
            basis,
            force_sd_n: 0.1,
            moment_sd_nm: 0.02,
            stuck_coulomb_nm: [0.6; N],
            correlated_samples: 50.0,
            prior_sd: [[1.0, 0.7, 0.5]; N],
            lower: [[0.0; 3]; N],
            upper: [[5.0, 5.0, 1.5]; N],
            offset_sd_nm: None,
            payload_sd_kg: None,
        }
    }

    /// The same with nuisances: torque offsets (prior sd 0.5 Nm) and a mass at the flange (prior sd 1 kg).
    pub fn with_nuisances(mut self) -> Self {
        self.offset_sd_nm = Some(0.5);
        self.payload_sd_kg = Some(1.0);
        self
    }
}
