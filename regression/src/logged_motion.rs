//! What logs say whatever the model: the motion, the measured torques in the band, and the noise of the sensors.

use std::ops::Range;

use nalgebra::SVector;
use tribo_logs::RobotLog;
use tribo_robot::{Arm, mass_matrix};

use crate::column::{Column, FineColumn};
use crate::filter::LANES;
use crate::noise_level::{median, resolution, sensor_share, white_noise_sd};
use crate::{DiagnoseError, MotionSample, ResidualSettings, SignalChain, TorqueResidual};

/// A stretch without a gap.
#[derive(Clone, Debug)]
pub struct Burst {
    /// Samples on the fine grid.
    pub fine: Range<usize>,
    /// Samples after band filter and averaging.
    pub out: Range<usize>,
    /// The log it belongs to.
    pub log: usize,
}

/// Logs on their uniform grids and in the band. One of it serves every model that is held against the logs.
#[derive(Debug)]
pub struct LoggedMotion<const N: usize> {
    /// Motion on the fine grid, before the band filter.
    pub motion: Vec<MotionSample<N>>,
    /// Measured torque at the same stamps, unfiltered (Nm).
    pub raw_nm: Vec<SVector<f64, N>>,
    /// Measured torque at the links at the same stamps, smoothed (Nm), where every log has it.
    pub raw_link_nm: Option<Vec<SVector<f64, N>>>,
    /// Stretches without a gap.
    pub bursts: Vec<Burst>,
    /// The signal chain of each log.
    pub chains: Vec<SignalChain>,
    /// Time of the output samples (s), within their log.
    pub time_s: Vec<f64>,
    /// Filtered velocity (rad/s) per joint.
    pub qd: [Vec<f64>; N],
    /// Filtered position (rad) per joint.
    pub q: [Vec<f64>; N],
    /// Filtered measured torque (Nm) per joint.
    pub measured_nm: [Vec<f64>; N],
    /// Smoothed theta − q on the fine grid (rad), with two encoders in every log.
    pub deflection_rad: Option<Vec<SVector<f64, N>>>,
    /// Positions in the middle of the first log (rad).
    pub middle_rad: SVector<f64, N>,
    /// White noise of the torque signal (Nm).
    pub torque_sd_nm: SVector<f64, N>,
    /// White noise of the positions (rad).
    pub position_sd_rad: SVector<f64, N>,
    /// Error of positions by the lattice of their encoder (rad).
    pub lattice_sd_rad: SVector<f64, N>,
    /// Samples on the fine grid in which a joint stops for a moment, with those before and after.
    pub short_rests: [Vec<Range<usize>>; N],
    /// Noise of the smoothed velocity (rad/s).
    pub velocity_sd_rad_s: SVector<f64, N>,
    /// White noise of the velocity in the band (rad/s).
    pub velocity_sd_in_band_rad_s: SVector<f64, N>,
    /// White noise of the acceleration in the band (rad/s²).
    pub acceleration_sd_rad_s2: SVector<f64, N>,
    /// Error of the velocity of a slow joint by the lattice of its encoder (rad/s).
    pub coarse_velocity_rad_s: SVector<f64, N>,
    /// RMS of the torque sensor's noise in the band (Nm).
    pub torque_floor_nm: SVector<f64, N>,
    /// Stretches too short for the filters.
    pub skipped_bursts: usize,
    /// Whether link-side torque was measured too: the residual is that of the transmission, no rigid body in it.
    pub transmission: bool,
}

/// Output samples over the band: 2.5 per period of its cut-off.
const SAMPLES_PER_BAND: f64 = 2.5;
/// Most output samples per joint; longer logs are averaged further.
const MOST_SAMPLES: f64 = 15_000.0;
/// Band limits (Hz).
const BAND_HZ: [f64; 2] = [6.0, 60.0];
/// Highest band over the sample rate.
const HIGHEST_BAND: f64 = 0.3;

