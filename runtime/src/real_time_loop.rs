//! The loop on a clock.

use hdrhistogram::CreationError;
use nalgebra::SVector;
use tribo_robot::{Plant, PlantLost, WrenchEstimator};

use crate::{
    Clock, ControlLoop, Delivery, LatencyHistogram, OverrunGuard, OverrunPolicy, ProcessImage, RecordSink, TickFault,
};

/// What the loop's clock has seen.
#[derive(Clone, Debug)]
pub struct LoopTiming {
    /// From the start of a period to the start of its tick.
    pub wake_up: LatencyHistogram,
    /// From the start of a tick to its command: sense, estimate, control, limit, record.
    pub tick: LatencyHistogram,
    /// From the start of a period to its command: what is held against the deadline.
    pub response: LatencyHistogram,
}

impl LoopTiming {
    /// Empty histograms; this is where their memory comes from.
    ///
    /// # Errors
    /// None with the bounds that histograms have.
    pub fn new() -> Result<Self, CreationError> {
        let empty = LatencyHistogram::new;
        Ok(Self { wake_up: empty()?, tick: empty()?, response: empty()? })
    }
}

/// [`ControlLoop`] once per period T of a [`Clock`], with a deadline:
///
/// ```text
/// period k begins at t_k = t_0 + k T;  its command is due at t_{k+1}
/// missed = ⌊(end of tick − t_k) / T⌋
/// missed = 0:  the command is sent
/// missed > 0:  it is not; the last one sent is sent again for each period missed, and the loop goes on in the period that runs
/// ```
///
/// [`OverrunPolicy`] says how many in a row are borne; one more is [`TickFault::DeadlineMissed`], and from the next tick on the
/// loop sends the safe torque. What the robot does while the loop does not run is its drives' affair: here they hold the
/// last torque, the worst of the usual answers.
///
/// A step allocates nothing and takes no lock. Leaves out: correcting the estimator for periods without a sample; after a missed
/// deadline it takes the new sample as if one period had gone by.
#[derive(Debug)]
pub struct RealTimeLoop<const N: usize, E, P, C> {
    control: ControlLoop<N, E>,
    plant: P,
    clock: C,
    sink: RecordSink<N>,
    timing: LoopTiming,
    guard: OverrunGuard,
    image: ProcessImage<N>,
    sent: SVector<f64, N>,
    period_ns: u64,
    begins_ns: u64,
    ticks: u64,
    faulted_at: Option<u64>,
}

impl<const N: usize, E: WrenchEstimator<N>, P: Plant<N>, C: Clock> RealTimeLoop<N, E, P, C> {
    /// A loop whose first period begins one period from now. `held` (Nm) is sent if the very first command is late.
    ///
    /// # Errors
    ///
    /// [`PlantLost`] where the robot gives no sample to begin with.
    pub fn new(
        control: ControlLoop<N, E>,
        mut plant: P,
        clock: C,
        policy: OverrunPolicy,
        sink: RecordSink<N>,
        timing: LoopTiming,
        held: SVector<f64, N>,
    ) -> Result<Self, PlantLost> {
        let period_ns = (control.period_s() * 1e9).round() as u64;
        let image = ProcessImage::of(plant.sense()?);
        let begins_ns = clock.now_ns() + period_ns;
        Ok(Self {
            control,
            plant,
            clock,
            sink,
            timing,
            guard: OverrunGuard::new(policy),
            image,
            sent: held,
            period_ns,
            begins_ns,
            ticks: 0,
            faulted_at: None,
        })
    }

    /// Waits for the period, runs its tick, sends the command or holds the last one. Returns the periods that went by.
    pub fn step(&mut self) -> u64 {
        self.clock.sleep_until_ns(self.begins_ns);
        let woke_ns = self.clock.now_ns();

        match self.plant.sense() {
            Ok(frame) => self.image.frame = frame,
            Err(PlantLost) => self.control.stop(TickFault::PlantLost),
        }
        let record = self.control.tick(&mut self.image);
        self.sink.push(self.ticks, *record);

        let done_ns = self.clock.now_ns();
        let response_ns = done_ns.saturating_sub(self.begins_ns);
        self.timing.wake_up.record(woke_ns.saturating_sub(self.begins_ns));
        self.timing.tick.record(done_ns.saturating_sub(woke_ns));
        self.timing.response.record(response_ns);

        let missed = response_ns / self.period_ns;
        match self.guard.judge(missed) {
            Delivery::Send => self.sent = self.image.command,
            Delivery::Hold => {}
            Delivery::Fault => {
                self.control.stop(TickFault::DeadlineMissed);
                self.faulted_at.get_or_insert(self.ticks);
            }
        }
        let periods = missed.max(1);
        for _ in 0..periods {
            self.plant.actuate(&self.sent);
        }
        self.begins_ns += periods * self.period_ns;
        self.ticks += 1;
        periods
    }

    /// Steps until `periods` periods have gone by, whether with a command or without, and says how many did: a late tick may go
    /// beyond.
    pub fn run(&mut self, periods: u64) -> u64 {
        let mut gone = 0;
        while gone < periods {
            gone += self.step();
        }
        gone
    }

    /// Ticks run.
    pub fn ticks(&self) -> u64 {
        self.ticks
    }

    /// The tick (from 0) at which the overrun policy stopped the loop.
    pub fn faulted_at(&self) -> Option<u64> {
        self.faulted_at
    }

    /// Deadlines missed, in all and in a row.
    pub fn overruns(&self) -> &OverrunGuard {
        &self.guard
    }

    /// What the clock has seen.
    pub fn timing(&self) -> &LoopTiming {
        &self.timing
    }

    /// Records that did not fit into the ring.
    pub fn dropped(&self) -> u64 {
        self.sink.dropped()
    }

    /// The robot.
    pub fn plant(&self) -> &P {
        &self.plant
    }
}
