//! Time of ticks, one by one.

use std::time::Instant;

use tribo_campaign::ValidTune;
use tribo_robot::Plant;
use tribo_runtime::{ControlLoop, LatencyHistogram, ProcessImage, RecordSink, record_ring, run_on_cores};
use tribo_sim::BoxFrictionPlant;
use tribo_trial::{AnyEstimator, Trial};

use super::BenchError;
use super::interference::preemptions;
use super::records::drain;

/// Records that the ring holds: a twelfth of a second of ticks at full speed.
pub(super) const RING: usize = 4096;
/// Runs of every trial. What disturbs a tick of one run leaves the same tick of another alone: of two in a thousand that are disturbed,
/// three runs leave one in a hundred million.
const RUNS: usize = 3;

/// Times of the ticks of trials, run one after the other as fast as they go.
#[derive(Clone, Debug)]
pub struct TickTimes {
    /// Sense, estimate, control, limit, record into the ring.
    pub tick: LatencyHistogram,
    /// The same ticks without what disturbs them: of each the least of three runs, which are the same to the bit. What a tick is slow by itself
    /// it is slow in every run.
    pub tick_itself: LatencyHistogram,
    /// The simulated arm alone: its sub-steps and sensors.
    pub plant: LatencyHistogram,
    /// Both.
    pub with_plant: LatencyHistogram,
    /// Records that did not fit into the ring, of all runs.
    pub records_lost: u64,
    /// Times that the thread lost its core during the runs that the histograms but `tick_itself` are of.
    pub preempted: Option<u64>,
    /// How long these took (s).
    pub wall_s: f64,
}

/// The loop of a trial that believes the true friction, and its plant.
pub(super) fn rig<const N: usize>(
    tune: &ValidTune<N>,
    trial: &Trial<N>,
    seed: u64,
) -> Result<(ControlLoop<N, AnyEstimator<N>>, BoxFrictionPlant<N>), BenchError> {
    let friction = tune.oracle.friction;
    let estimator = AnyEstimator::for_tuning(tune.config.residual, tune.config.ekf, trial, &friction)?;
    Ok((trial.control_loop(&friction, estimator), trial.plant(seed)))
}

/// Runs `ticks` ticks of the tuning trial, again from its start where it ends and each trial three times, with another thread on one of
/// `reader_cores` taking the records.
///
/// # Errors
/// An estimator that cannot be, or a loop that stops by itself.
pub fn tick_times<const N: usize>(
    tune: &ValidTune<N>,
    ticks: u64,
    reader_cores: &[usize],
) -> Result<TickTimes, BenchError> {
    let per_trial = (tune.trial.reference.total_s() / tune.trial.dt_s).round() as u64;
    let (mut sink, ring) = record_ring::<N>(RING);
    std::thread::scope(|scope| {
        let reader = scope.spawn(move || {
            // It would inherit the core of this thread, and take it away a thousand times per second. Refused, it only disturbs.
            let _ = run_on_cores(reader_cores);
            drain(ring, |_, _| ())
        });
        let empty = LatencyHistogram::new;
        let mut times = TickTimes {
            tick: empty()?,
            tick_itself: empty()?,
            plant: empty()?,
            with_plant: empty()?,
            records_lost: 0,
            preempted: Some(0),
            wall_s: 0.0,
        };
        let mut done = 0;
        while done < ticks {
            let (seed, length) = (tune.config.seed + done, per_trial.min(ticks - done));
            let mut least = vec![u64::MAX; length as usize];
            let (started, before) = (Instant::now(), preemptions());
            timed_trial(tune, seed, &mut sink, &mut least, |tick_ns, plant_ns| {
                times.tick.record(tick_ns);
                times.plant.record(plant_ns);
                times.with_plant.record(tick_ns + plant_ns);
            })?;
            times.wall_s += started.elapsed().as_secs_f64();
            let preempted = preemptions().zip(before).map(|(after, before)| after - before);
            times.preempted = times.preempted.zip(preempted).map(|(sum, more)| sum + more);
            for _ in 1..RUNS {
                timed_trial(tune, seed, &mut sink, &mut least, |_, _| ())?;
            }
            least.iter().for_each(|&least_ns| times.tick_itself.record(least_ns));
            done += length;
        }
        times.records_lost = sink.dropped();
        // Without it the reader would wait for more.
        drop(sink);
        reader.join().map_err(|_| BenchError::Thread)?;
        Ok(times)
    })
}

/// Runs the first ticks of the trial with this seed, as many as `least` has: `see` hears the times of tick and plant (ns) of each, `least`
/// keeps the tick's where it is less.
fn timed_trial<const N: usize>(
    tune: &ValidTune<N>,
    seed: u64,
    sink: &mut RecordSink<N>,
    least: &mut [u64],
    mut see: impl FnMut(u64, u64),
) -> Result<(), BenchError> {
    let nanoseconds =
        |from: Instant, to: Instant| u64::try_from(to.duration_since(from).as_nanos()).unwrap_or(u64::MAX);
    let (mut control, mut plant) = rig(tune, &tune.trial, seed)?;
    let mut image = ProcessImage::of(plant.sample());
    for (tick, least) in (0..).zip(least) {
        let begin = Instant::now();
        let record = control.tick(&mut image);
        sink.push(tick, *record);
        let done = Instant::now();
        plant.actuate(&image.command);
        image.frame = plant.sample();
        let end = Instant::now();
        let tick_ns = nanoseconds(begin, done);
        see(tick_ns, nanoseconds(done, end));
        *least = tick_ns.min(*least);
        if let Some(fault) = record.fault {
            return Err(fault.into());
        }
    }
    Ok(())
}
