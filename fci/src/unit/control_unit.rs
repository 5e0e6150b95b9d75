//! The state machine of the control unit.

use nalgebra::SVector;
use tribo_robot::{Arm, ControlTerms, Kinematics, Payload, Plant, PlantLost, Pose, SensorFrame};

use super::collision::{CollisionThresholds, Touch};
use super::desired::{Desired, PERIOD_S};
use super::external_torque::ExternalTorque;
use super::frames::{Frames, pose_of};
use super::generator::Generator;
use super::impedance::{cartesian_impedance, joint_impedance};
use super::limits::MotionLimits;
use super::motion::Motion;
use crate::wire::{
    ControllerMode, CyclicCommand, ErrorFlags, FciVersion, MotionRequest, MoveEnd, Refusal, RobotError, RobotMode,
    RobotState, Setting,
};

/// Stiffness (Nm/rad) of the joints unless the client sets another. Source: libfranka's examples.
const JOINT_STIFFNESS: [f64; 7] = [3000.0, 3000.0, 3000.0, 2500.0, 2500.0, 2000.0, 2000.0];
/// Stiffness of the end effector (N/m, Nm/rad), likewise.
const CARTESIAN_STIFFNESS: [f64; 6] = [3000.0, 3000.0, 3000.0, 300.0, 300.0, 300.0];
/// Time constant (s) with which an arm is stopped: 40 rad/s² from the Panda's full speed.
const STOPPING_S: f64 = 0.05;
/// Periods within which an arm stands that is being stopped.
const STOPPING_PERIODS: u32 = 500;
/// Speed beyond its limit (rad/s) at which a joint's motion is stopped: noise of the velocity signal is no violation.
const SPEED_MARGIN_RAD_S: f64 = 0.05;

/// The control unit of a Franka arm before a plant: gravity compensation, motion generators, controllers, observer of the
/// external torque, limits, reflexes. One call of [`Self::cycle`] is one period of 1 ms; nothing is allocated in it, no
/// clock is read, and the same commands give the same bits.
///
/// ```text
/// τ_motor = τ_J_d + g(q)         g of the arm with the load that the client has set
/// ```
///
/// The plant's torque sensor sits on the link side, as a real one's does. Limits and errors are those of libfranka
/// ([`MotionLimits`]); accelerations and jerks are checked with a margin for floats.
#[derive(Clone, Debug)]
pub struct ControlUnit<P> {
    plant: P,
    bare: Arm<7>,
    arm: Arm<7>,
    limits: MotionLimits,
    frames: Frames,
    thresholds: CollisionThresholds,
    joint_stiffness: [f64; 7],
    cartesian_stiffness: [f64; 6],
    frame: SensorFrame<7>,
    terms: ControlTerms<7>,
    external: ExternalTorque,
    touch: Touch,
    mode: RobotMode,
    motion: Option<Motion>,
    desired: Desired,
    /// Periods left of stopping.
    stopping: u32,
    /// What acts beside gravity.
    torque_nm: SVector<f64, 7>,
    /// What a motion asked for; nothing while the arm is held.
    commanded_nm: SVector<f64, 7>,
    torque_rate_nm_s: SVector<f64, 7>,
    errors: ErrorFlags,
    reflex_reason: ErrorFlags,
    success_rate: f64,
}

impl<P: Plant<7>> ControlUnit<P> {
    /// A unit for this arm, whose dynamics (rotors included) it believes, before a plant at rest.
    ///
    /// # Errors
    ///
    /// [`PlantLost`] where the plant gives no sample to begin with.
    pub fn new(version: FciVersion, arm: Arm<7>, mut plant: P) -> Result<Self, PlantLost> {
        let frame = plant.sense()?;
        let frames = Frames::default();
        let terms = ControlTerms::at(&arm, &frame.q, &frame.qd);
        let end_effector = terms.base_from_flange * frames.flange_from_end_effector();
        Ok(Self {
            limits: MotionLimits::of(version, &arm),
            external: ExternalTorque::at(&frame, &link_side(&terms, &arm)),
            desired: Desired::rest(frame.q, end_effector),
            bare: arm.clone(),
            arm,
            frames,
            thresholds: CollisionThresholds::default(),
            joint_stiffness: JOINT_STIFFNESS,
            cartesian_stiffness: CARTESIAN_STIFFNESS,
            frame,
            terms,
            touch: Touch::default(),
            mode: RobotMode::Idle,
            motion: None,
            stopping: 0,
            torque_nm: SVector::zeros(),
            commanded_nm: SVector::zeros(),
            torque_rate_nm_s: SVector::zeros(),
            errors: ErrorFlags::default(),
            reflex_reason: ErrorFlags::default(),
            success_rate: 0.0,
            plant,
        })
    }

