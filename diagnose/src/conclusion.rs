//! From a finished search to findings, rivals, gains and a verdict.

use tribo_logs::RobotLog;
use tribo_sim::Effect;

use crate::DiagnoseError;
use crate::confusable::same_torque;
use crate::diagnosis::{CauseLabel, Diagnosis, Finding, JointMisfit, Location, Unseen, Verdict};
use crate::evaluated::{Before, Evaluated};
use crate::evidence::joint_fit;
use crate::finding::{Fitted, Selected, deflection_finding, describe, finding_of, ripple_finding, squares};
use crate::held_out::{HeldOut, gain_of_pairs, gain_with_interval, plain_squares};
use crate::next_experiment::next_experiment;
use crate::noise_level::rms;
use crate::plots;
use crate::posterior::baseline::PlainFits;
use crate::pruning::{
    drop_chance, drop_lonely_pushes, drop_small, drop_stiction, drop_worthless, prefer_likelier, prefer_names,
    yield_to_unknown,
};
use crate::regression_data::{RegressionData, subtracted};
use crate::remarks::{assumptions_of, misfits, note_on_baseline, notes_of, rejected};
use crate::search::Search;
use crate::significance::Chance;
use crate::stamps::take_stamps;
use crate::validation::validated;

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
    search: &mut Search<'_, '_, N>,
    evaluated: &Evaluated<'_, N>,
    validate: &[(String, RobotLog)],
    step: &dyn Fn(&str, f64) -> Result<(), DiagnoseError>,
) -> Result<Diagnosis, DiagnoseError> {
    let nameless = search.selected.iter().any(|group| search.place(*group).0 == CauseLabel::Unknown);
    prune(search, evaluated.chance);
    if nameless {
        if !search.fill_with_names(&|| step("names", 0.87).is_ok()) {
            return Err(DiagnoseError::Cancelled);
        }
        prune(search, evaluated.chance);
    }
    let selected = describe(search, evaluated.chance, step)?;
    let system = &*search.system;
    let data = system.data;

    // Held-out squares with all findings, and without each.
    step("held-out gain", 0.93)?;
    let groups: Vec<usize> = selected.iter().map(|s| s.group).collect();
    let columns = system.columns_of(&groups);
    let coefficients = joint_fit(system, &columns).coefficients;
    let plain = selected.iter().flat_map(|s| s.plain.iter().cloned()).collect();
    let held_out = HeldOut::with_plain(system, &groups, plain);
    let Before { model: asked, residual_nm: asked_nm } =
        evaluated.before.unwrap_or(Before { model: &data.nominal, residual_nm: evaluated.original });
    let before = plain_squares(asked_nm, &held_out.blocks);
    let after = held_out.squares(&data.residual_nm);
    let all_joints: Vec<usize> = (0..N).collect();
    let (mut gain_heldout, mut gain_heldout_ci95) = gain_with_interval(&before, &after, &all_joints, evaluated.seed);

    let mut unseen = evaluated.plain_fits.map(|fits| beside(fits, search, &selected));
    if let (Some(unseen), Some(before)) = (&mut unseen, evaluated.before) {
        unseen.nominal_nm = before.residual_nm.iter().map(|column| rms(column)).collect();
    }
    let residual_after = subtracted(&data.residual_nm, &held_out.plain, &coefficients);
    // A model file takes named causes alone: they are fitted anew without the nameless.
    let named: Vec<usize> =
        groups.iter().copied().filter(|group| search.place(*group).0 != CauseLabel::Unknown).collect();
    let mut alone = joint_fit(system, &system.columns_of(&named)).coefficients.into_iter();
    let mut findings = Vec::new();
    let mut first = 0;
    for member in &selected {
        let own = first..first + member.plain.len();
        first = own.end;
        let has_name = search.place(member.group).0 != CauseLabel::Unknown;
        let fitted_alone: Vec<f64> = if has_name { alone.by_ref().take(own.len()).collect() } else { Vec::new() };
        let of_finding = if has_name { &fitted_alone[..] } else { &coefficients[own.clone()] };
        findings.push(finding_of(
            search,
            member,
            &own,
            of_finding,
            &Fitted { held_out: &held_out, after: &after, residual_after: &residual_after },
            evaluated.seed,
        ));
    }
    for line in evaluated.lines {
        findings.push(ripple_finding(data, line, evaluated, &after, &held_out.blocks));
    }
    let torque_findings = findings.len();
    for deflection in evaluated.deflections {
        findings.push(deflection_finding(deflection, &data.nominal.arm.joint_names, evaluated.seed));
    }
    if torque_findings == 0
        && let Some(largest) = evaluated.deflections.iter().max_by(|a, b| a.evidence.total_cmp(&b.evidence))
    {
        (gain_heldout, gain_heldout_ci95) = gain_of_pairs(&squares(&largest.blocks), evaluated.seed);
    }
    findings.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));

    let rejected = rejected(search, &findings);
    // What is reported is what the written model leaves when it is read back.
    let extension: Vec<Effect> = findings.iter().filter_map(|finding| finding.effect.clone()).collect();
    let mut extended = data.nominal.clone();
    extended.effects.extend(extension.iter().cloned());
    let read_back = RegressionData::of_logs(evaluated.logs, &extended, data.chains.first().map(|chain| chain.band_hz))?;
    let joints = misfits(data, asked_nm, &read_back.residual_nm, &before, &after);
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
    let validation = validated(
        [asked, &data.nominal],
        &extension,
        validate,
        data.chains.first().map(|chain| chain.band_hz),
        evaluated.seed,
    )?;
    let next_experiment = if data.transmission { None } else { next_experiment(data, &findings, &joints) };
    Ok(Diagnosis {
        verdict,
        findings,
        joint_names: data.nominal.arm.joint_names.clone(),
        joints,
        pattern,
        gain_heldout,
        gain_heldout_ci95,
        validation,
        rejected,
        extension,
        smoothing_rad_s: None,
        sticks: false,
        unseen,
        predictive_sd_nm: Vec::new(),
        assumptions: assumptions_of(search, evaluated.chance),
        notes,
        next_experiment,
        overview,
        band_hz: data.chains.first().map_or(0.0, |chain| chain.band_hz),
        rate_hz: data.chains.first().map_or(0.0, |chain| chain.output_rate_hz()),
        samples: data.time_s.len(),
        bursts: data.bursts.len(),
    })
}

