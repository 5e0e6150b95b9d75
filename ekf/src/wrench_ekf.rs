//! The wrench filter.

use nalgebra::{Matrix3, Matrix6, SMatrix, SVector, Vector3, Vector6};
use tribo_robot::{
    ControlTerms, EstimateFault, EstimatorInput, Pose, SensorFrame, SpdFactor, Twist, Wrench, WrenchEstimate,
    WrenchEstimator, product, product_transposed, so3,
};

use crate::{AugmentedCovariance, KnownInput, MeasurementNoise, WrenchEkfSettings};

/// Evidence of one update.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Innovation {
    /// `[log(R_y R̂ᵀ); p_y − p̂]` [rad; m], base axes.
    pub innovation: Vector6<f64>,
    /// Its covariance S = C P Cᵀ + R.
    pub covariance: Matrix6<f64>,
    /// Normalised innovation squared `νᵀ S⁻¹ ν`, chi-square with 6 degrees of freedom when the filter is honest.
    pub nis: f64,
}

/// `W = Λ J B⁻¹`, Λ = (J B⁻¹ Jᵀ)⁻¹: how a torque (Nm) that the model does not know shows in the filter's wrench
/// `[moment; force]`, base axes. `None` where B or Λ cannot be factored.
#[inline]
pub fn wrench_from_torque<const N: usize>(terms: &ControlTerms<N>) -> Option<SMatrix<f64, 6, N>> {
    let j_b_inverse = SpdFactor::of(&terms.mass_matrix)?.right_solve(&terms.jacobian);
    let lambda_inverse = SpdFactor::of(&product_transposed(&j_b_inverse, &terms.jacobian))?;
    Some(lambda_inverse.right_solve(&j_b_inverse.transpose()).transpose())
}

/// 18-state extended Kalman filter of the tool wrench; see the crate documentation for its law.
#[derive(Clone, Debug)]
pub struct WrenchEkf {
    settings: WrenchEkfSettings,
    posterior: Posterior,
    innovation: Option<Innovation>,
}

/// The state and its covariance.
#[derive(Clone, Copy, Debug)]
struct Posterior {
    twist: Vector6<f64>,
    position: Vector3<f64>,
    rotation: Matrix3<f64>,
    wrench: Vector6<f64>,
    covariance: AugmentedCovariance,
}

impl Posterior {
    /// Known exactly: at rest at a pose, without a wrench.
    fn at(pose: &Pose) -> Self {
        let zero = Vector6::zeros();
        Self {
            twist: zero,
            position: pose.translation.vector,
            rotation: *pose.rotation.matrix(),
            wrench: zero,
            covariance: AugmentedCovariance::diagonal(&zero, &zero, &zero),
        }
    }

    /// `pose ⊖ x̂ = [log(R R̂ᵀ); p − p̂]`, base axes.
    #[inline]
    fn pose_difference(&self, pose: &Pose) -> Vector6<f64> {
        let r = so3::log(&(pose.rotation.matrix() * self.rotation.transpose()));
        let p = pose.translation.vector - self.position;
        Vector6::new(r.x, r.y, r.z, p.x, p.y, p.z)
    }
}

impl WrenchEkf {
    /// A filter that knows nothing yet; [`WrenchEstimator::reset`] places it.
    pub fn new(settings: WrenchEkfSettings) -> Self {
        let mut ekf = Self { settings, posterior: Posterior::at(&Pose::identity()), innovation: None };
        ekf.place(&Pose::identity());
        ekf
    }

    /// The settings.
    pub fn settings(&self) -> &WrenchEkfSettings {
        &self.settings
    }

    /// Covariance of (v, x, h).
    pub fn covariance(&self) -> &AugmentedCovariance {
        &self.posterior.covariance
    }

    /// Evidence of the last update.
    pub fn innovation(&self) -> Option<&Innovation> {
        self.innovation.as_ref()
    }

