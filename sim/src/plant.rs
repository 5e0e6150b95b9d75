//! Time-stepping plant with set-valued friction.

use nalgebra::{SMatrix, SVector};
use tribo_friction::law::Bristle;
use tribo_friction::{JointFriction, SetValued};
use tribo_robot::{ControlTerms, Plant, PlantLost, SensorFrame, SpdFactor, Wrench, product, transposed_product};

use crate::friction_map::FrictionMap;
use crate::hidden::Hidden;
use crate::plant_effects::{PlantEffects, travelled};
use crate::projected_gauss_seidel::solve_friction;
use crate::sensors::SensorState;
use crate::soft_friction::solve_soft_friction;
use crate::{DryFriction, Sensors, TorqueSide, Truth, WrenchPulses};

/// Sub-steps per control period when nothing else is asked for.
pub const DEFAULT_SUB_STEPS: usize = 5;

/// Velocity-level plant (moreau1988) with n sub-steps h per control period:
///
/// ```text
/// A = (M + h diag(Fv))⁻¹,   v* = A (M v + h (tau − bias − Jᵀ h_ext − offset))
/// find |p| within h [lower, upper]:  v⁺ = v* − A p,   q⁺ = q + h v⁺
/// ```
///
/// The dry-friction impulse p is set-valued: true stick, no regularised sign. M, bias and J are held over one control
/// period. A truth whose dry friction creeps ([`DryFriction::Creeps`]) has the soft constraint of a physics engine in its place; joints with
/// springs hold all the same. A joint at its hard stop gets an unbounded impulse on that side (inelastic stop).
/// Motor torque is clipped to the arm's torque limits, as the drive would.
///
/// Hidden effects of the truth, which [`Truth::validate`] checks beforehand:
///
/// | effect | where it acts |
/// |---|---|
/// | payload, link_inertial, rotor_inertia, base_tilt | the arm, once |
/// | coulomb, viscous, stribeck, coulomb_asymmetry, load_friction | the set-valued map; the load is that of the last period, contact included |
/// | torque_offset, torque_ripple, position_spring | the map's offset, explicitly in q |
/// | friction_curve | viscous friction of its chord from standstill, implicit in the velocity |
/// | thermal_friction | scales dry and viscous friction of the law and of coulomb and viscous by the time since the start (or [`crate::WarmUp::operated_s`]), as if at work throughout |
/// | presliding | the whole Coulomb friction becomes a LuGre bristle; with an amplitude, so much of the dry friction does |
/// | joint_elasticity | motors on implicit springs (Spong): friction and the only encoder sit at the motors, contact and gravity at the links |
/// | backlash | the encoders only: they lead by the half gap on the side of the load; the free flight inside the gap is left out |
/// | torque_gain, time_delay | the torque sensor only; a negative delay is none |
/// | external_contact | added to the pulses, rising and falling within 20 ms |
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
    effects: Option<Box<PlantEffects<N>>>,
}

