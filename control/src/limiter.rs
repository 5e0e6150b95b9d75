//! Torque and torque-rate limits.

use nalgebra::SVector;
use tribo_robot::Limits;

/// Clips a torque to `|tau| ≤ tau_max` and `|tau − tau_last| ≤ tau_rate_max dt`, and says whether it had to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueLimiter<const N: usize> {
    tau_max_nm: SVector<f64, N>,
    tau_rate_max_nm_s: SVector<f64, N>,
    last_nm: Option<SVector<f64, N>>,
}

impl<const N: usize> TorqueLimiter<N> {
    /// A limiter for these limits; the first torque it sees is free of the rate limit.
    pub fn new(limits: &Limits<N>) -> Self {
        Self { tau_max_nm: limits.tau_max_nm, tau_rate_max_nm_s: limits.tau_rate_max_nm_s, last_nm: None }
    }

    /// The permitted torque (Nm) nearest to `tau` after dt (s), and whether the magnitude limit of any joint was hit.
    #[inline]
    pub fn limit(&mut self, tau: &SVector<f64, N>, dt_s: f64) -> (SVector<f64, N>, bool) {
        let mut saturated = false;
        let limited = SVector::from_fn(|j, _| {
            let mut torque = tau[j];
            if let Some(last) = self.last_nm {
                let step = self.tau_rate_max_nm_s[j] * dt_s;
                torque = torque.max(last[j] - step).min(last[j] + step);
            }
            if torque.abs() > self.tau_max_nm[j] {
                saturated = true;
                torque = self.tau_max_nm[j].copysign(torque);
            }
            torque
        });
        self.last_nm = Some(limited);
        (limited, saturated)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tribo_robot::presets;

    #[test]
    fn limits_magnitude_and_rate() {
        let mut limiter = TorqueLimiter::new(&presets::panda().limits);
        let (first, saturated) = limiter.limit(&SVector::repeat(100.0), 1e-3);
        assert!(saturated && first[0] == 87.0 && first[6] == 12.0);
        let (second, saturated) = limiter.limit(&SVector::zeros(), 1e-3);
        assert!(!saturated && second[0] == 86.0 && second[6] == 11.0);
    }
}
