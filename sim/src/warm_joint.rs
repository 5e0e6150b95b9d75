//! A joint that warms itself.

/// Friction and heat of one joint with two thermal masses:
///
/// ```text
/// tau_f = {[c0 + c1 v + c2 v² + c3 v³] f + c4 e^{−h v} g} sign(q̇),   f = 1 + α (T − T0),   g = 1 + γ (T − T0),   v = |q̇|
/// C_g Ṫ = q̇ tau_f − K_gh (T − T_h),    C_h Ṫ_h = K_gh (T − T_h) − K_ha (T_h − T_room)
/// ```
///
/// The gears (T) give their heat to the housing (T_h), the housing to the room. A model with one mass (simoni2019) is an
/// approximation of it, as of a real joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WarmJoint {
    /// c0 … c3 [Nm, Nm s/rad, …].
    pub polynomial: [f64; 4],
    /// c4 (Nm).
    pub stribeck_nm: f64,
    /// h [s/rad].
    pub stribeck_decay_s_per_rad: f64,
    /// α [1/K].
    pub polynomial_slope_per_k: f64,
    /// γ [1/K].
    pub stribeck_slope_per_k: f64,
    /// T0 (°C).
    pub reference_c: f64,
    /// C_g [J/K].
    pub gear_capacity_j_per_k: f64,
    /// C_h [J/K].
    pub housing_capacity_j_per_k: f64,
    /// K_gh [W/K].
    pub gear_to_housing_w_per_k: f64,
    /// K_ha [W/K].
    pub housing_to_room_w_per_k: f64,
}

/// Temperatures of a [`WarmJoint`] (°C).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointWarmth {
    /// Of the gears.
    pub gear_c: f64,
    /// Of the housing.
    pub housing_c: f64,
}

impl JointWarmth {
    /// Both as warm as the room.
    pub fn rested(room_c: f64) -> Self {
        Self { gear_c: room_c, housing_c: room_c }
    }
}

impl WarmJoint {
    /// Friction torque (Nm) at q̇ [rad/s] with gears of `gear_c` (°C); zero at rest.
    #[inline]
    pub fn friction_nm(&self, qd: f64, gear_c: f64) -> f64 {
        let (v, rise) = (qd.abs(), gear_c - self.reference_c);
        let [c0, c1, c2, c3] = self.polynomial;
        let f = (1.0 + self.polynomial_slope_per_k * rise).max(0.0);
        let g = (1.0 + self.stribeck_slope_per_k * rise).max(0.0);
        let polynomial = c0 + c1 * v + c2 * v * v + c3 * v * v * v;
        let size = polynomial * f + self.stribeck_nm * (-self.stribeck_decay_s_per_rad * v).exp() * g;
        if qd == 0.0 { 0.0 } else { size * qd.signum() }
    }

    /// Temperatures after `dt_s` (s), far below either time constant, at q̇ [rad/s] in a room of `room_c` (°C).
    #[inline]
    pub fn warmed(&self, warmth: JointWarmth, qd: f64, room_c: f64, dt_s: f64) -> JointWarmth {
        let power = self.friction_nm(qd, warmth.gear_c) * qd;
        let inwards = self.gear_to_housing_w_per_k * (warmth.gear_c - warmth.housing_c);
        let outwards = self.housing_to_room_w_per_k * (warmth.housing_c - room_c);
        JointWarmth {
            gear_c: warmth.gear_c + (power - inwards) / self.gear_capacity_j_per_k * dt_s,
            housing_c: warmth.housing_c + (inwards - outwards) / self.housing_capacity_j_per_k * dt_s,
        }
    }

    /// Splits one mass of capacity C [J/K] and conductance K [W/K] into gears and housing: the gears have `gear_share` of C, the
    /// way to the housing `gear_resistance_share` of 1/K. At a steady state the gears are as warm as the one mass.
    pub fn with_heat(self, capacity: f64, conductance: f64, gear_share: f64, gear_resistance_share: f64) -> Self {
        Self {
            gear_capacity_j_per_k: gear_share * capacity,
            housing_capacity_j_per_k: (1.0 - gear_share) * capacity,
            gear_to_housing_w_per_k: conductance / gear_resistance_share,
            housing_to_room_w_per_k: conductance / (1.0 - gear_resistance_share),
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn joint() -> WarmJoint {
        WarmJoint {
            polynomial: [130.0, 125.0, 0.0, -5.0],
            stribeck_nm: 30.0,
            stribeck_decay_s_per_rad: 8.0,
            polynomial_slope_per_k: -0.00937,
            stribeck_slope_per_k: 0.004,
            reference_c: 22.0,
            gear_capacity_j_per_k: 0.0,
            housing_capacity_j_per_k: 0.0,
            gear_to_housing_w_per_k: 0.0,
            housing_to_room_w_per_k: 0.0,
        }
        .with_heat(18_000.0, 2.75, 0.6, 0.2)
    }

    /// Energy: what friction put in is in the masses or in the room; and at a steady state all of it passes through.
    #[test]
    fn heat_is_conserved() {
        let (joint, room, dt) = (joint(), 22.0, 0.5);
        let (mut warmth, mut in_j, mut out_j) = (JointWarmth::rested(room), 0.0, 0.0);
        for k in 0..200_000 {
            let qd = 1.2 * (f64::from(k) * 0.7).sin();
            in_j += joint.friction_nm(qd, warmth.gear_c) * qd * dt;
            out_j += joint.housing_to_room_w_per_k * (warmth.housing_c - room) * dt;
            warmth = joint.warmed(warmth, qd, room, dt);
        }
        let stored = joint.gear_capacity_j_per_k * (warmth.gear_c - room)
            + joint.housing_capacity_j_per_k * (warmth.housing_c - room);
        assert!((in_j - out_j - stored).abs() < 1e-6 * in_j);
        // All day at the same work: the gears are P/K above the room.
        let mean_w = 2.75 * (warmth.gear_c - room);
        let housing = room + 0.8 * (warmth.gear_c - room);
        assert!((warmth.housing_c - housing).abs() < 0.2 && mean_w > 50.0, "{warmth:?}");
    }
}
