//! What is known of a robot with two encoders per joint.

use nalgebra::{Matrix6, SMatrix, SVector};
use tribo_robot::{Arm, Kinematics, Wrench};

use super::deflection_gp::{DeflectionGp, inputs};
use super::{DeflectionMean, Rest, StiffnessCurve, ValidDoubleEncoder};
use crate::damped_wrench::damped_wrench;

/// Hybrid model of uhlmann2023: what the joints of a free arm are deflected by, and what a wrench adds.
///
/// ```text
/// Δθ = Δθ₁ + Δθ₂,   Δθ₁: Gaussian process (5), (6), (8)–(15),   Δθ₂ = g(τ_W): stiffness (7), (16),   τ_W = Jᵀ W (17)
/// ```
///
/// | the paper | here | why |
/// |---|---|---|
/// | Δθ = θ_s − θ | motor less link angle | a positive drive torque deflects a spring forwards |
/// | inputs of the process: θ | also the direction of approach and the branch of the hysteresis | it asks for both (sections 3.1, 4): stiction and loading are not functions of the pose |
/// | Δθ₂ = g(τ_W) at any pose | `T(Δθ) − T(Δθ₁)`: the curve of the whole load | a gear that gravity has preloaded is past its soft zone; it blames this for its worst poses |
/// | m(x) = 0 | or the deflection by the model's gravity | for arms whose masses are known |
/// | W = J⁻ᵀ τ_W, six joints | weighted by the variance of every joint, any number of joints, damped | 7 joints; joint 7 is a better scale than joint 1 |
///
/// Each of the extensions is a setting. Leaves out: temperature as an input.
#[derive(Clone, Debug)]
pub struct DoubleEncoderModel<const N: usize> {
    pub(super) settings: ValidDoubleEncoder,
    pub(super) curves: [StiffnessCurve; N],
    /// One per joint, or none before a calibration.
    pub(super) processes: Vec<DeflectionGp>,
    /// Variance of what the curves leave of their loads, less what the rests themselves do not repeat (Nm²): that is in the
    /// noise of the processes.
    pub(super) misfit_nm2: [f64; N],
    pub(super) rotor_inertia_kg_m2: SVector<f64, N>,
}

/// Wrench at one rest, with what it is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestWrench<const N: usize> {
    /// Δθ₁: deflection expected without load (rad).
    pub free_deflection_rad: SVector<f64, N>,
    /// Its standard deviation (rad), for one more rest: process and what does not repeat.
    pub free_sd_rad: SVector<f64, N>,
    /// τ_W (Nm).
    pub torque_nm: SVector<f64, N>,
    /// Its standard deviation (Nm).
    pub torque_sd_nm: SVector<f64, N>,
    /// Wrench by the robot on the environment, flange, base axes.
    pub wrench_base: Wrench,
    /// Covariance of the wrench `[moment; force]`.
    pub covariance: Matrix6<f64>,
}

impl<const N: usize> DoubleEncoderModel<N> {
    /// A model before any calibration: one stiffness per joint (Nm/rad) known to a relative standard deviation, and the
    /// deflection of the free arm from gravity alone.
    ///
    /// Inputs that only a calibration gives a meaning (direction, loading) are not used; `settings.mean` is taken to be
    /// [`DeflectionMean::RigidBody`].
    pub fn nominal(
        arm: &Arm<N>,
        stiffness_nm_per_rad: [f64; N],
        relative_sd: f64,
        settings: ValidDoubleEncoder,
    ) -> Self {
        Self {
            settings,
            curves: stiffness_nm_per_rad.map(|k| StiffnessCurve::linear(k, relative_sd)),
            processes: Vec::new(),
            misfit_nm2: [0.0; N],
            rotor_inertia_kg_m2: arm.rotor_inertia_kg_m2,
        }
    }

    /// The settings.
    pub fn settings(&self) -> &ValidDoubleEncoder {
        &self.settings
    }

    /// Stiffness of every joint.
    pub fn curves(&self) -> &[StiffnessCurve; N] {
        &self.curves
    }

    /// The process of every joint; empty before a calibration.
    pub fn processes(&self) -> &[DeflectionGp] {
        &self.processes
    }

