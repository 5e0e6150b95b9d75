//! How far each joint moved, both ways.

use super::{Fault, Remark};
use crate::LogColumns;

/// Farthest that a joint goes (rad) that stands: play of gears, noise, a hand on the arm.
const STANDING_RAD: f64 = 2e-3;

/// The largest rise and the largest fall of a position (rad), wherever they lie in the log.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Travel {
    /// `max_{i ≤ k} (q_k − q_i)`.
    pub forward_rad: f64,
    /// `max_{i ≤ k} (q_i − q_k)`.
    pub backward_rad: f64,
}

/// Rise and fall of one position.
#[must_use]
pub fn travel(q_rad: &[f64]) -> Travel {
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut travel = Travel::default();
    for &q in q_rad {
        (least, most) = (least.min(q), most.max(q));
        travel.forward_rad = travel.forward_rad.max(q - least);
        travel.backward_rad = travel.backward_rad.max(most - q);
    }
    travel
}

/// An arm that stands throughout. What a log of it is good for, its use decides: a trial it is not.
pub(super) fn standstill(log: &LogColumns) -> Option<Remark> {
    let moved = log.q_rad.iter().map(|q| travel(q)).map(|t| t.forward_rad.max(t.backward_rad)).fold(0.0, f64::max);
    (moved < STANDING_RAD).then(|| {
        let evidence = format!("no joint moves: the farthest goes {moved:.1e} rad");
        let remedy = "a log of the standing arm says nothing about friction; log a motion".to_owned();
        Remark::refuse(Fault::Standstill, Vec::new(), evidence, remedy)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rises_and_falls_are_told_apart() {
        let up: Vec<f64> = (0..100).map(f64::from).collect();
        assert_eq!(travel(&up), Travel { forward_rad: 99.0, backward_rad: 0.0 });
        assert_eq!(travel(&[0.0, 3.0, 1.0, 2.0]), Travel { forward_rad: 3.0, backward_rad: 2.0 });
        assert_eq!(travel(&[]), Travel::default());
    }
}
