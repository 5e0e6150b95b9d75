//! What surrounds the findings: the misfit of every joint, notes, assumptions, and what was rejected.

use tribo_regression::evidence::Conditional;
use tribo_regression::{CauseLabel, RegressionData, rms};

use crate::diagnosis::{Finding, JointMisfit, Rejected, Unseen};
use crate::held_out::BlockSquares;
use crate::plots;
use crate::search::{LEAST_EVIDENCE, Search};
use crate::significance::Chance;

/// The misfit of every joint, from what is held out as RMS before and after (Nm).
pub(crate) fn misfits_of_squares<const N: usize>(
    data: &RegressionData<N>,
    before: &[Vec<f64>; N],
    after: &[Vec<f64>; N],
    held_out_nm: &[Vec<f64>; 2],
) -> Vec<JointMisfit> {
    let none = vec![[0.0; N]];
    let mut joints = misfits(data, before, after, &none, &none);
    for (j, joint) in joints.iter_mut().enumerate() {
        joint.held_out_nm = [held_out_nm[0][j], held_out_nm[1][j]];
    }
    joints
}

pub(crate) fn misfits<const N: usize>(
    data: &RegressionData<N>,
    before: &[Vec<f64>; N],
    after: &[Vec<f64>; N],
    held_out_before: &BlockSquares<N>,
    held_out_after: &BlockSquares<N>,
) -> Vec<JointMisfit> {
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len().max(1) as f64;
    let variance = |x: &[f64]| rms(x).powi(2) - mean(x).powi(2);
    let samples = data.time_s.len().max(1) as f64;
    let block_rms =
        |squares: &BlockSquares<N>, j: usize| (squares.iter().map(|block| block[j]).sum::<f64>() / samples).sqrt();
    (0..N)
        .map(|j| JointMisfit {
            rms_nm: rms(&before[j]),
            bias_nm: mean(&before[j]),
            // A torque that hardly varies leaves no variance to explain.
            unexplained: variance(&before[j])
                / variance(&data.measured_nm[j]).max(data.noise_floor_nm[j].powi(2)).max(1e-12),
            noise_floor_nm: data.noise_floor_nm[j],
            goes_with: plots::goes_with(data, &before[j], j),
            rms_after_nm: rms(&after[j]),
            held_out_nm: [block_rms(held_out_before, j), block_rms(held_out_after, j)],
        })
        .collect()
}

/// Says so where a plain fit predicts better than the extended model.
pub(crate) fn note_on_baseline(unseen: &Unseen) -> Option<String> {
    let ((name, _), ratio) = (unseen.better_baseline(), unseen.ratio());
    let preferable = unseen.baseline_is_preferable();
    let advice = if preferable { "prefer it, or record more motion" } else { "about as good" };
    unseen
        .baseline_is_better()
        .then(|| format!("{name} predicts unseen data better than the extended model, {ratio:.2} times: {advice}"))
}

pub(crate) fn notes_of<const N: usize>(data: &RegressionData<N>) -> Vec<String> {
    let mut notes = Vec::new();
    for j in 0..N {
        let joint = data.nominal.arm.joint_names.of(j);
        if !data.moves(j) {
            notes.push(format!("{joint} hardly moves: nothing but an offset can be said about its friction"));
            continue;
        }
        if data.moves_one_way(j) {
            notes.push(format!("{joint} moves in one direction only: Coulomb friction and offset cannot be separated"));
        }
    }
    if data.skipped_bursts > 0 {
        let (bursts, were) = if data.skipped_bursts == 1 { ("burst", "was") } else { ("bursts", "were") };
        notes.push(format!("{} {bursts} {were} too short for the band and left out", data.skipped_bursts));
    }
    notes
}

pub(crate) fn assumptions_of<const N: usize>(search: &Search<'_, '_, N>, chance: &Chance) -> Vec<String> {
    let data = search.system.data;
    let mut assumptions: Vec<String> = data.chains.iter().map(ToString::to_string).collect();
    assumptions.dedup();
    assumptions.push(format!(
        "sign(qd) is tanh(qd/{} rad/s); coefficients are fitted on whitened residuals of all joints together",
        data.nominal.smoothing_rad_s
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
pub(crate) fn rejected<const N: usize>(search: &Search<'_, '_, N>, findings: &[Finding]) -> Vec<Rejected> {
    let data = search.system.data;
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
            let allowed = search.system.groups[group].candidate.admissible(data, shape, &gain.coefficients);
            let value = gain.explained / search.inflation - search.price(group, &gain);
            let reason = match allowed {
                false => "only with values that physics forbids",
                true if value > LEAST_EVIDENCE => "too small to matter, by chance or on unseen blocks",
                true => "does not pay for its parameters",
            };
            (Some(value), reason.to_owned())
        };
        match all.iter_mut().find(|other| (other.label, other.location) == (label, location)) {
            Some(other) if evidence > other.evidence => *other = Rejected { label, location, evidence, reason },
            Some(_) => {}
            None => all.push(Rejected { label, location, evidence, reason }),
        }
    }
    for candidate in tribo_regression::cause::candidates::<N>() {
        if let Some(reason) = candidate.unavailable(data) {
            all.push(Rejected { label: candidate.label(), location: candidate.location(), evidence: None, reason });
        }
    }
    all.sort_by(|a, b| b.evidence.unwrap_or(f64::NEG_INFINITY).total_cmp(&a.evidence.unwrap_or(f64::NEG_INFINITY)));
    all
}
