//! The virtual force sensor in a polishing task (simoni2017): contact cycles with and without temperature.

use nalgebra::{SVector, Vector3, Vector6};
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};
use tribo_friction::thermal::{CapacityAnchor, TemperatureFactor, ThermalJoint, ThermalLaw};
use tribo_residual::{ThermalEstimator, ThermalSettings};
use tribo_robot::{Arm, ControlTerms, EstimatorInput, Kinematics, SensorFrame, Wrench, WrenchEstimator, presets, rnea};
use tribo_sim::{JointWarmth, WarmJoint};

use super::DutyCycleStudy;
use super::observer_run::equivalent_c;
use super::simoni2019::rounded;
use crate::reproduce::{ExperimentError, Quantity, SeedRun};
use tribo_model::FieldError;

type Joints = SVector<f64, 7>;

/// Motor-side friction of the examples: Coulomb (Nm), viscous [Nm s/rad], what a start takes more (Nm).
const COULOMB_NM: [f64; 7] = [0.60, 0.90, 0.55, 0.80, 0.40, 0.30, 0.35];
const VISCOUS_NM_S: [f64; 7] = [1.0, 1.4, 0.8, 1.1, 0.5, 0.4, 0.3];
const STRIBECK_NM: [f64; 7] = [0.15, 0.22, 0.14, 0.20, 0.10, 0.08, 0.09];
const STRIBECK_DECAY: f64 = 12.0;
/// Temperature dependence: α of simoni2019; γ small and positive, as simoni2017 argues.
const SLOPES_PER_K: [f64; 2] = [-0.009_37, 0.004];
/// Rise (K) of a joint that works at full duty all day, and time constant C/K (s).
const FULL_RISE_K: f64 = 30.0;
const TIME_CONSTANT_S: f64 = 5400.0;
/// RMS error of the contact force of the paper's table III (N): with temperature, without; cycles 1, 3, 5.
const TABLE3: [[f64; 2]; 3] = [[21.3078, 27.2322], [21.7498, 27.4293], [21.2590, 25.6366]];
/// Two minutes free; then two minutes of contact and fifteen free, again and again (s).
const FIRST_FREE_S: f64 = 120.0;
const CONTACT_S: f64 = 120.0;
const PERIOD_S: f64 = 1020.0;
/// Contacts that are measured, from 0.
const MEASURED: [usize; 3] = [0, 2, 4];
/// Left out after the start and end of a contact (s): the force rises through the momentum observer.
const EDGE_S: f64 = 0.5;

/// Settings of the experiment, `schema: tribo.reproduce/1`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Simoni2017 {
    /// `tribo.reproduce/1`.
    pub schema: String,
    /// Seeds 1 to this one.
    pub seeds: u64,
    /// Ticks per second (Hz).
    pub rate_hz: f64,
    /// Gain of the momentum observer [rad/s]: corner of the low-pass on external forces, 15 in the paper's table II.
    pub gain_rad_s: f64,
    /// Temperature of the room, and where the estimator starts (°C).
    pub room_c: f64,
    /// How much warmer the joints are than the estimator is told (K).
    pub start_error_k: f64,
    /// Normal force of the contact (N).
    pub normal_force_n: f64,
    /// Friction of the tool on the disc [-].
    pub rubbing: f64,
    /// Noise of the motor torque (Nm).
    pub torque_sd_nm: f64,
    /// Noise of the velocity [rad/s].
    pub velocity_sd_rad_s: f64,
    /// Torque ripple that no model knows, as a part of the joint's Coulomb friction [-].
    pub ripple_share: f64,
    /// Part of the heat capacity that is in the gears, of the rest in the housing.
    pub gear_share: f64,
    /// Part of the thermal resistance that is between gears and housing.
    pub gear_resistance_share: f64,
    /// How well the heat capacities are known beforehand [-].
    pub capacity_relative_sd: f64,
}

/// What a figure needs of one seed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PolishingTrace {
    /// Times (s), twice a second.
    pub time_s: Vec<f64>,
    /// Of every joint, the estimated temperature and the one at which the model's friction would be the true one (°C).
    pub temperature_c: Vec<[[f64; 2]; 7]>,
    /// Ten times a second in measured contacts: time (s), force along z true (as late as the estimates), with temperature,
    /// without (N).
    pub force: Vec<[f64; 4]>,
}

