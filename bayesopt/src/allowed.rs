//! What of the box may be tried.

use std::fmt::Debug;

/// A limit that is known before any trial, inside the box: points beyond it are never proposed by the model.
///
/// ```text
/// x allowed  ⟺  hold_back(x) = x,     hold_back(hold_back(x)) = hold_back(x) up to rounding
/// ```
///
/// All in real units. Designs are the caller's to hold back.
pub trait Allowed: Debug + Sync {
    /// Value above which no coordinate is proposed, whatever the others.
    fn highest(&self) -> &[f64];

    /// Moves a point of the box to an allowed one, by lowering coordinates; an allowed one stays.
    fn hold_back(&self, point: &mut [f64]);
}
