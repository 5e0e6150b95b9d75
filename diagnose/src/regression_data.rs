//! What the candidates are evaluated on: the motion of all logs and what the nominal model makes of it.

use std::ops::Range;
use std::sync::{Arc, OnceLock};

use nalgebra::{SMatrix, SVector};
use rayon::prelude::*;
use tribo_friction::law::smooth_sign;
use tribo_logs::RobotLog;
use tribo_robot::{Kinematics, link_regressor, mass_matrix, rnea};

use crate::column::{Column, FineColumn};
use crate::filter::{Knots, LANES, central_difference};
use crate::noise_level::{resolution, sensor_share, white_noise_sd};
use crate::{DiagnoseError, MotionSample, Nominal, ResidualError, ResidualSettings, SignalChain, TorqueResidual};

/// One stamp on the uniform grid of a burst, before the band filter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample<const N: usize> {
    /// Time (s).
    pub time_s: f64,
    /// Joint positions (rad).
    pub q: SVector<f64, N>,
    /// Joint velocities (rad/s).
    pub qd: SVector<f64, N>,
    /// Joint accelerations (rad/s²).
    pub qdd: SVector<f64, N>,
    /// tanh(qd/smoothing).
    pub sign: SVector<f64, N>,
    /// Torque of the rigid links, without rotors (Nm).
    pub link_nm: SVector<f64, N>,
    /// Friction of the nominal laws (Nm).
    pub friction_nm: SVector<f64, N>,
    /// The nominal model, effects included (Nm).
    pub model_nm: SVector<f64, N>,
    /// Measured torque, unfiltered (Nm).
    pub measured_nm: SVector<f64, N>,
}

/// A stretch without a gap.
#[derive(Clone, Debug)]
pub(crate) struct Burst {
    /// Samples on the fine grid.
    pub fine: Range<usize>,
    /// Samples after band filter and averaging.
    pub out: Range<usize>,
    /// The log it belongs to.
    pub log: usize,
}

/// Everything the candidates read.
#[derive(Debug)]
pub(crate) struct RegressionData<const N: usize> {
    pub nominal: Nominal<N>,
    pub samples: Vec<Sample<N>>,
    pub bursts: Vec<Burst>,
    pub chains: Vec<SignalChain>,
    /// Time of the output samples (s), within their log.
    pub time_s: Vec<f64>,
    /// Filtered velocity (rad/s) per joint.
    pub qd: [Vec<f64>; N],
    /// Filtered position (rad) per joint.
    pub q: [Vec<f64>; N],
    /// Filtered measured torque (Nm) per joint.
    pub measured_nm: [Vec<f64>; N],
    /// Filtered nominal torque (Nm) per joint.
    pub model_nm: [Vec<f64>; N],
    /// Filtered residual (Nm) per joint.
    pub residual_nm: [Vec<f64>; N],
    /// Smoothed theta − q on the fine grid (rad), with two encoders in every log.
    pub deflection_rad: Option<Vec<SVector<f64, N>>>,
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
    /// Error of the velocity of a slow joint by the lattice of its encoder (rad/s).
    pub coarse_velocity_rad_s: SVector<f64, N>,
    /// RMS of all sensor noise in the band (Nm).
    pub noise_floor_nm: SVector<f64, N>,
    /// RMS of the torque sensor's noise in the band (Nm).
    pub torque_floor_nm: SVector<f64, N>,
    pub skipped_bursts: usize,
    /// Whether link-side torque was measured too: the residual is that of the transmission, no rigid body in it.
    pub transmission: bool,
    /// Filtered regressors of every link, ten columns each, on first use.
    link_regressors: OnceLock<Arc<Vec<[Column<N>; 10]>>>,
    /// See [`Self::standing`], on first use.
    standing: [OnceLock<Vec<f64>>; N],
    /// See [`Self::noise_weights`], on first use.
    noise_weights: [OnceLock<Vec<f64>>; N],
}

/// Output samples over the band: 2.5 per period of its cut-off.
const SAMPLES_PER_BAND: f64 = 2.5;
/// Most output samples per joint; longer logs are averaged further.
const MOST_SAMPLES: f64 = 15_000.0;
/// Residual energy with the motor's encoder over that with the joint's, below which the motor's is believed.
const MOTOR_SIDE_GAIN: f64 = 0.98;
/// Velocity over the lattice's error of it from which on a joint counts as creeping.
const CREEPING: f64 = 0.2;
/// Joints slower than this many standard deviations of velocity noise count as standing.
const STANDING_SD: f64 = 4.0;
/// Widths of the smooth sign below which a joint may be stuck.
const STANDING_WIDTHS: f64 = 3.0;
/// Band limits (Hz).
const BAND_HZ: [f64; 2] = [6.0, 60.0];
/// Highest band over the sample rate.
const HIGHEST_BAND: f64 = 0.3;