impl<const N: usize> BoxFrictionPlant<N> {
    /// Plant at rest at q (rad), 1 kHz with [`DEFAULT_SUB_STEPS`]; `seed` feeds the sensor noise.
    pub fn new(mut truth: Truth<N>, sensors: Sensors, q: SVector<f64, N>, seed: u64) -> Self {
        let effects = (!truth.effects.is_empty()).then(|| {
            let hidden = Hidden::of(&truth);
            truth.arm = hidden.arm.clone();
            Box::new(PlantEffects::new(hidden, &q, 1e-3))
        });
        Self {
            effects,
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
        if let Some(effects) = &mut self.effects {
            effects.set_period(dt_s);
        }
        self
    }

    /// The same plant pushed by `pulses`.
    pub fn with_pulses(mut self, pulses: WrenchPulses) -> Self {
        self.pulses = pulses;
        self
    }

    /// Lets `pulses` push the plant from now on.
    pub fn set_pulses(&mut self, pulses: WrenchPulses) {
        self.pulses = pulses;
    }

    /// The same plant starting with joint velocity qd [rad/s].
    pub fn with_velocity(mut self, qd: SVector<f64, N>) -> Self {
        self.qd = qd;
        if let Some(flexible) = self.effects.as_mut().and_then(|effects| effects.flexible.as_mut()) {
            flexible.set_velocity(qd);
        }
        self
    }

    /// True joint positions (rad), of the links.
    pub fn q(&self) -> &SVector<f64, N> {
        &self.q
    }

    /// True joint velocities [rad/s], of the links.
    pub fn qd(&self) -> &SVector<f64, N> {
        &self.qd
    }

    /// True motor positions (rad): those of the links, but for joints with a spring or a gap. The encoder sits here,
    /// or the second one ([`Sensors::motor_encoder_sd_rad`]).
    pub fn motor_position(&self) -> SVector<f64, N> {
        self.effects.as_ref().map_or(self.q, |effects| self.q + effects.motor_lead_rad())
    }

    /// True wrench by the robot on the environment during the last period.
    pub fn wrench(&self) -> Wrench {
        self.wrench
    }

    /// True friction torque (Nm), averaged over the last period; with what effects of single joints add.
    pub fn friction_torque(&self) -> &SVector<f64, N> {
        &self.friction_torque
    }

    /// Time since the start (s).
    pub fn time_s(&self) -> f64 {
        self.ticks as f64 * self.dt_s
    }

    /// Reads the joint sensors; a simulated arm always answers.
    pub fn sample(&mut self) -> SensorFrame<N> {
        let time_s = self.time_s();
        match &self.effects {
            None => self.sensors.sample(time_s, &self.q, &self.q, &self.torque_at_sensor, self.dt_s),
            Some(effects) => {
                let motor = self.q + effects.motor_lead_rad();
                self.sensors.sample(time_s, &self.q, &motor, &effects.sensed_torque(), self.dt_s)
            }
        }
    }

    /// Friction of every joint over a step of h (s), scaled by the warm-up; motor velocity qd [rad/s].
    #[inline]
    fn friction_map(&self, qd: &SVector<f64, N>, mass: &SMatrix<f64, N, N>, h: f64, scale: f64) -> FrictionMap<N> {
        FrictionMap::of(h, |j| self.set_valued(j, qd[j], mass[(j, j)], h, scale))
    }

    /// Whether that is the same whatever the arm does.
    #[inline]
    fn has_constant_map(&self) -> bool {
        self.effects.is_none()
            && self.truth.friction.joints.iter().all(|law| matches!(law, JointFriction::CoulombViscous(_)))
    }

    /// Friction of joint j as the set-valued map of this sub-step, scaled by the warm-up; motor velocity qd [rad/s].
    #[inline]
    fn set_valued(&self, j: usize, qd: f64, inertia: f64, h: f64, scale: f64) -> SetValued {
        let law = &self.truth.friction.joints[j];
        if let Some(effects) = &self.effects {
            let worked_s = self.time_s() + self.truth.warm_up.map_or(0.0, |warm_up| warm_up.operated_s);
            let lead = effects.flexible.as_ref().map_or(0.0, |flexible| flexible.deflection_rad()[j]);
            let motor = [self.q[j] + lead, qd];
            return effects.set_valued(j, law, self.bristles[j], motor, inertia, h, [scale, worked_s]);
        }
        let s = match law {
            JointFriction::Lugre(law) => law.set_valued(self.bristles[j], qd, inertia, h),
            law => law.set_valued(qd),
        };
        SetValued {
            viscous_nm_s_per_rad: scale * s.viscous_nm_s_per_rad,
            offset_nm: scale * s.offset_nm,
            lower_nm: scale * s.lower_nm,
            upper_nm: scale * s.upper_nm,
        }
    }

    /// Bristles at the end of a sub-step of h (s) that took the motors from `qd` to `qd_new` [rad/s].
    #[inline]
    fn advance_bristles(&mut self, qd: &SVector<f64, N>, qd_new: &SVector<f64, N>, h: f64) {
        for j in 0..N {
            let law = &self.truth.friction.joints[j];
            let presliding_distance_rad = match (&self.effects, law) {
                (Some(effects), law) => effects.presliding_rad(j, law),
                (None, JointFriction::Lugre(law)) => law.presliding_distance_rad,
                (None, _) => 0.0,
            };
            if presliding_distance_rad > 0.0 {
                self.bristles[j] = travelled(self.bristles[j], presliding_distance_rad, [qd[j], qd_new[j]], h);
            }
            if let Some(effects) = &mut self.effects {
                effects.advance_parts(j, qd[j], qd_new[j], h);
            }
        }
    }

    /// Whether any joint is at the end of its travel.
    #[inline]
    fn at_hard_stop(&self) -> bool {
        let limits = &self.truth.arm.limits;
        // Every sub-step asks, and the answer is nearly always no: one branch for all joints.
        (0..N).fold(false, |any, j| any | (self.q[j] <= limits.q_min_rad[j]) | (self.q[j] >= limits.q_max_rad[j]))
    }

    /// Motor velocities [rad/s].
    #[inline]
    fn motor_qd(&self) -> SVector<f64, N> {
        let flexible = self.effects.as_ref().and_then(|effects| effects.flexible.as_ref());
        flexible.map_or(self.qd, |flexible| *flexible.motor_qd())
    }
}

impl<const N: usize> Plant<N> for BoxFrictionPlant<N> {
    fn sense(&mut self) -> Result<SensorFrame<N>, PlantLost> {
        Ok(self.sample())
    }

