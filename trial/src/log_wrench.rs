//! A wrench estimator run over a measured log.

use serde_json::{Value, json};
use tribo_friction::{Compensator, VelocitySource};
use tribo_logs::{GAP_TOLERANCE, RobotLog, bursts, row};
use tribo_model::ControllerModel;
use tribo_robot::{SensorFrame, Wrench, WrenchEstimate, WrenchEstimator};
use tribo_runtime::{LONGEST_GAP_PERIODS, MeasuredWrench};

/// Wrench along a log, one row per sample of the log, in file order: force then moment [N, Nm], base axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LogWrench {
    /// Time stamps of the log (s).
    pub time_s: Vec<f64>,
    /// Estimated wrench by the robot on the environment.
    pub wrench: Vec<[f64; 6]>,
    /// Its standard deviation, as the estimator believes it.
    pub sd: Vec<[f64; 6]>,
    /// Lower and upper end of its 95 % interval.
    pub limits95: Vec<[[f64; 6]; 2]>,
    /// Samples that the estimator could not use.
    pub faults: usize,
    /// Normalised innovation squared, where the estimator has one.
    pub nis: Vec<f64>,
    /// The log's reference wrench, if it has one.
    pub reference: Option<Vec<[f64; 6]>>,
    /// Delay that the estimator states (s).
    pub stated_delay_s: f64,
}

/// Runs an estimator over the bursts of a log, starting anew at each.
///
/// What it is given is said at [`MeasuredWrench`]; `controller_model` must be [`ControllerModel::on_log`], the arm on the same side of the gears as
/// `tau_J`.
pub fn wrench_on_log<const N: usize, E: WrenchEstimator<N>>(
    log: &RobotLog,
    controller_model: &ControllerModel<N>,
    smoothing_rad_s: f64,
    estimator: &mut E,
) -> LogWrench {
    let mut result = LogWrench { stated_delay_s: estimator.delay_s(), ..LogWrench::default() };
    if let Some(columns) = &log.o_f_ext {
        let rows = 0..log.rows();
        result.reference = Some(rows.map(|k| std::array::from_fn(|i| columns[i][k])).collect());
    }
    let mut measured = measured_wrench(controller_model, smoothing_rad_s, estimator);
    for burst in bursts(&log.time_s, GAP_TOLERANCE.max(LONGEST_GAP_PERIODS)) {
        let first = burst.start;
        for k in burst {
            let frame = frame_at(log, k);
            let estimate = if k == first {
                measured.begin(&frame);
                None
            } else {
                Some(measured.step(&frame, None))
            };
            match estimate.filter(|_| measured.has_settled()) {
                Some(estimate) => result.push(log.time_s[k], &estimate),
                None => result.push_unsettled(log.time_s[k]),
            }
        }
    }
    result
}

/// The estimator behind the sensors of an arm that is believed to be so, its friction at the measured velocity.
pub(crate) fn measured_wrench<const N: usize, E: WrenchEstimator<N>>(
    controller_model: &ControllerModel<N>,
    smoothing_rad_s: f64,
    estimator: E,
) -> MeasuredWrench<N, E> {
    let compensator = Compensator {
        smoothing_rad_s,
        effects: controller_model.effects,
        ..Compensator::new(controller_model.friction, VelocitySource::Measured)
    };
    MeasuredWrench::new(controller_model.arm.clone(), compensator, estimator)
}

/// Row k of a log as a sample of the joint sensors (s, rad, rad/s, Nm).
#[must_use]
pub fn frame_at<const N: usize>(log: &RobotLog, k: usize) -> SensorFrame<N> {
    SensorFrame {
        time_s: log.time_s[k],
        q: row(&log.q_rad, k).into(),
        qd: row(&log.dq_rad_s, k).into(),
        tau: row(&log.tau_j_nm, k).into(),
        theta: log.theta_rad.as_ref().map(|theta| row(theta, k).into()),
    }
}

/// Summary of a wrench along a log.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WrenchSummary {
    /// Samples behind the figures.
    pub samples: usize,
    /// Mean wrench, force then moment.
    pub mean: [f64; 6],
    /// Root mean square, force then moment.
    pub rms: [f64; 6],
    /// Largest magnitude, force then moment.
    pub max: [f64; 6],
    /// Mean standard deviation that the estimator states.
    pub stated_sd: [f64; 6],
    /// Mean half-width of its 95 % interval.
    pub half_width95: [f64; 6],
    /// Samples that the estimator could not use.
    pub faults: usize,
    /// Mean NIS (6 when the filter's noise model is right), where the estimator has an innovation.
    pub mean_nis: Option<f64>,
    /// Errors against the log's reference wrench, if it has one.
    pub against_reference: Option<ReferenceErrors>,
}

