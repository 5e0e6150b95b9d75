//! Time of ticks, one by one.

use std::time::Instant;

use tribo_robot::Plant;
use tribo_runtime::{ControlLoop, LatencyHistogram, ProcessImage, record_ring, run_on_cores};
use tribo_sim::BoxFrictionPlant;

use super::BenchError;
use super::interference::preemptions;
use super::records::drain;
use crate::{AnyEstimator, Trial, ValidTune};

/// Records that the ring holds: a twelfth of a second of ticks at full speed.
pub(super) const RING: usize = 4096;

/// Times of the ticks of trials, run one after the other as fast as they go.
#[derive(Clone, Debug)]
pub struct TickTimes {
    /// Sense, estimate, control, limit, record into the ring.
    pub tick: LatencyHistogram,
    /// The simulated arm alone: its sub-steps and sensors.
    pub plant: LatencyHistogram,
    /// Both.
    pub with_plant: LatencyHistogram,
    /// Records that did not fit into the ring.
    pub records_lost: u64,
    /// Times that the thread lost its core meanwhile.
    pub preempted: Option<u64>,
    /// How long all of it took (s).
    pub wall_s: f64,
}

/// The loop of a trial that believes the true friction, and its plant.
pub(super) fn rig<const N: usize>(
    tune: &ValidTune<N>,
    trial: &Trial<N>,
    seed: u64,
) -> Result<(ControlLoop<N, AnyEstimator<N>>, BoxFrictionPlant<N>), BenchError> {
    let friction = tune.oracle.friction;
    let estimator = AnyEstimator::for_tuning(tune.config.residual, tune.config.ekf, &trial.model, &friction)?;
    Ok((trial.control_loop(&friction, estimator), trial.plant(seed)))
}

/// Runs `ticks` ticks of the tuning trial, again from its start where it ends, with another thread on one of `reader_cores` taking
/// the records.
///
/// # Errors
/// An estimator that cannot be, or a loop that stops by itself.
pub fn tick_times<const N: usize>(
    tune: &ValidTune<N>,
    ticks: u64,
    reader_cores: &[usize],
) -> Result<TickTimes, BenchError> {
    let per_trial = (tune.trial.reference.total_s() / tune.trial.dt_s).round() as u64;
    let empty = LatencyHistogram::new;
    let (mut tick_time, mut plant_time, mut both) = (empty()?, empty()?, empty()?);
    let (mut sink, ring) = record_ring::<N>(RING);
    let nanoseconds =
        |from: Instant, to: Instant| u64::try_from(to.duration_since(from).as_nanos()).unwrap_or(u64::MAX);

    std::thread::scope(|scope| {
        let reader = scope.spawn(move || {
            // It would inherit the core of this thread, and take it away a thousand times per second. Refused, it only disturbs.
            let _ = run_on_cores(reader_cores);
            drain(ring, |_, _| ())
        });
        let (started, before) = (Instant::now(), preemptions());
        let mut run = 0;
        while run < ticks {
            let (mut control, mut plant) = rig(tune, &tune.trial, tune.config.seed + run)?;
            let mut image = ProcessImage::of(plant.sense());
            for _ in 0..per_trial.min(ticks - run) {
                let begin = Instant::now();
                let record = control.tick(&mut image);
                sink.push(run, *record);
                let done = Instant::now();
                plant.actuate(&image.command);
                image.frame = plant.sense();
                let end = Instant::now();
                tick_time.record(nanoseconds(begin, done));
                plant_time.record(nanoseconds(done, end));
                both.record(nanoseconds(begin, end));
                if let Some(fault) = record.fault {
                    return Err(fault.into());
                }
                run += 1;
            }
        }
        let wall_s = started.elapsed().as_secs_f64();
        let preempted = preemptions().zip(before).map(|(after, before)| after - before);
        drop(sink);
        let received = reader.join().map_err(|_| BenchError::Thread)?;
        Ok(TickTimes {
            tick: tick_time,
            plant: plant_time,
            with_plant: both,
            records_lost: ticks - received,
            preempted,
            wall_s,
        })
    })
}