    #[inline(never)]
    fn actuate(&mut self, tau_nm: &SVector<f64, N>) {
        let arm = &self.truth.arm;
        let limit = &arm.limits.tau_max_nm;
        let tau = SVector::<f64, N>::from_fn(|j, _| tau_nm[j].clamp(-limit[j], limit[j]));
        let time_s = self.time_s();
        let h = self.dt_s / self.sub_steps as f64;
        let terms = ControlTerms::at(arm, &self.q, &self.qd);
        let mass = terms.mass_matrix;
        self.wrench = self.pulses.at(time_s);
        if let Some(effects) = &self.effects {
            let contact = effects.contact_at(time_s);
            self.wrench.force_n += contact.force_n;
            self.wrench.moment_nm += contact.moment_nm;
        }
        let mut drive = tau - terms.bias_nm();
        if self.wrench != Wrench::default() {
            drive -= transposed_product(&terms.jacobian, &self.wrench.to_vector());
        }
        let scale = self.truth.warm_up.map_or(1.0, |warm_up| warm_up.scale(time_s));
        let motor_qd_before = self.motor_qd();
        let mut friction_impulse = SVector::<f64, N>::zeros();
        let (mut slope, mut a) = (SVector::<f64, N>::repeat(f64::NAN), SMatrix::<f64, N, N>::zeros());
        let flexible = self.effects.as_ref().and_then(|effects| effects.flexible.as_ref());
        let period = flexible.map(|flexible| flexible.period(&mass, &arm.rotor_inertia_kg_m2, &(drive - tau), h));

        // Of a rigid arm: M v, carried from step to step, and the map where it is the same in all of them.
        let mut momentum = product(&mass, &self.qd);
        let mut friction = self.friction_map(&motor_qd_before, &mass, h, scale);
        let constant = self.has_constant_map();

        let mut motor_qd = motor_qd_before;
        for step in 0..self.sub_steps {
            if step > 0 && !constant {
                friction = self.friction_map(&motor_qd, &mass, h, scale);
            }
            let FrictionMap { viscous, offset, mut lower, mut upper } = friction;
            if self.at_hard_stop() {
                let limits = &self.truth.arm.limits;
                for j in 0..N {
                    if self.q[j] <= limits.q_min_rad[j] {
                        lower[j] = f64::NEG_INFINITY;
                    }
                    if self.q[j] >= limits.q_max_rad[j] {
                        upper[j] = f64::INFINITY;
                    }
                }
            }
            // The factor changes only where the slope does (Gaz, LuGre); Coulomb and Stribeck keep it all period long.
            if slope != viscous {
                let mut implicit = mass;
                if let Some(period) = &period {
                    implicit = period.motor_matrix(&viscous);
                } else {
                    for j in 0..N {
                        implicit[(j, j)] += h * viscous[j];
                    }
                }
                a = SpdFactor::of(&implicit).map_or_else(SMatrix::zeros, |factor| factor.inverse());
                slope = viscous;
            }
            let flexible = self.effects.as_mut().and_then(|effects| effects.flexible.as_mut());
            self.qd = match (flexible, &period) {
                (Some(flexible), Some(period)) => {
                    flexible.step(period, &a, &self.qd, &(tau - offset), [&lower, &upper], &mut self.impulse)
                }
                _ => {
                    momentum += (drive - offset) * h;
                    let qd = match self.truth.dry {
                        DryFriction::Holds => solve_friction(&a, &momentum, &lower, &upper, &mut self.impulse),
                        DryFriction::Creeps => {
                            let free = (&momentum, &self.qd, h);
                            solve_soft_friction(&a, free, [&lower, &upper], &mut self.impulse)
                        }
                    };
                    momentum -= self.impulse + viscous.component_mul(&qd) * h;
                    qd
                }
            };
            let motor_qd_new = if period.is_some() { self.motor_qd() } else { self.qd };
            if !constant {
                self.advance_bristles(&motor_qd, &motor_qd_new, h);
            }
            motor_qd = motor_qd_new;
            friction_impulse += self.impulse + (offset + viscous.component_mul(&motor_qd)) * h;
            self.q += self.qd * h;
        }

        self.friction_torque = friction_impulse / self.dt_s;
        let motor_acceleration = (motor_qd - motor_qd_before) / self.dt_s;
        let rotor = self.truth.arm.rotor_inertia_kg_m2.component_mul(&motor_acceleration);
        let through_gears = tau - self.friction_torque - rotor;
        self.torque_at_sensor = match self.torque_side {
            TorqueSide::Motor => tau,
            TorqueSide::Link => through_gears,
        };
        if let Some(effects) = &mut self.effects {
            effects.end_period(&self.torque_at_sensor, &through_gears, self.dt_s);
        }
        self.ticks += 1;
    }
}
