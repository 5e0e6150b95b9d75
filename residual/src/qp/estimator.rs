//! The friction-band estimate in the tick.

use nalgebra::{Matrix6, SMatrix, SVector, Vector6};
use tribo_robot::{
    ControlTerms, EstimateFault, EstimatorInput, LAMBDA_95, SensorFrame, Wrench, WrenchEstimate, WrenchEstimator,
    WrenchLimits,
};

use super::{BandObserver, BoxOutcome, ForcePrior, ForceSolver};
use crate::BandOf;
use crate::momentum::{OBSERVER_GAIN_RAD_S, PANDA_TORQUE_SD_NM, PANDA_VELOCITY_SD_RAD_S};
use tribo_friction::FrictionBand;

/// Settings of [`QpEstimator`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QpSettings<const N: usize> {
    /// The friction of the joints, as the observer of the same gain sees it.
    pub band: FrictionBand<N>,
    /// Prior of the wrench `[moment; force]`, base axes.
    pub prior: ForcePrior<6>,
    /// Gain of the momentum observer that supplies the torque (rad/s).
    pub gain_rad_s: f64,
    /// What the band holds.
    pub band_of: BandOf,
    /// White noise of the torque, per sample (Nm).
    pub torque_sd_nm: SVector<f64, N>,
    /// Noise of the velocity signal (rad/s).
    pub velocity_sd_rad_s: SVector<f64, N>,
    /// Whether every estimate has its twelve 95 % limits; without them its interval is that of the covariance.
    pub limits: bool,
    /// Whether a standing joint has only the part of its band that fits how it came to rest ([`BandObserver::with_rest_memory`]):
    /// right where `tau_friction` of the input is what the controller added, too narrow for a log of which nobody knows that.
    pub remembers_rest: bool,
}

impl<const N: usize> QpSettings<N> {
    /// A hand's contact as the prior (30 N, 3 Nm), K = 50 rad/s and the sensors of a Panda as the momentum estimator, the
    /// band for the whole friction, limits on, all of the band at rest.
    pub fn new(band: FrictionBand<N>) -> Self {
        Self {
            band,
            prior: diagonal_prior(30.0, 3.0),
            gain_rad_s: OBSERVER_GAIN_RAD_S,
            band_of: BandOf::Friction,
            torque_sd_nm: SVector::repeat(PANDA_TORQUE_SD_NM),
            velocity_sd_rad_s: SVector::repeat(PANDA_VELOCITY_SD_RAD_S),
            limits: true,
            remembers_rest: false,
        }
    }
}

/// Prior of a wrench `[moment; force]` around zero with these standard deviations on every axis.
pub fn diagonal_prior(force_sd_n: f64, moment_sd_nm: f64) -> ForcePrior<6> {
    let (f, m) = (force_sd_n * force_sd_n, moment_sd_nm * moment_sd_nm);
    ForcePrior { mean: Vector6::zeros(), covariance: Matrix6::from_diagonal(&Vector6::new(m, m, m, f, f, f)) }
}

/// Most likely wrench with friction anywhere in its band (linderoth2013), 1 kHz:
///
/// ```text
/// r = Jᵀ h + tau_f + e,   lower ≤ tau_f ≤ upper,   h ~ N(h̄, R_F),   e ~ N(0, R_e)
/// R_e = diag(σ²(1 + k|q̇|)²) + a/(2 − a) diag(σ_τ²) + K² M diag(σ_v²) M
/// ```
///
/// The paper's R_e is the first term. The others are what the sensors' noise makes of r: a velocity of one joint is a momentum
/// of all it is coupled to, and an interval that does not know that is too narrow on one axis and too wide on the next.
///
/// r, J and the bounds come from a [`BandObserver`] of the whole motor torque: the momentum in it takes inertia and gravity
/// away, where the paper neglects inertia, and low-passes, where the paper filters with (5).
///
/// With [`BandOf::Remainder`] r and tau_f are those left by the friction believed.
/// [`WrenchEstimate::covariance`] is that of the joints at a bound of their band; [`WrenchEstimate::limits95`] are the
/// limits of section II-E, exact in the Gaussian case, approximate otherwise.
#[derive(Clone, Copy, Debug)]
pub struct QpEstimator<const N: usize> {
    settings: QpSettings<N>,
    observer: BandObserver<N>,
    solver: ForceSolver<N, 6>,
    estimate: WrenchEstimate,
}

