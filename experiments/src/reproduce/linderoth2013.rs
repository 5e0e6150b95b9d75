//! Force from joints whose friction is a band (linderoth2013, section IV): a static arm, and two arms that hold one thing.

use nalgebra::{SVector, Vector6};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};
use tribo_campaign::{Phases, TuneConfig, noise_seed};
use tribo_ekf::WrenchEkfSettings;
use tribo_friction::{FrictionBand, FrictionModel};
use tribo_model::FieldError;
use tribo_residual::{
    BandObserver, BandOf, BoxOutcome, ForceEstimate, ForceProblem, ForceSolver, OBSERVER_GAIN_RAD_S, diagonal_prior,
    identify_band, stack_opposed,
};
use tribo_robot::{ControlTerms, EstimatorInput, LAMBDA_95, Wrench};
use tribo_sim::{Pulse, Truth, WrenchPulses};
use tribo_trial::{AnyEstimator, EstimatorName, Trial, run_trial_observed, simulate_log};

use super::{ExperimentError, Quantity, SeedRun};

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

/// What one arm shows at one instant, and the true wrench of the static arm, `[moment; force]`.
struct Instant {
    time_s: f64,
    problem: ForceProblem<7, 6>,
    truth: Vector6<f64>,
}

/// Force along the assembly (N), base axes, one row per estimate.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AssemblyTrace {
    /// Time since the start of the judged part (s).
    pub time_s: Vec<f64>,
    /// True force of the static arm on the thing.
    pub truth_n: Vec<[f64; 3]>,
    /// Estimate, lower and upper end of the 95 % band, from the static arm, the moving arm and both.
    pub bands_n: [Vec<[[f64; 3]; 3]>; 3],
}

impl AssemblyTrace {
    fn push(&mut self, time_s: f64, truth: &Vector6<f64>, judged: &[Judged; 3]) {
        let force = |wrench: &Vector6<f64>| [wrench[3], wrench[4], wrench[5]];
        self.time_s.push(time_s);
        self.truth_n.push(force(truth));
        for (band, judged) in self.bands_n.iter_mut().zip(judged) {
            band.push([&judged.estimate, &judged.lower, &judged.upper].map(force));
        }
    }
}

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

    /// Measures it for one seed: same seed, same bits. With it the forces of the assembly, for figures.
    ///
    /// # Errors
    /// A band that cannot be identified.
    pub fn run(&self, seed: u64) -> Result<(SeedRun, AssemblyTrace), ExperimentError> {
        let band = identified_band(seed)?;
        let mut values = Vec::new();
        let point = pushes(seed, 0, self.push_n, 0.0);
        let static_arm = instants(seed, false, &point, 1.0, &band)?;
        for [force_n, moment_nm] in [[self.point_force_sd_n, self.point_moment_sd_nm], NO_PRIOR] {
            let mut solver = ForceSolver::new(diagonal_prior(force_n, moment_nm));
            let mut score = Score::default();
            for Instant { problem, truth, .. } in &static_arm {
                score.take(&Judged::of(&mut solver, problem)?, truth);
            }
            values.extend((3..6).map(|i| score.mean_absolute(i)));
        }
        let task = pushes(seed, 1, self.push_n, self.push_nm);
        let still = instants(seed, false, &task, 1.0, &band)?;
        let moving = instants(seed, true, &task, -1.0, &band)?;
        let prior = diagonal_prior(self.task_force_sd_n, self.task_moment_sd_nm);
        // F is the wrench of the static arm on the thing; the moving arm answers it.
        let (mut one, mut other, mut both) =
            (ForceSolver::<7, 6>::new(prior), ForceSolver::<7, 6>::new(prior), ForceSolver::<14, 6>::new(prior));
        let (mut scores, mut trace) = ([[Score::default(); 3]; 2], AssemblyTrace::default());
        for (Instant { time_s, problem: a, truth }, Instant { problem: b, .. }) in still.iter().zip(&moving) {
            let opposed = ForceProblem { jacobian: -b.jacobian, ..*b };
            let parts = if *truth == Vector6::zeros() { 0..1 } else { 0..2 };
            let judged = [
                Judged::of(&mut one, a)?,
                Judged::of(&mut other, &opposed)?,
                Judged::of(&mut both, &stack_opposed::<7, 7, 14>(a, b))?,
            ];
            for part in parts {
                scores[part].iter_mut().zip(&judged).for_each(|(score, judged)| score.take(judged, truth));
            }
            trace.push(*time_s, truth, &judged);
        }
        for score in scores.iter().flatten() {
            let mean = |value: &dyn Fn(usize) -> f64, axes: std::ops::Range<usize>| axes.map(value).sum::<f64>() / 3.0;
            values.push(100.0 * mean(&|i| score.coverage(i), 3..6));
            values.push(100.0 * mean(&|i| score.coverage(i), 0..3));
            values.push(mean(&|i| score.mean_absolute(i), 3..6));
            values.push(mean(&|i| score.mean_absolute(i), 0..3));
            values.push(mean(&|i| score.half_width(i), 3..6));
        }
        Ok((SeedRun { seed, values }, trace))
    }
}

