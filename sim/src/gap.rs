//! A motor in its gap.

/// Each of the two lags with which a motor crosses its gap (s).
const LAG_S: f64 = 4e-3;

/// Motor less link angle through a gap: the half gap on the side of the load, behind two lags of 4 ms.
///
/// ```text
/// T ẋ = half sign(load) − x,   T ġ = x − g
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Gap {
    half_rad: f64,
    lag_rad: f64,
    /// g (rad).
    pub lead_rad: f64,
}

impl Gap {
    /// Settled under the load (Nm).
    pub fn under(half_rad: f64, load_nm: f64) -> Self {
        let side = side(half_rad, load_nm);
        Self { half_rad, lag_rad: side, lead_rad: side }
    }

    /// After a time of `h` (s) under the load (Nm).
    #[inline]
    pub fn advanced(self, load_nm: f64, h: f64) -> Self {
        let follow = 1.0 - (-h / LAG_S).exp();
        let lag_rad = self.lag_rad + follow * (side(self.half_rad, load_nm) - self.lag_rad);
        Self { lag_rad, lead_rad: self.lead_rad + follow * (lag_rad - self.lead_rad), ..self }
    }
}

#[inline]
fn side(half_rad: f64, load_nm: f64) -> f64 {
    if load_nm == 0.0 { 0.0 } else { half_rad * load_nm.signum() }
}
