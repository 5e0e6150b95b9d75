//! Delays that are none: what comes of when in a period of the control loop the rows of a log are stamped, and of joints that stick.

use tribo_regression::{CauseLabel, Location, MotionSample, RegressionData};
use tribo_robot::gravity_torque;
use tribo_sim::TorqueSide;

use crate::diagnosis::Finding;

/// Period of the control loop of an arm (s), in which a torque is held and measured.
const CONTROL_PERIOD_S: f64 = 1e-3;

/// Periods that the far end of the interval of a delay that is surely shorter than one may reach: a delay of one is seen at 0.99.
const SHORTER_PERIODS: f64 = 0.95;
/// Least share of the residual on unseen data that a delay of about a period explains (one): a log of a controller that writes the torque of the
/// period before beside the state of this one has such a delay, which is small beside what a model lacks.
const LEAST_GAIN_OF_A_PERIOD: f64 = 0.1;
/// Periods that the near end of the interval of a delay of about a period may reach.
const SURELY_PERIODS: f64 = 1.25;
/// Periods that its far end may reach.
const POSSIBLY_PERIODS: f64 = 1.5;

/// Takes from the findings what comes of when in a period a log's rows are stamped, and says so; the extended model has it.
pub(crate) fn take_stamps<const N: usize>(data: &RegressionData<N>, findings: &mut Vec<Finding>) -> Vec<String> {
    let mut notes: Vec<String> = lateness_of_stamps(findings).into_iter().collect();
    if data.nominal.sticks {
        notes.extend(earliness_of_sticking(findings));
    }
    if data.nominal.torque_side == TorqueSide::Link {
        let stiffness = gravity_stiffness(data);
        let names = &data.nominal.arm.joint_names;
        let late = |finding: &Finding| {
            let Location::Joint(j) = finding.location else { return None };
            let viscous = finding.parameters.first().filter(|_| finding.label == CauseLabel::Viscous)?;
            let value = viscous.value.first().copied()?;
            (value.abs() < CONTROL_PERIOD_S * stiffness[j]).then(|| {
                format!(
                    "{}: the gravity torque is stamped {:.2} ms apart from the motion, a period of the control loop or less, which looks like viscous friction of {value:.3} \
                     Nm s/rad behind the gears: the extended model has it, and it is no finding",
                    names.of(j),
                    1e3 * value.abs() / stiffness[j]
                )
            })
        };
        notes.extend(findings.iter().filter_map(late));
        findings.retain(|finding| late(finding).is_none());
    }
    notes
}

/// Postures at which the gravity torque is asked how it changes.
const POSTURES: usize = 64;
/// Step of that (rad).
const STEP_RAD: f64 = 1e-4;

/// Most that the gravity torque of each joint changes with its own angle along the motion [Nm/rad]: what is late by d looks like viscous friction
/// of d times that.
fn gravity_stiffness<const N: usize>(data: &RegressionData<N>) -> [f64; N] {
    let every = (data.motion.len() / POSTURES).max(1);
    let arm = &data.nominal.arm;
    std::array::from_fn(|j| {
        let slope = |at: &MotionSample<N>| {
            let torque_nm = |step: f64| {
                let mut q = at.q;
                q[j] += step;
                gravity_torque(arm, &q)[j]
            };
            ((torque_nm(STEP_RAD) - torque_nm(-STEP_RAD)) / (2.0 * STEP_RAD)).abs()
        };
        data.motion.iter().step_by(every).map(slope).fold(0.0, f64::max)
    })
}

