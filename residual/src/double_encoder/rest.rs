//! Poses at which an arm with two encoders stands still.

use nalgebra::{SVector, Vector6};
use tribo_logs::{RobotLog, bursts};
use tribo_robot::Wrench;

use super::{Approach, CalibrationError, ValidDoubleEncoder};

/// An arm at rest, averaged over the rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest<const N: usize> {
    /// Link angles (rad).
    pub q: SVector<f64, N>,
    /// Motor less link angle (rad); the paper's Δθ with the other sign.
    pub deflection_rad: SVector<f64, N>,
    /// Direction from which each joint came, [−1, 1]; see [`Approach`].
    pub direction: SVector<f64, N>,
    /// Direction in which its load changed last, [−1, 1].
    pub loading: SVector<f64, N>,
}

/// The same pose without and with a wrench that is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadedRest<const N: usize> {
    /// Before the load, or without it.
    pub free: Rest<N>,
    /// Under the load.
    pub loaded: Rest<N>,
    /// Wrench by the robot on the environment, flange, base axes.
    pub wrench_base: Wrench,
}

/// The rests of a log, without and with load.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rests<const N: usize> {
    /// Without load.
    pub free: Vec<Rest<N>>,
    /// With a load, each with the last rest before it at the same pose without one.
    pub loaded: Vec<LoadedRest<N>>,
}

/// Speed of every joint (rad/s) below which the arm rests, on the mean over [`WINDOW_S`]: far below any motion.
const REST_SPEED_RAD_S: f64 = 2e-3;
/// Length (s) of the pieces of a log that are averaged; motion dies out within the first of a rest.
const WINDOW_S: f64 = 0.1;
/// Wrenches below this are none (N, and a tenth of it in Nm).
const NO_FORCE_N: f64 = 0.5;
/// Change of a wrench (N, and a tenth of it in Nm) that begins another rest.
const SAME_FORCE_N: f64 = 0.5;
/// Difference of joint angles (rad) up to which two rests are at one pose: far above a deflection.
const SAME_POSE_RAD: f64 = 0.02;
/// A gap of this many periods splits a log.
const LONGEST_GAP_PERIODS: f64 = 20.0;

impl<const N: usize> Rests<N> {
    /// Cuts a log into pieces of 0.1 s, keeps those in which no joint moves, joins those in a row under one wrench, and
    /// leaves the first piece of each rest out. The wrench is that of `O_F_ext`; without those columns every rest is taken
    /// to be free of load.
    ///
    /// # Errors
    /// [`CalibrationError::JointCount`], [`CalibrationError::NoMotorPositions`].
    pub fn in_log(log: &RobotLog, settings: &ValidDoubleEncoder) -> Result<Self, CalibrationError> {
        if log.joints() != N {
            return Err(CalibrationError::JointCount { need: N, got: log.joints() });
        }
        let theta = log.theta_rad.as_ref().ok_or(CalibrationError::NoMotorPositions)?;
        let mut rests = Self::default();
        for burst in bursts(&log.time_s, LONGEST_GAP_PERIODS) {
            let mut approach = Approach::new(settings.direction_travel_rad, settings.loading_travel_rad);
            let (mut row, end) = (burst.start, burst.end);
            let mut open: Option<OpenRest<N>> = None;
            while row < end {
                let to = (row..end).find(|&k| log.time_s[k] >= log.time_s[row] + WINDOW_S).unwrap_or(end);
                let mean = |columns: &[Vec<f64>]| {
                    SVector::<f64, N>::from_fn(|j, _| columns[j][row..to].iter().sum::<f64>() / (to - row) as f64)
                };
                let q = mean(&log.q_rad);
                let deflection = mean(theta) - q;
                approach.push(&q, &deflection);
                let wrench = log.o_f_ext.as_ref().map_or_else(Vector6::zeros, |columns| {
                    let at = |i: usize| columns[i][row..to].iter().sum::<f64>() / (to - row) as f64;
                    Wrench::from_force_moment(&std::array::from_fn(at)).to_vector()
                });
                if mean(&log.dq_rad_s).amax() < REST_SPEED_RAD_S {
                    match &mut open {
                        Some(rest) if size_n(&(wrench - rest.wrench)) < SAME_FORCE_N => {
                            rest.add(q, deflection, &approach)
                        }
                        _ => {
                            rests.close(open.take());
                            open = Some(OpenRest::new(wrench));
                        }
                    }
                } else {
                    rests.close(open.take());
                }
                row = to;
            }
            rests.close(open.take());
        }
        Ok(rests)
    }

    fn close(&mut self, rest: Option<OpenRest<N>>) {
        let Some((rest, wrench)) = rest.and_then(OpenRest::mean) else { return };
        if size_n(&wrench) < NO_FORCE_N {
            self.free.push(rest);
            return;
        }
        let same_pose = |free: &&Rest<N>| (free.q - rest.q).amax() < SAME_POSE_RAD;
        if let Some(&free) = self.free.iter().rev().find(same_pose) {
            let wrench_base = Wrench::from_vector(&wrench);
            self.loaded.push(LoadedRest { free, loaded: rest, wrench_base });
        }
    }
}

/// Largest component of a wrench `[moment; force]` (N), moments times 10/m.
fn size_n(wrench: &Vector6<f64>) -> f64 {
    (0..6).map(|i| wrench[i].abs() * if i < 3 { 10.0 } else { 1.0 }).fold(0.0, f64::max)
}

/// A rest that may go on.
struct OpenRest<const N: usize> {
    wrench: Vector6<f64>,
    pieces: f64,
    q: SVector<f64, N>,
    deflection: SVector<f64, N>,
    approach: Option<Approach<N>>,
}

impl<const N: usize> OpenRest<N> {
    fn new(wrench: Vector6<f64>) -> Self {
        Self { wrench, pieces: 0.0, q: SVector::zeros(), deflection: SVector::zeros(), approach: None }
    }

    fn add(&mut self, q: SVector<f64, N>, deflection: SVector<f64, N>, approach: &Approach<N>) {
        self.pieces += 1.0;
        self.q += q;
        self.deflection += deflection;
        self.approach = Some(*approach);
    }

    fn mean(self) -> Option<(Rest<N>, Vector6<f64>)> {
        let approach = self.approach?;
        let rest = Rest {
            q: self.q / self.pieces,
            deflection_rad: self.deflection / self.pieces,
            direction: approach.direction(),
            loading: approach.loading(),
        };
        Some((rest, self.wrench))
    }
}
