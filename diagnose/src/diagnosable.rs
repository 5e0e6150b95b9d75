//! The arms that logs can be held against.

use tribo_logs::RobotLog;
use tribo_logs::recognise::Remark;

use crate::{DiagnoseError, DiagnoseSettings, Diagnosis, Nominal, engine, recognise};

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
                recognise::by_the_arm(log, self)
            }
        }
    )*};
}

diagnosable!(6, 7);
