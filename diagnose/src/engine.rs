//! From logs and a nominal model to a diagnosis.

use std::sync::Arc;

use nalgebra::SVector;
use tribo_logs::RobotLog;
use tribo_robot::mass_matrix;
use tribo_sim::Truth;

use crate::cause::{Candidate, TorqueRipple, candidates};
use crate::conclusion::{Evaluated, conclude};
use crate::deflection::deflections;
use crate::diagnosis::{CauseLabel, Diagnosis, JointMisfit, Location};
use crate::evidence::joint_fit;
use crate::noise_level::rms;
use crate::posterior::baseline::PlainFits;
use crate::posterior::explain::{Given, explain};
use crate::posterior::gate::{AS_WELL, regression, wrongness};
use crate::posterior::sign_width::sharper_sign;
use crate::ripple::{RippleLine, ripples};
use crate::scene::{Column, Scene, subtracted};
use crate::search::{Search, joints_and_kinds};
use crate::significance::Chance;
use crate::system::{EvaluatedColumns, System};
use crate::{Diagnosable, DiagnoseError, Nominal};

/// What the caller chooses.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DiagnoseSettings {
    /// Seed of flips and bootstrap.
    pub seed: u64,
    /// Band of the residual (Hz); `None` chooses it from the noise of the log.
    pub band_hz: Option<f64>,
}

/// Fewest samples per joint after averaging.
const LEAST_SAMPLES: usize = 40;
/// Why nothing stands beside the answer.
const TOO_SHORT_TO_SPLIT: &str =
    "the log is too short to hold a third of it out: plain fits cannot be compared with the answer";
/// RMS that causes found one by one leave, over the sensors' noise in the band, from which on a joint is unexplained.
const MUCH_LEFT: f64 = 4.0;
/// Kinds of causes in most joints up to which they are few: dry friction, viscous friction and one more.
const MOST_KINDS: usize = 3;
/// Kinds of causes in most joints beyond which a search that goes on would not be believed, whatever is taken back at its end.
const HOPELESS_KINDS: usize = MOST_KINDS + 1;
/// What causes in most joints predict worse than least squares of friction, offsets and all links, mean of the joints' ratios, from which on
/// they are others.
const BEHIND_FULL_FIT: f64 = 1.1;
/// Inflation beyond which the search is repeated with deflated evidence.
const INFLATED: f64 = 1.15;

/// Finds what the nominal model lacks.
///
/// ```text
/// log → residual in band → ripples at full rate → whitened regression on all causes → forward–backward selection
///     → sign flips (chance) → held-out gain, intervals, rivals → verdict
/// ```
///
/// `validate` are logs that no parameter is fitted to. `progress` hears stage and fraction and stops the work by
/// answering `false`. The same logs, model and seed give the same bits.
///
/// # Errors
/// [`DiagnoseError`].
pub fn diagnose(
    logs: &[RobotLog],
    nominal: &impl Diagnosable,
    validate: &[(String, RobotLog)],
    settings: &DiagnoseSettings,
    progress: &(dyn Fn(&str, f64) -> bool + Sync),
) -> Result<Diagnosis, DiagnoseError> {
    diagnose_with_reference(logs, &[], nominal, validate, settings, progress)
}

/// [`diagnose`] with logs of the same arm whose flange is `unloaded`: they share everything with the others but the payload.
///
/// # Errors
/// [`DiagnoseError`].
pub fn diagnose_with_reference(
    logs: &[RobotLog],
    unloaded: &[RobotLog],
    nominal: &impl Diagnosable,
    validate: &[(String, RobotLog)],
    settings: &DiagnoseSettings,
    progress: &(dyn Fn(&str, f64) -> bool + Sync),
) -> Result<Diagnosis, DiagnoseError> {
    nominal.diagnosed(logs, unloaded, validate, settings, progress)
}

