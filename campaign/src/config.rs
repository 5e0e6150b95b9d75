//! Settings of a campaign: as written, and as validated.

use std::path::{Path, PathBuf};

use nalgebra::SVector;
use serde::{Deserialize, Serialize};
use tribo_bayesopt::StopRule;
use tribo_control::{GuardSettings, ImpedanceSettings, PAPER_PHASES_RAD, SinusoidReference};
use tribo_ekf::{KnownInput, MeasurementNoise, WrenchEkfSettings};
use tribo_friction::{JointEffects, JointFriction, VelocitySource};
use tribo_model::{ConfigError, ControllerModel, FieldError, ModelFile, POSES, Robot, joints_of_preset};
use tribo_robot::Kinematics;
use tribo_robot::presets::joint_stiffness_nm_per_rad;
use tribo_sim::{DEFAULT_SUB_STEPS, TorqueSide, WrenchPulses};
use tribo_trial::scenario::{LoadedTruth, ModelError, TruthName, freeze, random_phases};
use tribo_trial::{CostMeasure, CostName, EstimatorName, PenaltyLimits, Trial};

use crate::strategy_name::StrategyName;
use crate::{Batches, Bounds, ParameterSpace, StopBelow, TunedLaw, UserTrials};

/// Schema name of campaign settings.
const SCHEMA: &str = "tribo.tune/1";

/// How many trials a campaign may have.
pub(crate) const TRIALS: std::ops::RangeInclusive<usize> = 1..=10_000;

/// Phases of the reference trajectory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Phases {
    /// The fixed phases of all documented tables.
    #[default]
    Documented,
    /// Drawn from the campaign's seed.
    Random,
}

/// Settings of `tribo tune`, every field with its default. Frozen within a campaign.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TuneConfig {
    /// `tribo.tune/1`.
    pub schema: String,
    /// Version of Tribo that wrote the file; empty in files written by hand.
    pub tribo_version: String,
    /// The arm: a preset or the path of a URDF or MJCF; none is that of `model`, else that of the file of `truth`, else the Panda.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub robot: Option<String>,
    /// Link or body of such a file at which the arm begins; none is its root, or where the first joint is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub base_link: Option<String>,
    /// Link, body or site of such a file whose frame is the flange; none is the only end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tip_link: Option<String>,
    /// What a robot that is no preset is like, as it was when the campaign began.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub robot_content: Option<ModelFile>,
    /// Seed of everything random.
    pub seed: u64,
    /// What chooses the next parameters.
    pub strategy: StrategyName,
    /// Friction law of the compensator.
    pub friction: TunedLaw,
    /// Whether `grey_box` may go over from Coulomb-viscous friction to the Stribeck law where the logs speak for it; none is yes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub change_law: Option<bool>,
    /// Parameter box; none is what [`Bounds::default_of`] says of the strategy.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bounds: Option<Bounds>,
    /// Estimator whose wrench is the cost.
    pub residual: EstimatorName,
    /// What is made of that wrench.
    pub cost: CostName,
    /// Distance at which a force makes a moment (m), for the robust cost. The default weighs the EKF's noise of both alike.
    pub lever_arm_m: f64,
    /// Velocity the compensator believes near zero.
    pub velocity: VelocitySource,
    /// Number of trials.
    pub trials: usize,
    /// Trials of the initial design, where the strategy has one.
    pub init: usize,
    /// Trials that are chosen together and run side by side, as on so many robots (batch size q).
    pub batch: usize,
    /// Ends the campaign before its last trial, once another one promises less than this; none is what [`StopBelow::default_of`] says of
    /// the strategy. For strategies that know what a trial promises.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stop_below: Option<StopBelow>,
    /// What the simulated arm is like: a name, or the path of a model file. Of a robot elsewhere nobody knows.
    #[serde(default = "TruthName::unknown", skip_serializing_if = "TruthName::is_unknown")]
    pub truth: TruthName,
    /// Content of the file that `truth` names, as it was when the campaign began.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub truth_content: Option<ModelFile>,
    /// Model file that the controller believes in: its arm, and its effects on top of the tuned law; none is the
    /// bare arm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model: Option<PathBuf>,
    /// Content of the file that `model` names, as it was when the campaign began.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model_content: Option<ModelFile>,
    /// What the controller's model gets wrong.
    pub model_error: ModelError,
    /// Share of the simulated trials that are stopped at a random moment, as people and safety controllers do.
    pub failure_rate: f64,
    /// Configuration about which the tool moves: 0, 1, 2.
    pub pose: usize,
    /// Phases of the reference.
    pub phases: Phases,
    /// Factor on the lengths of the tool's path, 25 mm to either side; none is what [`Robot::path_times_panda`] says, or 1 in a campaign of
    /// an earlier version that does not say.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path_scale: Option<f64>,
    /// Plant sub-steps per control period.
    pub sub_steps: usize,
    /// Gains.
    pub impedance: ImpedanceSettings,
    /// Estimator noise.
    pub ekf: WrenchEkfSettings,
    /// What keeps the compensator from shaking the arm, or from being tried at all; `null` trusts every parameter set.
    pub guard: Option<GuardSettings>,
    /// Limits that end a trial, those of the tool's acceleration and position error times `path_scale` where that is above 1.
    pub limits: PenaltyLimits,
    /// What trials are like that the user runs (`ask` and `tell`); none where Tribo runs them on the simulated arm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub user_trials: Option<UserTrials>,
}

