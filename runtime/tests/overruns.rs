//! Injected delays: which commands still go out, when the loop gives up, and what the arm does then.
//!
//! On a clock of our own every delay is exact; the last story runs on the computer's.

use std::cell::Cell;
use std::rc::Rc;

use nalgebra::SVector;
use tribo_control::{GuardSettings, ImpedanceSettings, PAPER_PHASES_RAD, SinusoidReference};
use tribo_ekf::{WrenchEkf, WrenchEkfSettings};
use tribo_friction::{Compensator, VelocitySource};
use tribo_robot::{Kinematics, Plant, PlantLost, SensorFrame, gravity_torque, presets};
use tribo_runtime::{
    Clock, ControlLoop, LoopSettings, LoopTiming, MonotonicClock, OverrunPolicy, RealTimeLoop, RecordDrain, TickFault,
    record_ring,
};
use tribo_sim::{BoxFrictionPlant, Sensors, Truth};

const PERIOD_NS: u64 = 1_000_000;
/// What an undisturbed tick takes on the fake clock.
const TICK_NS: u64 = 20_000;
/// In the swing of the trajectory.
const SWINGING: u64 = 6_000;

type Joints = SVector<f64, 7>;

/// A clock that moves only when somebody waits for it or works.
#[derive(Clone, Debug, Default)]
struct FakeClock(Rc<Cell<u64>>);

impl FakeClock {
    fn spend(&self, ns: u64) {
        self.0.set(self.0.get() + ns);
    }
}

impl Clock for FakeClock {
    fn now_ns(&self) -> u64 {
        self.0.get()
    }

    fn sleep_until_ns(&self, at_ns: u64) {
        self.0.set(self.0.get().max(at_ns));
    }
}

/// The simulated arm on a bus that is slow at times; remembers what it was sent.
#[derive(Debug)]
struct SlowBus<W> {
    arm: BoxFrictionPlant<7>,
    wait: W,
    senses: u64,
    sent: Vec<Joints>,
    fastest: f64,
}

impl<W: FnMut(u64)> Plant<7> for SlowBus<W> {
    fn sense(&mut self) -> Result<SensorFrame<7>, PlantLost> {
        // The first reading is the loop's own, before its first period.
        if let Some(tick) = self.senses.checked_sub(1) {
            (self.wait)(tick);
        }
        self.senses += 1;
        self.arm.sense()
    }

    fn actuate(&mut self, tau_nm: &Joints) {
        self.sent.push(*tau_nm);
        self.arm.actuate(tau_nm);
        let limits = presets::panda().limits;
        self.fastest = self.fastest.max(self.arm.qd().component_div(&limits.qd_max_rad_s).amax());
    }
}

type Loop<W, C> = RealTimeLoop<7, WrenchEkf, SlowBus<W>, C>;

fn rig<W: FnMut(u64), C: Clock>(clock: C, wait: W, ring: usize) -> (Loop<W, C>, RecordDrain<7>) {
    let (arm, q) = (presets::panda(), presets::panda_ready_pose());
    let truth = Truth::panda_coulomb_viscous();
    let settings = LoopSettings {
        impedance: ImpedanceSettings::default(),
        reference: SinusoidReference::paper(Kinematics::at(&arm, &q).base_from_flange(), PAPER_PHASES_RAD),
        compensator: Compensator::new(truth.friction, VelocitySource::Hybrid),
        guard: Some(GuardSettings::default()),
        dt_s: 1e-3,
    };
    let held = gravity_torque(&arm, &q);
    let control = ControlLoop::new(arm, q, settings, WrenchEkf::new(WrenchEkfSettings::default()));
    let arm = BoxFrictionPlant::new(truth, Sensors::default(), q, 1);
    let plant = SlowBus { arm, wait, senses: 0, sent: Vec::new(), fastest: 0.0 };
    let (sink, drain) = record_ring(ring);
    let timing = LoopTiming::new().expect("valid bounds");
    (
        RealTimeLoop::new(control, plant, clock, OverrunPolicy::default(), sink, timing, held)
            .expect("a simulated arm answers"),
        drain,
    )
}

