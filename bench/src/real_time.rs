//! The loop on this computer's clock.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use nalgebra::SVector;
use serde::Serialize;
use tribo_robot::{Arm, Plant, PlantLost, SensorFrame, gravity_torque};
use tribo_runtime::{
    Clock, LoopTiming, MonotonicClock, OverrunPolicy, RealTimeLoop, TickFault, TickRecord, allowed_cores, lock_memory,
    record_ring, run_on_cores, take_fifo_priority,
};

use super::records::drain;
use super::tick::{RING, rig};
use super::{BenchError, Percentiles, Rights, Verdict};
use tribo_campaign::ValidTune;

/// Upper edges of the classes that are shown (µs); the last class is open.
const EDGES_US: [f64; 9] = [10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0, 2000.0, 5000.0];
/// Slower than this a joint stands (rad/s): the noise of its sensors.
const STANDING_RAD_S: f64 = 0.05;
/// The end of a run in which an arm that was stopped must stand (s).
const STANDS_AT_LAST_S: f64 = 0.1;
/// Memory that a loading thread walks through: more than a core's own caches hold.
const LOAD_WORDS: usize = 1 << 20;

/// A delay on purpose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stall {
    /// How long the loop stands still.
    pub length: Duration,
    /// When, in time of the loop (s).
    pub at_s: f64,
}

/// How the loop is run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RealTimeSettings {
    /// How long (s).
    pub seconds: f64,
    /// When the loop gives up.
    pub policy: OverrunPolicy,
    /// Whether a busy thread runs on every core.
    pub load: bool,
    /// A delay on purpose.
    pub stall: Option<Stall>,
}

/// What the arm did after the overrun policy stopped the loop.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AfterFault {
    /// Why the loop stopped; the overrun policy or something that came of the delays.
    pub fault: String,
    /// When (s).
    pub at_s: f64,
    /// How long it was watched afterwards (s).
    pub watched_s: f64,
    /// Highest speed of a joint over its limit.
    pub max_speed_share: f64,
    /// Highest speed of a joint (rad/s) in the last tenth of a second.
    pub last_speed_rad_s: f64,
    /// Whether every joint stayed within its limits.
    pub inside_limits: bool,
    /// Whether the safe torque was sent to the end.
    pub stayed: bool,
    /// All of it: within the limits of speed and position, standing at the end, no way back.
    pub safe: bool,
}

/// What came of a run.
#[derive(Clone, Debug, Serialize)]
pub struct RealTimeReport {
    /// Periods that went by.
    pub periods: u64,
    /// Ticks that ran: fewer than periods where deadlines were missed.
    pub ticks: u64,
    /// Deadlines missed.
    pub missed: u64,
    /// The most of them in a row.
    pub missed_in_a_row: u64,
    /// In a row, the loop gives up at.
    pub overruns_allowed: u32,
    /// Begin of a tick behind the begin of its period.
    pub wake_up_us: Percentiles,
    /// The tick.
    pub tick_us: Percentiles,
    /// Command behind the begin of the period.
    pub response_us: Percentiles,
    /// Upper edges of the classes of `response_counts` (µs).
    pub edges_us: [f64; 9],
    /// Ticks by response; one class more than edges.
    pub response_counts: Vec<u64>,
    /// Records that did not fit into the ring.
    pub records_lost: u64,
    /// Whether a busy thread ran on every core.
    pub load: bool,
    /// Delay on purpose (ms).
    pub stall_ms: Option<f64>,
    /// What the arm did after a fault, if there was one.
    pub after_fault: Option<AfterFault>,
    /// What the system granted.
    pub rights: Rights,
    /// Fit or not.
    pub verdict: Verdict,
}

/// The simulated arm on a bus that stands still once.
struct StallingPlant<P> {
    inner: P,
    stall: Option<(u64, u64)>,
    senses: u64,
}

impl<const N: usize, P: Plant<N>> Plant<N> for StallingPlant<P> {
    fn sense(&mut self) -> Result<SensorFrame<N>, PlantLost> {
        if let Some((_, length_ns)) = self.stall.filter(|(at, _)| *at == self.senses) {
            MonotonicClock.sleep_until_ns(MonotonicClock.now_ns() + length_ns);
        }
        self.senses += 1;
        self.inner.sense()
    }

    fn actuate(&mut self, tau_nm: &SVector<f64, N>) {
        self.inner.actuate(tau_nm);
    }
}

/// What the records say about an arm that was stopped.
#[derive(Default)]
struct Watch {
    fault: Option<TickFault>,
    first_s: f64,
    last_s: f64,
    max_speed_share: f64,
    last_speed_rad_s: f64,
    outside: bool,
    recovered: bool,
}

