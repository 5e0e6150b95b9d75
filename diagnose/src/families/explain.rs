//! The diagnosis of an arm whose model is wrong everywhere.

use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::Arc;

use tribo_logs::{RobotLog, median_period_s};
use tribo_posterior::{
    ArmScale, Bands, Baselines, Columns, Deviation, Family, Fit, HeldOut, Motion, MotionSpace, PARTS, Place, Problem,
    Selection, Start, Unseen, correlation_time, deviations, distance, extremes, is_payload, posterior, repetition,
    select, set_arm, soft_friction, torque_of_changes, unknown_variance, written,
};
use tribo_regression::deflection::deflections;
use tribo_regression::{CauseLabel, DiagnoseError, Location, LoggedMotion, Nominal, RegressionData, rms};
use tribo_robot::JointNames;
use tribo_sim::Effect;

use crate::DiagnoseSettings;
use crate::diagnosis::{self, Diagnosis, Finding, Rejected, Validation, Verdict};
use crate::families::family_finding::Answer;
use crate::families::further::further_causes;
use crate::finding::deflection_finding;
use crate::held_out::gain_of_pairs;
use crate::next_experiment::NextExperiment;
use crate::plots;
use crate::remarks::{misfits_of_squares, note_on_baseline, notes_of};
use crate::stamps::take_stamps;
use crate::validation::validated_whole;

/// Logs to diagnose, logs of the same arm with a bare flange, and logs that nothing is fitted to.
pub(crate) struct Given<'g> {
    pub logs: &'g [RobotLog],
    pub unloaded: &'g [RobotLog],
    pub validate: &'g [(String, RobotLog)],
}

/// Band of the residual (Hz): holds the motion of an arm; the likelihood is tempered, so that it hardly matters.
const BAND_HZ: f64 = 10.0;
/// Widest band over the rate of a log: beyond it differences of positions are no accelerations.
const WIDEST_BAND: f64 = 0.2;
/// Most times that causes beyond the families are looked for.
const FURTHER_ROUNDS: usize = 3;
/// Most findings, causes beyond the families and what two encoders show among them.
const MOST_FINDINGS: usize = 8;
/// Relative standard deviation of a payload's mass beyond which the log does not determine it to a tenth.
const UNSURE_PAYLOAD: f64 = 0.05;
/// How often what is left of a joint says the same, from which on its path comes again.
const COMES_AGAIN: f64 = 1.5;
/// Predicted standard deviation of unseen torque, over what is left, beyond which a joint is not determined.
const UNDETERMINED: f64 = 1.0;

/// One fit of everything.
struct Fitted {
    all: Fit,
    selection: Selection,
    unseen: Unseen,
}

/// Most times that load friction and tilt are made linear about what the joints carry.
const ARM_ROUNDS: usize = 3;
/// Change of a joint's torque by that, over what is left of it, which is no change.
const NO_CHANGE: f64 = 0.1;