impl<const N: usize> RegressionData<N> {
    /// Filters the logs and evaluates the nominal model along them; `band_hz` `None` chooses the band from the noise.
    #[inline(never)]
    pub fn of_logs(logs: &[RobotLog], nominal: &Nominal<N>, band_hz: Option<f64>) -> Result<Self, DiagnoseError> {
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
        let middle = logs.first().map(|log| log.rows() / 2).unwrap_or_default();
        let inertia = logs.first().map_or_else(SVector::zeros, |log| {
            let q = SVector::<f64, N>::from_fn(|j, _| log.q_rad[j][middle]);
            mass_matrix(&nominal.arm, &q).diagonal()
        });
        let band_hz = match band_hz {
            Some(band_hz) => band_hz,
            None => band_from_noise(&torque_sd_nm, &position_sd_rad, &inertia, rate_hz),
        };
        // Pauses between bursts do not count.
        let duration_s: f64 =
            logs.iter().map(|log| log.rows() as f64 * tribo_logs::median_period_s(&log.time_s).unwrap_or(0.0)).sum();

        let nominal = &nominal.with_rigid_effects_in_the_arm();
        let mut data = Self {
            nominal: nominal.clone(),
            samples: Vec::new(),
            bursts: Vec::new(),
            chains: Vec::new(),
            time_s: Vec::new(),
            qd: std::array::from_fn(|_| Vec::new()),
            q: std::array::from_fn(|_| Vec::new()),
            measured_nm: std::array::from_fn(|_| Vec::new()),
            model_nm: std::array::from_fn(|_| Vec::new()),
            residual_nm: std::array::from_fn(|_| Vec::new()),
            deflection_rad: None,
            torque_sd_nm,
            position_sd_rad,
            lattice_sd_rad,
            short_rests: std::array::from_fn(|_| Vec::new()),
            velocity_sd_rad_s: SVector::zeros(),
            velocity_sd_in_band_rad_s: SVector::zeros(),
            coarse_velocity_rad_s: SVector::zeros(),
            noise_floor_nm: SVector::zeros(),
            torque_floor_nm: SVector::zeros(),
            skipped_bursts: 0,
            transmission: logs.iter().all(|log| log.tau_link_nm.is_some()),
            link_regressors: OnceLock::new(),
            standing: std::array::from_fn(|_| OnceLock::new()),
            noise_weights: std::array::from_fn(|_| OnceLock::new()),
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
            let rigid = TorqueResidual::without_model(log, &settings)?;
            data.append(index, &rigid)?;
            match (rigid.deflection_rad(), &mut deflection) {
                (Some(bursts), Some(all)) => all.extend(bursts.iter().flatten().copied()),
                _ => deflection = None,
            }
        }
        data.deflection_rad = deflection.filter(|all| !all.is_empty());
        data.find_short_rests();
        if data.nominal.sticks {
            data.bridge_short_rests();
        }
        data.believe_motor_encoders();
        data.add_nominal_effects();
        data.filter_model();
        data.set_noise_floor(&inertia);
        Ok(data)
    }

