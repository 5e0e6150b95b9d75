//! One face for every estimator of the tool wrench.

use nalgebra::{Matrix6, SVector, Vector6};

use crate::{ControlTerms, SensorFrame, Wrench};

/// What a wrench estimator is given at each tick.
#[derive(Clone, Copy, Debug)]
pub struct EstimatorInput<'a, const N: usize> {
    /// The sample of the joint sensors.
    pub frame: &'a SensorFrame<N>,
    /// Model terms at the measured state.
    pub terms: &'a ControlTerms<N>,
    /// Motor torque (Nm) that acted during the period which ends at this sample.
    pub tau_motor: &'a SVector<f64, N>,
    /// Friction torque (Nm) believed to act (what the compensator added).
    pub tau_friction: &'a SVector<f64, N>,
    /// Acceleration [rad/s²; m/s²] that the controller asked of the tool during that period, base axes.
    pub acceleration_command: &'a Vector6<f64>,
    /// Length of that period (s).
    pub dt_s: f64,
}

/// λ of the two-sided 95 % interval of a normal error.
pub const LAMBDA_95: f64 = 1.959_963_984_540_054;

impl<const N: usize> EstimatorInput<'_, N> {
    /// Whether a state estimate may be moved by this input: every number finite, the period positive.
    ///
    /// # Errors
    /// [`EstimateFault::InputNotFinite`] or [`EstimateFault::PeriodNotPositive`].
    #[inline]
    pub fn check(&self) -> Result<(), EstimateFault> {
        let frame = self.frame.q.iter().chain(self.frame.qd.iter());
        let frame = frame.chain(self.frame.theta.iter().flat_map(|theta| theta.iter()));
        let torques = self.tau_motor.iter().chain(self.tau_friction.iter());
        if !frame.chain(torques).chain(self.acceleration_command.iter()).all(|value| value.is_finite()) {
            return Err(EstimateFault::InputNotFinite);
        }
        if !(self.dt_s > 0.0 && self.dt_s.is_finite()) {
            return Err(EstimateFault::PeriodNotPositive);
        }
        Ok(())
    }
}

/// Why an estimate is not a fresh one. The safe action is the same for all: the estimate before it stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EstimateFault {
    /// A measurement or a torque is NaN or infinite.
    #[error("an input of the estimator is not finite")]
    InputNotFinite,
    /// The period since the last sample is zero, negative or not finite.
    #[error("the period of the estimator is not positive")]
    PeriodNotPositive,
    /// A matrix that must be positive definite is not, or the state would not stay finite.
    #[error("the estimator met a matrix that is not positive definite")]
    NotPositiveDefinite,
    /// The robot has no second encoder, or its log no `theta_i`.
    #[error("the estimator needs the motor positions (theta), which the sensor frame does not have")]
    MotorPositionMissing,
    /// An iteration reached its limit.
    #[error("the estimator did not converge")]
    NotConverged,
}

/// Limits between which each component of the wrench lies; components are bounded one at a time, not jointly.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WrenchLimits {
    /// Lower limit of each component, base axes.
    pub lower: Wrench,
    /// Upper limit of each component, base axes.
    pub upper: Wrench,
}

impl WrenchLimits {
    /// Whether each component `[moment; force]` of `wrench` lies between its limits.
    pub fn contain(&self, wrench: &Wrench) -> [bool; 6] {
        let (lower, x, upper) = (self.lower.to_vector(), wrench.to_vector(), self.upper.to_vector());
        std::array::from_fn(|i| lower[i] <= x[i] && x[i] <= upper[i])
    }
}

/// Estimated tool wrench with its confidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WrenchEstimate {
    /// Wrench exerted by the robot on the environment, at the flange, base axes.
    pub wrench_base: Wrench,
    /// Covariance of the wrench `[moment; force]` [Nm², Nm·N, N²].
    pub covariance: Matrix6<f64>,
    /// 95 % limits, where the error is not normal; elsewhere the covariance says everything.
    pub limits95: Option<WrenchLimits>,
    /// Normalised innovation squared of this tick, if the estimator has an innovation (6 degrees of freedom).
    pub nis: Option<f64>,
    /// Why the last sample was not used, if it was not: the rest is then the estimate before it.
    pub fault: Option<EstimateFault>,
}

