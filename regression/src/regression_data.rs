//! What the candidates are evaluated on: the motion of all logs and what the nominal model makes of it.

use std::ops::{Deref, Range};
use std::sync::{Arc, OnceLock};

use nalgebra::{SMatrix, SVector};
use rayon::prelude::*;
use tribo_friction::law::smooth_sign;
use tribo_logs::RobotLog;
use tribo_robot::{Kinematics, link_regressor, mass_matrix, rnea};

use crate::column::{Column, FineColumn};
use crate::filter::{Knots, central_difference};
use crate::logged_motion::{Burst, LoggedMotion};
use crate::{DiagnoseError, MotionSample, Nominal, ResidualError};

/// What the nominal model makes of one stamp on the uniform grid of a burst, before the band filter.
#[derive(Clone, Copy, Debug)]
pub struct ModelSample<const N: usize> {
    /// tanh(qd/smoothing).
    pub sign: SVector<f64, N>,
    /// Torque of the rigid links, without rotors (Nm).
    pub link_nm: SVector<f64, N>,
    /// Friction of the nominal laws (Nm).
    pub friction_nm: SVector<f64, N>,
    /// The nominal model, effects included (Nm).
    pub model_nm: SVector<f64, N>,
}

/// One stamp on the uniform grid of a burst: motion, measured torque and what the nominal model makes of it.
#[derive(Clone, Copy, Debug)]
pub struct Sample<'d, const N: usize> {
    /// Time (s).
    pub time_s: f64,
    /// Joint positions (rad).
    pub q: &'d SVector<f64, N>,
    /// Joint velocities (rad/s).
    pub qd: &'d SVector<f64, N>,
    /// Joint accelerations (rad/s²).
    pub qdd: &'d SVector<f64, N>,
    /// tanh(qd/smoothing).
    pub sign: &'d SVector<f64, N>,
    /// Torque of the rigid links, without rotors (Nm).
    pub link_nm: &'d SVector<f64, N>,
    /// The nominal model, effects included (Nm).
    pub model_nm: &'d SVector<f64, N>,
    /// Measured torque, unfiltered (Nm).
    pub measured_nm: &'d SVector<f64, N>,
}

/// Everything the candidates read.
#[derive(Debug)]
pub struct RegressionData<const N: usize> {
    /// What the logs say; several models share it.
    pub logged: Arc<LoggedMotion<N>>,
    /// The model that the logs are held against.
    pub nominal: Nominal<N>,
    /// What the nominal model makes of the motion, on the fine grid.
    pub of_model: Vec<ModelSample<N>>,
    /// Filtered nominal torque (Nm) per joint.
    pub model_nm: [Vec<f64>; N],
    /// Filtered residual (Nm) per joint.
    pub residual_nm: [Vec<f64>; N],
    /// RMS of all sensor noise in the band (Nm).
    pub noise_floor_nm: SVector<f64, N>,
    /// Filtered regressors of every link, ten columns each, on first use.
    link_regressors: OnceLock<Arc<Vec<[Column<N>; 10]>>>,
    /// See [`Self::standing`], on first use.
    standing: [OnceLock<Vec<f64>>; N],
    /// See [`Self::noise_weights`], on first use.
    noise_weights: [OnceLock<Vec<f64>>; N],
}

/// Residual energy with the motor's encoder over that with the joint's, below which the motor's is believed.
const MOTOR_SIDE_GAIN: f64 = 0.98;
/// Velocity over the lattice's error of it from which on a joint counts as creeping.
const CREEPING: f64 = 0.2;
/// Joints slower than this many standard deviations of velocity noise count as standing.
const STANDING_SD: f64 = 4.0;
/// Widths of the smooth sign below which a joint may be stuck.
const STANDING_WIDTHS: f64 = 3.0;

impl<const N: usize> Deref for RegressionData<N> {
    type Target = LoggedMotion<N>;

    fn deref(&self) -> &LoggedMotion<N> {
        &self.logged
    }
}

impl<const N: usize> RegressionData<N> {
    /// Filters the logs and evaluates the nominal model along them; `band_hz` `None` chooses the band from the noise.
    pub fn of_logs(logs: &[RobotLog], nominal: &Nominal<N>, band_hz: Option<f64>) -> Result<Self, DiagnoseError> {
        Self::of_motion(&Arc::new(LoggedMotion::of_logs(logs, &nominal.arm, band_hz)?), nominal)
    }

