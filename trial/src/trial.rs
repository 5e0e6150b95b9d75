//! One trial: the loop on the simulated arm, judged.

use nalgebra::SVector;
use tribo_control::{GuardSettings, ImpedanceSettings, SinusoidReference};
use tribo_friction::{Compensator, FrictionModel, JointEffects, JointFriction, VelocitySource};
use tribo_model::ControllerModel;
use tribo_robot::presets::joint_stiffness_nm_per_rad;
use tribo_robot::{Arm, Plant, WrenchEstimator};
use tribo_runtime::{ControlLoop, LoopSettings, TickRecord};
use tribo_sim::{BoxFrictionPlant, Effect, Sensors, Truth, WrenchPulses};

use crate::{AbortReason, Cost, CostAccumulator, CostMeasure, PenaltyLimits, TrialLog, TrialMonitor};

/// Everything that defines a trial but the compensator's parameters and the noise.
#[derive(Clone, Debug)]
pub struct Trial<const N: usize> {
    /// What the plant obeys.
    pub truth: Truth<N>,
    /// What the controller sees of it.
    pub sensors: Sensors,
    /// Sub-steps of the plant per control period.
    pub sub_steps: usize,
    /// Who pushes the tool; nobody during tuning.
    pub pulses: WrenchPulses,
    /// The arm that the controller believes in.
    pub model: Arm<N>,
    /// Stiffness of its gears (Nm/rad) by the controller's belief: what two encoders read as torque.
    pub gears_nm_per_rad: [f64; N],
    /// Torques that the compensator believes in on top of the friction law of the trial.
    pub effects: [JointEffects; N],
    /// Configuration at the start (rad).
    pub start: SVector<f64, N>,
    /// Gains.
    pub impedance: ImpedanceSettings,
    /// Trajectory.
    pub reference: SinusoidReference,
    /// Velocity the compensator believes.
    pub velocity: VelocitySource,
    /// What watches the compensator; none trusts it.
    pub guard: Option<GuardSettings>,
    /// Limits that end a trial.
    pub limits: PenaltyLimits,
    /// What it is judged by.
    pub measure: CostMeasure,
    /// When somebody stops it, in time of the judged part (s).
    pub stopped_at_s: Option<f64>,
    /// Control period (s).
    pub dt_s: f64,
}

/// Result of a trial.
#[derive(Clone, Debug, PartialEq)]
pub struct TrialOutcome<const N: usize> {
    /// The cost and its parts.
    pub cost: Cost,
    /// Why the trial was stopped, if it was.
    pub aborted: Option<AbortReason>,
    /// Time of the violation since the start of the judged part (s) (negative in the pre-roll).
    pub aborted_at_s: Option<f64>,
    /// The decimated log.
    pub log: TrialLog<N>,
}

/// Damping of the springs in the joints (Nm s/rad): a few per cent of critical.
const JOINT_DAMPING_NM_S_PER_RAD: f64 = 10.0;
/// Ticks between two samples of the trial log.
const LOG_DECIMATION: u64 = 10;

impl<const N: usize> Trial<N> {
    /// The same trial with the tool held where it starts.
    pub fn holding(mut self) -> Self {
        self.reference = SinusoidReference::fixed(self.reference.centre);
        self
    }

    /// The same trial with springs in the joints of the arm and an encoder on either side of them.
    #[inline(never)]
    pub fn with_two_encoders(mut self) -> Self {
        // Springs of the truth's own stay what they are.
        let own: Vec<Effect> = self
            .truth
            .effects
            .iter()
            .filter(|effect| matches!(effect, Effect::JointElasticity { .. }))
            .cloned()
            .collect();
        let stiffness = joint_stiffness_nm_per_rad(&self.truth.arm);
        self.truth = self.truth.with_elastic_joints(stiffness, JOINT_DAMPING_NM_S_PER_RAD);
        self.truth.effects.extend(own);
        self.sensors = self.sensors.with_motor_encoders();
        self
    }

    /// The simulated arm at the start of the trial; `seed` feeds the sensor noise.
    #[inline(never)]
    pub fn plant(&self, seed: u64) -> BoxFrictionPlant<N> {
        BoxFrictionPlant::new(self.truth.clone(), self.sensors, self.start, seed)
            .with_sub_steps(self.sub_steps)
            .with_period(self.dt_s)
            .with_pulses(self.pulses.clone())
    }

