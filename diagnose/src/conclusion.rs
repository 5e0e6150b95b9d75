//! From a finished search to findings, rivals, gains and a verdict.

use tribo_logs::RobotLog;
use tribo_sim::Effect;

use crate::confusable::{same_by_physics, why};
use crate::deflection::DeflectionFinding;
use crate::diagnosis::{
    Alternative, CauseLabel, Diagnosis, Finding, JointMisfit, Location, Parameter, Rejected, Verdict,
};
use crate::engine::{DiagnoseError, ripple_effect};
use crate::evidence::{Conditional, joint_fit};
use crate::held_out::{
    BlockGram, BlockSquares, TimeBlocks, gain_of_pairs, gain_with_interval, held_out_squares, interval, plain_squares,
    resampled,
};
use crate::next_experiment::next_experiment;
use crate::parameters::parameters_of;
use crate::plots;
use crate::ripple::RippleLine;
use crate::scene::{Column, Scene};
use crate::search::{LEAST_EVIDENCE, Search};
use crate::significance::Chance;
use crate::validation::validated;

/// What the search ran on.
pub(crate) struct Evaluated<'e, const N: usize> {
    /// Residual before ripples were taken out (Nm).
    pub original: &'e [Vec<f64>; N],
    pub lines: &'e [RippleLine],
    pub deflections: &'e [DeflectionFinding],
    pub chance: &'e Chance,
    pub seed: u64,
}

/// Largest family-wise probability of chance for a finding.
const LARGEST_P: f64 = 0.01;
/// Least RMS of a finding's torque (Nm).
const LEAST_RMS_NM: f64 = 2.5e-3;
/// The same over the torque sensor's noise in the band.
const LEAST_OVER_NOISE: f64 = 0.25;
/// Evidence within which a rival cannot be excluded.
const RIVAL_EVIDENCE: f64 = 10.0;
/// Rivals whose shapes are refined.
const REFINED_RIVALS: usize = 4;
/// Residual over sensor noise in the band beyond which an empty list of findings is no clean bill.
const UNEXPLAINED_OVER_NOISE: f64 = 3.0;
/// The same in Nm.
const UNEXPLAINED_NM: f64 = 0.01;

/// A selected cause with everything that is reported of it.
struct Selected<const N: usize> {
    group: usize,
    evidence: f64,
    p_value: f64,
    plain: Vec<Column<N>>,
    /// Derivative of its torque by its refined shape, unwhitened and whitened.
    slope: Option<Column<N>>,
    alternatives: Vec<Alternative>,
}