    /// The samples of one log.
    fn append(&mut self, log: usize, rigid: &TorqueResidual<N>) -> Result<(), ResidualError> {
        let nominal = &self.nominal;
        let link_arm = nominal.arm.clone().link_side();
        self.samples.reserve_exact(rigid.motion().iter().map(Vec::len).sum());
        for (index, (motion, torque)) in rigid.motion().iter().zip(rigid.raw_torque_nm()).enumerate() {
            let start = self.samples.len();
            let link_nm = match rigid.link_torque_nm().filter(|_| self.transmission) {
                Some(bursts) => bursts[index].clone(),
                None => motion.iter().map(|at| rnea(&link_arm, &at.q, &at.qd, &at.qdd)).collect::<Vec<_>>(),
            };
            for (at, link_nm) in motion.iter().zip(&link_nm) {
                if let Some(joint) = (0..N).find(|j| !link_nm[*j].is_finite()) {
                    return Err(ResidualError::ModelNotFinite { joint, time_s: at.time_s });
                }
            }
            self.samples.extend(motion.iter().zip(torque).zip(link_nm).map(|((at, measured), link_nm)| {
                let MotionSample { time_s, q, qd, qdd } = *at;
                let friction_nm = nominal.friction.torque(&qd, nominal.smoothing_rad_s);
                let rotor_nm = nominal.arm.rotor_inertia_kg_m2.component_mul(&qdd);
                let model_nm = link_nm + rotor_nm + friction_nm;
                let sign = qd.map(|v| smooth_sign(v, nominal.smoothing_rad_s));
                Sample { time_s, q, qd, qdd, sign, link_nm, friction_nm, model_nm, measured_nm: *measured }
            }));
            let out = &rigid.bursts[index];
            let first_out = self.bursts.last().map_or(0, |burst: &Burst| burst.out.end);
            self.bursts.push(Burst { fine: start..self.samples.len(), out: first_out..first_out + out.len(), log });
        }
        self.time_s.extend(&rigid.time_s);
        for j in 0..N {
            self.measured_nm[j].extend(&rigid.measured_nm[j]);
            self.qd[j].extend(&rigid.qd_rad_s[j]);
        }
        self.chains.push(rigid.chain.clone());
        self.skipped_bursts += rigid.skipped_bursts;
        Ok(())
    }

    /// Square of the torque noise (Nm²) that velocity noise makes of a joint through the slope of nominal friction, sample by sample.
    fn sign_noise_squares(&self, j: usize) -> Vec<f64> {
        let step = self.velocity_sd_rad_s[j].max(1e-6);
        let friction = self.nominal.sliding_friction(j);
        let [creeping, moving] = [0.0, self.coarse_velocity_rad_s[j]]
            .map(|coarse| self.velocity_sd_in_band_rad_s[j].powi(2) + f64::powi(coarse, 2));
        let square = |at: &Sample<N>| {
            let qd = at.qd[j];
            let slope = (friction.torque_nm(qd + step) - friction.torque_nm(qd - step)) / (2.0 * step);
            // A joint at rest stays on its step of the lattice.
            slope.powi(2) * if qd.abs() > CREEPING * self.coarse_velocity_rad_s[j] { moving } else { creeping }
        };
        self.samples.iter().map(square).collect()
    }

    /// Weight of each output sample of a joint, `σ/√(σ² + σ_f²)`: σ the noise of torque and acceleration in the band, σ_f
    /// what velocity noise adds where the joint turns back.
    pub fn noise_weights(&self, joint: usize) -> &[f64] {
        self.noise_weights[joint].get_or_init(|| {
            let variance = self.filter_own(&self.sign_noise_squares(joint));
            let mean = variance.iter().sum::<f64>() / variance.len().max(1) as f64;
            let elsewhere = (self.noise_floor_nm[joint].powi(2) - mean).max(1e-12);
            variance.iter().map(|v| (elsewhere / (elsewhere + v.max(0.0))).sqrt()).collect()
        })
    }

    /// Share of samples at rest that the band filter sees at each output sample of a joint.
    pub fn standing(&self, joint: usize) -> &[f64] {
        self.standing[joint].get_or_init(|| {
            let threshold =
                (STANDING_SD * self.velocity_sd_rad_s[joint]).max(STANDING_WIDTHS * self.nominal.smoothing_rad_s);
            let stands = |at: &Sample<N>| f64::from(u8::from(at.qd[joint].abs() < threshold));
            self.filter_own(&self.samples.iter().map(stands).collect::<Vec<f64>>())
        })
    }

    /// With two encoders, friction and rotors follow the motor: `f(theta') + Ir theta''` in place of `f(q') + Ir q''`,
    /// joint by joint where that leaves a smaller residual (an elastic joint shows it; a rigid one does not care).
    fn believe_motor_encoders(&mut self) {
        let Some(deflection) = self.deflection_rad.clone() else { return };
        for j in 0..N {
            let mut corrected = self.samples.clone();
            for burst in &self.bursts {
                let dt_s = self.period_s(burst);
                let angle: Vec<f64> = deflection[burst.fine.clone()].iter().map(|d| d[j]).collect();
                let rate = central_difference(&angle, dt_s);
                let acceleration = central_difference(&rate, dt_s);
                for (i, k) in burst.fine.clone().enumerate() {
                    let at = &mut corrected[k];
                    let motor_qd = at.qd[j] + rate[i];
                    let friction_nm = self.nominal.friction.joints[j].torque(motor_qd, self.nominal.smoothing_rad_s);
                    let rotor_nm = self.nominal.arm.rotor_inertia_kg_m2[j] * acceleration[i];
                    at.model_nm[j] += friction_nm - at.friction_nm[j] + rotor_nm;
                    at.friction_nm[j] = friction_nm;
                    at.sign[j] = smooth_sign(motor_qd, self.nominal.smoothing_rad_s);
                }
            }
            let left = |samples: &[Sample<N>]| {
                let model = self.filter_own(&samples.iter().map(|at| at.model_nm[j]).collect::<Vec<f64>>());
                self.measured_nm[j].iter().zip(model).map(|(measured, model)| (measured - model).powi(2)).sum::<f64>()
            };
            if left(&corrected) < MOTOR_SIDE_GAIN * left(&self.samples) {
                self.samples = corrected;
            }
        }
    }

