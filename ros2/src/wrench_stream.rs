//! Joint states in, wrenches out; no network, no clock.

use nalgebra::SVector;
use tribo_logs::JointState;
use tribo_robot::{SensorFrame, WrenchEstimate, WrenchEstimator};
use tribo_runtime::MeasuredWrench;

use crate::arm_joints::picked;
use crate::sloped_velocity::SlopedVelocity;
use crate::stamps::{Stamps, Step};
use crate::{ArmJoints, Counts, Unusable};

/// A wrench and the stamp of the joint state that it belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StampedWrench {
    /// Since 1970 (ns).
    pub stamp_ns: u64,
    /// The wrench, its covariance in the order moment, force.
    pub estimate: WrenchEstimate,
}

/// What became of a message that moved the estimator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Taken<const N: usize> {
    /// Where the arm's joints were in the message, base to tool.
    pub entries: [usize; N],
    /// The wrench; none while the estimator settles, half a second after each beginning, nor where it has a fault.
    pub wrench: Option<StampedWrench>,
}

/// An estimator fed by messages.
///
/// ```text
/// message -> joints by name -> q, qd, tau, t = stamp -> MeasuredWrench -> wrench
/// begins anew at the first message, after a gap of more than 20 periods, and where the stamps jump back by more than a second
/// ```
///
/// An estimator that takes the place of another ([`Self::replace`]) runs beside it until it has settled, so that wrenches go on.
#[derive(Clone, Debug)]
pub struct WrenchStream<const N: usize, E> {
    measured: MeasuredWrench<N, E>,
    /// Takes the place of the other when it has settled.
    next: Option<Next<N, E>>,
    joints: ArmJoints<N>,
    stamps: Stamps,
    velocity: SlopedVelocity<N>,
    counts: Counts,
    fault: Option<tribo_robot::EstimateFault>,
}

#[derive(Clone, Debug)]
struct Next<const N: usize, E> {
    measured: MeasuredWrench<N, E>,
    has_begun: bool,
}

impl<const N: usize, E: WrenchEstimator<N>> WrenchStream<N, E> {
    /// A stream that has seen nothing.
    pub fn new(measured: MeasuredWrench<N, E>, joints: ArmJoints<N>) -> Self {
        let (stamps, velocity) = (Stamps::default(), SlopedVelocity::default());
        Self { measured, next: None, joints, stamps, velocity, counts: Counts::default(), fault: None }
    }

    /// Another estimator, as soon as it has settled.
    pub fn replace(&mut self, measured: MeasuredWrench<N, E>) {
        self.next = Some(Next { measured, has_begun: false });
    }

    /// What came so far.
    pub fn counts(&self) -> &Counts {
        &self.counts
    }

    /// What came so far, for whoever publishes.
    pub(crate) fn counts_mut(&mut self) -> &mut Counts {
        &mut self.counts
    }

    /// The joints, whose names are known after the first message.
    pub fn joints(&self) -> &ArmJoints<N> {
        &self.joints
    }

    /// Period of the topic (s) by its stamps, once it is known.
    pub fn period_s(&self) -> Option<f64> {
        self.stamps.period_s()
    }

    /// What the estimator had against the last sample.
    pub fn fault(&self) -> Option<tribo_robot::EstimateFault> {
        self.fault
    }