    /// The plant, for its truth.
    pub fn plant(&self) -> &P {
        &self.plant
    }

    /// The arm as the unit believes it, without load.
    pub fn bare_arm(&self) -> &Arm<7> {
        &self.bare
    }

    /// Limits of commanded motions.
    pub fn limits(&self) -> &MotionLimits {
        &self.limits
    }

    /// What the robot is doing.
    pub fn mode(&self) -> RobotMode {
        self.mode
    }

    /// The error flags that are set.
    pub fn errors(&self) -> ErrorFlags {
        self.errors
    }

    /// Whether the running motion has had a command.
    pub fn is_commanded(&self) -> bool {
        self.motion.is_some_and(|motion| motion.last.is_some())
    }

    /// Whether the arm is still being stopped.
    pub fn is_stopping(&self) -> bool {
        self.stopping > 0
    }

    /// Starts a motion.
    ///
    /// # Errors
    ///
    /// [`Refusal::NotPossible`] in a motion or a reflex.
    pub fn start(&mut self, request: MotionRequest) -> Result<(), Refusal> {
        if self.mode != RobotMode::Idle {
            return Err(Refusal::NotPossible);
        }
        self.motion = Some(Motion::new(request));
        self.mode = RobotMode::Move;
        // Torques of a client begin at zero, whatever it takes to hold the arm.
        self.commanded_nm = SVector::zeros();
        self.reflex_reason = ErrorFlags::default();
        self.success_rate = 1.0;
        Ok(())
    }

    /// Ends the motion, if there is one, and stops the arm.
    pub fn stop(&mut self) {
        if let Some(motion) = self.motion.take() {
            self.mode = RobotMode::Idle;
            self.brake(motion.request.controller);
        }
    }

    /// Takes the robot out of a reflex.
    ///
    /// # Errors
    ///
    /// [`Refusal::NotPossible`] in a motion.
    pub fn recover(&mut self) -> Result<(), Refusal> {
        if self.mode == RobotMode::Move {
            return Err(Refusal::NotPossible);
        }
        self.mode = RobotMode::Idle;
        self.errors = ErrorFlags::default();
        Ok(())
    }

    /// Takes a setting.
    ///
    /// # Errors
    ///
    /// [`Refusal::NotPossible`] in a motion.
    pub fn set(&mut self, setting: Setting) -> Result<(), Refusal> {
        if self.mode == RobotMode::Move {
            return Err(Refusal::NotPossible);
        }
        let frame = |pose: &[f64; 16]| pose_of(pose).ok_or(Refusal::InvalidArgument);
        match setting {
            Setting::Collision(thresholds) => self.thresholds = *thresholds,
            Setting::JointStiffness(stiffness) => self.joint_stiffness = stiffness,
            Setting::CartesianStiffness(stiffness) => self.cartesian_stiffness = stiffness,
            Setting::GuidingMode | Setting::Filters(_) => {}
            Setting::StiffnessFrame(pose) => self.frames.end_effector_from_stiffness = frame(&pose)?,
            Setting::EndEffector(pose) => {
                self.frames.nominal_from_end_effector = frame(&pose)?;
                self.desired.pose = self.end_effector_at_desired();
            }
            Setting::Load(load) => self.carry(load),
        }
        Ok(())
    }

    fn carry(&mut self, load: Payload) {
        self.frames.load = load;
        self.arm = self.bare.clone().with_payload(&load);
        self.terms = ControlTerms::at(&self.arm, &self.frame.q, &self.frame.qd);
        // The observer goes on; what the load changes shows and passes within its delay.
    }

