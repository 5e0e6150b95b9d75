//! Wrench from the residual less the friction of warm joints.

use nalgebra::{Matrix6, SMatrix, SVector, Vector6};
use tribo_friction::{JointBand, JointRest};
use tribo_robot::{ControlTerms, EstimateFault, EstimatorInput, SensorFrame, Wrench, WrenchEstimate, WrenchEstimator};

use super::{ContactGate, FrictionSample, TemperatureObserver, ThermalSettings, ThermalSettingsError};
use crate::MomentumObserver;
use crate::damped_wrench::{damped_wrench, weighted_inverse};

/// Beyond this many standard deviations of the velocity its sign is right.
const DOUBT_SD: f64 = 3.0;
/// Stands for a velocity without noise (rad/s).
const SMALLEST_VELOCITY_SD_RAD_S: f64 = 1e-9;
/// A joint that slides for this many 1/K has no other friction in its residual.
const SETTLE: f64 = 5.0;

/// Friction as the residual sees it: 1/K late.
#[derive(Clone, Copy, Debug)]
struct FrictionPrediction<const N: usize> {
    /// At the sample (Nm).
    now: SVector<f64, N>,
    /// Late (Nm).
    lagged: SVector<f64, N>,
    /// ∂/∂T, late [Nm/K].
    slope: SVector<f64, N>,
    /// Variance of its error, temperature aside, late (Nm²).
    variance: SVector<f64, N>,
    /// What the joints keep of their last slide.
    rest: [JointRest; N],
}

impl<const N: usize> FrictionPrediction<N> {
    fn none() -> Self {
        let zero = SVector::zeros();
        Self { now: zero, lagged: zero, slope: zero, variance: zero, rest: [JointRest::default(); N] }
    }
}

/// The thermal virtual force sensor (simoni2017 section V, (17)–(21)):
///
/// ```text
/// Jᵀ ĥ = r − tau_f(q̇, T̂)                  (17), (18); r = Jᵀ h + tau_f of a momentum observer in place of (19), (20)
/// ĥ = P J R⁻¹ (r − tau_f),   cov(ĥ) = P = (J R⁻¹ Jᵀ + D⁻²)⁻¹
/// R = a/(2 − a) diag(σ_τ²) + K² M diag(σ_v²) M + diag(σ_f² + (∂tau_f/∂T)² P_T),   a = 1 − exp(−K dt)
/// ```
///
/// Every joint has a [`TemperatureObserver`], corrected while it slides and the [`ContactGate`] is open ((21): without
/// contact the residual is friction) and running on its heat balance otherwise. σ_f² is the error of the law, and where the
/// sign of q̇ is in doubt what [`JointRest`] makes of friction between its bounds. Of it, and of the friction, R sees what the
/// observer's low-pass lets through.
///
/// | what the paper says | what we do | why |
/// |---|---|---|
/// | F_e = J⁻ᵀ δτ, six joints | least squares weighted by R | seven joints, and joints that know more count more |
/// | accelerations by differentiation, six filters | the momentum observer | no acceleration; one low-pass for every term |
/// | the observer runs when the user says so | [`ContactGate`] | nobody remembers to |
///
/// The friction is this estimator's own, compensated or not: `tau_friction` of the input only says what a standing joint came to
/// rest with ([`JointRest`]).
///
/// ```
/// use tribo_friction::{FrictionModel, law::CoulombViscous};
/// use tribo_residual::{ThermalEstimator, ThermalSettings};
///
/// let joint = CoulombViscous { coulomb_nm: 0.6, viscous_nm_s_per_rad: 1.0 };
/// let settings = ThermalSettings::without_temperature(&FrictionModel::<7>::uniform(joint.into()))?;
/// let estimator = ThermalEstimator::new(settings)?;
/// assert_eq!(estimator.temperatures_c()[0], 22.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct ThermalEstimator<const N: usize> {
    settings: ThermalSettings<N>,
    momentum: MomentumObserver<N>,
    observers: [TemperatureObserver; N],
    gate: ContactGate,
    prediction: FrictionPrediction<N>,
    /// Time each joint has been sliding (s).
    sliding_s: SVector<f64, N>,
    /// Friction energy since the last observation (J), and its time (s).
    energy_j: SVector<f64, N>,
    since_s: f64,
    estimate: WrenchEstimate,
}