    /// Takes a message. `told_nm` is the torque that the controller added for friction, where it tells.
    ///
    /// # Errors
    /// A message that cannot be used; nothing has moved.
    pub fn take(&mut self, message: &JointState, told_nm: Option<&SVector<f64, N>>) -> Result<Taken<N>, Unusable> {
        self.counts.received += 1;
        let sample = self.sample(message).inspect_err(|unusable| match unusable {
            Unusable::NoArm { .. } => self.counts.incomplete += 1,
            Unusable::NotLater => self.counts.not_later += 1,
            _ => self.counts.unusable += 1,
        });
        let Sample { entries, step, mut frame, has_velocity } = sample?;
        self.counts.used += 1;
        self.stamps.take(message.stamp_ns, step);
        frame.time_s = self.stamps.time_s(message.stamp_ns);
        let begins = match step {
            Step::Next { lost } => {
                self.counts.lost += lost;
                false
            }
            Step::Gap => {
                self.counts.gaps += 1;
                true
            }
            Step::Restart => {
                self.counts.restarts += 1;
                true
            }
            Step::First | Step::NotLater => true,
        };
        if begins {
            self.velocity = SlopedVelocity::default();
        }
        if !has_velocity {
            frame.qd = self.velocity.push(frame.time_s, &frame.q);
        }
        let estimate = self.estimate(&frame, begins, told_nm);
        let wrench = estimate.map(|estimate| StampedWrench { stamp_ns: message.stamp_ns, estimate });
        Ok(Taken { entries, wrench })
    }

    fn sample(&mut self, message: &JointState) -> Result<Sample<N>, Unusable> {
        let entries = self.joints.entries(message)?;
        if message.effort.is_empty() {
            return Err(Unusable::NoEffort);
        }
        if message.stamp_ns == 0 {
            return Err(Unusable::NoStamp);
        }
        let step = self.stamps.look(message.stamp_ns);
        if step == Step::NotLater {
            return Err(Unusable::NotLater);
        }
        let q = picked(message, "position", &message.position, &entries)?;
        let tau = picked(message, "effort", &message.effort, &entries)?;
        let has_velocity = !message.velocity.is_empty();
        let qd =
            if has_velocity { picked(message, "velocity", &message.velocity, &entries)? } else { SVector::zeros() };
        let frame = SensorFrame { time_s: 0.0, q, qd, tau, theta: None };
        Ok(Sample { entries, step, frame, has_velocity })
    }

    /// The wrench where it may be looked at.
    fn estimate(
        &mut self,
        frame: &SensorFrame<N>,
        begins: bool,
        told_nm: Option<&SVector<f64, N>>,
    ) -> Option<WrenchEstimate> {
        let mut estimate = moved(&mut self.measured, frame, begins, told_nm);
        if let Some(mut next) = self.next.take() {
            let newer = moved(&mut next.measured, frame, begins || !next.has_begun, told_nm);
            next.has_begun = true;
            // Where the old one has nothing to say either, there is nothing to wait for.
            if next.measured.has_settled() || !self.measured.has_settled() {
                (self.measured, estimate) = (next.measured, newer);
            } else {
                self.next = Some(next);
            }
        }
        self.fault = estimate.and_then(|estimate| estimate.fault);
        self.counts.faults += u64::from(self.fault.is_some());
        estimate.filter(|estimate| estimate.fault.is_none() && self.measured.has_settled())
    }
}

/// Begins with a sample, or takes it.
fn moved<const N: usize, E: WrenchEstimator<N>>(
    measured: &mut MeasuredWrench<N, E>,
    frame: &SensorFrame<N>,
    begins: bool,
    told_nm: Option<&SVector<f64, N>>,
) -> Option<WrenchEstimate> {
    if begins {
        measured.begin(frame);
        return None;
    }
    Some(measured.step(frame, told_nm))
}

struct Sample<const N: usize> {
    entries: [usize; N],
    step: Step,
    frame: SensorFrame<N>,
    has_velocity: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use tribo_ekf::{WrenchEkf, WrenchEkfSettings};
    use tribo_friction::law::CoulombViscous;
    use tribo_friction::{Compensator, FrictionModel, VelocitySource};
    use tribo_robot::{presets, rnea};

    /// Frictionless, or an arm whose friction is believed to be so many Nm.
    fn measured(coulomb_nm: f64) -> MeasuredWrench<7, WrenchEkf> {
        let law = CoulombViscous { coulomb_nm, viscous_nm_s_per_rad: 0.0 };
        let compensator = Compensator::new(FrictionModel::uniform(law.into()), VelocitySource::Measured);
        MeasuredWrench::new(presets::panda(), compensator, WrenchEkf::new(WrenchEkfSettings::default()))
    }