impl Default for TuneConfig {
    fn default() -> Self {
        Self {
            schema: SCHEMA.to_owned(),
            tribo_version: String::new(),
            robot: None,
            base_link: None,
            tip_link: None,
            robot_content: None,
            seed: 1,
            strategy: StrategyName::GreyBox,
            friction: TunedLaw::CoulombViscous,
            change_law: None,
            bounds: None,
            residual: EstimatorName::Ekf,
            cost: CostName::Paper,
            lever_arm_m: 0.15,
            velocity: VelocitySource::Hybrid,
            // The paper's budget: 10 random trials and 40 chosen ones.
            trials: 50,
            init: 10,
            batch: 1,
            stop_below: None,
            truth: TruthName::CoulombViscous,
            truth_content: None,
            model: None,
            model_content: None,
            model_error: ModelError::default(),
            failure_rate: 0.0,
            pose: 0,
            phases: Phases::Documented,
            path_scale: None,
            sub_steps: DEFAULT_SUB_STEPS,
            impedance: ImpedanceSettings::default(),
            ekf: WrenchEkfSettings::default(),
            guard: Some(GuardSettings::default()),
            limits: PenaltyLimits::default(),
            user_trials: None,
        }
    }
}

/// Trials of a campaign on one's own robot that nobody gave a number: one without compensation, three of least squares and one beyond
/// settle nearly all that `grey_box` finds, and a robot's time is dear.
const TRIALS_OF_OWN_ROBOT: usize = 5;

impl TuneConfig {
    /// The defaults of a campaign on a robot that is not simulated: its friction is not known.
    pub fn of_own_robot() -> Self {
        Self { truth: TruthName::Unknown, ..Self::default() }
    }

    /// Puts the number of trials that is enough on one's own robot in place of the default; strategies other than `grey_box` keep theirs.
    pub fn take_own_robot_trials(&mut self) {
        if self.strategy == StrategyName::GreyBox {
            self.trials = TRIALS_OF_OWN_ROBOT;
        }
    }
}

/// Validated settings with everything they refer to.
#[derive(Clone, Debug)]
pub struct ValidTune<const N: usize> {
    /// The settings, resolved.
    pub config: TuneConfig,
    /// The parameters that are tuned.
    pub space: ParameterSpace,
    /// How many times a Panda's friction each joint is taken to have, before anything is known of it.
    pub friction_scale: [f64; N],
    /// The trial that is repeated.
    pub trial: Trial<N>,
    /// What an oracle believes of the truth.
    pub oracle: ControllerModel<N>,
    /// What the controller believes, where a model file says it; its friction law is not in the trial.
    pub controller_model: Option<ControllerModel<N>>,
}

