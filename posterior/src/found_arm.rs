//! Columns that go with what the joints carry, for the arm as it is found and not as the model has it.
//!
//! ```text
//! load friction_j = |τ_link,j(π)| s_j,   tilt = G(q; π) dg,   π links and payload of the last fit
//! ```
//!
//! Load friction is bilinear in its coefficient and in what the joints carry, a tilt in gravity and in what it acts on. With the load of the model alone, a payload of 1.5 kg on
//! a UR10e was a constant 0.18 Nm of friction of its fourth joint that the fit took from the dry friction, and the written file, which knows the payload, added.

use std::sync::Arc;

use nalgebra::SVector;
use rayon::prelude::*;
use tribo_regression::RegressionData;
use tribo_regression::cause::base_tilt_columns;
use tribo_robot::{Arm, rnea};

use crate::columns::Columns;
use crate::joint_columns::TILT;
use crate::joint_term::JointTerm;
use crate::problem::{Place, Problem, State};

/// Puts the columns of an arm, without and with the payload, in the place of those of the model; `unloaded` says of each log whether the flange was bare.
/// Returns by how much each column of each joint changes (RMS, torque per unit of the coefficient), columns in the order load, tilts. Where
/// the torque at the links was measured, it is the load, and nothing changes.
pub fn set_arm<const N: usize>(
    columns: &mut Columns,
    data: &RegressionData<N>,
    [bare, loaded]: [&Arm<N>; 2],
    unloaded: &[bool],
) -> [Vec<f64>; 3] {
    if data.transmission {
        return [(); 3].map(|()| vec![0.0; N]);
    }
    let arms: Vec<Arm<N>> =
        unloaded.iter().map(|unloaded| if *unloaded { bare } else { loaded }.clone().link_side()).collect();
    let link_nm: Vec<SVector<f64, N>> = data
        .bursts
        .iter()
        .flat_map(|burst| {
            let (arm, samples) = (&arms[burst.log], &data.motion[burst.fine.clone()]);
            samples.par_iter().map(|at| rnea(arm, &at.q, &at.qd, &at.qdd)).collect::<Vec<_>>()
        })
        .collect();
    let load = |j: usize| {
        let friction = data.of_model.iter().zip(&link_nm).map(|(at, link_nm)| link_nm[j].abs() * at.sign[j]);
        data.filter_own(&friction.collect::<Vec<f64>>())
    };
    let tilts = data.filter_all(&base_tilt_columns(data, &arms));
    let rows = data.time_s.len();
    let mut replaced = vec![(JointTerm::Load.place(), (0..N).map(load).collect::<Vec<Vec<f64>>>())];
    replaced.extend(tilts.into_iter().enumerate().map(|(k, column)| {
        let of_joint =
            column.rows.into_iter().map(|values| values.map_or_else(|| vec![0.0; rows], Arc::unwrap_or_clone));
        (TILT + k, of_joint.collect())
    }));
    let mut changes = columns.replace(&replaced).into_iter();
    [(); 3].map(|()| changes.next().unwrap_or_else(|| vec![0.0; N]))
}

/// What changes of these columns mean for the torque of each joint at a state (RMS, Nm).
pub fn torque_of_changes(problem: &Problem, state: &State, [load, tilts @ ..]: &[Vec<f64>; 3]) -> Vec<f64> {
    let at = |place: Place| problem.index(place).map_or(0.0, |i| state[i].abs());
    (0..problem.joints())
        .map(|j| {
            let by_tilts =
                tilts.iter().enumerate().map(|(k, tilt)| problem.gravity_m_s2() * at(Place::Tilt(k)) * tilt[j]);
            at(Place::Own(j, JointTerm::Load)) * load[j] + by_tilts.sum::<f64>()
        })
        .collect()
}
