//! From a truth and a motion to a log.

use nalgebra::SVector;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;
use tribo_logs::{LogColumns, RobotLog};

use super::internal_motion::InternalMotion;
use super::settings::in_range;
use super::true_torque::TrueTorque;
use super::velocity_filter::VelocityFilter;
use super::{Recording, RecordingError};
use crate::excitation::JointTrajectory;
use crate::hidden::{Hidden, JointBristles, JointThermal};
use crate::{TorqueSide, Truth};

/// A torque (Nm) of log time (s), q (rad), q̇ [rad/s] and q̈ [rad/s²].
pub type ExtraTorque<'a, const N: usize> =
    dyn Fn(f64, &SVector<f64, N>, &SVector<f64, N>, &SVector<f64, N>) -> SVector<f64, N> + 'a;

/// Rate at which the drive differentiates its encoder (Hz).
const DRIVE_RATE_HZ: f64 = 1000.0;
/// Jitter is cut at this part of a period, so rows keep their order.
const LARGEST_JITTER: f64 = 0.2;
/// Shortest rise of a contact on an elastic joint (s).
const ELASTIC_EDGE_S: f64 = 0.02;
/// Warming of joints without an effect of their own (s).
const PLAIN_TIME_CONSTANT_S: f64 = 1200.0;
/// Noise of the temperatures (K).
const TEMPERATURE_SD_K: f64 = 0.05;

/// One cycle of the motion every `every_s` is logged; in between the arm works on in the same cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Session {
    /// From the start of one logged cycle to the next (s); longer than the cycle.
    pub every_s: f64,
    /// From the first start to the last possible one (s).
    pub duration_s: f64,
}

impl Default for Session {
    /// Two hours, a cycle every five minutes: the warm-up of a robot, from cold.
    fn default() -> Self {
        Self { every_s: 300.0, duration_s: 7200.0 }
    }
}

/// Makes logs of one truth.
#[derive(Clone, Copy)]
pub struct Recorder<'a, const N: usize> {
    /// What is true.
    pub truth: &'a Truth<N>,
    /// Width of the smooth sign of friction laws [rad/s].
    pub smoothing_rad_s: f64,
    /// How the log is taken.
    pub recording: Recording,
    /// A torque beyond the vocabulary of effects.
    pub extra: Option<&'a ExtraTorque<'a, N>>,
}

/// One log of the motion from its start to its end. The same seed gives the same log.
///
/// # Errors
/// A setting or an effect out of range, or a motion too short for two rows.
pub fn record<const N: usize>(
    truth: &Truth<N>,
    smoothing_rad_s: f64,
    trajectory: &dyn JointTrajectory<N>,
    recording: &Recording,
    seed: u64,
) -> Result<RobotLog, RecordingError> {
    Recorder { truth, smoothing_rad_s, recording: *recording, extra: None }.record(trajectory, seed)
}

