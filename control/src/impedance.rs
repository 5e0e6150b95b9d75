//! The impedance law.

use nalgebra::{SVector, Vector6};
use serde::{Deserialize, Serialize};
use tribo_robot::{ControlTerms, Pose, product};

use crate::DampedPseudoInverse;
use crate::pose_error::pose_error;

/// Gains of the impedance, isotropic in translation and in rotation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ImpedanceSettings {
    /// Desired mass (kg). Paper: 10.
    pub mass_kg: f64,
    /// Desired rotational inertia [kg m²]. Paper: 10.
    pub inertia_kg_m2: f64,
    /// Translational stiffness [N/m]. Paper: 2500.
    pub stiffness_n_per_m: f64,
    /// Rotational stiffness [Nm/rad]. Paper: 5000.
    pub stiffness_nm_per_rad: f64,
    /// Damping ratio h of `D = 2 h √(M K)` [-]. Paper: 0.75.
    pub damping_ratio: f64,
    /// Null-space damping Dn [1/s]. The paper gives none; below 20 an over-compensated elbow slides into its limits.
    pub nullspace_damping_per_s: f64,
    /// Posture spring in the null space, as stiffness over inertia [1/s²]; 0 leaves the paper's pure damping.
    pub posture_stiffness_per_s2: f64,
}

impl Default for ImpedanceSettings {
    fn default() -> Self {
        Self {
            mass_kg: 10.0,
            inertia_kg_m2: 10.0,
            stiffness_n_per_m: 2500.0,
            stiffness_nm_per_rad: 5000.0,
            damping_ratio: 0.75,
            nullspace_damping_per_s: 50.0,
            posture_stiffness_per_s2: 0.0,
        }
    }
}

impl ImpedanceSettings {
    /// Impedance acceleration `a = −M⁻¹(D v + K e)` (roveda2022 eq. 6) [rad/s²; m/s²], base axes, angular part first.
    #[inline]
    pub fn acceleration(&self, twist: &Vector6<f64>, error: &Vector6<f64>) -> Vector6<f64> {
        let damping = |mass: f64, stiffness: f64| 2.0 * self.damping_ratio * (mass * stiffness).sqrt();
        let turning = damping(self.inertia_kg_m2, self.stiffness_nm_per_rad);
        let moving = damping(self.mass_kg, self.stiffness_n_per_m);
        Vector6::from_fn(|i, _| {
            if i < 3 {
                -(turning * twist[i] + self.stiffness_nm_per_rad * error[i]) / self.inertia_kg_m2
            } else {
                -(moving * twist[i] + self.stiffness_n_per_m * error[i]) / self.mass_kg
            }
        })
    }
}

/// Every term of the commanded torque (Nm), kept apart for the log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueTerms<const N: usize> {
    /// `B J#(a − J̇ qd)`.
    pub task: SVector<f64, N>,
    /// `B (I − J#J)(−Dn qd − k (q − q0))`.
    pub nullspace: SVector<f64, N>,
    /// `C qd`.
    pub coriolis: SVector<f64, N>,
    /// `g(q)`.
    pub gravity: SVector<f64, N>,
    /// Friction compensation of the law.
    pub friction: SVector<f64, N>,
    /// Compensation of effects beyond the law.
    pub effects: SVector<f64, N>,
}

impl<const N: usize> TorqueTerms<N> {
    /// No torque at all.
    pub fn zero() -> Self {
        let zero = SVector::zeros();
        Self { task: zero, nullspace: zero, coriolis: zero, gravity: zero, friction: zero, effects: zero }
    }

    /// The commanded torque before limits (roveda2022 eq. 34).
    #[inline]
    pub fn total(&self) -> SVector<f64, N> {
        self.task + self.nullspace + self.coriolis + self.gravity + self.friction + self.effects
    }
}

/// What the controller saw of the task at this tick, base axes, angular part first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TaskState<const N: usize> {
    /// Measured twist J qd [rad/s; m/s].
    pub twist: Vector6<f64>,
    /// Pose error `[log(R R_dᵀ); p − p_d]` [rad; m].
    pub error: Vector6<f64>,
    /// Commanded acceleration a [rad/s²; m/s²].
    pub acceleration_command: Vector6<f64>,
    /// Joint velocity that does not move the tool, (I − J#J) qd [rad/s].
    pub nullspace_qd: SVector<f64, N>,
    /// Joint velocity that the motion is meant to have, J# ẋ_m [rad/s].
    pub qd_reference: SVector<f64, N>,
}

