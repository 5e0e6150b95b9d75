//! What may be tried on a robot: never much more compensation than it has friction.

use std::sync::Arc;

use tribo_bayesopt::Allowed;
use tribo_friction::identify::GlsFit;

use crate::strategy::{Identification, LogSource, Origin, Past, Proposal, Strategy, StrategyError};
use crate::{ParameterSpace, ValidTune};

/// Speeds at which compensation and friction are compared [rad/s].
const SPEEDS_RAD_S: [f64; 7] = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0];
/// Standard deviations of the identified friction that are allowed for.
const DEVIATIONS: f64 = 2.0;
/// Relative difference of two torques that are the same.
const ROUNDING: f64 = 1e-9;

/// Holds proposals back to what the logs of the campaign vouch for:
///
/// ```text
/// tau_c(qd) ≤ r (tau_f(qd) + 2 σ(qd))      for every joint and |qd| of 0.01 to 1 rad/s
/// ```
///
/// tau_f is the friction that least squares finds in the last logs ([`Identification::before`]), σ its standard deviation, r
/// `guard.predicted_ratio`. A joint that asks for more gets all its torques scaled down; speeds and shapes stay. Before a log tells
/// anything there is no compensation at all.
///
/// A law that is wrong for the robot bounds what is tried by what it explains of the logs, and no better.
pub struct FrictionLimit<const N: usize> {
    space: ParameterSpace,
    /// What knows the friction, and the ratio r; none where the settings have no guard, and every proposal may be tried.
    guard: Option<(Arc<Identification<N>>, f64)>,
}

impl<const N: usize> FrictionLimit<N> {
    /// The limit of a campaign, with the identification of the same settings.
    pub fn of(tune: &ValidTune<N>, identification: &Arc<Identification<N>>) -> Self {
        let guard = tune.config.guard.map(|guard| (Arc::clone(identification), guard.predicted_ratio));
        Self { space: tune.space.clone(), guard }
    }

    /// What the last trials before trial `number` let pass; none without a guard.
    ///
    /// # Errors
    /// A log that cannot be read.
    #[inline(never)]
    pub fn before(&self, number: usize, logs: &dyn LogSource<N>) -> Result<Option<Allowance<'_>>, StrategyError> {
        let Some((identification, ratio)) = &self.guard else { return Ok(None) };
        let fit = identification.before(number, logs)?;
        Ok(Some(Allowance::of(&self.space, fit.as_ref(), *ratio)))
    }

    /// Looks at the trials before trial `number`, all of which have ended, ahead of [`Self::before`]; an error is for that to report.
    pub fn learn(&self, number: usize, logs: &dyn LogSource<N>) {
        if let Some((identification, _)) = &self.guard {
            let _ = identification.before(number, logs);
        }
    }

    /// Whether the trials before trial `number` tell enough for trials of a design to run side by side.
    ///
    /// # Errors
    /// A log that cannot be read.
    pub fn knows(&self, number: usize, logs: &dyn LogSource<N>) -> Result<bool, StrategyError> {
        match &self.guard {
            None => Ok(true),
            Some((identification, _)) => Ok(first_known(identification, number, logs)?.is_some()),
        }
    }

    /// A proposal of a design as it may be tried: trials that run side by side all take what the first trials before `number` tell
    /// that tell enough.
    ///
    /// # Errors
    /// A log that cannot be read.
    pub fn hold_back_design(
        &self,
        proposal: Proposal,
        number: usize,
        logs: &dyn LogSource<N>,
    ) -> Result<Proposal, StrategyError> {
        let Some((identification, _)) = &self.guard else { return Ok(proposal) };
        let known = first_known(identification, number, logs)?.unwrap_or(number);
        self.hold_back(proposal, known, logs)
    }

    /// A proposal as it may be tried, given what the last trials before trial `number` tell.
    ///
    /// # Errors
    /// A log that cannot be read.
    pub fn hold_back(
        &self,
        proposal: Proposal,
        number: usize,
        logs: &dyn LogSource<N>,
    ) -> Result<Proposal, StrategyError> {
        Ok(held_back(proposal, self.before(number, logs)?.as_ref()))
    }

    /// What a strategy proposes for trial `number`, which knows the limit if it likes, as it may be tried.
    ///
    /// # Errors
    /// A log that cannot be read; a strategy without an answer.
    pub fn proposal(
        &self,
        strategy: &dyn Strategy<N>,
        number: usize,
        past: Past<'_>,
        logs: &dyn LogSource<N>,
    ) -> Result<Proposal, StrategyError> {
        let allowed = self.before(number, logs)?;
        let past = Past { allowed: allowed.as_ref().map(Allowance::as_dyn), ..past };
        Ok(held_back(strategy.propose(number, past, logs)?, allowed.as_ref()))
    }
}

