//! What may be tried on a robot: never much more compensation than it has friction.

use tribo_friction::JointFriction;
use tribo_friction::identify::{GlsError, GlsFit};

use crate::strategy::{GreyBox, LogSource, Origin, Proposal, StrategyError};
use crate::{ParameterSpace, ValidTune};

/// Speeds at which compensation and friction are compared [rad/s].
const SPEEDS_RAD_S: [f64; 7] = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0];
/// Standard deviations of the identified friction that are allowed for.
const DEVIATIONS: f64 = 2.0;

/// Holds proposals back to what the logs of the campaign vouch for:
///
/// ```text
/// tau_c(qd) ≤ r (tau_f(qd) + 2 σ(qd))      for every joint and |qd| of 0.01 to 1 rad/s
/// ```
///
/// tau_f is the friction that least squares finds in the last logs ([`GreyBox::identify`]), σ its standard deviation, r
/// `guard.predicted_ratio`. A joint that asks for more gets all its torques scaled down; speeds and shapes stay. Before a log tells
/// anything there is no compensation at all.
///
/// A law that is wrong for the robot bounds what is tried by what it explains of the logs, and no better.
pub struct FrictionLimit<const N: usize> {
    space: ParameterSpace,
    /// What knows the friction, and the ratio r; none where the settings have no guard, and every proposal may be tried.
    guard: Option<(GreyBox<N>, f64)>,
}

impl<const N: usize> FrictionLimit<N> {
    /// The limit of a campaign.
    ///
    /// # Errors
    /// An estimator that cannot be had.
    pub fn of(tune: &ValidTune<N>) -> Result<Self, StrategyError> {
        let guard = tune.config.guard.map(|guard| Ok::<_, StrategyError>((GreyBox::new(tune)?, guard.predicted_ratio)));
        Ok(Self { space: tune.space.clone(), guard: guard.transpose()? })
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
        let Some((identification, ratio)) = &self.guard else { return Ok(proposal) };
        let fit = friction_before(identification, number, logs)?;
        let mut theta = proposal.theta;
        let mut held_back = false;
        for (j, law) in self.space.joint_laws(&theta).iter().enumerate() {
            let share = fit.as_ref().map_or(0.0, |fit| share(law, fit, j, *ratio));
            if share < 1.0 && peak_nm(law) > 0.0 {
                self.space.scale_torques(&mut theta, j, share);
                held_back = true;
            }
        }
        Ok(Proposal { theta, origin: if held_back { Origin::Guard } else { proposal.origin } })
    }
}

/// The first trial whose predecessors tell how much friction there is, at most `number`; none if not even those of `number` do.
fn first_known<const N: usize>(
    identification: &GreyBox<N>,
    number: usize,
    logs: &dyn LogSource<N>,
) -> Result<Option<usize>, StrategyError> {
    for known in 1..=number {
        if friction_before(identification, known, logs)?.is_some() {
            return Ok(Some(known));
        }
    }
    Ok(None)
}

fn friction_before<const N: usize>(
    identification: &GreyBox<N>,
    number: usize,
    logs: &dyn LogSource<N>,
) -> Result<Option<GlsFit<N>>, StrategyError> {
    match identification.identify(number, logs) {
        // Trials that were stopped at once.
        Err(StrategyError::Identification(GlsError::TooFewSamples { .. })) => Ok(None),
        fit => fit,
    }
}

/// Share of a joint's compensation that may act [-].
fn share<const N: usize>(law: &JointFriction, fit: &GlsFit<N>, joint: usize, ratio: f64) -> f64 {
    let share = |&qd: &f64| {
        let friction_nm =
            fit.friction.joints[joint].torque(qd, 0.0).max(0.0) + DEVIATIONS * fit.torque_sd_nm(joint, qd);
        let (most_nm, asked_nm) = (ratio * friction_nm, law.torque(qd, 0.0).abs());
        if asked_nm > most_nm { most_nm / asked_nm } else { 1.0 }
    };
    SPEEDS_RAD_S.iter().map(share).fold(1.0, f64::min)
}

/// Largest torque of a law at the speeds compared (Nm).
fn peak_nm(law: &JointFriction) -> f64 {
    SPEEDS_RAD_S.iter().map(|&qd| law.torque(qd, 0.0).abs()).fold(0.0, f64::max)
}