/// Fits all families, drops those that harm on unseen data and fits anew, then asks which the log shows; `set_arm` gives the columns what the joints
/// carry by a fit, and returns by how much that changes each joint's torque (RMS, Nm).
fn fitted(
    problem: &mut Problem,
    set_arm: &dyn Fn(&mut Problem, &Fit) -> Vec<f64>,
    seed: u64,
    step: &dyn Fn(&str, f64) -> Result<(), DiagnoseError>,
) -> Result<Fitted, DiagnoseError> {
    let parts = problem.all_parts();
    let link_side = problem.scale.link_side;
    let rules = |family: &Family| family.prior(link_side);
    let mut families: Vec<Family> =
        Family::of_gears(problem.scale.link_side).filter(|family| problem.has(*family)).collect();
    let mut asked = false;
    let too_short = DiagnoseError::TooShort { got: problem.columns.samples(&parts), need: problem.places.len() };
    loop {
        step("posterior", 0.3)?;
        let Some((mut all, mut about)) = posterior(problem, &parts, &Start::of(&families)) else {
            return Err(too_short);
        };
        for _ in 0..ARM_ROUNDS {
            let changes = set_arm(problem, &all);
            if changes.iter().zip(&all.variances).all(|(change, own)| *change < NO_CHANGE * own.sqrt()) {
                break;
            }
            let Some(next) = posterior(problem, &parts, &Start::of(&families)) else { break };
            (all, about) = next;
        }
        let problem = &*problem;
        let equations = problem.normal_equations(&about, &parts);
        if !std::mem::replace(&mut asked, true) && soft_friction(problem, &equations, &parts, &all) {
            families.push(Family::Lead);
            continue;
        }
        step("unseen parts", 0.5)?;
        let unseen = Unseen::of(problem, &all);
        // What surely harms where it was not fitted is no property of the arm.
        let harms = |family: &Family| {
            let (_, without) = unseen.without.iter().find(|(other, _)| other == family)?;
            let sum = |row: &[f64]| row.iter().zip(&all.variances).map(|(square, own)| square / own).sum::<f64>();
            let pairs: Vec<[f64; 2]> =
                without.iter().zip(&unseen.ours).map(|(without, ours)| [sum(without), sum(ours)]).collect();
            let (gain, [_, high]) = gain_of_pairs(&pairs, seed);
            (high < 0.0 && !rules(family).always).then_some(gain)
        };
        let worst = all.start.families.iter().filter_map(|family| Some((*family, harms(family)?)));
        if let Some((worst, _)) = worst.min_by(|a, b| a.1.total_cmp(&b.1)) {
            families = all.start.families.iter().copied().filter(|family| *family != worst).collect();
            continue;
        }
        step("families", 0.7)?;
        let selection = select(problem, &parts, &all);
        return Ok(Fitted { all, selection, unseen });
    }
}