impl WrenchEstimate {
    /// Zero with zero covariance: what stands before an estimator has seen its first period.
    pub fn none_yet() -> Self {
        Self { wrench_base: Wrench::default(), covariance: Matrix6::zeros(), limits95: None, nis: None, fault: None }
    }

    /// The same estimate, marked as standing in for one that could not be made.
    #[inline]
    pub fn held(self, fault: EstimateFault) -> Self {
        Self { fault: Some(fault), ..self }
    }

    /// 95 % interval of each component: the estimator's own limits, else `h ± 1.96 √diag(covariance)`.
    #[inline]
    pub fn interval95(&self) -> WrenchLimits {
        self.limits95.unwrap_or_else(|| {
            let half = self.covariance.diagonal().map(|variance| LAMBDA_95 * variance.max(0.0).sqrt());
            let centre = self.wrench_base.to_vector();
            WrenchLimits { lower: Wrench::from_vector(&(centre - half)), upper: Wrench::from_vector(&(centre + half)) }
        })
    }
}

/// An estimator of the tool wrench that runs inside the tick: no heap, no lock, no clock, no panic.
pub trait WrenchEstimator<const N: usize> {
    /// Forgets everything but the settings and starts at this sample: the same samples then give the same bits.
    fn reset(&mut self, frame: &SensorFrame<N>, terms: &ControlTerms<N>);

    /// Takes one sample and returns the new estimate. A sample that cannot be used is named in
    /// [`WrenchEstimate::fault`] and leaves estimate and state as they were.
    fn step(&mut self, input: &EstimatorInput<'_, N>) -> WrenchEstimate;

    /// Delay (s) of the estimate behind the true wrench at low frequency.
    fn delay_s(&self) -> f64;
}

impl<const N: usize, E: WrenchEstimator<N> + ?Sized> WrenchEstimator<N> for &mut E {
    fn reset(&mut self, frame: &SensorFrame<N>, terms: &ControlTerms<N>) {
        (**self).reset(frame, terms);
    }

    #[inline]
    fn step(&mut self, input: &EstimatorInput<'_, N>) -> WrenchEstimate {
        (**self).step(input)
    }

    fn delay_s(&self) -> f64 {
        (**self).delay_s()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector6;

    /// Closed form of the normal interval, and the estimator's own limits before it.
    #[test]
    fn interval_is_the_covariance_unless_limits_are_given() {
        let wrench_base = Wrench::from_force_moment(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        let covariance = Matrix6::from_diagonal(&Vector6::repeat(4.0));
        let estimate = WrenchEstimate { wrench_base, covariance, ..WrenchEstimate::none_yet() };
        let normal = estimate.interval95();
        assert!((normal.upper.force_n.x - (1.0 + 2.0 * LAMBDA_95)).abs() < 1e-15);
        assert!((normal.lower.moment_nm.z - (6.0 - 2.0 * LAMBDA_95)).abs() < 1e-15);
        assert_eq!(normal.contain(&wrench_base), [true; 6]);
        let outside = Wrench::from_force_moment(&[1.0, 2.0, 3.0, 4.0, 5.0, 10.0]);
        assert_eq!(normal.contain(&outside), [true, true, false, true, true, true]);
        let own = WrenchLimits { lower: wrench_base, upper: outside };
        assert_eq!(WrenchEstimate { limits95: Some(own), ..estimate }.interval95(), own);
        let held = estimate.held(EstimateFault::InputNotFinite);
        assert_eq!((held.wrench_base, held.fault), (wrench_base, Some(EstimateFault::InputNotFinite)));
    }
}
