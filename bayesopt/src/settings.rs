//! What kind of search is run.

use serde::{Deserialize, Serialize};

use crate::acquisition::Acquisition;
use crate::design::{Design, latin_hypercube_point, safe_growth_point, sobol_point, uniform_random_point};
use crate::gp::{FitSettings, HyperPrior, Lengthscales};
use crate::kernel::{KernelFamily, KernelShape, Structure};
use crate::search::SearchSettings;
use crate::transform::CostTransform;
use crate::{BayesoptError, Domain};

/// A design, then a model. Plain data; `validate` says which field is out of range.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// How the first trials are laid out.
    pub design: Design,
    /// Trials of the design. Default 10, as in roveda2022 §5.
    pub init_trials: usize,
    /// What chooses the later trials; none lets the design go on.
    pub model: Option<ModelSettings>,
}

/// The model-based part of a search.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelSettings {
    /// Kernel, prior and effort of the Gaussian process.
    pub fit: FitSettings,
    /// Kernels among which the evidence decides; none leaves `fit.family` by itself.
    pub shapes: Vec<KernelShape>,
    /// What is maximised.
    pub acquisition: Acquisition,
    /// Factor on the posterior deviation in the acquisition.
    pub sd_factor: f64,
    /// From costs to targets.
    pub transform: CostTransform,
    /// Whether the improvement counts only as far as its trial is likely to finish ([`crate::Feasibility`]).
    pub feasibility: bool,
    /// Whether the incumbent of noisy costs is the best posterior mean among the trials instead of the luckiest cost.
    pub noise_aware: bool,
    /// At most one in this many trials of the model repeats a doubtful incumbent; none never does. Needs `noise_aware`.
    pub repeat_one_in: Option<usize>,
    /// A trust region is used in more coordinates than this; none never.
    pub trust_region_above: Option<usize>,
    /// Effort of the maximisation.
    pub search: SearchSettings,
}

/// Trials of the initial design (roveda2022 §5: ten).
const INIT_TRIALS: usize = 10;
/// Observations the hyper-parameters are fitted to at most: a fit costs n³ per evaluation.
const FIT_LIMIT: usize = 300;

impl Settings {
    /// The route of roveda2022: ten uniform random trials, isotropic squared-exponential kernel with
    /// ML-II, expected improvement, raw cost with its penalty inside.
    pub fn paper() -> Self {
        let fit = FitSettings {
            family: KernelFamily::SquaredExponential,
            lengthscales: Lengthscales::Isotropic,
            prior: HyperPrior::Flat,
            starts: 4,
            iterations: 50,
            fit_limit: FIT_LIMIT,
        };
        let model = ModelSettings {
            fit,
            shapes: vec![],
            acquisition: Acquisition::Ei,
            sd_factor: 1.0,
            transform: CostTransform::Raw,
            feasibility: false,
            noise_aware: false,
            repeat_one_in: None,
            trust_region_above: None,
            search: SearchSettings::default(),
        };
        Self { design: Design::UniformRandom, init_trials: INIT_TRIALS, model: Some(model) }
    }

    /// Safe growth from `start` (real units), then a squared-exponential ARD kernel with trend and pooled dimension-scaled
    /// length-scales, joint or additive by evidence as is the transform of the costs; LogEI at twice the posterior
    /// deviation inside a trust region. The same for every dimension; figures in `README.md` of this crate.
    pub fn bo(start: Vec<f64>) -> Self {
        let fit = FitSettings {
            family: KernelFamily::SquaredExponential,
            lengthscales: Lengthscales::Ard,
            prior: HyperPrior::DimensionScaled,
            starts: 2,
            iterations: 50,
            fit_limit: FIT_LIMIT,
        };
        let shapes = [Structure::Joint, Structure::Additive]
            .map(|structure| KernelShape { family: fit.family, structure, trend: true })
            .to_vec();
        let model = ModelSettings {
            fit,
            shapes,
            acquisition: Acquisition::LogEi,
            // Ackley in 14-D: regret 4.4 against 4.7 at 1.4 (40 seeds); friction in 35-D likes less, 6.8 at 1 against 7.3.
            sd_factor: 2.0,
            transform: CostTransform::ByEvidence { cap_factor: 1.3 },
            feasibility: true,
            noise_aware: true,
            repeat_one_in: Some(5),
            trust_region_above: Some(0),
            search: SearchSettings::default(),
        };
        let design = Design::SafeGrowth { start, first_factor: 0.1, last_factor: 0.6 };
        Self { design, init_trials: INIT_TRIALS, model: Some(model) }
    }

    /// Baseline: uniform random search.
    pub fn random() -> Self {
        Self { design: Design::UniformRandom, init_trials: INIT_TRIALS, model: None }
    }

    /// Baseline: the Owen-scrambled Sobol sequence.
    pub fn sobol() -> Self {
        Self { design: Design::Sobol, init_trials: INIT_TRIALS, model: None }
    }

