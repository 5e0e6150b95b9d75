//! What the logs of a campaign say of the friction.

use tribo_friction::identify::GlsFit;

use crate::ParameterSpace;
use crate::strategy::basis_column;

/// One parameter of a friction law as least squares on the last logs knows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Learnt {
    /// The joint, from 0.
    pub joint: usize,
    /// The parameter, its unit in its name.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// Its standard deviation, bounds of the box ignored.
    pub sd: f64,
}

impl Learnt {
    /// Standard deviation above which a parameter is unsure, as a part of its value: friction repeats to about this much from day to
    /// day, and nobody gains by knowing it better.
    pub const UNSURE: f64 = 0.2;

    /// The parameters of a space that a fit knows.
    pub(crate) fn of<const N: usize>(space: &ParameterSpace, fit: &GlsFit<N>) -> Vec<Self> {
        let per_joint = space.parameters_per_joint();
        let known = |(k, (name, _, _)): (usize, (&'static str, f64, f64))| {
            let (joint, column) = (k / per_joint, basis_column(name)?);
            Some(Self { joint, name, value: fit.coefficients[joint][column], sd: fit.sd[joint][column] })
        };
        space.entries().into_iter().enumerate().filter_map(known).collect()
    }

    /// Whether more logs, or faster and slower ones, would still change it much.
    pub fn is_unsure(&self) -> bool {
        self.sd > Self::UNSURE * self.value.abs()
    }
}