    /// One period: the torque by this command (or by its absence) acts, then the sensors are read. In a motion that has not
    /// been commanded yet the arm is held. Returns how the motion ended, if it did.
    pub fn cycle(&mut self, command: Option<&CyclicCommand>) -> Option<MoveEnd> {
        let before = self.torque_nm;
        let end = self.decide(command);
        if self.motion.is_none() || !self.is_commanded() {
            self.hold();
            self.commanded_nm = SVector::zeros();
        } else {
            self.commanded_nm = self.torque_nm;
        }
        let limit = &self.arm.limits.tau_max_nm;
        self.torque_nm = SVector::from_fn(|j, _| self.torque_nm[j].clamp(-limit[j], limit[j]));
        if !self.torque_nm.iter().all(|torque| torque.is_finite()) {
            self.torque_nm = before;
        }
        let torque_before = self.frame.tau;
        self.plant.actuate(&(self.torque_nm + self.terms.gravity_nm));
        // Of a plant that is lost, what was last seen stays.
        self.frame = self.plant.sense().unwrap_or(self.frame);
        self.terms = ControlTerms::at(&self.arm, &self.frame.q, &self.frame.qd);
        self.external.step(&self.frame, &link_side(&self.terms, &self.arm), PERIOD_S);
        self.torque_rate_nm_s = (self.frame.tau - torque_before) / PERIOD_S;
        end.or_else(|| self.watch())
    }

    /// The torque of a running motion by this command.
    fn decide(&mut self, command: Option<&CyclicCommand>) -> Option<MoveEnd> {
        let first = !self.is_commanded();
        let motion = self.motion.as_mut()?;
        motion.note(command);
        self.success_rate = motion.success_rate();
        let motion = *motion;
        if motion.is_deserted() {
            return Some(self.reflex(RobotError::CommunicationConstraintsViolation));
        }
        let lost = command.is_none();
        // Without a command the last torque stays, and the motion goes on as it was.
        let command = command.or(motion.last.as_ref())?;
        let generator = Generator {
            mode: motion.request.generator,
            arm: &self.bare,
            frames: &self.frames,
            limits: &self.limits,
            first,
        };
        let desired =
            if lost { Ok(generator.extrapolate(&self.desired)) } else { generator.follow(&self.desired, command) };
        match desired {
            Ok(desired) => self.desired = desired,
            Err(error) => return Some(self.reflex(error)),
        }
        match motion.request.controller {
            ControllerMode::External => {
                if Motion::torque_jumps(&self.commanded_nm.into(), command, self.limits.torque_rate_nm_s) {
                    return Some(self.reflex(RobotError::ControllerTorqueDiscontinuity));
                }
                self.torque_nm = SVector::from(command.torque_nm);
            }
            ControllerMode::JointImpedance => {
                self.torque_nm = joint_impedance(&self.joint_stiffness, &self.frame, &self.terms, &self.desired);
            }
            ControllerMode::CartesianImpedance => {
                let end_effector = self.terms.base_from_flange * self.frames.flange_from_end_effector();
                let (stiffness, desired) = (&self.cartesian_stiffness, &self.desired);
                self.torque_nm = cartesian_impedance(stiffness, &self.frame, &self.terms, &end_effector, desired);
            }
        }
        if command.finished && !lost {
            self.motion = None;
            self.mode = RobotMode::Idle;
            self.brake(motion.request.controller);
            return Some(MoveEnd::Finished);
        }
        None
    }

    /// Holds the arm. While it is being stopped, what is held slows down: `q̇_d ← q̇_d (1 − dt/T)`, tracked with the unit's full
    /// stiffness, so that no load moves the arm away meanwhile.
    fn hold(&mut self) {
        if self.stopping > 0 {
            self.stopping -= 1;
            let slowed =
                if self.stopping > 0 { self.desired.qd * (1.0 - PERIOD_S / STOPPING_S) } else { SVector::zeros() };
            let qdd = (slowed - self.desired.qd) / PERIOD_S;
            let (lower, upper) = (&self.arm.limits.q_min_rad, &self.arm.limits.q_max_rad);
            let q = (self.desired.q + slowed * PERIOD_S).sup(lower).inf(upper);
            self.desired = Desired { qd: slowed, qdd, ..Desired::rest(q, self.desired.pose) };
            self.desired.pose = self.end_effector_at_desired();
        }
        self.torque_nm = joint_impedance(&JOINT_STIFFNESS, &self.frame, &self.terms, &self.desired);
    }

    /// Begins to stop the arm, from where it is and as fast as it is; where the unit itself has led it, from where it was led.
    fn brake(&mut self, led_by: ControllerMode) {
        self.stopping = STOPPING_PERIODS;
        if led_by == ControllerMode::External {
            self.desired = Desired { qd: self.frame.qd, ..Desired::rest(self.frame.q, self.desired.pose) };
        }
    }

