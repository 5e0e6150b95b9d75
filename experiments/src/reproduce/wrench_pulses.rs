//! Every wrench estimator on pushes that are known: error, bias, delay, and what its 95 % interval is worth.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use tribo_campaign::{Phases, TuneConfig, noise_seed};
use tribo_ekf::WrenchEkfSettings;
use tribo_friction::FrictionModel;
use tribo_model::FieldError;
use tribo_robot::WrenchEstimator;
use tribo_sim::{Truth, WrenchPulses};
use tribo_trial::scenario::{ModelError, POSES};
use tribo_trial::{
    AnyEstimator, Calibration, ContactPrior, EstimatorName, LogWrench, Trial, band_of_model, run_trial_observed,
};

use super::ExperimentError;

/// Push on each axis in turn: 15 N or 2.5 Nm for 2.5 s, 1.5 s apart, from 5 s on.
const PUSH: [f64; 5] = [15.0, 2.5, 5.0, 2.5, 1.5];
/// Time after a push that does not count as free of contact (s).
const NEAR_PUSH_S: f64 = 0.3;

/// Settings of the experiment, `schema: tribo.reproduce/1`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PushedTool {
    /// `tribo.reproduce/1`.
    pub schema: String,
    /// Seeds 1 to this one: sensor noise and phases of the reference.
    pub seeds: u64,
    /// Configurations about which the tool moves; every one has all seeds.
    pub poses: Vec<usize>,
    /// What is simulated.
    pub cases: Vec<PushCase>,
}

/// One situation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PushCase {
    /// Whether the joints have friction.
    pub friction: bool,
    /// Whether the controller knows and compensates it.
    pub compensated: bool,
    /// Whether the tool follows the reference; else it holds its pose.
    pub moving: bool,
    /// Mass at the flange that nobody knows of (kg).
    pub payload_kg: f64,
}

/// What one estimator made of one situation, over all poses and seeds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PushRow {
    /// The situation.
    pub case: PushCase,
    /// The estimator.
    pub estimator: EstimatorName,
    /// Noise of the band after calibration, as a part of the assumed one; mean over poses.
    pub noise_factor: f64,
    /// What it reads.
    #[serde(flatten)]
    pub reading: Reading,
    /// What it most likely means where a component is touched in one sample of ten ([`ContactPrior`]).
    pub rarely_touched: Reading,
    /// Share of samples and axes in the 95 % interval.
    pub coverage95: f64,
    /// The same of the axis where it is least.
    pub coverage95_worst: f64,
    /// Mean half-width of the interval, force (N).
    pub half_width_force_n: f64,
    /// The same of the moment (Nm).
    pub half_width_moment_nm: f64,
}

/// How far off the wrenches of all poses and seeds are.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Reading {
    /// RMS error of the force, mean over axes (N).
    pub rmse_force_n: f64,
    /// The same of the moment (Nm).
    pub rmse_moment_nm: f64,
    /// Both, of each pose [N, Nm].
    pub rmse_by_pose: Vec<[f64; 2]>,
    /// Largest mean force reported on an axis in a pose before anybody has touched the arm (N).
    pub untouched_force_n: f64,
    /// The same of the moment (Nm).
    pub untouched_moment_nm: f64,
    /// Largest mean force reported on an axis in a pose while nobody pushes, most of it after pushes (N).
    pub bias_force_n: f64,
    /// The same of the moment (Nm).
    pub bias_moment_nm: f64,
    /// Delay at which the estimate fits best (ms), mean over seeds.
    pub delay_ms: f64,
}

impl PushedTool {
    /// Checks every field.
    ///
    /// # Errors
    /// The first out of its range.
    pub fn validate(&self) -> Result<(), FieldError> {
        if self.schema != "tribo.reproduce/1" {
            return Err(FieldError::new("schema", &self.schema, "tribo.reproduce/1"));
        }
        FieldError::check("seeds", self.seeds as f64, 1.0, 10_000.0)?;
        FieldError::check("number of poses", self.poses.len() as f64, 1.0, 100.0)?;
        self.poses.iter().try_for_each(|&pose| FieldError::check("poses", pose as f64, 0.0, (POSES - 1) as f64))?;
        self.cases.iter().try_for_each(|case| FieldError::check("cases.payload_kg", case.payload_kg, 0.0, 3.0))
    }

