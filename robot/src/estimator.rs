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

/// Estimated tool wrench with its confidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WrenchEstimate {
    /// Wrench exerted by the robot on the environment, at the flange, base axes.
    pub wrench_base: Wrench,
    /// Covariance of the wrench `[moment; force]` [Nm², Nm·N, N²].
    pub covariance: Matrix6<f64>,
    /// Normalised innovation squared of this tick, if the estimator has an innovation (6 degrees of freedom).
    pub nis: Option<f64>,
}

/// An estimator of the tool wrench that runs inside the tick: no heap, no lock, no clock, no panic.
pub trait WrenchEstimator<const N: usize> {
    /// Forgets everything but the settings and starts at this sample.
    fn reset(&mut self, frame: &SensorFrame<N>, terms: &ControlTerms<N>);

    /// Takes one sample and returns the new estimate. Input that is not finite leaves the state as it was.
    fn step(&mut self, input: &EstimatorInput<'_, N>) -> WrenchEstimate;

    /// Delay (s) of the estimate behind the true wrench at low frequency.
    fn delay_s(&self) -> f64;
}
