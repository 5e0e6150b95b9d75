//! The wrench filter that knows what it does not know about friction.

use nalgebra::SVector;
use tribo_friction::{FrictionBand, RemainingFriction, RestMemory};
use tribo_robot::{ControlTerms, EstimatorInput, SensorFrame, Wrench, WrenchEstimate, WrenchEstimator};

use crate::{WrenchEkf, WrenchEkfSettings, wrench_from_torque};

/// [`WrenchEkf`] with the uncertainty of friction in its covariance:
///
/// ```text
/// filter: h + W (tau_f − tau_f_hat),   W = Λ J B⁻¹
/// ĥ = filter − W f̄,   cov(ĥ) = c² P_hh + W diag(σ_f²) Wᵀ,   f̄, σ_f²: mean and variance of tau_f − tau_f_hat in the band
/// ```
///
/// Friction that is compensated enters the filter as an input; what is left of it, the filter takes for a wrench. What the band
/// expects of that is taken off. At speed the band is closed and adds its noise; where a joint stands, its friction may be
/// anything between the bounds and the covariance widens along that joint's column of W ([`RestMemory`]). Mean and variance pass the
/// filter's own delay, since the wrench does. P_hh allows for a wrench that walks at any moment, and is wide for one that
/// rests: c, from a calibration without contact, says what its errors really are there; 1 is the filter's own word.
///
/// The error of friction that sticks is a *bias* for as long as it sticks: the interval is right over poses and pushes, not
/// along one standstill.
#[derive(Clone, Debug)]
pub struct FrictionAwareEkf<const N: usize> {
    ekf: WrenchEkf,
    band: FrictionBand<N>,
    /// c².
    filter_part: f64,
    rest: RestMemory<N>,
    /// As late as the filter.
    remaining: RemainingFriction<N>,
    estimate: WrenchEstimate,
}

impl<const N: usize> FrictionAwareEkf<N> {
    /// A filter that knows nothing yet; [`WrenchEstimator::reset`] places it.
    ///
    /// `filter_factor` is c.
    pub fn new(settings: WrenchEkfSettings, band: FrictionBand<N>, filter_factor: f64) -> Self {
        let filter_part = filter_factor * filter_factor;
        Self {
            ekf: WrenchEkf::new(settings),
            band,
            filter_part,
            rest: RestMemory::default(),
            remaining: RemainingFriction::none(),
            estimate: WrenchEstimate::none_yet(),
        }
    }

    /// The filter without the band.
    pub fn ekf(&self) -> &WrenchEkf {
        &self.ekf
    }
}

impl<const N: usize> WrenchEstimator<N> for FrictionAwareEkf<N> {
    fn reset(&mut self, frame: &SensorFrame<N>, terms: &ControlTerms<N>) {
        self.ekf.reset(frame, terms);
        self.rest = RestMemory::default();
        self.remaining = self.rest.remaining(&self.band, &frame.qd, &SVector::zeros());
        // The filter starts at no wrench, whatever the friction.
        self.remaining.mean_nm = SVector::zeros();
        self.estimate = WrenchEstimate::none_yet();
    }

    #[inline]
    fn step(&mut self, input: &EstimatorInput<'_, N>) -> WrenchEstimate {
        let mut estimate = self.ekf.step(input);
        if let Some(fault) = estimate.fault {
            return self.estimate.held(fault);
        }
        let share = 1.0 - (-input.dt_s / WrenchEstimator::<N>::delay_s(&self.ekf)).exp();
        self.rest.note(&self.band, &input.frame.qd, input.tau_friction, input.dt_s);
        let now = self.rest.remaining(&self.band, &input.frame.qd, input.tau_friction);
        self.remaining.follow(&now, share);
        estimate.covariance *= self.filter_part;
        // The filter has factored the same matrix.
        if let Some(w) = wrench_from_torque(input.terms) {
            estimate.wrench_base =
                Wrench::from_vector(&(estimate.wrench_base.to_vector() - w * self.remaining.mean_nm));
            for j in 0..N {
                estimate.covariance += w.column(j) * w.column(j).transpose() * self.remaining.variance_nm2[j];
            }
        }
        self.estimate = estimate;
        estimate
    }

    fn delay_s(&self) -> f64 {
        WrenchEstimator::<N>::delay_s(&self.ekf)
    }
}
