//! Compensators that are too strong, with and without the guard that withdraws them.

use nalgebra::{SVector, Vector3};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use tribo_campaign::{Phases, TuneConfig, noise_seed};
use tribo_control::GuardTrip;
use tribo_ekf::WrenchEkf;
use tribo_friction::VelocitySource;
use tribo_model::FieldError;
use tribo_runtime::TickRecord;
use tribo_trial::Trial;
use tribo_trial::scenario::TruthName;

use super::ExperimentError;

/// Deviation from the path, faster than 1 Hz, that one sees (m): half a millimetre more than stick-slip without compensation.
const VISIBLE_M: f64 = 2e-3;
/// Motion of the elbow while the tool stays where it should be that one sees (rad), norm over the joints.
const VISIBLE_RAD: f64 = 0.2;

/// Settings of the experiment, `schema: tribo.reproduce/1`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct OverCompensation {
    /// `tribo.reproduce/1`.
    pub schema: String,
    /// Seeds 1 to this one: sensor noise and phases of the reference.
    pub seeds: u64,
    /// What the arm is like; each moves, and holds its pose.
    pub truths: Vec<TruthName>,
    /// Velocities that the compensator believes.
    pub velocities: Vec<VelocitySource>,
    /// Null-space dampings Dn [1/s].
    pub nullspace_damping_per_s: Vec<f64>,
    /// Compensation over true friction [-].
    pub scales: Vec<f64>,
}

/// One situation at one scale: the worst of all seeds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScaleRow {
    /// What the arm is like.
    pub truth: TruthName,
    /// Velocity that the compensator believes.
    pub velocity: VelocitySource,
    /// Whether the tool follows the reference; else it holds its pose.
    pub moving: bool,
    /// Null-space damping Dn [1/s].
    pub nullspace_damping_per_s: f64,
    /// Compensation over true friction [-].
    pub scale: f64,
    /// Seeds in which the guard tripped.
    pub trips: usize,
    /// Why, in the first of them.
    pub reason: Option<GuardTrip>,
    /// Seeds in which one would have seen it without the guard: oscillation, a sliding elbow or a fault.
    pub visible: usize,
    /// Least time from trip to sight (s), over the seeds in which one would have seen it; negative if the guard was late.
    pub lead_s: Option<f64>,
    /// Largest deviation from the path faster than 1 Hz, without and with the guard (m).
    pub deviation_m: [f64; 2],
    /// Largest motion of the elbow, without and with the guard (rad).
    pub elbow_rad: [f64; 2],
}

/// What was seen of one run.
#[derive(Clone, Copy, Debug, Default)]
struct Course {
    trip: Option<(GuardTrip, f64)>,
    visible_s: Option<f64>,
    deviation_m: f64,
    elbow_rad: f64,
}

impl OverCompensation {
    /// Checks every field.
    ///
    /// # Errors
    /// The first out of its range.
    pub fn validate(&self) -> Result<(), FieldError> {
        if self.schema != "tribo.reproduce/1" {
            return Err(FieldError::new("schema", &self.schema, "tribo.reproduce/1"));
        }
        FieldError::check("seeds", self.seeds as f64, 1.0, 10_000.0)?;
        if let Some(file) = self.truths.iter().find_map(TruthName::path) {
            return Err(FieldError::new("truths", file.display(), "the names of frictions that Tribo knows"));
        }
        for damping in &self.nullspace_damping_per_s {
            FieldError::check("nullspace_damping_per_s", *damping, 0.0, 500.0)?;
        }
        self.scales.iter().try_for_each(|scale| FieldError::check("scales", *scale, 0.0, 10.0))
    }

    /// Number of trials.
    pub fn trials(&self) -> usize {
        2 * self.situations().len() * self.scales.len() * self.seeds as usize
    }

    fn situations(&self) -> Vec<(&TruthName, VelocitySource, bool, f64)> {
        let mut all = Vec::new();
        for truth in &self.truths {
            for &velocity in &self.velocities {
                for moving in [true, false] {
                    all.extend(self.nullspace_damping_per_s.iter().map(|&damping| (truth, velocity, moving, damping)));
                }
            }
        }
        all
    }