/// Sums of the errors in one contact.
#[derive(Clone, Copy, Debug, Default)]
struct Errors {
    square: [f64; 2],
    count: f64,
    covered: [f64; 2],
    components: f64,
}

impl Simoni2017 {
    /// Checks every field.
    ///
    /// # Errors
    /// The first field outside its range.
    pub fn validate(&self) -> Result<(), FieldError> {
        if self.schema != "tribo.reproduce/1" {
            return Err(FieldError::new("schema", &self.schema, "tribo.reproduce/1"));
        }
        FieldError::check("seeds", self.seeds as f64, 1.0, 10_000.0)?;
        FieldError::check("rate_hz", self.rate_hz, 100.0, 1000.0)?;
        FieldError::check("gain_rad_s", self.gain_rad_s, 1.0, 200.0)?;
        FieldError::check("room_c", self.room_c, -20.0, 60.0)?;
        FieldError::check("start_error_k", self.start_error_k, -50.0, 50.0)?;
        FieldError::check("normal_force_n", self.normal_force_n, 0.0, 200.0)?;
        FieldError::check("rubbing", self.rubbing, 0.0, 2.0)?;
        FieldError::check("torque_sd_nm", self.torque_sd_nm, 1e-6, 10.0)?;
        FieldError::check("velocity_sd_rad_s", self.velocity_sd_rad_s, 0.0, 1.0)?;
        FieldError::check("ripple_share", self.ripple_share, 0.0, 1.0)?;
        FieldError::check("gear_share", self.gear_share, 0.05, 0.95)?;
        FieldError::check("gear_resistance_share", self.gear_resistance_share, 0.01, 0.95)?;
        FieldError::check("capacity_relative_sd", self.capacity_relative_sd, 1e-4, 1.0)
    }

    /// What is measured, in the order of the values.
    pub fn quantities(&self) -> Vec<Quantity> {
        let mut all = vec![
            Quantity::new("worst joint after 120 s of free motion", "K", None),
            Quantity::new("all joints within 2 K after", "s", None),
        ];
        for (k, row) in TABLE3.iter().enumerate() {
            let cycle = MEASURED[k] + 1;
            all.push(Quantity::new(format!("contact cycle {cycle}: RMS with temperature"), "N", Some(row[0])));
            all.push(Quantity::new(format!("contact cycle {cycle}: RMS without"), "N", Some(row[1])));
            let ratio = rounded(row[1] / row[0]);
            all.push(Quantity::new(format!("contact cycle {cycle}: without / with"), "-", Some(ratio)));
        }
        all.push(Quantity::new("95 % intervals cover, with temperature", "%", None));
        all.push(Quantity::new("95 % intervals cover, without", "%", None));
        all.push(Quantity::new("contact taken for free motion", "%", None));
        all
    }

    fn truth(&self, j: usize, top_speed_rad_s: f64) -> WarmJoint {
        let joint = WarmJoint {
            polynomial: [COULOMB_NM[j], VISCOUS_NM_S[j], 0.0, 0.0],
            stribeck_nm: STRIBECK_NM[j],
            stribeck_decay_s_per_rad: STRIBECK_DECAY,
            polynomial_slope_per_k: SLOPES_PER_K[0],
            stribeck_slope_per_k: SLOPES_PER_K[1],
            reference_c: self.room_c,
            gear_capacity_j_per_k: 0.0,
            housing_capacity_j_per_k: 0.0,
            gear_to_housing_w_per_k: 0.0,
            housing_to_room_w_per_k: 0.0,
        };
        // Half sines of mean peak speed 0.53 of the top: the power of full duty when cold.
        let mean = 0.53 * top_speed_rad_s * std::f64::consts::FRAC_2_PI;
        let power = mean * joint.friction_nm(mean, self.room_c);
        let conductance = power / FULL_RISE_K;
        joint.with_heat(conductance * TIME_CONSTANT_S, conductance, self.gear_share, self.gear_resistance_share)
    }

