//! The experiment that would separate rival causes.
//!
//! ```text
//! best = argmax over motions of  RSS(rival) − RSS(truth)   in units of the noise,   truth = nominal model + finding
//! ```
//!
//! A small library of motions ([`motion`]) is played to a simulated arm that has the finding, and the rival is fitted to
//! what it leaves ([`expectation`]). Leaves out: collisions. The motions keep joint and speed limits and nothing else.

mod expectation;
mod instruction;
mod motion;
mod pair;
mod room;
mod simulated;
#[cfg(test)]
mod tests;

use rayon::prelude::*;
use tribo_regression::{CauseLabel, Location, RegressionData};
use tribo_sim::Effect;
use tribo_sim::excitation::ViaPoints;

use self::expectation::{Run, SensorNoise, expected_evidence};
use self::motion::Motion;
use self::pair::Pair;
use self::simulated::Arrangement;
use crate::diagnosis::{Finding, JointMisfit};

/// A safe motion of the library.
#[derive(Clone, Debug, PartialEq)]
pub struct NextExperiment {
    /// Name of the motion: `multi_speed_strokes`; `no_motion` where physics or the library has none.
    pub motion: &'static str,
    /// What to do, in one sentence.
    pub instruction: String,
    /// The rivals it separates.
    pub separates: [(CauseLabel, Location); 2],
    /// Expected evidence between the two after that motion (difference of twice the log likelihood).
    pub expected_evidence: f64,
    /// The same on a repetition of the log at hand.
    pub evidence_of_this_log: f64,
    /// Via points of the motion: time (s), then the joint angles (rad). The arm moves by minimum jerk and rests at each.
    /// Empty where nothing new is to be moved.
    pub via_points: Vec<(f64, Vec<f64>)>,
}

/// Evidence below which repeating the motion is no answer either.
const LEAST_EXPECTED: f64 = 1.0;

/// The experiment for the closest pair of rivals, or `None` where every finding has one name.
pub(crate) fn next_experiment<const N: usize>(
    data: &RegressionData<N>,
    findings: &[Finding],
    joints: &[JointMisfit],
) -> Option<NextExperiment> {
    let pair = Pair::closest(data, findings)?;
    if pair.same_torque(data) {
        return Some(without_motion(&pair, 0.0));
    }
    let others: Vec<&Effect> = findings
        .iter()
        .filter_map(|finding| finding.effect.as_ref())
        .filter(|effect| **effect != pair.effect)
        .collect();
    let noise = SensorNoise::of(data, joints)?;
    let here = Run::of_torque(data, &pair.effect)?;
    let evidence_of_this_log = expected_evidence(std::slice::from_ref(&here), &pair, &others, &noise).unwrap_or(0.0);

    if let Effect::ExternalContact { .. } = pair.effect {
        // A push is over: only what stays comes back.
        let untouched = here.untouched();
        let expected = expected_evidence(&[here, untouched], &pair, &others, &noise).unwrap_or(0.0);
        return Some(NextExperiment {
            motion: "repeat_untouched",
            instruction: instruction::untouched(&pair),
            separates: [pair.found, pair.rival],
            expected_evidence: expected,
            evidence_of_this_log,
            via_points: Vec::new(),
        });
    }
    drop(here);

    let arrangement = Arrangement { data, pair: &pair, others: &others };
    let mut tried: Vec<(Motion, ViaPoints<N>, f64)> = Motion::ALL
        .into_par_iter()
        .filter(|motion| motion.suits(&pair))
        .filter_map(|motion| {
            let points = motion.draw(&room::of(data, &pair, motion));
            let simulated = arrangement.played(motion, &points)?;
            let runs: Vec<Run<'_, N>> = simulated.iter().map(Run::of_residual).collect();
            let expected = expected_evidence(&runs, &pair, &others, &noise)?;
            Some((motion, points, expected))
        })
        .collect();
    // The least effort first among equals: the library is in that order.
    tried.sort_by(|a, b| (b.2 / b.0.effort()).total_cmp(&(a.2 / a.0.effort())));
    let best = tried.into_iter().next().filter(|(_, _, expected)| *expected >= LEAST_EXPECTED);
    let Some((motion, points, expected)) = best else {
        return Some(without_motion(&pair, evidence_of_this_log));
    };
    Some(NextExperiment {
        motion: motion.name(),
        instruction: instruction::of(motion, &pair, &points, expected, &data.nominal.arm.joint_names),
        separates: [pair.found, pair.rival],
        expected_evidence: expected,
        evidence_of_this_log,
        via_points: points.time_s.iter().zip(&points.q_rad).map(|(t, q)| (*t, q.as_slice().to_vec())).collect(),
    })
}

/// Says so where no motion helps.
fn without_motion(pair: &Pair, evidence_of_this_log: f64) -> NextExperiment {
    NextExperiment {
        motion: "no_motion",
        instruction: instruction::without_motion(pair),
        separates: [pair.found, pair.rival],
        expected_evidence: 0.0,
        evidence_of_this_log,
        via_points: Vec::new(),
    }
}
