//! Time of one step of the optimiser.

use std::time::Instant;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde::Serialize;
use tribo_bayesopt::{BayesoptError, Domain, History, Outcome, Settings, SurrogateModel, suggest};

/// Finished trials when the step is taken: the end of a campaign of the paper's length and a little more.
const TRIALS: usize = 60;
/// Parameters of Coulomb and viscous friction of seven joints.
const COULOMB_VISCOUS: usize = 14;
/// Parameters with the Stribeck law.
const STRIBECK: usize = 35;

/// Times (ms) of the strategy `bo` after sixty trials.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct OptimiserTimes {
    /// Choice of kernel and hyper-parameters in 14 parameters.
    pub gp_fit_ms: f64,
    /// A whole suggestion in 14 parameters, fit included.
    pub bo_suggest_ms: f64,
    /// A whole suggestion in 35 parameters.
    pub bo_suggest_35_ms: f64,
}

impl OptimiserTimes {
    /// Measures them, each as the median of `repeats`.
    ///
    /// # Errors
    /// None on the problem as it is.
    pub fn measure(repeats: usize) -> Result<Self, BayesoptError> {
        let (settings, domain, history) = problem(COULOMB_VISCOUS)?;
        let (large_settings, large_domain, large_history) = problem(STRIBECK)?;
        Ok(Self {
            gp_fit_ms: median_ms(repeats, |seed| {
                let model = settings.model.as_ref();
                model.map(|model| SurrogateModel::of(model, &domain, &history, seed)).transpose().map(drop)
            })?,
            bo_suggest_ms: median_ms(repeats, |seed| suggest(&settings, &domain, &history, seed).map(drop))?,
            bo_suggest_35_ms: median_ms(repeats, |seed| {
                suggest(&large_settings, &large_domain, &large_history, seed).map(drop)
            })?,
        })
    }
}

/// Random points and a cost like that of friction: every parameter pulls its own way, more or less.
fn problem(dimension: usize) -> Result<(Settings, Domain, History), BayesoptError> {
    let mut random = Pcg64::seed_from_u64(dimension as u64);
    let mut history = History::new();
    for _ in 0..TRIALS {
        let u: Vec<f64> = (0..dimension).map(|_| random.random()).collect();
        let cost = u.iter().enumerate().map(|(i, u)| (1.0 + (i % 7) as f64) * (u - 0.4).abs()).sum();
        history.push(u, Outcome::Value(cost));
    }
    Ok((Settings::bo(vec![0.0; dimension]), Domain::unit_cube(dimension)?, history))
}

fn median_ms(repeats: usize, work: impl Fn(u64) -> Result<(), BayesoptError>) -> Result<f64, BayesoptError> {
    let mut times = Vec::with_capacity(repeats);
    for seed in 0..repeats.max(1) {
        let started = Instant::now();
        work(seed as u64)?;
        times.push(started.elapsed().as_secs_f64() * 1e3);
    }
    times.sort_by(f64::total_cmp);
    Ok(times[times.len() / 2])
}
