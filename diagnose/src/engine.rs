//! From logs and a nominal model to a diagnosis.

use nalgebra::SVector;
use tribo_logs::RobotLog;
use tribo_posterior::{Problem, sharper_sign, sticking};
use tribo_regression::{CauseLabel, DiagnoseError, Location, Nominal, PushWindow, RegressionData};
use tribo_robot::mass_matrix;
use tribo_sim::Truth;

use crate::cause_by_cause::{Question, cause_by_cause};
use crate::diagnosis::{Diagnosis, JointMisfit, Unseen};
use crate::evaluated::Before;
use crate::families::explain::{Given, explain};
use crate::families::gate::{AS_WELL, Wrongness, regression, wrongness};
use crate::search::joints_and_kinds;
use crate::settings::DiagnoseSettings;
use crate::torque_sides::SameSides;

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

/// What [`diagnose_with_reference`](crate::diagnose_with_reference) answers: causes one by one where few are wrong, else all families together.
pub(crate) fn explained<const N: usize>(
    logs: &[RobotLog],
    unloaded: &[RobotLog],
    nominal: &Nominal<N>,
    validate: &[(String, RobotLog)],
    settings: &DiagnoseSettings,
    progress: &(dyn Fn(&str, f64) -> bool + Sync),
) -> Result<Diagnosis, DiagnoseError> {
    let same_sides = SameSides::of(logs, unloaded, validate);
    let mut diagnosis = explained_alike(&same_sides.given(), nominal, settings, progress)?;
    diagnosis.notes.extend(same_sides.notes());
    Ok(diagnosis)
}

/// The same of logs that have link-side torque, each or none.
fn explained_alike<const N: usize>(
    given: &Given<'_>,
    nominal: &Nominal<N>,
    settings: &DiagnoseSettings,
    progress: &(dyn Fn(&str, f64) -> bool + Sync),
) -> Result<Diagnosis, DiagnoseError> {
    let &Given { logs, unloaded, validate } = given;
    let step =
        |stage: &str, fraction: f64| if progress(stage, fraction) { Ok(()) } else { Err(DiagnoseError::Cancelled) };
    if logs.is_empty() {
        return Err(DiagnoseError::NoLog);
    }
    step("residual", 0.0)?;
    let mut data = RegressionData::of_logs(logs, nominal, settings.band_hz)?;
    if data.time_s.len() < LEAST_SAMPLES {
        return Err(DiagnoseError::TooShort { got: data.time_s.len(), need: LEAST_SAMPLES });
    }
    // How friction turns round is the model's own affair: what is asked of is the model whose joints turn round as the log shows.
    let asked = nominal;
    let mut shown = asked.clone();
    let mut asked_nm = None;
    let whole = turned_round(&mut data, &mut shown, &mut asked_nm, &[])?;
    // With logs of a bare flange all is fitted together anyway: nobody needs to ask how much is wrong.
    let mut wrong = unloaded.is_empty().then(|| wrongness(&data, &whole));
    drop(whole);
    // A push hides how friction turns round; the log beside it shows that.
    if let (Some(Wrongness { pushes, .. }), None) = (&wrong, &asked_nm)
        && !pushes.is_empty()
    {
        turned_round(&mut data, &mut shown, &mut asked_nm, pushes)?;
        if asked_nm.is_some() {
            wrong = Some(wrongness(&data, &regression(&data, &[])));
        }
    }
    let nominal = &shown;
    let before = asked_nm.as_ref().map(|residual_nm| Before { model: asked, residual_nm });
    let few = wrong.filter(|wrong| !wrong.everywhere);
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
        // So it is, however few joints have causes, where a push is named or most joints are unexplained, and a plain fit predicts better or none was made.
        let preferable = found.unseen.as_ref().is_none_or(Unseen::baseline_is_preferable);
        let pushed = found.findings.iter().any(|finding| finding.label == CauseLabel::ExternalContact);
        let everywhere = preferable && (2 * unexplained > N || pushed)
            || 2 * joints > N && (2 * unexplained > N || kinds > MOST_KINDS || beaten);
        !everywhere && is_model(nominal, &found.extension)
    };
    let one_by_one = match few {
        Some(wrong) => {
            let plain_fits = wrong.plain_fits.as_ref();
            // A search gives up only here: elsewhere it ends soon, and the small causes that it finds beside the true ones are pruned.
            let most_kinds = wrong.in_many_joints.then_some(HOPELESS_KINDS);
            let question = Question { looked_for: &|_| true, most_kinds, plain_fits, validate, before };
            let mut found = cause_by_cause(&question, &mut data, settings, &step)?;
            if let (Some(found), None) = (&mut found, plain_fits) {
                found.notes.push(TOO_SHORT_TO_SPLIT.to_owned());
            }
            found.filter(|found| stands(found, &wrong.left_nm))
        }
        None => None,
    };
    drop(data);
    let mut diagnosis = match one_by_one {
        Some(found) => found,
        None => explain(given, [asked, nominal], settings, &step)?,
    };
    if nominal.sticks && !asked.sticks {
        diagnosis.sticks = true;
        diagnosis.notes.push(
            "joints stick where they stop for a moment: the extended model has that (friction.sticks)".to_owned(),
        );
    }
    let smoothing_rad_s = nominal.smoothing_rad_s;
    if smoothing_rad_s != asked.smoothing_rad_s {
        diagnosis.smoothing_rad_s = Some(smoothing_rad_s);
        diagnosis.notes.push(format!(
            "dry friction turns round within {smoothing_rad_s} rad/s, faster than the model's {} rad/s: the extended model has that width (friction.smoothing_rad_s)",
            asked.smoothing_rad_s
        ));
    }
    progress("done", 1.0);
    Ok(diagnosis)
}

/// Replaces regression data by those of the model whose joints turn round as the log beside some pushes shows, with what the model left before (Nm)
/// where that is another one; the regression of the data.
fn turned_round<const N: usize>(
    data: &mut RegressionData<N>,
    model: &mut Nominal<N>,
    before_nm: &mut Option<[Vec<f64>; N]>,
    pushes: &[PushWindow],
) -> Result<Problem, DiagnoseError> {
    let mut problem = regression(data, pushes);
    for turns_round in [sticking::<N>, sharper_sign::<N>] {
        let Some(Nominal { sticks, smoothing_rad_s, .. }) = turns_round(data, &problem) else { continue };
        (model.sticks, model.smoothing_rad_s) = (sticks, smoothing_rad_s);
        let mut of_model = RegressionData::of_motion(&data.logged, model)?;
        of_model.borrow_regressors(data);
        let before = std::mem::replace(data, of_model).residual_nm;
        before_nm.get_or_insert(before);
        problem = regression(data, pushes);
    }
    Ok(problem)
}

/// Whether effects on top of a model leave an arm whose every link has a mass and whose mass matrix is positive definite.
fn is_model<const N: usize>(nominal: &Nominal<N>, effects: &[tribo_sim::Effect]) -> bool {
    let all = nominal.effects.iter().chain(effects).cloned().collect();
    let truth = Truth { effects: all, ..Truth::new(nominal.arm.clone(), nominal.friction) };
    truth.validate().is_ok() && mass_matrix(&truth.true_arm(), &SVector::zeros()).cholesky().is_some()
}
