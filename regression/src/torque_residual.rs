//! Measured torque minus rigid-body torque.

use std::ops::Range;

use nalgebra::SVector;
use tribo_logs::{Resampling, RobotLog, median_period_s, resample};
use tribo_robot::{Arm, rnea};

use crate::filter::central_difference;
use crate::repeats::without_repeats;
use crate::signal_chain::GAP_PERIODS;
use crate::{ResidualError, ResidualSettings, SignalChain};

/// Longest hole of dropped repeats that is interpolated across, in periods of the log.
const HOLE_PERIODS: f64 = 2.6;

/// Smoothed motion at one grid stamp, before the band filter: what a regressor is a function of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionSample<const N: usize> {
    /// Time (s).
    pub time_s: f64,
    /// Joint positions (rad).
    pub q: SVector<f64, N>,
    /// Joint velocities (rad/s).
    pub qd: SVector<f64, N>,
    /// Joint accelerations (rad/s²).
    pub qdd: SVector<f64, N>,
}

/// `residual = measured − model` per joint on a uniform grid, burst by burst, filtered as [`SignalChain`] says.
///
/// Positive where the joint needs more torque than the rigid model: friction τ_f(qd) appears with its own sign.
/// The bursts stand one after the other in every column; `bursts` says where each begins and ends.
/// Leaves out: the logged dq (the derivative of smoothed q is better), and noise levels.
#[derive(Clone, Debug, PartialEq)]
pub struct TorqueResidual<const N: usize> {
    /// Time of each sample (s).
    pub time_s: Vec<f64>,
    /// Joint velocities, filtered like the torques (rad/s); outer index joint.
    pub qd_rad_s: [Vec<f64>; N],
    /// Measured torque, filtered (Nm).
    pub measured_nm: [Vec<f64>; N],
    /// Model torque, filtered (Nm).
    pub model_nm: [Vec<f64>; N],
    /// Measured minus model (Nm).
    pub residual_nm: [Vec<f64>; N],
    /// Samples of each burst.
    pub bursts: Vec<Range<usize>>,
    /// Bursts left out because they were too short.
    pub skipped_bursts: usize,
    /// How it was computed.
    pub chain: SignalChain,
    /// Motion of each burst before band filter and trimming.
    motion: Vec<Vec<MotionSample<N>>>,
    /// Measured torque of each burst at the same stamps as the motion, unfiltered (Nm).
    raw_torque_nm: Vec<Vec<SVector<f64, N>>>,
    /// Measured link-side torque of each burst at the same stamps, smoothed like the motion (Nm).
    link_torque_nm: Option<Vec<Vec<SVector<f64, N>>>>,
    /// Motor position through the gear less joint position of each burst, smoothed like the motion (rad).
    deflection_rad: Option<Vec<Vec<SVector<f64, N>>>>,
}

impl<const N: usize> TorqueResidual<N> {
    /// The residual of a log against `arm`, whose rotor inertia must fit the side of the gears that tau was measured on.
    ///
    /// # Errors
    /// See [`ResidualError`]; a log that validated is finite and ordered already.
    pub fn of_log(log: &RobotLog, arm: &Arm<N>, settings: &ResidualSettings) -> Result<Self, ResidualError> {
        let mut residual = Self::without_model(log, settings)?;
        // Model torque through the same band.
        residual.model_nm = residual.joint_columns(|at| rnea(arm, &at.q, &at.qd, &at.qdd));
        for joint in 0..N {
            let (measured, model) = (&residual.measured_nm[joint], &residual.model_nm[joint]);
            if let Some(k) = model.iter().position(|tau| !tau.is_finite()) {
                return Err(ResidualError::ModelNotFinite { joint, time_s: residual.time_s[k] });
            }
            residual.residual_nm[joint] = measured.iter().zip(model).map(|(tau, rigid)| tau - rigid).collect();
        }
        Ok(residual)
    }