/// Draws the conclusion.
pub(crate) fn conclude<const N: usize>(
    search: &mut Search<'_, '_, N>,
    evaluated: &Evaluated<'_, N>,
    validate: &[(String, RobotLog)],
    step: &dyn Fn(&str, f64) -> Result<(), DiagnoseError>,
) -> Result<Diagnosis, DiagnoseError> {
    prefer_likelier(search);
    drop_chance(search, evaluated.chance);
    drop_small(search);
    drop_worthless(search);
    yield_to_unknown(search);
    let selected = describe(search, evaluated.chance, step)?;
    let system = &*search.system;
    let scene = system.scene;

    // Held-out squares with all findings, and without each.
    step("held-out gain", 0.93)?;
    let blocks = TimeBlocks::of(system);
    let groups: Vec<usize> = selected.iter().map(|s| s.group).collect();
    let columns = system.columns_of(&groups);
    let coefficients = joint_fit(system, &columns).coefficients;
    let white: Vec<&Column<N>> = columns.iter().map(|c| &system.columns[*c]).collect();
    let plain: Vec<Column<N>> = selected.iter().flat_map(|s| s.plain.iter().cloned()).collect();
    let ridge: Vec<f64> = columns.iter().map(|c| system.ridge(*c)).collect();
    let gram = BlockGram::of(system, &white, ridge, &blocks);
    let everything: Vec<usize> = (0..columns.len()).collect();
    let before = plain_squares(evaluated.original, &blocks);
    let after = held_out_squares(&scene.residual_nm, &plain, &gram, &blocks, &everything);
    let all_joints: Vec<usize> = (0..N).collect();
    let (mut gain_heldout, mut gain_heldout_ci95) = gain_with_interval(&before, &after, &all_joints, evaluated.seed);

    let residual_after = subtracted(&scene.residual_nm, &plain, &coefficients);
    let mut findings = Vec::new();
    let mut first = 0;
    for member in &selected {
        let own = first..first + member.plain.len();
        first = own.end;
        findings.push(finding_of(
            search,
            member,
            &own,
            &coefficients,
            &Fitted { gram: &gram, plain: &plain, blocks: &blocks, after: &after, residual_after: &residual_after },
            evaluated.seed,
        ));
    }
    for line in evaluated.lines {
        findings.push(ripple_finding(scene, line, evaluated, &after, &blocks));
    }
    let torque_findings = findings.len();
    for deflection in evaluated.deflections {
        findings.push(deflection_finding(deflection, evaluated.seed));
    }
    if torque_findings == 0
        && let Some(largest) = evaluated.deflections.iter().max_by(|a, b| a.evidence.total_cmp(&b.evidence))
    {
        (gain_heldout, gain_heldout_ci95) = gain_of_pairs(&squares(&largest.blocks), evaluated.seed);
    }
    findings.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));

    // The verdict.
    let joints = misfits(scene, evaluated.original, &residual_after, &before, &after);
    let mut notes = notes_of(scene);
    let doubted = |finding: &Finding| {
        let place = (finding.label, finding.location);
        finding.alternatives.iter().any(|rival| !same_by_physics::<N>(place, (rival.label, rival.location)))
    };
    let worst = (0..N).max_by(|a, b| over_noise(&joints[*a]).total_cmp(&over_noise(&joints[*b]))).unwrap_or(0);
    let unexplained = findings.is_empty()
        && over_noise(&joints[worst]) > UNEXPLAINED_OVER_NOISE
        && joints[worst].rms_after_nm > UNEXPLAINED_NM;
    let verdict = if findings.iter().any(|finding| finding.label == CauseLabel::Unknown) || unexplained {
        Verdict::Unknown
    } else if findings.iter().any(doubted) {
        Verdict::Ambiguous
    } else if findings.is_empty() {
        Verdict::NothingMissing
    } else {
        Verdict::Named
    };
    if unexplained {
        notes.push(format!(
            "joint {worst}: {:.3} Nm are left where the sensors' own noise is {:.3} Nm, and no cause considered goes with them",
            joints[worst].rms_after_nm, joints[worst].noise_floor_nm
        ));
    }

    let rejected = rejected(search, &findings);
    let overview = plots::overview(scene, evaluated.original);
    let pattern = plots::cross_joint_pattern(scene, evaluated.original);
    step("validation", 0.97)?;
    let effects: Vec<Effect> = findings.iter().filter_map(|finding| finding.effect.clone()).collect();
    let validation = validated(&scene.nominal, &effects, validate, evaluated.seed)?;
    let next_experiment = if scene.transmission { None } else { next_experiment(scene, &findings, &joints) };
    Ok(Diagnosis {
        verdict,
        findings,
        joints,
        pattern,
        gain_heldout,
        gain_heldout_ci95,
        validation,
        rejected,
        assumptions: assumptions_of(search, evaluated.chance),
        notes,
        next_experiment,
        overview,
        band_hz: scene.chains.first().map_or(0.0, |chain| chain.band_hz),
        rate_hz: scene.chains.first().map_or(0.0, |chain| chain.output_rate_hz()),
        samples: scene.time_s.len(),
        bursts: scene.bursts.len(),
    })
}

fn over_noise(joint: &JointMisfit) -> f64 {
    joint.rms_after_nm / joint.noise_floor_nm.max(1e-6)
}

/// Evidence of a member given the other members.
fn evidence_of<const N: usize>(search: &Search<'_, '_, N>, group: usize) -> f64 {
    search.evidence_given(&search.others(group), group).map_or(f64::NEG_INFINITY, |(evidence, _)| evidence)
}

/// Of two causes with the same torque by physics, tells the likelier story: a payload rather than a heavier last link, a
/// rotor rather than the first link.
fn prefer_likelier<const N: usize>(search: &mut Search<'_, '_, N>) {
    for place in 0..search.selected.len() {
        let group = search.selected[place];
        let own = search.place(group);
        if own.0 != CauseLabel::LinkInertial {
            continue;
        }
        let others = search.others(group);
        let evidence = evidence_of(search, group);
        let likelier = (0..search.system.groups.len())
            .filter(|rival| same_by_physics::<N>(own, search.place(*rival)) && search.place(*rival) != own)
            .filter(|rival| !others.iter().any(|other| search.place(*other) == search.place(*rival)))
            .filter_map(|rival| Some((rival, search.evidence_given(&others, rival)?.0)))
            .max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((rival, value)) = likelier
            && value > evidence - RIVAL_EVIDENCE
        {
            search.selected[place] = rival;
        }
    }
}

