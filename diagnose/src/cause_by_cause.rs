//! The search for single causes, each at its place.

use std::sync::Arc;

use nalgebra::SVector;
use tribo_logs::RobotLog;
use tribo_posterior::PlainFits;
use tribo_regression::cause::{Candidate, candidates};
use tribo_regression::deflection::deflections;
use tribo_regression::evidence::joint_fit;
use tribo_regression::ripple::{RippleLine, ripples};
use tribo_regression::{CauseLabel, Column, DiagnoseError, EvaluatedColumns, RegressionData, System, rms, subtracted};

use crate::conclusion::conclude;
use crate::diagnosis::Diagnosis;
use crate::evaluated::{Before, Evaluated};
use crate::judged::judge;
use crate::search::Search;
use crate::settings::DiagnoseSettings;
use crate::significance::Chance;

/// What is asked of logs, cause by cause.
pub(crate) struct Question<'q, const N: usize> {
    /// Labels of the causes.
    pub looked_for: &'q dyn Fn(CauseLabel) -> bool,
    /// Kinds of causes in most joints beyond which nobody would believe an answer; `None` where any number will do.
    pub most_kinds: Option<usize>,
    /// What plain fits predict of parts that were held out, to stand beside the answer.
    pub plain_fits: Option<&'q PlainFits>,
    /// Logs that nothing is fitted to.
    pub validate: &'q [(String, RobotLog)],
    /// What figures before the findings are of; the data's own model where `None`.
    pub before: Option<Before<'q, N>>,
}

/// Explains logs by the fewest causes, each at its place; `None` if they are of too many kinds. What ripples explain is taken out of the
/// data's residual.
pub(crate) fn cause_by_cause<const N: usize>(
    question: &Question<'_, N>,
    data: &mut RegressionData<N>,
    settings: &DiagnoseSettings,
    step: &dyn Fn(&str, f64) -> Result<(), DiagnoseError>,
) -> Result<Option<Diagnosis>, DiagnoseError> {
    let original = data.residual_nm.clone();
    let all = candidates::<N>().into_iter().filter(|candidate| (question.looked_for)(candidate.label()));
    let causes: Vec<Arc<dyn Candidate<N>>> = all.map(Arc::from).collect();

    step("ripple", 0.08)?;
    let mut lines = ripples(data, &[]);
    subtract_ripples(data, &original, &lines);
    let mut round = 0;
    loop {
        let at = |fraction: f64| 0.2 + 0.33 * (f64::from(round) + fraction);
        step("candidates", at(0.0))?;
        let mut evaluated_columns = EvaluatedColumns::of(data, &causes);
        // The colour of the noise: first of what everything together leaves, then of what the selection leaves.
        let mut left = evaluated_columns.saturated_residual(data);
        let mut colours = 0;
        let (mut system, selected, inflation, chance) = loop {
            step("selection", at(0.3 + 0.3 * f64::from(colours)))?;
            // The last system takes the columns: beside their whitened copies they would be a third of the memory.
            let groups = evaluated_columns.groups.clone();
            let mut system = if colours == 0 {
                System::new(data, groups, &evaluated_columns.columns, &left)
            } else {
                System::new(data, groups, std::mem::take(&mut evaluated_columns.columns), &left)
            };
            let go_on = || step("selection", at(0.3 + 0.3 * f64::from(colours))).is_ok();
            let mut search = Search::new(&mut system, 1.0);
            (search.thorough, search.most_kinds) = (colours > 0, question.most_kinds);
            if !search.run(&go_on) {
                return Err(DiagnoseError::Cancelled);
            }
            if search.gave_up {
                return Ok(None);
            }
            if colours == 0 {
                left = second_colour(&search, left);
                colours = 1;
                continue;
            }
            let mut chance = Chance::of(&search, settings.seed);
            if chance.inflation > INFLATED || chance.joint_inflation.iter().any(|inflation| *inflation > INFLATED) {
                // Correlation is mostly that of a joint: it loses weight, and the others do not pay for it.
                search.system.deflate(&chance.joint_inflation);
                search.selected.clear();
                if !search.run(&go_on) {
                    return Err(DiagnoseError::Cancelled);
                }
                if search.gave_up {
                    return Ok(None);
                }
                chance = Chance::of(&search, settings.seed);
                if chance.inflation > INFLATED {
                    search.inflation = chance.inflation;
                    chance = Chance::of(&search, settings.seed);
                }
            }
            let (selected, inflation) = (search.selected.clone(), search.inflation);
            break (system, selected, inflation, chance);
        };
        let mut search = Search::new(&mut system, inflation);
        search.selected = selected;

        // A ripple may hide behind what has now been explained.
        if round == 0 {
            let explained = explained_torque(&search);
            let again = ripples(data, &explained);
            if again.len() != lines.len() {
                lines = again;
                round = 1;
                subtract_ripples(data, &original, &lines);
                continue;
            }
        }
        step("evidence", 0.88)?;
        let evaluated = Evaluated {
            original: &original,
            before: question.before,
            lines: &lines,
            plain_fits: question.plain_fits,
            deflections: &deflections(data),
            chance: &chance,
            seed: settings.seed,
        };
        let judged = judge(&mut search, &evaluated, step)?;
        // The written model is read back where the columns stood.
        drop(system);
        return conclude(data, judged, &evaluated, question.validate, step).map(Some);
    }
}

