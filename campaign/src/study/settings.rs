//! The grid of a study.

use std::path::Path;

use serde::{Deserialize, Serialize};
use tribo_model::{ConfigError, FieldError, FileError, ModelFile, POSES, YamlDocument, file_name};
use tribo_trial::EstimatorName;
use tribo_trial::scenario::{TruthName, freeze};

use super::place::{Cell, Work};
use crate::strategy_name::StrategyName;
use crate::{Phases, StopBelow, TuneConfig, TunedLaw};

/// Schema name of studies.
const SCHEMA: &str = "tribo.study/1";

/// The most combinations of pose, case, strategy and estimator: each is tried before anything runs, in a tenth of a millisecond.
const MOST_KINDS: usize = 10_000;
/// The most cells, each a file.
const MOST_CELLS: u64 = 1_000_000;
/// The most entries of a list.
const LONGEST_LIST: usize = 1000;

/// Checks that every entry of a list is there once.
fn once<T: PartialEq>(field: &str, entries: &[T]) -> Result<(), FieldError> {
    if entries.len() > LONGEST_LIST {
        let allowed = format!("at most {LONGEST_LIST} entries");
        return Err(FieldError::new(field, format!("{} entries", entries.len()), allowed));
    }
    match (1..entries.len()).find(|&k| entries[..k].contains(&entries[k])) {
        Some(k) => Err(FieldError::new(format!("{field}[{k}]"), "there twice", "once")),
        None => Ok(()),
    }
}

/// Campaigns over seeds, poses, truths, strategies and estimators: `schema: tribo.study/1`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Study {
    /// `tribo.study/1`.
    pub schema: String,
    /// Seeds 1 to this one.
    pub seeds: u64,
    /// Poses.
    #[serde(default = "first_pose")]
    pub poses: Vec<usize>,
    /// Truths, and the law tuned on each.
    pub cases: Vec<Case>,
    /// Strategies and their budgets; the others are tested against the first.
    pub strategies: Vec<Budget>,
    /// Estimators whose wrench is the cost.
    #[serde(default = "ekf_alone")]
    pub estimators: Vec<EstimatorName>,
    /// Runs over which the reference costs of a campaign are averaged; one alone repeats to 2–3 %.
    #[serde(default = "three_runs")]
    pub oracle_runs: u64,
    /// Everything else, as in `tribo.tune/1`, the same in all campaigns.
    #[serde(default)]
    pub settings: TuneConfig,
}

fn first_pose() -> Vec<usize> {
    vec![0]
}

fn ekf_alone() -> Vec<EstimatorName> {
    vec![EstimatorName::Ekf]
}

fn three_runs() -> u64 {
    3
}

/// A truth and the law tuned on it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Case {
    /// What the simulated arm is like.
    pub truth: TruthName,
    /// Friction law of the compensator.
    pub friction: TunedLaw,
    /// Content of the file that `truth` names, as it was when the study began.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub truth_content: Option<ModelFile>,
}

impl Case {
    /// `lugre tuned as coulomb_viscous`, or the truth alone where it is the law.
    pub fn name(&self) -> String {
        let (truth, law) = (String::from(self.truth.clone()), file_name(&self.friction));
        if truth == law { truth } else { format!("{truth}, tuned as {law}") }
    }
}

/// A strategy and its budget.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Budget {
    /// The strategy.
    pub strategy: StrategyName,
    /// Trials per campaign.
    pub trials: usize,
}

