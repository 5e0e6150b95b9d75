//! What happens when a command comes too late.

/// How many deadlines in a row may pass without a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OverrunPolicy {
    /// The loop faults at this many missed deadlines in a row; before, the last command is held. At least 1, which
    /// holds nothing.
    pub fault_after: u32,
}

impl Default for OverrunPolicy {
    /// Two missed deadlines are held, the third stops: over 2 ms a torque of a moving arm is still nearly right, and a
    /// single late wake-up of an ordinary kernel does not end a trial.
    fn default() -> Self {
        Self { fault_after: 3 }
    }
}

/// What to do with the command of a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Delivery {
    /// It is in time: send it.
    Send,
    /// It is late: the last one that was sent stands, the robot is asked again.
    Hold,
    /// It is late once too often: the loop faults, the safe torque follows.
    Fault,
}

/// The policy with its memory: deadlines missed in a row, and in all.
///
/// ```text
/// missed = ⌊(end of tick − start of its period) / period⌋        0: in time
/// ```
#[derive(Clone, Copy, Debug)]
pub struct OverrunGuard {
    policy: OverrunPolicy,
    in_a_row: u64,
    /// Deadlines missed since the start.
    missed: u64,
    longest: u64,
}

impl OverrunGuard {
    /// A guard that has seen nothing.
    pub fn new(policy: OverrunPolicy) -> Self {
        Self { policy, in_a_row: 0, missed: 0, longest: 0 }
    }

    /// Judges a tick that let `missed` deadlines pass.
    #[inline]
    pub fn judge(&mut self, missed: u64) -> Delivery {
        if missed == 0 {
            self.in_a_row = 0;
            return Delivery::Send;
        }
        self.in_a_row += missed;
        self.missed += missed;
        self.longest = self.longest.max(self.in_a_row);
        if self.in_a_row >= u64::from(self.policy.fault_after.max(1)) { Delivery::Fault } else { Delivery::Hold }
    }

    /// Deadlines missed since the start.
    pub fn missed(&self) -> u64 {
        self.missed
    }

    /// The longest row of missed deadlines.
    pub fn longest_row(&self) -> u64 {
        self.longest
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_ends_with_a_command_in_time() {
        let mut guard = OverrunGuard::new(OverrunPolicy { fault_after: 3 });
        let deliveries = [0, 1, 1, 0, 2, 0, 1, 1, 1].map(|missed| guard.judge(missed));
        use Delivery::{Fault, Hold, Send};
        assert_eq!(deliveries, [Send, Hold, Hold, Send, Hold, Send, Hold, Hold, Fault]);
        assert_eq!((guard.missed(), guard.longest_row()), (7, 3));
    }

    #[test]
    fn one_stall_counts_every_deadline_it_covers() {
        let mut guard = OverrunGuard::new(OverrunPolicy::default());
        assert_eq!(guard.judge(3), Delivery::Fault);
        let mut strict = OverrunGuard::new(OverrunPolicy { fault_after: 0 });
        assert_eq!(strict.judge(1), Delivery::Fault, "zero is one");
    }
}