    fn stream() -> WrenchStream<7, WrenchEkf> {
        WrenchStream::new(measured(0.0), ArmJoints::new(None))
    }

    /// A slow wave of all joints, torques of the rigid arm, at k ms.
    fn message(k: u64) -> JointState {
        let (arm, ready, t) = (presets::panda(), presets::panda_ready_pose(), k as f64 * 1e-3);
        let q = ready.map(|q| q + 0.1 * (2.0 * t).sin());
        let qd = ready.map(|_| 0.2 * (2.0 * t).cos());
        let qdd = ready.map(|_| -0.4 * (2.0 * t).sin());
        let list = |values: &SVector<f64, 7>| values.as_slice().to_vec();
        JointState {
            stamp_ns: 1_700_000_000_000_000_000 + k * 1_000_000,
            names: (1..=7).map(|j| format!("panda_joint{j}")).collect(),
            position: list(&q),
            velocity: list(&qd),
            effort: list(&rnea(&arm, &q, &qd, &qdd)),
        }
    }

    /// Seconds since another first stamp round differently (N, Nm).
    const ROUNDING: f64 = 1e-7;

    /// The largest difference of two wrenches (N, Nm).
    fn apart(one: &StampedWrench, other: &StampedWrench) -> f64 {
        (one.estimate.wrench_base.to_vector() - other.estimate.wrench_base.to_vector()).amax()
    }

    /// The wrenches of messages.
    fn wrenches(stream: &mut WrenchStream<7, WrenchEkf>, messages: &[JointState]) -> Vec<StampedWrench> {
        messages.iter().filter_map(|message| stream.take(message, None).ok()?.wrench).collect()
    }

    fn run(range: std::ops::Range<u64>) -> Vec<JointState> {
        range.map(message).collect()
    }

    /// A rigid arm in free motion has no wrench, and the first half second says nothing.
    #[test]
    fn an_arm_that_nobody_touches_has_no_wrench() {
        let (mut stream, messages) = (stream(), run(0..1500));
        let wrenches = wrenches(&mut stream, &messages);
        assert_eq!((wrenches.len(), wrenches[0].stamp_ns), (1000, messages[500].stamp_ns));
        let last = wrenches.last().unwrap().estimate.wrench_base.to_vector();
        assert!(last.amax() < 0.05, "{last}");
        let counts = *stream.counts();
        assert_eq!(counts, Counts { received: 1500, used: 1500, ..Counts::default() });
    }

    /// What a driver lists beside the arm, and in which order, changes no bit.
    #[test]
    fn the_order_of_joints_changes_no_bit() {
        let mixed = |state: &JointState| {
            let mixed = |values: &[f64]| std::iter::once(9.0).chain(values.iter().rev().copied()).collect::<Vec<f64>>();
            let names = std::iter::once("panda_finger_joint1".to_owned()).chain(state.names.iter().rev().cloned());
            JointState {
                stamp_ns: state.stamp_ns,
                names: names.collect(),
                position: mixed(&state.position),
                velocity: mixed(&state.velocity),
                effort: mixed(&state.effort),
            }
        };
        let messages = run(0..800);
        let shuffled: Vec<JointState> = messages.iter().map(mixed).collect();
        assert_eq!(wrenches(&mut stream(), &messages), wrenches(&mut stream(), &shuffled));
    }

    /// Messages that cannot be used leave the estimator as it was, and each is counted as what it is.
    #[test]
    fn what_cannot_be_used_moves_nothing() {
        let clean = run(0..800);
        let mut with_trouble = clean.clone();
        let other = JointState { names: vec!["gripper".into()], position: vec![0.1], ..message(601) };
        with_trouble.insert(601, other);
        with_trouble.insert(603, JointState { effort: vec![f64::NAN; 7], ..message(602) });
        with_trouble.insert(605, JointState { effort: Vec::new(), ..message(603) });
        with_trouble.insert(607, JointState { velocity: vec![0.0; 3], ..message(604) });
        with_trouble.insert(609, message(550));
        with_trouble.insert(611, JointState { stamp_ns: 0, ..message(606) });
        let mut troubled = stream();
        assert_eq!(wrenches(&mut stream(), &clean), wrenches(&mut troubled, &with_trouble));
        let counts = *troubled.counts();
        assert_eq!((counts.used, counts.incomplete, counts.unusable, counts.not_later), (800, 1, 4, 1));
    }

