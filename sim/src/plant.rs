//! Time-stepping plant with set-valued friction.

use nalgebra::{SMatrix, SVector};
use tribo_friction::law::Bristle;
use tribo_friction::{JointFriction, SetValued};
use tribo_robot::{Kinematics, Plant, SensorFrame, Wrench, bias_torque, mass_matrix};

use crate::projected_gauss_seidel::solve_friction;
use crate::sensors::SensorState;
use crate::{Sensors, TorqueSide, Truth, WrenchPulses};

/// Sub-steps per control period when nothing else is asked for.
pub const DEFAULT_SUB_STEPS: usize = 5;

/// Velocity-level plant (Moreau 1988) with n sub-steps h per control period:
///
/// ```text
/// A = (M + h diag(Fv))⁻¹,   v* = A (M v + h (tau − bias − Jᵀ h_ext − offset))
/// find |p| within h [lower, upper]:  v⁺ = v* − A p,   q⁺ = q + h v⁺
/// ```
///
/// The dry-friction impulse p is set-valued: true stick, no regularised sign. M, bias and J are held over one control
/// period. A joint at its hard stop gets an unbounded impulse on that side (inelastic stop).
/// Motor torque is clipped to the arm's torque limits, as the drive would.
#[derive(Clone, Debug)]
pub struct BoxFrictionPlant<const N: usize> {
    truth: Truth<N>,
    pulses: WrenchPulses,
    sensors: SensorState<N>,
    torque_side: TorqueSide,
    sub_steps: usize,
    dt_s: f64,
    ticks: u64,
    q: SVector<f64, N>,
    qd: SVector<f64, N>,
    bristles: [Bristle; N],
    impulse: SVector<f64, N>,
    torque_at_sensor: SVector<f64, N>,
    friction_torque: SVector<f64, N>,
    wrench: Wrench,
}

impl<const N: usize> BoxFrictionPlant<N> {
    /// Plant at rest at q (rad), 1 kHz with [`DEFAULT_SUB_STEPS`]; `seed` feeds the sensor noise.
    pub fn new(truth: Truth<N>, sensors: Sensors, q: SVector<f64, N>, seed: u64) -> Self {
        Self {
            truth,
            pulses: WrenchPulses::default(),
            sensors: SensorState::new(sensors, seed),
            torque_side: sensors.torque_side,
            sub_steps: DEFAULT_SUB_STEPS,
            dt_s: 1e-3,
            ticks: 0,
            q,
            qd: SVector::zeros(),
            bristles: [Bristle::default(); N],
            impulse: SVector::zeros(),
            torque_at_sensor: SVector::zeros(),
            friction_torque: SVector::zeros(),
            wrench: Wrench::default(),
        }
    }

    /// The same plant with another number of sub-steps (at least one) per control period.
    pub fn with_sub_steps(mut self, sub_steps: usize) -> Self {
        self.sub_steps = sub_steps.max(1);
        self
    }

    /// The same plant with another control period (s).
    pub fn with_period(mut self, dt_s: f64) -> Self {
        self.dt_s = dt_s;
        self
    }

    /// The same plant pushed by `pulses`.
    pub fn with_pulses(mut self, pulses: WrenchPulses) -> Self {
        self.pulses = pulses;
        self
    }

    /// The same plant starting with joint velocity qd [rad/s].
    pub fn with_velocity(mut self, qd: SVector<f64, N>) -> Self {
        self.qd = qd;
        self
    }

    /// True joint positions (rad).
    pub fn q(&self) -> &SVector<f64, N> {
        &self.q
    }

    /// True joint velocities [rad/s].
    pub fn qd(&self) -> &SVector<f64, N> {
        &self.qd
    }

    /// True wrench by the robot on the environment during the last period.
    pub fn wrench(&self) -> Wrench {
        self.wrench
    }

    /// True friction torque (Nm), averaged over the last period.
    pub fn friction_torque(&self) -> &SVector<f64, N> {
        &self.friction_torque
    }

    /// Time since the start (s).
    pub fn time_s(&self) -> f64 {
        self.ticks as f64 * self.dt_s
    }