/// Explains logs by the families of [`Family`], all fitted together.
///
/// ```text
/// logs → columns → posterior of all families → unseen parts → families by evidence → what is left: causes without a family
///      → all of it again around these → findings → file read back: residual after, validation
/// ```
///
/// Figures before are those of the model `asked`, which may differ from the nominal in the width of its sign.
///
/// # Errors
/// [`DiagnoseError`].
pub(crate) fn explain<const N: usize>(
    given: &Given<'_>,
    [asked, nominal]: [&Nominal<N>; 2],
    settings: &DiagnoseSettings,
    step: &dyn Fn(&str, f64) -> Result<(), DiagnoseError>,
) -> Result<Diagnosis, DiagnoseError> {
    let rates = given.logs.iter().filter_map(|log| median_period_s(&log.time_s)).map(f64::recip);
    let slowest_hz = rates.fold(f64::INFINITY, f64::min);
    let band_hz = settings.band_hz.unwrap_or_else(|| BAND_HZ.min(WIDEST_BAND * slowest_hz));
    let motion_of = |logs: &[RobotLog]| LoggedMotion::of_logs(logs, &nominal.arm, Some(band_hz)).map(Arc::new);
    let logged = motion_of(given.logs)?;
    let all_logged = match given.unloaded {
        [] => Arc::clone(&logged),
        unloaded => motion_of(&given.logs.iter().chain(unloaded).cloned().collect::<Vec<_>>())?,
    };
    let unloaded: Vec<bool> = (0..all_logged.chains.len()).map(|k| k >= given.logs.len()).collect();
    let fitted_around = |further: &[Finding],
                         before: Option<&RegressionData<N>>|
     -> Result<(RegressionData<N>, Problem, Fitted), DiagnoseError> {
        step("columns", 0.15)?;
        let around = with(nominal, &effects_of(further), true);
        let mut data = RegressionData::of_motion(&all_logged, &around)?;
        before.into_iter().for_each(|before| data.borrow_regressors(before));
        let scale = ArmScale::of(&data);
        let columns = Columns::of(&data, &scale, PARTS);
        let mut problem = Problem::of(&data, columns, scale, unloaded.clone());
        let carried = |problem: &mut Problem, fit: &Fit| {
            let effects = written::effects(&data, problem, &fit.state);
            let [bare, loaded] =
                [false, true].map(|payload| with(&data.nominal, &effects, payload).with_rigid_effects_in_the_arm().arm);
            let changes = set_arm(&mut problem.columns, &data, [&bare, &loaded], &unloaded);
            torque_of_changes(problem, &fit.state, &changes)
        };
        let fitted = fitted(&mut problem, &carried, settings.seed, step)?;
        Ok((data, problem, fitted))
    };
    // Families first; what they leave shows causes that no family has, around which the families are fitted again.
    let mut further: Vec<Finding> = Vec::new();
    let (mut data, mut problem, mut found) = fitted_around(&further, None)?;
    // What any user reaches, before anything is known of further causes.
    let baselines = Baselines::of(&problem, &problem.all_parts());
    let mut untouched: Option<Unseen> = None;
    // As they are without any push in the model.
    let weights: Vec<Vec<f64>> = (0..N).map(|j| problem.columns.row_weights(j).to_vec()).collect();
    for _ in 0..FURTHER_ROUNDS {
        let model = with(nominal, &written::effects(&data, &problem, &found.all.state), true);
        let next = further_causes(&logged, &model, &weights, settings, step)?;
        let places =
            |of: &[Finding]| of.iter().map(|finding| (finding.label, finding.location)).collect::<BTreeSet<_>>();
        let known = places(&next) == places(&further);
        if known && next.is_empty() {
            break;
        }
        further = next;
        let around = fitted_around(&further, Some(&data))?;
        let before = std::mem::replace(&mut found, around.2);
        (data, problem) = (around.0, around.1);
        untouched.get_or_insert(before.unseen);
        if known {
            break;
        }
    }
    let Fitted { all, selection, mut unseen } = found;
    if let Some(Unseen { nominal, plain, full, .. }) = untouched {
        (unseen.nominal, unseen.plain, unseen.full) = (nominal, plain, full);
    }

    // The file, and what it leaves of the logs when it is read back.
    step("extended model", 0.85)?;
    let mut extension = effects_of(&further);
    extension.extend(written::effects(&data, &problem, &all.state));
    let own_width = asked.smoothing_rad_s == nominal.smoothing_rad_s && asked.sticks == nominal.sticks;
    let fitted_to_the_same = further.is_empty() && given.unloaded.is_empty() && own_width;
    let before = if fitted_to_the_same { None } else { Some(RegressionData::of_motion(&logged, asked)?) };
    if !own_width {
        let all = RegressionData::of_motion(&all_logged, asked)?;
        let square = |samples: &Range<usize>, j: usize| all.residual_nm[j][samples.clone()].iter().map(|r| r * r).sum();
        let squares = |part: &usize| (0..N).map(|j| square(&problem.columns.parts[*part].samples, j)).collect();
        unseen.nominal = unseen.parts.iter().map(squares).collect();
    }
    let data_before = before.as_ref().unwrap_or(&data);
    // Two encoders show springs and gaps without any torque model.
    let seen: Vec<Finding> = deflections(data_before)
        .iter()
        .map(|found| deflection_finding(found, &data_before.nominal.arm.joint_names, settings.seed))
        .collect();
    extension.extend(seen.iter().filter_map(|finding| finding.effect.clone()));
    let extended = with(nominal, &extension, true);
    let without_payload = with(nominal, &extension, false);
    let left_nm: [Vec<f64>; N] = RegressionData::of_motion(&logged, &extended)?.residual_nm;
    let of_bare_flange = |logs| RegressionData::of_motion(&motion_of(logs)?, &without_payload);
    let bare_data = if given.unloaded.is_empty() { None } else { Some(of_bare_flange(given.unloaded)?) };

    let unsure = all.with_doubts(&problem);
    let answer = Answer {
        data: &data,
        problem: &problem,
        fit: &all,
        unsure: &unsure,
        selection: &selection,
        unseen: &unseen,
        seed: settings.seed,
    };
    let mut selected = selection.selected.clone();
    let worth = |family: &Family| selection.worth.get(family).copied().unwrap_or(0.0);
    selected.sort_by(|a, b| worth(b).total_cmp(&worth(a)));
    // A finding that surely harms where it was not fitted is none.
    let mut findings: Vec<Finding> = selected
        .iter()
        .flat_map(|family| answer.findings(*family))
        .filter(|finding| finding.held_out_gain_ci95[1] >= 0.0)
        .collect();
    let late = take_stamps(&data, &mut findings);
    findings.extend(further);
    findings.extend(seen);
    findings.sort_by(|a, b| b.evidence.total_cmp(&a.evidence));
    let cut = findings.len().saturating_sub(MOST_FINDINGS);
    for _ in 0..cut {
        // A body or a push is what somebody asks about, however little torque it is.
        let asked = |finding: &Finding| matches!(finding.label, CauseLabel::Payload | CauseLabel::ExternalContact);
        let weakest = findings.iter().rposition(|finding| !asked(finding)).unwrap_or(findings.len() - 1);
        findings.remove(weakest);
    }
    let payload_unsure = doubt_payload(&problem, [&all, &unsure], &mut findings, given.unloaded.is_empty());

    let rms_of = |squares: &[Vec<f64>]| unseen.rms_nm(&problem, squares);
    let report = diagnosis::Unseen {
        split: unseen.split.name(),
        nominal_nm: rms_of(&unseen.nominal),
        extended_nm: rms_of(&unseen.ours),
        plain_nm: rms_of(&unseen.plain),
        full_nm: rms_of(&unseen.full),
    };
    let held_out = [report.nominal_nm.clone(), report.extended_nm.clone()];
    let joints = misfits_of_squares(data_before, &data_before.residual_nm, &left_nm, &held_out);
    let sum = |row: &[f64]| row.iter().sum::<f64>();
    let pairs: Vec<[f64; 2]> =
        unseen.nominal.iter().zip(&unseen.ours).map(|(before, after)| [sum(before), sum(after)]).collect();
    let (gain_heldout, gain_heldout_ci95) = gain_of_pairs(&pairs, settings.seed);

    step("validation", 0.95)?;
    let rates_hz: Vec<f64> = data.chains.iter().map(|chain| chain.output_rate_hz()).collect();
    let space = MotionSpace::of(&problem);
    let in_turn = HeldOut { deviations: unseen.deviations, distance: space.in_turn(&problem) };
    let bands = Bands::of(&in_turn, &extremes(&problem, &all, &space, &rates_hz));
    // A push belongs to the log that it was found in.
    let not_lasting = |effect: &Effect| matches!(effect, Effect::ExternalContact { .. });
    let mut extended = extended;
    extended.effects.retain(|effect| !not_lasting(effect));
    let mut lasting = data.nominal.clone();
    lasting.effects.retain(|effect| !not_lasting(effect));
    let validation = given
        .validate
        .iter()
        .map(|named| {
            let (name, log) = named;
            if data.transmission && log.tau_link_nm.is_none() {
                return validated_whole([asked, nominal], &extension, named, Some(band_hz), settings.seed);
            }
            validated(
                name,
                log,
                [asked, nominal, &lasting, &extended],
                &problem,
                &all,
                &baselines,
                &bands,
                &space,
                settings,
                band_hz,
            )
        })
        .collect::<Result<Vec<_>, _>>()?;

    let mean = |values: &mut dyn Iterator<Item = f64>| {
        let (sum, count) = values.fold((0.0, 0.0), |(sum, count), x| (sum + x, count + 1.0));
        sum / f64::max(count, 1.0)
    };
    let band = bands.near();
    let predictive_sd_nm: Vec<f64> = (0..N)
        .map(|j| {
            let unknown: Vec<f64> =
                unseen.parts.iter().flat_map(|part| unknown_variance(&problem, &all, j, *part)).collect();
            let mut turning = in_turn.deviations[j].iter().map(|at| at.turning);
            let at = Deviation {
                residual_nm: 0.0,
                own: all.variances[j],
                unknown: mean(&mut unknown.into_iter()),
                motion: 1.0,
                turning: mean(&mut turning),
            };
            band.sd_nm(j, &at)
        })
        .collect();
    let mut notes = notes_of(&data);
    notes.extend(late);
    notes.extend(notes_on(&problem, &all, &report, cut, bare_data.as_ref(), &data.nominal.arm.joint_names));
    // Where plain least squares predicts better, the torque is not what any of the causes makes of it.
    let verdict = match () {
        () if report.baseline_is_preferable() => Verdict::Unknown,
        () if findings.is_empty() => Verdict::NothingMissing,
        () if payload_unsure || findings.iter().any(|finding| !finding.alternatives.is_empty()) => Verdict::Ambiguous,
        () => Verdict::Named,
    };
    Ok(Diagnosis {
        verdict,
        next_experiment: next_experiment(&findings, payload_unsure),
        findings,
        joint_names: data.nominal.arm.joint_names.clone(),
        joints,
        pattern: plots::cross_joint_pattern(data_before, &data_before.residual_nm),
        gain_heldout,
        gain_heldout_ci95,
        validation,
        rejected: rejected(&selection),
        extension,
        smoothing_rad_s: None,
        sticks: false,
        unseen: Some(report),
        predictive_sd_nm,
        assumptions: assumptions(&data, &all),
        notes,
        overview: plots::overview(data_before, &data_before.residual_nm),
        band_hz: data.chains.first().map_or(0.0, |chain| chain.band_hz),
        rate_hz: data.chains.first().map_or(0.0, |chain| chain.output_rate_hz()),
        samples: data_before.time_s.len(),
        bursts: data_before.bursts.len(),
    })
}

