//! Bayesian optimisation by ask and tell.
//!
//! ```text
//! x_{n+1} = argmax_x a(x | D_n),   D_n = {(x_i, y_i)},   y ~ GP(0, k)
//! ```
//!
//! Costs are minimised over a box. [`suggest()`] is a pure function of (settings, domain, history, seed):
//! no state hides anywhere, so a killed campaign goes on by replaying its journal, bit for bit on one machine.
//! Knows no robot. Main types: [`Settings`] (presets `paper`, `bo`, `random`, `sobol`), [`Study`].
//!
//! ```
//! use tribo_bayesopt::{Domain, Outcome, Settings, Study};
//!
//! let domain = Domain::new(vec!["x".into(), "y".into()], vec![-1.0, 0.0], vec![1.0, 2.0])?;
//! let mut study = Study::new(Settings::bo(vec![0.0, 0.0]), domain, 1)?;
//! for _ in 0..20 {
//!     let suggestion = study.ask()?;
//!     let cost = (suggestion.point[0] - 0.3).powi(2) + (suggestion.point[1] - 0.7).powi(2) + 0.1;
//!     study.tell(suggestion.trial, Outcome::Value(cost))?;
//! }
//! assert!(study.incumbent().is_some_and(|(_, cost)| cost < 0.11));
//! # Ok::<(), tribo_bayesopt::BayesoptError>(())
//! ```
//!
//! Inside the crate points live on the unit cube and targets are standardised; outside both are in real units.
//! Leaves out: several objectives, constraints other than failure and what is known to be [`Allowed`], categorical coordinates.

pub mod acquisition;
mod allowed;
pub mod design;
mod domain;
mod error;
mod feasibility;
pub mod gp;
mod history;
mod incumbent;
pub mod kernel;
mod random;
mod recommend;
pub mod search;
mod settings;
mod stop;
mod study;
mod suggest;
mod suggest_sum;
mod surrogate_model;
mod transform;
mod trust_region;

pub use allowed::Allowed;
pub use domain::Domain;
pub use error::BayesoptError;
pub use feasibility::Feasibility;
pub use history::{History, Observation, Outcome};
pub use recommend::{Recommendation, recommend};
pub use settings::{ModelSettings, Settings};
pub use stop::{ExpectedGain, LeastGain, StopRule};
pub use study::Study;
pub use suggest::{ModelEvidence, Phase, Suggestion, suggest, suggest_allowed};
pub use suggest_sum::suggest_sum;
pub use surrogate_model::{Slice, SurrogateModel};
pub use transform::{Bend, CostTransform, Targets};
pub use trust_region::TrustRegion;