/// Takes a delay of a period of the control loop from the findings, and says so: one that is surely shorter, or that gains little where it was
/// not fitted and is hardly longer. Such a lateness is a matter of when in a period a log's rows are stamped, and the extended model has it.
fn lateness_of_stamps(findings: &mut Vec<Finding>) -> Option<String> {
    let delay_s = |finding: &Finding| {
        let delay = finding.parameters.first().filter(|_| finding.label == CauseLabel::TimeDelay)?;
        let ends = || delay.ci95.iter().flatten().map(|end| end.abs());
        let (least_s, most_s) = (ends().fold(f64::INFINITY, f64::min), ends().fold(0.0, f64::max));
        let hardly_longer = least_s < SURELY_PERIODS * CONTROL_PERIOD_S && most_s < POSSIBLY_PERIODS * CONTROL_PERIOD_S;
        let gains_little = finding.held_out_gain < LEAST_GAIN_OF_A_PERIOD && hardly_longer;
        delay.value.first().copied().filter(|_| most_s < SHORTER_PERIODS * CONTROL_PERIOD_S || gains_little)
    };
    let (place, delay_s) = findings.iter().enumerate().find_map(|(place, finding)| Some((place, delay_s(finding)?)))?;
    findings.remove(place);
    let (delay_ms, how) = (1e3 * delay_s, if delay_s < 0.0 { "early" } else { "late" });
    Some(format!(
        "torques are stamped {:.2} ms {how}, a period of the control loop or less: the extended model has it, and it is no finding",
        delay_ms.abs()
    ))
}

/// Takes torques that come early from the findings of joints that stick, and says so: friction jumps where a joint stops, before it turns
/// round, and the straight line over a stop does not have that jump. The extended model has the delay.
fn earliness_of_sticking(findings: &mut Vec<Finding>) -> Option<String> {
    let delay_s = |finding: &Finding| {
        let delay = finding.parameters.first().filter(|_| finding.label == CauseLabel::TimeDelay)?;
        delay.value.first().copied().filter(|delay_s| *delay_s < 0.0)
    };
    let (place, delay_s) = findings.iter().enumerate().find_map(|(place, finding)| Some((place, delay_s(finding)?)))?;
    findings.remove(place);
    Some(format!(
        "torques are {:.1} ms ahead of a motion whose joints stick, as friction is that jumps where a joint stops: the extended model has it as a \
         time_delay, and it is no finding",
        -1e3 * delay_s
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Parameter;

    fn found(label: CauseLabel, ms: [f64; 3], held_out_gain: f64) -> Finding {
        let [low, value, high] = ms.map(|ms| 1e-3 * ms);
        let name = if label == CauseLabel::TimeDelay { "delay_s" } else { "delta_coulomb_nm" };
        Finding {
            label,
            location: Location::Arm,
            joints: Vec::new(),
            links: Vec::new(),
            effect: None,
            parameters: vec![Parameter { name, value: vec![value], ci95: vec![[low, high]] }],
            signature: None,
            p_value: 0.0,
            held_out_gain,
            held_out_gain_ci95: [held_out_gain; 2],
            explained_rms_nm: 0.1,
            evidence: 100.0,
            alternatives: Vec::new(),
            plots: Vec::new(),
        }
    }

    #[test]
    fn a_delay_of_a_control_period_is_a_matter_of_stamps() {
        let kept = |label, ms, gain| {
            let mut findings = vec![found(CauseLabel::Payload, [0.1, 0.2, 0.3], 0.5), found(label, ms, gain)];
            let said = lateness_of_stamps(&mut findings);
            assert_eq!(said.is_some(), findings.len() == 1, "{said:?}");
            assert_eq!(findings[0].label, CauseLabel::Payload);
            findings.len() == 2
        };
        let delay = CauseLabel::TimeDelay;
        assert!(!kept(delay, [0.7, 0.8, 0.9], 0.3), "surely shorter");
        assert!(!kept(delay, [-0.9, -0.8, -0.7], 0.3), "surely shorter, and early");
        assert!(!kept(delay, [0.97, 1.0, 1.03], 0.001), "gains nothing");
        assert!(!kept(delay, [0.94, 0.97, 0.99], 0.034), "gains little beside a payload");
        assert!(kept(delay, [0.97, 1.0, 1.03], 0.11), "gains something");
        assert!(kept(delay, [0.985, 0.99, 0.995], 0.5), "a period, and gains much");
        assert!(kept(delay, [2.8, 3.0, 3.2], 0.001), "three periods");
        assert!(kept(CauseLabel::Coulomb, [0.1, 0.2, 0.3], 0.001), "no delay");
    }
}