/// The effects of findings.
fn effects_of(findings: &[Finding]) -> Vec<Effect> {
    findings.iter().filter_map(|finding| finding.effect.clone()).collect()
}

/// The nominal model with effects, with or without the payload among them.
fn with<const N: usize>(nominal: &Nominal<N>, effects: &[Effect], payload: bool) -> Nominal<N> {
    let mut extended = nominal.clone();
    let kept = effects.iter().filter(|effect| payload || !matches!(effect, Effect::Payload { .. }));
    extended.effects.extend(kept.cloned());
    extended
}

/// Says of a payload that the log does not determine what else it could be.
fn doubt_payload(problem: &Problem, [all, unsure]: [&Fit; 2], findings: &mut [Finding], no_reference: bool) -> bool {
    let Some(mass) = problem.index(Place::Payload(0)).filter(|i| all.active.contains(i)) else { return false };
    let unsure = no_reference && is_payload(problem, all) && unsure.sd(mass) > UNSURE_PAYLOAD * all.state[mass];
    for finding in findings.iter_mut().filter(|finding| unsure && finding.label == CauseLabel::Payload) {
        for label in [CauseLabel::TorqueGain, CauseLabel::LinkInertial] {
            let known = finding.alternatives.iter().any(|other| other.label == label);
            if !known {
                finding.alternatives.push(diagnosis::Alternative {
                    label,
                    location: Location::Arm,
                    evidence_gap: 0.0,
                    why:
                        "a payload, heavier links and torques of another scale load the joints nearly alike; a log of \
                          the bare flange decides"
                            .to_owned(),
                });
            }
        }
    }
    unsure && findings.iter().any(|finding| finding.label == CauseLabel::Payload)
}

