//! Wrench from the residual of the momentum observer.

use nalgebra::{SMatrix, SVector};
use tribo_robot::{ControlTerms, EstimateFault, EstimatorInput, SensorFrame, Wrench, WrenchEstimate, WrenchEstimator};

use super::{MomentumObserver, OBSERVER_GAIN_RAD_S, PANDA_TORQUE_SD_NM, PANDA_VELOCITY_SD_RAD_S};
use crate::BandOf;
use crate::damped_wrench::{damped_wrench, weighted_inverse};
use tribo_friction::{FrictionBand, RemainingFriction, RestMemory, UNBOUNDED_NM2};

/// Settings of [`MomentumEstimator`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MomentumSettings<const N: usize> {
    /// Gain K of the observer (rad/s).
    pub gain_rad_s: f64,
    /// White noise of the torque, per sample (Nm).
    pub torque_sd_nm: SVector<f64, N>,
    /// Noise of the velocity signal (rad/s).
    pub velocity_sd_rad_s: SVector<f64, N>,
    /// Friction that may really act, however much of it is believed.
    pub friction: FrictionBand<N>,
    /// What that band is about.
    pub band_of: BandOf,
    /// Force (N) beyond which a direction that the joints cannot see is cut off: the damping of the inverse.
    pub force_damping_n: f64,
    /// The same for the moment (Nm).
    pub moment_damping_nm: f64,
}

impl<const N: usize> MomentumSettings<N> {
    /// K = 50 rad/s (8 Hz, 20 ms as the default of the wrench filter), the sensors of a Panda (0.05 Nm per sample,
    /// 3 mrad/s), and damping far above any contact: it takes 1e-4 off a wrench that is seen to 1 % of it.
    pub fn new(friction: FrictionBand<N>) -> Self {
        Self {
            gain_rad_s: OBSERVER_GAIN_RAD_S,
            torque_sd_nm: SVector::repeat(PANDA_TORQUE_SD_NM),
            velocity_sd_rad_s: SVector::repeat(PANDA_VELOCITY_SD_RAD_S),
            friction,
            band_of: BandOf::Friction,
            force_damping_n: 500.0,
            moment_damping_nm: 100.0,
        }
    }
}

/// Weighted, damped inverse of Jᵀ on the observer's residual r:
///
/// ```text
/// ĥ = P J R⁻¹ (r − f̄),   P = (J R⁻¹ Jᵀ + D⁻²)⁻¹,   cov(ĥ) = P       J and f̄ as late as r
/// R = a/(2 − a) diag(σ_τ²) + K² M diag(σ_v²) M + diag(σ_f²),   a = 1 − exp(−K dt)
/// f̄, σ_f² of RestMemory             for a band about the friction
/// f̄ = 0, σ_f² = m² + w²/2 + noise²  for one about the remainder: middle and half-width of what is left
/// ```
///
/// r is taken from the torque less the friction believed, f̄ is what the band expects beyond that belief. Friction is slower than
/// 1/K and passes the observer as it is. In a joint that sticks it is what the joint came to rest with, or what pushes have
/// made of it since ([`RestMemory`]). The error of that is a *bias* for as long as the joint sticks, not noise: the
/// covariance is right over poses and directions, not along one standstill.
/// D = diag(moment damping, force damping) is the standard deviation of a prior around zero; towards a singular pose P
/// tends to D² along the lost direction.
///
/// ```
/// use tribo_friction::{FrictionBand, JointBand};
/// use tribo_residual::{MomentumEstimator, MomentumSettings};
/// use tribo_robot::WrenchEstimator;
///
/// let band = FrictionBand::new([JointBand::frictionless(0.02); 7])?;
/// let observer = MomentumEstimator::new(MomentumSettings { gain_rad_s: 40.0, ..MomentumSettings::new(band) });
/// assert_eq!(observer.delay_s(), 0.025);
/// # Ok::<(), tribo_friction::BandError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct MomentumEstimator<const N: usize> {
    settings: MomentumSettings<N>,
    observer: MomentumObserver<N>,
    rest: RestMemory<N>,
    /// f̄ as late as the residual (Nm).
    expected_nm: SVector<f64, N>,
    estimate: WrenchEstimate,
}

impl<const N: usize> MomentumEstimator<N> {
    /// An estimator that knows nothing yet; [`WrenchEstimator::reset`] places it.
    pub fn new(settings: MomentumSettings<N>) -> Self {
        let observer = MomentumObserver::new(settings.gain_rad_s);
        let (rest, expected_nm) = (RestMemory::default(), SVector::zeros());
        Self { settings, observer, rest, expected_nm, estimate: WrenchEstimate::none_yet() }
    }