    /// The loop of the trial, whose compensator believes this friction. One that compensates nothing needs no guard.
    #[inline(never)]
    pub fn control_loop<E: WrenchEstimator<N>>(&self, friction: &FrictionModel<N>, estimator: E) -> ControlLoop<N, E> {
        let settings = LoopSettings {
            impedance: self.impedance,
            reference: self.reference,
            compensator: Compensator::new(*friction, self.velocity).with_effects(self.effects),
            guard: self.guard.filter(|_| self.compensates(friction)),
            dt_s: self.dt_s,
        };
        ControlLoop::new(self.model.clone(), self.start, settings, estimator)
    }

    /// Whether a compensator that believes this friction sends any torque.
    fn compensates(&self, friction: &FrictionModel<N>) -> bool {
        let acts = |law: &JointFriction| [-1.0, -0.01, 0.01, 1.0].iter().any(|qd| law.torque(*qd, 0.0) != 0.0);
        self.effects != [JointEffects::default(); N] || friction.joints.iter().any(acts)
    }

    /// The same trial with a controller that believes in another arm and other effects.
    pub fn with_controller_model(mut self, controller_model: &ControllerModel<N>) -> Self {
        self.model = controller_model.arm.clone();
        self.gears_nm_per_rad = controller_model.joint_stiffness_nm_per_rad();
        self.effects = controller_model.effects;
        self
    }
}

/// Runs one trial with the friction that the compensator believes; `seed` feeds the sensor noise.
pub fn run_trial<const N: usize, E: WrenchEstimator<N>>(
    trial: &Trial<N>,
    friction: &FrictionModel<N>,
    estimator: E,
    seed: u64,
) -> TrialOutcome<N> {
    run_trial_observed(trial, friction, estimator, seed, |_, _| {})
}

/// The same, showing every tick (and the plant, truth included) to `observe`.
pub fn run_trial_observed<const N: usize, E: WrenchEstimator<N>>(
    trial: &Trial<N>,
    friction: &FrictionModel<N>,
    estimator: E,
    seed: u64,
    observe: impl FnMut(&TickRecord<N>, &BoxFrictionPlant<N>),
) -> TrialOutcome<N> {
    run_trial_on(&mut trial.plant(seed), trial, friction, estimator, observe)
}

/// The same on any robot, which stands at the start of the trial; of the trial's own arm nothing is used.
pub fn run_trial_on<const N: usize, P: Plant<N>, E: WrenchEstimator<N>>(
    plant: &mut P,
    trial: &Trial<N>,
    friction: &FrictionModel<N>,
    estimator: E,
    mut observe: impl FnMut(&TickRecord<N>, &P),
) -> TrialOutcome<N> {
    let mut control = trial.control_loop(friction, estimator);
    let mut monitor = TrialMonitor::new(trial.limits, trial.dt_s);
    let mut accumulator = CostAccumulator::new(trial.measure);
    let ticks = (trial.reference.total_s() / trial.dt_s).round() as u64;
    let judged_from = (trial.reference.pre_roll_s() / trial.dt_s).round() as u64;
    let mut log = TrialLog::with_capacity((ticks / LOG_DECIMATION + 1) as usize, trial.dt_s * LOG_DECIMATION as f64);
    let mut violation = None;

    for tick in 0..ticks {
        let record = control.tick(plant);
        observe(record, plant);
        let time_s = (tick as f64 - judged_from as f64) * trial.dt_s;
        let stopped = trial.stopped_at_s.is_some_and(|at_s| time_s >= at_s).then_some(AbortReason::Stopped);
        if let Some(reason) = monitor.check(record).or(stopped) {
            violation = Some((reason, time_s));
            break;
        }
        if tick >= judged_from {
            accumulator.add(&record.estimate.wrench_base);
        }
        if tick % LOG_DECIMATION == 0 {
            log.push(time_s, record);
        }
    }

    TrialOutcome {
        cost: accumulator.finish(violation.map(|(_, at)| at), trial.reference.duration_s),
        aborted: violation.map(|(reason, _)| reason),
        aborted_at_s: violation.map(|(_, at)| at),
        log,
    }
}