impl<const N: usize> ValidTune<N> {
    /// The same with the law that `grey_box` may go over to; none where it may not, or has nowhere to go.
    pub(crate) fn with_richer_law(&self) -> Option<Self> {
        let may = self.config.change_law.unwrap_or(true) && self.space.law == TunedLaw::CoulombViscous;
        may.then(|| {
            let mut richer = self.clone();
            richer.change_law(TunedLaw::Stribeck);
            richer
        })
    }

    /// Goes over to another law.
    pub(crate) fn change_law(&mut self, law: TunedLaw) {
        (self.config.friction, self.space.law) = (law, law);
    }

    /// Goes over to another law, in which the parameters that were tried are what they were.
    pub(crate) fn change_law_of<'a>(&mut self, tried: impl Iterator<Item = &'a mut Vec<f64>>, law: TunedLaw) {
        let before = self.space.clone();
        self.change_law(law);
        for theta in tried {
            *theta = self.space.embedded(&before, theta);
        }
    }

    /// The parameters of the simulated arm's own friction; none where its law has others, or a user runs the trials.
    pub fn true_parameters(&self) -> Option<Vec<f64>> {
        let same = |law: &JointFriction| {
            matches!(law, JointFriction::CoulombViscous(_) | JointFriction::Stribeck(_) | JointFriction::Lugre(_))
        };
        let known = self.config.user_trials.is_none() && self.space.law != TunedLaw::GazSigmoid;
        let friction = &self.oracle.friction;
        (known && friction.joints.iter().all(same)).then(|| self.space.unbounded(friction))
    }
}

/// Validated settings about an arm with as many joints as it happens to have.
#[derive(Clone, Debug)]
#[allow(clippy::large_enum_variant, reason = "both are large, and few exist")]
pub enum AnyTune {
    /// Of an arm with six joints.
    Six(ValidTune<6>),
    /// Of an arm with seven joints.
    Seven(ValidTune<7>),
}

impl TuneConfig {
    /// Reads the files that the settings name into them, settles which robot is meant, and says how many joints it has.
    ///
    /// # Errors
    /// A file that cannot be used, or files about robots with different numbers of joints.
    pub fn load(&mut self) -> Result<usize, ConfigError> {
        if self.truth.is_unknown() && self.user_trials.is_none() {
            self.truth = TruthName::CoulombViscous;
        }
        freeze(self.truth.path(), &mut self.truth_content)?;
        freeze(self.model.as_ref(), &mut self.model_content)?;
        let file = self.robot_file()?;
        let joints = file.arm_joints()?;
        for (field, content) in [("model", &self.model_content), ("truth", &self.truth_content)] {
            let other = content.as_ref().map_or(Ok(joints), ModelFile::arm_joints)?;
            if other != joints {
                let allowed = format!("a model of a robot with {joints} joints, as {} has", file.robot);
                return Err(FieldError::new(field, format!("about a robot with {other} joints"), allowed).into());
            }
        }
        self.robot_content = joints_of_preset(&file.robot).is_none().then(|| file.robot_alone());
        self.robot = Some(file.robot);
        Ok(joints)
    }

    /// What says which robot it is.
    fn robot_file(&self) -> Result<ModelFile, ConfigError> {
        let named = |file: &&ModelFile| self.robot.as_ref().is_none_or(|robot| *robot == file.robot);
        let frozen = self.robot_content.as_ref().filter(named);
        let files = [frozen, self.model_content.as_ref(), self.truth_content.as_ref()];
        if let Some(file) = files.into_iter().flatten().find(named) {
            for (field, own, held) in
                [("base_link", &self.base_link, &file.base_link), ("tip_link", &self.tip_link, &file.tip_link)]
            {
                if let Some(own) = own.as_ref().filter(|own| held.as_ref() != Some(own)) {
                    let allowed = "what the model file says, or nothing: a model file has its own";
                    return Err(FieldError::new(field, own, allowed).into());
                }
            }
            return Ok(file.clone());
        }
        let mut file = ModelFile::bare(self.robot.as_deref().unwrap_or("panda"), TorqueSide::Motor, &[]);
        file.base_link.clone_from(&self.base_link);
        file.tip_link.clone_from(&self.tip_link);
        file.resolve(Path::new(""))?;
        Ok(file)
    }