/// Drops what chance may explain.
fn drop_chance<const N: usize>(search: &mut Search<'_, '_, N>, chance: &Chance) {
    loop {
        let weakest = search
            .selected
            .iter()
            .map(|group| (*group, evidence_of(search, *group)))
            .min_by(|a, b| a.1.total_cmp(&b.1));
        match weakest {
            Some((group, evidence)) if chance.p_value(evidence) > LARGEST_P => search.selected = search.others(group),
            _ => return,
        }
    }
}

/// Drops what is too small to matter on every joint.
fn drop_small<const N: usize>(search: &mut Search<'_, '_, N>) {
    let scene = search.system.scene;
    let columns = search.system.columns_of(&search.selected);
    let coefficients = joint_fit(search.system, &columns).coefficients;
    let mut first = 0;
    let mut kept = Vec::new();
    for &group in &search.selected {
        let plain = plain_columns(search, group);
        let own = &coefficients[first..first + plain.len()];
        first += plain.len();
        let matters = (0..N).any(|j| {
            let rms = torque_rms(&plain, own, j);
            rms > LEAST_RMS_NM && rms > LEAST_OVER_NOISE * scene.torque_floor_nm[j]
        });
        if matters {
            kept.push(group);
        }
    }
    search.selected = kept;
}

/// Drops what does not help on blocks that its coefficients have not seen: on no joint, in no stretch where it acts.
fn drop_worthless<const N: usize>(search: &mut Search<'_, '_, N>) {
    loop {
        let system = &*search.system;
        let blocks = TimeBlocks::of(system);
        let columns = system.columns_of(&search.selected);
        let white: Vec<&Column<N>> = columns.iter().map(|c| &system.columns[*c]).collect();
        let plain: Vec<Column<N>> = search.selected.iter().flat_map(|group| plain_columns(search, *group)).collect();
        let ridge: Vec<f64> = columns.iter().map(|c| system.ridge(*c)).collect();
    let gram = BlockGram::of(system, &white, ridge, &blocks);
        let everything: Vec<usize> = (0..columns.len()).collect();
        let residual = &system.scene.residual_nm;
        let after = held_out_squares(residual, &plain, &gram, &blocks, &everything);
        let mut first = 0;
        let mut worst: Option<(usize, f64)> = None;
        for &group in &search.selected {
            let own = first..first + system.groups[group].columns.len();
            first = own.end;
            let keep: Vec<usize> = everything.iter().copied().filter(|c| !own.contains(c)).collect();
            let without = held_out_squares(residual, &plain, &gram, &blocks, &keep);
            let acts = |block: usize, j: usize| {
                let range = blocks.ranges[block].clone();
                plain[own.clone()].iter().filter_map(|column| column.rows[j].as_ref()).any(|x| x[range.clone()].iter().any(|x| *x != 0.0))
            };
            let best = (0..N)
                .filter_map(|j| {
                    let touched: Vec<usize> = (0..blocks.ranges.len()).filter(|block| acts(*block, j)).collect();
                    let sum = |squares: &BlockSquares<N>| touched.iter().map(|block| squares[*block][j]).sum::<f64>();
                    (!touched.is_empty()).then(|| 1.0 - (sum(&after) / sum(&without).max(1e-300)).sqrt())
                })
                .fold(f64::NEG_INFINITY, f64::max);
            if best < LEAST_GAIN && worst.is_none_or(|(_, gain)| best < gain) {
                worst = Some((group, best));
            }
        }
        match worst {
            Some((group, _)) => search.selected = search.others(group),
            None => return,
        }
    }
}

/// Held-out gain on its best joint that a finding must have.
const LEAST_GAIN: f64 = 0.015;

/// A named cause on a joint where a nameless one explains more is part of what has no name.
fn yield_to_unknown<const N: usize>(search: &mut Search<'_, '_, N>) {
    let strength: Vec<(usize, CauseLabel, Location, f64)> = search
        .selected
        .iter()
        .map(|g| (*g, search.place(*g).0, search.place(*g).1, evidence_of(search, *g)))
        .collect();
    search.selected.retain(|group| {
        let Some((_, label, location, own)) = strength.iter().find(|entry| entry.0 == *group) else { return false };
        *label == CauseLabel::Unknown
            || !strength.iter().any(|(_, other, place, evidence)| {
                *other == CauseLabel::Unknown && place == location && evidence > own
            })
    });
}

