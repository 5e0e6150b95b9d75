//! From a finished search to findings, rivals and gains.

use tribo_posterior::PlainFits;
use tribo_regression::evidence::joint_fit;
use tribo_regression::{CauseLabel, DiagnoseError, rms, subtracted};

use crate::diagnosis::{Finding, Rejected, Unseen};
use crate::evaluated::Evaluated;
use crate::finding::{Fitted, Selected, deflection_finding, describe, finding_of, ripple_finding, squares};
use crate::held_out::{HeldOut, gain_of_pairs, gain_with_interval, plain_squares};
use crate::pruning::{
    drop_chance, drop_lonely_pushes, drop_small, drop_stiction, drop_worthless, prefer_likelier, prefer_names,
    yield_to_unknown,
};
use crate::remarks::{assumptions_of, rejected};
use crate::search::Search;
use crate::significance::Chance;

/// What a finished search says.
pub(crate) struct Judged<const N: usize> {
    /// By evidence.
    pub findings: Vec<Finding>,
    /// What the findings leave of the residual (Nm).
    pub residual_after: [Vec<f64>; N],
    /// Squares (Nm²) of the residual per block of the log and joint, and of what findings that were not fitted to the block leave of it.
    pub before: Vec<[f64; N]>,
    pub after: Vec<[f64; N]>,
    /// Share of the residual that all findings together remove on blocks that they were not fitted to, with its interval.
    pub gain: f64,
    pub gain_ci95: [f64; 2],
    pub unseen: Option<Unseen>,
    pub rejected: Vec<Rejected>,
    pub assumptions: Vec<String>,
}

/// Judges what a search selected: drops what chance explains or what gains nothing, describes the rest.
#[inline(never)]
pub(crate) fn judge<const N: usize>(
    search: &mut Search<'_, '_, N>,
    evaluated: &Evaluated<'_, N>,
    step: &dyn Fn(&str, f64) -> Result<(), DiagnoseError>,
) -> Result<Judged<N>, DiagnoseError> {
    let nameless = search.selected.iter().any(|group| search.place(*group).0 == CauseLabel::Unknown);
    prune(search, evaluated.chance, evaluated.seed);
    if nameless {
        if !search.fill_with_names(&|| step("names", 0.87).is_ok()) {
            return Err(DiagnoseError::Cancelled);
        }
        prune(search, evaluated.chance, evaluated.seed);
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
    let asked_nm = evaluated.asked(data).residual_nm;
    let before = plain_squares(asked_nm, &held_out.blocks);
    let after = held_out.squares(&data.residual_nm);
    let all_joints: Vec<usize> = (0..N).collect();
    let (mut gain, mut gain_ci95) = gain_with_interval(&before, &after, &all_joints, evaluated.seed);

    let mut unseen = evaluated.plain_fits.map(|fits| beside(fits, search, &selected));
    if let (Some(unseen), Some(before)) = (&mut unseen, evaluated.before) {
        unseen.nominal_nm = before.residual_nm.iter().map(|column| rms(column)).collect();
    }
    let residual_after = subtracted(data.residual_nm.clone(), &held_out.plain, &coefficients);
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
        (gain, gain_ci95) = gain_of_pairs(&squares(&largest.blocks), evaluated.seed);
    }
    findings.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));

    let rejected = rejected(search, &findings);
    let assumptions = assumptions_of(search, evaluated.chance);
    Ok(Judged { findings, residual_after, before, after, gain, gain_ci95, unseen, rejected, assumptions })
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
fn prune<const N: usize>(search: &mut Search<'_, '_, N>, chance: &Chance, seed: u64) {
    prefer_likelier(search);
    drop_lonely_pushes(search);
    loop {
        let before = search.selected.clone();
        drop_chance(search, chance);
        drop_small(search);
        drop_stiction(search);
        drop_worthless(search, seed);
        prefer_names(search);
        yield_to_unknown(search);
        if search.selected == before {
            return;
        }
    }
}
