//! The motion and the torque of a log at a few hundred instants.

use nalgebra::SVector;
use tribo_logs::{Resampling, RobotLog, resample};
use tribo_regression::{ResidualSettings, SignalChain, motion_of, smoothed, without_repeats};
use tribo_robot::{Arm, gravity_torque};

/// Cut-off of the smoother (Hz): the motion of an arm.
const BAND_HZ: f64 = 8.0;
/// Largest cut-off over the rate of the log.
const HIGHEST_BAND: f64 = 0.3;
/// Instants that are kept.
const MOST: usize = 240;
/// Rows of the log that are looked at, from its start: five minutes at 1 kHz.
const MOST_ROWS: usize = 300_000;
/// Turning of a joint that takes torque (rad).
const TURNS_RAD: f64 = 0.02;
/// Rounding of a smoother over a constant torque [-].
const SAME: f64 = 1e-9;
/// Norm of the torques of an arm's weight from which on it is to be seen (Nm).
const LEAST_WEIGHT_NM: f64 = 2.0;
/// Fewest instants that a judgement needs.
const LEAST: usize = 20;

/// One instant: positions (rad), velocities (rad/s), accelerations (rad/s²) and torques (Nm), all through one smoother.
#[derive(Clone, Copy, Debug)]
pub(super) struct Instant<const N: usize> {
    pub q: SVector<f64, N>,
    pub qd: SVector<f64, N>,
    pub qdd: SVector<f64, N>,
    pub tau_nm: SVector<f64, N>,
}

/// Instants spread evenly over the log, and how long it lasts without its gaps (s).
#[derive(Clone, Debug)]
pub(super) struct Samples<const N: usize> {
    pub instants: Vec<Instant<N>>,
    pub duration_s: f64,
}

impl<const N: usize> Samples<N> {
    /// `None` where no stretch is long enough to be judged.
    pub fn of(log: &RobotLog) -> Option<Self> {
        let log = log.slice(0..MOST_ROWS.min(log.rows())).ok()?;
        let (log, _) = without_repeats(&log);
        let rate_hz = tribo_logs::median_period_s(&log.time_s).filter(|period| *period > 0.0)?.recip();
        let band_hz = BAND_HZ.min(HIGHEST_BAND * rate_hz);
        let settings = ResidualSettings { band_hz, smoothing_over_band: 1.0, ..ResidualSettings::default() };
        let chain = SignalChain::resolve(&log, &settings).ok()?;
        let gap_tolerance = f64::max(2.6, chain.longest_gap_s * chain.rate_hz);
        let resampling = Resampling { period_s: Some(chain.rate_hz.recip()), gap_tolerance, min_rows: 2 };
        let grids = resample(&log, &resampling).ok()?;
        let long = |burst: &&RobotLog| burst.duration_s() >= chain.shortest_burst_s();
        let mut instants = Vec::new();
        let mut duration_s = 0.0;
        for burst in grids.bursts.iter().filter(long) {
            let motion = motion_of::<N>(burst, &chain);
            let torque: Vec<SVector<f64, N>> = smoothed(Some(&burst.tau_j_nm), &chain)?;
            duration_s += motion.len() as f64 / chain.rate_hz;
            instants.extend(motion.iter().zip(torque).map(|(at, tau_nm)| Instant {
                q: at.q,
                qd: at.qd,
                qdd: at.qdd,
                tau_nm,
            }));
        }
        let finite = |at: &Instant<N>| [at.q, at.qd, at.qdd, at.tau_nm].iter().all(|x| x.amax().is_finite());
        let step = instants.len().div_ceil(MOST).max(1);
        let instants: Vec<Instant<N>> = instants.into_iter().step_by(step).filter(finite).collect();
        (instants.len() >= LEAST).then_some(Self { instants, duration_s })
    }

    /// How much of the weight of an arm the torques hold, by least squares over all joints: 1 of an arm as it is, 0 where gravity was left
    /// out. A motion of centimetres, in which a weight is a constant, tells it as well as any; `None` where nothing is to be held.
    pub fn weight_share(&self, arm: &Arm<N>) -> Option<f64> {
        let (mut product, mut square) = (0.0, 0.0);
        for at in &self.instants {
            let weight_nm = gravity_torque(arm, &at.q);
            product += weight_nm.dot(&at.tau_nm);
            square += weight_nm.norm_squared();
        }
        (square > LEAST_WEIGHT_NM.powi(2) * self.instants.len() as f64).then(|| product / square)
    }

    /// Largest less smallest value.
    pub fn range(&self, of: impl Fn(&Instant<N>) -> f64) -> f64 {
        let values = self.instants.iter().map(&of);
        values.clone().fold(f64::MIN, f64::max) - values.fold(f64::MAX, f64::min)
    }

    /// Joints that turn while their torque stays the same to its last digits, as a column that was never filled in.
    pub fn constant_torques(&self) -> Vec<usize> {
        let constant = |j: &usize| {
            let size_nm = self.instants.iter().map(|at| at.tau_nm[*j].abs()).fold(1.0, f64::max);
            self.range(|at| at.q[*j]) > TURNS_RAD && self.range(|at| at.tau_nm[*j]) < SAME * size_nm
        };
        (0..N).filter(constant).collect()
    }
}