fn next_experiment(findings: &[Finding], payload_unsure: bool) -> Option<NextExperiment> {
    if payload_unsure {
        return Some(NextExperiment {
            motion: "unloaded_reference",
            instruction:
                "Record the same motion with nothing at the flange and give that log with --reference: all but the \
                          payload is then shared by both logs."
                    .to_owned(),
            separates: [(CauseLabel::Payload, Location::Arm), (CauseLabel::TorqueGain, Location::Arm)],
            expected_evidence: 0.0,
            evidence_of_this_log: 0.0,
            via_points: Vec::new(),
        });
    }
    let doubted = findings.iter().find(|finding| !finding.alternatives.is_empty())?;
    let rival = doubted.alternatives.first()?;
    Some(NextExperiment {
        motion: "another_motion",
        instruction: format!(
            "Give a second log of another motion, with other postures and speeds, beside this one: {}.",
            rival.why
        ),
        separates: [(doubted.label, doubted.location), (rival.label, rival.location)],
        expected_evidence: 0.0,
        evidence_of_this_log: rival.evidence_gap,
        via_points: Vec::new(),
    })
}

/// The written model, and the baselines, on a log that nothing was fitted to.
fn validated<const N: usize>(
    name: &str,
    log: &RobotLog,
    [asked, nominal, around, extended]: [&Nominal<N>; 4],
    problem: &Problem,
    all: &Fit,
    baselines: &Baselines,
    bands: &Bands,
    space: &MotionSpace,
    settings: &DiagnoseSettings,
    band_hz: f64,
) -> Result<Validation, DiagnoseError> {
    let one = std::slice::from_ref(log);
    let logged = Arc::new(LoggedMotion::of_logs(one, &nominal.arm, Some(band_hz))?);
    let of_model = |model: &Nominal<N>| RegressionData::of_motion(&logged, model);
    let (before, bare, after) = (of_model(asked)?, of_model(around)?, of_model(extended)?);
    let regression = |data: &RegressionData<N>| {
        Problem::of(data, Columns::of(data, &problem.scale, PARTS), problem.scale.clone(), vec![false])
    };
    let mut here = regression(&bare);
    let carrying = extended.with_rigid_effects_in_the_arm().arm;
    set_arm(&mut here.columns, &bare, [&carrying; 2], &[false]);
    let untouched = match around.effects.len() > nominal.effects.len() {
        true => Some(regression(&of_model(nominal)?)),
        false => None,
    };
    let parts = here.all_parts();
    let samples = before.time_s.len().max(1) as f64;
    let of_state = |state| -> Vec<f64> {
        let of_baselines = untouched.as_ref().unwrap_or(&here);
        let square = |j: usize| parts.iter().map(|part| of_baselines.unseen_square(state, j, *part)).sum::<f64>();
        (0..N).map(|j| (square(j) / samples).sqrt()).collect()
    };
    let motion = Motion::of(problem, &problem.all_parts());
    let away = distance(&space.points(&here, &parts), &space.points(problem, &problem.all_parts()));
    let band = bands.at(away);
    let inside: usize =
        (0..N).map(|j| deviations(&here, all, &motion, j, &parts).iter().filter(|at| band.holds(j, at)).count()).sum();
    let rms_of = |data: &RegressionData<N>| data.residual_nm.iter().map(|column| rms(column)).collect::<Vec<f64>>();
    let block = |data: &RegressionData<N>, part: &usize| -> f64 {
        let samples = here.columns.parts[*part].samples.clone();
        data.residual_nm.iter().flat_map(|column| &column[samples.clone()]).map(|r| r * r).sum()
    };
    let pairs: Vec<[f64; 2]> = parts.iter().map(|part| [block(&before, part), block(&after, part)]).collect();
    let (gain, gain_ci95) = gain_of_pairs(&pairs, settings.seed);
    Ok(Validation {
        log: name.to_owned(),
        before_nm: rms_of(&before),
        after_nm: rms_of(&after),
        plain_nm: of_state(&baselines.plain),
        full_nm: of_state(&baselines.full),
        inside95: Some(inside as f64 / (samples * N as f64)),
        gain,
        gain_ci95,
    })
}

