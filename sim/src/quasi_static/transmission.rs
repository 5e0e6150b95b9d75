//! A gear that yields, seen slowly.

/// Deflection δ = motor − link angle of a gear under a load L, and the stiction of the bearing behind it:
///
/// ```text
/// δ = L/k + a tanh(L/L₀) + h z + e sin(2 n θ),       dz = (1 − z sign dL) |dL|/L_h
/// L = gravity + Jᵀ W + F y,                          dy = (1 − y sign dq) |dq|/d
/// ```
///
/// Stiff at high loads, softer near zero, with a Dahl hysteresis (dahl1968) over the load and one over the angle (stiction of the
/// link's bearing), and the kinematic error of a strain-wave gear. Smooth where estimators are piecewise linear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transmission {
    /// k (Nm/rad).
    pub stiffness_nm_per_rad: f64,
    /// a: what the soft zone adds (rad).
    pub soft_rad: f64,
    /// L₀: its width (Nm).
    pub soft_load_nm: f64,
    /// h: half-width of the hysteresis (rad).
    pub hysteresis_rad: f64,
    /// L_h: change of load over which it builds up (Nm).
    pub hysteresis_load_nm: f64,
    /// F: stiction on the side of the link (Nm).
    pub stiction_nm: f64,
    /// d: travel over which it builds up (rad).
    pub presliding_rad: f64,
    /// e: kinematic error (rad).
    pub ripple_rad: f64,
    /// n: gear ratio [-].
    pub ratio: f64,
}

impl Transmission {
    /// Seven gears of a Panda-sized arm; invented, of the order of magnitude of strain-wave gears.
    pub fn panda() -> [Self; 7] {
        let stiction_nm = [0.5, 0.7, 0.5, 0.5, 0.25, 0.25, 0.2];
        std::array::from_fn(|j| Self {
            stiffness_nm_per_rad: tribo_robot::presets::PANDA_JOINT_STIFFNESS_NM_PER_RAD[j],
            soft_rad: if j < 4 { 1e-4 } else { 5e-5 },
            soft_load_nm: if j < 4 { 4.0 } else { 1.5 },
            hysteresis_rad: 2e-5,
            hysteresis_load_nm: if j < 4 { 3.0 } else { 1.0 },
            stiction_nm: stiction_nm[j],
            presliding_rad: 1e-3,
            ripple_rad: 3e-6,
            ratio: 100.0,
        })
    }

    /// Every magnitude times a factor of its own.
    pub fn scaled(self, mut factor: impl FnMut() -> f64) -> Self {
        Self {
            stiffness_nm_per_rad: self.stiffness_nm_per_rad * factor(),
            soft_rad: self.soft_rad * factor(),
            soft_load_nm: self.soft_load_nm * factor(),
            hysteresis_rad: self.hysteresis_rad * factor(),
            hysteresis_load_nm: self.hysteresis_load_nm * factor(),
            stiction_nm: self.stiction_nm * factor(),
            presliding_rad: self.presliding_rad * factor(),
            ripple_rad: self.ripple_rad * factor(),
            ratio: self.ratio,
        }
    }

    /// δ (rad) under a load (Nm), on the branch z, at the motor angle θ (rad).
    pub fn deflection_rad(&self, load_nm: f64, z: f64, theta_rad: f64) -> f64 {
        let soft = self.soft_rad * (load_nm / self.soft_load_nm).tanh();
        let ripple = self.ripple_rad * (2.0 * self.ratio * theta_rad).sin();
        load_nm / self.stiffness_nm_per_rad + soft + self.hysteresis_rad * z + ripple
    }
}

/// Dahl's state after a way `step` over the distance that builds it up: exact for one direction.
pub(super) fn dahl(state: f64, step: f64, distance: f64) -> f64 {
    let sign = step.signum();
    sign - (sign - state) * (-step.abs() / distance).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_branch_forgets_where_it_came_from_and_takes_any_number_of_steps() {
        let once = dahl(-0.4, 2.0, 0.7);
        let thrice = (0..3).fold(-0.4, |z, _| dahl(z, 2.0 / 3.0, 0.7));
        assert!((once - thrice).abs() < 1e-14);
        assert!((dahl(-1.0, 100.0, 0.7) - 1.0).abs() < 1e-14 && (dahl(1.0, -100.0, 0.7) + 1.0).abs() < 1e-14);
        assert!((dahl(0.3, 0.0, 0.7) - 0.3).abs() < 1e-15);
    }

    #[test]
    fn the_gear_is_softer_near_zero() {
        let gear = Transmission { ripple_rad: 0.0, ..Transmission::panda()[0] };
        let slope = |load: f64| (gear.deflection_rad(load + 0.1, 0.0, 0.0) - gear.deflection_rad(load, 0.0, 0.0)) / 0.1;
        assert!(slope(-0.05) > 1.3 * slope(30.0));
        assert!((slope(60.0) * gear.stiffness_nm_per_rad - 1.0).abs() < 1e-6);
    }
}