impl Study {
    /// Reads a study and the files that it names, and checks every field.
    ///
    /// # Errors
    /// A file that cannot be used; the first field out of its range.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        Self::parse(&YamlDocument::read(path)?)
    }

    /// The study in a document, as [`Self::read`].
    ///
    /// # Errors
    /// Those of [`Self::read`].
    pub fn parse(document: &YamlDocument) -> Result<Self, FileError> {
        let mut study: Self = document.parse()?;
        match study.validate() {
            Ok(()) => Ok(study),
            Err(ConfigError::Field(field)) => Err(document.explain(field)),
            Err(ConfigError::File(error)) => Err(error),
        }
    }

    fn validate(&mut self) -> Result<(), ConfigError> {
        if self.schema != SCHEMA {
            return Err(FieldError::new("schema", &self.schema, SCHEMA).into());
        }
        FieldError::check("seeds", self.seeds as f64, 1.0, 10_000.0)?;
        FieldError::check("oracle_runs", self.oracle_runs as f64, 1.0, 100.0)?;
        for (field, empty) in [
            ("poses", self.poses.is_empty()),
            ("cases", self.cases.is_empty()),
            ("strategies", self.strategies.is_empty()),
            ("estimators", self.estimators.is_empty()),
        ] {
            if empty {
                return Err(FieldError::new(field, "[]", "one or more").into());
            }
        }
        once("poses", &self.poses)?;
        once("cases", &self.cases)?;
        once("strategies", &self.strategies)?;
        once("estimators", &self.estimators)?;
        let kinds = self.poses.len() * self.cases.len() * (self.strategies.len() + 1) * self.estimators.len();
        if kinds > MOST_KINDS {
            let allowed = format!("at most {MOST_KINDS} combinations of pose, case, strategy and estimator");
            return Err(FieldError::new("cases", format!("part of {kinds} combinations"), allowed).into());
        }
        if self.seeds > MOST_CELLS / kinds as u64 {
            let allowed = format!("at most {} with {kinds} campaigns and references each", MOST_CELLS / kinds as u64);
            return Err(FieldError::new("seeds", self.seeds, allowed).into());
        }
        for (k, budget) in self.strategies.iter().enumerate() {
            FieldError::check(&format!("strategies.{k}.trials"), budget.trials as f64, 1.0, 10_000.0)?;
        }
        if let Some((k, pose)) = self.poses.iter().enumerate().find(|(_, pose)| **pose >= POSES) {
            return Err(FieldError::new(format!("poses.{k}"), pose, format!("0 to {}", POSES - 1)).into());
        }
        if self.settings.user_trials.is_some() {
            return Err(FieldError::new("settings.user_trials", "there", "nothing: a study is simulated").into());
        }
        // What the settings name is read once, here, so that all shards see the same.
        freeze(self.settings.model.as_ref(), &mut self.settings.model_content)?;
        for case in &mut self.cases {
            freeze(case.truth.path(), &mut case.truth_content)?;
        }
        if self.settings.robot.is_some() {
            self.settings.load()?;
        }
        self.settings.phases = Phases::Random;
        // Every kind of cell once: what cannot run is found before anything does.
        let mut kinds: Vec<Cell> = self.cells();
        kinds.retain(|cell| cell.seed == 1);
        kinds.iter().try_for_each(|cell| self.config_of(cell).validate_any().map(|_| ()))
    }

    /// All cells, in the order of tables.
    pub fn cells(&self) -> Vec<Cell> {
        let mut cells = Vec::new();
        for case in 0..self.cases.len() {
            for estimator in 0..self.estimators.len() {
                for &pose in &self.poses {
                    for seed in 1..=self.seeds {
                        let campaigns = (0..self.strategies.len()).map(Work::Campaign);
                        let work = std::iter::once(Work::References).chain(campaigns);
                        cells.extend(work.map(|work| Cell { case, estimator, pose, seed, work }));
                    }
                }
            }
        }
        cells
    }

    /// Settings of the campaign of a cell. Strategies see the same robot, motion and noise: they are compared in pairs.
    pub fn config_of(&self, cell: &Cell) -> TuneConfig {
        let case = &self.cases[cell.case];
        let config = TuneConfig {
            // Poses of one seed differ in phases and noise too.
            seed: cell.seed * 10 + cell.pose as u64,
            friction: case.friction,
            truth: case.truth.clone(),
            truth_content: case.truth_content.clone(),
            pose: cell.pose,
            residual: self.estimators[cell.estimator],
            ..self.settings.clone()
        };
        match cell.work {
            Work::References => config,
            Work::Campaign(strategy) => {
                let Budget { strategy, trials } = self.strategies[strategy];
                // Campaigns of equal length, unless the settings say otherwise of strategies that can end early.
                let stop_below = config.stop_below.filter(|_| strategy.expects_gain()).unwrap_or(StopBelow::Never);
                // The law is the case's.
                let change_law = Some(config.change_law.unwrap_or(false));
                TuneConfig { strategy, trials, stop_below: Some(stop_below), change_law, ..config }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A study of some kilobytes must not ask for more cells than memory holds.
    #[test]
    fn grids_without_end_are_refused() {
        let refused = |seeds: u64, poses: &str, trials: std::ops::Range<usize>| {
            let strategies: String = trials.map(|k| format!("- {{strategy: sobol, trials: {k}}}\n")).collect();
            let text = format!(
                "schema: tribo.study/1\nseeds: {seeds}\nposes: {poses}\n\
                 cases: [{{truth: stribeck, friction: stribeck}}]\nstrategies:\n{strategies}"
            );
            Study::parse(&YamlDocument::embedded("s.yaml", &text))
                .map(|study| study.cells().len())
                .map_err(|e| e.to_string())
        };
        assert_eq!(refused(2, "[0, 2]", 1..3), Ok(12));
        let message = refused(1, "[0, 2, 0]", 1..2).unwrap_err();
        assert_eq!(message, "s.yaml:3: field `poses[2]` is there twice; allowed: once");
        let message = refused(10_000, "[0, 1, 2]", 1..101).unwrap_err();
        assert!(message.starts_with("s.yaml:2: field `seeds` is 10000; allowed: at most 3300 "), "{message}");
        let message = refused(1, "[0]", 1..1002).unwrap_err();
        assert!(message.contains("`strategies` is 1001 entries; allowed: at most 1000"), "{message}");
    }

    /// Campaigns are of equal length unless the settings say otherwise; then those end early that can.
    #[test]
    fn campaigns_of_a_study_end_early_where_it_is_asked_for() {
        let rules = |settings: &str| {
            let text = format!(
                "schema: tribo.study/1\nseeds: 1\nposes: [0]\ncases: [{{truth: stribeck, friction: stribeck}}]\n\
                 strategies: [{{strategy: grey_box, trials: 9}}, {{strategy: bo, trials: 9}}, {{strategy: sobol, trials: 9}}]\n{settings}"
            );
            let study = Study::parse(&YamlDocument::embedded("s.yaml", &text)).unwrap();
            let cells = study.cells();
            let campaigns = cells.iter().filter(|cell| matches!(cell.work, Work::Campaign(_)));
            let campaigns: Vec<TuneConfig> = campaigns.map(|cell| study.config_of(cell)).collect();
            let of = |strategy| campaigns.iter().find(|config| config.strategy == strategy).unwrap().stop_below;
            [StrategyName::GreyBox, StrategyName::Bo, StrategyName::Sobol].map(of)
        };
        assert_eq!(rules(""), [Some(StopBelow::Never); 3]);
        let asked = rules("settings: {stop_below: 0.5}\n");
        assert_eq!(asked, [Some(StopBelow::Share(0.5)), Some(StopBelow::Share(0.5)), Some(StopBelow::Never)]);
    }
}
