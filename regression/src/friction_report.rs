//! How much of the torque residual is joint friction.

use std::ops::Range;

use nalgebra::SVector;
use tribo_friction::FrictionModel;
use tribo_friction::identify::{JointTorqueFit, TorqueFitError, fit_columns};
use tribo_friction::law::smooth_sign;
use tribo_logs::RobotLog;

use crate::noise_level::rms;
use crate::regression_data::RegressionData;
use crate::{
    BlockSettings, Blocks, BlocksError, DiagnoseError, ModelResidual, Nominal, ResidualSettings, SignalChain,
    TorqueResidual,
};

/// How friction is fitted and judged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionSettings {
    /// On logs sign(qd) is tanh(qd/smoothing) (rad/s); 0.005 is about the noise of a differentiated encoder.
    pub smoothing_rad_s: f64,
    /// Blocks for training and test.
    pub blocks: BlockSettings,
}

impl Default for FrictionSettings {
    fn default() -> Self {
        Self { smoothing_rad_s: 0.005, blocks: BlockSettings::default() }
    }
}

/// Why a joint's friction could not be fitted.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum JointFitError {
    /// The joint stood still or moved in one direction only: Coulomb friction and offset are one number then.
    #[error(
        "the joint moved forwards for {forwards_s:.2} s and backwards for {backwards_s:.2} s; friction and offset need \
         {need_s:.2} s each way faster than {speed_rad_s} rad/s"
    )]
    OneWay {
        /// Time faster than the threshold with qd > 0 (s).
        forwards_s: f64,
        /// Time faster than the threshold with qd < 0 (s).
        backwards_s: f64,
        /// Time needed each way (s).
        need_s: f64,
        /// Threshold (rad/s).
        speed_rad_s: f64,
    },
    /// The least-squares problem has no answer.
    #[error(transparent)]
    Columns(#[from] TorqueFitError),
}

/// Why a joint has no held-out figure.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum HeldOutError {
    /// The log cannot be cut into enough blocks.
    #[error(transparent)]
    Blocks(#[from] BlocksError),
    /// Without the blocks of one fold the joint cannot be fitted.
    #[error("without the blocks of fold {fold}: {source}")]
    Fold {
        /// The fold.
        fold: usize,
        /// What its training blocks lack.
        source: JointFitError,
    },
}

/// What cross-validation over contiguous blocks says about a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldOut {
    /// RMS on the training samples, over all folds (Nm).
    pub rms_fit_train_nm: f64,
    /// RMS on the test samples, over all folds: each sample once, by a fit that has not seen its block (Nm).
    pub rms_fit_test_nm: f64,
    /// Standard deviation of the parameters, jackknife over the folds: Fc (Nm), Fv (Nm s/rad), offset (Nm).
    pub sd: [f64; 3],
}

/// Friction of one joint.
#[derive(Clone, Debug, PartialEq)]
pub struct JointReport {
    /// Joint, from 0.
    pub joint: usize,
    /// RMS of the residual without friction (Nm).
    pub rms_rigid_nm: f64,
    /// Standard deviation of the same about its mean (Nm).
    pub sd_rigid_nm: f64,
    /// RMS with the given friction model (Nm).
    pub rms_with_model_nm: Option<f64>,
    /// Standard deviation with the given friction model (Nm).
    pub sd_with_model_nm: Option<f64>,
    /// Coulomb friction, viscous friction and offset fitted to all samples.
    pub fit: Result<JointTorqueFit, JointFitError>,
    /// The same fit judged on blocks it has not seen.
    pub held_out: Result<HeldOut, HeldOutError>,
}

/// Friction of all joints, with everything needed to repeat it.
#[derive(Clone, Debug, PartialEq)]
pub struct FrictionReport {
    /// One report per joint; a joint that cannot be fitted says why and the others stand.
    pub joints: Vec<JointReport>,
    /// Samples behind each RMS.
    pub samples: usize,
    /// Smoothing of the sign (rad/s).
    pub smoothing_rad_s: f64,
    /// Filters and band.
    pub chain: SignalChain,
    /// Blocks, or why there are none.
    pub blocks: Result<Blocks, BlocksError>,
}

/// Speed that counts as moving, in smoothings: there tanh has reached 96 %.
const MOVING_OVER_SMOOTHING: f64 = 2.0;