    /// Number of trials.
    pub fn trials(&self) -> usize {
        self.cases.len() * EstimatorName::ALL.len() * self.poses.len() * self.seeds as usize
    }

    /// Runs everything on the threads of the current rayon pool; `done` is told of each trial.
    ///
    /// # Errors
    /// Settings that no trial can be made of.
    pub fn run(&self, done: impl Fn() + Sync) -> Result<Vec<PushRow>, ExperimentError> {
        let keys: Vec<(PushCase, EstimatorName)> = self
            .cases
            .iter()
            .flat_map(|case| EstimatorName::ALL.into_iter().map(|estimator| (*case, estimator)))
            .collect();
        keys.into_par_iter()
            .map(|(case, estimator)| {
                let poses = self.poses.par_iter().map(|&pose| self.watch(case, estimator, pose, &done));
                Ok(row(case, estimator, poses.collect::<Result<Vec<PoseRun>, ExperimentError>>()?))
            })
            .collect()
    }

    /// Calibration and all seeds of one pose.
    fn watch(
        &self,
        case: PushCase,
        estimator: EstimatorName,
        pose: usize,
        done: &(impl Fn() + Sync),
    ) -> Result<PoseRun, ExperimentError> {
        let free = Stretch { case: PushCase { moving: true, ..case }, seed: FREE_SEED, pushed: false };
        let trial = free.trial(pose, estimator)?;
        let calibration = Calibration::of_free_stretch(|factor| free.watch(&trial, estimator, factor))?;
        let watched = (1..=self.seeds).into_par_iter().map(|seed| {
            let stretch = Stretch { case, seed, pushed: true };
            let trial = stretch.trial(pose, estimator)?;
            let mut log = stretch.watch(&trial, estimator, calibration.noise_factor)?;
            calibration.apply(&mut log);
            done();
            Ok(log)
        });
        Ok(PoseRun { calibration, logs: watched.collect::<Result<Vec<LogWrench>, ExperimentError>>()? })
    }
}

/// One estimator in one situation and one pose.
struct PoseRun {
    calibration: Calibration,
    /// One log per seed, calibrated.
    logs: Vec<LogWrench>,
}

/// What is true of a case but for the payload.
fn truth_of(case: PushCase) -> Truth<7> {
    if case.friction { Truth::panda_coulomb_viscous() } else { Truth::panda_frictionless() }
}

/// One trial of a case.
#[derive(Clone, Copy)]
struct Stretch {
    case: PushCase,
    seed: u64,
    pushed: bool,
}

impl Stretch {
    fn trial(&self, pose: usize, estimator: EstimatorName) -> Result<Trial<7>, ExperimentError> {
        let config = TuneConfig { seed: self.seed, pose, phases: Phases::Random, ..TuneConfig::default() };
        let mut trial = config.validate::<7>()?.trial;
        // Whoever pushes puts energy into the arm, as a compensator does that is too strong.
        trial.guard = None;
        let payload = ModelError { payload_kg: self.case.payload_kg, ..ModelError::default() };
        trial.truth = payload.apply(truth_of(self.case), self.seed);
        if estimator == EstimatorName::DoubleEncoder {
            trial = trial.with_two_encoders();
        }
        if self.pushed {
            let [force_n, moment_nm, start_s, width_s, pause_s] = PUSH;
            trial.pulses = WrenchPulses::each_axis(force_n, moment_nm, start_s, width_s, pause_s);
        }
        Ok(if self.case.moving { trial } else { trial.holding() })
    }

    /// Estimate and truth at every tick of the judged part.
    fn watch(
        &self,
        trial: &Trial<7>,
        estimator: EstimatorName,
        noise_factor: f64,
    ) -> Result<LogWrench, ExperimentError> {
        let known = truth_of(self.case).friction;
        let compensated = if self.case.compensated { known } else { FrictionModel::none() };
        let band = band_of_model(&known);
        let settings = WrenchEkfSettings::default();
        let estimator = AnyEstimator::with_confidence(estimator, settings, &trial.model, &known, &band, noise_factor)?
            .told_the_compensation();
        let mut log = LogWrench { stated_delay_s: estimator.delay_s(), ..LogWrench::default() };
        let mut reference = Vec::new();
        run_trial_observed(trial, &compensated, estimator, noise_seed(self.seed, 0), |record, _| {
            let time_s = record.frame.time_s;
            if time_s >= trial.reference.pre_roll_s() {
                log.push(time_s, &record.estimate);
                reference.push(trial.pulses.at(time_s - trial.dt_s).to_force_moment());
            }
        });
        log.reference = Some(reference);
        Ok(log)
    }
}