    fn reflex(&mut self, error: RobotError) -> MoveEnd {
        self.motion = None;
        self.mode = RobotMode::Reflex;
        self.errors = self.errors.and(ErrorFlags::of(error));
        self.reflex_reason = self.errors;
        // Whatever was asked for is no longer trusted.
        self.brake(ControllerMode::External);
        MoveEnd::Reflex
    }

    /// What the sensors say against the motion.
    fn watch(&mut self) -> Option<MoveEnd> {
        let torque = self.external.torque_nm();
        let [_, wrench] = self.external.wrench_at(&self.terms.base_from_flange, &self.stiffness_frame());
        let accelerating = self.desired.qdd.amax() > 1.0;
        self.touch = self.thresholds.touch(&torque, &wrench, accelerating);
        if self.mode != RobotMode::Move {
            return None;
        }
        let (frame, limits) = (&self.frame, &self.arm.limits);
        let too_fast = |j: usize| frame.qd[j].abs() > self.limits.qd_rad_s[j] + SPEED_MARGIN_RAD_S;
        let too_much = |j: usize| frame.tau[j].abs() > limits.tau_max_nm[j];
        let error = if self.arm.first_joint_outside_limits(&frame.q).is_some() {
            RobotError::JointPositionLimitsViolation
        } else if (0..7).any(too_fast) {
            RobotError::JointVelocityViolation
        } else if (0..7).any(too_much) {
            RobotError::TauJRangeViolation
        } else if self.touch.joint_collision.contains(&true) {
            RobotError::JointReflex
        } else if self.touch.cartesian_collision.contains(&true) {
            RobotError::CartesianReflex
        } else {
            return None;
        };
        Some(self.reflex(error))
    }

    fn end_effector_at_desired(&self) -> Pose {
        Kinematics::at(&self.bare, &self.desired.q).base_from_flange() * self.frames.flange_from_end_effector()
    }

    fn stiffness_frame(&self) -> Pose {
        self.terms.base_from_flange * self.frames.flange_from_stiffness()
    }

    /// The state now, under this number.
    pub fn state(&self, message_id: u64) -> RobotState {
        let frame = &self.frame;
        let [wrench_base, wrench_stiffness_frame] =
            self.external.wrench_at(&self.terms.base_from_flange, &self.stiffness_frame());
        RobotState {
            message_id,
            end_effector: self.terms.base_from_flange * self.frames.flange_from_end_effector(),
            end_effector_desired: self.desired.pose,
            flange_from_nominal: self.frames.flange_from_nominal,
            nominal_from_end_effector: self.frames.nominal_from_end_effector,
            end_effector_from_stiffness: self.frames.end_effector_from_stiffness,
            load_kg: self.frames.load.mass_kg,
            load_inertia_kg_m2: self.frames.load.inertia_kg_m2,
            load_com_m: self.frames.load.com_m,
            torque_nm: frame.tau,
            torque_desired_nm: self.commanded_nm,
            torque_rate_nm_s: self.torque_rate_nm_s,
            q_rad: frame.q,
            q_desired_rad: self.desired.q,
            qd_rad_s: frame.qd,
            qd_desired_rad_s: self.desired.qd,
            qdd_desired_rad_s2: self.desired.qdd,
            joint_contact: self.touch.joint_contact,
            cartesian_contact: self.touch.cartesian_contact,
            joint_collision: self.touch.joint_collision,
            cartesian_collision: self.touch.cartesian_collision,
            external_torque_nm: self.external.torque_nm(),
            wrench_base,
            wrench_stiffness_frame,
            twist_desired: self.desired.twist,
            acceleration_desired: self.desired.acceleration,
            gravity_m_s2: self.bare.gravity_m_s2,
            motor_rad: frame.theta.unwrap_or(frame.q),
            generator: self.motion.map(|motion| motion.request.generator),
            controller: self.motion.map(|motion| motion.request.controller),
            errors: self.errors,
            reflex_reason: self.reflex_reason,
            mode: self.mode,
            command_success_rate: if self.motion.is_some() { self.success_rate } else { 0.0 },
        }
    }
}

/// The same terms without the rotors, which the torque sensor does not feel.
fn link_side(terms: &ControlTerms<7>, arm: &Arm<7>) -> ControlTerms<7> {
    let mut terms = *terms;
    for j in 0..7 {
        terms.mass_matrix[(j, j)] -= arm.rotor_inertia_kg_m2[j];
    }
    terms
}