    /// Checks every field against its range and loads the truth, for an arm with as many joints as it has.
    ///
    /// # Errors
    /// Those of [`Self::validate`].
    pub fn validate_any(mut self) -> Result<AnyTune, ConfigError> {
        Ok(match self.load()? {
            6 => AnyTune::Six(self.validate()?),
            _ => AnyTune::Seven(self.validate()?),
        })
    }

    /// The robot; of a preset nothing but the preset counts, whatever the model makes of it.
    fn valid_robot<const N: usize>(&mut self) -> Result<Robot<N>, ConfigError> {
        let joints = self.load()?;
        let name = self.robot.as_deref().unwrap_or_default();
        if let Some(content) = &self.robot_content {
            return Ok(content.validate::<N>().map_err(|error| error.within("robot_content"))?.robot);
        }
        let wrong =
            || FieldError::new("robot", format!("{name} with {joints} joints"), format!("a robot with {N} joints"));
        Ok(Robot::preset(name).ok_or_else(wrong)?)
    }

    /// The pose about which the tool moves (rad): of the file of the truth or of the model that gives poses, else the robot's own.
    #[inline(never)]
    fn start<const N: usize>(&self, robot: &Robot<N>) -> Result<SVector<f64, N>, ConfigError> {
        let files = [("truth_content", &self.truth_content), ("model_content", &self.model_content)];
        let mut given = files.into_iter().filter_map(|(field, file)| Some((field, file.as_ref()?)));
        let poses_rad = match given.find(|(_, file)| file.poses_rad.is_some()) {
            Some((field, file)) => file.validate::<N>().map_err(|error| error.within(field))?.robot.poses_rad,
            None => robot.poses_rad,
        };
        let start = poses_rad[self.pose];
        match robot.arm.first_joint_outside_limits(&start) {
            None => Ok(start),
            Some(j) => {
                let limits = &robot.arm.limits;
                let allowed = format!("a pose within {} to {} in joint {j}", limits.q_min_rad[j], limits.q_max_rad[j]);
                Err(FieldError::new("pose", format!("{} with joint {j} at {}", self.pose, start[j]), allowed).into())
            }
        }
    }

    /// Checks the rule that ends the campaign early against its range and the strategy.
    pub(crate) fn check_stop_below(&self) -> Result<(), FieldError> {
        if let Some(StopBelow::Share(share)) = self.stop_below
            && !(share > 0.0 && share <= 0.5)
        {
            return Err(FieldError::new("stop_below", share, "greater than 0, at most 0.5"));
        }
        if let Some(stop) = self.stop_below.filter(|stop| *stop != StopBelow::Never && !self.strategy.expects_gain()) {
            let allowed = "never with this strategy: grey_box, paper, bo and composite know what a trial promises";
            return Err(FieldError::new("stop_below", stop, allowed));
        }
        Ok(())
    }

    /// The rule by which the campaign ends before its last trial; none of one that runs all.
    pub fn stop_rule(&self) -> Option<StopRule> {
        self.stop_below.unwrap_or_else(|| StopBelow::default_of(self.strategy)).rule(self.strategy)
    }

    /// Which trials are chosen together.
    pub fn batches(&self) -> Batches {
        Batches { size: self.batch }
    }

