//! The arms that logs can be held against.

use tribo_logs::RobotLog;
use tribo_logs::recognise::Remark;
use tribo_regression::{DiagnoseError, Nominal};

use crate::recognise::by_the_arm;
use crate::settings::DiagnoseSettings;
use crate::{Diagnosis, engine};

/// A [`Nominal`] model of six or of seven joints, which [`diagnose`](crate::diagnose) and
/// [`recognise`](crate::recognise::recognise) take.
///
/// The search is written for any number of joints and is compiled here for these: a call of it from another crate compiles nothing.
pub trait Diagnosable {
    #[doc(hidden)]
    fn diagnosed(
        &self,
        logs: &[RobotLog],
        unloaded: &[RobotLog],
        validate: &[(String, RobotLog)],
        settings: &DiagnoseSettings,
        progress: &(dyn Fn(&str, f64) -> bool + Sync),
    ) -> Result<Diagnosis, DiagnoseError>;

    #[doc(hidden)]
    fn recognised(&self, log: &RobotLog) -> Vec<Remark>;
}

macro_rules! diagnosable {
    ($($joints:literal),*) => {$(
        impl Diagnosable for Nominal<$joints> {
            fn diagnosed(
                &self,
                logs: &[RobotLog],
                unloaded: &[RobotLog],
                validate: &[(String, RobotLog)],
                settings: &DiagnoseSettings,
                progress: &(dyn Fn(&str, f64) -> bool + Sync),
            ) -> Result<Diagnosis, DiagnoseError> {
                engine::explained(logs, unloaded, self, validate, settings, progress)
            }

            fn recognised(&self, log: &RobotLog) -> Vec<Remark> {
                by_the_arm(log, self)
            }
        }
    )*};
}

diagnosable!(6, 7);

/// Finds what the nominal model lacks.
///
/// ```text
/// log → residual in band → ripples at full rate → whitened regression on all causes → forward–backward selection
///     → sign flips (chance) → held-out gain, intervals, rivals → verdict
/// ```
///
/// `validate` are logs that no parameter is fitted to. `progress` hears stage and fraction and stops the work by
/// answering `false`. The same logs, model and seed give the same bits.
///
/// # Errors
/// [`DiagnoseError`].
pub fn diagnose(
    logs: &[RobotLog],
    nominal: &impl Diagnosable,
    validate: &[(String, RobotLog)],
    settings: &DiagnoseSettings,
    progress: &(dyn Fn(&str, f64) -> bool + Sync),
) -> Result<Diagnosis, DiagnoseError> {
    diagnose_with_reference(logs, &[], nominal, validate, settings, progress)
}

/// [`diagnose`] with logs of the same arm whose flange is `unloaded`: they share everything with the others but the payload.
///
/// # Errors
/// [`DiagnoseError`].
pub fn diagnose_with_reference(
    logs: &[RobotLog],
    unloaded: &[RobotLog],
    nominal: &impl Diagnosable,
    validate: &[(String, RobotLog)],
    settings: &DiagnoseSettings,
    progress: &(dyn Fn(&str, f64) -> bool + Sync),
) -> Result<Diagnosis, DiagnoseError> {
    nominal.diagnosed(logs, unloaded, validate, settings, progress)
}

/// The remarks of the rigid model on a log, of which `tau_j_nm` is the torque that acted; none on a good one, or on one too
/// short to be judged.
#[must_use]
pub fn recognise(log: &RobotLog, nominal: &impl Diagnosable) -> Vec<Remark> {
    nominal.recognised(log)
}