/// Seed of the stretch that calibrates, no trial's.
const FREE_SEED: u64 = 1_000_003;

fn row(case: PushCase, estimator: EstimatorName, poses: Vec<PoseRun>) -> PushRow {
    let n = poses.iter().map(|run| run.logs.len()).sum::<usize>().max(1) as f64;
    let (mut coverage, mut half_width) = ([0.0; 6], [0.0; 6]);
    for log in poses.iter().flat_map(|run| &run.logs) {
        let summary = log.summary();
        let errors = summary.against_reference.unwrap_or_default();
        for i in 0..6 {
            coverage[i] += errors.coverage95[i] / n;
            half_width[i] += summary.half_width95[i] / n;
        }
    }
    let noise_factor = poses.iter().map(|run| run.calibration.noise_factor).sum::<f64>() / poses.len() as f64;
    let mut logs: Vec<Vec<LogWrench>> = poses.into_iter().map(|run| run.logs).collect();
    let reading = Reading::of(&logs);
    logs.iter_mut().flatten().for_each(|log| ContactPrior::default().apply(log));
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
    PushRow {
        case,
        estimator,
        noise_factor,
        reading,
        rarely_touched: Reading::of(&logs),
        coverage95: mean(&coverage),
        coverage95_worst: coverage.iter().copied().fold(1.0, f64::min),
        half_width_force_n: mean(&half_width[..3]),
        half_width_moment_nm: mean(&half_width[3..]),
    }
}

impl Reading {
    /// Of the logs of every pose.
    fn of(poses: &[Vec<LogWrench>]) -> Self {
        let n = poses.iter().map(Vec::len).sum::<usize>().max(1) as f64;
        let (mut mean_square, mut bias, mut untouched) = ([0.0; 6], [0.0_f64; 6], [0.0_f64; 6]);
        let (mut delay_s, mut rmse_by_pose) = (0.0, Vec::new());
        let root_of_mean = |x: &[f64]| (x.iter().sum::<f64>() / 3.0).sqrt();
        for logs in poses {
            let (mut free, mut first, mut own_square) = ([0.0; 6], [0.0; 6], [0.0; 6]);
            for log in logs {
                let errors = log.summary().against_reference.unwrap_or_default();
                delay_s += errors.delay_s.unwrap_or(0.0) / n;
                let own = free_mean(log, f64::INFINITY);
                let own_first = free_mean(log, PUSH[2]);
                for i in 0..6 {
                    mean_square[i] += errors.rmse[i].powi(2) / n;
                    free[i] += own[i] / logs.len() as f64;
                    first[i] += own_first[i] / logs.len() as f64;
                    own_square[i] += errors.rmse[i].powi(2) / logs.len() as f64;
                }
            }
            bias = std::array::from_fn(|i| bias[i].max(free[i].abs()));
            untouched = std::array::from_fn(|i| untouched[i].max(first[i].abs()));
            rmse_by_pose.push([root_of_mean(&own_square[..3]), root_of_mean(&own_square[3..])]);
        }
        let largest = |x: &[f64]| x.iter().copied().fold(0.0, f64::max);
        Self {
            rmse_force_n: root_of_mean(&mean_square[..3]),
            rmse_moment_nm: root_of_mean(&mean_square[3..]),
            rmse_by_pose,
            untouched_force_n: largest(&untouched[..3]),
            untouched_moment_nm: largest(&untouched[3..]),
            bias_force_n: largest(&bias[..3]),
            bias_moment_nm: largest(&bias[3..]),
            delay_ms: 1e3 * delay_s,
        }
    }
}