/// The search of [`diagnose_with_reference`].
pub(crate) fn explained<const N: usize>(
    logs: &[RobotLog],
    unloaded: &[RobotLog],
    nominal: &Nominal<N>,
    validate: &[(String, RobotLog)],
    settings: &DiagnoseSettings,
    progress: &(dyn Fn(&str, f64) -> bool + Sync),
) -> Result<Diagnosis, DiagnoseError> {
    let step =
        |stage: &str, fraction: f64| if progress(stage, fraction) { Ok(()) } else { Err(DiagnoseError::Cancelled) };
    if logs.is_empty() {
        return Err(DiagnoseError::NoLog);
    }
    step("residual", 0.0)?;
    let mut scene = Scene::of_logs(logs, nominal, settings.band_hz)?;
    if scene.time_s.len() < LEAST_SAMPLES {
        return Err(DiagnoseError::TooShort { got: scene.time_s.len(), need: LEAST_SAMPLES });
    }
    // The width of the smooth sign is the model's own affair: what is asked of is the model with the width that the log shows.
    let asked = nominal;
    let mut whole = regression(&scene, &[]);
    let sharper = sharper_sign(&scene, &whole).map(|width| asked.with_sign(width));
    let nominal = sharper.as_ref().unwrap_or(asked);
    let mut asked_nm = None;
    if sharper.is_some() {
        let mut sharp = Scene::of_logs(logs, nominal, scene.chains.first().map(|chain| chain.band_hz))?;
        sharp.borrow_regressors(&scene);
        asked_nm = Some(std::mem::replace(&mut scene, sharp).residual_nm);
        whole = regression(&scene, &[]);
    }
    let before = asked_nm.as_ref().map(|residual_nm| Before { model: asked, residual_nm });
    // With logs of a bare flange all is fitted together anyway: nobody needs to ask how much is wrong.
    let few = unloaded.is_empty().then(|| wrongness(&scene, &whole)).filter(|wrong| !wrong.everywhere);
    drop(whole);
    // Causes in most joints are a model that is wrong everywhere if they are of many kinds, or leave most joints unexplained and more
    // than all families would; and causes found one by one need not make an arm together, families fitted with every link a body do.
    let stands = |found: &Diagnosis, all_nm: &[f64]| {
        let worse_than = |joint: &JointMisfit, other_nm: f64, own_nm: f64| {
            own_nm > MUCH_LEFT * joint.noise_floor_nm && own_nm > AS_WELL * other_nm
        };
        let unexplained = |(joint, all_nm): &(&JointMisfit, &f64)| worse_than(joint, **all_nm, joint.rms_after_nm);
        let unexplained = found.joints.iter().zip(all_nm).filter(unexplained).count();
        // Least squares of friction and offset is a witness: where it predicts a joint better, the joint's causes are others.
        // So is that of friction, offsets and all links, unbounded as it is: causes that are the right ones predict no worse.
        let beaten = found.unseen.as_ref().is_some_and(|unseen| {
            let predicted = unseen.extended_nm.iter().zip(&unseen.plain_nm);
            unseen.ratio_to(&unseen.full_nm) > BEHIND_FULL_FIT
                || found
                    .joints
                    .iter()
                    .zip(predicted)
                    .any(|(joint, (own_nm, plain_nm))| worse_than(joint, *plain_nm, *own_nm))
        });
        let places: Vec<(CauseLabel, Location)> =
            found.findings.iter().map(|finding| (finding.label, finding.location)).collect();
        let (joints, kinds) = joints_and_kinds(&places);
        let everywhere = 2 * joints > N && (2 * unexplained > N || kinds > MOST_KINDS || beaten);
        !everywhere && is_model(nominal, &found.extension)
    };
    let one_by_one = match few {
        Some(wrong) => {
            let plain_fits = wrong.plain_fits.as_ref();
            // A search gives up only here: elsewhere it ends soon, and the small causes that it finds beside the true ones are pruned.
            let most_kinds = wrong.in_many_joints.then_some(HOPELESS_KINDS);
            let question = Question { looked_for: &|_| true, most_kinds, plain_fits, validate, before };
            let mut found = cause_by_cause(&question, logs, &mut scene, settings, &step)?;
            if let (Some(found), None) = (&mut found, plain_fits) {
                found.notes.push(TOO_SHORT_TO_SPLIT.to_owned());
            }
            found.filter(|found| stands(found, &wrong.left_nm))
        }
        None => None,
    };
    drop(scene);
    let mut diagnosis = match one_by_one {
        Some(found) => found,
        None => explain(&Given { logs, unloaded, validate }, [asked, nominal], settings, &step)?,
    };
    if let Some(Nominal { smoothing_rad_s, .. }) = sharper {
        diagnosis.smoothing_rad_s = Some(smoothing_rad_s);
        diagnosis.notes.push(format!(
            "dry friction turns round within {smoothing_rad_s} rad/s, faster than the model's {} rad/s: the extended model has that width (friction.smoothing_rad_s)",
            asked.smoothing_rad_s
        ));
    }
    progress("done", 1.0);
    Ok(diagnosis)
}

/// A model that is asked about, where the scene has another in its place, and what it leaves (Nm).
#[derive(Clone, Copy)]
pub(crate) struct Before<'b, const N: usize> {
    pub model: &'b Nominal<N>,
    pub residual_nm: &'b [Vec<f64>; N],
}

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
    /// What figures before the findings are of; the scene's own model where `None`.
    pub before: Option<Before<'q, N>>,
}

