//! Time from the stamps of messages.

use tribo_runtime::LONGEST_GAP_PERIODS;

/// Periods of which the median is the period of the topic.
const PERIODS: usize = 31;
/// Periods after which it is believed.
const ENOUGH: usize = 10;
/// The longest gap that is bridged before that (s).
const FIRST_GAP_S: f64 = 1.0;
/// Stamps that go back by more than this are those of a clock that was set, or of a bag that begins anew (ns).
const SET_BACK_NS: u64 = 1_000_000_000;

/// What a stamp says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Step {
    /// The first, at this time (s).
    First,
    /// The next; that many messages before it were lost.
    Next { lost: u64 },
    /// The next after a gap that is not bridged.
    Gap,
    /// The clock was set back.
    Restart,
    /// Not later than the one before.
    NotLater,
}

/// The stamps of a topic: time since the first, which is later in each message than in the one before, and the gaps in it.
///
/// ```text
/// t = (stamp - first stamp)/1e9;  a gap is longer than 20 periods, the period being the median of the last 31
/// ```
#[derive(Clone, Debug, Default)]
pub(crate) struct Stamps {
    first_ns: Option<u64>,
    last_ns: u64,
    /// The last periods (s), round and round.
    periods_s: [f64; PERIODS],
    count: usize,
}

impl Stamps {
    /// Time of a stamp since the first (s).
    pub fn time_s(&self, stamp_ns: u64) -> f64 {
        stamp_ns.saturating_sub(self.first_ns.unwrap_or(stamp_ns)) as f64 / 1e9
    }

    /// Period of the topic (s), once it is known.
    pub fn period_s(&self) -> Option<f64> {
        let known = self.count.min(PERIODS);
        let mut sorted = self.periods_s;
        let sorted = &mut sorted[..known];
        sorted.sort_unstable_by(f64::total_cmp);
        (known >= ENOUGH).then(|| sorted[known / 2])
    }

    /// What this stamp would say; nothing is taken yet.
    pub fn look(&self, stamp_ns: u64) -> Step {
        if self.first_ns.is_none() {
            return Step::First;
        }
        if stamp_ns <= self.last_ns {
            return if self.last_ns - stamp_ns > SET_BACK_NS { Step::Restart } else { Step::NotLater };
        }
        let dt_s = (stamp_ns - self.last_ns) as f64 / 1e9;
        match self.period_s() {
            Some(period_s) if dt_s > LONGEST_GAP_PERIODS * period_s => Step::Gap,
            Some(period_s) => Step::Next { lost: ((dt_s / period_s).round() as u64).saturating_sub(1) },
            None if dt_s > FIRST_GAP_S => Step::Gap,
            None => Step::Next { lost: 0 },
        }
    }

    /// Takes a stamp that was looked at.
    pub fn take(&mut self, stamp_ns: u64, step: Step) {
        match step {
            Step::First | Step::Restart => *self = Self { first_ns: Some(stamp_ns), ..Self::default() },
            Step::Next { .. } => {
                self.periods_s[self.count % PERIODS] = (stamp_ns - self.last_ns) as f64 / 1e9;
                self.count += 1;
            }
            Step::Gap => {}
            Step::NotLater => return,
        }
        self.last_ns = stamp_ns;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: u64 = 1_000_000;

    fn after(stamps_ms: &[u64]) -> (Stamps, Vec<Step>) {
        let mut stamps = Stamps::default();
        let steps = stamps_ms.iter().map(|ms| {
            let step = stamps.look(ms * MS);
            stamps.take(ms * MS, step);
            step
        });
        let steps = steps.collect();
        (stamps, steps)
    }

    #[test]
    fn losses_gaps_and_clocks_that_go_back() {
        let regular: Vec<u64> = (5000..5040).collect();
        let (stamps, steps) = after(&regular);
        assert_eq!((steps[0], stamps.period_s()), (Step::First, Some(1e-3)));
        assert!(steps[1..].iter().all(|step| *step == Step::Next { lost: 0 }));
        assert_eq!(stamps.time_s(5039 * MS), 0.039);
        for (ms, expected) in [
            (5043, Step::Next { lost: 3 }),
            (5059, Step::Next { lost: 19 }),
            (5060, Step::Gap),
            (5039, Step::NotLater),
            (4500, Step::NotLater),
            (4000, Step::Restart),
        ] {
            assert_eq!(stamps.look(ms * MS), expected, "{ms}");
        }
    }

    #[test]
    fn before_the_period_is_known_a_second_is_a_gap() {
        assert_eq!(after(&[10, 510, 1610]).1, [Step::First, Step::Next { lost: 0 }, Step::Gap]);
    }
}
