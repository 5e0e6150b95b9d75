//! What is logged for an identification.

use super::ThermalFitError;

/// One moment of one joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThermalSample {
    /// Time since the start of the session (s).
    pub time_s: f64,
    /// Velocity [rad/s].
    pub qd_rad_s: f64,
    /// Friction torque (Nm): measured torque less inertia, Coriolis torque and gravity (simoni2017 (19)).
    pub friction_nm: f64,
}

/// A log of one joint that worked at one duty cycle after a long rest.
///
/// Between two samples velocity and friction are taken to be those of the first: log so fast that the power is seen
/// (10 Hz and more), rests included.
#[derive(Clone, Debug, PartialEq)]
pub struct ThermalSession {
    /// Temperature of the room (°C); also of the joint at the start, unless `start_c` says otherwise.
    pub ambient_c: f64,
    /// Temperature of the joint at the start (°C), if known to differ from the room.
    pub start_c: Option<f64>,
    /// The samples, in order of time.
    pub samples: Vec<ThermalSample>,
}

impl ThermalSession {
    /// Finite numbers, growing times.
    pub(super) fn check(&self, session: usize) -> Result<(), ThermalFitError> {
        let bad = |sample, problem| Err(ThermalFitError::BadSample { session, sample, problem });
        if !(self.ambient_c.is_finite() && self.start_c.is_none_or(f64::is_finite)) {
            return bad(0, "the temperature of the room or of the start is not finite");
        }
        let mut last = f64::NEG_INFINITY;
        for (k, s) in self.samples.iter().enumerate() {
            if !(s.time_s.is_finite() && s.qd_rad_s.is_finite() && s.friction_nm.is_finite()) {
                return bad(k, "time, velocity or friction is not finite");
            }
            if s.time_s <= last {
                return bad(k, "time does not grow");
            }
            last = s.time_s;
        }
        Ok(())
    }
}