fn plain_columns<const N: usize>(search: &Search<'_, '_, N>, group: usize) -> Vec<Column<N>> {
    let scene = search.system.scene;
    let group = &search.system.groups[group];
    group.candidate.filtered(scene, &group.shape)
}

fn torque_rms<const N: usize>(plain: &[Column<N>], coefficients: &[f64], joint: usize) -> f64 {
    let Some(rows) = plain.iter().find_map(|column| column.rows[joint].as_ref()) else { return 0.0 };
    let acting = |k: &usize| plain.iter().any(|column| column.rows[joint].as_ref().is_some_and(|x| x[*k] != 0.0));
    let count = (0..rows.len()).filter(acting).count();
    let sum: f64 = (0..rows.len())
        .map(|k| {
            let torque: f64 = plain
                .iter()
                .zip(coefficients)
                .filter_map(|(column, c)| Some(column.rows[joint].as_ref()?[k] * c))
                .sum();
            torque * torque
        })
        .sum();
    (sum / count.max(1) as f64).sqrt()
}

/// Step of the numerical derivative by a shape, relative.
const SHAPE_STEP: f64 = 0.03;

/// Rivals, significance and columns of every member.
fn describe<const N: usize>(
    search: &mut Search<'_, '_, N>,
    chance: &Chance,
    step: &dyn Fn(&str, f64) -> Result<(), DiagnoseError>,
) -> Result<Vec<Selected<N>>, DiagnoseError> {
    let members = search.selected.clone();
    let mut described = Vec::new();
    for &group in &members {
        step("rivals", 0.88)?;
        let evidence = evidence_of(search, group);
        let alternatives = rivals(search, group, evidence);
        let plain = plain_columns(search, group);
        let candidate = search.system.groups[group].candidate.clone();
        let shape = search.system.groups[group].shape.clone();
        let slope = candidate.profile().map(|_| {
            let scene = search.system.scene;
            let columns = search.system.columns_of(&search.selected);
            let fit = joint_fit(search.system, &columns).coefficients;
            let place = columns.iter().position(|c| *c == search.system.groups[group].columns.start).unwrap_or(0);
            let moved = [shape[0] * (1.0 + SHAPE_STEP)];
            let up = candidate.filtered(scene, &moved).swap_remove(0);
            let scale = fit[place] / (shape[0] * SHAPE_STEP);
            Column {
                rows: std::array::from_fn(|j| {
                    let (up, here) = (up.rows[j].as_ref()?, plain[0].rows[j].as_ref()?);
                    Some(up.iter().zip(here).map(|(up, here)| (up - here) * scale).collect())
                }),
            }
        });
        described.push(Selected { group, evidence, p_value: chance.p_value(evidence), plain, slope, alternatives });
    }
    search.selected = members;
    Ok(described)
}

/// Causes that would do as well in the place of a member.
fn rivals<const N: usize>(search: &mut Search<'_, '_, N>, group: usize, evidence: f64) -> Vec<Alternative> {
    let others = search.others(group);
    let taken: Vec<_> = others.iter().map(|g| search.place(*g)).collect();
    let own = search.place(group);
    let mut best: Vec<(usize, f64)> = Vec::new();
    {
        let given = Conditional::on(search.system, &search.system.columns_of(&others));
        for rival in 0..search.system.groups.len() {
            let place = search.place(rival);
            let nameless = place.0 == CauseLabel::Unknown;
            if place == own || taken.contains(&place) || nameless || place.0 == CauseLabel::ExternalContact {
                continue;
            }
            let Some((value, _)) = search.evidence(&given, rival) else { continue };
            match best.iter_mut().find(|(other, _)| search.place(*other) == place) {
                Some(entry) if value > entry.1 => *entry = (rival, value),
                Some(_) => {}
                None => best.push((rival, value)),
            }
        }
    }
    best.sort_by(|a, b| b.1.total_cmp(&a.1));
    best.truncate(REFINED_RIVALS);
    let mut rivals = Vec::new();
    for (rival, coarse) in best {
        if coarse < LEAST_EVIDENCE || coarse < 0.5 * evidence {
            continue;
        }
        let refined = search.refined(rival, &others);
        let value = search.evidence_given(&others, refined).map_or(coarse, |(value, _)| value);
        if value > evidence - RIVAL_EVIDENCE {
            let (label, location) = search.place(refined);
            rivals.push(Alternative {
                label,
                location,
                evidence_gap: (evidence - value).max(0.0),
                why: why(own.0, label),
            });
        }
    }
    rivals.sort_by(|a, b| a.evidence_gap.total_cmp(&b.evidence_gap));
    rivals
}