    /// The settings.
    pub fn settings(&self) -> &MomentumSettings<N> {
        &self.settings
    }

    /// The observer, for its residual.
    pub fn observer(&self) -> &MomentumObserver<N> {
        &self.observer
    }

    /// `W = P J R⁻¹` at a state: how a torque (Nm) that is not believed shows in the wrench. `belief` is the friction
    /// torque believed (Nm), `dt_s` the period.
    pub fn wrench_from_torque(
        &self,
        terms: &ControlTerms<N>,
        qd: &SVector<f64, N>,
        belief: &SVector<f64, N>,
        dt_s: f64,
    ) -> Option<SMatrix<f64, 6, N>> {
        let r = self.residual_covariance(terms, &self.remaining(qd, belief), dt_s);
        let damping = [self.settings.moment_damping_nm, self.settings.force_damping_n];
        weighted_inverse(&terms.jacobian, &r, damping).map(|(inverse, _)| inverse)
    }

    /// R: covariance of the residual (Nm²).
    #[inline]
    fn residual_covariance(
        &self,
        terms: &ControlTerms<N>,
        remaining: &RemainingFriction<N>,
        dt_s: f64,
    ) -> SMatrix<f64, N, N> {
        let s = &self.settings;
        let (torque_sd, velocity_sd) = (&s.torque_sd_nm, &s.velocity_sd_rad_s);
        let sensors = self.observer.noise_covariance_nm2(&terms.mass_matrix, torque_sd, velocity_sd, dt_s);
        sensors + SMatrix::from_diagonal(&remaining.variance_nm2)
    }

    /// f̄ (Nm) and σ_f² (Nm²) at qd (rad/s).
    #[inline]
    fn remaining(&self, qd: &SVector<f64, N>, belief: &SVector<f64, N>) -> RemainingFriction<N> {
        let s = &self.settings;
        if s.band_of == BandOf::Friction {
            return self.rest.remaining(&s.friction, qd, belief);
        }
        let [lower, upper] = s.band_of.left_nm(&s.friction, qd, belief);
        let noise = s.friction.noise_variance_nm2(qd);
        let spread = SVector::<f64, N>::from_fn(|j, _| {
            let (middle, half_width) = (0.5 * (lower[j] + upper[j]), 0.5 * (upper[j] - lower[j]));
            middle * middle + 0.5 * half_width * half_width
        });
        // A joint of unlimited friction says nothing.
        let variance_nm2 = (spread + noise).map(|variance| if variance.is_finite() { variance } else { UNBOUNDED_NM2 });
        RemainingFriction { variance_nm2, ..RemainingFriction::none() }
    }
}

impl<const N: usize> WrenchEstimator<N> for MomentumEstimator<N> {
    fn reset(&mut self, frame: &SensorFrame<N>, terms: &ControlTerms<N>) {
        self.observer.start(frame, terms);
        self.rest = RestMemory::default();
        // The residual starts at zero whatever the friction: so does what is expected in it.
        self.expected_nm = SVector::zeros();
        self.estimate = WrenchEstimate::none_yet();
    }

    #[inline(never)]
    fn step(&mut self, input: &EstimatorInput<'_, N>) -> WrenchEstimate {
        if let Err(fault) = input.check() {
            return self.estimate.held(fault);
        }
        let before = (self.observer, self.rest, self.expected_nm);
        let (qd, belief) = (&input.frame.qd, input.tau_friction);
        self.rest.note(&self.settings.friction, qd, belief, input.dt_s);
        self.observer.step(input.frame, input.terms, &(input.tau_motor - belief), input.dt_s);
        let remaining = self.remaining(qd, belief);
        self.expected_nm += (remaining.mean_nm - self.expected_nm) * self.observer.share(input.dt_s);
        let r = self.residual_covariance(input.terms, &remaining, input.dt_s);
        let s = &self.settings;
        let (jacobian, residual) = (self.observer.lagged_jacobian(), self.observer.residual_nm() - self.expected_nm);
        match damped_wrench(jacobian, &r, &residual, [s.moment_damping_nm, s.force_damping_n]) {
            Some((h, covariance)) => {
                let wrench_base = Wrench::from_vector(&h);
                self.estimate = WrenchEstimate { wrench_base, covariance, limits95: None, nis: None, fault: None };
                self.estimate
            }
            None => {
                (self.observer, self.rest, self.expected_nm) = before;
                self.estimate.held(EstimateFault::NotPositiveDefinite)
            }
        }
    }

    /// 1/K.
    fn delay_s(&self) -> f64 {
        1.0 / self.settings.gain_rad_s
    }
}
