//! Friction that goes with the load of the arm as it is found, not as the model has it.
//!
//! ```text
//! column_j = |τ_link,j(π)| s_j,   π links, payload and gravity of the last fit
//! ```
//!
//! Load friction is bilinear in its coefficient and in what the joints carry. With the load of the model alone, a payload of 1.5 kg on a UR10e was a constant
//! 0.18 Nm of friction of its fourth joint that the fit took from the dry friction, and the written file, which knows the payload, added.

use nalgebra::SVector;
use rayon::prelude::*;
use tribo_robot::{Arm, rnea};

use super::columns::Columns;
use super::joint_term::JointTerm;
use crate::regression_data::RegressionData;

/// Replaces the load columns of some data by those of an arm, one without and one with the payload; `unloaded` says of each log whether the flange was bare.
/// Where the torque at the links was measured, it is the load, and nothing changes.
pub(super) fn set_load<const N: usize>(
    columns: &mut Columns,
    data: &RegressionData<N>,
    [bare, loaded]: [&Arm<N>; 2],
    unloaded: &[bool],
) {
    if data.transmission {
        return;
    }
    let [bare, loaded] = [bare, loaded].map(|arm| arm.clone().link_side());
    let link_nm: Vec<SVector<f64, N>> = data
        .bursts
        .iter()
        .flat_map(|burst| {
            let arm = if unloaded[burst.log] { &bare } else { &loaded };
            let samples = &data.samples[burst.fine.clone()];
            samples.par_iter().map(|at| rnea(arm, &at.q, &at.qd, &at.qdd)).collect::<Vec<_>>()
        })
        .collect();
    let column = |j: usize| {
        let friction = data.samples.iter().zip(&link_nm).map(|(at, link_nm)| link_nm[j].abs() * at.sign[j]);
        data.filter_own(j, friction.collect())
    };
    columns.replace(JointTerm::Load, &(0..N).map(column).collect::<Vec<Vec<f64>>>());
}
