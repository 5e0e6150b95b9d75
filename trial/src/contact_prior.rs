//! What a wrench most likely is where most of the time nobody touches the arm.

use tribo_model::FieldError;
use tribo_robot::LAMBDA_95;

use crate::LogWrench;

/// A component of the wrench is zero unless somebody touches the arm:
///
/// ```text
/// p(h) = (1 − π) δ(h) + π N(h; 0, s²),   ĥ | h ~ N(h, σ²)
/// E[h | ĥ] = ρ ĥ s²/(σ² + s²),   ρ/(1 − ρ) = π/(1 − π) √(σ²/(σ² + s²)) exp(½ ĥ² s²/(σ² (σ² + s²)))
/// ```
///
/// Stiction of a joint that stands is a wrench to every estimator that feels the motors, and stays one for as long as the joint
/// stands: no tare knows it. The interval does, and within it nothing speaks for a contact. What is far outside of it stays as it
/// is; a contact below 1.6 to 1.7 half-widths (π = 0.1) is taken for nothing. ρ knows one component at one instant: neither the others nor
/// what was before.
///
/// ```
/// use tribo_trial::ContactPrior;
///
/// let prior = ContactPrior::default();
/// let expected = |force_n: f64| prior.expected(force_n, prior.force_sd_n, 1.25); // half-width 2.5 N
/// assert!(expected(1.5).abs() < 0.02 && (expected(15.0) - 15.0).abs() < 0.05);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactPrior {
    /// π: share of the samples in which a component is not zero.
    pub touched: f64,
    /// s of a force in contact (N).
    pub force_sd_n: f64,
    /// s of a moment in contact (Nm).
    pub moment_sd_nm: f64,
}

/// A hand's contact: force (N), moment (Nm).
const CONTACT: [f64; 2] = [30.0, 3.0];

/// A hand's contact in one sample of ten.
impl Default for ContactPrior {
    fn default() -> Self {
        Self { touched: 0.1, force_sd_n: CONTACT[0], moment_sd_nm: CONTACT[1] }
    }
}

impl ContactPrior {
    /// A hand's contact, 30 N and 3 Nm, in this share of the samples, above 0 and at most 1.
    ///
    /// # Errors
    /// A share outside of that.
    pub fn rarely(touched: f64) -> Result<Self, FieldError> {
        if !(touched > 0.0 && touched <= 1.0) {
            return Err(FieldError::new("touched", touched, "above 0, at most 1"));
        }
        Ok(Self { touched, ..Self::default() })
    }

    /// E[h | ĥ] of one component with the deviation s in contact and σ of the estimate.
    #[inline]
    pub fn expected(&self, estimate: f64, contact_sd: f64, sd: f64) -> f64 {
        let (contact, noise) = (contact_sd * contact_sd, sd * sd);
        let kept = contact / (contact + noise);
        let log_odds_of_none = ((1.0 - self.touched) / self.touched).ln()
            - 0.5 * (noise / (contact + noise)).ln()
            - 0.5 * estimate * estimate * kept / noise;
        let expected = estimate * kept / (1.0 + log_odds_of_none.exp());
        // An estimate without noise is the wrench.
        if expected.is_finite() { expected } else { estimate }
    }

    /// Takes every settled estimate for what it most likely is. The interval, whose half-width is 1.96 σ, stays, and grows
    /// to hold the new estimate where it does not.
    pub fn apply(&self, log: &mut LogWrench) {
        for (wrench, limits) in log.wrench.iter_mut().zip(&mut log.limits95) {
            for i in 0..6 {
                let sd = 0.5 * (limits[1][i] - limits[0][i]) / LAMBDA_95;
                let contact_sd = if i < 3 { self.force_sd_n } else { self.moment_sd_nm };
                wrench[i] = self.expected(wrench[i], contact_sd, sd);
                limits[0][i] = limits[0][i].min(wrench[i]);
                limits[1][i] = limits[1][i].max(wrench[i]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn normal(x: f64, sd: f64) -> f64 {
        (-0.5 * (x / sd).powi(2)).exp() / (sd * std::f64::consts::TAU.sqrt())
    }

    /// Witness: Bayes' rule by quadrature over the wrench.
    #[test]
    fn it_is_the_posterior_mean() {
        let prior = ContactPrior::rarely(0.2).unwrap();
        for (estimate, contact_sd, sd) in [(0.4, 30.0, 1.25), (3.0, 30.0, 1.25), (-3.9, 30.0, 1.25), (0.5, 3.0, 0.2)] {
            let (mut mass, mut moment) = ((1.0 - prior.touched) * normal(estimate, sd), 0.0);
            let steps = 400_000;
            let step = 20.0 * contact_sd / f64::from(steps);
            for k in 0..steps {
                let h = -10.0 * contact_sd + (f64::from(k) + 0.5) * step;
                let p = prior.touched * normal(h, contact_sd) * normal(estimate - h, sd) * step;
                mass += p;
                moment += p * h;
            }
            let expected = prior.expected(estimate, contact_sd, sd);
            assert!((expected - moment / mass).abs() < 1e-6, "{estimate}: {expected} {}", moment / mass);
        }
    }

    #[test]
    fn far_out_nothing_changes_and_the_estimate_stays_inside() {
        let prior = ContactPrior::rarely(0.1).unwrap();
        assert!((prior.expected(1e9, 30.0, 1.0) / 1e9 - 900.0 / 901.0).abs() < 1e-12);
        assert_eq!(prior.expected(2.0, 30.0, 1e-9), 2.0);
        assert_eq!(prior.expected(2.0, 30.0, 0.0), 2.0);
        assert_eq!(prior.expected(0.0, 30.0, 0.0), 0.0);
        assert!(prior.expected(f64::NAN, 30.0, 1.0).is_nan());
        let (wrench, limits95) = (vec![[2.2; 6], [f64::NAN; 6]], vec![[[0.2; 6], [4.2; 6]], [[f64::NAN; 6]; 2]]);
        let mut log = LogWrench { wrench, limits95, ..LogWrench::default() };
        prior.apply(&mut log);
        assert!(log.wrench[0][0] < 0.2 && log.limits95[0][0][0] == log.wrench[0][0] && log.limits95[0][1][0] == 4.2);
        assert!(log.wrench[1][0].is_nan() && log.limits95[1][0][0].is_nan());
    }

    #[test]
    fn shares_out_of_range_are_named() {
        for touched in [0.0, -0.1, 1.1, f64::NAN] {
            assert!(ContactPrior::rarely(touched).unwrap_err().to_string().contains("touched"));
        }
    }
}
