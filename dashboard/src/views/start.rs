//! A campaign to be started.

use std::path::{Path, PathBuf};

use egui::{ComboBox, Grid, RichText, Ui};
use serde::de::DeserializeOwned;
use tribo_campaign::TuneConfig;

use crate::source::Source;

/// Choices as they are spelt in files, each with a word of explanation.
type Choices = &'static [(&'static str, &'static str)];

const ROBOTS: Choices = &[
    ("panda", "Franka Emika Panda, 7 joints"),
    ("fr3", "Franka Research 3, 7 joints"),
    ("ur3e", "Universal Robots UR3e, 6 joints"),
    ("ur5e", "Universal Robots UR5e, 6 joints"),
    ("ur10e", "Universal Robots UR10e, 6 joints"),
    ("xarm6", "UFACTORY xArm 6, 6 joints"),
    ("xarm7", "UFACTORY xArm 7, 7 joints"),
    ("kinova_gen3", "Kinova Gen3, 7 joints"),
    ("iiwa14", "KUKA LBR iiwa 14, 7 joints"),
];
const STRATEGIES: Choices = &[
    ("grey_box", "least squares on past logs, then local search"),
    ("bo", "Bayesian optimisation grown from zero compensation"),
    ("paper", "the route of roveda2022"),
    ("composite", "Bayesian optimisation of the parts of the cost"),
    ("cma_es", "covariance matrix adaptation"),
    ("iterative_learning", "the fixed-gain baseline of roveda2022"),
    ("random", "baseline: uniform random search"),
    ("sobol", "baseline: Sobol sequence"),
    ("gaz", "baseline: constants published by Gaz et al. 2019"),
    ("zero", "baseline: no compensation"),
];
const LAWS: Choices = &[("coulomb_viscous", "two parameters per joint"), ("stribeck", "five parameters per joint")];
const TRUTHS: Choices = &[
    ("coulomb_viscous", "Coulomb and viscous friction"),
    ("stribeck", "more friction at low speed"),
    ("lugre", "bristles with presliding"),
    ("soft", "a physics engine: joints creep where they should stick"),
    ("gaz", "the sigmoid of Gaz et al. 2019"),
    ("thermal", "friction that fades as the robot warms up"),
    ("frictionless", "no friction"),
];
const ESTIMATORS: Choices = &[
    ("ekf", "augmented-state Kalman filter"),
    ("momentum", "generalised-momentum observer"),
    ("qp", "friction-band programme"),
    ("thermal", "thermal virtual sensor"),
    ("double_encoder", "two encoders per joint"),
];
const VELOCITIES: Choices = &[
    ("hybrid", "measured above its noise, else the reference's"),
    ("measured", "measured, as in the paper"),
    ("reference", "of the reference model"),
];

/// Endings of robot descriptions.
const DESCRIPTIONS: [&str; 3] = ["urdf", "xml", "mjcf"];
/// Endings of model files.
const MODEL_FILES: [&str; 2] = ["yaml", "yml"];

/// The form.
#[derive(Debug)]
pub struct StartView {
    robot: &'static str,
    robot_file: String,
    strategy: &'static str,
    law: &'static str,
    truth: &'static str,
    estimator: &'static str,
    velocity: &'static str,
    trials: usize,
    seed: u64,
    pose: usize,
    directory: String,
    campaigns: PathBuf,
}

impl StartView {
    /// A form with the defaults of `tribo tune`; new campaigns go below `campaigns`.
    pub fn new(campaigns: &Path) -> Self {
        let defaults = TuneConfig::default();
        Self {
            robot: ROBOTS[0].0,
            robot_file: String::new(),
            strategy: STRATEGIES[0].0,
            law: LAWS[0].0,
            truth: TRUTHS[0].0,
            estimator: ESTIMATORS[0].0,
            velocity: VELOCITIES[0].0,
            trials: defaults.trials,
            seed: defaults.seed,
            pose: defaults.pose,
            directory: next_directory(campaigns),
            campaigns: campaigns.to_owned(),
        }
    }

