//! Logs of a simulated arm that follows a motion.

use pyo3::prelude::*;
use tribo_logs::RobotLog;
use tribo_model::{AnyModel, Model};
use tribo_sim::excitation::{Envelope, Excitation};
use tribo_sim::{Recording, RecordingError, record as recorded};

use crate::arm::either;
use crate::failure::{bad, raised};
use crate::log::PyLog;
use crate::model::PyModel;

/// The motions by name.
const MOTIONS: [(&str, Excitation); 6] = [
    ("multisine", Excitation::Multisine),
    ("cruise", Excitation::Cruise),
    ("back_and_forth", Excitation::BackAndForth),
    ("static_poses", Excitation::StaticPoses),
    ("small_fast", Excitation::SmallFast),
    ("joint_by_joint", Excitation::JointByJoint),
];

/// The log that an arm which is truly as `model` says would leave of a motion, by inverse dynamics: no controller, no drift.
#[pyfunction]
#[pyo3(signature = (model, motion, duration, rate, noise, seed))]
pub(crate) fn record(
    py: Python<'_>,
    model: &Bound<'_, PyAny>,
    motion: &str,
    duration: f64,
    rate: f64,
    noise: f64,
    seed: u64,
) -> PyResult<PyLog> {
    let model = PyModel::meant(Some(model), &[])?;
    let named = MOTIONS.into_iter().find(|(name, _)| *name == motion);
    let Some((_, excitation)) = named else {
        return Err(bad(format!("motion is {motion}; allowed: {}", MOTIONS.map(|(name, _)| name).join(", "))));
    };
    for (name, value, least, most) in [("duration", duration, 1.0, 3600.0), ("noise", noise, 0.0, 100.0)] {
        if !(least..=most).contains(&value) {
            return Err(bad(format!("{name} is {value}; allowed: {least} to {most}")));
        }
    }
    let usual = Recording { rate_hz: rate, ..Recording::default() };
    let recording = Recording {
        encoder_sd_rad: noise * usual.encoder_sd_rad,
        torque_sd_nm: noise * usual.torque_sd_nm,
        ..usual
    };
    let log = py
        .detach(|| either!(&model.model, AnyModel, model => of(model, excitation, duration, &recording, seed)))
        .map_err(raised)?;
    Ok(PyLog::of(log, motion))
}

fn of<const N: usize>(
    model: &Model<N>,
    motion: Excitation,
    duration_s: f64,
    recording: &Recording,
    seed: u64,
) -> Result<RobotLog, RecordingError> {
    let truth = model.to_plant();
    let trajectory = motion.draw(&Envelope::of(&model.robot.arm), duration_s, seed);
    let recording = Recording { torque_side: model.torque_side, ..*recording };
    recorded(&truth, model.smoothing_rad_s, trajectory.as_ref(), &recording, seed)
}
