//! How long the loop takes on this computer.

use std::time::{Duration, Instant};

use nalgebra::SVector;
use tribo_campaign::ValidTune;
use tribo_robot::{Plant, PlantLost, SensorFrame};
use tribo_sim::BoxFrictionPlant;
use tribo_trial::{AnyEstimator, EstimatorError};

/// Times of the ticks of one trial on this computer, ascending (µs). Readings of a clock: they differ from run to run and
/// are part of no log.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoopTimes {
    /// One time per tick.
    pub tick_us: Vec<f64>,
    /// Control period (µs).
    pub period_us: f64,
}

impl LoopTimes {
    /// The quantile `p` in 0 to 1 (µs); none without ticks.
    pub fn quantile(&self, p: f64) -> Option<f64> {
        quantile(&self.tick_us, p)
    }
}

/// The quantile `p` in 0 to 1 of ascending times; none of none.
pub fn quantile(ascending: &[f64], p: f64) -> Option<f64> {
    let last = ascending.len().checked_sub(1)?;
    ascending.get((p.clamp(0.0, 1.0) * last as f64).round() as usize).copied()
}

/// A plant that takes the time it spends itself, so that it can be left out.
struct TimedPlant<const N: usize> {
    inner: BoxFrictionPlant<N>,
    spent: Duration,
}

impl<const N: usize> Plant<N> for TimedPlant<N> {
    fn sense(&mut self) -> Result<SensorFrame<N>, PlantLost> {
        let started = Instant::now();
        let frame = self.inner.sense();
        self.spent += started.elapsed();
        frame
    }

    fn actuate(&mut self, tau_nm: &SVector<f64, N>) {
        let started = Instant::now();
        self.inner.actuate(tau_nm);
        self.spent += started.elapsed();
    }
}

/// Runs the loop of a trial with a clock around every tick: estimator, controller and limits, the simulated arm left out.
///
/// # Errors
/// Parameters that the estimator cannot work with.
pub fn loop_times<const N: usize>(tune: &ValidTune<N>, theta: &[f64]) -> Result<LoopTimes, EstimatorError> {
    let trial = &tune.trial;
    let friction = tune.space.friction(theta);
    let estimator = AnyEstimator::for_tuning(tune.config.residual, tune.config.ekf, trial, &friction)?;
    let mut plant = TimedPlant { inner: trial.plant(tune.config.seed), spent: Duration::ZERO };
    let mut control = trial.control_loop(&friction, estimator);
    let ticks = (trial.reference.total_s() / trial.dt_s).round() as usize;
    let mut tick_us = Vec::with_capacity(ticks);
    for _ in 0..ticks {
        plant.spent = Duration::ZERO;
        let started = Instant::now();
        let record = control.tick(&mut plant);
        tick_us.push((started.elapsed().saturating_sub(plant.spent)).as_secs_f64() * 1e6);
        if record.fault.is_some() {
            break;
        }
    }
    tick_us.sort_by(f64::total_cmp);
    Ok(LoopTimes { tick_us, period_us: trial.dt_s * 1e6 })
}
