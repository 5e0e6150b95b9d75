//! Force from joints whose friction is a band (linderoth2013, section IV): a static arm, and two arms that hold one thing.

use nalgebra::{SVector, Vector6};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};
use tribo_control::SinusoidReference;
use tribo_ekf::WrenchEkfSettings;
use tribo_friction::law::CoulombViscous;
use tribo_friction::{FrictionBand, FrictionModel};
use tribo_residual::{
    BandObserver, BandOf, BoxOutcome, ForceEstimate, ForceProblem, ForceSolver, diagonal_prior, identify_band,
    stack_opposed,
};
use tribo_robot::{ControlTerms, EstimatorInput, Kinematics, LAMBDA_95, Wrench};
use tribo_sim::{Pulse, Truth, WrenchPulses};

use super::{ExperimentError, Quantity, SeedRun};
use crate::files::FieldError;
use crate::{AnyEstimator, EstimatorName, Phases, Trial, TuneConfig, noise_seed, run_trial_observed, simulate_log};

/// Gain of the momentum observer, to which a band belongs (rad/s).
const GAIN_RAD_S: f64 = 50.0;
/// Ticks between two estimates: 250 Hz, as the paper's samples.
const DECIMATION: u64 = 4;
/// Standard deviations that stand for no prior: force (N), moment (Nm).
const NO_PRIOR: [f64; 2] = [1e3, 1e2];
/// Names of the components in file order.
const AXES: [&str; 6] = ["Fx", "Fy", "Fz", "Mx", "My", "Mz"];

/// Settings of the experiment, `schema: tribo.reproduce/1`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Linderoth2013 {
    /// `tribo.reproduce/1`.
    pub schema: String,
    /// Seeds 1 to this one: pushes, phases, sensor noise.
    pub seeds: u64,
    /// Prior of a point contact: force (N).
    pub point_force_sd_n: f64,
    /// Prior of a point contact: moment (Nm).
    pub point_moment_sd_nm: f64,
    /// Prior of the assembly: force (N).
    pub task_force_sd_n: f64,
    /// Prior of the assembly: moment (Nm).
    pub task_moment_sd_nm: f64,
    /// Forces of the pushes, largest (N).
    pub push_n: f64,
    /// Moments of the pushes in the assembly, largest (Nm).
    pub push_nm: f64,
}

/// What one arm shows at one instant.
type Moment = (ForceProblem<7, 6>, Vector6<f64>);

impl Linderoth2013 {
    /// Checks every field.
    ///
    /// # Errors
    /// The first field outside its range.
    pub fn validate(&self) -> Result<(), FieldError> {
        if self.schema != "tribo.reproduce/1" {
            return Err(FieldError::new("schema", &self.schema, "tribo.reproduce/1"));
        }
        FieldError::check("seeds", self.seeds as f64, 1.0, 10_000.0)?;
        FieldError::check("point_force_sd_n", self.point_force_sd_n, 0.1, 1e3)?;
        FieldError::check("point_moment_sd_nm", self.point_moment_sd_nm, 1e-3, 1e2)?;
        FieldError::check("task_force_sd_n", self.task_force_sd_n, 0.1, 1e3)?;
        FieldError::check("task_moment_sd_nm", self.task_moment_sd_nm, 1e-3, 1e2)?;
        FieldError::check("push_n", self.push_n, 0.1, 100.0)?;
        FieldError::check("push_nm", self.push_nm, 0.0, 20.0)
    }

    /// What is measured, in the order of the values.
    pub fn quantities(&self) -> Vec<Quantity> {
        let mut all = Vec::new();
        for prior in ["with prior", "without prior"] {
            all.extend(
                AXES[..3].iter().map(|axis| Quantity::new(format!("static arm, {prior}: MAE {axis}"), "N", None)),
            );
        }
        for part in ["whole", "in contact"] {
            for arms in ["static arm", "moving arm", "both arms"] {
                let named = |what: &str, unit: &str| Quantity::new(format!("{part}, {arms}: {what}"), unit, None);
                all.push(named("coverage, forces", "%"));
                all.push(named("coverage, moments", "%"));
                all.push(named("MAE, forces", "N"));
                all.push(named("MAE, moments", "Nm"));
                all.push(named("half-width, forces", "N"));
            }
        }
        all
    }