    /// The form; true once a campaign has been started.
    pub fn ui(&mut self, ui: &mut Ui, source: &mut Source) -> bool {
        ui.add_space(16.0);
        let mut started = false;
        ui.vertical_centered(|ui| {
            ui.set_max_width(640.0);
            ui.heading("Tune the friction compensator of a simulated arm");
            ui.add_space(4.0);
            ui.label("Every trial is 33 s of a 1 kHz loop, simulated in a fraction of a second. What the estimator reports in free motion is friction that was not compensated: its cost is J.");
            ui.add_space(12.0);
            ui.group(|ui| {
                Grid::new("campaign").num_columns(2).spacing([16.0, 8.0]).show(ui, |ui| {
                    choose(ui, "Robot", &mut self.robot, ROBOTS);
                    let label = ui.label("Or a robot file");
                    let hint = "URDF, MJCF or model file; it can be dropped here";
                    let path = egui::TextEdit::singleline(&mut self.robot_file).hint_text(hint).desired_width(472.0);
                    ui.add(path).labelled_by(label.id);
                    ui.end_row();
                    choose(ui, "Friction law", &mut self.law, LAWS);
                    choose(ui, "Estimator", &mut self.estimator, ESTIMATORS);
                    choose(ui, "Strategy", &mut self.strategy, STRATEGIES);
                    choose(ui, "Simulated friction", &mut self.truth, TRUTHS);
                    choose(ui, "Velocity", &mut self.velocity, VELOCITIES);
                    number(ui, "Trials", &mut self.trials, 1..=10_000);
                    number(ui, "Pose", &mut self.pose, 0..=2);
                    number(ui, "Seed", &mut self.seed, 0..=u64::MAX);
                    let label = ui.label("Directory");
                    ui.add(egui::TextEdit::singleline(&mut self.directory).desired_width(472.0)).labelled_by(label.id);
                    ui.end_row();
                });
            });
            ui.add_space(12.0);
            if ui.button(RichText::new("Start").size(16.0)).clicked() {
                match self.config() {
                    Ok(config) => {
                        source.start(config, Path::new(self.directory.trim()));
                        self.directory = next_directory(&self.campaigns);
                        started = true;
                    }
                    Err(error) => source.message = error,
                }
            }
            ui.add_space(12.0);
            ui.weak("Or give a campaign directory or a robot log above; a campaign that another process runs is followed live.");
        });
        started
    }

    /// Whether a file that is dropped on the window is a robot; the form then shows it.
    pub fn takes(&mut self, path: &str) -> bool {
        let is_robot = ends_in(path, &DESCRIPTIONS) || ends_in(path, &MODEL_FILES);
        if is_robot {
            path.clone_into(&mut self.robot_file);
        }
        is_robot
    }

    fn config(&self) -> Result<TuneConfig, String> {
        let file = self.robot_file.trim();
        // A model file says which robot it is, and its friction is what is simulated.
        let is_model = ends_in(file, &MODEL_FILES);
        let robot = if file.is_empty() { self.robot } else { file };
        Ok(TuneConfig {
            robot: (!is_model).then(|| robot.to_owned()),
            strategy: named(self.strategy)?,
            friction: named(self.law)?,
            residual: named(self.estimator)?,
            velocity: named(self.velocity)?,
            truth: named(if is_model { file } else { self.truth })?,
            trials: self.trials,
            seed: self.seed,
            pose: self.pose,
            ..TuneConfig::default()
        })
    }
}

fn ends_in(path: &str, endings: &[&str]) -> bool {
    let ending = Path::new(path).extension().unwrap_or_default();
    endings.iter().any(|one| ending.eq_ignore_ascii_case(one))
}

fn named<T: DeserializeOwned>(name: &str) -> Result<T, String> {
    serde_json::from_value(serde_json::Value::String(name.to_owned())).map_err(|error| format!("{name}: {error}"))
}

fn choose(ui: &mut Ui, label: &str, chosen: &mut &'static str, choices: Choices) {
    let label = ui.label(label);
    let text = |name: &str| {
        choices.iter().find(|choice| choice.0 == name).map_or(String::new(), |(name, why)| format!("{name}: {why}"))
    };
    let combo = ComboBox::from_id_salt(label.id).width(480.0).selected_text(text(chosen)).show_ui(ui, |ui| {
        for (name, _) in choices {
            ui.selectable_value(chosen, name, text(name));
        }
    });
    combo.response.labelled_by(label.id);
    ui.end_row();
}

fn number<N: egui::emath::Numeric>(ui: &mut Ui, label: &str, value: &mut N, range: std::ops::RangeInclusive<N>) {
    let label = ui.label(label);
    ui.add(egui::DragValue::new(value).range(range).speed(0.2)).labelled_by(label.id);
    ui.end_row();
}

/// The next free `campaigns/NNNN`, as `tribo tune` counts.
fn next_directory(campaigns: &Path) -> String {
    let entries = std::fs::read_dir(campaigns).into_iter().flatten().flatten();
    let last = entries.filter_map(|entry| entry.file_name().to_str()?.parse::<u32>().ok()).max();
    campaigns.join(format!("{:04}", last.map_or(1, |last| last + 1))).display().to_string()
}

#[cfg(test)]
mod tests {
    use tribo_campaign::strategy::StrategyName;
    use tribo_trial::EstimatorName;

    use super::*;

    /// What is offered exists, and what exists is offered.
    #[test]
    fn the_form_knows_every_name() {
        let strategies: Vec<StrategyName> =
            STRATEGIES.iter().map(|(name, _)| named(name).expect("a strategy")).collect();
        for name in
            ["zero", "gaz", "random", "sobol", "paper", "bo", "composite", "cma_es", "iterative_learning", "grey_box"]
        {
            assert!(strategies.contains(&named(name).expect("a strategy")), "{name}");
        }
        let estimators: Vec<&str> = ESTIMATORS.iter().map(|(name, _)| *name).collect();
        assert_eq!(estimators, EstimatorName::ALL.map(EstimatorName::as_str));
        assert_eq!(ROBOTS.iter().map(|(name, _)| *name).collect::<Vec<_>>(), tribo_robot::presets::NAMES);
        for (name, _) in TRUTHS {
            let _: tribo_trial::scenario::TruthName = named(name).expect("a truth");
        }
    }
}
