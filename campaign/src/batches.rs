//! Trials that are chosen together.

use std::ops::Range;

/// The batches of a campaign: trial 0 alone, as nothing is known before it, then `size` trials at a time.
///
/// A trial is chosen by what the trials before its batch tell, and by the parameters of those before it in its batch; which of them
/// ends first, and the number of threads, do not matter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Batches {
    /// Trials of a batch (q); none counts as one.
    pub size: usize,
}

impl Batches {
    /// Numbers of the trials that are chosen together with trial `number`, itself among them.
    pub fn of(self, number: usize) -> Range<usize> {
        let Some(after_first) = number.checked_sub(1) else { return 0..1 };
        let size = self.size.max(1);
        let start = number - after_first % size;
        start..start + size
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_trial_is_alone_and_the_others_come_by_size() {
        let starts = |size: usize| (0..8).map(|number| Batches { size }.of(number).start).collect::<Vec<_>>();
        assert_eq!(starts(1), [0, 1, 2, 3, 4, 5, 6, 7]);
        assert_eq!(starts(2), [0, 1, 1, 3, 3, 5, 5, 7]);
        assert_eq!(starts(3), [0, 1, 1, 1, 4, 4, 4, 7]);
        assert_eq!(starts(0), starts(1));
        for size in 1..5 {
            for number in 0..20 {
                let batch = Batches { size }.of(number);
                assert!(batch.contains(&number) && batch.len() == if number == 0 { 1 } else { size });
                assert!(batch.clone().all(|other| Batches { size }.of(other) == batch));
            }
        }
    }
}