impl<const N: usize> ThermalEstimator<N> {
    /// An estimator that knows nothing yet; [`WrenchEstimator::reset`] places it.
    ///
    /// # Errors
    /// The first setting outside its range.
    pub fn new(settings: ThermalSettings<N>) -> Result<Self, ThermalSettingsError> {
        settings.validate()?;
        let observer =
            |j: usize| TemperatureObserver::new(settings.joints[j], settings.observer, settings.initial_c[j]);
        let mut observers = [observer(0)?; N];
        for (j, slot) in observers.iter_mut().enumerate() {
            *slot = observer(j)?;
        }
        let zero = SVector::zeros();
        Ok(Self {
            settings,
            momentum: MomentumObserver::new(settings.gain_rad_s),
            observers,
            gate: ContactGate::new(settings.contact)?,
            prediction: FrictionPrediction::none(),
            sliding_s: zero,
            energy_j: zero,
            since_s: 0.0,
            estimate: WrenchEstimate::none_yet(),
        })
    }

    /// The settings.
    pub fn settings(&self) -> &ThermalSettings<N> {
        &self.settings
    }

    /// T̂ of every joint (°C).
    pub fn temperatures_c(&self) -> SVector<f64, N> {
        SVector::from_fn(|j, _| self.observers[j].temperature_c())
    }

    /// Standard deviation of every temperature (K).
    pub fn temperature_sd_k(&self) -> SVector<f64, N> {
        SVector::from_fn(|j, _| self.observers[j].variance_k2().sqrt())
    }

    /// Whether the arm counts as free, so that its friction may correct the temperatures.
    pub fn is_free(&self) -> bool {
        self.gate.is_free()
    }

    /// Temperature of the room from now on (°C), if it is finite.
    pub fn set_ambient_c(&mut self, ambient_c: f64) {
        if ambient_c.is_finite() {
            self.settings.ambient_c = ambient_c;
        }
    }

    /// `W = P J R⁻¹` at a state, with the temperatures of now: how a torque (Nm) that is neither model nor friction shows in
    /// the wrench. `compensation` (Nm) is what the compensator adds, `dt_s` the period.
    pub fn wrench_from_torque(
        &self,
        terms: &ControlTerms<N>,
        qd: &SVector<f64, N>,
        compensation: &SVector<f64, N>,
        dt_s: f64,
    ) -> Option<SMatrix<f64, 6, N>> {
        let prediction = self.predict(qd, compensation, dt_s, 1.0);
        let r = self.residual_covariance(&self.noise_covariance(terms, dt_s), &prediction);
        let damping = [self.settings.moment_damping_nm, self.settings.force_damping_n];
        weighted_inverse(&terms.jacobian, &r, damping).map(|(inverse, _)| inverse)
    }

    /// Friction at this sample, low-passed like the residual; the mean of both ends of the period, like its bias.
    #[inline(never)]
    fn predict(
        &self,
        qd: &SVector<f64, N>,
        compensation: &SVector<f64, N>,
        dt_s: f64,
        share: f64,
    ) -> FrictionPrediction<N> {
        let mut prediction = self.prediction;
        for j in 0..N {
            let (law, t) = (self.settings.joints[j].law(), self.observers[j].temperature_c());
            let sliding = law.torque_nm(qd[j], t);
            let velocity_sd = self.settings.velocity_sd_rad_s[j].max(SMALLEST_VELOCITY_SD_RAD_S);
            let doubt = JointBand::coulomb_viscous(1.0, 0.0, velocity_sd, 1.0).doubt(qd[j]);
            let ends = [1.0, -1.0].map(|side| law.sliding_nm(side * DOUBT_SD * velocity_sd, t));
            let (middle, half_width) = (0.5 * (ends[0] + ends[1]), 0.5 * (ends[0] - ends[1]));
            // What a compensator that fades at rest withdraws, the friction takes over: the memory is of the rest.
            let compensated = compensation[j];
            prediction.rest[j].note(doubt, sliding - compensated, dt_s);
            let [left, spread] =
                prediction.rest[j].remaining(doubt, sliding - compensated, middle - compensated, half_width);
            let now = left + compensated;
            let s = &self.settings.observer;
            let noise = (s.model_error * now).powi(2) + s.friction_sd_nm.powi(2);
            prediction.variance[j] += (spread + noise - prediction.variance[j]) * share;
            let mean = 0.5 * (prediction.now[j] + now);
            prediction.lagged[j] += share * (mean - prediction.lagged[j]);
            prediction.slope[j] += share * (law.slope_nm_per_k(qd[j], t) - prediction.slope[j]);
            prediction.now[j] = now;
        }
        prediction
    }

    /// What the noise of torque and velocity makes of the residual (Nm²).
    #[inline]
    fn noise_covariance(&self, terms: &ControlTerms<N>, dt_s: f64) -> SMatrix<f64, N, N> {
        let s = &self.settings;
        self.momentum.noise_covariance_nm2(&terms.mass_matrix, &s.torque_sd_nm, &s.velocity_sd_rad_s, dt_s)
    }