impl<const N: usize> Recorder<'_, N> {
    /// One log of the motion from its start to its end, the joints cold at its start.
    ///
    /// # Errors
    /// As [`record`].
    pub fn record(&self, trajectory: &dyn JointTrajectory<N>, seed: u64) -> Result<RobotLog, RecordingError> {
        self.bursts(trajectory, &[0.0], seed)
    }

    /// One log with a burst per logged cycle, the joints cold at its start and warming up through it.
    ///
    /// # Errors
    /// As [`record`], or if the cycle does not fit between two bursts.
    pub fn record_session(
        &self,
        trajectory: &dyn JointTrajectory<N>,
        session: &Session,
        seed: u64,
    ) -> Result<RobotLog, RecordingError> {
        self.recording.validate()?;
        let shortest_s = trajectory.duration_s() + 3.0 / self.recording.rate_hz;
        in_range("every_s", session.every_s, shortest_s, 1e9, "the cycle and three periods, or longer")?;
        in_range("duration_s", session.duration_s, 0.0, 1e9, "0..1e9")?;
        let last = (session.duration_s / session.every_s + 1e-9).floor() as usize;
        let starts_s: Vec<f64> = (0..=last).map(|k| k as f64 * session.every_s).collect();
        self.bursts(trajectory, &starts_s, seed)
    }

    fn bursts(
        &self,
        trajectory: &dyn JointTrajectory<N>,
        starts_s: &[f64],
        seed: u64,
    ) -> Result<RobotLog, RecordingError> {
        self.recording.validate()?;
        in_range("smoothing_rad_s", self.smoothing_rad_s, 0.0, 10.0, "0..10")?;
        self.truth.validate()?;
        let mut rng = Pcg64::seed_from_u64(seed);
        let mut rows = Rows::new(&self.recording);
        let mut bristles = [JointBristles::default(); N];
        for &start_s in starts_s {
            bristles = self.burst(trajectory, start_s, &bristles, &mut rng, &mut rows);
        }
        Ok(rows.columns.validate()?)
    }

    /// Adds one cycle that starts at `start_s` (s) of the log; returns the bristles at its end, where the next begins.
    #[inline(never)]
    fn burst(
        &self,
        trajectory: &dyn JointTrajectory<N>,
        start_s: f64,
        bristles: &[JointBristles; N],
        rng: &mut Pcg64,
        rows: &mut Rows<N>,
    ) -> [JointBristles; N] {
        let recording = &self.recording;
        let torque = self.true_torque(trajectory, start_s);
        let (delay_s, skew_s) = (torque.hidden.delay_s, recording.encoder_skew_s);
        let earliest_s = -delay_s.max(skew_s).max(0.0);
        let latest_s = trajectory.duration_s() - delay_s.min(skew_s).min(0.0);
        let internal = InternalMotion::integrate(&torque, earliest_s, latest_s, bristles);

        let period_s = 1.0 / recording.rate_hz;
        let count = (trajectory.duration_s() * recording.rate_hz * (1.0 + 1e-12)).floor() as usize + 1;
        let mut last_s = 0.0;
        let mut sensors = Encoders::new(recording, &torque, &internal, rng);
        for k in 0..count {
            let jitter_s = |sd: f64, rng: &mut Pcg64| {
                (sd * rng.sample::<f64, _>(StandardNormal)).clamp(-LARGEST_JITTER * period_s, LARGEST_JITTER * period_s)
            };
            let time_s = (k as f64 * period_s + jitter_s(recording.sampling_jitter_sd_s, rng)).max(last_s);
            let stamp_s = start_s + time_s + jitter_s(recording.stamp_jitter_sd_s, rng);
            sensors.advance(last_s, time_s, &torque, &internal, rng);
            last_s = time_s;
            let sensed_s = time_s - delay_s;
            let tau = torque.at(sensed_s, &internal.at(sensed_s)) + noise(recording.torque_sd_nm, rng);
            let tau = quantised(tau, recording.torque_resolution_nm);
            let repeated = k > 0 && rng.random_bool(recording.repeated_fraction);
            rows.push(stamp_s, &sensors, &tau, repeated);
            if recording.temperatures {
                rows.push_temperatures(start_s + time_s, &torque.hidden, recording, rng);
            }
        }
        internal.at(trajectory.duration_s()).bristles
    }

    pub(super) fn true_torque<'b>(
        &'b self,
        trajectory: &'b dyn JointTrajectory<N>,
        log_offset_s: f64,
    ) -> TrueTorque<'b, N> {
        let hidden = Hidden::of(self.truth);
        let elastic = hidden.elasticity.iter().any(Option::is_some);
        TrueTorque {
            truth: self.truth,
            link_arm: hidden.arm.clone().link_side(),
            rotor_inertia: match self.recording.torque_side {
                TorqueSide::Motor => hidden.arm.rotor_inertia_kg_m2,
                TorqueSide::Link => SVector::zeros(),
            },
            hidden,
            trajectory,
            smoothing_rad_s: self.smoothing_rad_s,
            dual_encoder: self.recording.dual_encoder,
            contact_edge_s: self.recording.contact_edge_s.max(if elastic { ELASTIC_EDGE_S } else { 0.0 }),
            log_offset_s,
            extra: self.extra,
        }
    }
}

/// The encoders between two rows: every tick of the drive is measured, the last one is logged.
struct Encoders<const N: usize> {
    recording: Recording,
    q: SVector<f64, N>,
    theta: SVector<f64, N>,
    q_filter: VelocityFilter<N>,
    theta_filter: VelocityFilter<N>,
}

impl<const N: usize> Encoders<N> {
    fn new(recording: &Recording, torque: &TrueTorque<'_, N>, internal: &InternalMotion<N>, rng: &mut Pcg64) -> Self {
        let state = torque.trajectory.at(0.0);
        let q = quantised(state.q + noise(recording.encoder_sd_rad, rng), recording.encoder_resolution_rad);
        let theta = if recording.dual_encoder {
            let read_s = -recording.encoder_skew_s;
            let theta = torque.motor_angle(read_s, &internal.at(read_s));
            quantised(theta + noise(recording.motor_encoder_sd_rad, rng), recording.encoder_resolution_rad)
        } else {
            q
        };
        let filter = |angle| VelocityFilter::new(recording.velocity_cutoff_hz, angle, state.qd);
        Self { recording: *recording, q, theta, q_filter: filter(q), theta_filter: filter(theta) }
    }

