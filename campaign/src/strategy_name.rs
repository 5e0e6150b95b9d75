//! Strategies by name.

use serde::{Deserialize, Serialize};

/// Strategies by name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StrategyName {
    /// No compensation, again and again: the baseline and its repeatability.
    Zero,
    /// The constants published by gaz2019.
    Gaz,
    /// Uniform random search.
    Random,
    /// Sobol sequence.
    Sobol,
    /// roveda2022: ten random trials, then expected improvement on an isotropic Gaussian process of the raw cost.
    Paper,
    /// Bayesian optimisation grown from zero compensation: ARD Matérn-5/2, LogEI, capped log cost.
    Bo,
    /// The same with a model for each of the twelve parts of the cost, and the improvement of their sum.
    Composite,
    /// Covariance matrix adaptation from the centre of the box.
    CmaEs,
    /// Iterative learning with fixed gains from the motion alone, the baseline of roveda2022.
    IterativeLearning,
    /// Least squares on the logs of past trials, then local Bayesian optimisation of what is left.
    #[default]
    GreyBox,
}