impl Watch {
    fn see<const N: usize>(&mut self, arm: &Arm<N>, end_s: f64, record: &TickRecord<N>) {
        let frame = &record.frame;
        let Some(fault) = record.fault else {
            self.recovered |= self.fault.is_some();
            return;
        };
        if self.fault.is_none() {
            (self.fault, self.first_s) = (Some(fault), frame.time_s);
        }
        self.last_s = frame.time_s;
        self.max_speed_share = self.max_speed_share.max(frame.qd.component_div(&arm.limits.qd_max_rad_s).amax());
        if frame.time_s >= end_s - STANDS_AT_LAST_S {
            self.last_speed_rad_s = self.last_speed_rad_s.max(frame.qd.amax());
        }
        self.outside |= arm.first_joint_outside_limits(&frame.q).is_some();
    }

    fn judged(&self) -> Option<AfterFault> {
        let fault = self.fault?;
        let stands = self.last_speed_rad_s <= STANDING_RAD_S;
        Some(AfterFault {
            fault: fault.to_string(),
            at_s: self.first_s,
            watched_s: self.last_s - self.first_s,
            max_speed_share: self.max_speed_share,
            last_speed_rad_s: self.last_speed_rad_s,
            inside_limits: !self.outside,
            stayed: !self.recovered,
            safe: !self.outside && !self.recovered && self.max_speed_share <= 1.0 && stands,
        })
    }
}

/// Runs the loop of the tuning trial, with the true friction believed, on `CLOCK_MONOTONIC`, with whatever the system grants of
/// memory locking, a core and `SCHED_FIFO`.
///
/// # Errors
/// Settings that the estimator cannot work with.
pub fn real_time<const N: usize>(
    tune: &ValidTune<N>,
    settings: &RealTimeSettings,
) -> Result<RealTimeReport, BenchError> {
    let mut rights = Rights::none();
    rights.memory_locked = rights.granted("memory", lock_memory());
    let trial = &tune.trial;
    let arm = &trial.model;
    let (control, inner) = rig(tune, trial, tune.config.seed)?;
    let periods = (settings.seconds / trial.dt_s).round() as u64;
    let stall = settings.stall.map(|stall| {
        // One reading is the loop's own, before its first period.
        let at = (stall.at_s / trial.dt_s).round() as u64 + 1;
        (at, u64::try_from(stall.length.as_nanos()).unwrap_or(u64::MAX))
    });
    let plant = StallingPlant { inner, stall, senses: 0 };
    let (sink, ring) = record_ring::<N>(RING);
    let timing = LoopTiming::new()?;
    let (policy, held) = (settings.policy, gravity_torque(arm, &trial.start));
    let stop_load = AtomicBool::new(false);

    std::thread::scope(|scope| {
        if settings.load {
            for core in allowed_cores() {
                let stop = &stop_load;
                scope.spawn(move || busy(core, stop));
            }
        }
        let reader = scope.spawn(|| {
            let mut watch = Watch::default();
            drain(ring, |_, record| watch.see(arm, settings.seconds, record));
            watch
        });
        // A thread of its own: what it is granted ends with it.
        let looping = scope.spawn(move || -> Result<RealTimeReport, PlantLost> {
            rights.pin();
            rights.fifo = rights.granted("SCHED_FIFO", take_fifo_priority());
            let mut real_time = RealTimeLoop::new(control, plant, MonotonicClock, policy, sink, timing, held)?;
            let periods = real_time.run(periods);
            let timing = real_time.timing();
            let missed = real_time.overruns().missed();
            Ok(RealTimeReport {
                periods,
                ticks: real_time.ticks(),
                missed,
                missed_in_a_row: real_time.overruns().longest_row(),
                overruns_allowed: policy.fault_after,
                wake_up_us: (&timing.wake_up).into(),
                tick_us: (&timing.tick).into(),
                response_us: (&timing.response).into(),
                edges_us: EDGES_US,
                response_counts: timing.response.counts_between(&EDGES_US),
                records_lost: real_time.dropped(),
                load: settings.load,
                stall_ms: settings.stall.map(|stall| stall.length.as_secs_f64() * 1e3),
                after_fault: None,
                rights,
                verdict: Verdict::of_response(&timing.response, missed, trial.dt_s * 1e6),
            })
        });
        let report = looping.join();
        stop_load.store(true, Ordering::Relaxed);
        let watch = reader.join().map_err(|_| BenchError::Thread)?;
        let report = report.map_err(|_| BenchError::Thread)?.map_err(|_| TickFault::PlantLost)?;
        Ok(RealTimeReport { after_fault: watch.judged(), ..report })
    })
}

/// Keeps one core and its caches busy until told to stop.
fn busy(core: usize, stop: &AtomicBool) {
    // Where it cannot be pinned it is busy all the same.
    let _ = run_on_cores(&[core]);
    let mut memory = vec![1_u64; LOAD_WORDS];
    while !stop.load(Ordering::Relaxed) {
        for word in &mut memory {
            *word = word.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        }
        std::hint::black_box(&mut memory);
    }
}
