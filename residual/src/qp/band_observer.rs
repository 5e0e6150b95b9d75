//! Residual and friction bounds of one arm, ready for the programme.

use nalgebra::{SMatrix, SVector};
use tribo_friction::{FrictionBand, RestMemory};
use tribo_robot::{ControlTerms, EstimatorInput, SensorFrame};

use super::ForceProblem;
use crate::{BandOf, MomentumObserver};

/// What a friction band makes of one arm in the tick: the residual of a [`MomentumObserver`] and the bounds of friction,
/// both through the same low-pass.
///
/// The kernel of the low-pass is not negative: if friction was between its bounds, what the observer sees of it is between
/// the filtered ones. So does J.
#[derive(Clone, Copy, Debug)]
pub struct BandObserver<const N: usize> {
    band: FrictionBand<N>,
    band_of: BandOf,
    observer: MomentumObserver<N>,
    lower: SVector<f64, N>,
    upper: SVector<f64, N>,
    torque_sd_nm: SVector<f64, N>,
    velocity_sd_rad_s: SVector<f64, N>,
    covariance: SMatrix<f64, N, N>,
    /// How the joints came to rest, where that is to narrow the band.
    rest: Option<RestMemory<N>>,
}

impl<const N: usize> BandObserver<N> {
    /// An observer of gain `gain_rad_s` whose noise is that of the band alone; [`Self::start`] places it.
    pub fn new(band: FrictionBand<N>, band_of: BandOf, gain_rad_s: f64) -> Self {
        let zero = SVector::zeros();
        Self {
            band,
            band_of,
            observer: MomentumObserver::new(gain_rad_s),
            lower: zero,
            upper: zero,
            torque_sd_nm: zero,
            velocity_sd_rad_s: zero,
            covariance: SMatrix::identity(),
            rest: None,
        }
    }

    /// The same with noise of the sensors besides, per joint: torque (Nm, white, per sample) and velocity (rad/s). Noise of one
    /// velocity shows in every joint that it is coupled to by M ([`MomentumObserver::noise_covariance_nm2`]).
    #[must_use]
    pub fn with_sensor_noise(mut self, torque_sd_nm: SVector<f64, N>, velocity_sd_rad_s: SVector<f64, N>) -> Self {
        (self.torque_sd_nm, self.velocity_sd_rad_s) = (torque_sd_nm, velocity_sd_rad_s);
        self
    }

    /// The same with the band of a standing joint narrowed to what it came to rest with ([`RestMemory::limits_nm`]), as far as
    /// `tau_friction` of the input is what was compensated; for a band about the whole friction.
    #[must_use]
    pub fn with_rest_memory(mut self) -> Self {
        self.rest = Some(RestMemory::default());
        self
    }

    /// Starts at a sample.
    pub fn start(&mut self, frame: &SensorFrame<N>, terms: &ControlTerms<N>) {
        self.observer.start(frame, terms);
        self.rest = self.rest.map(|_| RestMemory::default());
        [self.lower, self.upper] = self.bounds(&frame.qd, &SVector::zeros());
        self.covariance = SMatrix::from_diagonal(&self.band.noise_variance_nm2(&frame.qd));
    }

    /// Takes one sample.
    #[inline]
    pub fn step(&mut self, input: &EstimatorInput<'_, N>) {
        let qd = &input.frame.qd;
        let torque = match self.band_of {
            BandOf::Friction => *input.tau_motor,
            BandOf::Remainder => input.tau_motor - input.tau_friction,
        };
        self.observer.step(input.frame, input.terms, &torque, input.dt_s);
        let share = self.observer.share(input.dt_s);
        if let Some(rest) = &mut self.rest {
            rest.note(&self.band, qd, input.tau_friction, input.dt_s);
        }
        let [lower, upper] = self.bounds(qd, input.tau_friction);
        for j in 0..N {
            self.lower[j] = lagged(self.lower[j], lower[j], share);
            self.upper[j] = lagged(self.upper[j], upper[j], share);
        }
        self.covariance = self.noise_covariance_nm2(input.terms, qd, input.dt_s);
    }

    /// R_e at a state (Nm²).
    #[inline]
    pub fn noise_covariance_nm2(&self, terms: &ControlTerms<N>, qd: &SVector<f64, N>, dt_s: f64) -> SMatrix<f64, N, N> {
        let (torque_sd, velocity_sd) = (&self.torque_sd_nm, &self.velocity_sd_rad_s);
        let sensors = self.observer.noise_covariance_nm2(&terms.mass_matrix, torque_sd, velocity_sd, dt_s);
        sensors + SMatrix::from_diagonal(&self.band.noise_variance_nm2(qd))
    }

    /// What is known after the last sample about the wrench `[moment; force]`, base axes.
    #[inline]
    pub fn problem(&self) -> ForceProblem<N, 6> {
        ForceProblem {
            torque: *self.observer.residual_nm(),
            jacobian: *self.observer.lagged_jacobian(),
            lower: self.lower,
            upper: self.upper,
            covariance: self.covariance,
        }
    }

    /// Bounds of the friction that is looked for (Nm).
    #[inline]
    fn bounds(&self, qd: &SVector<f64, N>, belief: &SVector<f64, N>) -> [SVector<f64, N>; 2] {
        match (self.band_of, &self.rest) {
            (BandOf::Friction, None) => self.band.limits_nm(qd),
            (BandOf::Friction, Some(rest)) => rest.limits_nm(&self.band, qd, belief),
            (BandOf::Remainder, _) => self.band_of.left_nm(&self.band, qd, belief),
        }
    }
}

/// `old + share (new − old)`, also for bounds that are infinite.
#[inline]
fn lagged(old: f64, new: f64, share: f64) -> f64 {
    if old.is_finite() && new.is_finite() { old + share * (new - old) } else { new }
}

/// The problem of two arms that hold one thing between them: the wrench of the first on it is minus that of the second. Both
/// Jacobians are for the same point and axes; C = A + B, checked when compiled.
///
/// ```text
/// [torque_a; torque_b] = [J_a, −J_b]ᵀ F + tau_f + e
/// ```
#[inline]
pub fn stack_opposed<const A: usize, const B: usize, const C: usize>(
    a: &ForceProblem<A, 6>,
    b: &ForceProblem<B, 6>,
) -> ForceProblem<C, 6> {
    const { assert!(C == A + B, "as many joints as both arms have") };
    let both = |a: &SVector<f64, A>, b: &SVector<f64, B>| SVector::from_fn(|i, _| if i < A { a[i] } else { b[i - A] });
    ForceProblem {
        torque: both(&a.torque, &b.torque),
        jacobian: SMatrix::from_fn(|r, c| if c < A { a.jacobian[(r, c)] } else { -b.jacobian[(r, c - A)] }),
        lower: both(&a.lower, &b.lower),
        upper: both(&a.upper, &b.upper),
        covariance: SMatrix::from_fn(|r, c| match (r < A, c < A) {
            (true, true) => a.covariance[(r, c)],
            (false, false) => b.covariance[(r - A, c - A)],
            _ => 0.0,
        }),
    }
}