    /// The motion and the measured torques of a log; model and residual are empty.
    pub(crate) fn without_model(log: &RobotLog, settings: &ResidualSettings) -> Result<Self, ResidualError> {
        if log.joints() != N {
            return Err(ResidualError::JointCount { log: log.joints(), arm: N });
        }
        let (log, repeats) = without_repeats(log);
        let log = log.as_ref();
        // A dropped repeat leaves a hole of two periods, which is no gap.
        let hole_s = repeats.then(|| HOLE_PERIODS * median_period_s(&log.time_s).unwrap_or(0.0));
        let longest_gap_s = settings.longest_gap_s.or(hole_s.map(|hole_s| hole_s.max(GAP_PERIODS / settings.band_hz)));
        let chain = SignalChain::resolve(log, &ResidualSettings { longest_gap_s, ..*settings })?;

        // Bursts on uniform grids.
        let resampling = Resampling {
            period_s: Some(chain.rate_hz.recip()),
            gap_tolerance: f64::max(1.0, chain.longest_gap_s * chain.rate_hz),
            min_rows: 2,
        };
        let grids = resample(log, &resampling)?;
        let count = grids.bursts.len() + grids.skipped_bursts;
        let longest_burst_s = grids.bursts.iter().map(|burst| burst.duration_s()).fold(0.0, f64::max);
        let long = |burst: &RobotLog| burst.duration_s() >= chain.shortest_burst_s();
        let kept: Vec<RobotLog> = grids.bursts.into_iter().filter(long).collect();
        if kept.is_empty() {
            let (need_s, band_hz) = (chain.shortest_burst_s(), chain.band_hz);
            return Err(ResidualError::TooShort { longest_burst_s, need_s, bursts: count, band_hz });
        }
        let mut residual = Self {
            time_s: Vec::new(),
            qd_rad_s: std::array::from_fn(|_| Vec::new()),
            measured_nm: std::array::from_fn(|_| Vec::new()),
            model_nm: std::array::from_fn(|_| Vec::new()),
            residual_nm: std::array::from_fn(|_| Vec::new()),
            bursts: Vec::new(),
            skipped_bursts: count - kept.len(),
            chain,
            motion: Vec::new(),
            raw_torque_nm: Vec::new(),
            link_torque_nm: log.tau_link_nm.is_some().then(Vec::new),
            deflection_rad: log.theta_rad.is_some().then(Vec::new),
        };
        for burst in kept {
            residual.append(&burst);
        }
        residual.qd_rad_s = residual.joint_columns(|at| at.qd);
        Ok(residual)
    }

    /// The samples of one burst on its grid: measured torque through the same smoother and band as the motion, which is that of positions.
    fn append(&mut self, burst: &RobotLog) {
        let start = self.time_s.len();
        self.time_s.extend(self.chain.trim_and_average(self.chain.settled(&burst.time_s)));
        self.bursts.push(start..self.time_s.len());
        let smoothed_nm = self.chain.smooth_all(&burst.tau_j_nm);
        let settled: Vec<Vec<f64>> = smoothed_nm.iter().map(|x| self.chain.settled(x).to_vec()).collect();
        drop(smoothed_nm);
        for (measured, finished) in self.measured_nm.iter_mut().zip(self.chain.finish_all(&settled)) {
            measured.extend(finished);
        }
        drop(settled);
        self.raw_torque_nm.push(rows(&burst.tau_j_nm, &self.chain));
        if let Some(all) = &mut self.link_torque_nm {
            all.extend(smoothed(burst.tau_link_nm.as_ref(), &self.chain));
        }
        if let Some(all) = &mut self.deflection_rad {
            all.extend(deflection_of(burst, &self.chain));
        }
        self.motion.push(motion_of(burst, &self.chain));
    }

    /// Number of samples of every column.
    pub fn samples(&self) -> usize {
        self.time_s.len()
    }

    /// Motion and unfiltered torque (Nm) of each burst, for whoever keeps nothing else.
    pub(crate) fn into_motion_and_raw_torque_nm(self) -> (Vec<Vec<MotionSample<N>>>, Vec<Vec<SVector<f64, N>>>) {
        (self.motion, self.raw_torque_nm)
    }

