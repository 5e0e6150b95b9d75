//! Friction that the box of a campaign cuts off.

use serde::{Deserialize, Serialize};
use tribo_friction::identify::GlsFit;
use tribo_robot::JointNames;

use super::basis_column;
use crate::ParameterSpace;

/// A parameter of which the last logs speak for more than may be tried: the rest of that friction stays uncompensated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BeyondBox {
    /// The joint, from 0.
    pub joint: usize,
    /// The parameter, its unit in its name.
    pub parameter: String,
    /// Upper end of its box.
    pub bound: f64,
    /// What least squares finds in the last logs.
    pub found: f64,
}

impl BeyondBox {
    /// The parameters of a space that a fit finds beyond their upper ends.
    pub(crate) fn of<const N: usize>(space: &ParameterSpace, fit: &GlsFit<N>) -> Vec<Self> {
        let per_joint = space.parameters_per_joint();
        let beyond = |(k, (name, _, bound)): (usize, (&'static str, f64, f64))| {
            let (joint, column) = (k / per_joint, basis_column(name)?);
            let found = fit.coefficients[joint][column];
            (found > bound).then(|| Self { joint, parameter: name.to_owned(), bound, found })
        };
        space.entries().into_iter().enumerate().filter_map(beyond).collect()
    }
}

impl BeyondBox {
    /// What there is to say of it.
    pub fn sentence(&self, names: &JointNames) -> String {
        let Self { joint, parameter, bound, found } = self;
        let joint = names.of(*joint);
        format!(
            "{joint}: {parameter} is at its bound of {bound:.3}, and the last logs speak for {found:.3}: the rest stays uncompensated \
             (--bounds of a new campaign: torque_limits goes with the arm)"
        )
    }
}