impl FrictionReport {
    /// Judges friction on a residual, with `model` if there is one to judge.
    ///
    /// ```text
    /// residual_j = F (Fc tanh(qd_j/ε) + Fv qd_j + offset),   F the filter of the residual
    /// ```
    pub fn of<const N: usize>(
        residual: &TorqueResidual<N>,
        model: Option<&FrictionModel<N>>,
        settings: &FrictionSettings,
    ) -> Self {
        let epsilon = settings.smoothing_rad_s;
        let sign = residual.joint_columns(|at| SVector::from_fn(|j, _| smooth_sign(at.qd[j], epsilon)));
        let model_friction = model.map(|law| residual.joint_columns(|at| law.torque(&at.qd, epsilon)));
        let left = |j: usize, friction: &[Vec<f64>; N]| difference(&residual.residual_nm[j], &friction[j]);
        let with_model: Option<Vec<Vec<f64>>> =
            model_friction.map(|friction| (0..N).map(|j| left(j, &friction)).collect());
        let columns: Vec<[&[f64]; 2]> = (0..N).map(|j| [&sign[j][..], &residual.qd_rad_s[j][..]]).collect();
        Self::assembled(
            &residual.residual_nm,
            with_model.as_deref(),
            &columns,
            &residual.bursts,
            residual.chain.clone(),
            settings,
        )
    }

    /// Judges friction on what a whole model leaves of a log: arm and effects without its friction law, then with `friction`
    /// in the law's place.
    ///
    /// # Errors
    /// [`DiagnoseError`] of a log that does not fit the model or the band.
    pub fn of_model<const N: usize>(
        log: &RobotLog,
        model: &Nominal<N>,
        friction: Option<&FrictionModel<N>>,
        band_hz: f64,
        settings: &FrictionSettings,
    ) -> Result<Self, DiagnoseError> {
        let one = std::slice::from_ref(log);
        // A diagnosis bends its band to the log; here somebody asked for this one.
        SignalChain::resolve(log, &ResidualSettings { band_hz, ..ResidualSettings::default() })?;
        let without = Nominal { friction: FrictionModel::none(), ..model.clone() };
        let data = RegressionData::of_logs(one, &without, Some(band_hz))?;
        let with = |friction: &FrictionModel<N>| {
            let whole = Nominal { friction: *friction, ..model.clone() };
            Ok::<_, DiagnoseError>(ModelResidual::of(one, &whole, Some(band_hz))?.residual_nm)
        };
        let with_model = friction.map(with).transpose()?;
        let fine = |j: usize| data.motion.iter().map(move |at| smooth_sign(at.qd[j], settings.smoothing_rad_s));
        let sign: Vec<Vec<f64>> = (0..N).map(|j| data.filter_own(&fine(j).collect::<Vec<f64>>())).collect();
        let columns: Vec<[&[f64]; 2]> = (0..N).map(|j| [&sign[j][..], &data.qd[j][..]]).collect();
        let bursts: Vec<Range<usize>> = data.bursts.iter().map(|burst| burst.out.clone()).collect();
        let chain = data.chains.first().cloned().ok_or(DiagnoseError::NoLog)?;
        Ok(Self::assembled(&data.residual_nm, with_model.as_deref(), &columns, &bursts, chain, settings))
    }

    /// The report on residuals (Nm) without and with a friction model, given filtered tanh(qd/ε) and qd of each joint.
    fn assembled(
        rigid_nm: &[Vec<f64>],
        with_model_nm: Option<&[Vec<f64>]>,
        columns: &[[&[f64]; 2]],
        bursts: &[Range<usize>],
        chain: SignalChain,
        settings: &FrictionSettings,
    ) -> Self {
        let epsilon = settings.smoothing_rad_s;
        let rate_hz = chain.output_rate_hz();
        let blocks = Blocks::cut(bursts, rate_hz, chain.memory_s(), &settings.blocks);
        let need_s = chain.band_hz.recip();
        let joint = |j: usize| {
            let rigid = &rigid_nm[j];
            let ones = vec![1.0; rigid.len()];
            let problem = JointProblem {
                columns: [columns[j][0], columns[j][1], &ones],
                residual: rigid,
                rate_hz,
                need_s,
                speed_rad_s: MOVING_OVER_SMOOTHING * epsilon,
            };
            let with_model = with_model_nm.map(|left| &left[j][..]);
            JointReport {
                joint: j,
                rms_rigid_nm: rms(rigid),
                sd_rigid_nm: sd(rigid),
                rms_with_model_nm: with_model.map(rms),
                sd_with_model_nm: with_model.map(sd),
                fit: problem.fit(bursts),
                held_out: blocks.as_ref().map_err(|&error| error.into()).and_then(|blocks| problem.hold_out(blocks)),
            }
        };
        let joints = (0..rigid_nm.len()).map(joint).collect();
        let samples = rigid_nm.first().map_or(0, Vec::len);
        Self { joints, samples, smoothing_rad_s: epsilon, chain, blocks }
    }
}