    /// Ticks from `last_s` to `time_s` (s).
    fn advance(
        &mut self,
        last_s: f64,
        time_s: f64,
        torque: &TrueTorque<'_, N>,
        internal: &InternalMotion<N>,
        rng: &mut Pcg64,
    ) {
        let recording = &self.recording;
        if time_s <= last_s {
            return;
        }
        let ticks = ((time_s - last_s) * DRIVE_RATE_HZ).round().max(1.0);
        let dt_s = (time_s - last_s) / ticks;
        for tick in (0..ticks as usize).rev() {
            let tick_s = time_s - tick as f64 * dt_s;
            let q = torque.trajectory.at(tick_s).q + noise(recording.encoder_sd_rad, rng);
            self.q = quantised(q, recording.encoder_resolution_rad);
            self.q_filter.push(self.q, dt_s);
            if recording.dual_encoder {
                let read_s = tick_s - recording.encoder_skew_s;
                let theta = torque.motor_angle(read_s, &internal.at(read_s));
                let theta = theta + noise(recording.motor_encoder_sd_rad, rng);
                self.theta = quantised(theta, recording.encoder_resolution_rad);
                self.theta_filter.push(self.theta, dt_s);
            }
        }
    }
}

/// The log as it grows.
struct Rows<const N: usize> {
    columns: LogColumns,
}

impl<const N: usize> Rows<N> {
    fn new(recording: &Recording) -> Self {
        let joints = || vec![Vec::new(); N];
        let columns = LogColumns {
            time_s: Vec::new(),
            q_rad: joints(),
            dq_rad_s: joints(),
            tau_j_nm: joints(),
            theta_rad: recording.dual_encoder.then(joints),
            dtheta_rad_s: recording.dual_encoder.then(joints),
            temperature_c: recording.temperatures.then(joints),
            temperature_ambient_c: recording.temperatures.then(Vec::new),
            ..LogColumns::default()
        };
        Self { columns }
    }

    /// A row, or the values of the row before under a new stamp.
    fn push(&mut self, stamp_s: f64, sensors: &Encoders<N>, tau: &SVector<f64, N>, repeated: bool) {
        let columns = &mut self.columns;
        columns.time_s.push(stamp_s);
        let put = |column: &mut Vec<Vec<f64>>, values: &SVector<f64, N>| {
            for j in 0..N {
                let value = if repeated { column[j].last().copied() } else { None };
                column[j].push(value.unwrap_or(values[j]));
            }
        };
        put(&mut columns.q_rad, &sensors.q);
        put(&mut columns.dq_rad_s, &sensors.q_filter.velocity_rad_s);
        put(&mut columns.tau_j_nm, tau);
        if let Some(theta) = &mut columns.theta_rad {
            put(theta, &sensors.theta);
        }
        if let Some(dtheta) = &mut columns.dtheta_rad_s {
            put(dtheta, &sensors.theta_filter.velocity_rad_s);
        }
    }

    /// `ambient + rise (1 − exp(−t/τ))` per joint, τ of its thermal effect or 20 min.
    fn push_temperatures(&mut self, time_s: f64, hidden: &Hidden<N>, recording: &Recording, rng: &mut Pcg64) {
        let noise = noise::<N>(TEMPERATURE_SD_K, rng);
        if let Some(temperatures) = &mut self.columns.temperature_c {
            for j in 0..N {
                let plain = JointThermal { drop_fraction: 0.0, time_constant_s: PLAIN_TIME_CONSTANT_S };
                let warmth = hidden.thermal[j].unwrap_or(plain).warmth(time_s);
                temperatures[j].push(recording.ambient_c + recording.warm_rise_k * warmth + noise[j]);
            }
        }
        if let Some(ambient) = &mut self.columns.temperature_ambient_c {
            ambient.push(recording.ambient_c + TEMPERATURE_SD_K * rng.sample::<f64, _>(StandardNormal));
        }
    }
}

/// White noise; nothing is drawn for the deviation 0.
fn noise<const N: usize>(sd: f64, rng: &mut Pcg64) -> SVector<f64, N> {
    if sd > 0.0 { SVector::from_fn(|_, _| sd * rng.sample::<f64, _>(StandardNormal)) } else { SVector::zeros() }
}

fn quantised<const N: usize>(values: SVector<f64, N>, resolution: f64) -> SVector<f64, N> {
    if resolution > 0.0 { values.map(|value| (value / resolution).round() * resolution) } else { values }
}
