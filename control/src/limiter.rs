//! Torque and torque-rate limits.

use nalgebra::SVector;
use tribo_robot::Limits;

/// What a control unit that adds gravity itself makes of a wanted torque τ:
///
/// ```text
/// s  = τ − g     clipped to |s − s_last| ≤ .999 tau_rate_max dt
/// τ' = s + g     clipped to |τ' − τ'_last| ≤ tau_rate_max dt and |τ'| ≤ tau_max
/// ```
///
/// s is what is sent, τ' what acts. A loop that takes τ' for its command has the same bits before a simulated arm as before a Franka.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueLimiter<const N: usize> {
    tau_max_nm: SVector<f64, N>,
    tau_rate_max_nm_s: SVector<f64, N>,
    /// What was sent, and what acted.
    last_nm: Option<[SVector<f64, N>; 2]>,
}

/// Share of the rate that is used: version 10 of Franka's interface rounds torques to floats.
const SHARE_OF_RATE: f64 = 0.999;

impl<const N: usize> TorqueLimiter<N> {
    /// A limiter for these limits; the first torque it sees is free of the rate limit.
    pub fn new(limits: &Limits<N>) -> Self {
        Self { tau_max_nm: limits.tau_max_nm, tau_rate_max_nm_s: limits.tau_rate_max_nm_s, last_nm: None }
    }

    /// The permitted torque (Nm) near `tau` after dt (s) where `gravity` (Nm) is part of it, and whether the magnitude limit of any
    /// joint was hit.
    #[inline]
    pub fn limit(&mut self, tau: &SVector<f64, N>, gravity: &SVector<f64, N>, dt_s: f64) -> (SVector<f64, N>, bool) {
        let step = self.tau_rate_max_nm_s * dt_s;
        let mut sent = tau - gravity;
        if let Some([last_sent, last]) = self.last_nm {
            let sent_step = step * SHARE_OF_RATE;
            sent = sent.sup(&(last_sent - sent_step)).inf(&(last_sent + sent_step));
            sent = (sent + gravity).sup(&(last - step)).inf(&(last + step)) - gravity;
        }
        let mut acts = sent + gravity;
        let saturated = (0..N).any(|j| acts[j].abs() > self.tau_max_nm[j]);
        if saturated {
            acts = SVector::from_fn(|j, _| acts[j].max(-self.tau_max_nm[j]).min(self.tau_max_nm[j]));
            sent = acts - gravity;
        }
        self.last_nm = Some([sent, acts]);
        (acts, saturated)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tribo_robot::presets;

    /// Taken for the wanted torque, what acts is sent and acts again: bit by bit, whatever the sizes.
    #[test]
    fn what_acts_stays_what_it_is() {
        let draw = |k: u64| (k.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 12) as f64 / (1_u64 << 52) as f64 - 0.5;
        let mut limits = presets::panda().limits;
        limits.tau_rate_max_nm_s.fill(1e9);
        let mut limiter = TorqueLimiter::new(&limits);
        for k in 0..100_000_u64 {
            let sized = |size: u64, at: u64| {
                SVector::<f64, 7>::from_fn(|j, _| 2.0_f64.powi((size % 17) as i32 - 14) * draw(at + j as u64))
            };
            let (tau, gravity) = (sized(k, 14 * k), sized(k / 17, 14 * k + 7));
            let (acts, _) = limiter.limit(&tau, &gravity, 1e-3);
            assert_eq!(limiter.limit(&acts, &gravity, 1e-3).0, acts, "{k}");
            assert!((acts - tau).amax() <= f64::EPSILON * tau.amax().max(gravity.amax()), "{k}");
        }
    }

    #[test]
    fn limits_magnitude_and_rate() {
        let (limits, none) = (presets::panda().limits, SVector::zeros());
        let mut limiter = TorqueLimiter::new(&limits);
        let (first, saturated) = limiter.limit(&SVector::repeat(100.0), &none, 1e-3);
        assert!(saturated && first[0] == 87.0 && first[6] == 12.0);
        let (second, saturated) = limiter.limit(&SVector::zeros(), &none, 1e-3);
        assert!(!saturated && (second[0] - 86.001).abs() < 1e-12 && (second[6] - 11.001).abs() < 1e-12);
        // Gravity is the unit's own, and may change as it will.
        let mut limiter = TorqueLimiter::new(&limits);
        limiter.limit(&none, &none, 1e-3);
        let gravity = SVector::repeat(0.4);
        let (third, saturated) = limiter.limit(&SVector::repeat(0.9), &gravity, 1e-3);
        assert!(!saturated && third == SVector::<f64, 7>::repeat(0.9));
        let (fourth, _) = limiter.limit(&SVector::repeat(3.0), &gravity, 1e-3);
        assert!((fourth - SVector::repeat(1.899)).amax() < 1e-12);
        // Nor does what acts change faster than the drives let it.
        let (fifth, _) = limiter.limit(&SVector::repeat(5.0), &SVector::repeat(0.8), 1e-3);
        assert!((fifth - SVector::repeat(2.899)).amax() < 1e-12);
    }
}