    /// Some messages that are lost are bridged and counted; after a gap, and where the clock is set back, the estimator settles anew.
    #[test]
    fn gaps_begin_anew_and_losses_are_bridged() {
        let mut lossy = run(0..600);
        lossy.extend(run(605..700));
        let mut stream = stream();
        assert_eq!(wrenches(&mut stream, &lossy).len(), 195);
        assert_eq!((stream.counts().lost, stream.counts().gaps), (5, 0));
        let after = run(720..1230);
        let again = wrenches(&mut stream, &after);
        assert_eq!((stream.counts().gaps, again[0].stamp_ns), (1, message(1220).stamp_ns));
        let fresh = wrenches(&mut self::stream(), &after);
        assert_eq!(again.len(), fresh.len());
        assert!(apart(again.last().unwrap(), fresh.last().unwrap()) < ROUNDING);
        let back: Vec<JointState> =
            (0..510).map(|k| JointState { stamp_ns: 5_000_000_000 + k * 1_000_000, ..message(k) }).collect();
        assert_eq!(wrenches(&mut stream, &back).len(), 10);
        assert_eq!(stream.counts().restarts, 1);
    }

    /// Another estimator takes over when it has settled: no wrench is missing, and in the end it is as if it had been there alone.
    #[test]
    fn another_estimator_takes_over_without_a_gap() {
        let (mut swapped, messages) = (stream(), run(0..2500));
        let mut found = wrenches(&mut swapped, &messages[..1000]);
        swapped.replace(measured(0.5));
        found.extend(wrenches(&mut swapped, &messages[1000..]));
        assert_eq!(found.len(), 2000);
        let alone = wrenches(&mut WrenchStream::new(measured(0.5), ArmJoints::new(None)), &messages[1000..]);
        let kept = wrenches(&mut stream(), &messages);
        // The new one begins with message 1000 and speaks from 1500 on.
        assert_eq!(found[..1000], kept[..1000]);
        assert_eq!(found.len() - 1000, alone.len());
        for (found, alone) in found[1000..].iter().zip(&alone) {
            assert!(found.stamp_ns == alone.stamp_ns && apart(found, alone) < ROUNDING);
        }
        assert!(found[1999].estimate.wrench_base != kept[1999].estimate.wrench_base);
    }

    /// Without velocities the slope of the positions stands for them: a little late, so a little wrong.
    #[test]
    fn velocities_come_from_positions_where_there_are_none() {
        let bare: Vec<JointState> =
            run(0..1500).into_iter().map(|state| JointState { velocity: Vec::new(), ..state }).collect();
        let found = wrenches(&mut stream(), &bare);
        let exact = wrenches(&mut stream(), &run(0..1500));
        let apart = apart(found.last().unwrap(), exact.last().unwrap());
        assert!(apart > 1e-6 && apart < 1.0, "{apart}");
    }

    /// A torque that the controller tells takes the place of the law believed.
    #[test]
    fn a_told_compensation_replaces_the_law() {
        let told = SVector::<f64, 7>::repeat(0.5);
        let mut believed = WrenchStream::new(measured(0.0), ArmJoints::new(None));
        let with: Vec<JointState> = run(0..800)
            .into_iter()
            .map(|state| JointState { effort: state.effort.iter().map(|tau| tau + 0.5).collect(), ..state })
            .collect();
        let found: Vec<StampedWrench> =
            with.iter().filter_map(|message| believed.take(message, Some(&told)).unwrap().wrench).collect();
        let plain = wrenches(&mut stream(), &run(0..800));
        assert!(apart(&found[299], &plain[299]) < 1e-6);
    }
}