impl<const N: usize> QpEstimator<N> {
    /// An estimator that knows nothing yet; [`WrenchEstimator::reset`] places it.
    pub fn new(settings: QpSettings<N>) -> Self {
        let observer = BandObserver::new(settings.band, settings.band_of, settings.gain_rad_s)
            .with_sensor_noise(settings.torque_sd_nm, settings.velocity_sd_rad_s);
        Self {
            settings,
            observer: if settings.remembers_rest { observer.with_rest_memory() } else { observer },
            solver: ForceSolver::new(settings.prior),
            estimate: WrenchEstimate::none_yet(),
        }
    }

    /// The settings.
    pub fn settings(&self) -> &QpSettings<N> {
        &self.settings
    }

    /// How a torque (Nm) that neither band nor model holds shows in the wrench, at a state: `W = P J R_e⁻¹` over the joints
    /// whose band is closed there. `dt_s` is the period.
    pub fn wrench_from_torque(
        &self,
        terms: &ControlTerms<N>,
        qd: &SVector<f64, N>,
        dt_s: f64,
    ) -> Option<SMatrix<f64, 6, N>> {
        let mut noise = self.observer.noise_covariance_nm2(terms, qd, dt_s);
        let mut jacobian = terms.jacobian;
        for j in (0..N).filter(|&j| self.settings.band.joints()[j].doubt(qd[j]) >= HALF) {
            // Whatever such a joint shows may be friction: it says nothing of the wrench.
            jacobian.column_mut(j).fill(0.0);
            noise.column_mut(j).fill(0.0);
            noise.row_mut(j).fill(0.0);
            noise[(j, j)] = 1.0;
        }
        let weighted = noise.cholesky()?.solve(&jacobian.transpose()).transpose();
        let information = weighted * jacobian.transpose() + self.settings.prior.covariance.try_inverse()?;
        Some(information.cholesky()?.solve(&weighted))
    }

    /// Limit in any direction v `[moment; force]` of the wrench of the last step, `lambda` standard deviations out; see
    /// [`ForceSolver::limit`].
    ///
    /// # Errors
    /// [`EstimateFault::NotPositiveDefinite`] or [`EstimateFault::NotConverged`].
    pub fn limit(&mut self, v: &Vector6<f64>, lambda: f64) -> Result<f64, EstimateFault> {
        self.solver.limit(v, lambda).map(|limit| limit.value).map_err(fault_of)
    }

    /// Estimate and limits for the present residual and bounds.
    #[inline]
    fn solve(&mut self) -> Result<WrenchEstimate, BoxOutcome> {
        let estimate = self.solver.estimate(&self.observer.problem())?;
        let limits95 = if self.settings.limits { Some(self.limits95()?) } else { None };
        let wrench_base = Wrench::from_vector(&estimate.force);
        Ok(WrenchEstimate { wrench_base, covariance: estimate.covariance, limits95, nis: None, fault: None })
    }

    #[inline]
    fn limits95(&mut self) -> Result<WrenchLimits, BoxOutcome> {
        let (mut lower, mut upper) = (Vector6::zeros(), Vector6::zeros());
        for axis in 0..6 {
            let mut v = Vector6::zeros();
            v[axis] = 1.0;
            upper[axis] = self.solver.limit(&v, LAMBDA_95)?.value;
            v[axis] = -1.0;
            lower[axis] = -self.solver.limit(&v, LAMBDA_95)?.value;
        }
        Ok(WrenchLimits { lower: Wrench::from_vector(&lower), upper: Wrench::from_vector(&upper) })
    }
}

impl<const N: usize> WrenchEstimator<N> for QpEstimator<N> {
    fn reset(&mut self, frame: &SensorFrame<N>, terms: &ControlTerms<N>) {
        self.observer.start(frame, terms);
        self.solver.reset();
        self.estimate = WrenchEstimate::none_yet();
    }

    #[inline(never)]
    fn step(&mut self, input: &EstimatorInput<'_, N>) -> WrenchEstimate {
        if let Err(fault) = input.check() {
            return self.estimate.held(fault);
        }
        let before = (self.observer, self.solver);
        self.observer.step(input);
        match self.solve() {
            Ok(estimate) => self.estimate = estimate,
            Err(outcome) => {
                (self.observer, self.solver) = before;
                return self.estimate.held(fault_of(outcome));
            }
        }
        self.estimate
    }

    /// 1/K.
    fn delay_s(&self) -> f64 {
        1.0 / self.settings.gain_rad_s
    }
}

/// Doubt below which a joint counts as sliding.
const HALF: f64 = 0.5;

#[inline]
fn fault_of(outcome: BoxOutcome) -> EstimateFault {
    match outcome {
        BoxOutcome::PivotLimit => EstimateFault::NotConverged,
        BoxOutcome::NotPositiveDefinite | BoxOutcome::Converged => EstimateFault::NotPositiveDefinite,
    }
}
