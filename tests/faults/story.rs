//! One trial with something broken in it.

use tribo_campaign::TuneConfig;
use tribo_control::TorqueLimiter;
use tribo_friction::FrictionModel;
use tribo_robot::{Plant, PlantLost, SensorFrame};
use tribo_runtime::TickFault;
use tribo_sim::BoxFrictionPlant;
use tribo_tests::{Joints, default_ekf};
use tribo_trial::{AbortReason, CostAccumulator, Trial, TrialMonitor};

/// Tick at which the fault comes: 2 s into the judged part, the arm at full speed.
pub const AT: u64 = 5000;
/// Ticks that are watched after a trial was stopped.
const AFTER: u64 = 3000;
/// Speed below which an arm has come to rest [rad/s].
const REST_RAD_S: f64 = 0.02;
const ROUNDING_NM: f64 = 1e-9;

/// How a story ended.
#[derive(Clone, Copy, Debug)]
pub struct Ending {
    /// Why the trial was stopped, and what the loop itself had to say.
    pub reason: Option<AbortReason>,
    pub fault: Option<TickFault>,
    /// When (s) since the fault came.
    pub after_s: f64,
    /// J of what was judged.
    pub cost: f64,
    /// Largest true speed of a joint before it was stopped [rad/s].
    pub fastest_rad_s: f64,
    /// Whether the arm stood still 3 s after it was stopped, and how far it had gone by then (rad).
    pub at_rest: bool,
    pub went_on_rad: f64,
}

/// The default tuning trial, guard and all, and the true friction of its arm.
pub fn trial() -> (Trial<7>, FrictionModel<7>) {
    let trial = TuneConfig::default().validate::<7>().expect("the default").trial;
    let friction = trial.truth.friction;
    (trial, friction)
}

/// An arm whose frames are tampered with on their way to the loop, and its torques on their way back.
struct BrokenPlant<S, P> {
    inner: BoxFrictionPlant<7>,
    tamper: S,
    power: P,
    ticks: u64,
}

impl<S: FnMut(u64, SensorFrame<7>) -> SensorFrame<7>, P: Fn(u64) -> f64> Plant<7> for BrokenPlant<S, P> {
    fn sense(&mut self) -> Result<SensorFrame<7>, PlantLost> {
        Ok((self.tamper)(self.ticks, self.inner.sample()))
    }

    fn actuate(&mut self, tau_nm: &Joints) {
        self.inner.actuate(&(tau_nm * (self.power)(self.ticks)));
        self.ticks += 1;
    }
}

/// Runs the trial with the friction believed; frames go through `tamper(tick, frame)`, and the arm gets `power(tick)` of the torque.
pub fn tell(
    trial: &Trial<7>,
    friction: &FrictionModel<7>,
    tamper: impl FnMut(u64, SensorFrame<7>) -> SensorFrame<7>,
    power: impl Fn(u64) -> f64,
) -> Ending {
    let mut plant = BrokenPlant { inner: trial.plant(1), tamper, power, ticks: 0 };
    let mut control = trial.control_loop(friction, default_ekf());
    let (mut monitor, mut cost) = (TrialMonitor::new(trial.limits, trial.dt_s), CostAccumulator::new(trial.measure));
    let limits = trial.model.limits;
    let ticks = (trial.reference.total_s() / trial.dt_s).round() as u64;
    let mut ending = Ending {
        reason: None,
        fault: None,
        after_s: 0.0,
        cost: 0.0,
        fastest_rad_s: 0.0,
        at_rest: true,
        went_on_rad: 0.0,
    };
    let (mut last, mut stopped): (Option<Joints>, Option<(u64, Joints)>) = (None, None);
    for tick in 0..ticks + AFTER {
        let record = *control.tick(&mut plant);
        for j in 0..7 {
            let tau = record.command[j];
            assert!(tau.is_finite() && tau.abs() <= limits.tau_max_nm[j], "tick {tick} joint {j}: {tau} Nm");
            let step = last.map_or(0.0, |last| (tau - last[j]).abs());
            assert!(step <= limits.tau_rate_max_nm_s[j] * trial.dt_s + ROUNDING_NM, "tick {tick} joint {j}: {step} Nm");
        }
        last = Some(record.command);
        match stopped {
            None => {
                ending.fastest_rad_s = ending.fastest_rad_s.max(plant.inner.qd().amax());
                if let Some(reason) = monitor.check(&record) {
                    (ending.reason, ending.fault) = (Some(reason), record.fault);
                    ending.after_s = (tick as f64 - AT as f64) * trial.dt_s;
                    stopped = Some((tick, *plant.inner.q()));
                    control.stop(TickFault::Stopped);
                } else if tick == ticks {
                    break;
                } else if record.frame.time_s >= trial.reference.pre_roll_s() {
                    cost.add(&record.estimate.wrench_base);
                }
            }
            Some((at, q)) if tick == at + AFTER => {
                ending.at_rest = plant.inner.qd().amax() < REST_RAD_S;
                ending.went_on_rad = (plant.inner.q() - q).amax();
                break;
            }
            Some(_) => {}
        }
    }
    ending.cost = cost.finish(None, trial.reference.duration_s).total();
    assert!(ending.cost.is_finite());
    ending
}

/// The limiter must be able to say no, or the assertions of every story are empty.
#[test]
fn the_limiter_limits() {
    let mut limiter = TorqueLimiter::new(&tribo_robot::presets::panda().limits);
    assert_eq!(limiter.limit(&Joints::repeat(1e6), &Joints::zeros(), 1e-3).0[0], 87.0);
}
