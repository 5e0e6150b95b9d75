//! A Franka under torque control, as the control loop sees it.

use std::sync::atomic::{AtomicBool, Ordering};

use franka::{ActiveTorqueControl, FrankaError, RobotState, Torques};
use nalgebra::SVector;
use tribo_robot::{Arm, ControlTerms, Plant, PlantLost, SensorFrame};

/// The robot as a [`Plant`]: torques of the loop contain gravity, which the unit adds itself.
///
/// ```text
/// sent = limited(τ − g(q), 1000 Nm/s)        g of the model, at the measured q, with the bits of the control loop's
/// ```
///
/// Time counts from the first frame in the robot's own milliseconds. Where the robot ends the motion, the connection is lost or
/// somebody asks to stop, `sense` says so and [`Self::reason`] why (nothing for a wish to stop); then [`Self::finish`] lands the arm.
pub struct TorquePlant<'a> {
    stop: &'a AtomicBool,
    control: ActiveTorqueControl<'a>,
    arm: Arm<7>,
    frame: Option<SensorFrame<7>>,
    begun_ms: u64,
    last_ms: u64,
    sent: [f64; 7],
    lost_periods: u64,
    reason: Option<FrankaError>,
}

/// Rate of torques that the unit accepts (Nm per period), with a margin for the floats of version 10; the control loop keeps to it.
const STEP_NM: f64 = 0.999;

/// What the sensors of a state say, at the robot's own time.
pub fn sensor_frame(state: &RobotState) -> SensorFrame<7> {
    SensorFrame {
        time_s: state.time.as_secs_f64(),
        q: SVector::from(state.q),
        qd: SVector::from(state.dq),
        tau: SVector::from(state.tau_J),
        theta: None,
    }
}

impl<'a> TorquePlant<'a> {
    pub(super) fn new(control: ActiveTorqueControl<'a>, arm: Arm<7>, stop: &'a AtomicBool) -> Self {
        let (begun_ms, last_ms, lost_periods) = (0, 0, 0);
        Self { stop, control, arm, frame: None, begun_ms, last_ms, sent: [0.0; 7], lost_periods, reason: None }
    }

    /// Why the robot gives no more samples.
    pub fn reason(&self) -> Option<&FrankaError> {
        self.reason.as_ref()
    }

    /// Whether the robot can no longer be reached, so that it stands by its own means.
    pub fn connection_is_lost(&self) -> bool {
        matches!(self.reason, Some(FrankaError::Network(_)))
    }

    /// Periods whose state did not come: the loop was too late, or the network lost it.
    pub fn lost_periods(&self) -> u64 {
        self.lost_periods
    }

    /// Ends the motion: torques go to zero within the unit's rate, then the unit holds the arm.
    ///
    /// # Errors
    ///
    /// The robot's own reason, where it has ended the motion before.
    pub fn finish(mut self) -> Result<(), FrankaError> {
        if let Some(reason) = self.reason {
            return Err(reason);
        }
        while self.sent.iter().any(|torque| *torque != 0.0) {
            self.control.read_once()?;
            self.sent = self.sent.map(|torque| torque - torque.clamp(-STEP_NM, STEP_NM));
            self.control.write_once(&Torques::new(self.sent))?;
        }
        self.control.read_once()?;
        self.control.write_once(&franka::motion_finished(Torques::new(self.sent)))
    }
}

impl Plant<7> for TorquePlant<'_> {
    fn sense(&mut self) -> Result<SensorFrame<7>, PlantLost> {
        if self.reason.is_some() || self.stop.load(Ordering::Relaxed) {
            return Err(PlantLost);
        }
        let state = match self.control.read_once() {
            Ok((state, _)) => state,
            Err(error) => {
                self.reason = Some(error);
                return Err(PlantLost);
            }
        };
        let now_ms = state.time.as_millis();
        if self.frame.is_none() {
            (self.begun_ms, self.last_ms) = (now_ms, now_ms);
            self.sent = state.tau_J_d;
        }
        self.lost_periods += now_ms.saturating_sub(self.last_ms + 1);
        self.last_ms = now_ms;
        let frame = SensorFrame { time_s: (now_ms - self.begun_ms) as f64 * 1e-3, ..sensor_frame(&state) };
        self.frame = Some(frame);
        Ok(frame)
    }

    fn actuate(&mut self, tau_nm: &SVector<f64, 7>) {
        let Some(frame) = self.frame.filter(|_| self.reason.is_none()) else { return };
        let without_gravity = tau_nm - ControlTerms::at(&self.arm, &frame.q, &frame.qd).gravity_nm;
        self.sent = std::array::from_fn(|j| {
            let wanted = without_gravity[j];
            // The same bits unless it is too fast.
            if (wanted - self.sent[j]).abs() <= STEP_NM {
                wanted
            } else {
                self.sent[j] + (wanted - self.sent[j]).clamp(-STEP_NM, STEP_NM)
            }
        });
        if let Err(error) = self.control.write_once(&Torques::new(self.sent)) {
            self.reason = Some(error);
        }
    }
}