    /// Friction of every joint as the set-valued map of this sub-step, scaled by the warm-up.
    #[inline]
    fn set_valued(&self, j: usize, inertia: f64, h: f64, scale: f64) -> SetValued {
        let s = match &self.truth.friction.joints[j] {
            JointFriction::Lugre(law) => law.set_valued(self.bristles[j], self.qd[j], inertia, h),
            law => law.set_valued(self.qd[j]),
        };
        SetValued {
            viscous_nm_s_per_rad: scale * s.viscous_nm_s_per_rad,
            offset_nm: scale * s.offset_nm,
            lower_nm: scale * s.lower_nm,
            upper_nm: scale * s.upper_nm,
        }
    }
}

impl<const N: usize> Plant<N> for BoxFrictionPlant<N> {
    fn sense(&mut self) -> SensorFrame<N> {
        self.sensors.sample(self.time_s(), &self.q, &self.torque_at_sensor, self.dt_s)
    }

    fn actuate(&mut self, tau_nm: &SVector<f64, N>) {
        let arm = &self.truth.arm;
        let limit = &arm.limits.tau_max_nm;
        let tau = SVector::<f64, N>::from_fn(|j, _| tau_nm[j].clamp(-limit[j], limit[j]));
        let time_s = self.time_s();
        let h = self.dt_s / self.sub_steps as f64;
        let mass = mass_matrix(arm, &self.q);
        let bias = bias_torque(arm, &self.q, &self.qd);
        self.wrench = self.pulses.at(time_s);
        let mut drive = tau - bias;
        if self.wrench != Wrench::default() {
            drive -= Kinematics::at(arm, &self.q).jacobian().transpose() * self.wrench.to_vector();
        }
        let scale = self.truth.warm_up.map_or(1.0, |warm_up| warm_up.scale(time_s));
        let qd_before = self.qd;
        let mut friction_impulse = SVector::<f64, N>::zeros();
        let mut factored: Option<(SVector<f64, N>, SMatrix<f64, N, N>)> = None;

        for _ in 0..self.sub_steps {
            let (mut viscous, mut offset) = (SVector::<f64, N>::zeros(), SVector::<f64, N>::zeros());
            let (mut lower, mut upper) = (SVector::<f64, N>::zeros(), SVector::<f64, N>::zeros());
            for j in 0..N {
                let s = self.set_valued(j, mass[(j, j)], h, scale);
                viscous[j] = s.viscous_nm_s_per_rad;
                offset[j] = s.offset_nm;
                let limits = &self.truth.arm.limits;
                lower[j] = if self.q[j] <= limits.q_min_rad[j] { f64::NEG_INFINITY } else { h * s.lower_nm };
                upper[j] = if self.q[j] >= limits.q_max_rad[j] { f64::INFINITY } else { h * s.upper_nm };
            }
            // The factor changes only where the slope does (Gaz, LuGre); Coulomb and Stribeck keep it all period long.
            let a = match &factored {
                Some((slope, inverse)) if *slope == viscous => *inverse,
                _ => {
                    let mut implicit = mass;
                    for j in 0..N {
                        implicit[(j, j)] += h * viscous[j];
                    }
                    let inverse = implicit.cholesky().map_or_else(SMatrix::zeros, |factor| factor.inverse());
                    factored = Some((viscous, inverse));
                    inverse
                }
            };
            let v_free = a * (mass * self.qd + (drive - offset) * h);
            let qd_new = solve_friction(&a, &v_free, &lower, &upper, &mut self.impulse);
            for j in 0..N {
                if let JointFriction::Lugre(law) = &self.truth.friction.joints[j] {
                    self.bristles[j] = law.advanced(self.bristles[j], self.qd[j], qd_new[j], h);
                }
            }
            friction_impulse += self.impulse + (offset + viscous.component_mul(&qd_new)) * h;
            self.qd = qd_new;
            self.q += self.qd * h;
        }

        self.friction_torque = friction_impulse / self.dt_s;
        self.torque_at_sensor = match self.torque_side {
            TorqueSide::Motor => tau,
            TorqueSide::Link => {
                let acceleration = (self.qd - qd_before) / self.dt_s;
                tau - self.friction_torque - self.truth.arm.rotor_inertia_kg_m2.component_mul(&acceleration)
            }
        };
        self.ticks += 1;
    }
}