/// What the fit of all findings has left behind.
struct Fitted<'f, const N: usize> {
    gram: &'f BlockGram,
    plain: &'f [Column<N>],
    blocks: &'f TimeBlocks,
    after: &'f BlockSquares<N>,
    residual_after: &'f [Vec<f64>; N],
}

fn finding_of<const N: usize>(
    search: &Search<'_, '_, N>,
    member: &Selected<N>,
    own: &std::ops::Range<usize>,
    coefficients: &[f64],
    fitted: &Fitted<'_, N>,
    seed: u64,
) -> Finding {
    let system = &*search.system;
    let scene = system.scene;
    let group = &system.groups[member.group];
    let candidate = &group.candidate;
    let own_coefficients = &coefficients[own.clone()];
    let effect = candidate.effect(scene, &group.shape, own_coefficients);

    // Gain of this finding, given the others, on the joints it acts on.
    let keep: Vec<usize> = (0..coefficients.len()).filter(|c| !own.contains(c)).collect();
    let without = held_out_squares(&scene.residual_nm, fitted.plain, fitted.gram, fitted.blocks, &keep);
    let affected: Vec<usize> =
        (0..N).filter(|j| member.plain.iter().any(|column| column.rows[*j].is_some())).collect();
    let (held_out_gain, held_out_gain_ci95) = gain_with_interval(&without, fitted.after, &affected, seed);

    // Intervals: coefficients (and the shape, linearised) of resampled blocks.
    let parameters = effect.as_ref().map_or_else(Vec::new, |effect| {
        let slope = member.slope.as_ref().map(|slope| system.whiten(slope));
        let mut columns: Vec<&Column<N>> = search_columns(search);
        let base = columns.len();
        columns.extend(slope.as_ref());
        let selected = system.columns_of(&search.selected);
        let ridge = selected.iter().map(|c| system.ridge(*c)).chain(slope.iter().map(|_| 0.0)).collect();
        let gram = BlockGram::of(system, &columns, ridge, fitted.blocks);
        let kept: Vec<usize> = (0..columns.len()).collect();
        let draws = resampled(gram.blocks(), seed, |weights| {
            let fit = gram.fit(weights, &kept);
            let mut shape = group.shape.clone();
            if slope.is_some() {
                shape[0] = (shape[0] + fit[base]).max(1e-9);
            }
            candidate.effect(scene, &shape, &fit[own.clone()])
        });
        let drawn: Vec<_> = draws.into_iter().flatten().map(|effect| parameters_of(&effect)).collect();
        parameters_of(effect)
            .into_iter()
            .enumerate()
            .map(|(p, (name, value))| {
                let ci95 = (0..value.len())
                    .map(|i| interval(drawn.iter().map(|draw| draw[p].1[i]).collect()))
                    .collect();
                Parameter { name, value, ci95 }
            })
            .collect()
    });
    let explained = (0..N).map(|j| torque_rms(&member.plain, own_coefficients, j));
    let plots = plots::of_member(scene, candidate.as_ref(), &member.plain, own_coefficients, fitted.residual_after);
    Finding {
        label: candidate.label(),
        location: candidate.location(),
        effect,
        parameters,
        signature: candidate.signature(),
        p_value: member.p_value,
        held_out_gain,
        held_out_gain_ci95,
        explained_rms_nm: explained.fold(0.0, f64::max),
        evidence: member.evidence,
        alternatives: member.alternatives.clone(),
        plots,
    }
}

fn search_columns<'s, const N: usize>(search: &'s Search<'_, '_, N>) -> Vec<&'s Column<N>> {
    search.system.columns_of(&search.selected).into_iter().map(|c| &search.system.columns[c]).collect()
}