    /// Estimation error `[v − v̂; x ⊖ x̂; h − ĥ]` against a known truth, for consistency tests: NEES = eᵀ P⁻¹ e.
    pub fn error(&self, twist: &Twist, pose: &Pose, wrench: &Wrench) -> SVector<f64, 18> {
        let mut e = SVector::<f64, 18>::zeros();
        e.fixed_rows_mut::<6>(0).copy_from(&(twist.to_vector() - self.posterior.twist));
        e.fixed_rows_mut::<6>(6).copy_from(&self.posterior.pose_difference(pose));
        e.fixed_rows_mut::<6>(12).copy_from(&(wrench.to_vector() - self.posterior.wrench));
        e
    }

    /// `v ← v + dt (u − Λ⁻¹ h)`, `x ← x ⊕ (dt v + dt²/2 (u − Λ⁻¹ h))`, `h ← h`.
    #[inline]
    pub fn predict(&mut self, u: &Vector6<f64>, lambda_inverse: &Matrix6<f64>, dt_s: f64) {
        self.posterior = self.predicted(u, lambda_inverse, dt_s);
    }

    /// Takes the measured pose; returns `false` and changes nothing if the innovation covariance cannot be factored.
    #[inline]
    pub fn update(&mut self, pose: &Pose, measurement_covariance: &Matrix6<f64>) -> bool {
        let predicted = self.posterior;
        self.correct(&predicted, pose, measurement_covariance)
    }

    #[inline]
    fn predicted(&self, u: &Vector6<f64>, lambda_inverse: &Matrix6<f64>, dt_s: f64) -> Posterior {
        let Posterior { twist, position, rotation, wrench, covariance } = &self.posterior;
        let acceleration = u - product(lambda_inverse, wrench);
        let motion = twist * dt_s + acceleration * (0.5 * dt_s * dt_s);
        let turn: Vector3<f64> = motion.fixed_rows::<3>(0).into_owned();
        let s = &self.settings;
        let (qa, qr) = (s.acceleration_noise_m_s2.powi(2) * dt_s, s.acceleration_noise_rad_s2.powi(2) * dt_s);
        let (qf, qm) = (s.force_walk_n.powi(2) * dt_s, s.moment_walk_nm.powi(2) * dt_s);
        Posterior {
            twist: twist + acceleration * dt_s,
            position: position + motion.fixed_rows::<3>(3),
            rotation: so3::renormalized(&(so3::exp(&turn) * rotation)),
            wrench: *wrench,
            covariance: covariance.propagated(
                lambda_inverse,
                dt_s,
                &Vector6::new(qr, qr, qr, qa, qa, qa),
                &Vector6::new(qm, qm, qm, qf, qf, qf),
            ),
        }
    }

    /// Believes `predicted`, corrected by the measured pose; changes nothing if that cannot be done.
    #[inline]
    fn correct(&mut self, predicted: &Posterior, pose: &Pose, measurement_covariance: &Matrix6<f64>) -> bool {
        let s = predicted.covariance.xx + measurement_covariance;
        let Some(factor) = SpdFactor::of(&s) else {
            return false;
        };
        let innovation = predicted.pose_difference(pose);
        let whitened = factor.half(&innovation);
        let y = whitened.component_mul(factor.reciprocal_pivots());
        let nis = whitened.dot(&y);
        if !nis.is_finite() {
            return false;
        }
        let gain = predicted.covariance.pose_gain(&factor);
        let correction = product(&gain.x.0, &y);
        let turn: Vector3<f64> = correction.fixed_rows::<3>(0).into_owned();
        let posterior = &mut self.posterior;
        posterior.twist = predicted.twist + product(&gain.v.0, &y);
        posterior.wrench = predicted.wrench + product(&gain.h.0, &y);
        posterior.rotation = so3::exp(&turn) * predicted.rotation;
        posterior.position = predicted.position + correction.fixed_rows::<3>(3);
        predicted.covariance.update_into(&mut posterior.covariance, &gain);
        self.innovation = Some(Innovation { innovation, covariance: s, nis });
        true
    }

