//! External torque and wrench, as the control unit tells them.

use nalgebra::{SVector, Vector3, Vector6};
use tribo_friction::{FrictionBand, FrictionModel};
use tribo_residual::{MomentumEstimator, MomentumSettings};
use tribo_robot::{ControlTerms, EstimatorInput, Pose, SensorFrame, Wrench, WrenchEstimator};

/// Noise of velocity (rad/s) and torque (Nm) that the observer counts on.
const VELOCITY_SD_RAD_S: f64 = 3e-3;
const TORQUE_SD_NM: f64 = 0.05;

/// Momentum observer of the link side that knows no friction: what it leaves in `tau_ext_hat_filtered` and
/// `O_F_ext_hat_K` of a free arm is the friction between the motors and the torque sensors' model, as on the real unit.
///
/// Sign: by the robot on the environment. A real unit tells the same: pulled downwards, it reports an upward force
/// (libfranka issue 26).
#[derive(Clone, Copy, Debug)]
pub(super) struct ExternalTorque {
    estimator: MomentumEstimator<7>,
    wrench: Wrench,
}

impl ExternalTorque {
    /// An observer that starts at this sample of the link side.
    pub(super) fn at(frame: &SensorFrame<7>, terms: &ControlTerms<7>) -> Self {
        let band = FrictionBand::of_model(&FrictionModel::none(), VELOCITY_SD_RAD_S, TORQUE_SD_NM, 0.0);
        let mut estimator = MomentumEstimator::new(MomentumSettings::new(band));
        estimator.reset(frame, terms);
        Self { estimator, wrench: Wrench::default() }
    }

    /// Takes the sample at the end of a period (s).
    pub(super) fn step(&mut self, frame: &SensorFrame<7>, terms: &ControlTerms<7>, dt_s: f64) {
        let zero = SVector::zeros();
        let estimate = self.estimator.step(&EstimatorInput {
            frame,
            terms,
            tau_motor: &frame.tau,
            tau_friction: &zero,
            acceleration_command: &Vector6::zeros(),
            dt_s,
        });
        self.wrench = estimate.wrench_base;
    }

    /// External torque (Nm).
    pub(super) fn torque_nm(&self) -> SVector<f64, 7> {
        *self.estimator.observer().residual_nm()
    }

    /// Wrench at the stiffness frame in base axes and in its own: force (N), then moment (Nm).
    pub(super) fn wrench_at(&self, flange: &Pose, stiffness: &Pose) -> [Vector6<f64>; 2] {
        let arm = flange.translation.vector - stiffness.translation.vector;
        let force = self.wrench.force_n;
        let moment = self.wrench.moment_nm + arm.cross(&force);
        let turned = |v| stiffness.rotation.inverse() * v;
        let joined = |f: Vector3<f64>, m: Vector3<f64>| Vector6::new(f.x, f.y, f.z, m.x, m.y, m.z);
        [joined(force, moment), joined(turned(force), turned(moment))]
    }
}
