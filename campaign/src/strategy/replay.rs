//! What a trial would have cost with other parameters.

use nalgebra::Vector6;
use tribo_friction::FrictionModel;
use tribo_friction::identify::GlsSample;
use tribo_robot::Wrench;
use tribo_trial::{CostAccumulator, CostMeasure};

/// Speed below which a joint counts as standing [rad/s].
pub(super) const STUCK_RAD_S: f64 = 0.004;

/// The judged part of one log, from which J of other compensators follows:
///
/// ```text
/// h_t(θ) = h_hat_t + W_t (tau_c(θ_log, qd_t) − tau_c(θ, qd_t)),      J(θ) from h_t(θ) as from any wrench
/// ```
///
/// h_hat, W and qd are those of [`GlsSample`]. The noise of one log is the same for all θ, so that differences of J are known far better
/// than J repeats from trial to trial. A joint that stands takes up a changed compensation by its stiction: its torque counts as
/// unchanged. The motion counts as unchanged, too, which holds for parameters that differ little.
#[derive(Clone, Debug)]
pub(crate) struct Replay<'a, const N: usize> {
    /// Samples of the judged part.
    pub samples: &'a [GlsSample<N>],
    /// The friction that the compensator believed when the log was taken.
    pub compensated: FrictionModel<N>,
    /// What makes J of a wrench.
    pub measure: CostMeasure,
}

impl<const N: usize> Replay<'_, N> {
    /// J of a compensator that believes this friction.
    pub fn cost(&self, friction: &FrictionModel<N>) -> f64 {
        let mut accumulator = CostAccumulator::new(self.measure);
        for sample in self.samples {
            accumulator.add(&Wrench::from_vector(&self.wrench(sample, friction)));
        }
        accumulator.finish(None, 1.0).total()
    }

    /// The most by which J can differ between two compensators along this motion: J of the difference of their wrenches, whatever the
    /// estimator makes of the rest (triangle inequality).
    pub fn largest_change(&self, one: &FrictionModel<N>, other: &FrictionModel<N>) -> f64 {
        let mut accumulator = CostAccumulator::new(self.measure);
        for sample in self.samples {
            let change = self.wrench(sample, one) - self.wrench(sample, other);
            accumulator.add(&Wrench::from_vector(&change));
        }
        accumulator.finish(None, 1.0).total()
    }

    fn wrench(&self, sample: &GlsSample<N>, friction: &FrictionModel<N>) -> Vector6<f64> {
        let mut wrench = sample.wrench;
        for (j, qd) in sample.qd.iter().enumerate() {
            if qd.abs() > STUCK_RAD_S {
                let before = self.compensated.joints[j].torque(*qd, 0.0);
                let change = before - friction.joints[j].torque(*qd, 0.0);
                wrench += sample.wrench_from_torque.column(j) * change;
            }
        }
        wrench
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{SMatrix, SVector};
    use tribo_friction::law::CoulombViscous;

    use super::*;

    fn friction(coulomb_nm: f64) -> FrictionModel<7> {
        FrictionModel { joints: [CoulombViscous { coulomb_nm, viscous_nm_s_per_rad: 0.0 }.into(); 7] }
    }

    /// Closed form: joint 0 makes a force along z of its torque; 0.5 Nm of dry friction, of which 0.2 Nm were compensated.
    #[test]
    fn what_was_not_compensated_is_what_is_felt() {
        let mut map = SMatrix::<f64, 6, 7>::zeros();
        map[(5, 0)] = 1.0;
        let sample = |k: usize| {
            let qd = SVector::from_fn(|j, _| if j == 0 { [0.1, -0.1, 0.001][k % 3] } else { 0.0 });
            let wrench = Vector6::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.3 * f64::signum(qd[0]));
            GlsSample { wrench, wrench_from_torque: map, qd, slides: [true; 7], tau_compensation: SVector::zeros() }
        };
        let samples: Vec<_> = (0..300).map(sample).collect();
        let replay = Replay { samples: &samples, compensated: friction(0.2), measure: CostMeasure::Paper };
        assert!((replay.cost(&friction(0.2)) - 0.6).abs() < 1e-12, "as it was");
        // A joint that stands in a third of the samples keeps what it had in these.
        assert!((replay.cost(&friction(0.5)) - (0.3 + 0.1)).abs() < 1e-12);
        assert!((replay.largest_change(&friction(0.2), &friction(0.5)) - (0.3 + 0.2)).abs() < 1e-12);
        assert!((replay.cost(&friction(0.9)) - (0.4 + (2.0 * 0.4 + 0.3) / 3.0)).abs() < 1e-12);
    }
}
