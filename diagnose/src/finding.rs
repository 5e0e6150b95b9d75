//! Findings with their parameters, intervals, gains and plots.

use std::sync::Arc;

use tribo_regression::cause::{Candidate, TorqueRipple};
use tribo_regression::deflection::DeflectionFinding;
use tribo_regression::evidence::joint_fit;
use tribo_regression::ripple::RippleLine;
use tribo_regression::{CauseLabel, Column, DiagnoseError, Location, RegressionData};
use tribo_robot::JointNames;
use tribo_sim::Effect;

use crate::diagnosis::{Alternative, Finding, Parameter};
use crate::evaluated::Evaluated;
use crate::held_out::{
    BlockGram, BlockSquares, HeldOut, TimeBlocks, gain_of_pairs, gain_with_interval, interval, plain_squares, resampled,
};
use crate::parameters::parameters_of;
use crate::plots;
use crate::pruning::{LARGEST_P, acting_on, torque_rms};
use crate::rivals::rivals;
use crate::search::Search;
use crate::significance::Chance;

/// A selected cause with everything that is reported of it.
pub(crate) struct Selected<const N: usize> {
    pub group: usize,
    evidence: f64,
    p_value: f64,
    pub plain: Vec<Column<N>>,
    /// Derivative of its torque by its refined shape, unwhitened and whitened.
    slope: Option<Column<N>>,
    alternatives: Vec<Alternative>,
}

/// Step of the numerical derivative by a shape, relative.
const SHAPE_STEP: f64 = 0.03;

/// Rivals, significance and columns of every member.
pub(crate) fn describe<const N: usize>(
    search: &mut Search<'_, '_, N>,
    chance: &Chance,
    step: &dyn Fn(&str, f64) -> Result<(), DiagnoseError>,
) -> Result<Vec<Selected<N>>, DiagnoseError> {
    let members = search.selected.clone();
    let mut described = Vec::new();
    for &group in &members {
        step("rivals", 0.88)?;
        let evidence = search.member_evidence(group);
        let alternatives = rivals(search, group, evidence);
        let plain = search.system.plain_columns(group);
        let candidate = search.system.groups[group].candidate.clone();
        let shape = search.system.groups[group].shape.clone();
        let slope = candidate.profile().map(|_| {
            let data = search.system.data;
            let columns = search.system.columns_of(&search.selected);
            let fit = joint_fit(search.system, &columns).coefficients;
            let place = columns.iter().position(|c| *c == search.system.groups[group].columns.start).unwrap_or(0);
            let moved = [shape[0] * (1.0 + SHAPE_STEP)];
            let up = candidate.filtered(data, &moved).swap_remove(0);
            let scale = fit[place] / (shape[0] * SHAPE_STEP);
            Column {
                rows: std::array::from_fn(|j| {
                    let (up, here) = (up.rows[j].as_ref()?, plain[0].rows[j].as_ref()?);
                    Some(Arc::new(up.iter().zip(here.iter()).map(|(up, here)| (up - here) * scale).collect()))
                }),
            }
        });
        described.push(Selected { group, evidence, p_value: chance.p_value(evidence), plain, slope, alternatives });
    }
    search.selected = members;
    Ok(described)
}

/// What the fit of all findings has left behind.
pub(crate) struct Fitted<'f, const N: usize> {
    pub held_out: &'f HeldOut<N>,
    pub after: &'f BlockSquares<N>,
    pub residual_after: &'f [Vec<f64>; N],
}