/// Errors of an estimate against a reference wrench.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ReferenceErrors {
    /// RMS of the force error, mean over axes (N).
    pub rmse_force_n: f64,
    /// RMS of the moment error, mean over axes (Nm).
    pub rmse_moment_nm: f64,
    /// RMS of the error on each axis, force then moment.
    pub rmse: [f64; 6],
    /// Mean error, force then moment.
    pub bias: [f64; 6],
    /// Share of samples whose reference lies in the stated 95 % interval.
    pub coverage95: [f64; 6],
    /// Shift of the estimate that fits the reference best (s); none where the reference never moves.
    pub delay_s: Option<f64>,
}

impl LogWrench {
    /// Appends an estimate at a time (s).
    pub fn push(&mut self, time_s: f64, estimate: &WrenchEstimate) {
        let (interval, variance) = (estimate.interval95(), estimate.covariance.diagonal());
        self.time_s.push(time_s);
        self.wrench.push(estimate.wrench_base.to_force_moment());
        self.sd.push(Wrench::from_vector(&variance.map(|v| v.max(0.0).sqrt())).to_force_moment());
        self.limits95.push([interval.lower.to_force_moment(), interval.upper.to_force_moment()]);
        self.nis.push(estimate.nis.unwrap_or(f64::NAN));
        self.faults += usize::from(estimate.fault.is_some());
    }

    fn push_unsettled(&mut self, time_s: f64) {
        let nan = [f64::NAN; 6];
        self.time_s.push(time_s);
        self.wrench.push(nan);
        self.sd.push(nan);
        self.limits95.push([nan; 2]);
        self.nis.push(f64::NAN);
    }

    /// Takes a constant wrench (force then moment) off estimates and intervals.
    pub fn tare(&mut self, tare: &[f64; 6]) {
        let estimates = self.wrench.iter_mut().chain(self.limits95.iter_mut().flatten());
        estimates.for_each(|wrench| wrench.iter_mut().zip(tare).for_each(|(value, tare)| *value -= tare));
    }

    /// Multiplies standard deviations and the distance of both ends of the intervals, axis by axis (force then moment).
    pub fn widen(&mut self, factors: &[f64; 6]) {
        for (k, wrench) in self.wrench.iter().enumerate() {
            for (i, factor) in factors.iter().enumerate() {
                self.sd[k][i] *= factor;
                for end in &mut self.limits95[k] {
                    end[i] = wrench[i] + (end[i] - wrench[i]) * factor;
                }
            }
        }
    }

    /// How many half-widths of its interval off zero the estimate is at most in this share of the settled samples, axis by
    /// axis; the half-width is that on the side of zero.
    pub fn half_widths_from_zero(&self, share: f64) -> [f64; 6] {
        std::array::from_fn(|i| {
            let settled = (0..self.wrench.len()).filter(|&k| self.wrench[k][i].is_finite());
            let mut ratios: Vec<f64> = settled
                .map(|k| {
                    let (value, [lower, upper]) = (self.wrench[k][i], self.limits95[k]);
                    value.abs() / if value > 0.0 { value - lower[i] } else { upper[i] - value }
                })
                .filter(|ratio| ratio.is_finite())
                .collect();
            ratios.sort_by(f64::total_cmp);
            let rank = (share * ratios.len() as f64).ceil() as usize;
            ratios.get(rank.saturating_sub(1)).copied().unwrap_or(1.0)
        })
    }

    /// Share of settled samples and axes whose 95 % interval holds `wrench`.
    pub fn share_inside(&self, wrench: &[f64; 6]) -> f64 {
        let settled = self.limits95.iter().filter(|limits| limits[0][0].is_finite());
        let (mut inside, mut all) = (0usize, 0usize);
        for [lower, upper] in settled {
            inside += (0..6).filter(|&i| lower[i] <= wrench[i] && wrench[i] <= upper[i]).count();
            all += 6;
        }
        inside as f64 / all.max(1) as f64
    }

    /// Time from the first sample to the last (s); zero without samples.
    pub fn duration_s(&self) -> f64 {
        self.time_s.last().zip(self.time_s.first()).map_or(0.0, |(last, first)| last - first)
    }

