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
