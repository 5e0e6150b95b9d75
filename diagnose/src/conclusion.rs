//! From the findings of a search to a verdict.

use tribo_logs::RobotLog;
use tribo_regression::{CauseLabel, DiagnoseError, Location, RegressionData, rms};
use tribo_sim::Effect;

use crate::confusable::same_torque;
use crate::diagnosis::{Diagnosis, Finding, JointMisfit, Verdict};
use crate::evaluated::{Before, Evaluated};
use crate::judged::Judged;
use crate::next_experiment::next_experiment;
use crate::plots;
use crate::remarks::{misfits, note_on_baseline, notes_of};
use crate::stamps::take_stamps;
use crate::validation::validated_whole;

/// Residual over sensor noise in the band beyond which a joint without a finding has something unexplained.
const UNEXPLAINED_OVER_NOISE: f64 = 3.0;
/// The same in Nm.
const UNEXPLAINED_NM: f64 = 0.01;
/// How much larger both are where other joints have findings: those leave traces everywhere.
const BESIDE_FINDINGS: f64 = 4.0;

/// Evidence of a nameless cause, over that of all named ones, from which on it decides the verdict.
const LEAST_NAMELESS: f64 = 0.02;
/// Share of samples at rest in the filter's window from which on an output sample counts as one of a rest.
const STANDING: f64 = 0.1;
/// Parts of the log of which one at least must be motion, for motion alone to be judged.
const LEAST_MOVING_PARTS: usize = 5;

/// Draws the conclusion.
#[inline(never)]
pub(crate) fn conclude<const N: usize>(
    data: &RegressionData<N>,
    judged: Judged<N>,
    evaluated: &Evaluated<'_, N>,
    validate: &[(String, RobotLog)],
    step: &dyn Fn(&str, f64) -> Result<(), DiagnoseError>,
) -> Result<Diagnosis, DiagnoseError> {
    let Judged { mut findings, residual_after, before, after, gain, gain_ci95, unseen, rejected, assumptions } = judged;
    let Before { model: asked, residual_nm: asked_nm } = evaluated.asked(data);

    // What is reported is what the written model leaves when it is read back.
    let extension: Vec<Effect> = findings.iter().filter_map(|finding| finding.effect.clone()).collect();
    let mut extended = data.nominal.clone();
    extended.effects.extend(extension.iter().cloned());
    let band_hz = data.chains.first().map(|chain| chain.band_hz);
    let read_back_nm = RegressionData::of_motion(&data.logged, &extended)?.residual_nm;
    let joints = misfits(data, asked_nm, &read_back_nm, &before, &after);
    // The verdict.
    let mut notes = notes_of(data);
    notes.extend(take_stamps(data, &mut findings));
    let doubted = |finding: &Finding| {
        let place = (finding.label, finding.location);
        finding.alternatives.iter().any(|rival| !same_torque(&data.nominal, place, (rival.label, rival.location)))
    };
    let explained = |j: usize| {
        findings.iter().any(|finding| match finding.location {
            Location::Joint(joint) => joint == j && finding.label != CauseLabel::TorqueRipple,
            Location::Link(_) | Location::Arm => true,
        })
    };
    let worst = (0..N)
        .filter(|j| !explained(*j))
        .max_by(|a, b| over_noise(&joints[*a]).total_cmp(&over_noise(&joints[*b])))
        .filter(|j| {
            let factor = if findings.is_empty() { 1.0 } else { BESIDE_FINDINGS };
            let left_nm = joints[*j].rms_after_nm.min(rms_in_motion(data, &residual_after[*j], *j));
            left_nm > factor * UNEXPLAINED_OVER_NOISE * joints[*j].noise_floor_nm && left_nm > factor * UNEXPLAINED_NM
        });
    let named: f64 = findings.iter().filter(|f| f.label != CauseLabel::Unknown).map(|f| f.evidence).sum();
    let nameless = |f: &Finding| f.label == CauseLabel::Unknown && f.evidence > LEAST_NAMELESS * named;
    let verdict = if findings.iter().any(nameless) || worst.is_some() {
        Verdict::Unknown
    } else if findings.iter().any(doubted) {
        Verdict::Ambiguous
    } else if findings.is_empty() {
        Verdict::NothingMissing
    } else {
        Verdict::Named
    };
    notes.extend(unseen.as_ref().and_then(note_on_baseline));
    if let Some(worst) = worst {
        notes.push(format!(
            "{}: {:.3} Nm are left where the sensors' own noise is {:.3} Nm, and no cause considered goes with them",
            data.nominal.arm.joint_names.of(worst),
            joints[worst].rms_after_nm,
            joints[worst].noise_floor_nm
        ));
    }

    let overview = plots::overview(data, asked_nm);
    let pattern = plots::cross_joint_pattern(data, asked_nm);
    step("validation", 0.97)?;
    let held_against = |log| validated_whole([asked, &data.nominal], &extension, log, band_hz, evaluated.seed);
    let validation = validate.iter().map(held_against).collect::<Result<Vec<_>, _>>()?;
    let next_experiment = if data.transmission { None } else { next_experiment(data, &findings, &joints) };
    Ok(Diagnosis {
        verdict,
        findings,
        joint_names: data.nominal.arm.joint_names.clone(),
        joints,
        pattern,
        gain_heldout: gain,
        gain_heldout_ci95: gain_ci95,
        validation,
        rejected,
        extension,
        smoothing_rad_s: None,
        sticks: false,
        unseen,
        predictive_sd_nm: Vec::new(),
        assumptions,
        notes,
        next_experiment,
        overview,
        band_hz: band_hz.unwrap_or(0.0),
        rate_hz: data.chains.first().map_or(0.0, |chain| chain.output_rate_hz()),
        samples: data.time_s.len(),
        bursts: data.bursts.len(),
    })
}

/// RMS (Nm) of a residual where the joint moves: where it turns back, a slow log catches the jump of dry friction or not.
fn rms_in_motion<const N: usize>(data: &RegressionData<N>, residual: &[f64], joint: usize) -> f64 {
    let pairs = residual.iter().zip(data.standing(joint));
    let moving: Vec<f64> = pairs.filter(|(_, standing)| **standing < STANDING).map(|(r, _)| *r).collect();
    if moving.len() * LEAST_MOVING_PARTS < residual.len() { rms(residual) } else { rms(&moving) }
}

fn over_noise(joint: &JointMisfit) -> f64 {
    joint.rms_after_nm / joint.noise_floor_nm.max(1e-6)
}