    /// Motion of each burst before band filter and trimming.
    pub fn motion(&self) -> &[Vec<MotionSample<N>>] {
        &self.motion
    }

    /// Measured link-side torque at the stamps of [`Self::motion`], smoothed (Nm), where the log has it.
    pub fn link_torque_nm(&self) -> Option<&[Vec<SVector<f64, N>>]> {
        self.link_torque_nm.as_deref()
    }

    /// Motor position through the gear less joint position at the stamps of [`Self::motion`] (rad), with two encoders.
    pub fn deflection_rad(&self) -> Option<&[Vec<SVector<f64, N>>]> {
        self.deflection_rad.as_deref()
    }

    /// A regressor φ(q, qd, qdd) for each joint, filtered, trimmed and averaged exactly as the torques are.
    pub fn joint_columns(&self, regressor: impl Fn(&MotionSample<N>) -> SVector<f64, N>) -> [Vec<f64>; N] {
        let mut columns = std::array::from_fn(|_| Vec::with_capacity(self.samples()));
        for burst in &self.motion {
            let values: Vec<SVector<f64, N>> = burst.iter().map(&regressor).collect();
            let track = |j: usize| values.iter().map(|value| value[j]).collect::<Vec<f64>>();
            columns.iter_mut().zip(self.chain.finish_all((0..N).map(track))).for_each(|(column, x)| column.extend(x));
        }
        columns
    }

    /// One regressor, filtered, trimmed and averaged exactly as the torques are.
    pub fn column(&self, regressor: impl Fn(&MotionSample<N>) -> f64) -> Vec<f64> {
        let finished = |burst: &Vec<_>| self.chain.finish(&burst.iter().map(&regressor).collect::<Vec<f64>>());
        self.motion.iter().flat_map(finished).collect()
    }
}

/// Settled rows of one quantity.
fn rows<const N: usize>(columns: &[Vec<f64>], chain: &SignalChain) -> Vec<SVector<f64, N>> {
    let settled: Vec<&[f64]> = columns.iter().map(|column| chain.settled(column)).collect();
    let count = settled.first().map_or(0, |column| column.len());
    (0..count).map(|k| SVector::from_fn(|j, _| settled[j][k])).collect()
}

/// Smoothed, settled rows of a quantity that a log may lack.
pub fn smoothed<const N: usize>(columns: Option<&Vec<Vec<f64>>>, chain: &SignalChain) -> Option<Vec<SVector<f64, N>>> {
    Some(rows(&chain.smooth_all(columns?), chain))
}

/// Smoothed, settled `theta − q` where the log has two encoders.
fn deflection_of<const N: usize>(burst: &RobotLog, chain: &SignalChain) -> Option<Vec<SVector<f64, N>>> {
    let theta = burst.theta_rad.as_ref()?;
    let difference = |j: usize| theta[j].iter().zip(&burst.q_rad[j]).map(|(theta, q)| theta - q).collect::<Vec<f64>>();
    let differences: Vec<Vec<f64>> = (0..N).map(difference).collect();
    Some(rows(&chain.smooth_all(&differences), chain))
}

/// Smoothed positions and their derivatives, away from the ends of the burst.
pub fn motion_of<const N: usize>(burst: &RobotLog, chain: &SignalChain) -> Vec<MotionSample<N>> {
    let dt_s = chain.rate_hz.recip();
    let q = chain.smooth_all(&burst.q_rad);
    let qd: [Vec<f64>; N] = std::array::from_fn(|j| central_difference(&q[j], dt_s));
    let qdd: [Vec<f64>; N] = std::array::from_fn(|j| central_difference(&qd[j], dt_s));
    let at = |columns: &[Vec<f64>], k: usize| SVector::from_fn(|j, _| columns[j][k]);
    let rows: Vec<usize> = (0..burst.rows()).collect();
    let sample = |&k: &usize| MotionSample { time_s: burst.time_s[k], q: at(&q, k), qd: at(&qd, k), qdd: at(&qdd, k) };
    chain.settled(&rows).iter().map(sample).collect()
}
