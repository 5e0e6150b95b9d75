//! The effects that a model file adds to arm and friction, along the motion of a log.

use std::sync::Arc;

use nalgebra::SVector;
use tribo_sim::Effect;

use crate::cause::{candidate_of_effect, interpolated};
use crate::column::FineColumn;
use crate::regression_data::RegressionData;

impl<const N: usize> RegressionData<N> {
    /// The effects that the model has already, rigid ones aside, which are in its arm:
    ///
    /// ```text
    /// model(t) = (1 + g) (rigid + friction + effects)(t − delay)
    /// ```
    pub(crate) fn add_nominal_effects(&mut self) {
        let mut effects: Vec<Effect> = self.nominal.effects.clone();
        // Warm friction fades as a whole: what adds to dry and viscous friction comes first.
        effects.sort_by_key(|effect| !matches!(effect, Effect::Coulomb { .. } | Effect::Viscous { .. }));
        let logged = Arc::clone(&self.logged);
        let (mut gain, mut delay_s) = (SVector::<f64, N>::repeat(1.0), 0.0);
        for effect in &effects {
            match *effect {
                Effect::Coulomb { joint, delta_coulomb_nm } => {
                    self.of_model.iter_mut().for_each(|at| at.friction_nm[joint] += delta_coulomb_nm * at.sign[joint]);
                }
                Effect::Viscous { joint, delta_viscous_nm_s_per_rad } => {
                    let slope = delta_viscous_nm_s_per_rad;
                    let pairs = self.of_model.iter_mut().zip(&logged.motion);
                    pairs.for_each(|(of_model, at)| of_model.friction_nm[joint] += slope * at.qd[joint]);
                }
                Effect::TorqueGain { joint, gain_error } => {
                    gain[joint] *= 1.0 + gain_error;
                    continue;
                }
                Effect::TimeDelay { delay_s: of_effect } => {
                    delay_s += of_effect;
                    continue;
                }
                _ => {}
            }
            let Some(torque) = self.effect_torque(effect) else { continue };
            match torque {
                FineColumn::Joint(j, column) => {
                    self.of_model.iter_mut().zip(column).for_each(|(at, tau)| at.model_nm[j] += tau);
                }
                FineColumn::Arm(column) => {
                    self.of_model.iter_mut().zip(column).for_each(|(at, tau)| at.model_nm += tau)
                }
            }
        }
        self.of_model.iter_mut().for_each(|at| at.model_nm.component_mul_assign(&gain));
        if delay_s != 0.0 {
            for burst in &logged.bursts {
                let prompt: Vec<SVector<f64, N>> =
                    self.of_model[burst.fine.clone()].iter().map(|at| at.model_nm).collect();
                let back = delay_s / logged.period_s(burst);
                for (k, at) in self.of_model[burst.fine.clone()].iter_mut().enumerate() {
                    at.model_nm = interpolated(prompt.len(), k as f64 - back, |i| prompt[i]);
                }
            }
        }
    }

    /// Torque of an effect along the motion, or `None` where it is not a torque (such as backlash).
    pub fn effect_torque(&self, effect: &Effect) -> Option<FineColumn<N>> {
        let (candidate, shape, coefficients) = candidate_of_effect::<N>(effect)?;
        let columns = candidate.columns(self, &shape);
        // A bristle carries whatever Coulomb friction its joint has.
        let coefficients = coefficients.into_iter().map(|c| match effect {
            Effect::Presliding { joint, amplitude_nm, .. } => {
                amplitude_nm.unwrap_or_else(|| self.nominal.dry_nm(*joint))
            }
            _ => c,
        });
        let mut sum = vec![SVector::<f64, N>::zeros(); self.of_model.len()];
        for (column, coefficient) in columns.iter().zip(coefficients) {
            column.add_to(&mut sum, coefficient);
        }
        Some(FineColumn::Arm(sum))
    }
}
