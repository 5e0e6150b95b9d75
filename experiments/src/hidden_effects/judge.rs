//! An answer against what was hidden.

use tribo_diagnose::{Diagnosis, Verdict};
use tribo_logs::RobotLog;
use tribo_regression::{CauseLabel, Nominal, ResidualError, ResidualSettings, TorqueResidual};
use tribo_sim::Effect;

use super::claim::{Claim, claims, is_background, is_background_cause, names, place, right_value};
use super::{HiddenCase, World, parameter_errors};

/// What is right and wrong in a diagnosis.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement {
    /// Whether anything was found at all.
    pub detected: bool,
    /// Whether the first finding is a hidden cause at its place.
    pub top_one: bool,
    /// Per hidden cause: whether a finding names it at its place.
    pub found: Vec<bool>,
    /// Per hidden cause: whether a finding or one of its alternatives names it at its place.
    pub listed: Vec<bool>,
    /// Findings that are not hidden causes, in words. With a torque outside the vocabulary `unknown` is none of them.
    pub false_findings: Vec<String>,
    /// Verdict `named` with a name that is wrong: what a user would act on.
    pub confidently_wrong: bool,
    /// Errors of the main parameters of the causes that were found.
    pub parameter_errors: Vec<(CauseLabel, &'static str, f64)>,
    /// Part of the held-out residual that the findings remove [-].
    pub gain: f64,
    /// Part of the residual in the same band that the truth removes [-].
    pub truth_gain: f64,
}

impl Judgement {
    /// Compares.
    ///
    /// A finding of several joints claims each of them.
    ///
    /// # Errors
    /// [`ResidualError`] if a log has no residual, which its diagnosis would have met before.
    pub fn of(case: &HiddenCase, diagnosis: &Diagnosis) -> Result<Self, ResidualError> {
        let hidden = &case.hidden;
        let claims = claims(diagnosis);
        let named = |effect: &Effect| match right_value(effect, case, diagnosis) {
            Some(right) if case.world == World::WrongEverywhere => right,
            _ => claims.iter().any(|claim| names((claim.label, claim.location), effect, case)),
        };
        let found: Vec<bool> = hidden.iter().map(named).collect();
        let listed: Vec<bool> = hidden
            .iter()
            .zip(&found)
            .map(|(effect, found)| {
                let rivals = diagnosis.findings.iter().flat_map(|finding| &finding.alternatives);
                *found || rivals.into_iter().any(|rival| names((rival.label, rival.location), effect, case))
            })
            .collect();
        let right = |claim: &Claim| {
            hidden.iter().any(|effect| names((claim.label, claim.location), effect, case))
                || (case.extra.is_some() && claim.label == CauseLabel::Unknown)
        };
        let telling: Vec<&Claim> =
            claims.iter().filter(|claim| !is_background(claim, case.world) || right(claim)).collect();
        let mut false_findings: Vec<String> = telling
            .iter()
            .filter(|claim| !right(claim))
            .map(|claim| format!("{}@{}", claim.label, claim.location))
            .collect();
        // What the model lacks everywhere is no news; of the rest the first must be a hidden cause.
        let by_value =
            hidden.iter().zip(&found).any(|(effect, found)| *found && is_background_cause(effect, case.world));
        let strangers = claims.iter().find(|claim| !is_background(claim, case.world));
        let top_one = match strangers {
            Some(first) => right(first),
            None => by_value || telling.first().is_some_and(|first| right(first)),
        };
        // "Something is there" is false where nothing is.
        let nothing = hidden.is_empty() && case.extra.is_none();
        if nothing
            && case.world == World::Identified
            && diagnosis.findings.is_empty()
            && diagnosis.verdict != Verdict::NothingMissing
        {
            false_findings.push(diagnosis.verdict.name().to_owned());
        }
        let errors = hidden.iter().flat_map(|effect| {
            let finding = diagnosis.findings.iter().find(|f| (f.label, f.location) == place(effect));
            let pairs = finding.and_then(|f| f.effect.as_ref()).map(|found| parameter_errors(found, effect));
            pairs.unwrap_or_default().into_iter().map(|(name, error)| (CauseLabel::of(effect), name, error))
        });
        Ok(Self {
            detected: !diagnosis.findings.is_empty(),
            top_one,
            found,
            listed,
            confidently_wrong: diagnosis.verdict == Verdict::Named && !false_findings.is_empty(),
            false_findings,
            parameter_errors: errors.collect(),
            gain: diagnosis.gain_heldout,
            truth_gain: truth_gain(case, diagnosis)?,
        })
    }
}

/// `1 − RMS after/RMS before` over all joints and logs, after: the same logs of an arm without anything hidden.
///
/// Of torques; of theta − q where encoders alone show what is hidden, as in the diagnosis.
fn truth_gain(case: &HiddenCase, diagnosis: &Diagnosis) -> Result<f64, ResidualError> {
    let two_encoders = case.logs.iter().all(|log| log.theta_rad.is_some());
    let by_encoders = |effect: &Effect| matches!(effect, Effect::Backlash { .. } | Effect::JointElasticity { .. });
    let joints: Vec<usize> =
        case.hidden.iter().filter(|effect| by_encoders(effect)).filter_map(Effect::joint).collect();
    let of_encoders = two_encoders && !joints.is_empty() && joints.len() == case.hidden.len();
    let squares = |logs: &[RobotLog]| -> Result<f64, ResidualError> {
        let sums = logs.iter().map(|log| {
            let residual = residual(log, &case.nominal, diagnosis)?;
            Ok(if of_encoders {
                joints.iter().map(|joint| deflection_squares(&residual, *joint)).sum()
            } else {
                torque_squares(&residual, &case.nominal)
            })
        });
        sums.sum()
    };
    Ok(1.0 - (squares(&case.twins)? / squares(&case.logs)?.max(1e-30)).sqrt())
}

/// The signal chain in the band and at the rate of the diagnosis.
fn residual(log: &RobotLog, nominal: &Nominal<7>, diagnosis: &Diagnosis) -> Result<TorqueResidual<7>, ResidualError> {
    let rate_hz = tribo_logs::median_period_s(&log.time_s).unwrap_or(1.0).recip();
    let average_samples = (rate_hz / diagnosis.rate_hz).round().max(1.0) as usize;
    let settings = ResidualSettings {
        band_hz: diagnosis.band_hz.min(0.3 * rate_hz),
        longest_gap_s: None,
        average_samples,
        ..ResidualSettings::default()
    };
    TorqueResidual::of_log(log, &nominal.arm, &settings)
}

/// Sum of squares of measured less nominal torque [Nm²].
fn torque_squares(rigid: &TorqueResidual<7>, nominal: &Nominal<7>) -> f64 {
    let friction = rigid.joint_columns(|at| nominal.friction.torque(&at.qd, nominal.smoothing_rad_s));
    let pairs = rigid.residual_nm.iter().flatten().zip(friction.iter().flatten());
    pairs.map(|(residual, friction)| (residual - friction).powi(2)).sum()
}

/// Sum of squares of theta − q around its mean [rad²].
fn deflection_squares(residual: &TorqueResidual<7>, joint: usize) -> f64 {
    let bursts = residual.deflection_rad().unwrap_or_default();
    let values: Vec<f64> = bursts.iter().flatten().map(|deflection| deflection[joint]).collect();
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    values.iter().map(|value| (value - mean).powi(2)).sum()
}
