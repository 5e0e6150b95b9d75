//! Dry friction that builds up over a distance after reversals.

use tribo_sim::Effect;

use super::{Candidate, log_grid};
use crate::column::FineColumn;
use crate::label::{CauseLabel, Location};
use crate::regression_data::RegressionData;

/// `Fc (z − s)`, z the Dahl bristle ratio, profiled over its distance d:
///
/// ```text
/// dz = (dq − |dq| z) / d,   |z| ≤ 1,   s = tanh(qd/ε)
/// ```
///
/// Independent of rate: z depends on the travel alone, exactly `z⁺ = σ + (z − σ) exp(−|dq|/d)`, σ = sign(dq). Needs
/// reversals. Confusable with Stribeck friction where all speed is low.
pub(super) struct Presliding {
    pub joint: usize,
}

/// Distances of gears, at the joint (rad).
const DISTANCE_RAD: [f64; 2] = [1e-4, 3e-2];
/// The bristle carries the joint's Coulomb friction within this factor, where the model knows it.
const COULOMB_FACTOR: [f64; 2] = [0.3, 3.0];

impl<const N: usize> Candidate<N> for Presliding {
    fn label(&self) -> CauseLabel {
        CauseLabel::Presliding
    }

    fn location(&self) -> Location {
        Location::Joint(self.joint)
    }

    fn shapes(&self, _data: &RegressionData<N>) -> Vec<Vec<f64>> {
        log_grid(DISTANCE_RAD[0], DISTANCE_RAD[1], 8)
    }

    fn profile(&self) -> Option<[f64; 2]> {
        Some(DISTANCE_RAD)
    }

    fn columns(&self, data: &RegressionData<N>, shape: &[f64]) -> Vec<FineColumn<N>> {
        let j = self.joint;
        let z = bristle(data, j, shape[0]);
        vec![FineColumn::Joint(j, z.iter().zip(&data.of_model).map(|(z, at)| z - at.sign[j]).collect())]
    }

    fn admissible(&self, data: &RegressionData<N>, _shape: &[f64], coefficients: &[f64]) -> bool {
        let dry_nm = data.nominal.dry_nm(self.joint);
        let [low, high] = COULOMB_FACTOR.map(|factor| factor * dry_nm);
        coefficients[0] > low && (dry_nm == 0.0 || coefficients[0] < high)
    }

    fn effect(&self, _data: &RegressionData<N>, shape: &[f64], _coefficients: &[f64]) -> Option<Effect> {
        Some(Effect::Presliding { joint: self.joint, presliding_distance_rad: shape[0], amplitude_nm: None })
    }
}

/// Dahl's bristle ratio z along the samples of a joint, 0 at the start of each burst.
pub fn bristle<const N: usize>(data: &RegressionData<N>, j: usize, distance_rad: f64) -> Vec<f64> {
    let mut ratios = Vec::with_capacity(data.motion.len());
    for burst in &data.bursts {
        let mut z = 0.0;
        let mut last = None;
        for at in &data.motion[burst.fine.clone()] {
            let travel = at.q[j] - last.unwrap_or(at.q[j]);
            let toward = travel.signum();
            z = toward + (z - toward) * (-travel.abs() / distance_rad).exp();
            last = Some(at.q[j]);
            ratios.push(z);
        }
    }
    ratios
}