    /// Measures it for one seed: same seed, same bits.
    ///
    /// # Errors
    /// A band that cannot be identified.
    pub fn run(&self, seed: u64) -> Result<(SeedRun, ()), ExperimentError> {
        let band = identified_band(seed)?;
        let mut values = Vec::new();
        let point = pushes(seed, 0, self.push_n, 0.0);
        let static_arm = moments(seed, false, &point, 1.0, &band)?;
        for [force_n, moment_nm] in [[self.point_force_sd_n, self.point_moment_sd_nm], NO_PRIOR] {
            let mut solver = ForceSolver::new(diagonal_prior(force_n, moment_nm));
            let mut score = Score::default();
            for (problem, truth) in &static_arm {
                score.add(&mut solver, problem, truth)?;
            }
            values.extend((3..6).map(|i| score.mean_absolute(i)));
        }
        let task = pushes(seed, 1, self.push_n, self.push_nm);
        let still = moments(seed, false, &task, 1.0, &band)?;
        let moving = moments(seed, true, &task, -1.0, &band)?;
        let prior = diagonal_prior(self.task_force_sd_n, self.task_moment_sd_nm);
        // F is the wrench of the static arm on the thing; the moving arm answers it.
        let (mut one, mut other, mut both) =
            (ForceSolver::<7, 6>::new(prior), ForceSolver::<7, 6>::new(prior), ForceSolver::<14, 6>::new(prior));
        let mut scores = [[Score::default(); 3]; 2];
        for ((a, truth), (b, _)) in still.iter().zip(&moving) {
            let opposed = ForceProblem { jacobian: -b.jacobian, ..*b };
            let parts = if *truth == Vector6::zeros() { 0..1 } else { 0..2 };
            let judged = [
                Judged::of(&mut one, a, truth)?,
                Judged::of(&mut other, &opposed, truth)?,
                Judged::of(&mut both, &stack_opposed::<7, 7, 14>(a, b), truth)?,
            ];
            for part in parts {
                scores[part].iter_mut().zip(&judged).for_each(|(score, judged)| score.take(judged));
            }
        }
        for score in scores.iter().flatten() {
            let mean = |value: &dyn Fn(usize) -> f64, axes: std::ops::Range<usize>| axes.map(value).sum::<f64>() / 3.0;
            values.push(100.0 * mean(&|i| score.coverage(i), 3..6));
            values.push(100.0 * mean(&|i| score.coverage(i), 0..3));
            values.push(mean(&|i| score.mean_absolute(i), 3..6));
            values.push(mean(&|i| score.mean_absolute(i), 0..3));
            values.push(mean(&|i| score.half_width(i), 3..6));
        }
        Ok((SeedRun { seed, values }, ()))
    }
}

/// Estimate and limits of one instant against the truth, `[moment; force]`.
struct Judged {
    error: Vector6<f64>,
    inside: [bool; 6],
    half_width: Vector6<f64>,
}

impl Judged {
    fn of<const N: usize>(
        solver: &mut ForceSolver<N, 6>,
        problem: &ForceProblem<N, 6>,
        truth: &Vector6<f64>,
    ) -> Result<Self, ExperimentError> {
        let unsolved = |outcome: BoxOutcome| ExperimentError::Unsolved { joints: N, outcome };
        let estimate: ForceEstimate<N, 6> = solver.estimate(problem).map_err(unsolved)?;
        let (mut inside, mut half_width) = ([false; 6], Vector6::zeros());
        for axis in 0..6 {
            let v = Vector6::from_fn(|r, _| f64::from(u8::from(r == axis)));
            let above = solver.limit(&v, LAMBDA_95).map_err(unsolved)?.value;
            let below = -solver.limit(&-v, LAMBDA_95).map_err(unsolved)?.value;
            inside[axis] = below <= truth[axis] && truth[axis] <= above;
            half_width[axis] = 0.5 * (above - below);
        }
        Ok(Self { error: estimate.force - truth, inside, half_width })
    }
}

/// Sums over instants, `[moment; force]`.
#[derive(Clone, Copy, Default)]
struct Score {
    absolute: [f64; 6],
    inside: [f64; 6],
    width: [f64; 6],
    count: f64,
}

impl Score {
    fn add<const N: usize>(
        &mut self,
        solver: &mut ForceSolver<N, 6>,
        problem: &ForceProblem<N, 6>,
        truth: &Vector6<f64>,
    ) -> Result<(), ExperimentError> {
        self.take(&Judged::of(solver, problem, truth)?);
        Ok(())
    }

    fn take(&mut self, judged: &Judged) {
        self.count += 1.0;
        for i in 0..6 {
            self.absolute[i] += judged.error[i].abs();
            self.inside[i] += f64::from(u8::from(judged.inside[i]));
            self.width[i] += judged.half_width[i];
        }
    }

    fn mean_absolute(&self, i: usize) -> f64 {
        self.absolute[i] / self.count
    }

