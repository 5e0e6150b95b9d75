//! Somebody pushed the arm.

use std::sync::Arc;

use nalgebra::SVector;
use tribo_sim::Effect;

use super::Candidate;
use crate::column::{Column, FineColumn};
use crate::label::{CauseLabel, Location};
use crate::logged_motion::Burst;
use crate::regression_data::RegressionData;

/// `−Jᵀ [force, moment]` on the robot during a window: six coefficients. Shape start and end (s), found by
/// [`crate::contact_window`]. A push that never ends is a payload.
pub struct ExternalContact {
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
        let mut columns = vec![vec![SVector::<f64, N>::zeros(); data.motion.len()]; 6];
        for burst in data.bursts.iter().filter(|burst| self.log.is_none_or(|log| log == burst.log)) {
            for k in burst.fine.clone() {
                let at = &data.motion[k];
                if at.time_s >= shape[0] && at.time_s <= shape[1] {
                    let jacobian = data.jacobian(&at.q);
                    for (component, column) in columns.iter_mut().enumerate() {
                        column[k] = -jacobian.row(component).transpose();
                    }
                }
            }
        }
        columns.into_iter().map(FineColumn::Arm).collect()
    }

    fn filtered(&self, data: &RegressionData<N>, shape: &[f64]) -> Vec<Column<N>> {
        let within = |burst: &Burst| {
            let samples = &data.motion[burst.fine.clone()];
            let start = samples.partition_point(|at| at.time_s < shape[0]);
            let end = samples.partition_point(|at| at.time_s <= shape[1]);
            let pushed = self.log.is_none_or(|log| log == burst.log) && start < end;
            burst.fine.start + start..burst.fine.start + if pushed { end } else { start }
        };
        let columns = data.filter_smooth(N, within, |at| -data.jacobian(&at.q).transpose());
        let acts = |row: &Arc<Vec<f64>>| row.iter().any(|x| *x != 0.0);
        columns.map(|column| Column { rows: column.rows.map(|row| row.filter(acts)) }).into()
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