fn notes_on<const N: usize>(
    problem: &Problem,
    all: &Fit,
    report: &diagnosis::Unseen,
    cut: usize,
    bare: Option<&RegressionData<N>>,
    names: &JointNames,
) -> Vec<String> {
    let mut notes: Vec<String> = note_on_baseline(report).into_iter().collect();
    let parts = problem.all_parts();
    for j in 0..N {
        let unknown: Vec<f64> = parts.iter().flat_map(|part| unknown_variance(problem, all, j, *part)).collect();
        let mean = unknown.iter().sum::<f64>() / unknown.len().max(1) as f64;
        if mean.sqrt() > UNDETERMINED * all.variances[j].sqrt() {
            notes.push(format!(
                "{} is not determined by this motion: what the parameters leave open is {:.3} Nm, more than what the fit leaves",
                names.of(j),
                mean.sqrt()
            ));
        }
    }
    if all.start.families.contains(&Family::Lead) {
        notes.push(
            "dry friction turns round before the joints do, as that of a physics engine (frictionloss of MuJoCo): the log is \
             simulated, or its velocities are late; the extended model holds it as friction_lead"
                .to_owned(),
        );
    }
    let comes_again = |j: usize| {
        let left = problem.residual_along(&all.state, j, &parts);
        repetition(&left, correlation_time(&left)) > COMES_AGAIN
    };
    if 2 * (0..N).filter(|j| comes_again(*j)).count() > N {
        notes.push(
            "the robot repeats its path in this log, and the model its errors: held-out parts show little that is new; a log of another path, \
             given with --validate, says more"
                .to_owned(),
        );
    }
    if cut > 0 {
        notes.push(format!("{cut} weaker findings are in the extended model and not listed"));
    }
    if let Some(bare) = bare {
        let left: Vec<String> = bare.residual_nm.iter().map(|column| format!("{:.3}", rms(column))).collect();
        notes.push(format!(
            "on the unloaded reference the extended model without its payload leaves {} Nm",
            left.join(" ")
        ));
    }
    notes
}