fn ripple_finding<const N: usize>(
    scene: &Scene<N>,
    line: &RippleLine,
    evaluated: &Evaluated<'_, N>,
    after: &BlockSquares<N>,
    blocks: &TimeBlocks,
) -> Finding {
    // Without this line its torque is back in the residual.
    let column = scene.filter(&line.torque(scene));
    let torque = column.rows[line.joint].clone().unwrap_or_default();
    let mut back = evaluated.original.clone();
    back[line.joint] = scene.residual_nm[line.joint].iter().zip(&torque).map(|(r, x)| r + x).collect();
    let (with, without) = (plain_squares(&scene.residual_nm, blocks), plain_squares(&back, blocks));
    // The other findings' part cancels but for the cross term, which is small: a ripple is orthogonal to slow causes.
    let raised: BlockSquares<N> = after
        .iter()
        .zip(with.iter().zip(&without))
        .map(|(after, (with, without))| std::array::from_fn(|j| (after[j] + without[j] - with[j]).max(0.0)))
        .collect();
    let (held_out_gain, held_out_gain_ci95) = gain_with_interval(&raised, after, &[line.joint], evaluated.seed);
    let error = 1.96 * line.standard_error_nm;
    let effect = ripple_effect(scene, line);
    let amplitude = line.amplitude_nm();
    let phase_error = error / amplitude;
    let half = [1.96 * line.order_error, error, phase_error];
    let parameters = effect.as_ref().map_or_else(Vec::new, |effect| {
        parameters_of(effect)
            .into_iter()
            .zip(half)
            .map(|((name, value), half)| Parameter { name, ci95: vec![[value[0] - half, value[0] + half]], value })
            .collect()
    });
    Finding {
        label: CauseLabel::TorqueRipple,
        location: Location::Joint(line.joint),
        effect,
        parameters,
        signature: None,
        p_value: (-0.5 * line.evidence).exp().min(LARGEST_P),
        held_out_gain,
        held_out_gain_ci95,
        explained_rms_nm: amplitude / 2f64.sqrt(),
        evidence: line.evidence,
        alternatives: Vec::new(),
        plots: plots::of_ripple(scene, line),
    }
}

fn squares(rms: &[[f64; 2]]) -> Vec<[f64; 2]> {
    rms.iter().map(|pair| [pair[0] * pair[0], pair[1] * pair[1]]).collect()
}

fn deflection_finding(found: &DeflectionFinding, seed: u64) -> Finding {
    let (held_out_gain, held_out_gain_ci95) = gain_of_pairs(&squares(&found.blocks), seed);
    let parameters = parameters_of(&found.effect)
        .into_iter()
        .enumerate()
        .map(|(i, (name, value))| {
            // The damping of a quasi-static deflection is weakly determined.
            let relative = if i == 0 { 1.96 * found.relative_error } else { 1.0 };
            let ci95 = vec![[value[0] * (1.0 - relative), value[0] * (1.0 + relative)]];
            Parameter { name, value, ci95 }
        })
        .collect();
    Finding {
        label: found.label,
        location: Location::Joint(found.joint),
        effect: Some(found.effect.clone()),
        parameters,
        signature: None,
        p_value: (-0.5 * found.evidence).exp().min(LARGEST_P),
        held_out_gain,
        held_out_gain_ci95,
        explained_rms_nm: 0.0,
        evidence: found.evidence,
        alternatives: Vec::new(),
        plots: plots::of_deflection(found),
    }
}

fn subtracted<const N: usize>(residual: &[Vec<f64>; N], plain: &[Column<N>], coefficients: &[f64]) -> [Vec<f64>; N] {
    let mut left = residual.clone();
    for (column, coefficient) in plain.iter().zip(coefficients) {
        for j in 0..N {
            if let Some(values) = &column.rows[j] {
                left[j].iter_mut().zip(values).for_each(|(left, x)| *left -= coefficient * x);
            }
        }
    }
    left
}