/// Every tick takes [`TICK_NS`], those of `stalls` so much longer (ns).
fn on_fake_clock(stalls: &'static [(u64, u64)]) -> (Loop<impl FnMut(u64), FakeClock>, RecordDrain<7>, FakeClock) {
    let clock = FakeClock::default();
    let bus = clock.clone();
    let wait = move |tick| {
        let stall = stalls.iter().find(|(at, _)| *at == tick).map_or(0, |(_, ns)| *ns);
        bus.spend(TICK_NS + stall);
    };
    let (real_time, drain) = rig(clock.clone(), wait, 20_000);
    (real_time, drain, clock)
}

fn inside_limits(q: &Joints) -> bool {
    presets::panda().first_joint_outside_limits(q).is_none()
}

#[test]
fn on_time_nothing_is_held_and_waiting_does_not_drift() {
    let (mut real_time, _, clock) = on_fake_clock(&[]);
    real_time.run(1000);
    assert_eq!((real_time.ticks(), real_time.overruns().missed(), real_time.faulted_at()), (1000, 0, None));
    // The first period began one period after the start, the last ended a tick after it began.
    assert_eq!(clock.now_ns(), 1000 * PERIOD_NS + TICK_NS);
    let timing = real_time.timing();
    assert_eq!(timing.wake_up.max_us(), 0.0);
    assert_eq!((timing.tick.mean_us(), timing.response.max_us()), (20.0, 20.0));
    let sent = &real_time.plant().sent;
    assert_eq!(sent.len(), 1000);
    assert!(sent[500..].windows(2).all(|pair| pair[0] != pair[1]), "every period has its own command");
}

/// One period without a command: the last one is sent again, the late one never.
#[test]
fn one_missed_deadline_is_held() {
    let (mut real_time, mut drain, _) = on_fake_clock(&[(SWINGING, 1_500_000)]);
    real_time.run(SWINGING + 1000);
    assert_eq!((real_time.overruns().missed(), real_time.faulted_at()), (1, None));
    let at = SWINGING as usize;
    let sent = &real_time.plant().sent;
    assert_eq!(sent[at], sent[at - 1], "held");
    assert_ne!(sent[at + 1], sent[at], "and then control goes on");
    let records: Vec<_> = std::iter::from_fn(|| drain.pop()).collect();
    assert!(records.iter().all(|(_, record)| record.fault.is_none()));
    assert_ne!(records[at].1.command, sent[at], "the late command was another one");
    // The tick after the late one begins half a period late, and is in time.
    assert_eq!(real_time.timing().wake_up.max_us(), 520.0);
    assert!(real_time.plant().fastest < 1.0);
}

/// Three milliseconds: three deadlines at once, which is what the default does not bear.
#[test]
fn a_stall_of_three_periods_stops_the_arm_for_good() {
    let (mut real_time, mut drain, _) = on_fake_clock(&[(SWINGING, 3_000_000)]);
    real_time.run(SWINGING + 4000);
    assert_eq!((real_time.faulted_at(), real_time.overruns().missed()), (Some(SWINGING), 3));
    let (before, at) = (SWINGING as usize - 1, SWINGING as usize);
    let plant = real_time.plant();
    assert!(plant.sent[at..at + 3].iter().all(|torque| *torque == plant.sent[before]), "held while nobody decided");

    let records: Vec<_> = std::iter::from_fn(|| drain.pop()).map(|(_, record)| record).collect();
    assert!(records[..=at].iter().all(|record| record.fault.is_none()));
    assert!(
        records[at + 1..].iter().all(|record| record.fault == Some(TickFault::DeadlineMissed)),
        "there is no way back"
    );
    assert!(plant.fastest < 0.2, "no joint beyond a fifth of its speed: {}", plant.fastest);
    assert!(inside_limits(plant.arm.q()) && plant.arm.qd().amax() < 1e-3, "it stands: {}", plant.arm.qd());
}

