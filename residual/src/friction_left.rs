//! Friction alone, as a wrench: what the motors say less what the gears say.

use tribo_robot::{ControlTerms, EstimateFault, EstimatorInput, SensorFrame, Wrench, WrenchEstimate, WrenchEstimator};

use crate::{DoubleEncoderEstimator, MomentumEstimator};

/// The friction that is not compensated, as the wrench that it pretends to be:
///
/// ```text
/// ĥ_motors = h + W (tau_f − tau_f_hat),   ĥ_gears = h,   ĥ = ĥ_motors − ĥ_gears = W (tau_f − tau_f_hat)
/// ```
///
/// A second encoder measures the torque behind the gears, which friction does not touch, so the difference to what the
/// motor torque says is friction even while somebody pushes: a compensator can be judged in contact. The covariance is the
/// sum of both. The two must have the same gain; without motor positions it is [`EstimateFault::MotorPositionMissing`].
#[derive(Clone, Debug)]
pub struct FrictionLeft<const N: usize> {
    motors: MomentumEstimator<N>,
    gears: DoubleEncoderEstimator<N>,
    estimate: WrenchEstimate,
}

impl<const N: usize> FrictionLeft<N> {
    /// From the two estimators.
    pub fn new(motors: MomentumEstimator<N>, gears: DoubleEncoderEstimator<N>) -> Self {
        Self { motors, gears, estimate: WrenchEstimate::none_yet() }
    }

    /// The estimator on the motor torque.
    pub fn motors(&self) -> &MomentumEstimator<N> {
        &self.motors
    }
}

impl<const N: usize> WrenchEstimator<N> for FrictionLeft<N> {
    fn reset(&mut self, frame: &SensorFrame<N>, terms: &ControlTerms<N>) {
        self.motors.reset(frame, terms);
        self.gears.reset(frame, terms);
        self.estimate = WrenchEstimate::none_yet();
    }

    #[inline]
    fn step(&mut self, input: &EstimatorInput<'_, N>) -> WrenchEstimate {
        if input.frame.theta.is_none() {
            return self.estimate.held(EstimateFault::MotorPositionMissing);
        }
        let (motors, gears) = (self.motors.step(input), self.gears.step(input));
        if let Some(fault) = motors.fault.or(gears.fault) {
            return self.estimate.held(fault);
        }
        self.estimate = WrenchEstimate {
            wrench_base: Wrench::from_vector(&(motors.wrench_base.to_vector() - gears.wrench_base.to_vector())),
            covariance: motors.covariance + gears.covariance,
            ..WrenchEstimate::none_yet()
        };
        self.estimate
    }

    fn delay_s(&self) -> f64 {
        self.motors.delay_s()
    }
}