/// Mean wrench while nobody pushes, before a time (s).
fn free_mean(log: &LogWrench, before_s: f64) -> [f64; 6] {
    let Some(reference) = &log.reference else { return [0.0; 6] };
    let [.., start_s, width_s, pause_s] = PUSH;
    let near = |time_s: f64| {
        let since = time_s - start_s;
        since >= 0.0 && since.rem_euclid(width_s + pause_s) <= width_s + NEAR_PUSH_S
    };
    let is_free = |k: usize| reference[k] == [0.0; 6] && !near(log.time_s[k]) && log.time_s[k] < before_s;
    let free: Vec<usize> = (0..reference.len()).filter(|&k| is_free(k)).collect();
    std::array::from_fn(|i| free.iter().map(|&k| log.wrench[k][i]).sum::<f64>() / free.len().max(1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use tribo_model::YamlDocument;

    const SMOOTH: PushCase = PushCase { friction: false, compensated: false, moving: false, payload_kg: 0.0 };

    fn shipped() -> PushedTool {
        YamlDocument::embedded("config.yaml", crate::reproduce::shipped::WRENCH_PULSES).parse().unwrap()
    }

    /// One trial without calibration.
    fn judged(case: PushCase, estimator: EstimatorName) -> PushRow {
        let stretch = Stretch { case, seed: 1, pushed: true };
        let log = stretch.watch(&stretch.trial(0, estimator).unwrap(), estimator, 1.0).unwrap();
        row(case, estimator, vec![PoseRun { calibration: Calibration::default(), logs: vec![log] }])
    }

    #[test]
    fn the_filter_sees_pushes_on_a_smooth_arm() {
        let ekf = judged(SMOOTH, EstimatorName::Ekf);
        assert_eq!(ekf, judged(SMOOTH, EstimatorName::Ekf));
        assert!(ekf.reading.rmse_force_n < 0.25 && ekf.reading.rmse_moment_nm < 0.05, "{ekf:?}");
        assert!(
            ekf.reading.untouched_force_n < 0.01 && ekf.reading.bias_force_n < 0.01 && ekf.coverage95_worst > 0.95,
            "{ekf:?}"
        );
        assert!((5.0..30.0).contains(&ekf.reading.delay_ms), "{ekf:?}");
    }

    /// What lies between the two encoders does not contain the friction of the motors; the filter sees all of it.
    #[test]
    fn two_encoders_do_not_see_friction() {
        let rough = PushCase { friction: true, ..SMOOTH };
        let ratio =
            |estimator| judged(rough, estimator).reading.rmse_force_n / judged(SMOOTH, estimator).reading.rmse_force_n;
        let [gears, motors] = [EstimatorName::DoubleEncoder, EstimatorName::Ekf].map(ratio);
        assert!((gears - 1.0).abs() < 0.02 && motors > 5.0, "{gears} {motors}");
    }

    #[test]
    fn the_free_mean_ignores_pushes_and_their_edges() {
        let [force_n, moment_nm, start_s, width_s, pause_s] = PUSH;
        let pulses = WrenchPulses::each_axis(force_n, moment_nm, start_s, width_s, pause_s);
        let (bias, mut log) = ([0.3, -0.2, 0.1, 0.03, -0.02, 0.01], LogWrench::default());
        let mut reference = Vec::new();
        for k in 0..3000 {
            let time_s = 0.01 * f64::from(k);
            // An estimate that comes a quarter of a second late.
            let late = pulses.at(time_s - 0.25).to_force_moment();
            log.time_s.push(time_s);
            log.wrench.push(std::array::from_fn(|i| bias[i] + late[i]));
            reference.push(pulses.at(time_s).to_force_moment());
        }
        log.reference = Some(reference);
        let free = free_mean(&log, f64::INFINITY);
        assert!((0..6).all(|i| (free[i] - bias[i]).abs() < 1e-12), "{free:?}");
        // Nobody has touched the arm before the first push, whatever is left of it afterwards.
        log.wrench
            .iter_mut()
            .zip(&log.time_s)
            .filter(|(_, at)| **at >= start_s)
            .for_each(|(wrench, _)| wrench[0] += 2.0);
        let untouched = free_mean(&log, start_s);
        assert!((0..6).all(|i| (untouched[i] - bias[i]).abs() < 1e-12), "{untouched:?}");
    }

    #[test]
    fn settings_out_of_range_are_named() {
        let shipped = shipped();
        shipped.validate().unwrap();
        assert_eq!(shipped.trials(), 8 * 5 * 3 * 5);
        for poses in [vec![], vec![0, POSES]] {
            let error = PushedTool { poses, ..shipped.clone() }.validate().unwrap_err().to_string();
            assert!(error.contains("poses"), "{error}");
        }
        let cases = vec![PushCase { payload_kg: -0.1, ..SMOOTH }];
        let error = PushedTool { cases, ..shipped }.validate().unwrap_err().to_string();
        assert!(error.contains("cases.payload_kg"), "{error}");
    }
}
