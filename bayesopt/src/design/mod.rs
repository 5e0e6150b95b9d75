//! Points that need no model: the initial design and the model-free baselines.

mod latin_hypercube;
mod safe_growth;
mod sobol;
mod uniform;

pub use latin_hypercube::latin_hypercube_point;
pub use safe_growth::{growth_factor, safe_growth_point};
pub(crate) use sobol::scrambled_sobol;
pub use sobol::sobol_point;
pub use uniform::uniform_random_point;

use serde::{Deserialize, Serialize};

/// How the points of the design are laid out. Every kind gives point `i` from (seed, i) alone,
/// so that a caller can run the whole design in parallel before any value is known.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Design {
    /// Independent uniform points.
    UniformRandom,
    /// Owen-scrambled Sobol sequence.
    Sobol,
    /// Latin hypercube over the initial trials; a new hypercube follows when it is spent.
    LatinHypercube,
    /// The start point, then Sobol points pulled towards it, wider and wider.
    SafeGrowth {
        /// The point known to be safe, in real units (zero compensation).
        start: Vec<f64>,
        /// Share of the box used by the first point after the start. Default 0.1: small steps cannot crash.
        first_factor: f64,
        /// Share of the box used by the last point. Default 0.6: measured best on an early prototype of the loop.
        last_factor: f64,
    },
}