    /// Point `index` of the design, in real units: a function of (settings, domain, index, seed) alone.
    /// The first `init_trials` points can be run in parallel before any value is known.
    ///
    /// # Errors
    /// `BadSetting`, `DimensionMismatch`, `NonFiniteCoordinate` of a start that does not fit the domain.
    pub fn design_point(&self, domain: &Domain, index: usize, seed: u64) -> Result<Vec<f64>, BayesoptError> {
        self.validate(domain)?;
        let (dimension, count) = (domain.dimension(), self.init_trials);
        let unit = match &self.design {
            Design::UniformRandom => uniform_random_point(dimension, index, seed),
            Design::Sobol => sobol_point(dimension, index, seed),
            Design::LatinHypercube => latin_hypercube_point(dimension, index, count, seed),
            // The start itself is handed out as it was given, to the last bit.
            Design::SafeGrowth { start, .. } if index == 0 => return Ok(start.clone()),
            Design::SafeGrowth { start, first_factor, last_factor } => {
                safe_growth_point(&domain.to_unit(start)?, index, count, *first_factor, *last_factor, seed)
            }
        };
        domain.from_unit(&unit)
    }

    /// Checks every field against its range and against the domain.
    ///
    /// # Errors
    /// `BadSetting`, `DimensionMismatch`, `NonFiniteCoordinate`.
    pub fn validate(&self, domain: &Domain) -> Result<(), BayesoptError> {
        if let Design::SafeGrowth { start, first_factor, last_factor } = &self.design {
            for u in domain.to_unit(start)? {
                require("design.start", u, (0.0..=1.0).contains(&u), "inside the domain")?;
            }
            let share = |factor: f64| factor > 0.0 && factor <= 1.0;
            require("design.first_factor", *first_factor, share(*first_factor), "(0, 1]")?;
            require("design.last_factor", *last_factor, share(*last_factor), "(0, 1]")?;
        }
        let Some(model) = &self.model else { return Ok(()) };
        let sd_factor = model.sd_factor;
        require("model.sd_factor", sd_factor, sd_factor > 0.0 && sd_factor.is_finite(), "(0, ∞)")?;
        if let CostTransform::ByEvidence { cap_factor } = model.transform {
            require("model.transform.cap_factor", cap_factor, cap_factor >= 1.0 && cap_factor.is_finite(), "[1, ∞)")?;
        }
        let allowed = "false where the acquisition is ei, which is no logarithm";
        let logarithmic = model.acquisition == Acquisition::LogEi;
        require(
            "model.feasibility",
            f64::from(u8::from(model.feasibility)),
            !model.feasibility || logarithmic,
            allowed,
        )?;
        let every = model.repeat_one_in.unwrap_or(2);
        require("model.repeat_one_in", every as f64, every >= 2, "at least 2")?;
        let search = &model.search;
        for (field, count, most) in [
            ("model.fit.starts", model.fit.starts, 1000),
            ("model.fit.iterations", model.fit.iterations, 100_000),
            ("model.search.candidates", search.candidates, 1 << 16),
            ("model.search.refined", search.refined, 1000),
        ] {
            require(field, count as f64, (1..=most).contains(&count), "at least 1 and not absurdly large")?;
        }
        require("model.fit.fit_limit", model.fit.fit_limit as f64, model.fit.fit_limit >= 2, "at least 2")
    }
}

fn require(field: &'static str, value: f64, holds: bool, allowed: &'static str) -> Result<(), BayesoptError> {
    if holds { Ok(()) } else { Err(BayesoptError::BadSetting { field, value, allowed }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_are_valid_and_survive_serialisation() {
        let domain = Domain::unit_cube(3).unwrap();
        for settings in [Settings::paper(), Settings::bo(vec![0.0; 3]), Settings::random(), Settings::sobol()] {
            settings.validate(&domain).unwrap();
            let text = serde_json::to_string(&settings).unwrap();
            assert_eq!(serde_json::from_str::<Settings>(&text).unwrap(), settings);
        }
    }

    #[test]
    fn a_bad_field_is_named() {
        let domain = Domain::unit_cube(2).unwrap();
        let outside = Settings::bo(vec![0.0, 1.5]).validate(&domain);
        assert!(matches!(outside, Err(BayesoptError::BadSetting { field: "design.start", .. })));
        let short = Settings::bo(vec![0.0]).validate(&domain);
        assert_eq!(short, Err(BayesoptError::DimensionMismatch { need: 2, got: 1 }));
        let mut lazy = Settings::paper();
        lazy.model.as_mut().unwrap().search.refined = 0;
        assert!(matches!(lazy.validate(&domain), Err(BayesoptError::BadSetting { field: "model.search.refined", .. })));
    }

    #[test]
    fn the_design_begins_at_the_start_to_the_last_bit() {
        let domain = Domain::new(vec!["a".into()], vec![-0.3], vec![1.7]).unwrap();
        let start = vec![0.1];
        assert_eq!(Settings::bo(start.clone()).design_point(&domain, 0, 1).unwrap(), start);
    }
}