    /// m(x) of joint j (rad) under the model's gravity torque (Nm).
    #[inline]
    pub(super) fn mean_rad(&self, j: usize, gravity_nm: f64) -> f64 {
        let known = self.settings.mean == DeflectionMean::RigidBody || self.processes.is_empty();
        if known { self.curves[j].deflection_rad(gravity_nm) } else { 0.0 }
    }

    /// τ_W of joint j (Nm) and its variance (Nm²) at a deflection (rad), where `free_rad` with a variance (rad²) is expected.
    #[inline]
    pub(super) fn load_torque_nm(
        &self,
        j: usize,
        free_rad: f64,
        free_variance: f64,
        deflection_rad: f64,
    ) -> (f64, f64) {
        let curve = &self.curves[j];
        let (from, to) =
            if self.settings.preload { (free_rad, deflection_rad) } else { (0.0, deflection_rad - free_rad) };
        let (torque, by_slopes) = curve.torque_between_nm(from, to);
        let stiffness = curve.stiffness_nm_per_rad(if self.settings.preload { free_rad } else { to });
        (torque, by_slopes + self.misfit_nm2[j] + stiffness * stiffness * free_variance)
    }

    /// Expected free deflections (rad) and their standard deviations for one more rest, by the exact processes.
    pub fn free_deflections(&self, arm: &Arm<N>, rests: &[Rest<N>]) -> Vec<[SVector<f64, N>; 2]> {
        let repeat_sd = self.settings.encoder_sd_rad;
        let mut out: Vec<[SVector<f64, N>; 2]> = rests
            .iter()
            .map(|rest| {
                let gravity = Kinematics::at(arm, &rest.q).gravity_torque(arm);
                [SVector::from_fn(|j, _| self.mean_rad(j, gravity[j])), SVector::repeat(repeat_sd)]
            })
            .collect();
        for (j, process) in self.processes.iter().enumerate() {
            let rows: Vec<Vec<f64>> = rests.iter().map(|rest| input_row(&self.settings, j, rest)).collect();
            for (out, posterior) in out.iter_mut().zip(process.predict_rad(&rows)) {
                out[0][j] += posterior.mean;
                out[1][j] = posterior.sd.hypot(process.noise_rad());
            }
        }
        out
    }

    /// The wrench at each rest, by the exact processes; `None` where it cannot be solved for.
    ///
    /// For arms at rest and off the tick; the estimator does the same while the arm moves.
    pub fn wrenches(&self, arm: &Arm<N>, rests: &[Rest<N>]) -> Vec<Option<RestWrench<N>>> {
        let damping = [self.settings.moment_damping_nm, self.settings.force_damping_n];
        let free = self.free_deflections(arm, rests);
        rests
            .iter()
            .zip(free)
            .map(|(rest, [free_deflection_rad, free_sd_rad])| {
                let (mut torque_nm, mut covariance) = (SVector::<f64, N>::zeros(), SMatrix::<f64, N, N>::zeros());
                for j in 0..N {
                    let variance = free_sd_rad[j] * free_sd_rad[j];
                    (torque_nm[j], covariance[(j, j)]) =
                        self.load_torque_nm(j, free_deflection_rad[j], variance, rest.deflection_rad[j]);
                }
                let torque_sd_nm = covariance.diagonal().map(f64::sqrt);
                let jacobian = Kinematics::at(arm, &rest.q).jacobian();
                let (h, covariance) = damped_wrench(&jacobian, &covariance, &torque_nm, damping)?;
                let wrench_base = Wrench::from_vector(&h);
                Some(RestWrench { free_deflection_rad, free_sd_rad, torque_nm, torque_sd_nm, wrench_base, covariance })
            })
            .collect()
    }
}

/// Inputs of joint j's process as a row.
pub(super) fn input_row<const N: usize>(settings: &ValidDoubleEncoder, j: usize, rest: &Rest<N>) -> Vec<f64> {
    let (mut q, mut approach) = (SVector::<f64, N>::zeros(), [0.0; 2]);
    let count = inputs(settings, j, rest, &mut q, &mut approach);
    q.iter().chain(&approach).copied().take(count).collect()
}
