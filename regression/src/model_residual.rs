//! What a model leaves of logs: the one path from a model file and a log to a residual.

use tribo_logs::RobotLog;

use crate::noise_level::rms;
use crate::regression_data::RegressionData;
use crate::{DiagnoseError, Nominal, SignalChain};

/// `residual = B (S tau_measured − model)` with everything that a model file says: arm, friction, effects, gains, delay.
///
/// A diagnosis reports this of the model that it wrote, `--validate` of other logs, `tribo estimate` of any log; one number
/// has one source.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelResidual {
    /// Time of each sample (s), within its log.
    pub time_s: Vec<f64>,
    /// Residual of each joint (Nm).
    pub residual_nm: Vec<Vec<f64>>,
    /// Filters, one entry per log.
    pub chains: Vec<SignalChain>,
}

impl ModelResidual {
    /// The residual of logs; `band_hz` `None` chooses the band from their noise.
    ///
    /// # Errors
    /// [`DiagnoseError`] of logs that do not fit the model or are too short for the band.
    pub fn of<const N: usize>(
        logs: &[RobotLog],
        model: &Nominal<N>,
        band_hz: Option<f64>,
    ) -> Result<Self, DiagnoseError> {
        Ok(Self::of_data(&RegressionData::of_logs(logs, model, band_hz)?))
    }

    /// The residual of regression data.
    pub(crate) fn of_data<const N: usize>(data: &RegressionData<N>) -> Self {
        let residual_nm = data.residual_nm.to_vec();
        Self { time_s: data.time_s.clone(), residual_nm, chains: data.chains.clone() }
    }

    /// RMS of each joint (Nm).
    pub fn rms_nm(&self) -> Vec<f64> {
        self.residual_nm.iter().map(|column| rms(column)).collect()
    }
}