fn assumptions<const N: usize>(data: &RegressionData<N>, all: &Fit) -> Vec<String> {
    let mut assumptions: Vec<String> = data.chains.iter().map(ToString::to_string).collect();
    assumptions.dedup();
    let kappa: Vec<String> = all.kappa.iter().map(|kappa| format!("{kappa:.0}")).collect();
    assumptions.push(
        "more than half of the joints differ from the model: every family of causes is fitted to all joints together, with \
         priors of usual sizes; findings are the families that make the log likelier by 10 nat"
            .to_owned(),
    );
    assumptions.push(format!(
        "what is left is correlated: a sample of joint 0 to {} counts as 1/{} of one",
        all.kappa.len().saturating_sub(1),
        kappa.join(", 1/")
    ));
    assumptions.push(
        "the extended model holds every family, also those too weak to be named; every link stays a body".to_owned(),
    );
    assumptions.push("RMS gains are 1 − rms after / rms before, in the band".to_owned());
    assumptions
}

fn rejected(selection: &Selection) -> Vec<Rejected> {
    let mut all: Vec<Rejected> = selection
        .would_add
        .iter()
        .flat_map(|(family, nats)| {
            family.labels().iter().map(move |label| Rejected {
                label: *label,
                location: Location::Arm,
                evidence: nats.is_finite().then_some(2.0 * nats),
                reason: if nats.is_finite() {
                    "does not make the log likelier by 10 nat".to_owned()
                } else {
                    "only with values that physics forbids".to_owned()
                },
            })
        })
        .collect();
    all.sort_by(|a, b| b.evidence.unwrap_or(f64::NEG_INFINITY).total_cmp(&a.evidence.unwrap_or(f64::NEG_INFINITY)));
    all
}