/// In a row means one after the other: two late ticks, one in time, two late ones go by; three do not.
#[test]
fn three_late_ticks_in_a_row_fault_and_two_do_not() {
    const LATE: u64 = 1_100_000;
    let (mut twice, _, _) = on_fake_clock(&[(100, LATE), (101, LATE - 100_000), (200, LATE), (201, LATE - 100_000)]);
    twice.run(1000);
    assert_eq!((twice.overruns().missed(), twice.overruns().longest_row(), twice.faulted_at()), (4, 2, None));
    let (mut thrice, _, _) = on_fake_clock(&[(100, LATE), (101, LATE - 100_000), (102, LATE - 100_000)]);
    thrice.run(1000);
    assert_eq!((thrice.overruns().missed(), thrice.faulted_at()), (3, Some(102)));
}

/// A torque must be sent even if the very first tick is late: the one the loop was given.
#[test]
fn before_the_first_command_the_arm_is_held() {
    let (mut real_time, _, _) = on_fake_clock(&[(0, 1_000_000)]);
    real_time.run(2);
    assert_eq!(real_time.plant().sent[0], gravity_torque(&presets::panda(), &presets::panda_ready_pose()));
}

/// Nobody reads: the ring keeps the oldest records, both ends agree about the rest, and the loop does not care.
#[test]
fn a_full_ring_loses_records_and_says_how_many() {
    let (mut real_time, mut drain) = rig(FakeClock::default(), |_| (), 64);
    real_time.run(100);
    assert_eq!(real_time.dropped(), 36);
    assert!(!drain.is_finished());
    let taken: Vec<u64> = std::iter::from_fn(|| drain.pop()).map(|(tick, _)| tick).collect();
    assert_eq!(taken, (0..64).collect::<Vec<_>>());
    real_time.run(10);
    assert_eq!(drain.pop().map(|(tick, _)| tick), Some(100), "the gap shows in the numbers");
    let ticks = real_time.ticks();
    drop(real_time);
    while drain.pop().is_some() {}
    assert!(drain.is_finished());
    assert_eq!((drain.received(), drain.lost_of(ticks)), (74, 36));
}

/// On the computer's clock, with the records going to another thread. What else the computer does may stop the loop
/// earlier; that it stops at the stall at the latest, and how it stands then, does not depend on that.
#[test]
fn on_the_real_clock_a_stall_stops_the_arm() {
    const STALLED: u64 = 150;
    let clock = MonotonicClock;
    let wait = |tick| {
        if tick == STALLED {
            clock.sleep_until_ns(clock.now_ns() + 20_000_000);
        }
    };
    let (mut real_time, mut drain) = rig(clock, wait, 4096);
    let started_ns = clock.now_ns();
    let (ticks, records) = std::thread::scope(|scope| {
        let reader = scope.spawn(move || {
            let mut records = Vec::new();
            while !drain.is_finished() {
                records.extend(std::iter::from_fn(|| drain.pop()));
                std::thread::sleep(std::time::Duration::from_millis(1));
            }
            records
        });
        real_time.run(400);
        assert!(clock.now_ns() - started_ns >= 399 * PERIOD_NS, "no period is shorter than it is");
        assert!(real_time.overruns().missed() >= 20);
        assert!(inside_limits(real_time.plant().arm.q()) && real_time.plant().arm.qd().amax() < 1e-2);
        let (ticks, faulted_at, dropped) = (real_time.ticks(), real_time.faulted_at(), real_time.dropped());
        assert!(faulted_at.is_some_and(|tick| tick <= STALLED), "{faulted_at:?}");
        drop(real_time);
        let records = reader.join().expect("the reader ends");
        assert_eq!(dropped, 0);
        let after = faulted_at.unwrap_or_default() + 1;
        assert!(records.iter().filter(|(tick, _)| *tick >= after).all(|(_, record)| record.fault.is_some()));
        (ticks, records.len() as u64)
    });
    assert_eq!(ticks, records, "every record arrived");
}