    /// One seed, with what figures need of it: seven joints identified from duty cycles, then the polishing task.
    ///
    /// # Errors
    /// Where the identification fails.
    pub fn run(&self, seed: u64) -> Result<(SeedRun, PolishingTrace), ExperimentError> {
        let arm = presets::panda();
        let top = arm.limits.qd_max_rad_s * 0.5;
        let truth: [WarmJoint; 7] = std::array::from_fn(|j| self.truth(j, top[j]));
        let mut joints = Vec::with_capacity(7);
        for j in 0..7 {
            let study = DutyCycleStudy {
                top_speed_rad_s: top[j],
                minutes: 240.0,
                rate_hz: 4.0,
                noise_sd_nm: self.torque_sd_nm,
                room_c: self.room_c,
            };
            let capacity_j_per_k = truth[j].gear_capacity_j_per_k + truth[j].housing_capacity_j_per_k;
            let anchor = CapacityAnchor { capacity_j_per_k, relative_sd: self.capacity_relative_sd };
            joints.push(study.identify(&truth[j], 6.0, anchor, 1000 * seed + j as u64)?.joint);
        }
        let warm: [ThermalJoint; 7] = std::array::from_fn(|j| joints[j]);
        let mut blind = warm;
        for joint in &mut blind {
            let none = TemperatureFactor::NONE;
            *joint = ThermalJoint::new(ThermalLaw { polynomial: none, stribeck: none, ..*joint.law() }, *joint.heat())?;
        }
        let settings = ThermalSettings {
            gain_rad_s: self.gain_rad_s,
            torque_sd_nm: Joints::repeat(self.torque_sd_nm),
            velocity_sd_rad_s: Joints::repeat(self.velocity_sd_rad_s),
            ..ThermalSettings::new(warm, self.room_c)
        };
        let with = ThermalEstimator::new(settings)?;
        let without = ThermalEstimator::new(ThermalSettings { joints: blind, ..settings })?;
        Ok(self.polish(&arm, &truth, [with, without], seed))
    }

