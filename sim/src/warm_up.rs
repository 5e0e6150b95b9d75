//! Friction that fades as the gears warm up.

/// Thermal loss of friction over the operating time:
///
/// ```text
/// scale(t) = 1 − drop (1 − exp(−t/τ)),   t = operating time since a cold start
/// ```
///
/// A stationary duty cycle deposits constant mean heat, so the first-order heat balance of simoni2019 reduces to its
/// operating time; that keeps a trial a function of its number alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WarmUp {
    /// Fraction of the cold friction that is lost when warm [-], 0..1.
    pub drop_fraction: f64,
    /// Thermal time constant τ (s).
    pub time_constant_s: f64,
    /// Operating time already passed at the start of the trial (s).
    pub operated_s: f64,
}

impl WarmUp {
    /// Scale of the friction [-] at `time_s` (s) into the trial.
    #[inline]
    pub fn scale(&self, time_s: f64) -> f64 {
        1.0 - self.drop_fraction * (1.0 - (-(self.operated_s + time_s) / self.time_constant_s).exp())
    }
}