    #[inline]
    fn measurement_covariance<const N: usize>(&self, jacobian: &SMatrix<f64, 6, N>) -> Matrix6<f64> {
        match self.settings.measurement {
            MeasurementNoise::Diagonal { position_m, rotation_rad } => {
                let (p, r) = (position_m * position_m, rotation_rad * rotation_rad);
                let mut covariance = Matrix6::zeros();
                for (i, variance) in [r, r, r, p, p, p].into_iter().enumerate() {
                    covariance[(i, i)] = variance;
                }
                covariance
            }
            MeasurementNoise::Encoder { sd_rad } => product_transposed(jacobian, jacobian) * (sd_rad * sd_rad),
        }
    }

    fn place(&mut self, pose: &Pose) {
        let s = &self.settings;
        let (f, m) = (s.initial_force_sd_n.powi(2), s.initial_moment_sd_nm.powi(2));
        // At rest to within a centimetre per second; the first pose is exact to the encoder, far below this.
        let (v, w, p, r) = (1e-4, 1e-3, 1e-8, 1e-8);
        self.posterior = Posterior {
            covariance: AugmentedCovariance::diagonal(
                &Vector6::new(w, w, w, v, v, v),
                &Vector6::new(r, r, r, p, p, p),
                &Vector6::new(m, m, m, f, f, f),
            ),
            ..Posterior::at(pose)
        };
        self.innovation = None;
    }

    fn estimate(&self) -> WrenchEstimate {
        WrenchEstimate {
            wrench_base: Wrench::from_vector(&self.posterior.wrench),
            covariance: self.posterior.covariance.hh,
            nis: self.innovation.map(|innovation| innovation.nis),
            limits95: None,
            fault: None,
        }
    }
}

impl<const N: usize> WrenchEstimator<N> for WrenchEkf {
    fn reset(&mut self, _frame: &SensorFrame<N>, terms: &ControlTerms<N>) {
        self.place(&terms.base_from_flange);
    }

    #[inline(never)]
    fn step(&mut self, input: &EstimatorInput<'_, N>) -> WrenchEstimate {
        let terms = input.terms;
        let jacobian = &terms.jacobian;
        if let Err(fault) = input.check() {
            return self.estimate().held(fault);
        }
        let Some(mass) = SpdFactor::of(&terms.mass_matrix) else {
            return self.estimate().held(EstimateFault::NotPositiveDefinite);
        };
        // J B⁻¹ x = half D⁻¹ (L⁻¹ x)
        let (half, scaled) = mass.right_half(jacobian);
        let lambda_inverse = product_transposed(&scaled, &half);
        let u = match self.settings.known_input {
            KnownInput::AppliedTorque => {
                let net = input.tau_motor - input.tau_friction - terms.bias_nm();
                product(&half, &mass.half(&net).component_mul(mass.reciprocal_pivots())) + terms.jdot_qd
            }
            KnownInput::CommandedAcceleration => *input.acceleration_command,
        };
        let r = self.measurement_covariance(jacobian);
        let predicted = self.predicted(&u, &lambda_inverse, input.dt_s);
        if self.correct(&predicted, &terms.base_from_flange, &r) {
            self.estimate()
        } else {
            self.estimate().held(EstimateFault::NotPositiveDefinite)
        }
    }

    /// Two thirds of the filter's 2 Hz group delay scale `2/w0`, `w0 = (q_h²/(Λ² r² dt))^(1/6)`, is what the default
    /// settings show: 20 ms at 5 N/√s. Scaled from there by `w0 ∝ q_h^(1/3)`.
    fn delay_s(&self) -> f64 {
        0.020 * (5.0 / self.settings.force_walk_n).cbrt()
    }
}