/// Explains logs by the fewest causes, each at its place; `None` if they are of too many kinds. What ripples explain is taken out of the
/// scene's residual.
pub(crate) fn cause_by_cause<const N: usize>(
    question: &Question<'_, N>,
    logs: &[RobotLog],
    scene: &mut Scene<N>,
    settings: &DiagnoseSettings,
    step: &dyn Fn(&str, f64) -> Result<(), DiagnoseError>,
) -> Result<Option<Diagnosis>, DiagnoseError> {
    let original = scene.residual_nm.clone();
    let all = candidates::<N>().into_iter().filter(|candidate| (question.looked_for)(candidate.label()));
    let causes: Vec<Arc<dyn Candidate<N>>> = all.map(Arc::from).collect();

    step("ripple", 0.08)?;
    let mut lines = ripples(scene, &[]);
    subtract_ripples(scene, &original, &lines);
    step("candidates", 0.12)?;
    let evaluated_columns = EvaluatedColumns::of(scene, &causes);
    let mut round = 0;
    loop {
        let at = |fraction: f64| 0.2 + 0.33 * (f64::from(round) + fraction);
        // The colour of the noise: first of what everything together leaves, then of what the selection leaves.
        let mut left = evaluated_columns.saturated_residual(scene);
        let mut colours = 0;
        let (mut system, selected, inflation, chance) = loop {
            step("selection", at(0.3 + 0.3 * f64::from(colours)))?;
            let mut system = System::new(scene, &evaluated_columns, &left);
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
            let again = ripples(scene, &explained);
            if again.len() != lines.len() {
                lines = again;
                round = 1;
                subtract_ripples(scene, &original, &lines);
                continue;
            }
        }
        step("evidence", 0.88)?;
        let evaluated = Evaluated {
            original: &original,
            before: question.before,
            lines: &lines,
            plain_fits: question.plain_fits,
            deflections: &deflections(scene),
            chance: &chance,
            logs,
            seed: settings.seed,
        };
        return conclude(&mut search, &evaluated, question.validate, step).map(Some);
    }
}

/// Whether effects on top of a model leave an arm whose every link has a mass and whose mass matrix is positive definite.
fn is_model<const N: usize>(nominal: &Nominal<N>, effects: &[tribo_sim::Effect]) -> bool {
    let all = nominal.effects.iter().chain(effects).cloned().collect();
    let truth = Truth { effects: all, ..Truth::new(nominal.arm.clone(), nominal.friction) };
    truth.validate().is_ok() && mass_matrix(&truth.true_arm(), &SVector::zeros()).cholesky().is_some()
}

/// The residual less the ripples.
fn subtract_ripples<const N: usize>(scene: &mut Scene<N>, original: &[Vec<f64>; N], lines: &[RippleLine]) {
    let columns: Vec<Column<N>> = lines.iter().map(|line| scene.filter(&line.torque(scene))).collect();
    scene.residual_nm = subtracted(original, &columns, &vec![1.0; columns.len()]);
}

/// What the selection leaves of the residual (Nm), but what everything together leaves where the selection explains nothing
/// although much could be explained: a colour that holds an unexplained constant whitens every constant away.
fn second_colour<const N: usize>(search: &Search<'_, '_, N>, saturated: [Vec<f64>; N]) -> [Vec<f64>; N] {
    let mut left = residual_after(search);
    for (j, everything) in saturated.into_iter().enumerate() {
        let untouched = rms(&left[j]) > UNTOUCHED * rms(&search.system.scene.residual_nm[j]);
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
    subtracted(&search.system.scene.residual_nm, &plain, &coefficients)
}

/// Torque of the selected causes on the fine grid (Nm).
fn explained_torque<const N: usize>(search: &Search<'_, '_, N>) -> Vec<SVector<f64, N>> {
    let scene = search.system.scene;
    let mut sum = vec![SVector::<f64, N>::zeros(); scene.samples.len()];
    let coefficients = joint_fit(search.system, &search.system.columns_of(&search.selected)).coefficients;
    let groups = search.selected.iter().map(|group| &search.system.groups[*group]);
    let columns = groups.flat_map(|group| group.candidate.columns(scene, &group.shape));
    for (column, coefficient) in columns.zip(coefficients) {
        column.add_to(&mut sum, coefficient);
    }
    sum
}

/// The effect of a ripple.
pub(crate) fn ripple_effect<const N: usize>(scene: &Scene<N>, line: &RippleLine) -> Option<tribo_sim::Effect> {
    let candidate = TorqueRipple { joint: line.joint };
    candidate.effect(scene, &[line.cycles_per_rev], &[line.sine_nm, line.cosine_nm])
}
