//! Springs between motors and links.

use nalgebra::{SMatrix, SVector};
use tribo_robot::SpdFactor;

use crate::hidden::Elasticity;
use crate::projected_gauss_seidel::solve_friction;

/// Flexible-joint arm (spong1987) at velocity level, springs implicit; v link and w motor velocity, δ = motor − link:
///
/// ```text
/// M v⁺ = M v + h b + λ,     Ir w⁺ = Ir w + h (tau − offset − Fv w⁺) − p − λ,     b = −bias − Jᵀ h_ext
/// λ = h (K δ⁺ + D (w⁺ − v⁺)),   δ⁺ = δ + h (w⁺ − v⁺)
/// ```
///
/// With the compliance C = 1/(h D + h² K), zero for a rigid joint, and B = (M⁻¹ + C)⁻¹ the links are eliminated:
///
/// ```text
/// (Ir + h Fv + B) w⁺ = Ir w + h (tau − offset) + B (v + h M⁻¹ b − K δ/(D + h K)) − p
/// ```
///
/// M is the mass matrix without rotors, Ir the rotors. The implicit step damps oscillations faster than about 1/h.
#[derive(Clone, Debug)]
pub(crate) struct FlexibleJoints<const N: usize> {
    springs: [Option<Elasticity>; N],
    deflection_rad: SVector<f64, N>,
    motor_qd: SVector<f64, N>,
}

/// What stays the same over a control period.
pub(crate) struct FlexiblePeriod<const N: usize> {
    link_inverse: SMatrix<f64, N, N>,
    /// B.
    coupling: SMatrix<f64, N, N>,
    /// M⁻¹ b [rad/s²].
    free_acceleration: SVector<f64, N>,
    rotor_inertia: SVector<f64, N>,
    h: f64,
}

impl<const N: usize> FlexibleJoints<N> {
    /// At rest under the torque `load` (Nm) through the gears; `None` if every joint is rigid.
    pub fn under(springs: [Option<Elasticity>; N], load: &SVector<f64, N>) -> Option<Self> {
        springs.iter().any(Option::is_some).then(|| Self {
            springs,
            deflection_rad: SVector::from_fn(|j, _| springs[j].map_or(0.0, |s| load[j] / s.stiffness_nm_per_rad)),
            motor_qd: SVector::zeros(),
        })
    }

    /// Motor less link angle (rad).
    pub fn deflection_rad(&self) -> &SVector<f64, N> {
        &self.deflection_rad
    }

    /// Motor velocities [rad/s].
    pub fn motor_qd(&self) -> &SVector<f64, N> {
        &self.motor_qd
    }

    /// The motors turn with the links.
    pub fn set_velocity(&mut self, qd: SVector<f64, N>) {
        self.motor_qd = qd;
    }

    /// Factors for one period with steps of h (s): `mass` [kg m²] with rotors, b (Nm).
    pub fn period(
        &self,
        mass: &SMatrix<f64, N, N>,
        rotor_inertia: &SVector<f64, N>,
        b: &SVector<f64, N>,
        h: f64,
    ) -> FlexiblePeriod<N> {
        let inverse = |m: SMatrix<f64, N, N>| SpdFactor::of(&m).map_or_else(SMatrix::zeros, |factor| factor.inverse());
        let link_inverse = inverse(mass - SMatrix::from_diagonal(rotor_inertia));
        let mut compliant = link_inverse;
        for j in 0..N {
            if let Some(s) = self.springs[j] {
                compliant[(j, j)] += 1.0 / (h * (s.damping_nm_s_per_rad + h * s.stiffness_nm_per_rad));
            }
        }
        let rotor_inertia = *rotor_inertia;
        FlexiblePeriod {
            link_inverse,
            coupling: inverse(compliant),
            free_acceleration: link_inverse * b,
            rotor_inertia,
            h,
        }
    }

    /// One step from the link velocity `qd` [rad/s] with the motor torque less offsets `drive` (Nm): the new link
    /// velocity. `a` is the inverse of [`FlexiblePeriod::motor_matrix`]; bounds and impulse (Nm s) as in
    /// [`solve_friction`].
    pub fn step(
        &mut self,
        period: &FlexiblePeriod<N>,
        a: &SMatrix<f64, N, N>,
        qd: &SVector<f64, N>,
        drive: &SVector<f64, N>,
        [lower, upper]: [&SVector<f64, N>; 2],
        impulse: &mut SVector<f64, N>,
    ) -> SVector<f64, N> {
        let h = period.h;
        let mut pull = qd + period.free_acceleration * h;
        for j in 0..N {
            if let Some(s) = self.springs[j] {
                let stiffness = s.stiffness_nm_per_rad;
                pull[j] -= stiffness * self.deflection_rad[j] / (s.damping_nm_s_per_rad + h * stiffness);
            }
        }
        let momentum = period.rotor_inertia.component_mul(&self.motor_qd) + drive * h + period.coupling * pull;
        let motor_qd = solve_friction(a, &momentum, lower, upper, impulse);
        let through_spring = period.coupling * (motor_qd - pull);
        let mut link_qd = qd + period.free_acceleration * h + period.link_inverse * through_spring;
        for j in 0..N {
            if self.springs[j].is_some() {
                self.motor_qd[j] = motor_qd[j];
                self.deflection_rad[j] += h * (motor_qd[j] - link_qd[j]);
            } else {
                // One body: a stuck joint stands exactly still.
                (self.motor_qd[j], link_qd[j]) = (motor_qd[j], motor_qd[j]);
            }
        }
        link_qd
    }
}

impl<const N: usize> FlexiblePeriod<N> {
    /// `Ir + h Fv + B` for viscous slopes Fv [Nm s/rad].
    pub fn motor_matrix(&self, viscous: &SVector<f64, N>) -> SMatrix<f64, N, N> {
        self.coupling + SMatrix::from_diagonal(&(self.rotor_inertia + viscous * self.h))
    }
}