/// What the named causes, fitted to the rest, leave of the parts that plain fits were asked about.
fn beside<const N: usize>(fits: &PlainFits, search: &Search<'_, '_, N>, selected: &[Selected<N>]) -> Unseen {
    let has_name = |member: &&Selected<N>| search.place(member.group).0 != CauseLabel::Unknown;
    let named: Vec<&Selected<N>> = selected.iter().filter(has_name).collect();
    let groups: Vec<usize> = named.iter().map(|member| member.group).collect();
    let plain = named.iter().flat_map(|member| member.plain.iter().cloned()).collect();
    let data = search.system.data;
    let squares = HeldOut::of_parts(search.system, &groups, plain).squares(&data.residual_nm);
    let samples = data.time_s.len().max(1) as f64;
    Unseen {
        split: fits.split.name(),
        nominal_nm: fits.nominal_nm.clone(),
        extended_nm: (0..N).map(|j| (squares.iter().map(|part| part[j]).sum::<f64>() / samples).sqrt()).collect(),
        plain_nm: fits.plain_nm.clone(),
        full_nm: fits.full_nm.clone(),
    }
}

/// Keeps what has enough evidence, torque and gain, in the likelier of two stories.
fn prune<const N: usize>(search: &mut Search<'_, '_, N>, chance: &Chance) {
    prefer_likelier(search);
    drop_lonely_pushes(search);
    loop {
        let before = search.selected.clone();
        drop_chance(search, chance);
        drop_small(search);
        drop_stiction(search);
        drop_worthless(search);
        prefer_names(search);
        yield_to_unknown(search);
        if search.selected == before {
            return;
        }
    }
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