impl<const N: usize> LoggedMotion<N> {
    /// Resamples and filters the logs; `band_hz` `None` chooses the band from the noise, which inertias of `arm` weigh.
    ///
    /// # Errors
    /// [`DiagnoseError`] of logs of other arms, or too short for the band.
    #[inline(never)]
    pub fn of_logs(logs: &[RobotLog], arm: &Arm<N>, band_hz: Option<f64>) -> Result<Self, DiagnoseError> {
        for (index, log) in logs.iter().enumerate() {
            if log.joints() != N {
                return Err(DiagnoseError::JointCount { log: index, got: log.joints(), expected: N });
            }
        }
        let mean_square = |of: &dyn Fn(&RobotLog, usize) -> f64| {
            SVector::<f64, N>::from_fn(|j, _| {
                (logs.iter().map(|log| of(log, j).powi(2)).sum::<f64>() / logs.len().max(1) as f64).sqrt()
            })
        };
        let torque_sd_nm = mean_square(&|log, j| {
            let torque = &log.tau_j_nm[j];
            let share = log.tau_j_d_nm.as_ref().map_or(1.0, |command| sensor_share(&log.time_s, torque, &command[j]));
            white_noise_sd(&log.time_s, torque) * share
        });
        let position_sd_rad = mean_square(&|log, j| white_noise_sd(&log.time_s, &log.q_rad[j]));
        let lattice_sd_rad = mean_square(&|log, j| resolution(&log.q_rad[j]) / 12f64.sqrt());
        let rate_hz =
            logs.iter().filter_map(|log| tribo_logs::median_period_s(&log.time_s)).fold(0.0, f64::max).recip();
        let middle_rad = logs.first().map_or_else(SVector::zeros, |log| {
            let middle = log.rows() / 2;
            SVector::from_fn(|j, _| log.q_rad[j][middle])
        });
        let band_hz = band_hz.unwrap_or_else(|| {
            let inertia = mass_matrix(arm, &middle_rad).diagonal();
            band_from_noise(&torque_sd_nm, &position_sd_rad, &inertia, rate_hz)
        });
        // Pauses between bursts do not count.
        let duration_s: f64 =
            logs.iter().map(|log| log.rows() as f64 * tribo_logs::median_period_s(&log.time_s).unwrap_or(0.0)).sum();

        let transmission = logs.iter().all(|log| log.tau_link_nm.is_some());
        let mut motion = Self {
            motion: Vec::new(),
            raw_nm: Vec::new(),
            raw_link_nm: transmission.then(Vec::new),
            bursts: Vec::new(),
            chains: Vec::new(),
            time_s: Vec::new(),
            qd: std::array::from_fn(|_| Vec::new()),
            q: std::array::from_fn(|_| Vec::new()),
            measured_nm: std::array::from_fn(|_| Vec::new()),
            deflection_rad: None,
            middle_rad,
            torque_sd_nm,
            position_sd_rad,
            lattice_sd_rad,
            short_rests: std::array::from_fn(|_| Vec::new()),
            velocity_sd_rad_s: SVector::zeros(),
            velocity_sd_in_band_rad_s: SVector::zeros(),
            acceleration_sd_rad_s2: SVector::zeros(),
            coarse_velocity_rad_s: SVector::zeros(),
            torque_floor_nm: SVector::zeros(),
            skipped_bursts: 0,
            transmission,
        };
        let mut deflection = Some(Vec::new());
        for (index, log) in logs.iter().enumerate() {
            let log_rate_hz = tribo_logs::median_period_s(&log.time_s).unwrap_or(1.0).recip();
            // A 30 Hz log carries 10 Hz at most; the average follows the band, or the number of samples allowed.
            let band_hz = band_hz.min(HIGHEST_BAND * log_rate_hz);
            let by_band = log_rate_hz / (SAMPLES_PER_BAND * band_hz);
            let by_size = duration_s * log_rate_hz / MOST_SAMPLES;
            let average_samples = by_band.max(by_size).floor().max(1.0) as usize;
            let settings = ResidualSettings { band_hz, average_samples, ..ResidualSettings::default() };
            let bursts = TorqueResidual::without_model(log, &settings)?;
            match (bursts.deflection_rad(), &mut deflection) {
                (Some(bursts), Some(all)) => all.extend(bursts.iter().flatten().copied()),
                _ => deflection = None,
            }
            motion.append(index, bursts);
        }
        motion.deflection_rad = deflection.filter(|all| !all.is_empty());
        motion.q = motion.filter_joints(|j| motion.motion.iter().map(|at| at.q[j]).collect());
        motion.find_short_rests();
        motion.set_noise();
        Ok(motion)
    }

