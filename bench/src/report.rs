//! The figures of one computer.

use std::time::Duration;

use serde::Serialize;
use tribo_campaign::ValidTune;
use tribo_runtime::allowed_cores;

use super::interference::{DISTURBANCE_US, idle_gaps};
use super::{
    BenchError, DynamicsTimes, EstimatorTimes, Interference, OptimiserTimes, Percentiles, Rights, TickTimes,
    TrialTimes, Verdict, tick_times,
};

/// How much is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BenchSettings {
    /// Ticks of the histogram.
    pub ticks: u64,
    /// Repeats of what takes long: trials, steps of the optimiser.
    pub repeats: usize,
    /// How long the idle loop is watched.
    pub idle: Duration,
}

impl BenchSettings {
    /// A million ticks, the tail of which means something; about a minute.
    pub const FULL: Self = Self { ticks: 1_000_000, repeats: 5, idle: Duration::from_secs(2) };
    /// A few seconds.
    pub const QUICK: Self = Self { ticks: 30_000, repeats: 1, idle: Duration::from_millis(200) };
}

/// Everything `tribo bench` says: `schema: tribo.bench/1`.
#[derive(Clone, Debug, Serialize)]
pub struct BenchReport {
    /// `tribo.bench/1`.
    pub schema: &'static str,
    /// The arm.
    pub robot: String,
    /// Ticks of the histograms.
    pub ticks: u64,
    /// Whole tick without the simulated arm.
    pub tick_us: Percentiles,
    /// The same ticks without what disturbs them, by [`TickTimes::tick_itself`].
    pub tick_itself_us: Percentiles,
    /// Whole tick and simulated arm.
    pub tick_with_plant_us: Percentiles,
    /// The simulated arm alone.
    pub plant_us: Percentiles,
    /// Rigid-body dynamics.
    #[serde(flatten)]
    pub dynamics: DynamicsTimes,
    /// Wrench estimators.
    #[serde(flatten)]
    pub estimators: EstimatorTimes,
    /// A trial.
    #[serde(flatten)]
    pub trial: TrialTimes,
    /// The optimiser.
    #[serde(flatten)]
    pub optimiser: OptimiserTimes,
    /// What disturbed the ticks.
    pub interference: Interference,
    /// Records that did not fit into the ring.
    pub records_lost: u64,
    /// What the system granted.
    pub rights: Rights,
    /// Fit or not.
    pub verdict: Verdict,
}

/// Measures everything on the calling thread, which is kept on one core from then on; `stage` hears what comes next.
///
/// # Errors
/// Settings that the estimator cannot work with, or a loop that stops by itself.
pub fn bench<const N: usize>(
    tune: &ValidTune<N>,
    settings: BenchSettings,
    mut stage: impl FnMut(&str),
) -> Result<BenchReport, BenchError> {
    let cores = allowed_cores();
    let mut rights = Rights::none();
    rights.pin();
    let others: Vec<usize> = cores.iter().copied().filter(|core| Some(*core) != rights.pinned_core).collect();
    stage("idle loop");
    let idle = idle_gaps(settings.idle)?;
    stage("ticks");
    let times = tick_times(tune, settings.ticks, if others.is_empty() { &cores } else { &others })?;
    stage("dynamics");
    let dynamics = DynamicsTimes::of(&tune.trial.model);
    stage("estimators");
    let estimators = EstimatorTimes::of(tune)?;
    stage("trial");
    let trial = TrialTimes::of(tune, settings.repeats)?;
    stage("optimiser");
    let optimiser = OptimiserTimes::measure(settings.repeats)?;
    let TickTimes { tick, tick_itself, plant, with_plant, records_lost, preempted, wall_s } = &times;
    let disturbed = tick.count_from(DISTURBANCE_US);
    Ok(BenchReport {
        schema: "tribo.bench/1",
        robot: tune.trial.model.name.clone(),
        ticks: tick.count(),
        tick_us: tick.into(),
        tick_itself_us: tick_itself.into(),
        tick_with_plant_us: with_plant.into(),
        plant_us: plant.into(),
        dynamics,
        estimators,
        trial,
        optimiser,
        interference: Interference {
            ticks_above_100_us: disturbed,
            ticks_above_100_us_per_s: disturbed as f64 / wall_s,
            idle_gaps_above_100_us_per_s: idle.count_from(DISTURBANCE_US) as f64 / settings.idle.as_secs_f64(),
            idle_gap_max_us: idle.max_us(),
            preempted: *preempted,
        },
        records_lost: *records_lost,
        rights,
        verdict: Verdict::of_ticks(tick, tune.trial.dt_s * 1e6),
    })
}