    /// Band filter and residual.
    fn filter_model(&mut self) {
        let position = self.filter(&self.arm_column(|at| at.q));
        let model = self.filter(&self.arm_column(|at| at.model_nm));
        // A joint at 0 all along has no row.
        let samples = self.time_s.len();
        let take =
            |column: Column<N>| column.rows.map(|row| row.map_or_else(|| vec![0.0; samples], Arc::unwrap_or_clone));
        self.q = take(position);
        self.model_nm = take(model);
        for j in 0..N {
            let pairs = self.measured_nm[j].iter().zip(&self.model_nm[j]);
            self.residual_nm[j] = pairs.map(|(measured, model)| measured - model).collect();
        }
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
            filtered[c].rows[j] = Some(Arc::new(values));
        }
        filtered
    }

    /// A signal of one joint (any unit) on the fine grid, after band filter and averaging.
    pub fn filter_own(&self, values: &[f64]) -> Vec<f64> {
        self.filter_own_all([values]).pop().unwrap_or_default()
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

    /// Regressors of every link in its ten inertial parameters, in the band.
    pub fn link_regressors(&self) -> &[[Column<N>; 10]] {
        self.link_regressors.get_or_init(|| Arc::new((0..N).map(|link| self.link_regressor(link)).collect()))
    }

    /// Takes over the regressors of links from data of the same logs: they are a matter of motion, geometry and gravity alone.
    pub fn borrow_regressors(&mut self, other: &Self) {
        let (arm, others) = (&self.nominal.arm, &other.nominal.arm);
        let alike = arm.gravity_m_s2 == others.gravity_m_s2 && self.chains == other.chains;
        if alike && self.time_s == other.time_s {
            self.link_regressors.clone_from(&other.link_regressors);
        }
    }

    /// Link by link, so that those of all links never stand on the fine grid together.
    fn link_regressor(&self, link: usize) -> [Column<N>; 10] {
        let arm = &self.nominal.arm;
        self.filter_smooth(link + 1, |burst| burst.fine.clone(), |at| link_regressor(arm, &at.q, &at.qd, &at.qdd, link))
    }

    /// K columns that are smooth functions of the motion, evaluated at few samples, in the band: of the first joints, within a part of each burst
    /// and zero elsewhere. Joint by joint, so that the columns of all joints never stand on the fine grid together.
    pub fn filter_smooth<const K: usize>(
        &self,
        joints: usize,
        within: impl Fn(&Burst) -> Range<usize>,
        value: impl Fn(&Sample<N>) -> SMatrix<f64, N, K>,
    ) -> [Column<N>; K] {
        let mut filtered: Vec<Vec<Vec<f64>>> = vec![vec![Vec::new(); K]; joints];
        for burst in &self.bursts {
            let (whole, part) = (burst.fine.clone(), within(burst));
            if part.is_empty() {
                filtered.iter_mut().flatten().for_each(|row| row.resize(row.len() + burst.out.len(), 0.0));
                continue;
            }
            let chain = &self.chains[burst.log];
            let knots = Knots::of(part.len(), chain.knot_stride());
            let values: Vec<SMatrix<f64, N, K>> =
                knots.places().map(|k| value(&self.samples[part.start + k])).collect();
            filtered.par_iter_mut().enumerate().for_each(|(j, rows)| {
                let track = |i: usize| {
                    let inside = knots.fill(&values.iter().map(|value| value[(j, i)]).collect::<Vec<f64>>());
                    if part == whole {
                        return inside;
                    }
                    let mut track = vec![0.0; whole.len()];
                    track[part.start - whole.start..part.end - whole.start].copy_from_slice(&inside);
                    track
                };
                rows.iter_mut()
                    .zip(chain.finish_all((0..K).map(track)))
                    .for_each(|(row, finished)| row.extend(finished));
            });
        }
        std::array::from_fn(|i| Column {
            rows: std::array::from_fn(|j| filtered.get_mut(j).map(|joint| Arc::new(std::mem::take(&mut joint[i])))),
        })
    }

    /// A regressor of one joint, sample by sample.
    pub fn joint_column(&self, joint: usize, value: impl Fn(&Sample<N>) -> f64) -> FineColumn<N> {
        FineColumn::Joint(joint, self.samples.iter().map(value).collect())
    }

    /// A regressor of all joints, sample by sample.
    pub fn arm_column(&self, value: impl Fn(&Sample<N>) -> SVector<f64, N>) -> FineColumn<N> {
        FineColumn::Arm(self.samples.iter().map(value).collect())
    }

    /// The Jacobian of the flange at a sample, linear rows first: force then moment map through its transpose.
    pub fn jacobian(&self, at: &Sample<N>) -> SMatrix<f64, 6, N> {
        let angular_first = Kinematics::at(&self.nominal.arm, &at.q).jacobian();
        SMatrix::from_fn(|row, column| angular_first[((row + 3) % 6, column)])
    }

    /// Period of the fine grid of a burst (s).
    pub fn period_s(&self, burst: &Burst) -> f64 {
        self.chains[burst.log].rate_hz.recip()
    }

    /// Whether the joint moves at all, against the noise of its encoder.
    pub fn moves(&self, joint: usize) -> bool {
        let fast = 10.0 * self.velocity_sd_rad_s[joint] + 1e-4;
        let moving = self.samples.iter().filter(|at| at.qd[joint].abs() > fast).count();
        moving * 20 > self.samples.len()
    }

    /// Whether the joint turns one way only, so that dry friction is a constant.
    pub fn moves_one_way(&self, joint: usize) -> bool {
        let count = |way: f64| self.samples.iter().filter(|at| way * at.sign[joint] > 0.9).count();
        self.moves(joint) && count(1.0).min(count(-1.0)) * 50 < self.samples.len()
    }

    /// Sensor noise in the band: torque noise, and position noise through two derivatives and the inertia and through one
    /// and the slope of friction, which is steep where the joint turns back. The error of positions on a coarse
    /// lattice is not white where a joint is slow.
    fn set_noise_floor(&mut self, inertia: &SVector<f64, N>) {
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
        let mean = |sum: f64| sum / STEPS as f64;
        self.velocity_sd_rad_s = self.position_sd_rad * mean(velocity).sqrt();
        self.velocity_sd_in_band_rad_s = self.position_sd_rad * mean(velocity_in_band).sqrt();
        self.coarse_velocity_rad_s = self.lattice_sd_rad * 2.0 * std::f64::consts::PI * chain.band_hz;
        self.noise_floor_nm = SVector::from_fn(|j, _| {
            let squares: f64 = self.sign_noise_squares(j).iter().sum();
            let from_friction = squares / self.samples.len().max(1) as f64;
            let from_torque = self.torque_sd_nm[j].powi(2) * mean(torque);
            let from_position = (inertia[j] * self.position_sd_rad[j]).powi(2) * mean(acceleration);
            (from_torque + from_position + from_friction).sqrt()
        });
        self.torque_floor_nm = self.torque_sd_nm * mean(torque).sqrt();
    }
}

/// A torque of all joints that is a smooth function of the motion, at every sample of a burst.
pub(crate) fn smooth_in_time<const N: usize>(
    samples: usize,
    stride: usize,
    torque: impl Fn(usize) -> SVector<f64, N>,
) -> Vec<SVector<f64, N>> {
    let knots = Knots::of(samples, stride);
    let values: Vec<SVector<f64, N>> = knots.places().map(torque).collect();
    let of_joint = |j: usize| knots.fill(&values.iter().map(|value| value[j]).collect::<Vec<f64>>());
    let filled: [Vec<f64>; N] = std::array::from_fn(of_joint);
    (0..samples).map(|k| SVector::from_fn(|j, _| filled[j][k])).collect()
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
    let median = crate::noise_level::median(&mut bands).unwrap_or(BAND_HZ[0]);
    median.clamp(BAND_HZ[0], BAND_HZ[1]).min(HIGHEST_BAND * rate_hz)
}
