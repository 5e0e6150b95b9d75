//! What a log says about itself, without a model of the arm: whether its clock, angles, encoders and velocities can be right.
//!
//! ```text
//! Δq = ∫ dq dt   on every window of a tenth of a second,     |q| within a few turns,     a row more than five times a second
//! ```
//!
//! [`recognise`] judges the whole log; nothing is ever changed. What needs the rigid model (signs, units and order of the
//! torques) is judged by `tribo_diagnose::recognise`, in the same words: a list of [`Remark`]s.
//! Leaves out: what a log of good columns is good for.

mod angle;
mod clock;
mod encoder;
mod impossible;
mod noise;
mod remark;
mod travel;
mod velocity;

pub use impossible::{Reach, without_impossible_rows};
pub use remark::{Fault, Remark, Severity, Use, joints_named, refusal, said};
pub use travel::{Travel, travel};

use crate::LogColumns;

/// The remarks on a log, worst first; none on a good one.
///
/// Joints count from 0. Whatever the columns hold, this ends with remarks: no panic, no error.
#[must_use]
pub fn recognise(log: &LogColumns) -> Vec<Remark> {
    let mut remarks = Vec::new();
    if let Some(remark) = clock::too_slow(&log.time_s) {
        // Of a wrong clock no speed is right.
        return vec![remark];
    }
    remarks.extend(angle::degrees(log));
    remarks.extend(encoder::frozen(log));
    let frozen: Vec<usize> =
        remarks.iter().filter(|r| r.fault == Fault::FrozenEncoder).flat_map(|r| r.joints.clone()).collect();
    remarks.extend(velocity::against_position(log, &frozen));
    remarks.extend(noise::drowned(log, &frozen));
    remarks.extend(travel::standstill(log));
    remarks.sort_by_key(|remark| remark.severity == Severity::Warn);
    remarks
}