    /// The samples of one log.
    fn append(&mut self, log: usize, bursts: TorqueResidual<N>) {
        let [mut fine, mut out] = [self.motion.len(), self.time_s.len()];
        for (samples, kept) in bursts.motion().iter().zip(&bursts.bursts) {
            self.bursts.push(Burst { fine: fine..fine + samples.len(), out: out..out + kept.len(), log });
            (fine, out) = (fine + samples.len(), out + kept.len());
        }
        self.time_s.extend(&bursts.time_s);
        for j in 0..N {
            self.measured_nm[j].extend(&bursts.measured_nm[j]);
            self.qd[j].extend(&bursts.qd_rad_s[j]);
        }
        if let (Some(all), Some(bursts)) = (&mut self.raw_link_nm, bursts.link_torque_nm()) {
            all.extend(bursts.iter().flatten());
        }
        self.chains.push(bursts.chain.clone());
        self.skipped_bursts += bursts.skipped_bursts;
        let (motion, raw_nm) = bursts.into_motion_and_raw_torque_nm();
        motion.into_iter().for_each(|burst| append(&mut self.motion, burst));
        raw_nm.into_iter().for_each(|burst| append(&mut self.raw_nm, burst));
    }

    /// Noise of the sensors in the band: of torques, and of positions through derivatives. The error of positions on a coarse lattice is not
    /// white where a joint is slow.
    fn set_noise(&mut self) {
        let Some(chain) = self.chains.first() else { return };
        const STEPS: usize = 400;
        let nyquist_hz = 0.5 * chain.rate_hz;
        let (mut torque, mut velocity, mut velocity_in_band, mut acceleration) = (0.0, 0.0, 0.0, 0.0);
        for step in 0..STEPS {
            let f = nyquist_hz * (step as f64 + 0.5) / STEPS as f64;
            let average = average_gain(f / chain.rate_hz, chain.average_samples);
            let (omega, gain) = (2.0 * std::f64::consts::PI * f, chain.gain(f) * average);
            torque += gain.powi(2);
            acceleration += (omega.powi(2) * gain).powi(2);
            velocity += (omega * chain.smoothing_gain(f)).powi(2);
            velocity_in_band += (omega * gain).powi(2);
        }
        let gain = |squares: f64| (squares / STEPS as f64).sqrt();
        self.velocity_sd_rad_s = self.position_sd_rad * gain(velocity);
        self.velocity_sd_in_band_rad_s = self.position_sd_rad * gain(velocity_in_band);
        self.acceleration_sd_rad_s2 = self.position_sd_rad * gain(acceleration);
        self.coarse_velocity_rad_s = self.lattice_sd_rad * 2.0 * std::f64::consts::PI * chain.band_hz;
        self.torque_floor_nm = self.torque_sd_nm * gain(torque);
    }

    /// Period of the fine grid of a burst (s).
    pub fn period_s(&self, burst: &Burst) -> f64 {
        self.chains[burst.log].rate_hz.recip()
    }

    /// Whether the joint moves at all, against the noise of its encoder.
    pub fn moves(&self, joint: usize) -> bool {
        let fast = 10.0 * self.velocity_sd_rad_s[joint] + 1e-4;
        let moving = self.motion.iter().filter(|at| at.qd[joint].abs() > fast).count();
        moving * 20 > self.motion.len()
    }