    fn polish(
        &self,
        arm: &Arm<7>,
        truth: &[WarmJoint; 7],
        mut estimators: [ThermalEstimator<7>; 2],
        seed: u64,
    ) -> (SeedRun, PolishingTrace) {
        let mut rng = Pcg64::seed_from_u64(50_000 + seed);
        let dt = 1.0 / self.rate_hz;
        let start = JointWarmth {
            gear_c: self.room_c + self.start_error_k,
            housing_c: self.room_c + (1.0 - self.gear_resistance_share) * self.start_error_k,
        };
        let mut warmth = [start; 7];
        // The true wrench as late as the estimates say they are.
        let (mut late, share) = (Vector6::<f64>::zeros(), -(-dt / estimators[0].delay_s()).exp_m1());
        let mut trace = PolishingTrace::default();
        let mut errors = [Errors::default(); 3];
        let (mut worst_at_120, mut found_s, mut missed, mut in_contact) = (0.0_f64, 0.0_f64, 0.0, 0.0);
        let last = *MEASURED.last().unwrap_or(&0);
        let end_s = FIRST_FREE_S + PERIOD_S * last as f64 + CONTACT_S;
        let ticks = (end_s * self.rate_hz) as u64;
        for k in 0..ticks {
            let t = (k + 1) as f64 * dt;
            let ([qm, qdm, qddm], [q, qd, _]) = (path(t - 0.5 * dt), path(t));
            let since = t - FIRST_FREE_S;
            let (cycle, phase) = ((since / PERIOD_S).floor(), since.rem_euclid(PERIOD_S));
            let touches = since >= 0.0 && phase < CONTACT_S;
            let kinematics = Kinematics::at(arm, &qm);
            let jacobian = kinematics.jacobian();
            let wrench = if touches { self.contact(phase, &(jacobian * qdm)) } else { Wrench::default() };
            late += (wrench.to_vector() - late) * share;
            let mut noise = |sd: f64| -> Joints { Joints::from_fn(|_, _| sd * rng.sample::<f64, _>(StandardNormal)) };
            let (torque_noise, velocity_noise) = (noise(self.torque_sd_nm), noise(self.velocity_sd_rad_s));
            let friction = Joints::from_fn(|j, _| {
                let ripple = self.ripple_share * COULOMB_NM[j] * (23.0 * qm[j] + j as f64).sin();
                let tau = truth[j].friction_nm(qdm[j], warmth[j].gear_c) + ripple;
                warmth[j] = truth[j].warmed(warmth[j], qdm[j], self.room_c, dt);
                tau
            });
            let tau_motor =
                rnea(arm, &qm, &qdm, &qddm) + friction + jacobian.transpose() * wrench.to_vector() + torque_noise;
            let measured_qd = qd + velocity_noise;
            let terms = ControlTerms::at(arm, &q, &measured_qd);
            let frame = SensorFrame { time_s: t, q, qd: measured_qd, tau: tau_motor, theta: None };
            if k == 0 {
                estimators.iter_mut().for_each(|estimator| estimator.reset(&frame, &terms));
                continue;
            }
            let input = EstimatorInput {
                frame: &frame,
                terms: &terms,
                tau_motor: &tau_motor,
                tau_friction: &Joints::zeros(),
                acceleration_command: &Vector6::zeros(),
                dt_s: dt,
            };
            let estimates = estimators.each_mut().map(|estimator| estimator.step(&input));

            if k % (0.5 * self.rate_hz) as u64 == 0 {
                let temperatures = estimators[0].temperatures_c();
                let both: [[f64; 2]; 7] = std::array::from_fn(|j| {
                    [temperatures[j], equivalent_c(&truth[j], &estimators[0].settings().joints[j], warmth[j])]
                });
                if since < 0.0 {
                    worst_at_120 = both.iter().map(|[a, b]| (a - b).abs()).fold(0.0, f64::max);
                    if worst_at_120 >= 2.0 {
                        found_s = t;
                    }
                }
                trace.time_s.push(t);
                trace.temperature_c.push(both);
            }
            let measured = MEASURED.iter().position(|&c| touches && c as f64 == cycle);
            let Some(row) = measured else { continue };
            if !(EDGE_S..CONTACT_S - EDGE_S).contains(&phase) {
                continue;
            }
            let forces = estimates.map(|estimate| estimate.wrench_base.force_n.z);
            let e = &mut errors[row];
            e.count += 1.0;
            e.components += 6.0;
            for i in 0..2 {
                e.square[i] += (forces[i] - late[5]).powi(2);
                let inside = estimates[i].interval95().contain(&Wrench::from_vector(&late));
                e.covered[i] += inside.iter().filter(|&&inside| inside).count() as f64;
            }
            in_contact += 1.0;
            missed += f64::from(estimators[0].is_free());
            if k % (0.1 * self.rate_hz) as u64 == 0 {
                trace.force.push([t, late[5], forces[0], forces[1]]);
            }
        }
        let mut values = vec![worst_at_120, found_s];
        for e in &errors {
            let [with, without] = e.square.map(|square| (square / e.count).sqrt());
            values.extend([with, without, without / with]);
        }
        let components: f64 = errors.iter().map(|e| e.components).sum();
        for i in 0..2 {
            values.push(100.0 * errors.iter().map(|e| e.covered[i]).sum::<f64>() / components);
        }
        values.push(100.0 * missed / in_contact);
        (SeedRun { seed, values: values.into_iter().map(rounded).collect() }, trace)
    }

    /// Pressed in and lifted off within a quarter of a second, on a disc that is not quite flat and pushes back along z; it
    /// rubs against the motion of the tool.
    fn contact(&self, phase_s: f64, twist_base: &Vector6<f64>) -> Wrench {
        let ramp = (phase_s / 0.25).min((CONTACT_S - phase_s) / 0.25).clamp(0.0, 1.0);
        let normal = -ramp * self.normal_force_n * (1.0 + 0.2 * (std::f64::consts::TAU * 0.7 * phase_s).sin());
        let slip = Vector3::new(twist_base[3], twist_base[4], 0.0);
        let along = slip / (slip.norm() + 1e-3);
        let force = along * (self.rubbing * normal.abs()) + Vector3::new(0.0, 0.0, normal);
        Wrench::from_force_moment(&[force.x, force.y, force.z, 0.0, 0.0, 0.0])
    }
}

/// Every joint strokes around the ready pose at its own frequency, 0.4 to 0.8 rad/s at most.
fn path(t: f64) -> [Joints; 3] {
    let w = Joints::from_fn(|j, _| 1.6 + 0.23 * j as f64);
    let x = Joints::from_fn(|j, _| w[j] * t + j as f64);
    let (s, c) = (x.map(f64::sin) * 0.25, x.map(f64::cos) * 0.25);
    [presets::panda_ready_pose() + s, c.component_mul(&w), -s.component_mul(&w).component_mul(&w)]
}
