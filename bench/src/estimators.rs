//! Time of the wrench estimators.

use std::hint::black_box;

use nalgebra::{SVector, Vector6};
use serde::Serialize;
use tribo_campaign::ValidTune;
use tribo_ekf::WrenchEkf;
use tribo_residual::{QpEstimator, QpSettings};
use tribo_robot::{ControlTerms, EstimatorInput, SensorFrame, WrenchEstimator};
use tribo_runtime::TickRecord;
use tribo_trial::{band_of_model, run_trial_observed};

use super::BenchError;
use super::stopwatch::per_call_ns;

/// Ticks of the trial that are kept: pre-roll and the first seconds of motion, joints at rest and moving.
const SAMPLES: usize = 6000;

/// Time per sample (µs) of the estimators on what the sensors of a trial said.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct EstimatorTimes {
    /// The augmented-state filter.
    pub ekf_us: f64,
    /// The friction-band programme, estimate alone.
    pub qp_us: f64,
    /// The same with its twelve limits.
    pub qp_interval_us: f64,
}

/// What an estimator is given at one tick.
struct Sample<const N: usize> {
    frame: SensorFrame<N>,
    terms: ControlTerms<N>,
    tau_motor: SVector<f64, N>,
    tau_friction: SVector<f64, N>,
    acceleration_command: Vector6<f64>,
    dt_s: f64,
}

impl<const N: usize> Sample<N> {
    fn input(&self) -> EstimatorInput<'_, N> {
        EstimatorInput {
            frame: &self.frame,
            terms: &self.terms,
            tau_motor: &self.tau_motor,
            tau_friction: &self.tau_friction,
            acceleration_command: &self.acceleration_command,
            dt_s: self.dt_s,
        }
    }
}

impl EstimatorTimes {
    /// Measures them on an uncompensated trial.
    ///
    /// # Errors
    /// None with valid settings.
    pub fn of<const N: usize>(tune: &ValidTune<N>) -> Result<Self, BenchError> {
        let samples = samples(tune);
        let qp = QpSettings::new(band_of_model(&tune.oracle.friction));
        Ok(Self {
            ekf_us: time_us(WrenchEkf::new(tune.config.ekf), &samples),
            qp_us: time_us(QpEstimator::new(QpSettings { limits: false, ..qp }), &samples),
            qp_interval_us: time_us(QpEstimator::new(qp), &samples),
        })
    }
}

fn samples<const N: usize>(tune: &ValidTune<N>) -> Vec<Sample<N>> {
    let trial = &tune.trial;
    let mut samples = Vec::with_capacity(SAMPLES);
    let mut before: Option<TickRecord<N>> = None;
    let friction = tribo_friction::FrictionModel::none();
    run_trial_observed(trial, &friction, WrenchEkf::new(tune.config.ekf), tune.config.seed, |record, _| {
        if let Some(before) = before.replace(*record).filter(|_| samples.len() < SAMPLES) {
            samples.push(Sample {
                frame: record.frame,
                terms: ControlTerms::at(&trial.model, &record.frame.q, &record.frame.qd),
                tau_motor: before.command,
                tau_friction: before.torque.friction + before.torque.effects,
                acceleration_command: before.task.acceleration_command,
                dt_s: trial.dt_s,
            });
        }
    });
    samples
}

fn time_us<const N: usize, E: WrenchEstimator<N>>(mut estimator: E, samples: &[Sample<N>]) -> f64 {
    let Some((first, rest)) = samples.split_first() else { return f64::NAN };
    1e-3 * per_call_ns(rest.len(), || {
        estimator.reset(&first.frame, &first.terms);
        for sample in rest {
            black_box(estimator.step(&black_box(sample).input()));
        }
    })
}
