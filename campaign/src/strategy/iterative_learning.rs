//! Iterative learning of friction from the motion alone: the route that Bayesian optimisation replaced.

use tribo_trial::TrialLog;

use super::{LogSource, Origin, Past, Proposal, Strategy, StrategyError};
use crate::ParameterSpace;

/// Learning gain of the Coulomb friction.
const COULOMB_GAIN: f64 = 0.1;
/// Learning gain of the viscous friction.
const VISCOUS_GAIN: f64 = 0.05;
/// Speed (rad/s) below which a joint says nothing about its direction.
const SLOWEST_RAD_S: f64 = 0.02;

/// P-type iterative learning, in the manner of the earlier work that roveda2022 compares with (its ref. 12): no wrench
/// estimate, a fixed gain matrix, one step per trial from zero compensation.
///
/// ```text
/// Fc ← Fc + L_c mean(τ sign q̇),   Fv ← Fv + L_v Σ τ q̇ / Σ q̇²      over samples with |q̇| > 0.02 rad/s
/// ```
///
/// τ is the torque with which the impedance controller pulls a joint towards the reference: where friction is compensated
/// too little it goes with the velocity. Ref. 12 gives neither its law in this detail nor its gains; these are the
/// largest of 0.05, 0.1, 0.2, … that let no joint overshoot.
pub(super) struct IterativeLearning {
    space: ParameterSpace,
}

impl IterativeLearning {
    pub(super) fn new(space: ParameterSpace) -> Self {
        Self { space }
    }
}

impl<const N: usize> Strategy<N> for IterativeLearning {
    fn design(&self, number: usize) -> Result<Option<Proposal>, StrategyError> {
        Ok((number == 0).then(|| Proposal { theta: self.space.zero(), origin: Origin::Constant }))
    }

    #[inline(never)]
    fn propose(&self, number: usize, past: Past<'_>, logs: &dyn LogSource<N>) -> Result<Proposal, StrategyError> {
        let last = past.finished.iter().rfind(|trial| trial.number < number);
        let mut theta = last.map_or_else(|| self.space.zero(), |trial| trial.theta.clone());
        // A trial without log teaches nothing: once more.
        if let Some(log) = last.map(|last| logs.log(last.number)).transpose()?.flatten() {
            let entries = self.space.entries();
            for (k, value) in theta.iter_mut().enumerate() {
                let (joint, (name, low, high)) = (k / self.space.parameters_per_joint(), entries[k]);
                let step = match name {
                    "coulomb_nm" => COULOMB_GAIN * missing(&log, joint, f64::signum),
                    "viscous_nm_s_per_rad" => VISCOUS_GAIN * missing(&log, joint, |qd| qd),
                    _ => 0.0,
                };
                *value = (*value + step).clamp(low, high);
            }
        }
        Ok(Proposal { theta, origin: Origin::Learning })
    }
}

/// `Σ τ φ(q̇) / Σ φ(q̇)²` over the samples in which the joint moves.
fn missing<const N: usize>(log: &TrialLog<N>, joint: usize, regressor: impl Fn(f64) -> f64) -> f64 {
    let samples = log.qd.iter().zip(&log.tau_task).map(|(qd, tau)| (qd[joint], tau[joint]));
    let (mut product, mut square) = (0.0, 0.0);
    for (qd, tau) in samples.filter(|(qd, _)| qd.abs() > SLOWEST_RAD_S) {
        let x = regressor(qd);
        product += tau * x;
        square += x * x;
    }
    if square > 0.0 { product / square } else { 0.0 }
}