fn misfits<const N: usize>(
    scene: &Scene<N>,
    before: &[Vec<f64>; N],
    after: &[Vec<f64>; N],
    held_out_before: &BlockSquares<N>,
    held_out_after: &BlockSquares<N>,
) -> Vec<JointMisfit> {
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len().max(1) as f64;
    let rms = |x: &[f64]| (x.iter().map(|x| x * x).sum::<f64>() / x.len().max(1) as f64).sqrt();
    let variance = |x: &[f64]| rms(x).powi(2) - mean(x).powi(2);
    let samples = scene.time_s.len().max(1) as f64;
    let block_rms = |squares: &BlockSquares<N>, j: usize| {
        (squares.iter().map(|block| block[j]).sum::<f64>() / samples).sqrt()
    };
    (0..N)
        .map(|j| JointMisfit {
            rms_nm: rms(&before[j]),
            bias_nm: mean(&before[j]),
            // A torque that hardly varies leaves no variance to explain.
            unexplained: variance(&before[j]) / variance(&scene.measured_nm[j]).max(scene.noise_floor_nm[j].powi(2)).max(1e-12),
            noise_floor_nm: scene.noise_floor_nm[j],
            goes_with: plots::goes_with(scene, &before[j], j),
            rms_after_nm: rms(&after[j]),
            held_out_nm: [block_rms(held_out_before, j), block_rms(held_out_after, j)],
        })
        .collect()
}

fn notes_of<const N: usize>(scene: &Scene<N>) -> Vec<String> {
    let mut notes = Vec::new();
    for j in 0..N {
        if !scene.moves(j) {
            notes.push(format!("joint {j} hardly moves: nothing but an offset can be said about its friction"));
            continue;
        }
        let (forwards, backwards) = scene.samples.iter().fold((0usize, 0usize), |(f, b), at| {
            (f + usize::from(at.sign[j] > 0.9), b + usize::from(at.sign[j] < -0.9))
        });
        if forwards.min(backwards) * 50 < scene.samples.len() {
            notes.push(format!("joint {j} moves in one direction only: Coulomb friction and offset cannot be separated"));
        }
    }
    if scene.skipped_bursts > 0 {
        notes.push(format!("{} bursts were too short for the band and were left out", scene.skipped_bursts));
    }
    notes
}

fn assumptions_of<const N: usize>(search: &Search<'_, '_, N>, chance: &Chance) -> Vec<String> {
    let scene = search.system.scene;
    let mut assumptions: Vec<String> = scene.chains.iter().map(ToString::to_string).collect();
    assumptions.dedup();
    assumptions.push(format!(
        "sign(qd) is tanh(qd/{} rad/s); coefficients are fitted on whitened residuals of all joints together",
        scene.nominal.smoothing_rad_s
    ));
    assumptions.push(format!(
        "held-out figures: coefficients of each fold come from the other contiguous blocks, shapes (speeds, distances, \
         time constants, orders) from the whole log; chance is {:.2} times white noise's",
        chance.inflation
    ));
    assumptions.push("RMS gains are 1 − rms after / rms before, in the band".to_owned());
    assumptions
}

/// The best of every named cause that was not selected, and why it is out.
fn rejected<const N: usize>(search: &Search<'_, '_, N>, findings: &[Finding]) -> Vec<Rejected> {
    let scene = search.system.scene;
    let given = Conditional::on(search.system, &search.system.columns_of(&search.selected));
    let mut all: Vec<Rejected> = Vec::new();
    for group in 0..search.system.groups.len() {
        let (label, location) = search.place(group);
        let found = findings.iter().any(|finding| (finding.label, finding.location) == (label, location));
        if found || label == CauseLabel::Unknown || label == CauseLabel::ExternalContact {
            continue;
        }
        let columns: Vec<usize> = search.system.groups[group].columns.clone().collect();
        let gain = given.gain(search.system, &columns);
        let (evidence, reason) = if gain.directions == 0 {
            (None, "this motion cannot tell it from the findings".to_owned())
        } else {
            let shape = &search.system.groups[group].shape;
            let allowed = search.system.groups[group].candidate.admissible(scene, shape, &gain.coefficients);
            let value = gain.explained / search.inflation - search.price(group, &gain);
            let reason =
                if allowed { "does not pay for its parameters" } else { "only with values that physics forbids" };
            (Some(value), reason.to_owned())
        };
        match all.iter_mut().find(|other| (other.label, other.location) == (label, location)) {
            Some(other) if evidence > other.evidence => *other = Rejected { label, location, evidence, reason },
            Some(_) => {}
            None => all.push(Rejected { label, location, evidence, reason }),
        }
    }
    for candidate in crate::cause::candidates::<N>() {
        if let Some(reason) = candidate.unavailable(scene) {
            all.push(Rejected { label: candidate.label(), location: candidate.location(), evidence: None, reason });
        }
    }
    all.sort_by(|a, b| b.evidence.unwrap_or(f64::NEG_INFINITY).total_cmp(&a.evidence.unwrap_or(f64::NEG_INFINITY)));
    all
}