fn held_back(mut proposal: Proposal, allowed: Option<&Allowance<'_>>) -> Proposal {
    if allowed.is_some_and(|allowed| allowed.cut(&mut proposal.theta)) {
        proposal.origin = Origin::Guard;
    }
    proposal
}

/// What the logs before one trial let pass.
#[derive(Clone, Debug)]
pub struct Allowance<'a> {
    space: &'a ParameterSpace,
    /// Most torque of each joint at each of the speeds compared (Nm).
    most_nm: Vec<[f64; SPEEDS_RAD_S.len()]>,
    /// Largest value of each parameter, the others at zero.
    highest: Vec<f64>,
}

impl<'a> Allowance<'a> {
    fn of<const N: usize>(space: &'a ParameterSpace, fit: Option<&GlsFit<N>>, ratio: f64) -> Self {
        let most_nm = (0..space.joints()).map(|joint| {
            SPEEDS_RAD_S.map(|qd| {
                let friction_nm = |fit: &GlsFit<N>| {
                    let expected_nm = fit.friction.joints[joint].torque(qd, 0.0).max(0.0);
                    expected_nm + DEVIATIONS * fit.torque_sd_nm(joint, qd)
                };
                ratio * fit.map_or(0.0, friction_nm)
            })
        });
        let mut allowed = Self { space, most_nm: most_nm.collect(), highest: Vec::new() };
        let alone = |(k, (_, _, high)): (usize, &(&str, f64, f64))| {
            let mut theta = space.zero();
            theta[k] = *high;
            allowed.cut(&mut theta);
            theta[k]
        };
        allowed.highest = space.entries().iter().enumerate().map(alone).collect();
        allowed
    }

    /// As strategies take it.
    pub fn as_dyn(&self) -> &dyn Allowed {
        self
    }

    /// Scales the torques of every joint down to what is allowed; whether there was something to scale.
    fn cut(&self, theta: &mut [f64]) -> bool {
        let mut cut = false;
        for (joint, (law, most_nm)) in self.space.joint_laws(theta).iter().zip(&self.most_nm).enumerate() {
            let asked_nm = SPEEDS_RAD_S.map(|qd| law.torque(qd, 0.0).abs());
            let over = |(asked_nm, most_nm): (&f64, &f64)| if asked_nm > most_nm { most_nm / asked_nm } else { 1.0 };
            let share = asked_nm.iter().zip(most_nm).map(over).fold(1.0, f64::min);
            // What was cut before is past the limit by its rounding.
            if share < 1.0 - ROUNDING {
                self.space.scale_torques(theta, joint, share);
                cut = true;
            }
        }
        cut
    }
}

impl Allowed for Allowance<'_> {
    fn highest(&self) -> &[f64] {
        &self.highest
    }

    fn hold_back(&self, theta: &mut [f64]) {
        self.cut(theta);
    }
}

/// The first trial whose predecessors tell how much friction there is, at most `number`; none if not even those of `number` do.
fn first_known<const N: usize>(
    identification: &Identification<N>,
    number: usize,
    logs: &dyn LogSource<N>,
) -> Result<Option<usize>, StrategyError> {
    for known in 1..=number {
        if identification.before(known, logs)?.is_some() {
            return Ok(Some(known));
        }
    }
    Ok(None)
}
