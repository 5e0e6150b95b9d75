//! The extended model on logs that no parameter was fitted to.

use tribo_logs::RobotLog;
use tribo_regression::{DiagnoseError, Nominal, RegressionData, rms};
use tribo_sim::Effect;

use crate::diagnosis::Validation;
use crate::held_out::gain_of_pairs;

/// Length of a block of the interval (s).
const BLOCK_S: f64 = 2.0;

/// Residual RMS of a log with the model that is asked about and with the extended one, which is the nominal with its effects, in the band
/// of the diagnosis.
pub(crate) fn validated_whole<const N: usize>(
    [asked, nominal]: [&Nominal<N>; 2],
    effects: &[Effect],
    (name, log): &(String, RobotLog),
    band_hz: Option<f64>,
    seed: u64,
) -> Result<Validation, DiagnoseError> {
    // A push belongs to the log that it was found in.
    let lasting = effects.iter().filter(|effect| !matches!(effect, Effect::ExternalContact { .. })).cloned();
    let mut extended = nominal.clone();
    extended.effects.extend(lasting);
    let before = RegressionData::of_logs(std::slice::from_ref(log), asked, band_hz)?;
    let after = RegressionData::of_motion(&before.logged, &extended)?;
    let per_joint = |data: &RegressionData<N>| data.residual_nm.iter().map(|column| rms(column)).collect();
    let length = (BLOCK_S * before.chains[0].output_rate_hz()).ceil().max(1.0) as usize;
    let block = |data: &RegressionData<N>, start: usize| {
        let end = (start + length).min(data.time_s.len());
        data.residual_nm.iter().flat_map(|column| &column[start..end]).map(|r| r * r).sum::<f64>()
    };
    let starts = (0..before.time_s.len().min(after.time_s.len())).step_by(length);
    let pairs: Vec<[f64; 2]> = starts.map(|start| [block(&before, start), block(&after, start)]).collect();
    let (gain, gain_ci95) = gain_of_pairs(&pairs, seed);
    Ok(Validation {
        log: name.clone(),
        before_nm: per_joint(&before),
        after_nm: per_joint(&after),
        plain_nm: Vec::new(),
        full_nm: Vec::new(),
        inside95: None,
        gain,
        gain_ci95,
    })
}