    /// R: noise, what is not known of the friction, and of the temperatures (Nm²).
    #[inline]
    fn residual_covariance(
        &self,
        noise: &SMatrix<f64, N, N>,
        prediction: &FrictionPrediction<N>,
    ) -> SMatrix<f64, N, N> {
        let by_temperature = |j: usize| prediction.slope[j].powi(2) * self.observers[j].variance_k2();
        noise + SMatrix::from_diagonal(&SVector::from_fn(|j, _| prediction.variance[j] + by_temperature(j)))
    }

    /// Gate, heat and observers, after the estimate of this tick is accepted.
    #[inline]
    fn observe(
        &mut self,
        input: &EstimatorInput<'_, N>,
        unexplained: &SVector<f64, N>,
        [noise, r]: [&SMatrix<f64, N, N>; 2],
        h: &Vector6<f64>,
        covariance: &Matrix6<f64>,
    ) {
        let s = self.settings;
        let settle_s = SETTLE / s.gain_rad_s;
        for j in 0..N {
            let qd = input.frame.qd[j];
            self.energy_j[j] += (self.prediction.now[j] * qd).max(0.0) * input.dt_s;
            self.sliding_s[j] = if qd.abs() > s.sliding_rad_s { self.sliding_s[j] + input.dt_s } else { 0.0 };
        }
        self.since_s += input.dt_s;
        if self.since_s < s.observe_every_s * (1.0 - 1e-9) {
            return;
        }
        let ratio = |j: usize| unexplained[j].powi(2) / r[(j, j)];
        let largest = (0..N).map(ratio).fold(0.0, f64::max);
        // hᵀ cov⁻¹ h, of which the damping has taken 1e-4.
        let nis = covariance.cholesky().map_or(0.0, |factor| h.dot(&factor.solve(h)));
        let was_free = self.gate.is_free();
        let free = self.gate.step(largest, nis, self.since_s);
        for (j, observer) in self.observers.iter_mut().enumerate() {
            observer.warm(self.energy_j[j] / self.since_s, s.ambient_c, self.since_s);
            if was_free && !free {
                observer.forget_window();
            }
            if free && self.sliding_s[j] >= settle_s {
                let predicted_nm = self.prediction.lagged[j];
                let slope_nm_per_k = self.prediction.slope[j];
                let measured_nm = predicted_nm + unexplained[j];
                let noise_variance_nm2 = noise[(j, j)];
                observer.correct(
                    &FrictionSample { measured_nm, predicted_nm, slope_nm_per_k, noise_variance_nm2 },
                    self.since_s,
                );
            }
        }
        self.energy_j = SVector::zeros();
        self.since_s = 0.0;
    }
}

impl<const N: usize> WrenchEstimator<N> for ThermalEstimator<N> {
    fn reset(&mut self, frame: &SensorFrame<N>, terms: &ControlTerms<N>) {
        self.momentum.start(frame, terms);
        self.gate.restart();
        for (observer, &start_c) in self.observers.iter_mut().zip(self.settings.initial_c.iter()) {
            observer.restart(start_c);
        }
        let zero = SVector::zeros();
        self.prediction = FrictionPrediction::none();
        self.prediction = self.predict(&frame.qd, &zero, 0.0, 1.0);
        // The residual starts at zero whatever the friction: so does the friction it is compared with.
        (self.prediction.lagged, self.prediction.slope) = (zero, zero);
        (self.sliding_s, self.energy_j, self.since_s) = (zero, zero, 0.0);
        self.estimate = WrenchEstimate::none_yet();
    }

    #[inline(never)]
    fn step(&mut self, input: &EstimatorInput<'_, N>) -> WrenchEstimate {
        if let Err(fault) = input.check() {
            return self.estimate.held(fault);
        }
        let mut momentum = self.momentum;
        momentum.step(input.frame, input.terms, input.tau_motor, input.dt_s);
        let share = momentum.share(input.dt_s);
        let prediction = self.predict(&input.frame.qd, input.tau_friction, input.dt_s, share);
        let unexplained = momentum.residual_nm() - prediction.lagged;
        let noise = self.noise_covariance(input.terms, input.dt_s);
        let r = self.residual_covariance(&noise, &prediction);
        let damping = [self.settings.moment_damping_nm, self.settings.force_damping_n];
        let Some((h, covariance)) = damped_wrench(momentum.lagged_jacobian(), &r, &unexplained, damping) else {
            return self.estimate.held(EstimateFault::NotPositiveDefinite);
        };
        (self.momentum, self.prediction) = (momentum, prediction);
        let wrench_base = Wrench::from_vector(&h);
        self.estimate = WrenchEstimate { wrench_base, covariance, limits95: None, nis: None, fault: None };
        self.observe(input, &unexplained, [&noise, &r], &h, &covariance);
        self.estimate
    }

    /// 1/K.
    fn delay_s(&self) -> f64 {
        1.0 / self.settings.gain_rad_s
    }
}