/// Inflation beyond which the search is repeated with deflated evidence.
const INFLATED: f64 = 1.15;

/// The residual less the ripples.
fn subtract_ripples<const N: usize>(data: &mut RegressionData<N>, original: &[Vec<f64>; N], lines: &[RippleLine]) {
    let columns: Vec<Column<N>> = lines.iter().map(|line| data.filter(&line.torque(data))).collect();
    data.residual_nm = subtracted(original.clone(), &columns, &vec![1.0; columns.len()]);
}

/// What the selection leaves of the residual (Nm), but what everything together leaves where the selection explains nothing
/// although much could be explained: a colour that holds an unexplained constant whitens every constant away.
fn second_colour<const N: usize>(search: &Search<'_, '_, N>, saturated: [Vec<f64>; N]) -> [Vec<f64>; N] {
    let mut left = residual_after(search);
    for (j, everything) in saturated.into_iter().enumerate() {
        let untouched = rms(&left[j]) > UNTOUCHED * rms(&search.system.data.residual_nm[j]);
        if untouched && rms(&left[j]) > MUCH * rms(&everything) {
            left[j] = everything;
        }
    }
    left
}

/// RMS left by nothing over RMS left by everything from which on something is surely missing.
const MUCH: f64 = 3.0;
/// RMS left by the selection over RMS of the residual from which on it explains nothing.
const UNTOUCHED: f64 = 0.9;

/// What the selection leaves of the residual (Nm), unwhitened.
fn residual_after<const N: usize>(search: &Search<'_, '_, N>) -> [Vec<f64>; N] {
    let coefficients = joint_fit(search.system, &search.system.columns_of(&search.selected)).coefficients;
    let plain: Vec<Column<N>> = search.selected.iter().flat_map(|group| search.system.plain_columns(*group)).collect();
    subtracted(search.system.data.residual_nm.clone(), &plain, &coefficients)
}

/// Torque of the selected causes on the fine grid (Nm).
fn explained_torque<const N: usize>(search: &Search<'_, '_, N>) -> Vec<SVector<f64, N>> {
    let data = search.system.data;
    let mut sum = vec![SVector::<f64, N>::zeros(); data.motion.len()];
    let coefficients = joint_fit(search.system, &search.system.columns_of(&search.selected)).coefficients;
    let mut rest = &coefficients[..];
    for group in search.selected.iter().map(|group| &search.system.groups[*group]) {
        let (own, others) = rest.split_at(group.columns.len());
        rest = others;
        group.candidate.add_to(data, &group.shape, own, &mut sum);
    }
    sum
}