/// The regression of one joint.
struct JointProblem<'a> {
    /// Filtered tanh(qd/ε), qd and 1.
    columns: [&'a [f64]; 3],
    residual: &'a [f64],
    rate_hz: f64,
    need_s: f64,
    speed_rad_s: f64,
}

impl JointProblem<'_> {
    fn fit(&self, rows: &[Range<usize>]) -> Result<JointTorqueFit, JointFitError> {
        // Both directions, or there is nothing to fit: noise about rest separates the columns and means nothing.
        let (qd, speed_rad_s, need_s) = (self.columns[1], self.speed_rad_s, self.need_s);
        let seconds = |moving: &dyn Fn(f64) -> bool| {
            rows.iter().cloned().flatten().filter(|&k| moving(qd[k])).count() as f64 / self.rate_hz
        };
        let (forwards_s, backwards_s) = (seconds(&|v| v > speed_rad_s), seconds(&|v| v < -speed_rad_s));
        if forwards_s < need_s || backwards_s < need_s {
            return Err(JointFitError::OneWay { forwards_s, backwards_s, need_s, speed_rad_s });
        }

        let fit = fit_columns(&self.columns, self.residual, rows)?;
        let at = |c: usize| fit.coefficients[c];
        let condition = fit.condition;
        Ok(JointTorqueFit { coulomb_nm: at(0), viscous_nm_s_per_rad: at(1), offset_nm: at(2), condition })
    }

    fn hold_out(&self, blocks: &Blocks) -> Result<HeldOut, HeldOutError> {
        let (mut train, mut test) = (MeanSquare::default(), MeanSquare::default());
        let mut fits = Vec::with_capacity(blocks.folds);
        for fold in 0..blocks.folds {
            let split = blocks.split(fold);
            let fit = self.fit(&split.train).map_err(|source| HeldOutError::Fold { fold, source })?;
            let theta = [fit.coulomb_nm, fit.viscous_nm_s_per_rad, fit.offset_nm];
            for (ranges, sum) in [(&split.train, &mut train), (&split.test, &mut test)] {
                for k in ranges.iter().cloned().flatten() {
                    let explained: f64 = self.columns.iter().zip(theta).map(|(column, c)| column[k] * c).sum();
                    sum.add(self.residual[k] - explained);
                }
            }
            fits.push(theta);
        }
        let sd = std::array::from_fn(|c| jackknife_sd(fits.iter().map(|theta| theta[c])));
        Ok(HeldOut { rms_fit_train_nm: train.root(), rms_fit_test_nm: test.root(), sd })
    }
}

/// `sqrt((k − 1)/k Σ (θ_i − mean)²)` over k leave-one-fold-out estimates.
fn jackknife_sd(estimates: impl ExactSizeIterator<Item = f64> + Clone) -> f64 {
    let k = estimates.len() as f64;
    let mean = estimates.clone().sum::<f64>() / k;
    ((k - 1.0) / k * estimates.map(|theta| (theta - mean).powi(2)).sum::<f64>()).sqrt()
}

#[derive(Default)]
struct MeanSquare {
    sum: f64,
    count: usize,
}

impl MeanSquare {
    fn add(&mut self, x: f64) {
        self.sum += x * x;
        self.count += 1;
    }

    fn root(&self) -> f64 {
        (self.sum / self.count.max(1) as f64).sqrt()
    }
}

fn sd(x: &[f64]) -> f64 {
    let mean = x.iter().sum::<f64>() / x.len().max(1) as f64;
    rms(&x.iter().map(|x| x - mean).collect::<Vec<_>>())
}

fn difference(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}
