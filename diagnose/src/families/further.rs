//! Causes whose torque no family has: what a search for single causes finds in what the families leave.
//!
//! ```text
//! left = y − (1 + g)(τ0 + A μ) → search among pushes, warmth, waves of the motor, springs of the gears, friction that differs by direction
//! keep while   Σ_j (n_j/2κ_j) ln(left_j²/left'_j²) − (p/2) ln n/κ  >  10 nat
//! ```
//!
//! κ is that of what is left with the cause: a push that is none leaves a residual as correlated as before.

use std::sync::Arc;

use tribo_posterior::{LEAST_NATS, kappa};
use tribo_regression::{CauseLabel, DiagnoseError, LoggedMotion, Nominal, RegressionData, rms, subtracted};

use crate::DiagnoseSettings;
use crate::cause_by_cause::{Question, cause_by_cause};
use crate::diagnosis::Finding;

/// Labels that are looked for beyond the families.
const BEYOND: [CauseLabel; 5] = [
    CauseLabel::ExternalContact,
    CauseLabel::ThermalFriction,
    CauseLabel::TorqueRipple,
    CauseLabel::JointElasticity,
    CauseLabel::CoulombAsymmetry,
];
/// Labels that the search may use beside them, which the families then take back.
const BESIDE: [CauseLabel; 3] = [CauseLabel::Coulomb, CauseLabel::Viscous, CauseLabel::TorqueOffset];

/// Findings with their effects, strongest first, that `model` lacks: the nominal model with all families at their posterior mean; `weights` are those
/// of every joint's rows.
pub(crate) fn further_causes<const N: usize>(
    logged: &Arc<LoggedMotion<N>>,
    model: &Nominal<N>,
    weights: &[Vec<f64>],
    settings: &DiagnoseSettings,
    step: &dyn Fn(&str, f64) -> Result<(), DiagnoseError>,
) -> Result<Vec<Finding>, DiagnoseError> {
    let looked_for = |label: CauseLabel| BEYOND.contains(&label) || BESIDE.contains(&label);
    let mut data = RegressionData::of_motion(logged, model)?;
    let residual_nm = data.residual_nm.clone();
    let question =
        Question { looked_for: &looked_for, most_kinds: None, plain_fits: None, validate: &[], before: None };
    let Some(found) = cause_by_cause(&question, &mut data, settings, step)? else {
        return Ok(Vec::new());
    };
    data.residual_nm = residual_nm;
    // A second encoder shows springs better than torques do: see `deflection`.
    let news = |finding: &Finding| {
        let by_encoders = finding.label == CauseLabel::JointElasticity && data.deflection_rad.is_some();
        BEYOND.contains(&finding.label) && !by_encoders
    };
    let (mut candidates, known): (Vec<Finding>, Vec<Finding>) = found.findings.into_iter().partition(news);
    let mut beside: Vec<Finding> = known.into_iter().filter(|finding| BESIDE.contains(&finding.label)).collect();
    let mut left = data.residual_nm.clone();
    let mut kept = Vec::new();
    loop {
        // Warm friction is less than that of the families, cold friction more: what they take back at its joint is part of the cause, as
        // far as it is worth nothing by itself.
        let worth = |finding: &Finding| {
            let mut taken_back = beside.iter().filter(|other| other.location == finding.location);
            let unfitted = taken_back.try_fold(left.clone(), |left, other| without(&data, &left, other))?;
            let by_itself = evidence(weights, &left, &unfitted, 0).max(0.0);
            let after = without(&data, &unfitted, finding)?;
            Some((evidence(weights, &left, &after, parameters(finding.label)) - by_itself, after))
        };
        let best = candidates.iter().enumerate().filter_map(|(i, finding)| Some((i, worth(finding)?)));
        let best = best.max_by(|a, b| a.1.0.total_cmp(&b.1.0));
        let Some((i, (nats, after))) = best.filter(|(_, (nats, _))| *nats > LEAST_NATS) else { return Ok(kept) };
        left = after;
        let mut finding = candidates.remove(i);
        beside.retain(|other| other.location != finding.location);
        finding.evidence = 2.0 * nats;
        kept.push(finding);
    }
}

/// What is left without the torque of a finding (Nm), or `None` where it has none.
fn without<const N: usize>(data: &RegressionData<N>, left: &[Vec<f64>; N], finding: &Finding) -> Option<[Vec<f64>; N]> {
    let torque = data.effect_torque(finding.effect.as_ref()?)?;
    Some(subtracted(left.clone(), &[data.filter(&torque)], &[1.0]))
}

/// By how much the log is likelier (nat), every row with the weight that it has in the fit.
fn evidence<const N: usize>(
    weights: &[Vec<f64>],
    before: &[Vec<f64>; N],
    after: &[Vec<f64>; N],
    parameters: usize,
) -> f64 {
    let (mut gain, mut counted) = (0.0, 0.0);
    for j in 0..N {
        let weighted = |x: &[f64]| -> Vec<f64> { x.iter().zip(&weights[j]).map(|(x, weight)| x * weight).collect() };
        let (with, without) = (weighted(&after[j]), weighted(&before[j]));
        let count = with.len() as f64 / kappa(&with);
        gain += count * (rms(&without) / rms(&with).max(f64::MIN_POSITIVE)).ln();
        counted += count;
    }
    gain - 0.5 * parameters as f64 * counted.max(1.0).ln()
}

/// Free numbers of a cause, places and shapes among them.
fn parameters(label: CauseLabel) -> usize {
    match label {
        CauseLabel::ExternalContact => 8,
        CauseLabel::TorqueRipple => 3,
        CauseLabel::CoulombAsymmetry => 1,
        _ => 2,
    }
}