    /// Mean wrench of the settled samples, force then moment.
    pub fn mean(&self) -> [f64; 6] {
        let settled: Vec<&[f64; 6]> = self.wrench.iter().filter(|wrench| wrench[0].is_finite()).collect();
        let count = settled.len().max(1) as f64;
        std::array::from_fn(|i| settled.iter().map(|wrench| wrench[i]).sum::<f64>() / count)
    }

    /// The figures of the settled samples.
    pub fn summary(&self) -> WrenchSummary {
        let settled: Vec<usize> = (0..self.wrench.len()).filter(|&k| self.wrench[k][0].is_finite()).collect();
        let count = settled.len().max(1) as f64;
        let mean_of = |value: &dyn Fn(usize, usize) -> f64| -> [f64; 6] {
            std::array::from_fn(|i| settled.iter().map(|&k| value(k, i)).sum::<f64>() / count)
        };
        let against_reference = self.reference.as_ref().map(|reference| {
            let error = |k: usize, i: usize| self.wrench[k][i] - reference[k][i];
            let mean_square = mean_of(&|k, i| error(k, i).powi(2));
            let inside = |k: usize, i: usize| {
                let ([lower, upper], truth) = (self.limits95[k], reference[k][i]);
                f64::from(lower[i] <= truth && truth <= upper[i])
            };
            ReferenceErrors {
                rmse_force_n: (mean_square[..3].iter().sum::<f64>() / 3.0).sqrt(),
                rmse_moment_nm: (mean_square[3..].iter().sum::<f64>() / 3.0).sqrt(),
                rmse: mean_square.map(f64::sqrt),
                bias: mean_of(&error),
                coverage95: mean_of(&inside),
                delay_s: self.delay(reference, &settled),
            }
        });
        let nis: Vec<f64> = settled.iter().map(|&k| self.nis[k]).filter(|nis| nis.is_finite()).collect();
        WrenchSummary {
            samples: settled.len(),
            mean: self.mean(),
            rms: mean_of(&|k, i| self.wrench[k][i].powi(2)).map(f64::sqrt),
            max: std::array::from_fn(|i| settled.iter().map(|&k| self.wrench[k][i].abs()).fold(0.0, f64::max)),
            stated_sd: mean_of(&|k, i| self.sd[k][i]),
            half_width95: mean_of(&|k, i| 0.5 * (self.limits95[k][1][i] - self.limits95[k][0][i])),
            faults: self.faults,
            mean_nis: (!nis.is_empty()).then(|| nis.iter().sum::<f64>() / nis.len() as f64),
            against_reference,
        }
    }

    /// The lag, in samples of the log, at which the squared error over all axes is least; up to 100 ms.
    fn delay(&self, reference: &[[f64; 6]], settled: &[usize]) -> Option<f64> {
        let moves = |i: usize| reference.iter().any(|row| row[i] != reference[0][i]);
        let (first, last) = (*settled.first()?, *settled.last()?);
        let period = (self.time_s[last] - self.time_s[first]) / (last - first).max(1) as f64;
        if !(0..6).any(moves) || period <= 0.0 {
            return None;
        }
        let most = (0.1 / period).round() as usize;
        let error = |lag: usize| -> f64 {
            let pairs = settled.iter().filter(|&&k| k >= first + most);
            pairs.map(|&k| (0..6).map(|i| (self.wrench[k][i] - reference[k - lag][i]).powi(2)).sum::<f64>()).sum()
        };
        let best = (0..=most).min_by(|&a, &b| error(a).total_cmp(&error(b)))?;
        Some(best as f64 * period)
    }
}

impl WrenchSummary {
    /// The entry of one estimator in `tribo.estimate/1`.
    pub fn to_json(&self) -> Value {
        let mut document = json!({
            "samples": self.samples,
            "mean": self.mean,
            "rms": self.rms,
            "max": self.max,
            "stated_sd": self.stated_sd,
            "half_width95": self.half_width95,
            "faults": self.faults,
            "mean_nis": self.mean_nis,
        });
        if let (Some(errors), Some(object)) = (&self.against_reference, document.as_object_mut()) {
            object.insert("rmse_force_n".into(), json!(errors.rmse_force_n));
            object.insert("rmse_moment_nm".into(), json!(errors.rmse_moment_nm));
            object.insert("bias".into(), json!(errors.bias));
            object.insert("coverage95".into(), json!(errors.coverage95));
            object.insert("delay_ms".into(), json!(errors.delay_s.map(|delay| delay * 1e3)));
        }
        document
    }
}