pub(crate) fn finding_of<const N: usize>(
    search: &Search<'_, '_, N>,
    member: &Selected<N>,
    own: &std::ops::Range<usize>,
    own_coefficients: &[f64],
    fitted: &Fitted<'_, N>,
    seed: u64,
) -> Finding {
    let system = &*search.system;
    let data = system.data;
    let group = &system.groups[member.group];
    let candidate = &group.candidate;
    let effect = candidate.effect(data, &group.shape, own_coefficients);

    // Gain of this finding, given the others, on the joints it acts on.
    let without = fitted.held_out.squares_without(&data.residual_nm, own.clone());
    let (held_out_gain, held_out_gain_ci95) =
        gain_with_interval(&without, fitted.after, &acting_on(&member.plain), seed);

    // Intervals: coefficients (and the shape, linearised) of resampled blocks.
    let parameters = effect.as_ref().map_or_else(Vec::new, |effect| {
        let slope = member.slope.as_ref().map(|slope| system.whiten(slope));
        let columns = system.columns_of(&search.selected);
        let base = columns.len();
        // Without a refined shape the products are those of the held-out fit.
        let with_slope =
            slope.as_ref().map(|slope| BlockGram::of(system, &columns, Some(slope), &fitted.held_out.blocks));
        let gram = with_slope.as_ref().unwrap_or(&fitted.held_out.gram);
        let kept: Vec<usize> = (0..base + usize::from(slope.is_some())).collect();
        let estimated = |weights: &[f64]| {
            let fit = gram.fit(weights, &kept);
            let mut shape = group.shape.clone();
            if slope.is_some() {
                shape[0] = (shape[0] + fit[base]).max(1e-9);
            }
            candidate.effect(data, &shape, &fit[own.clone()])
        };
        let draws = resampled(gram.blocks(), seed, estimated);
        let drawn: Vec<_> = draws.into_iter().flatten().map(|effect| parameters_of(&effect)).collect();
        // Draws scatter about the estimate that all blocks together give, which need not be the refined one.
        let centre = estimated(&vec![1.0; gram.blocks()]).map(|effect| parameters_of(&effect));
        parameters_of(effect)
            .into_iter()
            .enumerate()
            .map(|(p, (name, value))| {
                let ci95 = (0..value.len())
                    .map(|i| {
                        let [low, high] = interval(drawn.iter().map(|draw| draw[p].1[i]).collect());
                        let shift = centre.as_ref().map_or(0.0, |centre| value[i] - centre[p].1[i]);
                        [(low + shift).min(value[i]), (high + shift).max(value[i])]
                    })
                    .collect();
                Parameter { name, value, ci95 }
            })
            .collect()
    });
    let explained = (0..N).map(|j| torque_rms(&member.plain, own_coefficients, j));
    let plots = plots::of_member(data, candidate.as_ref(), &member.plain, own_coefficients, fitted.residual_after);
    Finding {
        label: candidate.label(),
        location: candidate.location(),
        joints: candidate.location().places().0,
        links: candidate.location().places().1,
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

/// The effect of a ripple.
fn ripple_effect<const N: usize>(data: &RegressionData<N>, line: &RippleLine) -> Option<Effect> {
    let candidate = TorqueRipple { joint: line.joint };
    candidate.effect(data, &[line.cycles_per_rev], &[line.sine_nm, line.cosine_nm])
}

pub(crate) fn ripple_finding<const N: usize>(
    data: &RegressionData<N>,
    line: &RippleLine,
    evaluated: &Evaluated<'_, N>,
    after: &BlockSquares<N>,
    blocks: &TimeBlocks,
) -> Finding {
    // Without this line its torque is back in the residual.
    let column = data.filter(&line.torque(data));
    let torque = column.rows[line.joint].clone().unwrap_or_default();
    let mut back = evaluated.original.clone();
    back[line.joint] = data.residual_nm[line.joint].iter().zip(torque.iter()).map(|(r, x)| r + x).collect();
    let (with, without) = (plain_squares(&data.residual_nm, blocks), plain_squares(&back, blocks));
    // The other findings' part cancels but for the cross term, which is small: a ripple is orthogonal to slow causes.
    let raised: BlockSquares<N> = after
        .iter()
        .zip(with.iter().zip(&without))
        .map(|(after, (with, without))| std::array::from_fn(|j| (after[j] + without[j] - with[j]).max(0.0)))
        .collect();
    let (held_out_gain, held_out_gain_ci95) = gain_with_interval(&raised, after, &[line.joint], evaluated.seed);
    let error = 1.96 * line.standard_error_nm;
    let effect = ripple_effect(data, line);
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
        joints: vec![line.joint],
        links: Vec::new(),
        effect,
        parameters,
        signature: None,
        p_value: (-0.5 * line.evidence).exp().min(LARGEST_P),
        held_out_gain,
        held_out_gain_ci95,
        explained_rms_nm: amplitude / 2f64.sqrt(),
        evidence: line.evidence,
        alternatives: Vec::new(),
        plots: plots::of_ripple(data, line),
    }
}

pub(crate) fn squares(rms: &[[f64; 2]]) -> Vec<[f64; 2]> {
    rms.iter().map(|pair| [pair[0] * pair[0], pair[1] * pair[1]]).collect()
}

pub(crate) fn deflection_finding(found: &DeflectionFinding, names: &JointNames, seed: u64) -> Finding {
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
        joints: vec![found.joint],
        links: Vec::new(),
        effect: Some(found.effect.clone()),
        parameters,
        signature: None,
        p_value: (-0.5 * found.evidence).exp().min(LARGEST_P),
        held_out_gain,
        held_out_gain_ci95,
        explained_rms_nm: 0.0,
        evidence: found.evidence,
        alternatives: Vec::new(),
        plots: plots::of_deflection(found, names),
    }
}