/// Estimate and 95 % limits of one instant, `[moment; force]`.
struct Judged {
    estimate: Vector6<f64>,
    lower: Vector6<f64>,
    upper: Vector6<f64>,
}

impl Judged {
    fn of<const N: usize>(
        solver: &mut ForceSolver<N, 6>,
        problem: &ForceProblem<N, 6>,
    ) -> Result<Self, ExperimentError> {
        let unsolved = |outcome: BoxOutcome| ExperimentError::Unsolved { joints: N, outcome };
        let estimate: ForceEstimate<N, 6> = solver.estimate(problem).map_err(unsolved)?;
        let (mut lower, mut upper) = (Vector6::zeros(), Vector6::zeros());
        for axis in 0..6 {
            let v = Vector6::from_fn(|r, _| f64::from(u8::from(r == axis)));
            upper[axis] = solver.limit(&v, LAMBDA_95).map_err(unsolved)?.value;
            lower[axis] = -solver.limit(&-v, LAMBDA_95).map_err(unsolved)?.value;
        }
        Ok(Self { estimate: estimate.force, lower, upper })
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
    fn take(&mut self, judged: &Judged, truth: &Vector6<f64>) {
        let Judged { estimate, lower, upper } = judged;
        self.count += 1.0;
        for i in 0..6 {
            self.absolute[i] += (estimate[i] - truth[i]).abs();
            self.inside[i] += f64::from(u8::from(lower[i] <= truth[i] && truth[i] <= upper[i]));
            self.width[i] += 0.5 * (upper[i] - lower[i]);
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
    let mut trial = config.validate::<7>()?.trial;
    trial.truth = Truth::panda_coulomb_viscous();
    trial.pulses = pulses;
    Ok(if moving { trial } else { trial.holding() })
}

/// The band of each joint from a motion that nobody touches (section II-C, automated).
fn identified_band(seed: u64) -> Result<FrictionBand<7>, ExperimentError> {
    let trial = trial(seed, true, WrenchPulses::default())?;
    let estimator = AnyEstimator::for_tuning(
        EstimatorName::Momentum,
        WrenchEkfSettings::default(),
        &trial,
        &FrictionModel::none(),
    )?;
    let (_, log) =
        simulate_log(&trial, &FrictionModel::none(), estimator, noise_seed(seed, 9)).map_err(ExperimentError::Log)?;
    let fits = identify_band(&log, &trial.model, OBSERVER_GAIN_RAD_S).map_err(ExperimentError::Band)?;
    FrictionBand::new(fits.map(|fit| fit.band)).map_err(|error| ExperimentError::Band(error.into()))
}

/// What one arm shows along its trial; `side` is the sign of this arm's share in the wrench of the static arm.
fn instants(
    seed: u64,
    moving: bool,
    pushes: &WrenchPulses,
    side: f64,
    band: &FrictionBand<7>,
) -> Result<Vec<Instant>, ExperimentError> {
    let mut own = pushes.clone();
    for pulse in &mut own.pulses {
        pulse.wrench_base.force_n *= side;
        pulse.wrench_base.moment_nm *= side;
    }
    let trial = trial(seed, moving, own)?;
    let estimator = AnyEstimator::for_tuning(
        EstimatorName::Momentum,
        WrenchEkfSettings::default(),
        &trial,
        &FrictionModel::none(),
    )?;
    let mut observer = BandObserver::new(*band, BandOf::Friction, OBSERVER_GAIN_RAD_S);
    let (nothing, no_command) = (SVector::zeros(), Vector6::zeros());
    let (mut sent, mut tick, mut found) = (None, 0u64, Vec::new());
    let noise = noise_seed(seed, 10 + u64::from(moving));
    run_trial_observed(&trial, &FrictionModel::none(), estimator, noise, |record, _| {
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
            let truth = pushes.at(frame.time_s - trial.dt_s).to_vector();
            let time_s = frame.time_s - trial.reference.pre_roll_s();
            found.push(Instant { time_s, problem: observer.problem(), truth });
        }
        tick += 1;
    });
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use tribo_model::YamlDocument;

    fn shipped() -> Linderoth2013 {
        YamlDocument::embedded("config.yaml", crate::reproduce::shipped::LINDEROTH2013).parse().unwrap()
    }

    /// One seed: the same bits twice, one value per quantity, and what the experiment is there to show.
    #[test]
    fn a_prior_and_a_second_arm_help() {
        let experiment = shipped();
        experiment.validate().unwrap();
        let (once, again) = rayon::join(|| experiment.run(3).unwrap(), || experiment.run(3).unwrap());
        assert!(once == again);
        assert_ne!(pushes(3, 1, 15.0, 0.5), pushes(4, 1, 15.0, 0.5));
        let (run, trace) = once;
        let quantities = experiment.quantities();
        assert_eq!(run.values.len(), quantities.len());
        let value = |name: &str| run.values[quantities.iter().position(|q| q.name == name).unwrap()];
        for axis in &AXES[..3] {
            let [with, without] = ["with", "without"].map(|p| value(&format!("static arm, {p} prior: MAE {axis}")));
            assert!(with < without, "{axis}: {with} {without}");
        }
        let [one, other, both] = ["static arm", "moving arm", "both arms"]
            .map(|arms| ["MAE", "half-width"].map(|what| value(&format!("in contact, {arms}: {what}, forces"))));
        assert!((0..2).all(|i| both[i] < one[i] && both[i] < other[i]), "{one:?} {other:?} {both:?}");

        // The trace is what was judged: its share inside the band is the coverage.
        let held = |k: usize, i: usize| {
            let ([_, lower, upper], truth) = (trace.bands_n[2][k], trace.truth_n[k]);
            f64::from(u8::from(lower[i] <= truth[i] && truth[i] <= upper[i]))
        };
        let count = trace.time_s.len();
        let share = (0..count).map(|k| (0..3).map(|i| held(k, i)).sum::<f64>()).sum::<f64>() / (3.0 * count as f64);
        assert!((100.0 * share - value("whole, both arms: coverage, forces")).abs() < 1e-9);
        assert!(trace.time_s[0] >= 0.0 && trace.time_s[count - 1] < 30.1);
    }

    #[test]
    fn settings_out_of_range_are_named() {
        let named = |experiment: Linderoth2013| experiment.validate().unwrap_err().to_string();
        let error = named(Linderoth2013 { point_moment_sd_nm: 0.0, ..shipped() });
        assert!(error.contains("point_moment_sd_nm"), "{error}");
        let error = named(Linderoth2013 { push_n: f64::NAN, ..shipped() });
        assert!(error.contains("push_n"), "{error}");
    }
}
