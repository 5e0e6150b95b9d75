//! Whether something touches the arm, as far as the temperature observer is concerned.

use super::ThermalSettingsError;

/// Settings of [`ContactGate`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactSettings {
    /// Unexplained torque of one joint, in its standard deviations, from which there is contact.
    pub joint_sd: f64,
    /// Squared length of the wrench in the metric of its covariance (6 degrees of freedom) from which there is contact.
    pub wrench_nis: f64,
    /// Time after the last sign of contact before the arm counts as free (s).
    pub hold_s: f64,
}

impl Default for ContactSettings {
    /// One in 10⁵ samples of a joint, or of a wrench, by chance: 4.4 standard deviations, χ²₆ = 35. A second of hold.
    fn default() -> Self {
        Self { joint_sd: 4.4, wrench_nis: 35.0, hold_s: 1.0 }
    }
}

impl ContactSettings {
    pub(super) fn validate(&self) -> Result<(), ThermalSettingsError> {
        let check = ThermalSettingsError::check;
        let (z, nis, hold) = (self.joint_sd, self.wrench_nis, self.hold_s);
        check("contact.joint_sd", z, (1.0..=100.0).contains(&z), "1 to 100")?;
        check("contact.wrench_nis", nis, (6.0..=1e4).contains(&nis), "6 to 1e4")?;
        check("contact.hold_s", hold, (0.0..=1e3).contains(&hold), "0 to 1e3 s")
    }
}

/// Closes while the residual is more than temperature explains.
///
/// ```text
/// |r_j − tau_f_hat,j| > z √(H_j² P_j + σ_j²)   or   ĥᵀ cov(ĥ)⁻¹ ĥ > χ²
/// ```
///
/// What a temperature may explain is bounded by its variance P, and P follows heat, which is slow: after a few strokes a
/// joint's temperature is known to a kelvin or two, and what moves the residual by more within minutes is no warmth. A
/// wrench shows at several joints in the proportions of Jᵀ, warmth in those of each joint's own friction; the second test
/// adds up over joints what the first does not see at any of them. Nobody has to say when the arm is free, as the user of
/// simoni2017 does.
///
/// Leaves out: a contact from the first sample that pulls by less than the doubt of the start; it is taken for warmth until
/// it goes away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactGate {
    settings: ContactSettings,
    hold_left_s: f64,
}

impl ContactGate {
    /// An open gate.
    ///
    /// # Errors
    /// The first setting outside its range.
    pub fn new(settings: ContactSettings) -> Result<Self, ThermalSettingsError> {
        settings.validate()?;
        Ok(Self { settings, hold_left_s: 0.0 })
    }

    /// Opens it.
    pub fn restart(&mut self) {
        self.hold_left_s = 0.0;
    }

    /// Takes the largest squared residual of a joint over its variance and the NIS of the wrench; returns whether the arm is
    /// free.
    #[inline]
    pub fn step(&mut self, largest_joint_ratio: f64, wrench_nis: f64, dt_s: f64) -> bool {
        let contact = largest_joint_ratio > self.settings.joint_sd.powi(2) || wrench_nis > self.settings.wrench_nis;
        self.hold_left_s = if contact { self.settings.hold_s } else { self.hold_left_s - dt_s };
        !contact && self.is_free()
    }

    /// Whether the arm counts as free.
    #[inline]
    pub fn is_free(&self) -> bool {
        self.hold_left_s <= 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn either_test_closes_it_and_the_hold_keeps_it_closed() {
        let mut gate = ContactGate::new(ContactSettings::default()).unwrap();
        assert!(gate.step(19.0, 34.0, 0.1));
        assert!(!gate.step(20.0, 0.0, 0.1));
        let closed = (0..20).filter(|_| !gate.step(0.0, 0.0, 0.1)).count();
        assert!((9..=10).contains(&closed), "{closed}");
        assert!(!gate.step(0.0, 36.0, 0.1));
        gate.restart();
        assert!(gate.is_free());
        let bad = ContactSettings { joint_sd: 0.0, ..ContactSettings::default() };
        assert_eq!(ContactGate::new(bad).unwrap_err().field, "contact.joint_sd");
    }
}
