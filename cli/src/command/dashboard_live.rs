//! A robot in the window: a thread hears it and estimates the wrench, the window draws.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::Instant;

use tribo_dashboard::{LiveFeed, LiveSample, LiveTitle};
use tribo_fci::{Connection, HeardState, sensor_frame};
use tribo_model::AnyModel;
use tribo_runtime::{LONGEST_GAP_PERIODS, MeasuredWrench};
use tribo_trial::{AnyEstimator, EstimatorName, LogEstimator};

use super::live::{heard, preset_of};
use super::{named, show_robot, warn_not_cancelled};
use crate::arguments::{Common, Dashboard};
use crate::failure::BadInput;

/// Period of the states (s).
const PERIOD_S: f64 = 1e-3;

/// A robot that is being heard.
pub struct Watching {
    /// What the window takes from.
    pub feed: LiveFeed,
    over: Arc<AtomicBool>,
    thread: JoinHandle<()>,
}

impl Watching {
    /// Connects, and hears the robot from now on.
    pub fn begin(host: &str, arguments: &Dashboard, common: &Common) -> anyhow::Result<Self> {
        let name: EstimatorName = named(&arguments.residual)?;
        let mut choice = arguments.of.choice()?;
        let given = choice.given()?;
        let connection = heard(host)?;
        choice.torque_side = tribo_sim::TorqueSide::Link;
        choice.robot.get_or_insert_with(|| preset_of(connection.version()).to_owned());
        let (file, model) = given.map_or_else(|| choice.bare(Path::new(""), 7, &[]), Ok)?;
        show_robot(&file, common);
        let AnyModel::Seven(model) = model else {
            return Err(BadInput("a Franka has seven joints".to_owned()).into());
        };
        let by_name = LogEstimator::new(&model);
        warn_not_cancelled(&by_name.controller_model().not_cancelled, &model.robot.arm.joint_names, common);
        let estimator = by_name.measured(name)?;
        let robot = model.robot.arm.name.clone();
        let title = LiveTitle { host: host.to_owned(), robot, estimator: name.as_str().to_owned() };
        let feed = LiveFeed::new(title, model.robot.arm.clone());
        let over = Arc::new(AtomicBool::new(false));
        let (to, until) = (feed.clone(), Arc::clone(&over));
        let thread = std::thread::spawn(move || hear(&connection, estimator, &to, &until));
        Ok(Self { feed, over, thread })
    }

    /// Lets the robot go.
    pub fn end(self) {
        self.over.store(true, Ordering::Relaxed);
        // A thread that panicked has said so.
        let _ = self.thread.join();
    }
}

/// Hears states until it is over or the robot is gone.
fn hear(connection: &Connection, estimator: MeasuredWrench<7, AnyEstimator<7>>, feed: &LiveFeed, over: &AtomicBool) {
    let mut listener = Listener { estimator, last: None, status: String::new() };
    let heard = connection.watch(|state| {
        listener.take(state, Instant::now(), feed);
        !over.load(Ordering::Relaxed)
    });
    if let Err(error) = heard {
        feed.end(error.to_string());
    }
}

/// What is kept from state to state.
struct Listener {
    estimator: MeasuredWrench<7, AnyEstimator<7>>,
    /// Time of the last state by the robot's clock (s) and by ours.
    last: Option<(f64, Instant)>,
    status: String,
}

impl Listener {
    fn take(&mut self, state: &HeardState, arrived: Instant, feed: &LiveFeed) {
        let status = status(state);
        if status != self.status {
            feed.tell(status.clone());
            self.status = status;
        }
        let frame = sensor_frame(state);
        let since_s = self.last.map(|(time_s, _)| frame.time_s - time_s);
        // A state that comes twice is one.
        if since_s == Some(0.0) {
            return;
        }
        let since_last_ms = self.last.map_or(f64::NAN, |(_, at)| (arrived - at).as_secs_f64() * 1e3);
        self.last = Some((frame.time_s, arrived));
        let started = Instant::now();
        let estimate = match since_s {
            Some(since_s) if since_s > 0.0 && since_s < LONGEST_GAP_PERIODS * PERIOD_S => {
                Some(self.estimator.step(&frame, None))
            }
            _ => {
                self.estimator.begin(&frame);
                None
            }
        };
        let estimator_us = started.elapsed().as_secs_f64() * 1e6;
        let estimate = estimate.filter(|estimate| self.estimator.has_settled() && estimate.fault.is_none());
        feed.push(LiveSample {
            time_s: frame.time_s,
            q_rad: state.q.to_vec(),
            dq_rad_s: state.dq.to_vec(),
            tau_j_nm: state.tau_J.to_vec(),
            wrench: estimate.as_ref().map(|estimate| estimate.wrench_base.to_force_moment()),
            limits95: estimate.as_ref().map(|estimate| {
                let ends = estimate.interval95();
                [ends.lower, ends.upper].map(|end| end.to_force_moment())
            }),
            own_wrench: state.O_F_ext_hat_K,
            since_last_ms,
            estimator_us,
        });
    }
}

/// Mode and errors.
fn status(state: &HeardState) -> String {
    let mode = format!("{:?}", state.robot_mode);
    if state.current_errors.any() { format!("{mode} {}", state.current_errors) } else { mode }
}
