//! Somebody pushed the arm.

use nalgebra::{SMatrix, SVector};
use rayon::prelude::*;
use tribo_sim::Effect;

use super::Candidate;
use crate::column::{Column, FineColumn};
use crate::diagnosis::{CauseLabel, Location};
use crate::filter::Knots;
use crate::regression_data::RegressionData;

/// `−Jᵀ [force, moment]` on the robot during a window: six coefficients. Shape start and end (s), found by
/// [`crate::contact_window`]. A push that never ends is a payload.
pub(crate) struct ExternalContact {
    /// The log of the window; `None` is every log.
    pub log: Option<usize>,
}

impl<const N: usize> Candidate<N> for ExternalContact {
    fn label(&self) -> CauseLabel {
        CauseLabel::ExternalContact
    }

    fn location(&self) -> Location {
        Location::Arm
    }

    fn log(&self) -> Option<usize> {
        self.log
    }

    fn columns(&self, data: &RegressionData<N>, shape: &[f64]) -> Vec<FineColumn<N>> {
        let mut columns = vec![vec![SVector::<f64, N>::zeros(); data.samples.len()]; 6];
        for burst in data.bursts.iter().filter(|burst| self.log.is_none_or(|log| log == burst.log)) {
            for k in burst.fine.clone() {
                let at = &data.samples[k];
                if at.time_s >= shape[0] && at.time_s <= shape[1] {
                    let jacobian = data.jacobian(at);
                    for (component, column) in columns.iter_mut().enumerate() {
                        column[k] = -jacobian.row(component).transpose();
                    }
                }
            }
        }
        columns.into_iter().map(FineColumn::Arm).collect()
    }

    /// Joint by joint, so that the six columns of all joints never stand on the fine grid together.
    fn filtered(&self, data: &RegressionData<N>, shape: &[f64]) -> Vec<Column<N>> {
        let mut rows: Vec<Vec<Vec<f64>>> = vec![vec![Vec::new(); 6]; N];
        for burst in &data.bursts {
            let samples = &data.samples[burst.fine.clone()];
            let of_log = self.log.is_none_or(|log| log == burst.log);
            let (start, end) = (
                samples.partition_point(|at| at.time_s < shape[0]),
                samples.partition_point(|at| at.time_s <= shape[1]),
            );
            if !of_log || start >= end {
                rows.iter_mut().flatten().for_each(|row| row.resize(row.len() + burst.out.len(), 0.0));
                continue;
            }
            let chain = &data.chains[burst.log];
            let knots = Knots::of(end - start, chain.knot_stride());
            let jacobians: Vec<SMatrix<f64, 6, N>> =
                knots.places().map(|k| data.jacobian(&samples[start + k])).collect();
            rows.par_iter_mut().enumerate().for_each(|(j, row)| {
                let track = |component: usize| {
                    let at_knots: Vec<f64> = jacobians.iter().map(|jacobian| -jacobian[(component, j)]).collect();
                    let mut track = vec![0.0; samples.len()];
                    track[start..end].copy_from_slice(&knots.fill(&at_knots));
                    track
                };
                let tracks: Vec<Vec<f64>> = (0..6).map(track).collect();
                row.iter_mut().zip(chain.finish_all(&tracks)).for_each(|(row, finished)| row.extend(finished));
            });
        }
        let acts = |row: &Vec<f64>| row.iter().any(|x| *x != 0.0);
        let mut column =
            |c: usize| Column { rows: std::array::from_fn(|j| Some(std::mem::take(&mut rows[j][c])).filter(acts)) };
        (0..6).map(&mut column).collect()
    }

    fn effect(&self, _data: &RegressionData<N>, shape: &[f64], coefficients: &[f64]) -> Option<Effect> {
        let c = coefficients;
        Some(Effect::ExternalContact {
            force_n: [c[0], c[1], c[2]],
            moment_nm: [c[3], c[4], c[5]],
            start_s: shape[0],
            end_s: shape[1],
        })
    }
}