    fn coverage(&self, i: usize) -> f64 {
        self.inside[i] / self.count
    }

    fn half_width(&self, i: usize) -> f64 {
        self.width[i] / self.count
    }
}

/// Pushes in random directions: a second and a half each, a second and a half apart.
fn pushes(seed: u64, stream: u64, force_n: f64, moment_nm: f64) -> WrenchPulses {
    let mut rng = Pcg64::seed_from_u64(noise_seed(seed, 50 + stream));
    let mut vector = |largest: f64| {
        let direction = nalgebra::Vector3::from_fn(|_, _| rng.random_range(-1.0..1.0));
        let size = rng.random_range(0.3..1.0) * largest;
        if direction.norm() > 0.0 { direction.normalize() * size } else { direction }
    };
    let pulses = (0..9).map(|k| {
        let start_s = 5.0 + 3.0 * f64::from(k);
        let wrench_base = Wrench { force_n: vector(force_n), moment_nm: vector(moment_nm) };
        Pulse { wrench_base, start_s, end_s: start_s + 1.5, ramp_s: 0.1 }
    });
    WrenchPulses { pulses: pulses.collect() }
}

/// A trial of an arm with friction that nobody compensates.
fn trial(seed: u64, moving: bool, pulses: WrenchPulses) -> Result<Trial<7>, ExperimentError> {
    let config = TuneConfig { seed, phases: Phases::Random, ..TuneConfig::default() };
    let mut trial = config.validate()?.trial;
    trial.truth = Truth::panda_coulomb_viscous();
    trial.pulses = pulses;
    if !moving {
        trial.reference = SinusoidReference::fixed(Kinematics::at(&trial.model, &trial.start).base_from_flange());
    }
    Ok(trial)
}

/// Friction of a controller that believes there is none.
fn none() -> FrictionModel<7> {
    FrictionModel::uniform(CoulombViscous::default().into())
}

/// The band of each joint from a motion that nobody touches (section II-C, automated).
fn identified_band(seed: u64) -> Result<FrictionBand<7>, ExperimentError> {
    let trial = trial(seed, true, WrenchPulses::default())?;
    let estimator =
        AnyEstimator::for_tuning(EstimatorName::Momentum, WrenchEkfSettings::default(), &trial.model, &none())?;
    let (_, log) = simulate_log(&trial, &none(), estimator, noise_seed(seed, 9)).map_err(ExperimentError::Log)?;
    let fits = identify_band(&log, &trial.model, GAIN_RAD_S).map_err(ExperimentError::Band)?;
    Ok(FrictionBand::new(fits.map(|fit| fit.band)).map_err(|error| ExperimentError::Band(error.into()))?)
}

/// What one arm shows along its trial, with the true wrench of the static arm, `[moment; force]`; `side` is the sign of this
/// arm's share in it.
fn moments(
    seed: u64,
    moving: bool,
    pushes: &WrenchPulses,
    side: f64,
    band: &FrictionBand<7>,
) -> Result<Vec<Moment>, ExperimentError> {
    let mut own = pushes.clone();
    for pulse in &mut own.pulses {
        pulse.wrench_base.force_n *= side;
        pulse.wrench_base.moment_nm *= side;
    }
    let trial = trial(seed, moving, own)?;
    let estimator =
        AnyEstimator::for_tuning(EstimatorName::Momentum, WrenchEkfSettings::default(), &trial.model, &none())?;
    let mut observer = BandObserver::new(*band, BandOf::Friction, GAIN_RAD_S);
    let (nothing, no_command) = (SVector::zeros(), Vector6::zeros());
    let (mut sent, mut tick, mut found) = (None, 0u64, Vec::new());
    let noise = noise_seed(seed, 10 + u64::from(moving));
    run_trial_observed(&trial, &none(), estimator, noise, |record, _| {
        let frame = &record.frame;
        let terms = ControlTerms::at(&trial.model, &frame.q, &frame.qd);
        match sent {
            None => observer.start(frame, &terms),
            Some(tau_motor) => observer.step(&EstimatorInput {
                frame,
                terms: &terms,
                tau_motor: &tau_motor,
                tau_friction: &nothing,
                acceleration_command: &no_command,
                dt_s: trial.dt_s,
            }),
        }
        sent = Some(record.command);
        if frame.time_s >= trial.reference.pre_roll_s() && tick % DECIMATION == 0 {
            found.push((observer.problem(), pushes.at(frame.time_s - trial.dt_s).to_vector()));
        }
        tick += 1;
    });
    Ok(found)
}