    /// Evaluates the nominal model along the motion of logs.
    ///
    /// # Errors
    /// [`DiagnoseError`] of a model that is not finite.
    #[inline(never)]
    pub fn of_motion(logged: &Arc<LoggedMotion<N>>, nominal: &Nominal<N>) -> Result<Self, DiagnoseError> {
        let inertia = mass_matrix(&nominal.arm, &logged.middle_rad).diagonal();
        let nominal = nominal.with_rigid_effects_in_the_arm();
        let mut data = Self {
            logged: Arc::clone(logged),
            of_model: rigid_samples(logged, &nominal)?,
            nominal,
            model_nm: std::array::from_fn(|_| Vec::new()),
            residual_nm: std::array::from_fn(|_| Vec::new()),
            noise_floor_nm: SVector::zeros(),
            link_regressors: OnceLock::new(),
            standing: std::array::from_fn(|_| OnceLock::new()),
            noise_weights: std::array::from_fn(|_| OnceLock::new()),
        };
        if data.nominal.sticks {
            data.bridge_short_rests();
        }
        data.believe_motor_encoders();
        data.add_nominal_effects();
        data.filter_model();
        data.set_noise_floor(&inertia);
        Ok(data)
    }

    /// The samples on the fine grid.
    pub fn samples(&self) -> impl ExactSizeIterator<Item = Sample<'_, N>> {
        self.motion.iter().zip(&self.of_model).zip(&self.raw_nm).map(|((at, of_model), measured_nm)| {
            let MotionSample { time_s, q, qd, qdd } = at;
            let ModelSample { sign, link_nm, model_nm, .. } = of_model;
            Sample { time_s: *time_s, q, qd, qdd, sign, link_nm, model_nm, measured_nm }
        })
    }

    /// Square of the torque noise (Nm²) that velocity noise makes of a joint through the slope of nominal friction, sample by sample.
    fn sign_noise_squares(&self, j: usize) -> Vec<f64> {
        let step = self.velocity_sd_rad_s[j].max(1e-6);
        let friction = self.nominal.sliding_friction(j);
        let [creeping, moving] = [0.0, self.coarse_velocity_rad_s[j]]
            .map(|coarse| self.velocity_sd_in_band_rad_s[j].powi(2) + f64::powi(coarse, 2));
        let square = |at: &MotionSample<N>| {
            let qd = at.qd[j];
            let slope = (friction.torque_nm(qd + step) - friction.torque_nm(qd - step)) / (2.0 * step);
            // A joint at rest stays on its step of the lattice.
            slope.powi(2) * if qd.abs() > CREEPING * self.coarse_velocity_rad_s[j] { moving } else { creeping }
        };
        self.motion.iter().map(square).collect()
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
            let stands = |at: &MotionSample<N>| f64::from(u8::from(at.qd[joint].abs() < threshold));
            self.filter_own(&self.motion.iter().map(stands).collect::<Vec<f64>>())
        })
    }

    /// With two encoders, friction and rotors follow the motor: `f(theta') + Ir theta''` in place of `f(q') + Ir q''`,
    /// joint by joint where that leaves a smaller residual (an elastic joint shows it; a rigid one does not care).
    fn believe_motor_encoders(&mut self) {
        let logged = Arc::clone(&self.logged);
        let Some(deflection) = &logged.deflection_rad else { return };
        for j in 0..N {
            let mut corrected = self.of_model.clone();
            for burst in &logged.bursts {
                let dt_s = logged.period_s(burst);
                let angle: Vec<f64> = deflection[burst.fine.clone()].iter().map(|d| d[j]).collect();
                let rate = central_difference(&angle, dt_s);
                let acceleration = central_difference(&rate, dt_s);
                for (i, k) in burst.fine.clone().enumerate() {
                    let at = &mut corrected[k];
                    let motor_qd = logged.motion[k].qd[j] + rate[i];
                    let friction_nm = self.nominal.friction.joints[j].torque(motor_qd, self.nominal.smoothing_rad_s);
                    let rotor_nm = self.nominal.arm.rotor_inertia_kg_m2[j] * acceleration[i];
                    at.model_nm[j] += friction_nm - at.friction_nm[j] + rotor_nm;
                    at.friction_nm[j] = friction_nm;
                    at.sign[j] = smooth_sign(motor_qd, self.nominal.smoothing_rad_s);
                }
            }
            let left = |of_model: &[ModelSample<N>]| {
                let model = self.filter_own(&of_model.iter().map(|at| at.model_nm[j]).collect::<Vec<f64>>());
                self.measured_nm[j].iter().zip(model).map(|(measured, model)| (measured - model).powi(2)).sum::<f64>()
            };
            if left(&corrected) < MOTOR_SIDE_GAIN * left(&self.of_model) {
                self.of_model = corrected;
            }
        }
    }

    /// Band filter and residual.
    fn filter_model(&mut self) {
        self.model_nm = self.filter_joints(|j| self.of_model.iter().map(|at| at.model_nm[j]).collect());
        for j in 0..N {
            let pairs = self.logged.measured_nm[j].iter().zip(&self.model_nm[j]);
            self.residual_nm[j] = pairs.map(|(measured, model)| measured - model).collect();
        }
    }

    /// Regressors of every link in its ten inertial parameters, in the band.
    pub fn link_regressors(&self) -> &[[Column<N>; 10]] {
        self.link_regressors.get_or_init(|| Arc::new((0..N).map(|link| self.link_regressor(link)).collect()))
    }

    /// Takes over the regressors of links from data of the same motion: they are a matter of motion, geometry and gravity alone.
    pub fn borrow_regressors(&mut self, other: &Self) {
        let same_gravity = self.nominal.arm.gravity_m_s2 == other.nominal.arm.gravity_m_s2;
        if same_gravity && Arc::ptr_eq(&self.logged, &other.logged) {
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
        value: impl Fn(&MotionSample<N>) -> SMatrix<f64, N, K>,
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
            let values: Vec<SMatrix<f64, N, K>> = knots.places().map(|k| value(&self.motion[part.start + k])).collect();
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
        FineColumn::Joint(joint, self.samples().map(|at| value(&at)).collect())
    }

    /// The Jacobian of the flange at some joint positions (rad), linear rows first: force then moment map through its transpose.
    pub fn jacobian(&self, q: &SVector<f64, N>) -> SMatrix<f64, 6, N> {
        let angular_first = Kinematics::at(&self.nominal.arm, q).jacobian();
        SMatrix::from_fn(|row, column| angular_first[((row + 3) % 6, column)])
    }

    /// Whether the joint turns one way only, so that dry friction is a constant.
    pub fn moves_one_way(&self, joint: usize) -> bool {
        let count = |way: f64| self.of_model.iter().filter(|at| way * at.sign[joint] > 0.9).count();
        self.moves(joint) && count(1.0).min(count(-1.0)) * 50 < self.of_model.len()
    }

    /// Sensor noise in the band: torque noise, and position noise through two derivatives and the inertia and through one
    /// and the slope of friction, which is steep where the joint turns back.
    fn set_noise_floor(&mut self, inertia: &SVector<f64, N>) {
        let rigid_nm = inertia.component_mul(&self.acceleration_sd_rad_s2);
        self.noise_floor_nm = SVector::from_fn(|j, _| {
            let squares: f64 = self.sign_noise_squares(j).iter().sum();
            let from_friction = squares / self.motion.len().max(1) as f64;
            (self.torque_floor_nm[j].powi(2) + rigid_nm[j].powi(2) + from_friction).sqrt()
        });
    }
}