impl<const N: usize> TaskState<N> {
    /// Nothing seen, nothing asked.
    pub fn zero() -> Self {
        Self {
            twist: Vector6::zeros(),
            error: Vector6::zeros(),
            acceleration_command: Vector6::zeros(),
            nullspace_qd: SVector::zeros(),
            qd_reference: SVector::zeros(),
        }
    }
}

/// Why a controller cannot answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ControlFault {
    /// State or model terms hold NaN or infinity.
    #[error("the state given to the controller is not finite")]
    NotFinite,
}

/// Cartesian impedance controller with inverse dynamics (roveda2022 eqs. 2, 6, 7, 33, 34).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImpedanceController<const N: usize> {
    /// Gains.
    pub settings: ImpedanceSettings,
    /// Pseudo-inverse of the Jacobian.
    pub pseudo_inverse: DampedPseudoInverse,
    /// Posture q0 (rad) of the optional null-space spring.
    pub posture: SVector<f64, N>,
    /// Rotor inertia Ir of the arm [kg m²], which the gears do not bear.
    pub rotor_inertia_kg_m2: SVector<f64, N>,
}

impl<const N: usize> ImpedanceController<N> {
    /// One tick: torque terms (Nm) for the measured state (q (rad), qd [rad/s]) and the reference pose.
    ///
    /// `compensation` maps (measured qd, reference qd, load) to the torques (Nm) of friction law and effects; the reference joint velocity
    /// J# ẋ_m is formed here from `twist_model`, the twist of the [`crate::ReferenceModel`], and the load is what this tick
    /// asks the links to bear, `(B − Ir) qdd + C qd + g` without rotor inertia (Nm).
    #[inline]
    pub fn tick(
        &self,
        terms: &ControlTerms<N>,
        q: &SVector<f64, N>,
        qd: &SVector<f64, N>,
        reference: &Pose,
        twist_model: &Vector6<f64>,
        compensation: impl FnOnce(
            &SVector<f64, N>,
            &SVector<f64, N>,
            &SVector<f64, N>,
        ) -> (SVector<f64, N>, SVector<f64, N>),
    ) -> Result<(TorqueTerms<N>, TaskState<N>), ControlFault> {
        let inverse = self.pseudo_inverse.factor(&terms.jacobian).ok_or(ControlFault::NotFinite)?;
        let pose = &terms.base_from_flange;
        let twist = product(&terms.jacobian, qd);
        let error = pose_error(&pose.translation.vector, pose.rotation.matrix(), reference);
        let acceleration_command = self.settings.acceleration(&twist, &error);
        let gamma = inverse.apply(&(acceleration_command - terms.jdot_qd));
        let nullspace_qd = inverse.project_to_null_space(qd);
        let mut settle = nullspace_qd * -self.settings.nullspace_damping_per_s;
        if self.settings.posture_stiffness_per_s2 > 0.0 {
            let displaced = inverse.project_to_null_space(&(q - self.posture));
            settle -= displaced * self.settings.posture_stiffness_per_s2;
        }
        let qd_reference = inverse.apply(twist_model);
        let (task, nullspace) = (product(&terms.mass_matrix, &gamma), product(&terms.mass_matrix, &settle));
        let rotor = self.rotor_inertia_kg_m2.component_mul(&(gamma + settle));
        let load = task + nullspace - rotor + terms.bias_nm();
        let (friction, effects) = compensation(qd, &qd_reference, &load);
        let torque =
            TorqueTerms { task, nullspace, coriolis: terms.coriolis_nm, gravity: terms.gravity_nm, friction, effects };
        if torque.total().iter().all(|tau| tau.is_finite()) {
            Ok((torque, TaskState { twist, error, acceleration_command, nullspace_qd, qd_reference }))
        } else {
            Err(ControlFault::NotFinite)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tribo_robot::{Arm, forward_dynamics, presets};

    fn controller(arm: &Arm<7>, posture: SVector<f64, 7>) -> ImpedanceController<7> {
        ImpedanceController {
            settings: ImpedanceSettings::default(),
            pseudo_inverse: DampedPseudoInverse::default(),
            posture,
            rotor_inertia_kg_m2: arm.rotor_inertia_kg_m2,
        }
    }

    /// Witness: forward dynamics (ABA) under the commanded torque must give exactly the impedance's acceleration.
    #[test]
    fn the_arm_accelerates_as_the_impedance_says() {
        let arm = presets::panda();
        let q = presets::panda_ready_pose();
        let qd = SVector::<f64, 7>::from_fn(|i, _| 0.2 * (i as f64 + 1.0).sin());
        let terms = ControlTerms::at(&arm, &q, &qd);
        let mut reference = terms.base_from_flange;
        reference.translation.vector.x += 0.01;
        let controller = controller(&arm, q);
        let (torque, task) = controller
            .tick(&terms, &q, &qd, &reference, &Vector6::zeros(), |_, _, _| (SVector::zeros(), SVector::zeros()))
            .unwrap();
        let qdd = forward_dynamics(&arm, &q, &qd, &torque.total());
        let acceleration = terms.jacobian * qdd + terms.jdot_qd;
        assert!((acceleration - task.acceleration_command).amax() < 1e-9);
        // And the null space is damped at the stated rate.
        let inverse = controller.pseudo_inverse.factor(&terms.jacobian).unwrap();
        let null = inverse.project_to_null_space(&qdd) + inverse.project_to_null_space(&qd) * 50.0;
        assert!(null.amax() < 1e-9);
        assert!(task.error[3] < 0.0 && task.acceleration_command[3] - 0.01 * 250.0 < 5.0);
    }

    /// Witness: the load handed to the compensation is inverse dynamics of the link-side arm at the acceleration made.
    #[test]
    fn the_load_is_what_the_links_bear() {
        let arm = presets::panda();
        let q = presets::panda_ready_pose();
        let qd = SVector::<f64, 7>::from_fn(|i, _| 0.2 * (i as f64 + 1.0).sin());
        let terms = ControlTerms::at(&arm, &q, &qd);
        let controller = controller(&arm, q);
        let mut load = SVector::zeros();
        let answer = controller.tick(&terms, &q, &qd, &terms.base_from_flange, &Vector6::zeros(), |_, _, given| {
            load = *given;
            (SVector::zeros(), SVector::zeros())
        });
        let qdd = forward_dynamics(&arm, &q, &qd, &answer.unwrap().0.total());
        assert!((load - tribo_robot::rnea(&arm.link_side(), &q, &qd, &qdd)).amax() < 1e-9);
    }

    /// Six joints have no null space: its damping and its spring vanish, and the arm still accelerates as it should.
    #[test]
    fn an_arm_without_null_space_feels_no_spring_in_it() {
        let preset = presets::find("ur10e").unwrap();
        let preset = preset.with_joints::<6>().unwrap();
        let (arm, q) = (&preset.arm, preset.poses_rad[0]);
        let qd = SVector::<f64, 6>::from_fn(|i, _| 0.2 * (i as f64 + 1.0).sin());
        let terms = ControlTerms::at(arm, &q, &qd);
        let controller = ImpedanceController {
            settings: ImpedanceSettings { posture_stiffness_per_s2: 400.0, ..ImpedanceSettings::default() },
            pseudo_inverse: DampedPseudoInverse::default(),
            posture: q + SVector::repeat(0.5),
            rotor_inertia_kg_m2: arm.rotor_inertia_kg_m2,
        };
        let no_friction = |_: &_, _: &_, _: &_| (SVector::zeros(), SVector::zeros());
        let (torque, task) =
            controller.tick(&terms, &q, &qd, &terms.base_from_flange, &Vector6::zeros(), no_friction).unwrap();
        assert!(torque.nullspace.amax() < 1e-8 && task.nullspace_qd.amax() < 1e-10, "{torque:?}");
        let qdd = forward_dynamics(arm, &q, &qd, &torque.total());
        let acceleration = terms.jacobian * qdd + terms.jdot_qd;
        assert!((acceleration - task.acceleration_command).amax() < 1e-8);
    }

    #[test]
    fn nan_is_a_fault_not_a_torque() {
        let arm = presets::panda();
        let (q, qd) = (presets::panda_ready_pose(), SVector::<f64, 7>::repeat(f64::NAN));
        let terms = ControlTerms::at(&arm, &q, &qd);
        let controller = controller(&arm, q);
        let answer = controller.tick(&terms, &q, &qd, &terms.base_from_flange, &Vector6::zeros(), |_, _, _| {
            (SVector::zeros(), SVector::zeros())
        });
        assert_eq!(answer.unwrap_err(), ControlFault::NotFinite);
    }
}
