//! Bayesian optimisation of any function, by ask and tell.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use tribo_bayesopt::{Domain, Outcome, Settings, Study, recommend};

use crate::failure::{bad, raised};
use crate::interrupt::interruptible;

/// Bayesian optimisation of a function of a few dozen numbers at most, each evaluation of which is dear: costs are minimised over a box.
///
/// The same settings, seed and history ask for the same points.
#[pyclass(name = "Study", module = "tribo")]
pub(crate) struct PyStudy {
    study: Study,
    seed: u64,
}

#[pymethods]
impl PyStudy {
    /// `space` maps the name of each coordinate to its lower and upper bound. `start` is the first point that is tried; `method` is bo (ours), paper, sobol or random;
    /// `init` the number of trials before there is a model.
    #[new]
    #[pyo3(signature = (space, *, start = None, seed = 1, method = "bo", init = None))]
    fn new(
        space: &Bound<'_, PyAny>,
        start: Option<Vec<f64>>,
        seed: u64,
        method: &str,
        init: Option<usize>,
    ) -> PyResult<Self> {
        let pairs = if let Ok(dictionary) = space.cast::<PyDict>() { dictionary.items().into_any() } else { space.clone() };
        let space: Vec<(String, (f64, f64))> = pairs.extract()?;
        let (names, bounds): (Vec<String>, Vec<(f64, f64)>) = space.into_iter().unzip();
        let (low, high): (Vec<f64>, Vec<f64>) = bounds.into_iter().unzip();
        let middle: Vec<f64> = low.iter().zip(&high).map(|(low, high)| 0.5 * (low + high)).collect();
        let domain = Domain::new(names, low, high).map_err(raised)?;
        let mut settings = match method {
            "bo" => Settings::bo(start.unwrap_or(middle)),
            "paper" => Settings::paper(),
            "sobol" => Settings::sobol(),
            "random" => Settings::random(),
            other => return Err(bad(format!("method is {other}; allowed: bo, paper, sobol, random"))),
        };
        settings.init_trials = init.unwrap_or(settings.init_trials);
        Ok(Self { study: Study::new(settings, domain, seed).map_err(raised)?, seed })
    }

    /// The next trial and its point, in the order of the space.
    fn ask(&mut self, py: Python<'_>) -> PyResult<(usize, Vec<f64>)> {
        let suggestion = interruptible(py, |_| self.study.ask())?.map_err(raised)?;
        Ok((suggestion.trial, suggestion.point))
    }

    /// What a trial cost; nothing, of one that failed.
    #[pyo3(signature = (trial, cost = None))]
    fn tell(&mut self, trial: usize, cost: Option<f64>) -> PyResult<()> {
        let outcome = match cost {
            Some(cost) if cost.is_finite() => Outcome::Value(cost),
            Some(cost) => return Err(bad(format!("cost is {cost}; allowed: finite numbers, or None of a trial that failed"))),
            None => Outcome::FAILED,
        };
        self.study.tell(trial, outcome).map_err(raised)
    }

    /// The trial with the least cost so far, its point and its cost; none before a trial has finished.
    #[getter]
    fn best(&self) -> Option<(usize, Vec<f64>, f64)> {
        let (trial, cost) = self.study.incumbent()?;
        Some((trial, self.study.history().trials.get(trial)?.point.clone(), cost))
    }

    /// The trial to use: of noisy costs the one that is expected to cost least when it is run again, with its point and that expectation.
    fn recommend(&self, py: Python<'_>) -> PyResult<Option<(usize, Vec<f64>, f64)>> {
        let found = interruptible(py, |_| {
            recommend(self.study.settings(), self.study.domain(), self.study.history(), self.seed)
        })?
        .map_err(raised)?;
        Ok(found.and_then(|found| {
            let point = self.study.history().trials.get(found.trial)?.point.clone();
            Some((found.trial, point, found.cost))
        }))
    }

    fn __len__(&self) -> usize {
        self.study.history().len()
    }

    fn __repr__(&self) -> String {
        format!("Study({} coordinates, {} trials)", self.study.domain().dimension(), self.study.history().len())
    }
}