/// Rigid body, rotors and friction along the motion.
fn rigid_samples<const N: usize>(
    logged: &LoggedMotion<N>,
    nominal: &Nominal<N>,
) -> Result<Vec<ModelSample<N>>, ResidualError> {
    let link_arm = nominal.arm.clone().link_side();
    let sample = |(k, at): (usize, &MotionSample<N>)| {
        let MotionSample { time_s, q, qd, qdd } = at;
        let link_nm = match &logged.raw_link_nm {
            Some(measured) => measured[k],
            None => rnea(&link_arm, q, qd, qdd),
        };
        if let Some(joint) = (0..N).find(|j| !link_nm[*j].is_finite()) {
            return Err(ResidualError::ModelNotFinite { joint, time_s: *time_s });
        }
        let friction_nm = nominal.friction.torque(qd, nominal.smoothing_rad_s);
        let rotor_nm = nominal.arm.rotor_inertia_kg_m2.component_mul(qdd);
        let sign = qd.map(|v| smooth_sign(v, nominal.smoothing_rad_s));
        Ok(ModelSample { sign, link_nm, friction_nm, model_nm: link_nm + rotor_nm + friction_nm })
    };
    let mut samples = Vec::with_capacity(logged.motion.len());
    for at in logged.motion.iter().enumerate() {
        samples.push(sample(at)?);
    }
    Ok(samples)
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