    /// Checks every field against its range and loads the truth; the robot must have N joints.
    ///
    /// # Errors
    /// The first field out of its range, or the file that cannot be used.
    #[inline(never)]
    pub fn validate<const N: usize>(mut self) -> Result<ValidTune<N>, ConfigError> {
        if self.schema != SCHEMA {
            return Err(FieldError::new("schema", &self.schema, SCHEMA).into());
        }
        let count = |field: &str, value: usize, low: usize, high: usize| {
            if (low..=high).contains(&value) {
                Ok(())
            } else {
                Err(FieldError::new(field, value, format!("{low} to {high}")))
            }
        };
        count("trials", self.trials, *TRIALS.start(), *TRIALS.end())?;
        count("init", self.init, 1, 1000)?;
        count("batch", self.batch, 1, 1000)?;
        count("sub_steps", self.sub_steps, 1, 1000)?;
        count("pose", self.pose, 0, POSES - 1)?;
        let positive = |field: &str, value: f64, high: f64| {
            if value > 0.0 && value <= high {
                Ok(())
            } else {
                Err(FieldError::new(field, value, format!("greater than 0, at most {high}")))
            }
        };
        FieldError::check("model_error.payload_kg", self.model_error.payload_kg, 0.0, 20.0)?;
        FieldError::check("model_error.link_mass_error", self.model_error.link_mass_error, 0.0, 0.5)?;
        FieldError::check("model_error.noise_factor", self.model_error.noise_factor, 0.0, 1000.0)?;
        positive("lever_arm_m", self.lever_arm_m, 10.0)?;
        FieldError::check("failure_rate", self.failure_rate, 0.0, 0.9)?;
        self.check_stop_below()?;
        let i = &self.impedance;
        positive("impedance.mass_kg", i.mass_kg, 1e3)?;
        positive("impedance.inertia_kg_m2", i.inertia_kg_m2, 1e3)?;
        positive("impedance.stiffness_n_per_m", i.stiffness_n_per_m, 1e5)?;
        positive("impedance.stiffness_nm_per_rad", i.stiffness_nm_per_rad, 1e5)?;
        positive("impedance.damping_ratio", i.damping_ratio, 10.0)?;
        FieldError::check("impedance.nullspace_damping_per_s", i.nullspace_damping_per_s, 0.0, 500.0)?;
        FieldError::check("impedance.posture_stiffness_per_s2", i.posture_stiffness_per_s2, 0.0, 1e4)?;
        let e = &self.ekf;
        match e.measurement {
            MeasurementNoise::Diagonal { position_m, rotation_rad } => {
                positive("ekf.measurement.diagonal.position_m", position_m, 1.0)?;
                positive("ekf.measurement.diagonal.rotation_rad", rotation_rad, 1.0)?;
            }
            MeasurementNoise::Encoder { sd_rad } => positive("ekf.measurement.encoder.sd_rad", sd_rad, 1.0)?,
        }
        FieldError::check("ekf.acceleration_noise_m_s2", e.acceleration_noise_m_s2, 0.0, 1e3)?;
        FieldError::check("ekf.acceleration_noise_rad_s2", e.acceleration_noise_rad_s2, 0.0, 1e3)?;
        positive("ekf.force_walk_n", e.force_walk_n, 1e4)?;
        positive("ekf.moment_walk_nm", e.moment_walk_nm, 1e4)?;
        positive("ekf.initial_force_sd_n", e.initial_force_sd_n, 1e4)?;
        positive("ekf.initial_moment_sd_nm", e.initial_moment_sd_nm, 1e4)?;
        if let Some(path_scale) = self.path_scale {
            FieldError::check("path_scale", path_scale, 0.05, 20.0)?;
        }
        let l = &self.limits;
        positive("limits.acceleration_m_s2", l.acceleration_m_s2, 1e4)?;
        positive("limits.acceleration_rad_s2", l.acceleration_rad_s2, 1e4)?;
        positive("limits.error_m", l.error_m, 10.0)?;
        positive("limits.error_rad", l.error_rad, 4.0)?;
        positive("limits.nullspace_speed_rad_s", l.nullspace_speed_rad_s, 100.0)?;
        positive("limits.saturation_s", l.saturation_s, 100.0)?;
        positive("limits.acceleration_cutoff_hz", l.acceleration_cutoff_hz, 500.0)?;

        if let Some(g) = &self.guard {
            FieldError::check("guard.predicted_ratio", g.predicted_ratio, 0.0, 100.0)?;
            FieldError::check("guard.observed_ratio", g.observed_ratio, 1.0, 100.0)?;
            positive("guard.surplus_j", g.surplus_j, 100.0)?;
            positive("guard.oscillation_j", g.oscillation_j, 100.0)?;
            positive("guard.drift_rad", g.drift_rad, 10.0)?;
            positive("guard.swing_rad_s", g.swing_rad_s, 100.0)?;
            positive("guard.swings", g.swings, 1e4)?;
        }

        if let Some(user_trials) = &self.user_trials {
            user_trials.check()?;
            if self.batch > 1 {
                let allowed = "1 in campaigns whose trials run elsewhere: ask once for every robot";
                return Err(FieldError::new("batch", self.batch, allowed).into());
            }
            if self.ekf.known_input == KnownInput::CommandedAcceleration {
                let allowed = "applied_torque: logs do not hold the acceleration that was asked for";
                return Err(FieldError::new("ekf.known_input", "commanded_acceleration", allowed).into());
            }
        }

        let robot = self.valid_robot::<N>()?;
        if self.strategy == StrategyName::Gaz {
            if robot.arm.name != "panda" {
                let allowed = "another strategy: gaz holds the constants of one Panda";
                return Err(FieldError::new("strategy", "gaz", allowed).into());
            }
            self.friction = TunedLaw::GazSigmoid;
        }
        let LoadedTruth { truth, oracle } = self.truth.of(&robot, self.truth_content.as_ref())?;
        let truth = self.model_error.apply(truth, self.seed);
        let controller_model = match &self.model_content {
            Some(file) => {
                Some(ControllerModel::by_controller(&file.validate().map_err(|error| error.within("model_content"))?))
            }
            None => None,
        };
        let start = self.start(&robot)?;
        let friction_scale = robot.friction_times_panda();
        let bounds = self.bounds.unwrap_or_else(|| Bounds::default_of(self.strategy));
        let box_scale = bounds.scale(friction_scale, &robot.arm.limits.tau_max_nm);
        let path_times_panda = robot.path_times_panda();
        let model = robot.arm;
        let phase_rad = match self.phases {
            Phases::Documented => PAPER_PHASES_RAD,
            Phases::Random => random_phases(self.seed),
        };
        let of_arm = if self.tribo_version.is_empty() { path_times_panda } else { 1.0 };
        let path_scale = self.path_scale.unwrap_or(of_arm);
        // Settings of a Panda stay as short as they were.
        self.path_scale = (path_scale != 1.0).then_some(path_scale);
        let centre = Kinematics::at(&model, &start).base_from_flange();
        let trial = Trial {
            truth,
            sensors: self.model_error.sensors(),
            sub_steps: self.sub_steps,
            pulses: WrenchPulses::default(),
            gears_nm_per_rad: joint_stiffness_nm_per_rad(&model),
            model,
            effects: [JointEffects::default(); N],
            start,
            impedance: self.impedance,
            reference: SinusoidReference::paper(centre, phase_rad).scaled(path_scale),
            velocity: self.velocity,
            // What its bounds are in proportion to is the friction of the joints.
            guard: self.guard.map(|guard| guard.for_friction(friction_scale.iter().sum::<f64>() / N as f64)),
            limits: self.limits.for_path(path_scale),
            measure: match self.cost {
                CostName::Paper => CostMeasure::Paper,
                CostName::Robust => CostMeasure::Robust { lever_arm_m: self.lever_arm_m },
            },
            stopped_at_s: None,
            dt_s: 1e-3,
        };
        let trial = controller_model
            .as_ref()
            .map_or(trial.clone(), |controller_model| trial.with_controller_model(controller_model));
        let trial = if self.residual == EstimatorName::DoubleEncoder { trial.with_two_encoders() } else { trial };
        let space = ParameterSpace { law: self.friction, bounds, box_scale };
        self.tribo_version = env!("CARGO_PKG_VERSION").to_owned();
        Ok(ValidTune { config: self, space, friction_scale, trial, oracle, controller_model })
    }
}