    /// Runs everything on the threads of the current rayon pool; `done` is told of each trial.
    ///
    /// # Errors
    /// Settings that no trial can be made of.
    pub fn run(&self, done: impl Fn() + Sync) -> Result<Vec<ScaleRow>, ExperimentError> {
        let at_every_scale = |(truth, velocity, moving, damping)| {
            let row = ScaleRow {
                truth: TruthName::clone(truth),
                velocity,
                moving,
                nullspace_damping_per_s: damping,
                scale: 0.0,
                trips: 0,
                reason: None,
                visible: 0,
                lead_s: None,
                deviation_m: [0.0; 2],
                elbow_rad: [0.0; 2],
            };
            self.scales.iter().map(move |&scale| ScaleRow { scale, ..row.clone() })
        };
        let rows: Vec<ScaleRow> = self.situations().into_iter().flat_map(at_every_scale).collect();
        rows.into_par_iter().map(|row| self.watch(row, &done)).collect()
    }

    fn watch(&self, mut row: ScaleRow, done: &impl Fn()) -> Result<ScaleRow, ExperimentError> {
        for seed in 1..=self.seeds {
            let mut trial = trial_of(&row, seed)?;
            let [free, guarded] = [None, trial.guard].map(|guard| {
                trial.guard = guard;
                let course = course(&trial, row.scale, seed);
                done();
                course
            });
            row.trips += usize::from(guarded.trip.is_some());
            row.reason = row.reason.or(guarded.trip.map(|trip| trip.0));
            row.visible += usize::from(free.visible_s.is_some());
            if let Some(visible_s) = free.visible_s {
                let lead_s = guarded.trip.map_or(f64::NEG_INFINITY, |trip| visible_s - trip.1);
                row.lead_s = Some(row.lead_s.map_or(lead_s, |least: f64| least.min(lead_s)));
            }
            for (k, course) in [free, guarded].iter().enumerate() {
                row.deviation_m[k] = row.deviation_m[k].max(course.deviation_m);
                row.elbow_rad[k] = row.elbow_rad[k].max(course.elbow_rad);
            }
        }
        Ok(row)
    }
}

fn trial_of(row: &ScaleRow, seed: u64) -> Result<Trial<7>, ExperimentError> {
    let mut config = TuneConfig {
        seed,
        truth: row.truth.clone(),
        velocity: row.velocity,
        phases: Phases::Random,
        ..TuneConfig::default()
    };
    config.impedance.nullspace_damping_per_s = row.nullspace_damping_per_s;
    let trial = config.validate::<7>()?.trial;
    Ok(if row.moving { trial } else { trial.holding() })
}

/// The trial to its end or to the first fault, whatever its limits say.
fn course(trial: &Trial<7>, scale: f64, seed: u64) -> Course {
    let mut plant = trial.plant(noise_seed(seed, 0));
    let friction = trial.truth.friction.scaled(scale);
    let mut control = trial.control_loop(&friction, WrenchEkf::new(TuneConfig::default().ekf));
    let mut course = Course::default();
    let mut sight = Sight::default();
    for _ in 0..(trial.reference.total_s() / trial.dt_s).round() as u64 {
        let record = control.tick(&mut plant);
        let now_s = record.frame.time_s;
        sight.look(record, trial.dt_s);
        course.deviation_m = course.deviation_m.max(sight.deviation_m());
        course.elbow_rad = course.elbow_rad.max(sight.elbow.norm());
        course.trip = course.trip.or(record.guard.map(|trip| (trip, now_s)));
        let seen = sight.deviation_m() > VISIBLE_M || sight.elbow.norm() > VISIBLE_RAD || record.fault.is_some();
        course.visible_s = course.visible_s.or(seen.then_some(now_s));
        if record.fault.is_some() {
            break;
        }
    }
    course
}

/// What somebody sees who stands beside the arm.
#[derive(Default)]
struct Sight {
    /// Position error of the tool, and its part slower than 1 Hz (m).
    error: Vector3<f64>,
    slow: Option<Vector3<f64>>,
    /// How far the arm has gone without moving the tool (rad).
    elbow: SVector<f64, 7>,
}

impl Sight {
    fn look(&mut self, record: &TickRecord<7>, dt_s: f64) {
        if record.fault.is_some() {
            return;
        }
        self.error = record.task.error.fixed_rows::<3>(3).into_owned();
        let slow = self.slow.get_or_insert(self.error);
        *slow += (self.error - *slow) * (2.0 * std::f64::consts::PI * dt_s);
        self.elbow += record.task.nullspace_qd * dt_s;
    }

    fn deviation_m(&self) -> f64 {
        self.slow.map_or(0.0, |slow| (self.error - slow).norm())
    }
}