    /// A regressor through the same band filter, trim and average as the torques.
    pub fn filter(&self, column: &FineColumn<N>) -> Column<N> {
        let mut columns = self.filter_all(std::slice::from_ref(column));
        columns.pop().unwrap_or_else(Column::zero)
    }

    /// The same of several, side by side.
    pub fn filter_all(&self, columns: &[FineColumn<N>]) -> Vec<Column<N>> {
        let acting: Vec<(usize, usize)> = (0..columns.len())
            .flat_map(|c| (0..N).filter(move |j| columns[c].acts_on(*j)).map(move |j| (c, j)))
            .collect();
        let mut filtered: Vec<Column<N>> = columns.iter().map(|_| Column::zero()).collect();
        let tracks = acting.iter().map(|&(c, j)| columns[c].of_joint(j));
        for (&(c, j), values) in acting.iter().zip(self.filter_own_all(tracks)) {
            filtered[c].rows[j] = Some(std::sync::Arc::new(values));
        }
        filtered
    }

    /// A signal of one joint (any unit) on the fine grid, after band filter and averaging.
    pub fn filter_own(&self, values: &[f64]) -> Vec<f64> {
        self.filter_own_all([values]).pop().unwrap_or_default()
    }

    /// The same of one signal of every joint, side by side.
    pub fn filter_joints(&self, signal: impl Fn(usize) -> Vec<f64>) -> [Vec<f64>; N] {
        let mut filtered = self.filter_own_all((0..N).map(signal)).into_iter();
        std::array::from_fn(|_| filtered.next().unwrap_or_default())
    }

    /// The same of several signals, of which no more are asked for at a time than the filter takes.
    pub fn filter_own_all<S: AsRef<[f64]>>(&self, signals: impl IntoIterator<Item = S>) -> Vec<Vec<f64>> {
        let (mut signals, mut filtered) = (signals.into_iter(), Vec::new());
        loop {
            let few: Vec<S> = signals.by_ref().take(LANES).collect();
            let first = filtered.len();
            filtered.extend(few.iter().map(|_| Vec::with_capacity(self.time_s.len())));
            if few.is_empty() {
                return filtered;
            }
            for burst in &self.bursts {
                let tracks = few.iter().map(|x| &x.as_ref()[burst.fine.clone()]);
                for (column, values) in filtered[first..].iter_mut().zip(self.chains[burst.log].finish_all(tracks)) {
                    column.extend(values);
                }
            }
        }
    }
}

/// Appends without a copy where there is nothing yet.
fn append<T>(all: &mut Vec<T>, more: Vec<T>) {
    if all.is_empty() { *all = more } else { all.extend(more) }
}

/// Gain of the average of m samples at `frequency` (in sample rates).
fn average_gain(frequency: f64, m: usize) -> f64 {
    let x = std::f64::consts::PI * frequency;
    if m <= 1 || x == 0.0 { 1.0 } else { ((m as f64 * x).sin() / (m as f64 * x.sin())).abs() }
}

/// Cut-off at which the noise of the acceleration, through the inertia, is a tenth of the torque noise in the band.
///
/// ```text
/// (M sd_q)² (2π)⁴ fc⁴ / 5 = sd_tau² / 10
/// ```
///
/// The median over the joints, within 6 to 60 Hz and 0.3 of the sample rate.
fn band_from_noise<const N: usize>(
    torque_sd: &SVector<f64, N>,
    position_sd: &SVector<f64, N>,
    inertia: &SVector<f64, N>,
    rate_hz: f64,
) -> f64 {
    let mut bands: Vec<f64> = (0..N)
        .map(|j| {
            let ratio = 0.5 * (torque_sd[j] / (inertia[j] * position_sd[j]).max(1e-12)).powi(2);
            ratio.sqrt().sqrt() / (2.0 * std::f64::consts::PI)
        })
        .filter(|band| band.is_finite())
        .collect();
    let median = median(&mut bands).unwrap_or(BAND_HZ[0]);
    median.clamp(BAND_HZ[0], BAND_HZ[1]).min(HIGHEST_BAND * rate_hz)
}
