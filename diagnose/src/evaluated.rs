//! What a search for single causes ran on, for whoever draws conclusions from it.

use tribo_posterior::PlainFits;
use tribo_regression::deflection::DeflectionFinding;
use tribo_regression::ripple::RippleLine;
use tribo_regression::{Nominal, RegressionData};

use crate::significance::Chance;

/// A model that is asked about, where the data have another in its place, and what it leaves (Nm).
#[derive(Clone, Copy)]
pub(crate) struct Before<'b, const N: usize> {
    pub model: &'b Nominal<N>,
    pub residual_nm: &'b [Vec<f64>; N],
}

/// What the search ran on.
pub(crate) struct Evaluated<'e, const N: usize> {
    /// Residual before ripples were taken out (Nm).
    pub original: &'e [Vec<f64>; N],
    /// What figures before the findings are of, if not the data's own model.
    pub before: Option<Before<'e, N>>,
    pub lines: &'e [RippleLine],
    /// What plain fits predict, to stand beside the answer.
    pub plain_fits: Option<&'e PlainFits>,
    pub deflections: &'e [DeflectionFinding],
    pub chance: &'e Chance,
    pub seed: u64,
}

impl<const N: usize> Evaluated<'_, N> {
    /// The model that figures before the findings are of, with what it leaves.
    pub fn asked<'a>(&'a self, data: &'a RegressionData<N>) -> Before<'a, N> {
        self.before.unwrap_or(Before { model: &data.nominal, residual_nm: self.original })
    }
}
