//! A motion that a client has started.

use super::desired::PERIOD_S;
use crate::wire::{CyclicCommand, MotionRequest};

/// Lost commands in a row that end a motion.
pub(super) const LOST_IN_A_ROW: u32 = 20;
/// Periods without any command after which a motion that was started ends.
const FIRST_COMMAND_WITHIN: u32 = 1000;

/// The motion and its book of lost commands.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion {
    pub(super) request: MotionRequest,
    /// The last command that came.
    pub(super) last: Option<CyclicCommand>,
    lost_in_a_row: u32,
    /// One bit per period, the last in the lowest: whether its command came.
    received: u128,
}

impl Motion {
    pub(super) fn new(request: MotionRequest) -> Self {
        Self { request, last: None, lost_in_a_row: 0, received: u128::MAX }
    }

    /// Notes whether a command came in this period.
    pub(super) fn note(&mut self, command: Option<&CyclicCommand>) {
        match command {
            Some(command) => {
                self.lost_in_a_row = 0;
                self.received = self.received << 1 | 1;
                self.last = Some(*command);
            }
            None => {
                self.lost_in_a_row += 1;
                if self.last.is_some() {
                    self.received <<= 1;
                }
            }
        }
    }

    /// Whether the client counts as lost.
    pub(super) fn is_deserted(&self) -> bool {
        self.lost_in_a_row >= if self.last.is_some() { LOST_IN_A_ROW } else { FIRST_COMMAND_WITHIN }
    }

    /// Share of the last 100 periods whose command came.
    pub(super) fn success_rate(&self) -> f64 {
        f64::from((self.received & ((1 << 100) - 1)).count_ones()) / 100.0
    }

    /// Whether the torque (Nm) of a command changes faster than `rate` (Nm/s) since `before`, or is not a number.
    pub(super) fn torque_jumps(before: &[f64; 7], command: &CyclicCommand, rate: f64) -> bool {
        // Floats of the state may round what a client takes as its last torque.
        let step = rate * PERIOD_S + 1e-3;
        !(0..7).all(|j| (command.torque_nm[j] - before[j]).abs() <= step)
    }
}
